// SPDX-License-Identifier: Apache-2.0
//
// A 3x3 fingertip in a user's design: only the core, with its parameters and pins. `meissner config show fingertip`
// prints the reset values (Resets) of a configuration. Without Resets, as here, the settings have the register map's
// defaults, and a host sets the others.

module finger (
  input  logic       clk_24m_i,
  input  logic       rst_i,
  output logic [2:0] row_o,       // drives the rows of the matrix
  output logic       adc_cs_n_o,  // an MCP3208 on the columns
  output logic       adc_sclk_o,
  output logic       adc_mosi_o,
  input  logic       adc_miso_i,
  input  logic       rx_i,
  output logic       tx_o,
  output logic       slip_o       // to the hand's controller
);

  logic        unused_group, unused_convst, unused_adc_reset, unused_ready, unused_done, unused_error;
  logic        unused_valid, unused_last, unused_gross, unused_touched, unused_pressed, unused_grip,
               unused_pwm;
  logic [5:0]  unused_hv;
  logic [7:0]  unused_bytes;
  logic [31:0] unused_word;
  logic [16:0] unused_command;
  msn_pkg::sdram_t    unused_sdram;
  msn_pkg::verdict_t  unused_verdict;
  msn_pkg::decision_t unused_decision;

  msn_core #(
    .Adc        (msn_pkg::AdcMcp3208),
    .AdcChannels(3),
    .ClkKhz     (24_000),
    .Array      (1'b1),
    .Rows       (3),
    .Columns    (3),
    .Tare       (1'b1),
    .Image      (1'b1)
  ) u_core (
    .clk_i            (clk_24m_i),
    .rst_i,
    .row_o,
    .group_o          (unused_group),
    .adc_cs_n_o,
    .adc_sclk_o,
    .adc_mosi_o,
    .adc_miso_i,
    .adc_convst_o     (unused_convst),
    .adc_busy_i       (1'b0),
    .adc_reset_o      (unused_adc_reset),
    .actuator_moving_i(1'b0),
    .in_valid_i       (1'b0),
    .in_ready_o       (unused_ready),
    .in_data_i        ('0),
    .in_id_i          ('0),
    .in_last_i        (1'b0),
    .slip_o,
    .gross_o          (unused_gross),
    .touched_o        (unused_touched),
    .pressed_o        (unused_pressed),
    .grip_valid_o     (unused_grip),
    .grip_word_o      (unused_command),
    .pwm_o            (unused_pwm),
    .sdram_o          (unused_sdram),
    .sdram_dq_i       ('0),
    .hv_data_o        (unused_hv[0]),
    .hv_clk_o         (unused_hv[1]),
    .hv_le_o          (unused_hv[2]),
    .hv_bl_o          (unused_hv[3]),
    .hv_pol_o         (unused_hv[4]),
    .hv_dir_o         (unused_hv[5]),
    .verdict_o        (unused_verdict),
    .decision_o       (unused_decision),
    .rx_i,
    .tx_o,
    .bus_valid_i      (1'b0),
    .bus_write_i      (1'b0),
    .bus_address_i    ('0),
    .bus_wdata_i       ('0),
    .bus_strobe_i     ('0),
    .bus_done_o       (unused_done),
    .bus_error_o      (unused_error),
    .bus_rdata_o       (unused_word),
    .out_valid_o      (unused_valid),
    .out_ready_i      (1'b1),
    .out_data_o       (unused_bytes),
    .out_last_o       (unused_last)
  );

endmodule
