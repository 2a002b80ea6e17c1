// SPDX-License-Identifier: Apache-2.0
//
// The slip path: samples to slip decisions about each channel. Instances and wires only, in data-path order.
//
//   samples ─ frame_filter ─ haar ─ peak_to_peak ─ slip ─ decisions
//
// Whole frames come in, channels in order, `last` on the final one. Decision Level + 5 clocks after the sample that
// completes a group with tumbling windows, Level + 7 with a sliding one of 64. Serial: one block in place of the four,
// the same decisions 2*Steps + 2 clocks after (msn_slip_serial).
// Error: none.
// Model: model/meissner/twins/slip/slip_path.py

module msn_slip_path #(
  parameter  int unsigned Channels   = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Level      = 1,   // Haar level
  parameter  int unsigned Window     = 64,  // samples
  parameter  int unsigned Hop        = 64,  // samples
  parameter  int unsigned TimerBits  = 16,
  parameter  bit          Mask       = 1'b0,  // of the samples: a masked sample raises no slip
  parameter  bit          Serial     = 1'b0,  // one channel, two bits a clock: a third of the cells
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels),
  localparam int unsigned DetailBits = SampleBits + Level
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

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

  output logic                         busy_o,        // a sample, detail or decision is inside
  output logic        [31:0]           damaged_o,     // frames: channels out of order
  output logic        [31:0]           blanked_o      // details: over, but blanked or moving
);

  localparam int unsigned Group = 1 << Level;  // samples in a detail
  if (Window < 2 * Group || !msn_pkg::is_power(Window)) begin : gen_check_window
    $fatal(1, "msn_slip_path: Window = %0d must be a power of two, %0d or more", Window, 2 * Group);
  end
  if (Hop < Group || Hop > Window || Hop % Group != 0) begin : gen_check_hop
    $fatal(1, "msn_slip_path: Hop = %0d must be a multiple of %0d up to Window", Hop, Group);
  end
  if (DetailBits > 20) begin : gen_check_detail_bits
    $fatal(1, "msn_slip_path: SampleBits = %0d must be at most %0d", SampleBits, 20 - Level);
  end
  if (TimerBits > 16) begin : gen_check_timer_bits
    $fatal(1, "msn_slip_path: TimerBits = %0d must be at most 16", TimerBits);
  end
  if (Mask && Serial) begin : gen_check_mask
    $fatal(1, "msn_slip_path: Mask = 1 must have Serial = 0");
  end
  if (Serial && (Channels != 1 || Hop != Window)) begin : gen_check_serial
    $fatal(1, "msn_slip_path: Serial = 1 must have Channels = 1 and Hop = Window");
  end

  // The settings, in the widths of this build.
  logic        [DetailBits-1:0] threshold, gross_threshold, keep_threshold;
  logic signed [DetailBits-1:0] contact_level, release_level;
  logic        [TimerBits-1:0]  hold, refractory, blank;
  assign threshold       = DetailBits'(cfg_i.threshold);
  assign gross_threshold = DetailBits'(cfg_i.gross_threshold);
  assign keep_threshold  = DetailBits'(cfg_i.keep_threshold);
  assign contact_level   = signed'(DetailBits'(cfg_i.contact_level));
  assign release_level   = signed'(DetailBits'(cfg_i.release_level));
  assign hold            = TimerBits'(cfg_i.hold);
  assign refractory      = TimerBits'(cfg_i.refractory);
  assign blank           = TimerBits'(cfg_i.blank);
  logic unused_cfg;
  assign unused_cfg = ^cfg_i;

  if (Serial) begin : gen_serial
    assign out_id_o   = '0;
    assign out_last_o = 1'b1;
    logic unused_mask;
    assign unused_mask = in_mask_i;
    msn_slip_serial #(
      .SampleBits(SampleBits), .Level(Level), .Window(Window), .TimerBits(TimerBits)
    ) u_slip (
      .clk_i, .rst_i,
      .cfg_threshold_i(threshold), .cfg_gross_threshold_i(gross_threshold),
      .cfg_contact_level_i(contact_level), .cfg_release_level_i(release_level),
      .cfg_contact_rises_i(cfg_i.contact_rises), .cfg_hold_i(hold), .cfg_refractory_i(refractory),
      .cfg_blank_i(blank), .cfg_keep_threshold_i(keep_threshold),
      .actuator_moving_i,
      .in_valid_i, .in_ready_o, .in_data_i, .in_id_i(in_id_i[0]), .in_last_i,
      .out_valid_o, .out_ready_i, .out_state_o, .out_raised_o, .out_over_o, .out_p2p_o, .out_end_o,
      .busy_o, .damaged_o, .blanked_o
    );

  end else begin : gen_parallel
    logic                         whole_valid, whole_ready, whole_last, whole_restart;
    logic signed [SampleBits-1:0] whole;
    logic        [IdBits-1:0]     whole_id;
    logic whole_mask, detail_mask, window_mask;
    logic haar_busy, extremes_busy, slip_busy;
    assign busy_o = whole_valid || haar_busy || extremes_busy || slip_busy;
    msn_frame_filter #(.Channels(Channels), .DataBits(SampleBits + 1)) u_frame_filter (
      .clk_i, .rst_i,
      .in_valid_i, .in_ready_o, .in_data_i({Mask && in_mask_i, in_data_i}), .in_id_i, .in_last_i,
      .out_valid_o(whole_valid), .out_ready_i(whole_ready), .out_data_o({whole_mask, whole}),
      .out_id_o(whole_id), .out_last_o(whole_last), .out_restart_o(whole_restart),
      .damaged_o
    );

    logic                         detail_valid, detail_ready, detail_last, detail_restart;
    logic signed [DetailBits-1:0] detail, detail_total;
    logic        [IdBits-1:0]     detail_id;
    msn_haar #(
      .Channels(Channels), .SampleBits(SampleBits), .Level(Level), .Mask(Mask)
    ) u_haar (
      .clk_i, .rst_i,
      .in_valid_i(whole_valid), .in_ready_o(whole_ready), .in_data_i(whole), .in_id_i(whole_id),
      .in_last_i(whole_last), .in_restart_i(whole_restart), .in_mask_i(whole_mask),
      .out_valid_o(detail_valid), .out_ready_i(detail_ready), .out_detail_o(detail),
      .out_total_o(detail_total), .out_id_o(detail_id), .out_last_o(detail_last),
      .out_restart_o(detail_restart), .out_mask_o(detail_mask),
      .busy_o(haar_busy)
    );

    logic                         window_valid, window_ready, window_last, window_restart, window_end;
    logic        [DetailBits-1:0] window_p2p;
    logic signed [DetailBits-1:0] window_total;
    logic        [IdBits-1:0]     window_id;
    msn_peak_to_peak #(
      .Channels(Channels), .DetailBits(DetailBits), .Span(Window / Group), .Hop(Hop / Group), .Mask(Mask)
    ) u_peak_to_peak (
      .clk_i, .rst_i,
      .in_valid_i(detail_valid), .in_ready_o(detail_ready), .in_detail_i(detail), .in_total_i(detail_total),
      .in_id_i(detail_id), .in_last_i(detail_last), .in_restart_i(detail_restart), .in_mask_i(detail_mask),
      .out_valid_o(window_valid), .out_ready_i(window_ready), .out_p2p_o(window_p2p),
      .out_total_o(window_total), .out_id_o(window_id), .out_last_o(window_last),
      .out_restart_o(window_restart), .out_mask_o(window_mask), .out_end_o(window_end),
      .busy_o(extremes_busy)
    );

    msn_slip #(
      .Channels(Channels), .DetailBits(DetailBits), .TimerBits(TimerBits), .Mask(Mask)
    ) u_slip (
      .clk_i, .rst_i,
      .cfg_threshold_i(threshold), .cfg_gross_threshold_i(gross_threshold),
      .cfg_contact_level_i(contact_level), .cfg_release_level_i(release_level),
      .cfg_contact_rises_i(cfg_i.contact_rises), .cfg_hold_i(hold), .cfg_refractory_i(refractory),
      .cfg_blank_i(blank), .cfg_keep_threshold_i(keep_threshold),
      .actuator_moving_i,
      .in_valid_i(window_valid), .in_ready_o(window_ready), .in_p2p_i(window_p2p), .in_total_i(window_total),
      .in_id_i(window_id), .in_last_i(window_last), .in_restart_i(window_restart), .in_mask_i(window_mask),
      .in_end_i(window_end),
      .out_valid_o, .out_ready_i, .out_state_o, .out_raised_o, .out_over_o, .out_p2p_o, .out_id_o,
      .out_last_o, .out_end_o,
      .busy_o(slip_busy), .blanked_o
    );
  end

endmodule
