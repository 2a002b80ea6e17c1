// SPDX-License-Identifier: Apache-2.0
//
// Commands for a hand whose fingers are the core's channels, as words and pulses, from slip decisions and speeds.
//
//   samples ─ finger_health ─┐
//   the forest's decisions ──┤
//   decisions ───────────────┴─ grip ─┬─ words
//                                     └─ pwm (mode force) ─ pulses
//
// Grip = 0: no logic is built. cfg_i.enable = 0: everything but the counters is in reset. When the converter misses a
// frame or answers for another channel, all fingers are unhealthy in that cycle: the affected finger is not known.
// A decision of the forest for a class of slip marks the next detail of every finger as over. Single: an array has one
// finger, and each decision of the forest is a window of it; its samples are not judged.
// A word leaves 4 clocks after the decision (msn_grip). Model: model/meissner/twins/actuate/actuate.py

module msn_actuate #(
  parameter  bit          Grip       = 1'b1,
  parameter  bit          Suits      = 1'b1,  // the core decides slip of single channels and has registers
  parameter  bit          Single     = 1'b0,
  parameter  int unsigned Fingers    = 2,
  parameter  int unsigned SampleBits = 17,
  localparam int unsigned IdBits     = msn_pkg::index_width(Fingers)
) (
  input  logic                            clk_i,
  input  logic                            rst_i,

  input  msn_registers_pkg::grip_cfg_t    cfg_i,
  output msn_registers_pkg::grip_status_t status_o,

  input  logic                            sample_valid_i,  // the samples that the slip path takes
  input  logic signed [SampleBits-1:0]    sample_data_i,
  input  logic        [IdBits-1:0]        sample_id_i,
  input  msn_registers_pkg::adc_status_t  adc_i,           // the converter's counters
  input  msn_pkg::verdict_t               verdict_i,
  input  msn_pkg::shear_t                 shear_i,         // of the fingers' rubber
  input  logic                            decided_i,       // the forest, for one clock
  input  logic                            slips_i,         // for a class of slip

  output logic                            grip_valid_o,    // for one clock
  output logic signed [16:0]              grip_word_o,     // increment of a position, or force: cfg_i.mode
  output logic                            pwm_o
);

  if (Grip && !Suits) begin : gen_check_suits
    $fatal(1, "msn_actuate: Grip = 1 must go with Slip and Registers, without Serial, with an array Forest");
  end

  if (Grip) begin : gen_grip
    logic rst, lost, timeout_q, mistagged_q;
    assign rst  = rst_i || !cfg_i.enable;
    assign lost = adc_i.timeout[0] != timeout_q || adc_i.mistagged[0] != mistagged_q;
    always_ff @(posedge clk_i) begin
      timeout_q   <= !rst_i && adc_i.timeout[0];
      mistagged_q <= !rst_i && adc_i.mistagged[0];
    end

    logic [Fingers-1:0] healthy, faulty;
    msn_finger_health #(.Fingers(Fingers), .SampleBits(SampleBits)) u_finger_health (
      .clk_i, .rst_i(rst),
      .cfg_low_i(signed'(cfg_i.low)), .cfg_high_i(signed'(cfg_i.high)), .cfg_rail_i(cfg_i.rail),
      .in_valid_i(sample_valid_i), .in_data_i(sample_data_i), .in_id_i(sample_id_i), .lost_i(lost),
      .healthy_o(healthy)
    );

    logic               over_valid, over, over_end;
    logic [IdBits-1:0]  over_id;
    logic [Fingers-1:0] marked;
    always_comb begin
      {over_valid, over, over_end, over_id} = {decided_i, slips_i, 1'b1, IdBits'(0)};
      if (!Single) begin
        over_valid = verdict_i.valid;
        over_id    = verdict_i.id[IdBits-1:0];
        over_end   = verdict_i.last;
        over       = verdict_i.over;
        for (int unsigned f = 0; f < Fingers; f++) over |= marked[f] && over_id == IdBits'(f);
      end
    end
    always_ff @(posedge clk_i) begin
      for (int unsigned f = 0; f < Fingers; f++) begin
        if (over_valid && over_id == IdBits'(f)) marked[f] <= 1'b0;
      end
      if (decided_i && slips_i) marked <= '1;
      if (rst) marked <= '0;
    end

    logic signed [16:0] increment;
    logic        [15:0] command;
    logic               is_force;
    logic        [4:0]  fault;
    msn_grip #(.Fingers(Fingers)) u_grip (
      .clk_i, .rst_i(rst),
      .cfg_period_i(cfg_i.period), .cfg_step_i(cfg_i.step), .cfg_speed_gain_i(cfg_i.speed_gain),
      .cfg_boost_i(cfg_i.boost), .cfg_decay_i(cfg_i.decay),
      .cfg_minimum_i(cfg_i.minimum), .cfg_maximum_i(cfg_i.maximum), .cfg_rate_i(cfg_i.rate),
      .cfg_watchdog_i(cfg_i.watchdog), .cfg_rule_i(cfg_i.rule), .cfg_mode_i(cfg_i.mode),
      .cfg_immediate_i(cfg_i.immediate), .cfg_override_i(cfg_i.override_),
      .cfg_override_value_i(cfg_i.override_value),
      .over_valid_i(over_valid), .over_id_i(over_id), .over_i(over), .over_end_i(over_end),
      .speed_valid_i(shear_i.valid), .speed_id_i(shear_i.id[IdBits-1:0]), .speed_ok_i(shear_i.ok),
      .speed_i(shear_i.speed),
      .healthy_i(healthy),
      .out_valid_o(grip_valid_o), .out_word_o(grip_word_o), .out_increment_o(increment),
      .out_command_o(command), .out_force_o(is_force), .fault_o(fault), .faulty_o(faulty)
    );
    logic        tightened;
    logic [31:0] commands, tightenings;
    assign tightened = grip_valid_o && increment > 0;
    always_ff @(posedge clk_i) begin
      commands    <= commands + 32'(grip_valid_o);
      tightenings <= tightenings + 32'(tightened);
      if (rst_i) begin
        commands    <= '0;
        tightenings <= '0;
      end
    end
    assign status_o = {command, increment, fault, 8'(faulty), commands, tightenings};

    logic unused_begin;
    msn_pwm u_pwm (
      .clk_i, .rst_i(rst),
      .cfg_divide_i(cfg_i.divide),
      .in_valid_i(grip_valid_o && is_force), .in_data_i(command),
      .pwm_o, .begin_o(unused_begin)
    );
    logic unused;
    assign unused = ^{adc_i, verdict_i, shear_i.id, marked};
  end else begin : gen_none
    assign {status_o, grip_valid_o, grip_word_o, pwm_o} = '0;
    logic unused;
    assign unused = ^{clk_i, rst_i, cfg_i, sample_valid_i, sample_data_i, sample_id_i, adc_i, verdict_i,
                      shear_i, decided_i, slips_i};
  end

endmodule
