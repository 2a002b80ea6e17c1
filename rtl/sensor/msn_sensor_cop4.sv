// SPDX-License-Identifier: Apache-2.0
//
// The four-wire sensor, from a converter's pins or a stream to centres of pressure and slip decisions.
//
//   ADC pins or stream ─ sensor_channels ─ electrodes ─ cop4 ─┬─ centres of pressure
//                                                             └─ cop_slip (CopSlip) ─ decisions
//
// The next frame is let through when the last result of the previous one has left (msn_frame_owed).
// Model: model/meissner/twins/sensor/sensors.py

module msn_sensor_cop4 #(
  parameter  int unsigned Adc          = msn_pkg::AdcNone,  // msn_pkg::adc_part_e
  parameter  int unsigned AdcLanes     = 1,
  parameter  int unsigned ClkKhz       = 25_000,
  parameter  int unsigned SclkKhz      = msn_adc_pkg::sclk_default_khz(Adc),
  parameter  int unsigned AdcPeriod    = 0,
  parameter  bit          ReadDuring   = 1'b0,              // msn_adc_spi
  parameter  bit          Correct      = 1'b0,
  parameter  int unsigned BitsPerClock = 2,
  parameter  bit          CopSlip      = 1'b0,
  parameter  int unsigned Lag          = 16,
  localparam int unsigned SampleBits   = 17
) (
  input  logic                         clk_i,
  input  logic                         rst_i,
  input  logic [47:0]                  now_i,

  input  msn_registers_pkg::cfg_t      cfg_i,
  output msn_registers_pkg::status_t   status_o,
  input  logic                         pending_i,
  output logic                         commit_o,

  output logic                         adc_cs_n_o,
  output logic                         adc_sclk_o,
  output logic                         adc_mosi_o,
  input  logic [AdcLanes-1:0]          adc_miso_i,
  output logic                         adc_convst_o,
  input  logic                         adc_busy_i,
  output logic                         adc_reset_o,
  output logic                         convert_o,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic [1:0]                   in_id_i,
  input  logic                         in_last_i,

  output logic                         cop_valid_o,
  output msn_pkg::cop_t                cop_o,
  output logic                         decision_valid_o,
  input  logic                         decision_ready_i,
  output msn_pkg::decision_t           decision_o,
  output logic [47:0]                  time_o
);

  msn_registers_pkg::status_t channels;
  logic [31:0]                damaged;
  always_comb begin
    status_o             = channels;
    status_o.cop.damaged = damaged;
  end

  logic                         owed, sample_valid, sample_ready, sample_first, sample_last;
  logic signed [SampleBits-1:0] sample;
  logic        [1:0]            sample_id;
  msn_sensor_channels #(
    .Adc(Adc), .AdcLanes(AdcLanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .AdcPeriod(AdcPeriod), .Channels(4),
    .SampleBits(SampleBits), .ReadDuring(ReadDuring)
  ) u_channels (
    .clk_i, .rst_i,
    .now_i, .cfg_i, .status_o(channels), .pending_i, .commit_o, .busy_i(owed),
    .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i, .adc_convst_o, .adc_busy_i, .adc_reset_o,
    .convert_o,
    .in_valid_i, .in_ready_o, .in_data_i, .in_id_i, .in_last_i,
    .sample_valid_o(sample_valid), .sample_ready_i(sample_ready), .sample_data_o(sample),
    .sample_id_o(sample_id), .sample_first_o(sample_first), .sample_last_o(sample_last),
    .time_o
  );

  logic               frame_valid, frame_ready, found_valid, found_ready;
  logic signed [16:0] e1, e2, e3, e4;
  msn_electrodes u_electrodes (
    .clk_i, .rst_i,
    .in_valid_i(sample_valid), .in_ready_o(sample_ready), .in_data_i(sample), .in_id_i(sample_id),
    .in_last_i(sample_last),
    .out_valid_o(frame_valid), .out_ready_i(frame_ready), .out_e1_o(e1), .out_e2_o(e2), .out_e3_o(e3),
    .out_e4_o(e4),
    .damaged_o(damaged)
  );

  logic signed [15:0] x, y;
  logic        [15:0] load;
  logic               unused_over, unused_saturated, unused_imbalance;
  logic        [3:0]  unused_open;
  msn_cop4 #(.BitsPerClock(BitsPerClock), .Correct(Correct)) u_cop4 (
    .clk_i, .rst_i,
    .cfg_rail_i(cfg_i.cop4.rail), .cfg_kx_i(cfg_i.cop4.kx), .cfg_shift_x_i(cfg_i.cop4.shift_x),
    .cfg_ky_i(cfg_i.cop4.ky), .cfg_shift_y_i(cfg_i.cop4.shift_y), .cfg_kf_i(cfg_i.cop4.kf),
    .cfg_shift_load_i(cfg_i.cop4.shift_load),
    .cfg_p_i         ({cfg_i.cop4.p5, cfg_i.cop4.p4, cfg_i.cop4.p3, cfg_i.cop4.p2,
                       cfg_i.cop4.p1, cfg_i.cop4.p0}),
    .cfg_min_load_i(cfg_i.cop4.min_load), .cfg_top_i(cfg_i.cop4.top), .cfg_idle_i(cfg_i.cop4.idle),
    .cfg_busy_i(cfg_i.cop4.busy), .cfg_imbalance_i(cfg_i.cop4.imbalance),
    .in_valid_i(frame_valid), .in_ready_o(frame_ready), .in_e1_i(e1), .in_e2_i(e2), .in_e3_i(e3),
    .in_e4_i(e4),
    .out_valid_o(found_valid), .out_ready_i(found_ready), .out_x_o(x), .out_y_o(y), .out_load_o(load),
    .out_pressed_o(cop_o.pressed), .out_over_o(unused_over), .out_saturated_o(unused_saturated),
    .out_imbalance_o(unused_imbalance), .out_open_o(unused_open)
  );
  assign cop_valid_o = found_valid && found_ready;
  assign cop_o.x     = 24'(x);
  assign cop_o.y     = 24'(y);
  assign cop_o.load  = 40'(load);

  if (CopSlip) begin : gen_cop_slip
    logic signed [16:0] unused_dx, unused_dy;
    logic               unused_over_load, slips, pressed;
    logic        [2:0]  octant;
    msn_cop_slip #(.Lag(Lag)) u_cop_slip (
      .clk_i, .rst_i,
      .cfg_drop_i(cfg_i.cop_slip.drop), .cfg_move_i(cfg_i.cop_slip.move),
      .cfg_min_load_i(cfg_i.cop_slip.min_load), .cfg_hold_i(cfg_i.cop_slip.hold),
      .cfg_refractory_i(cfg_i.cop_slip.refractory),
      .in_valid_i(found_valid), .in_ready_o(found_ready), .in_x_i(x), .in_y_i(y), .in_load_i(load),
      .in_pressed_i(cop_o.pressed),
      .out_valid_o(decision_valid_o), .out_ready_i(decision_ready_i), .out_slip_o(slips),
      .out_raised_o(decision_o.raised), .out_over_o(unused_over_load), .out_pressed_o(pressed),
      .out_dx_o(unused_dx), .out_dy_o(unused_dy), .out_octant_o(octant)
    );
    assign decision_o.last  = 1'b1;
    assign decision_o.state = slips ? msn_pkg::Incipient : pressed ? msn_pkg::Contact : msn_pkg::None;
    assign decision_o.p2p   = 24'(octant);
    assign decision_o.id    = '1;
  end else begin : gen_no_cop_slip
    assign found_ready = 1'b1;
    assign {decision_valid_o, decision_o} = '0;
  end

  // A damaged frame gives no result: the change of its counter shows it.
  logic damaged_q, done;
  always_ff @(posedge clk_i) damaged_q <= rst_i ? 1'b0 : damaged[0];
  assign done = damaged[0] != damaged_q || (CopSlip ? decision_valid_o && decision_ready_i : cop_valid_o);
  msn_frame_owed #(.Results(1)) u_owed (
    .clk_i, .rst_i,
    .taken_i(sample_valid && sample_ready), .first_i(sample_first), .done_i(done), .drop_i(1'b0),
    .quiet_i(!(frame_valid || found_valid || decision_valid_o)), .busy_o(owed)
  );

endmodule
