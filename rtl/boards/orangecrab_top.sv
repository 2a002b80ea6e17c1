// SPDX-License-Identifier: Apache-2.0
//
// OrangeCrab r0.2: its 48 MHz, converter on the SPI pins of the feather. docs/boards.md has the wiring.

`include "msn_build.svh"  // the configuration, written by tools/synth.py

module orangecrab_top (
  input  logic       clk_48m_i,
  input  logic       rx_i,
  output logic       tx_o,
  output logic       led_blue_n_o,
  output logic       led_green_n_o,
  output logic       led_red_n_o,
  input  logic       moving_i,
  output logic [7:0] row_o,
  output logic       adc_cs_n_o,
  output logic       adc_sclk_o,
  output logic       adc_mosi_o,
  input  logic       adc_miso_i
);

  if (`MSN_CLK_KHZ != 48_000) begin : gen_check_clk
    $fatal(1, "orangecrab_top: the clock of %0d kHz must be 48000", `MSN_CLK_KHZ);
  end

  logic slip, gross, touched, pressed;
  msn_board u_board (
    .clk_i       (clk_48m_i),
    .good_i      (1'b1),
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
  assign led_blue_n_o  = !(touched || pressed);
  assign led_green_n_o = !slip;
  assign led_red_n_o   = !gross;

endmodule
