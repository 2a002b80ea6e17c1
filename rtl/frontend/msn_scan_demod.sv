// SPDX-License-Identifier: Apache-2.0
//
// msn_scan of a capacitive array: at each place Converters adjacent taxels are measured by a burst of samples of their
// carrier, and the scan's samples are their amplitudes.
//
//   a place  switch, settle | Skip + Periods SamplesPerPeriod samples, SamplePeriod clocks apart | amplitudes
//
// SamplePeriod clocks are 1/SamplesPerPeriod of a carrier period, or that plus k full periods (docs/demod.md). A lost
// conversion spoils its burst: the place's samples are 0 and marked in user.
// Model: model/meissner/twins/frontend/scan_demod.py

module msn_scan_demod #(
  parameter  int unsigned Rows             = 8,
  parameter  int unsigned Columns          = 8,
  parameter  int unsigned Converters       = 1,
  parameter  int unsigned Part             = msn_pkg::AdcMax11123,  // msn_pkg::adc_part_e
  parameter  int unsigned ClkKhz           = 25_000,
  parameter  int unsigned SclkKhz          = msn_adc_pkg::sclk_default_khz(Part),
  parameter  int unsigned SampleBits       = 17,
  parameter  int unsigned Form             = msn_pkg::DemodIq,      // msn_pkg::demod_form_e
  parameter  int unsigned SamplesPerPeriod = 4,
  parameter  int unsigned SamplePeriod     = 160,                   // clocks
  parameter  int unsigned Periods          = 4,
  parameter  int unsigned Skip             = 4,                     // samples that settle
  parameter  int unsigned Shift            = 3,                     // amplitude = sum / 2^Shift
  localparam int unsigned GroupBits        = msn_pkg::index_width((Columns + Converters - 1) / Converters),
  localparam int unsigned IdBits           = msn_pkg::index_width(Rows * Columns)
) (
  input  logic                  clk_i,
  input  logic                  rst_i,

  input  msn_registers_pkg::scan_cfg_t    cfg_i,
  output msn_registers_pkg::scan_status_t status_o,
  input  logic [47:0]           now_i,

  output logic [Rows-1:0]       row_o,
  output logic [GroupBits-1:0]  group_o,

  output logic [Converters-1:0] adc_cs_n_o,
  output logic [Converters-1:0] adc_sclk_o,
  output logic [Converters-1:0] adc_mosi_o,
  input  logic [Converters-1:0] adc_miso_i,
  output logic                  convert_o,

  output logic                  out_valid_o,
  input  logic                  out_ready_i,
  output logic [SampleBits-1:0] out_data_o,
  output logic [IdBits-1:0]     out_id_o,
  output logic                  out_last_o,
  output logic                  out_user_o,
  output logic [31:0]           out_frame_o,
  output logic [47:0]           out_time_o
);

  localparam int unsigned Half       = msn_adc_pkg::half_clocks(Part, ClkKhz, SclkKhz);
  localparam int unsigned AdcCycle   = msn_adc_pkg::cycle_clocks(Part, 1, 1, ClkKhz, Half, 1'b0);
  localparam int unsigned Count      = Skip + Periods * SamplesPerPeriod;
  localparam int unsigned BurstBits  = $clog2(Count + 1);
  localparam int unsigned SampleTime = $clog2(SamplePeriod + 1);
  localparam int unsigned Measured   = $clog2(Periods + 1);
  localparam int unsigned SkipBits   = $clog2(Skip + 2);
  // An upper bound: the references add at most five bits, the root takes three clocks a bit.
  localparam int unsigned DemodLane  = 3 * (SampleBits + 5 + Measured + 1) + Shift + 2;
  localparam int unsigned DemodTime  = 5 + Converters * DemodLane;
  localparam int unsigned Span       = 2 + (Count - 1) * SamplePeriod;  // trigger to the last convert start
  localparam int unsigned Hold       = Span + msn_adc_pkg::hold_clocks(Part, 1, ClkKhz, Half);
  localparam int unsigned Cycle      = Span + AdcCycle + DemodTime;

  if (msn_adc_pkg::has_busy(Part)) begin : gen_check_part
    $fatal(1, "msn_scan_demod: Part = %0d must convert without BUSY", Part);
  end
  if (!msn_pkg::are_lanes(Converters)) begin : gen_check_converters
    $fatal(1, "msn_scan_demod: Converters = %0d must lie in 1 .. 8", Converters);
  end
  if (SamplePeriod < AdcCycle) begin : gen_check_sample_period
    $fatal(1, "msn_scan_demod: SamplePeriod = %0d must be at least the converter's %0d clocks", SamplePeriod,
           AdcCycle);
  end
  if (Periods < 1) begin : gen_check_periods
    $fatal(1, "msn_scan_demod: Periods = %0d must be at least 1", Periods);
  end

  logic place_trigger, trigger, spoiled, burst_lost, first, taken;
  logic [Converters-1:0]            ready, convert, sample_valid, sample_user, lost;
  logic [Converters*SampleBits-1:0] sample;
  logic                             together, demod_ready, enable_q;
  // The remaining samples of a spoiled burst are discarded, so that the parts are in step again at the next burst.
  assign together  = &sample_valid;
  assign taken     = together && demod_ready;  // in a spoiled burst too: each burst has a first sample
  assign convert_o = |convert;

  msn_burst #(.CountBits(BurstBits), .PeriodBits(SampleTime)) u_burst (
    .clk_i, .rst_i,
    .cfg_count_i(BurstBits'(Count)), .cfg_period_i(SampleTime'(SamplePeriod)),
    .start_i(place_trigger), .trigger_o(trigger), .taken_i(taken), .first_o(first),
    .lost_i(|lost), .lost_o(burst_lost),
    .spoiled_o(spoiled)
  );

  for (genvar part = 0; part < Converters; part++) begin : gen_adc
    logic        unused_id, unused_last, unused_convst, unused_reset, unused_busy, unused_read;
    logic [31:0] unused_dropped, unused_overrun, unused_timeout, unused_mistagged, unused_over_range;
    msn_adc_spi #(
      .Part(Part), .Channels(1), .Lanes(1), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .SampleBits(SampleBits),
      .PeriodBits(1), .Trigger(1'b1)
    ) u_adc_spi (
      .clk_i, .rst_i,
      .cfg_enable_i(1'b1), .cfg_period_i(1'b0),
      .trigger_i(trigger),
      .adc_cs_n_o(adc_cs_n_o[part]), .adc_sclk_o(adc_sclk_o[part]), .adc_mosi_o(adc_mosi_o[part]),
      .adc_miso_i(adc_miso_i[part]), .adc_convst_o(unused_convst), .adc_busy_i(1'b0),
      .adc_reset_o(unused_reset), .busy_o(unused_busy), .wait_i(1'b0),
      .ready_o(ready[part]), .convert_o(convert[part]), .read_o(unused_read), .lost_o(lost[part]),
      .out_valid_o(sample_valid[part]), .out_ready_i(spoiled || taken),
      .out_data_o(sample[part*SampleBits+:SampleBits]), .out_id_o(unused_id), .out_last_o(unused_last),
      .out_user_o(sample_user[part]),
      .dropped_o(unused_dropped), .overrun_o(unused_overrun), .timeout_o(unused_timeout),
      .mistagged_o(unused_mistagged), .over_range_o(unused_over_range)
    );
  end

  localparam int unsigned LaneBits = msn_pkg::index_width(Converters);
  logic                         level_valid, level_ready, level_user, unused_level_last;
  logic signed [SampleBits-1:0] level;
  logic        [LaneBits-1:0]   unused_level_id;
  logic        [31:0]           unused_broken;  // the scan's lost counts the same
  msn_am_demod #(
    .Form(Form), .SamplesPerPeriod(SamplesPerPeriod), .Lanes(Converters), .Channels(Converters),
    .SampleBits(SampleBits), .PeriodBits(Measured), .SkipBits(SkipBits)
  ) u_am_demod (
    .clk_i, .rst_i,
    .cfg_periods_i(Measured'(Periods)), .cfg_skip_i(SkipBits'(Skip)), .cfg_shift_i(5'(Shift)),
    .in_valid_i(together && !spoiled), .in_ready_o(demod_ready), .in_data_i(sample), .in_user_i(sample_user),
    .in_start_i(first), .in_id_i('0), .in_last_i(1'b0),
    .out_valid_o(level_valid), .out_ready_i(level_ready), .out_data_o(level), .out_id_o(unused_level_id),
    .out_last_o(unused_level_last), .out_user_o(level_user),
    .broken_o(unused_broken)
  );

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
    .Rows(Rows), .Columns(Columns), .Lanes(1), .Channels(Converters), .Hold(Hold), .Cycle(Cycle),
    .SampleBits(SampleBits)
  ) u_scan (
    .clk_i, .rst_i,
    .cfg_i(cfg), .status_o,
    .now_i, .row_o, .group_o, .trigger_o(place_trigger),
    .in_valid_i(level_valid), .in_ready_o(level_ready), .in_data_i(level), .in_user_i(level_user),
    .in_lost_i(burst_lost),
    .out_valid_o, .out_ready_i, .out_data_o, .out_id_o, .out_last_o, .out_user_o, .out_frame_o, .out_time_o
  );

endmodule
