// SPDX-License-Identifier: Apache-2.0
//
// ULX3S: 25, 50 or 100 MHz from its 25 MHz. The converter on the board, or AD7606 on the headers, which share all
// lines but DOUT and BUSY. docs/boards.md has the wiring.

`include "msn_build.svh"  // the configuration, written by tools/synth.py

module ulx3s_top (
  input  logic        clk_25m_i,
  input  logic        rx_i,
  output logic        tx_o,
  output logic [7:0]  led_o,
  input  logic        moving_i,
  output logic        slip_o,
  output logic        gross_o,
  output logic        adc_cs_n_o,    // on the board
  output logic        adc_sclk_o,
  output logic        adc_mosi_o,
  input  logic        adc_miso_i,
  output logic [7:0]  row_o,         // headers
  output logic [2:0]  group_o,
  output logic        ext_cs_n_o,
  output logic        ext_sclk_o,
  output logic        ext_convst_o,
  output logic        ext_reset_o,
  input  logic [7:0]  ext_busy_i,
  input  logic [15:0] ext_miso_i
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

  localparam bit OnBoard = `MSN_ADC != msn_pkg::AdcAd7606;
  logic cs_n, sclk, touched, pressed;
  msn_board u_board (
    .clk_i       (clk),
    .good_i      (good),
    .row_o       (row_o),
    .group_o     (group_o),
    .adc_cs_n_o  (cs_n),
    .adc_sclk_o  (sclk),
    .adc_mosi_o  (adc_mosi_o),
    .adc_convst_o(ext_convst_o),
    .adc_reset_o (ext_reset_o),
    .adc_miso_i  (OnBoard ? {15'd0, adc_miso_i} : ext_miso_i),
    .adc_busy_i  (ext_busy_i),
    .moving_i    (moving_i),
    .rx_i        (rx_i),
    .tx_o        (tx_o),
    .slip_o      (slip_o),
    .gross_o     (gross_o),
    .touched_o   (touched),
    .pressed_o   (pressed)
  );
  assign adc_cs_n_o = !OnBoard || cs_n;
  assign adc_sclk_o = !OnBoard || sclk;
  assign ext_cs_n_o = OnBoard || cs_n;
  assign ext_sclk_o = OnBoard || sclk;
  assign led_o      = {3'b0, good, pressed, touched, slip_o, gross_o};

endmodule
