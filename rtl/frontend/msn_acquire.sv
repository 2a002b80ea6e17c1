// SPDX-License-Identifier: Apache-2.0
//
// Complete frames of samples from one converter's pins, or from a stream: instances and wires only.
//
//   Adc = AdcNone      the stream unchanged: complete frames, channels in order, `last` on the final one
//   AdcPeriod > 0      msn_adc_single: one channel of an MCP3208, a conversion every AdcPeriod clocks
//   else               msn_adc_spi: up to eight channels, cfg_period_i clocks from convert start to convert start
//
// Outputs of parts not built are 0, CS is high. convert_o is high in the clock in which a frame's time is taken, its
// convert start; with a stream any clock may be one, so convert_o stays high. No latency of its own.
// Error: none.
// Model: model/meissner/twins/frontend/acquire.py

module msn_acquire #(
  parameter  int unsigned Adc        = msn_pkg::AdcNone,  // msn_pkg::adc_part_e
  parameter  int unsigned AdcLanes   = 1,
  parameter  int unsigned ClkKhz     = 25_000,
  parameter  int unsigned SclkKhz    = msn_adc_pkg::sclk_default_khz(Adc),
  parameter  int unsigned PeriodBits = 24,
  parameter  int unsigned AdcPeriod  = 0,
  parameter  int unsigned Channels   = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          ReadDuring = 1'b0,  // msn_adc_spi: a frame is read while the next one is converted
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         cfg_enable_i,
  input  logic        [PeriodBits-1:0] cfg_period_i,

  output logic                         adc_cs_n_o,
  output logic                         adc_sclk_o,
  output logic                         adc_mosi_o,
  input  logic        [AdcLanes-1:0]   adc_miso_i,
  output logic                         adc_convst_o,
  input  logic                         adc_busy_i,
  output logic                         adc_reset_o,
  output logic                         convert_o,
  output logic                         read_o,        // ReadDuring: a frame's transfer begins

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic        [IdBits-1:0]     in_id_i,
  input  logic                         in_last_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [SampleBits-1:0] out_data_o,
  output logic        [IdBits-1:0]     out_id_o,
  output logic                         out_last_o,

  output logic        [31:0]           dropped_o,     // frames: the consumer was not ready
  output logic        [31:0]           overrun_o,     // ticks: the frame before was still under way
  output logic        [31:0]           timeout_o,     // frames: BUSY did not answer
  output logic        [31:0]           mistagged_o,   // frames: an answer had another channel's number
  output logic        [31:0]           over_range_o   // samples at an end of the converter's range
);

  if (ReadDuring && !msn_adc_pkg::has_busy(Adc)) begin : gen_check_read_during
    $fatal(1, "msn_acquire: ReadDuring = 1 must go with a converter that has BUSY");
  end

  if (Adc == msn_pkg::AdcNone) begin : gen_stream
    assign out_valid_o = in_valid_i;
    assign in_ready_o  = out_ready_i;
    assign out_data_o  = in_data_i;
    assign out_id_o    = in_id_i;
    assign out_last_o  = in_last_i;

    assign {adc_cs_n_o, adc_sclk_o, adc_mosi_o, adc_convst_o, adc_reset_o, convert_o, read_o} = 7'b1000010;
    assign {dropped_o, overrun_o, timeout_o, mistagged_o, over_range_o}               = '0;
    logic unused_pins;
    assign unused_pins = ^{clk_i, rst_i, cfg_enable_i, cfg_period_i, adc_miso_i, adc_busy_i};

  end else if (AdcPeriod != 0) begin : gen_adc_single
    if (Adc != msn_pkg::AdcMcp3208 || Channels != 1) begin : gen_check_adc_period
      $fatal(1, "msn_acquire: AdcPeriod = %0d must be 0 but for one channel of an MCP3208", AdcPeriod);
    end
    logic unused_user;
    msn_adc_single #(
      .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .Period(AdcPeriod), .SampleBits(SampleBits)
    ) u_adc_single (
      .clk_i, .rst_i,
      .cfg_enable_i,
      .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i(adc_miso_i[0]),
      .convert_o,
      .out_valid_o, .out_ready_i, .out_data_o, .out_user_o(unused_user),
      .dropped_o, .over_range_o
    );
    assign out_id_o   = '0;
    assign out_last_o = 1'b1;
    assign in_ready_o = 1'b0;
    assign {adc_convst_o, adc_reset_o, read_o, overrun_o, timeout_o, mistagged_o} = '0;
    logic unused_inputs;
    assign unused_inputs = ^{cfg_period_i, adc_busy_i, in_valid_i, in_data_i, in_id_i, in_last_i};

  end else begin : gen_adc
    logic unused_lost, unused_ready;  // lost frames are counted; the converter waits for its own ready
    logic unused_user;  // over-range samples are only counted here
    logic unused_busy;  // no other converter shares its lines
    msn_adc_spi #(
      .Part(Adc), .Channels(Channels), .Lanes(AdcLanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz),
      .SampleBits(SampleBits), .PeriodBits(PeriodBits), .ReadDuring(ReadDuring)
    ) u_adc_spi (
      .clk_i, .rst_i,
      .cfg_enable_i, .cfg_period_i,
      .trigger_i(1'b0),
      .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i, .adc_convst_o, .adc_busy_i, .adc_reset_o,
      .busy_o(unused_busy), .wait_i(1'b0), .ready_o(unused_ready), .convert_o, .read_o, .lost_o(unused_lost),
      .out_valid_o, .out_ready_i, .out_data_o, .out_id_o, .out_last_o, .out_user_o(unused_user),
      .dropped_o, .overrun_o, .timeout_o, .mistagged_o, .over_range_o
    );
    assign in_ready_o = 1'b0;
    logic unused_stream;
    assign unused_stream = ^{in_valid_i, in_data_i, in_id_i, in_last_i};
  end

endmodule
