// SPDX-License-Identifier: Apache-2.0
//
// What every board has behind its pins: the reset and the core. Its parameters are the configuration's; each
// board's top only adds clock and pins. Thresholds are those the bitstream is built with.

module msn_board #(
  parameter  int unsigned Adc            = msn_pkg::AdcMcp3208,  // msn_pkg::adc_part_e
  parameter  int unsigned ClkKhz         = 12_000,
  parameter  int unsigned SclkKhz        = 1_000,
  parameter  int unsigned BaudHz         = 1_000_000,
  parameter  int unsigned PeriodClocks   = 1_200,  // from convert start to convert start
  parameter  bit          Single         = 1'b0,   // msn_adc_single reads the converter
  parameter  int unsigned SampleBits     = 13,
  parameter  int unsigned TimerBits      = 10,
  parameter  int unsigned Threshold      = 23,
  parameter  int unsigned GrossThreshold = 200,
  parameter  int          ContactLevel   = 7000,
  parameter  int          ReleaseLevel   = 7400,
  parameter  bit          ContactRises   = 1'b0,
  parameter  int unsigned Hold           = 100,
  parameter  int unsigned Refractory     = 50,
  parameter  int unsigned Blank          = 250
) (
  input  logic clk_i,
  input  logic good_i,  // the clock runs

  output logic adc_cs_n_o,
  output logic adc_sclk_o,
  output logic adc_mosi_o,
  input  logic adc_miso_i,

  output logic tx_o,

  output logic contact_o,  // levels, for LEDs or pins
  output logic slip_o,
  output logic gross_o
);

  localparam int unsigned P2pBits    = SampleBits + 1;
  localparam int unsigned PeriodBits = $clog2(PeriodClocks + 1);

  logic rst;
  msn_board_reset u_reset (
    .clk_i,
    .good_i,
    .rst_o(rst)
  );

  logic               convert, decision_valid, decision_ready, raised;
  logic [2:0]         state;
  logic [P2pBits-1:0] p2p;
  msn_channels #(
    .Adc       (Adc),
    .ClkKhz    (ClkKhz),
    .SclkKhz   (SclkKhz),
    .PeriodBits(PeriodBits),
    .AdcPeriod (Single ? PeriodClocks : 0),
    .SampleBits(SampleBits),
    .TimerBits (TimerBits),
    .Serial    (1'b1)
  ) u_channels (
    .clk_i,
    .rst_i                (rst),
    .cfg_adc_enable_i     (1'b1),
    .cfg_adc_period_i     (PeriodBits'(PeriodClocks)),
    .adc_cs_n_o,
    .adc_sclk_o,
    .adc_mosi_o,
    .adc_miso_i,
    .adc_convst_o         (),
    .adc_busy_i           (1'b0),
    .adc_reset_o          (),
    .convert_o            (convert),
    .cfg_threshold_i      (P2pBits'(Threshold)),
    .cfg_gross_threshold_i(P2pBits'(GrossThreshold)),
    .cfg_contact_level_i  (P2pBits'(ContactLevel)),
    .cfg_release_level_i  (P2pBits'(ReleaseLevel)),
    .cfg_contact_rises_i  (ContactRises),
    .cfg_hold_i           (TimerBits'(Hold)),
    .cfg_refractory_i     (TimerBits'(Refractory)),
    .cfg_blank_i          (TimerBits'(Blank)),
    .actuator_moving_i    (1'b0),
    .in_valid_i           (1'b0),
    .in_ready_o           (),
    .in_data_i            ('0),
    .in_id_i              ('0),
    .in_last_i            (1'b1),
    .out_valid_o          (decision_valid),
    .out_ready_i          (decision_ready),
    .out_state_o          (state),
    .out_raised_o         (raised),
    .out_over_o           (),
    .out_p2p_o            (p2p),
    .out_id_o             (),
    .out_last_o           (),
    .out_end_o            (),
    .dropped_o            (),
    .overrun_o            (),
    .timeout_o            (),
    .mistagged_o          (),
    .over_range_o         (),
    .damaged_o            (),
    .blanked_o            ()
  );

  logic       packet_begin, packet_valid, packet_ready, packet_last;
  logic [7:0] packet;
  msn_packet_slip #(.P2pBits(P2pBits)) u_packet (
    .clk_i,
    .rst_i       (rst),
    .convert_i   (convert),
    .in_valid_i  (decision_valid),
    .in_ready_o  (decision_ready),
    .in_raised_i (raised),
    .in_state_i  (state),
    .in_p2p_i    (p2p),
    .out_begin_o (packet_begin),
    .out_valid_o (packet_valid),
    .out_ready_i (packet_ready),
    .out_data_o  (packet),
    .out_last_o  (packet_last)
  );

  logic       byte_valid, byte_ready;
  logic [7:0] line_byte;
  msn_cobs #(.MaxBytes(18)) u_cobs (
    .clk_i,
    .rst_i       (rst),
    .in_begin_i  (packet_begin),
    .in_valid_i  (packet_valid),
    .in_ready_o  (packet_ready),
    .in_data_i   (packet),
    .in_last_i   (packet_last),
    .out_valid_o (byte_valid),
    .out_ready_i (byte_ready),
    .out_data_o  (line_byte)
  );

  msn_uart_tx #(.ClkHz(1000 * ClkKhz), .BaudHz(BaudHz)) u_uart_tx (
    .clk_i,
    .rst_i      (rst),
    .in_valid_i (byte_valid),
    .in_ready_o (byte_ready),
    .in_data_i  (line_byte),
    .tx_o
  );

  always_ff @(posedge clk_i) begin
    if (decision_valid && decision_ready) begin
      contact_o <= state != msn_pkg::None;
      slip_o    <= state == msn_pkg::Incipient || state == msn_pkg::Gross;
      gross_o   <= state == msn_pkg::Gross;
    end
    if (rst) {contact_o, slip_o, gross_o} <= '0;
  end

endmodule
