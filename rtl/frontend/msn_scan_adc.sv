// SPDX-License-Identifier: Apache-2.0
//
// msn_scan with its converters: from the pins of Lanes parts of one kind, and the lines of the matrix, to frames.
//
// Channels inputs of each part are used. A part that converts them one after the other (MCP3208, MAX111xx) holds the
// row for that time; one that samples all simultaneously (AD7606) lets the row change while it converts. The lines
// hold for Hold clocks, triggers are Cycle clocks apart, both from msn_adc_pkg. Scanning begins when all parts have
// been reset or set up. Converters are read together, after the last BUSY has fallen, so they may share every line but
// DOUT and BUSY.   Model: model/meissner/twins/frontend/scan_adc.py

module msn_scan_adc #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned Part       = msn_pkg::AdcAd7606,  // msn_pkg::adc_part_e
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned AdcLanes   = 1,                   // DOUT lines of each part
  parameter  int unsigned ClkKhz     = 25_000,
  parameter  int unsigned SclkKhz    = msn_adc_pkg::sclk_default_khz(Part),
  parameter  int unsigned SampleBits = 17,
  parameter  bit          ReadDuring = 1'b0,                // a conversion is read while the next one runs
  localparam int unsigned Beats      = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned IdBits     = msn_pkg::index_width(Rows * Beats),
  parameter  int unsigned Depth      = Rows * Beats,
  localparam int unsigned GroupBits  = msn_pkg::index_width((Beats + Channels - 1) / Channels)
) (
  input  logic                        clk_i,
  input  logic                        rst_i,

  input  msn_registers_pkg::scan_cfg_t    cfg_i,
  output msn_registers_pkg::scan_status_t status_o,
  input  logic [47:0]                 now_i,

  output logic [Rows-1:0]             row_o,
  output logic [GroupBits-1:0]        group_o,

  output logic [Lanes-1:0]            adc_cs_n_o,
  output logic [Lanes-1:0]            adc_sclk_o,
  output logic [Lanes-1:0]            adc_mosi_o,
  input  logic [Lanes*AdcLanes-1:0]   adc_miso_i,
  output logic [Lanes-1:0]            adc_convst_o,
  input  logic [Lanes-1:0]            adc_busy_i,
  output logic [Lanes-1:0]            adc_reset_o,
  output logic                        convert_o,

  output logic                        out_valid_o,
  input  logic                        out_ready_i,
  output logic [Lanes*SampleBits-1:0] out_data_o,
  output logic [IdBits-1:0]           out_id_o,
  output logic                        out_last_o,
  output logic [Lanes-1:0]            out_user_o,
  output logic [31:0]                 out_frame_o,
  output logic [47:0]                 out_time_o
);

  localparam int unsigned Half  = msn_adc_pkg::half_clocks(Part, ClkKhz, SclkKhz);
  localparam int unsigned Hold  = msn_adc_pkg::hold_clocks(Part, Channels, ClkKhz, Half);
  localparam int unsigned Cycle = msn_adc_pkg::cycle_clocks(Part, Channels, AdcLanes, ClkKhz, Half,
                                                            ReadDuring);
  localparam int unsigned Overlap = ReadDuring ? msn_adc_pkg::overlap_clocks(Part, ClkKhz, Half) : 0;

  logic                        trigger;
  logic [Lanes-1:0]            ready, busy, convert, sample_valid, sample_ready, sample_user, lost;
  logic [Lanes*SampleBits-1:0] sample;
  assign convert_o = |convert;
  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_adc
    // msn_scan numbers the channels and counts lost conversions.
    logic [msn_pkg::index_width(Channels)-1:0] unused_id;
    logic                                      unused_last, unused_read;
    logic [31:0] unused_dropped, unused_overrun, unused_timeout, unused_mistagged, unused_over_range;
    msn_adc_spi #(
      .Part(Part), .Channels(Channels), .Lanes(AdcLanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz),
      .SampleBits(SampleBits), .PeriodBits(1), .Trigger(1'b1), .ReadDuring(ReadDuring)
    ) u_adc_spi (
      .clk_i, .rst_i,
      .cfg_enable_i(1'b1), .cfg_period_i(1'b0),
      .trigger_i(trigger),
      .adc_cs_n_o(adc_cs_n_o[lane]), .adc_sclk_o(adc_sclk_o[lane]), .adc_mosi_o(adc_mosi_o[lane]),
      .adc_miso_i(adc_miso_i[lane*AdcLanes+:AdcLanes]), .adc_convst_o(adc_convst_o[lane]),
      .adc_busy_i(adc_busy_i[lane]), .adc_reset_o(adc_reset_o[lane]),
      .busy_o(busy[lane]), .wait_i(|busy),
      .ready_o(ready[lane]), .convert_o(convert[lane]), .read_o(unused_read), .lost_o(lost[lane]),
      .out_valid_o(sample_valid[lane]), .out_ready_i(sample_ready[lane]),
      .out_data_o(sample[lane*SampleBits+:SampleBits]), .out_id_o(unused_id), .out_last_o(unused_last),
      .out_user_o(sample_user[lane]),
      .dropped_o(unused_dropped), .overrun_o(unused_overrun), .timeout_o(unused_timeout),
      .mistagged_o(unused_mistagged), .over_range_o(unused_over_range)
    );
  end

  // Parts stay ready once they have been: one that is set up again loses conversions but does not stop the scan.
  logic enable_q;
  msn_registers_pkg::scan_cfg_t cfg;
  always_comb begin
    cfg        = cfg_i;
    cfg.enable = enable_q;
  end
  always_ff @(posedge clk_i) begin
    enable_q <= cfg_i.enable && &ready;
    if (rst_i) enable_q <= 1'b0;
  end

  msn_scan #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Channels(Channels), .Hold(Hold), .Cycle(Cycle),
    .SampleBits(SampleBits), .Depth(Depth), .Overlap(Overlap)
  ) u_scan (
    .clk_i, .rst_i,
    .cfg_i(cfg), .status_o,
    .now_i, .row_o, .group_o, .trigger_o(trigger),
    .in_valid_i(sample_valid), .in_ready_o(sample_ready), .in_data_i(sample), .in_user_i(sample_user),
    .in_lost_i(lost),
    .out_valid_o, .out_ready_i, .out_data_o, .out_id_o, .out_last_o, .out_user_o, .out_frame_o, .out_time_o
  );

endmodule
