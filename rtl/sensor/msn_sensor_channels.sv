// SPDX-License-Identifier: Apache-2.0
//
// A converter's channels, from its pins or a stream to samples, one frame at a time.
//
//   ADC pins or stream ─ acquire ─ frame_gate ─ samples
//
// The next frame waits while busy_i is high, until the blocks downstream have finished the previous one, so that
// settings (commit_o) and the frame's time change only between frames. Gate = 0: settings are constants, and the
// blocks downstream keep the time themselves. A sensor's ports: docs/frames.md.
// Model: model/meissner/twins/sensor/sensors.py

module msn_sensor_channels #(
  parameter  int unsigned Adc        = msn_pkg::AdcNone,  // msn_pkg::adc_part_e
  parameter  int unsigned AdcLanes   = 1,
  parameter  int unsigned ClkKhz     = 25_000,
  parameter  int unsigned SclkKhz    = msn_adc_pkg::sclk_default_khz(Adc),
  parameter  int unsigned PeriodBits = 24,
  parameter  int unsigned AdcPeriod  = 0,                 // clocks, built in: msn_acquire
  parameter  int unsigned Channels   = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          ReadDuring = 1'b0,              // msn_adc_spi
  parameter  bit          Gate       = 1'b1,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,
  input  logic [47:0]                  now_i,

  input  msn_registers_pkg::cfg_t      cfg_i,
  output msn_registers_pkg::status_t   status_o,
  input  logic                         pending_i,      // settings wait for commit_o
  output logic                         commit_o,
  input  logic                         busy_i,

  output logic                         adc_cs_n_o,
  output logic                         adc_sclk_o,
  output logic                         adc_mosi_o,
  input  logic [AdcLanes-1:0]          adc_miso_i,
  output logic                         adc_convst_o,
  input  logic                         adc_busy_i,
  output logic                         adc_reset_o,
  output logic                         convert_o,      // convert start

  input  logic                         in_valid_i,     // Adc = AdcNone
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic [IdBits-1:0]            in_id_i,
  input  logic                         in_last_i,

  output logic                         sample_valid_o,
  input  logic                         sample_ready_i,
  output logic signed [SampleBits-1:0] sample_data_o,
  output logic [IdBits-1:0]            sample_id_o,
  output logic                         sample_first_o,
  output logic                         sample_last_o,
  output logic [47:0]                  time_o          // convert start of the frame that was let through
);

  if (PeriodBits > 24) begin : gen_check_period_bits
    $fatal(1, "msn_sensor_channels: PeriodBits = %0d must be at most 24, like its register", PeriodBits);
  end
  // Without the gate, the blocks downstream take a frame's time from the last convert start.
  if (ReadDuring && !Gate) begin : gen_check_read_during
    $fatal(1, "msn_sensor_channels: ReadDuring = 1 must go with Gate = 1");
  end

  msn_registers_pkg::adc_status_t adc;
  always_comb begin
    status_o     = '0;
    status_o.adc = adc;
  end

  logic adc_valid, adc_ready, read;
  msn_acquire #(
    .Adc(Adc), .AdcLanes(AdcLanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .PeriodBits(PeriodBits),
    .AdcPeriod(AdcPeriod), .Channels(Channels), .SampleBits(SampleBits), .ReadDuring(ReadDuring)
  ) u_acquire (
    .clk_i, .rst_i,
    .cfg_enable_i(cfg_i.adc.enable), .cfg_period_i(cfg_i.adc.period[PeriodBits-1:0]),
    .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i, .adc_convst_o, .adc_busy_i, .adc_reset_o,
    .convert_o, .read_o(read),
    .in_valid_i, .in_ready_o, .in_data_i, .in_id_i, .in_last_i,
    .out_valid_o(adc_valid), .out_ready_i(adc_ready), .out_data_o(sample_data_o), .out_id_o(sample_id_o),
    .out_last_o(sample_last_o),
    .dropped_o(adc.dropped), .overrun_o(adc.overrun), .timeout_o(adc.timeout), .mistagged_o(adc.mistagged),
    .over_range_o(adc.over_range)
  );

  if (Gate) begin : gen_gate
    msn_frame_gate u_frame_gate (
      .clk_i, .rst_i,
      .pending_i(sample_valid_o || pending_i), .commit_o, .busy_i,
      .in_valid_i(adc_valid), .in_ready_o(adc_ready), .in_last_i(sample_last_o),
      .out_valid_o(sample_valid_o), .out_ready_i(sample_ready_i), .out_first_o(sample_first_o)
    );
    if (Adc == msn_pkg::AdcNone) begin : gen_stream_time
      always_ff @(posedge clk_i) if (sample_valid_o && sample_ready_i && sample_first_o) time_o <= now_i;
    end else begin : gen_time_stamp
      msn_time_stamp #(.ReadDuring(ReadDuring)) u_time_stamp (
        .clk_i, .rst_i,
        .now_i, .convert_i(convert_o), .read_i(read), .valid_i(adc_valid), .ready_i(adc_ready),
        .last_i(sample_last_o), .time_o
      );
    end
  end else begin : gen_no_gate
    assign {sample_valid_o, adc_ready} = {adc_valid, sample_ready_i};
    assign {commit_o, sample_first_o, time_o} = '0;
    logic unused_gate;
    assign unused_gate = ^{pending_i, busy_i, now_i};
  end

  logic unused;
  assign unused = ^{cfg_i, read};

endmodule
