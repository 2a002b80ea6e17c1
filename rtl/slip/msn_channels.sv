// SPDX-License-Identifier: Apache-2.0
//
// Channels of a converter from their pins to slip decisions, without registers and link: instances and wires only.
//
//   ADC pins ─ sensor_channels ─ slip_path ─ decisions
//
// As in a core, but without the blocks that a core has between the two: no gate and no skid, and actuator_moving_i is
// synchronous. Adc = AdcNone: samples enter on the stream. Latency and formats are those of msn_slip_path.
// Model: model/meissner/twins/slip/channels.py

module msn_channels #(
  parameter  int unsigned Adc        = msn_pkg::AdcNone,  // msn_pkg::adc_part_e
  parameter  int unsigned AdcLanes   = 1,
  parameter  int unsigned ClkKhz     = 25_000,
  parameter  int unsigned SclkKhz    = msn_adc_pkg::sclk_default_khz(Adc),
  parameter  int unsigned PeriodBits = 24,
  parameter  int unsigned AdcPeriod  = 0,   // clocks, built in, for one MCP3208 channel; 0: cfg_adc_period_i
  parameter  int unsigned Channels   = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Level      = 1,   // Haar level
  parameter  int unsigned Window     = 64,  // samples
  parameter  int unsigned Hop        = 64,  // samples
  parameter  int unsigned TimerBits  = 16,
  parameter  bit          Mask       = 1'b0,  // of the stream's samples: a masked sample raises no slip
  parameter  bit          Serial     = 1'b0,  // one channel, two bits a clock: a third of the cells
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels),
  localparam int unsigned DetailBits = SampleBits + Level
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         cfg_adc_enable_i,
  input  logic        [PeriodBits-1:0] cfg_adc_period_i,  // clocks from convert start to convert start
  output logic                         adc_cs_n_o,
  output logic                         adc_sclk_o,
  output logic                         adc_mosi_o,
  input  logic        [AdcLanes-1:0]   adc_miso_i,
  output logic                         adc_convst_o,
  input  logic                         adc_busy_i,
  output logic                         adc_reset_o,
  output logic                         convert_o,         // convert start, which defines a frame's time

  input  msn_registers_pkg::slip_cfg_t cfg_i,
  input  logic                         actuator_moving_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic        [IdBits-1:0]     in_id_i,
  input  logic                         in_last_i,
  input  logic                         in_mask_i,     // a sample that cannot be trusted

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output msn_pkg::slip_state_e         out_state_o,
  output logic                         out_raised_o,
  output logic                         out_over_o,
  output logic        [DetailBits-1:0] out_p2p_o,
  output logic        [IdBits-1:0]     out_id_o,
  output logic                         out_last_o,
  output logic                         out_end_o,

  output logic                         busy_o,        // of the slip path
  output logic        [31:0]           dropped_o,     // frames: the chain was not ready
  output logic        [31:0]           overrun_o,     // ticks: the frame before was still under way
  output logic        [31:0]           timeout_o,     // frames: BUSY did not answer
  output logic        [31:0]           mistagged_o,   // frames: an answer had another channel's number
  output logic        [31:0]           over_range_o,  // samples at an end of the converter's range
  output logic        [31:0]           damaged_o,     // frames: channels out of order
  output logic        [31:0]           blanked_o      // details: over, but blanked or moving
);

  if (Mask && Adc != msn_pkg::AdcNone) begin : gen_check_mask
    $fatal(1, "msn_channels: Mask = 1 must have Adc = 0: a converter's samples have no mask");
  end

  msn_registers_pkg::cfg_t    cfg;
  msn_registers_pkg::status_t status;
  always_comb begin
    cfg            = '0;
    cfg.adc.enable = cfg_adc_enable_i;
    cfg.adc.period = 24'(cfg_adc_period_i);
    dropped_o      = status.adc.dropped;
    overrun_o      = status.adc.overrun;
    timeout_o      = status.adc.timeout;
    mistagged_o    = status.adc.mistagged;
    over_range_o   = status.adc.over_range;
  end

  logic                         sample_valid, sample_ready, sample_last, unused_commit, unused_first;
  logic signed [SampleBits-1:0] sample;
  logic        [IdBits-1:0]     sample_id;
  logic        [47:0]           unused_time;
  msn_sensor_channels #(
    .Adc(Adc), .AdcLanes(AdcLanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .PeriodBits(PeriodBits),
    .AdcPeriod(AdcPeriod), .Channels(Channels), .SampleBits(SampleBits), .Gate(1'b0)
  ) u_sensor (
    .clk_i, .rst_i, .now_i('0),
    .cfg_i(cfg), .status_o(status), .pending_i(1'b0), .commit_o(unused_commit), .busy_i(1'b0),
    .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i, .adc_convst_o, .adc_busy_i, .adc_reset_o,
    .convert_o,
    .in_valid_i, .in_ready_o, .in_data_i, .in_id_i, .in_last_i,
    .sample_valid_o(sample_valid), .sample_ready_i(sample_ready), .sample_data_o(sample),
    .sample_id_o(sample_id), .sample_first_o(unused_first), .sample_last_o(sample_last),
    .time_o(unused_time)
  );

  msn_slip_path #(
    .Channels(Channels), .SampleBits(SampleBits), .Level(Level), .Window(Window), .Hop(Hop),
    .TimerBits(TimerBits), .Mask(Mask), .Serial(Serial)
  ) u_slip_path (
    .clk_i, .rst_i,
    .cfg_i, .actuator_moving_i,
    .in_valid_i(sample_valid), .in_ready_o(sample_ready), .in_data_i(sample), .in_id_i(sample_id),
    .in_last_i(sample_last), .in_mask_i,
    .out_valid_o, .out_ready_i, .out_state_o, .out_raised_o, .out_over_o, .out_p2p_o, .out_id_o, .out_last_o,
    .out_end_o,
    .busy_o, .damaged_o, .blanked_o
  );

  logic unused_status;
  assign unused_status = ^status;

endmodule
