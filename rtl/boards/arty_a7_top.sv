// SPDX-License-Identifier: Apache-2.0
//
// Arty A7: 50 MHz from its 100 MHz, converter on PMOD JA. Not built here. docs/boards.md has the wiring.

`include "msn_build.svh"  // the configuration, written by tools/synth.py

module arty_a7_top (
  input  logic       clk_100m_i,
  input  logic       rx_i,
  output logic       tx_o,
  output logic [3:0] led_o,
  input  logic       moving_i,
  output logic [7:0] row_o,
  output logic       adc_cs_n_o,
  output logic       adc_sclk_o,
  output logic       adc_mosi_o,
  input  logic       adc_miso_i
);

  if (`MSN_CLK_KHZ != 50_000) begin : gen_check_clk
    $fatal(1, "arty_a7_top: the clock of %0d kHz must be 50000", `MSN_CLK_KHZ);
  end

  // 100 MHz * 10 = 1 GHz, / 20
  logic clk_100, clk_50, clk, feedback, good;
  IBUF u_pad (.I(clk_100m_i), .O(clk_100));
  MMCME2_BASE #(
    .CLKIN1_PERIOD   (10.0),
    .CLKFBOUT_MULT_F (10.0),
    .CLKOUT0_DIVIDE_F(20.0)
  ) u_mmcm (
    .CLKIN1  (clk_100),
    .CLKFBIN (feedback),
    .CLKFBOUT(feedback),
    .CLKOUT0 (clk_50),
    .LOCKED  (good),
    .PWRDWN  (1'b0),
    .RST     (1'b0)
  );
  BUFG u_buffer (.I(clk_50), .O(clk));

  logic slip, gross, touched, pressed;
  msn_board u_board (
    .clk_i       (clk),
    .good_i      (good),
    .row_o       (row_o),
    .group_o     (),
    .adc_cs_n_o  (adc_cs_n_o),
    .adc_sclk_o  (adc_sclk_o),
    .adc_mosi_o  (adc_mosi_o),
    .adc_convst_o(),
    .adc_reset_o (),
    .adc_miso_i  ({15'd0, adc_miso_i}),
    .adc_busy_i  ('0),
    .moving_i    (moving_i),
    .rx_i        (rx_i),
    .tx_o        (tx_o),
    .slip_o      (slip),
    .gross_o     (gross),
    .touched_o   (touched),
    .pressed_o   (pressed)
  );
  assign led_o = {pressed, touched, slip, gross};

endmodule
