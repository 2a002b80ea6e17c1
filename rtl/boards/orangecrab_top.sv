// SPDX-License-Identifier: Apache-2.0
//
// OrangeCrab r0.2: its 48 MHz, converter on the SPI pins of the feather. docs/boards.md has the wiring.

`include "msn_build.svh"  // the configuration, written by tools/synth.py

module orangecrab_top (
  input  logic clk_48m_i,
  output logic tx_o,
  output logic led_red_n_o,
  output logic led_green_n_o,
  output logic led_blue_n_o,
  output logic adc_cs_n_o,
  output logic adc_sclk_o,
  output logic adc_mosi_o,
  input  logic adc_miso_i
);

  logic contact, slip, gross;
  msn_board #(
    `MSN_PARAMETERS
  ) u_board (
    .clk_i     (clk_48m_i),
    .good_i    (1'b1),
    .adc_cs_n_o,
    .adc_sclk_o,
    .adc_mosi_o,
    .adc_miso_i,
    .tx_o,
    .contact_o (contact),
    .slip_o    (slip),
    .gross_o   (gross)
  );
  assign led_blue_n_o  = !contact;
  assign led_green_n_o = !slip;
  assign led_red_n_o   = !gross;

endmodule
