// SPDX-License-Identifier: Apache-2.0
//
// iCEBreaker 1.0: 12 MHz, or 24 MHz from the PLL (MSN_CLK_KHZ); converter on PMOD 1A. docs/boards.md has the wiring.
// An iCE40 pulls its pins up or not at all, so that moving_n_i is low while the actuator moves: left open, it rests.

`include "msn_build.svh"  // the configuration, written by tools/synth.py

module icebreaker_top (
  input  logic       clk_12m_i,
  input  logic       rx_i,
  output logic       tx_o,
  output logic       led_red_n_o,
  output logic       led_green_n_o,
  input  logic       moving_n_i,
  output logic [7:0] row_o,
  output logic       adc_cs_n_o,
  output logic       adc_sclk_o,
  output logic       adc_mosi_o,
  input  logic       adc_miso_i
);

  logic clk, good;
  if (`MSN_CLK_KHZ == 12_000) begin : gen_crystal
    assign clk  = clk_12m_i;
    assign good = 1'b1;
  end else begin : gen_pll
    if (`MSN_CLK_KHZ != 24_000) begin : gen_check_clk
      $fatal(1, "icebreaker_top: the clock of %0d kHz must be 12000 or 24000", `MSN_CLK_KHZ);
    end
    // 12 MHz * 64 = 768 MHz, / 32
    SB_PLL40_PAD #(
      .FEEDBACK_PATH("SIMPLE"),
      .DIVR         (4'd0),
      .DIVF         (7'd63),
      .DIVQ         (3'd5),
      .FILTER_RANGE (3'd1)
    ) u_pll (
      .PACKAGEPIN   (clk_12m_i),
      .PLLOUTGLOBAL (clk),
      .LOCK         (good),
      .RESETB       (1'b1),
      .BYPASS       (1'b0)
    );
  end

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
    .moving_i    (!moving_n_i),
    .rx_i        (rx_i),
    .tx_o        (tx_o),
    .slip_o      (slip),
    .gross_o     (gross),
    .touched_o   (touched),
    .pressed_o   (pressed)
  );
  assign led_green_n_o = !(touched || pressed) || slip;
  assign led_red_n_o   = !(slip || gross);

endmodule
