// SPDX-License-Identifier: Apache-2.0
//
// An array's frames, from the scan of its lines and converters or from a stream: instances and wires only.
//
//   lines, ADC pins ─ scan_adc, or with Demod scan_demod ─┬─ frames
//   stream (Part = AdcNone) ──────────────────────────────┘
//
// out_time_o: a scanned frame's convert start; of a stream the present clock tick, to be read with the first beat.
// Latency and formats are those of the block inside. Model: model/meissner/twins/frontend/array_source.py

module msn_array_source #(
  parameter  int unsigned Rows             = 16,
  parameter  int unsigned Columns          = 16,
  parameter  bit          Demod            = 1'b0,
  parameter  int unsigned Part             = msn_pkg::AdcAd7606,  // msn_pkg::adc_part_e
  parameter  int unsigned Converters       = 1,
  parameter  int unsigned Channels         = 8,                   // of each converter; Demod: one
  parameter  int unsigned AdcLanes         = 1,
  parameter  int unsigned ClkKhz           = 25_000,
  parameter  int unsigned SclkKhz          = msn_adc_pkg::sclk_default_khz(Part),
  parameter  int unsigned SettleBits       = 16,
  parameter  int unsigned PeriodBits       = 32,
  parameter  int unsigned Form             = msn_pkg::DemodIq,    // this and the next five: msn_scan_demod
  parameter  int unsigned SamplesPerPeriod = 4,
  parameter  int unsigned SamplePeriod     = 160,
  parameter  int unsigned Periods          = 4,
  parameter  int unsigned Skip             = 4,
  parameter  int unsigned Shift            = 3,
  localparam int unsigned SampleBits       = 17,
  localparam int unsigned Lanes            = Demod ? 1 : Converters,
  localparam int unsigned Beats            = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned IdBits           = msn_pkg::index_width(Rows * Beats),
  localparam int unsigned Inputs           = Demod ? 1 : Channels,
  localparam int unsigned GroupBits        = msn_pkg::index_width((Columns + Converters * Inputs - 1)
                                                                  / (Converters * Inputs))
) (
  input  logic                             clk_i,
  input  logic                             rst_i,
  input  logic [47:0]                      now_i,

  input  logic                             cfg_enable_i,         // msn_scan
  input  logic [SettleBits-1:0]            cfg_settle_i,
  input  logic [PeriodBits-1:0]            cfg_period_i,
  input  logic                             cfg_interleave_i,

  output logic [Rows-1:0]                  row_o,
  output logic [GroupBits-1:0]             group_o,
  output logic [Converters-1:0]            adc_cs_n_o,
  output logic [Converters-1:0]            adc_sclk_o,
  output logic [Converters-1:0]            adc_mosi_o,
  input  logic [Converters*AdcLanes-1:0]   adc_miso_i,
  output logic [Converters-1:0]            adc_convst_o,
  input  logic [Converters-1:0]            adc_busy_i,
  output logic [Converters-1:0]            adc_reset_o,
  output logic                             convert_o,

  input  logic                             in_valid_i,           // Part = AdcNone: frames on a stream
  output logic                             in_ready_o,
  input  logic [Lanes*SampleBits-1:0]      in_data_i,
  input  logic [IdBits-1:0]                in_id_i,
  input  logic                             in_last_i,

  output logic                             out_valid_o,
  input  logic                             out_ready_i,
  output logic [Lanes*SampleBits-1:0]      out_data_o,
  output logic [Lanes-1:0]                 out_user_o,           // over-range
  output logic [IdBits-1:0]                out_id_o,
  output logic                             out_last_o,
  output logic [47:0]                      out_time_o,

  output logic [31:0]                      dropped_o,
  output logic [31:0]                      overrun_o,
  output logic [31:0]                      held_o,
  output logic [31:0]                      lost_o
);

  if (Part == msn_pkg::AdcNone) begin : gen_stream
    assign out_valid_o = in_valid_i;
    assign in_ready_o  = out_ready_i;
    assign out_data_o  = in_data_i;
    assign out_id_o    = in_id_i;
    assign out_last_o  = in_last_i;
    assign out_user_o  = '0;
    assign out_time_o  = now_i;  // read at the frame's first beat
    assign {row_o, group_o, adc_sclk_o, adc_mosi_o, adc_convst_o, adc_reset_o, convert_o} = '0;
    assign adc_cs_n_o  = '1;
    assign {dropped_o, overrun_o, held_o, lost_o} = '0;
    logic unused_scan;
    assign unused_scan = ^{clk_i, rst_i, cfg_enable_i, cfg_settle_i, cfg_period_i, cfg_interleave_i,
                           adc_busy_i, adc_miso_i};

  end else if (!Demod) begin : gen_adc
    logic [31:0] unused_frame;
    msn_scan_adc #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Part(Part), .Channels(Channels), .AdcLanes(AdcLanes),
      .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .SampleBits(SampleBits), .SettleBits(SettleBits),
      .PeriodBits(PeriodBits)
    ) u_scan_adc (
      .clk_i, .rst_i,
      .cfg_enable_i, .cfg_settle_i, .cfg_period_i, .cfg_interleave_i,
      .now_i, .row_o, .group_o,
      .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i, .adc_convst_o, .adc_busy_i, .adc_reset_o,
      .convert_o,
      .out_valid_o, .out_ready_i, .out_data_o, .out_id_o, .out_last_o, .out_user_o, .out_time_o,
      .out_frame_o(unused_frame),
      .dropped_o, .overrun_o, .held_o, .lost_o
    );

  end else begin : gen_demod
    logic [31:0] unused_frame;
    msn_scan_demod #(
      .Rows(Rows), .Columns(Columns), .Converters(Converters), .Part(Part), .ClkKhz(ClkKhz),
      .SclkKhz(SclkKhz), .SampleBits(SampleBits), .Form(Form), .SamplesPerPeriod(SamplesPerPeriod),
      .SamplePeriod(SamplePeriod), .Periods(Periods), .Skip(Skip), .Shift(Shift), .SettleBits(SettleBits),
      .PeriodBits(PeriodBits)
    ) u_scan_demod (
      .clk_i, .rst_i,
      .cfg_enable_i, .cfg_settle_i, .cfg_period_i, .cfg_interleave_i,
      .now_i, .row_o, .group_o,
      .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i(adc_miso_i[Converters-1:0]),
      .convert_o,
      .out_valid_o, .out_ready_i, .out_data_o, .out_id_o, .out_last_o, .out_user_o, .out_time_o,
      .out_frame_o(unused_frame),
      .dropped_o, .overrun_o, .held_o, .lost_o
    );
    assign {adc_convst_o, adc_reset_o} = '0;
    logic unused_pins;
    assign unused_pins = ^{adc_busy_i, adc_miso_i};
  end

  if (Part != msn_pkg::AdcNone) begin : gen_no_stream
    assign in_ready_o = 1'b0;
    logic unused_stream;
    assign unused_stream = ^{in_valid_i, in_data_i, in_id_i, in_last_i};
  end

endmodule
