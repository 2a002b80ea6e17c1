// SPDX-License-Identifier: Apache-2.0
//
// Speed of shear of each channel of a core, in parallel to the slip path, which gets the same samples.
//
//   samples ─┬─ frame_filter ─ shear_speed (one a channel) ─ status, reports to the grip reflex
//            └─ samples, to the slip path
//
// A sample is taken by both or by neither: while a channel's window is processed, its next sample waits. A window is
// held if actuator_moving_i is high, cfg_i.hold = 1, or the reflex's command has changed in the last cfg_i.hold_cycles
// control cycles, as the normal force may change then; without a command (the reflex is off, or unarmed) it does not
// change. cfg_i.enable = 0: all is in reset, and samples pass.
// A window's report follows its last sample by 60 clocks; samples arrive one a clock at most, so do reports.
// ShearSpeed = 0: no logic is built.
// Model: model/meissner/twins/slip/shear_speeds.py

module msn_shear_speeds #(
  parameter  bit          ShearSpeed = 1'b1,
  parameter  bit          Suits      = 1'b1,  // the core decides slip of single channels and has registers
  parameter  int unsigned Channels   = 2,
  parameter  int unsigned SampleBits = 17,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input  logic                                   clk_i,
  input  logic                                   rst_i,

  input  msn_registers_pkg::shear_speed_cfg_t    cfg_i,
  output msn_registers_pkg::shear_speed_status_t status_o,
  input  logic                                   actuator_moving_i,  // a pin
  input  logic                                   grip_valid_i,       // msn_actuate's, with its status
  input  msn_registers_pkg::grip_status_t        grip_i,

  input  logic                                   in_valid_i,
  output logic                                   in_ready_o,
  input  logic signed [SampleBits-1:0]           in_data_i,
  input  logic        [IdBits-1:0]               in_id_i,
  input  logic                                   in_last_i,

  output logic                                   out_valid_o,        // the same samples
  input  logic                                   out_ready_i,

  output msn_pkg::shear_t                        report_o            // for one clock, after each window
);

  if (ShearSpeed && !Suits) begin : gen_check_suits
    $fatal(1, "msn_shear_speeds: ShearSpeed = 1 must go with Slip and Registers, without Array and Serial");
  end
  if (ShearSpeed && (Channels > 8 || SampleBits != 17)) begin : gen_check_channels
    $fatal(1, "msn_shear_speeds: Channels = %0d must lie in 1 .. 8, and samples have 17 bits", Channels);
  end

  if (ShearSpeed) begin : gen_shear_speed
    localparam int unsigned LevelBits = 26;  // of the registers: 17 bits, windows of 64, Vi of 8
    localparam int unsigned Unarmed   = 4;   // bit of the reflex's fault: it has given no command
    logic rst;
    assign rst = rst_i || !cfg_i.enable;

    // hold: the normal force may change.
    logic       moving, hold;
    logic [7:0] cycles;  // control cycles since the last change of the command, at most 255
    msn_sync u_moving (
      .clk_i, .in_data_i(actuator_moving_i), .out_data_o(moving)
    );
    assign hold = moving || cfg_i.hold || cycles < cfg_i.hold_cycles;
    always_ff @(posedge clk_i) begin
      if (grip_valid_i) cycles <= grip_i.increment != '0 ? '0 : cycles + 8'(cycles != '1);
      if (rst || grip_i.fault[Unarmed]) cycles <= '1;
    end

    // Each sample goes to both paths together. Damaged frames are discarded, as in the slip path.
    logic                         room, sample_valid, sample_ready, unused_last, restart;
    logic signed [SampleBits-1:0] sample;
    logic        [IdBits-1:0]     sample_id;
    logic        [31:0]           unused_damaged;
    assign in_ready_o  = out_ready_i && room;
    assign out_valid_o = in_valid_i && room;
    msn_frame_filter #(.Channels(Channels), .DataBits(SampleBits)) u_frame_filter (
      .clk_i, .rst_i(rst),
      .in_valid_i(in_valid_i && out_ready_i), .in_ready_o(room), .in_data_i(in_data_i), .in_id_i, .in_last_i,
      .out_valid_o(sample_valid), .out_ready_i(sample_ready), .out_data_o(sample), .out_id_o(sample_id),
      .out_last_o(unused_last), .out_restart_o(restart),
      .damaged_o(unused_damaged)
    );

    localparam int unsigned PairBits = 2 * LevelBits + 1;  // Vi and rise
    localparam int unsigned WordBits = 32 + PairBits;      // of a report: speed, flags, Vi, rise
    logic [Channels-1:0]          ready, found;
    logic [WordBits*Channels-1:0] words;
    always_comb begin
      sample_ready = 1'b0;
      for (int unsigned c = 0; c < Channels; c++) sample_ready |= sample_id == IdBits'(c) && ready[c];
    end
    for (genvar c = 0; c < Channels; c++) begin : gen_channel
      logic        [23:0]          speed;
      logic        [7:0]           flags;
      logic signed [LevelBits-1:0] vi;
      logic signed [LevelBits:0]   rise;
      msn_shear_speed #(.SampleBits(SampleBits)) u_shear_speed (
        .clk_i, .rst_i(rst),
        .cfg_k0_i(cfg_i.k0), .cfg_k1_i(signed'(cfg_i.k1)), .cfg_exponent_i(cfg_i.exponent),
        .cfg_vi_min_i(signed'(cfg_i.vi_min)), .cfg_vi_max_i(signed'(cfg_i.vi_max)), .cfg_noise_i(cfg_i.noise),
        .cfg_still_i(cfg_i.still), .cfg_full_i(signed'(cfg_i.full)), .cfg_limit_i(cfg_i.limit),
        .cfg_travel_i(cfg_i.travel),
        .in_valid_i(sample_valid && sample_id == IdBits'(c)), .in_ready_o(ready[c]), .in_data_i(sample),
        .in_hold_i(hold), .in_restart_i(restart),
        .out_valid_o(found[c]), .out_ready_i(1'b1), .out_speed_o(speed), .out_flags_o(flags),
        .out_vi_o(vi), .out_rise_o(rise)
      );
      assign words[WordBits*c+:WordBits] = {speed, flags, vi, rise};
    end

    // At most one report a clock; the registers keep the last report of each channel.
    logic [WordBits-1:0] word;
    logic [2:0]          id;
    always_comb begin
      word = '0;
      id   = '0;
      for (int unsigned c = 0; c < Channels; c++) begin
        if (found[c]) begin
          word = words[WordBits*c+:WordBits];
          id   = 3'(c);
        end
      end
    end
    logic [23:0]           speed;
    logic [7:0]            flags;
    logic [PairBits-1:0]   pair;
    logic [8*32-1:0]       last;  // channel 0 highest, as in status_o
    logic [8*32-1:0]       windows;
    logic [8*PairBits-1:0] pairs;
    assign {speed, flags, pair} = word;
    always_ff @(posedge clk_i) begin
      report_o <= {found != '0, flags == '0, id, speed[23:8]};
      for (int unsigned c = 0; c < Channels; c++) begin
        if (found[c]) begin
          last[32*(7-c)+:32]           <= {speed, flags};
          pairs[PairBits*c+:PairBits]  <= pair;
          windows[32*c+:32]            <= windows[32*c+:32] + 1'b1;
        end
      end
      if (rst) begin
        report_o.valid   <= 1'b0;
        last             <= {8{32'd1}};  // unsettled
        {pairs, windows} <= '0;
      end
    end
    assign status_o = {last, pairs[PairBits*cfg_i.select+:PairBits], windows[32*cfg_i.select+:32]};

    logic unused;
    assign unused = ^grip_i;
  end else begin : gen_none
    assign {in_ready_o, out_valid_o} = {out_ready_i, in_valid_i};
    assign {status_o, report_o}      = '0;
    logic unused;
    assign unused = ^{clk_i, rst_i, cfg_i, actuator_moving_i, grip_valid_i, grip_i, in_data_i, in_id_i,
                      in_last_i};
  end

endmodule
