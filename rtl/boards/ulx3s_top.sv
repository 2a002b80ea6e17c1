// SPDX-License-Identifier: Apache-2.0
//
// ULX3S: up to 100 MHz from its 25 MHz, the converter on the board. docs/boards.md has the wiring.

`include "msn_build.svh"  // the configuration, written by tools/synth.py

module ulx3s_top (
  input  logic       clk_25m_i,
  output logic       tx_o,
  output logic [7:0] led_o,
  output logic       adc_cs_n_o,
  output logic       adc_sclk_o,
  output logic       adc_mosi_o,
  input  logic       adc_miso_i
);

  localparam int unsigned VcoKhz  = 600_000;
  localparam int unsigned Divider = VcoKhz / `MSN_CLK_KHZ;
  if (VcoKhz != Divider * `MSN_CLK_KHZ || `MSN_CLK_KHZ % 25_000 != 0) begin : gen_check_clk
    $fatal(1, "ulx3s_top: the clock of %0d kHz must be 25000, 50000 or 100000", `MSN_CLK_KHZ);
  end

  logic clk, good;
  (* ICP_CURRENT = "12", LPF_RESISTOR = "8" *)
  EHXPLLL #(
    .CLKI_DIV     (1),
    .CLKFB_DIV    (`MSN_CLK_KHZ / 25_000),
    .CLKOP_DIV    (Divider),
    .CLKOP_CPHASE (Divider - 1),
    .CLKOP_ENABLE ("ENABLED"),
    .FEEDBK_PATH  ("CLKOP")
  ) u_pll (
    .CLKI        (clk_25m_i),
    .CLKFB       (clk),
    .CLKOP       (clk),
    .LOCK        (good),
    .RST         (1'b0),
    .STDBY       (1'b0),
    .PHASESEL0   (1'b0),
    .PHASESEL1   (1'b0),
    .PHASEDIR    (1'b1),
    .PHASESTEP   (1'b1),
    .PHASELOADREG(1'b1),
    .PLLWAKESYNC (1'b0),
    .ENCLKOP     (1'b0)
  );

  logic contact, slip, gross;
  msn_board #(
    `MSN_PARAMETERS
  ) u_board (
    .clk_i     (clk),
    .good_i    (good),
    .adc_cs_n_o,
    .adc_sclk_o,
    .adc_mosi_o,
    .adc_miso_i,
    .tx_o,
    .contact_o (contact),
    .slip_o    (slip),
    .gross_o   (gross)
  );
  assign led_o = {4'b0, good, contact, slip, gross};

endmodule
