// SPDX-License-Identifier: Apache-2.0
//
// Conditions an array's samples before calibration: msn_health masks taxels that cannot be trusted, msn_tare
// subtracts the taxels' zeros. Instances and wires only.
//
//   samples ─ health (Health) ─ skid (both, several lanes) ─ tare, skid (Tare) ─ samples
//
// A stage left out is wires: its settings have no effect, its results are 0. With Tare, samples are one bit wider.
// Latency 1 clock a stage. Model: model/meissner/twins/frontend/condition.py

module msn_condition #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          Health     = 1'b1,
  parameter  bit          Tare       = 1'b1,
  parameter  int unsigned TareLog2   = 4,
  localparam int unsigned ZeroedBits = Tare ? SampleBits + 1 : SampleBits,
  localparam int unsigned IdBits     = msn_pkg::index_width(Rows * ((Columns + Lanes - 1) / Lanes)),
  localparam int unsigned CountBits  = msn_pkg::index_width(Rows * Columns + 1)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic [SampleBits-1:0]        cfg_band_i,         // msn_health
  input  logic [SampleBits-1:0]        cfg_jump_i,
  input  logic signed [SampleBits-1:0] cfg_low_i,
  input  logic signed [SampleBits-1:0] cfg_high_i,
  input  logic                         cfg_over_range_enable_i,
  input  logic                         cfg_edges_i,
  input  logic [7:0]                   cfg_still_i,
  input  logic [7:0]                   cfg_rail_i,
  input  logic [7:0]                   cfg_blink_i,
  input  logic                         cfg_clear_i,
  input  logic                         cfg_report_i,

  input  logic [SampleBits-1:0]        cfg_contact_i,      // msn_tare
  input  logic [7:0]                   cfg_step_i,
  input  logic                         cfg_tare_i,
  input  logic                         cfg_force_i,
  input  logic                         cfg_load_i,
  input  logic [Lanes-1:0]             cfg_zero_write_i,
  input  logic [IdBits-1:0]            cfg_zero_word_i,
  input  logic [SampleBits-1:0]        cfg_zero_i,
  output logic                         cfg_loading_o,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic [Lanes*SampleBits-1:0]  in_data_i,
  input  logic [Lanes-1:0]             in_user_i,          // over-range
  input  logic [IdBits-1:0]            in_id_i,
  input  logic                         in_fits_i,          // marks of msn_frame_marker
  input  logic                         in_row_last_i,
  input  logic                         in_last_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic [Lanes*ZeroedBits-1:0]  out_data_o,
  output logic [Lanes-1:0]             out_mask_o,
  output logic                         out_fits_o,
  output logic                         out_row_last_o,
  output logic                         out_last_o,

  output logic                         event_valid_o,      // msn_health
  input  logic                         event_ready_i,
  output logic [IdBits-1:0]            event_id_o,
  output logic [Lanes-1:0]             event_dead_o,
  output logic [Lanes-1:0]             event_railed_o,
  output logic [Lanes-1:0]             event_blinking_o,
  output logic [CountBits-1:0]         dead_o,
  output logic [CountBits-1:0]         railed_o,
  output logic [CountBits-1:0]         blinking_o,

  output logic                         taring_o,           // msn_tare
  output logic                         pressed_o,
  output logic [15:0]                  tared_o,
  output logic [15:0]                  refused_o,
  output logic [31:0]                  swallowed_o         // frames dropped while zeros are loaded
);

  // The skid between the two cuts the path of ready from tare to the states of health.
  localparam bit Skid = Lanes > 1 && Health && Tare;
  logic                        seen_valid, seen_ready, checked_valid, checked_ready;
  logic [Lanes*SampleBits-1:0] seen_data, checked_data;
  logic [Lanes-1:0]            seen_mask, checked_mask;
  logic [IdBits-1:0]           seen_id, checked_id;
  logic [2:0]                  seen_marks, checked_marks;
  if (Health) begin : gen_health
    msn_health #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits)) u_health (
      .clk_i, .rst_i,
      .cfg_band_i, .cfg_jump_i, .cfg_low_i, .cfg_high_i, .cfg_over_range_enable_i, .cfg_edges_i, .cfg_still_i,
      .cfg_rail_i,
      .cfg_blink_i, .cfg_clear_i, .cfg_report_i,
      .in_valid_i, .in_ready_o, .in_data_i, .in_user_i, .in_id_i, .in_fits_i, .in_row_last_i, .in_last_i,
      .out_valid_o(seen_valid), .out_ready_i(seen_ready), .out_data_o(seen_data), .out_mask_o(seen_mask),
      .out_id_o(seen_id), .out_fits_o(seen_marks[2]), .out_row_last_o(seen_marks[1]),
      .out_last_o(seen_marks[0]),
      .event_valid_o, .event_ready_i, .event_id_o, .event_dead_o, .event_railed_o, .event_blinking_o,
      .dead_o, .railed_o, .blinking_o
    );
  end else begin : gen_no_health
    assign {seen_valid, in_ready_o, seen_data, seen_id} = {in_valid_i, seen_ready, in_data_i, in_id_i};
    assign {seen_mask, seen_marks} = {Lanes'(0), in_fits_i, in_row_last_i, in_last_i};
    assign {event_valid_o, event_id_o, event_dead_o, event_railed_o, event_blinking_o} = '0;
    assign {dead_o, railed_o, blinking_o} = '0;
    logic unused_health;
    assign unused_health = ^{cfg_band_i, cfg_jump_i, cfg_low_i, cfg_high_i, cfg_over_range_enable_i,
                             cfg_edges_i, cfg_still_i, cfg_rail_i, cfg_blink_i, cfg_clear_i, cfg_report_i,
                             event_ready_i, in_user_i};
  end

  if (Skid) begin : gen_skid
    msn_skid #(.Width(Lanes * (SampleBits + 1) + IdBits + 3)) u_skid (
      .clk_i, .rst_i,
      .in_valid_i(seen_valid), .in_ready_o(seen_ready),
      .in_data_i({seen_data, seen_mask, seen_id, seen_marks}),
      .out_valid_o(checked_valid), .out_ready_i(checked_ready),
      .out_data_o({checked_data, checked_mask, checked_id, checked_marks})
    );
  end else begin : gen_no_skid
    assign {checked_valid, seen_ready}  = {seen_valid, checked_ready};
    assign {checked_data, checked_mask} = {seen_data, seen_mask};
    assign {checked_id, checked_marks}  = {seen_id, seen_marks};
  end

  if (Tare) begin : gen_tare
    logic                        tared_valid, tared_ready;
    logic [Lanes*ZeroedBits-1:0] tared_data;
    logic [Lanes-1:0]            tared_mask;
    logic [IdBits-1:0]           unused_id;  // the blocks downstream do not need it
    logic [2:0]                  tared_marks;
    msn_tare #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .TareLog2(TareLog2)
    ) u_tare (
      .clk_i, .rst_i,
      .cfg_contact_i, .cfg_step_i, .cfg_tare_i, .cfg_force_i, .cfg_load_i, .cfg_write_i(cfg_zero_write_i),
      .cfg_word_i(cfg_zero_word_i), .cfg_offset_i(cfg_zero_i), .cfg_loading_o,
      .taring_o, .pressed_o, .tared_o, .refused_o, .swallowed_o,
      .in_valid_i(checked_valid), .in_ready_o(checked_ready), .in_data_i(checked_data),
      .in_mask_i(checked_mask), .in_id_i(checked_id), .in_fits_i(checked_marks[2]),
      .in_row_last_i(checked_marks[1]), .in_last_i(checked_marks[0]),
      .out_valid_o(tared_valid), .out_ready_i(tared_ready), .out_data_o(tared_data), .out_mask_o(tared_mask),
      .out_id_o(unused_id), .out_fits_o(tared_marks[2]), .out_row_last_o(tared_marks[1]),
      .out_last_o(tared_marks[0])
    );
    // This skid cuts the path of ready from the blocks downstream to the samples' source.
    msn_skid #(.Width(Lanes * (ZeroedBits + 1) + 3)) u_skid (
      .clk_i, .rst_i,
      .in_valid_i(tared_valid), .in_ready_o(tared_ready), .in_data_i({tared_data, tared_mask, tared_marks}),
      .out_valid_o, .out_ready_i,
      .out_data_o({out_data_o, out_mask_o, out_fits_o, out_row_last_o, out_last_o})
    );
  end else begin : gen_no_tare
    assign {out_valid_o, checked_ready}             = {checked_valid, out_ready_i};
    assign {out_data_o, out_mask_o}                 = {checked_data, checked_mask};
    assign {out_fits_o, out_row_last_o, out_last_o} = checked_marks;
    assign {cfg_loading_o, taring_o, pressed_o, tared_o, refused_o, swallowed_o} = '0;
    logic unused_tare;
    assign unused_tare = ^{clk_i, rst_i, cfg_contact_i, cfg_step_i, cfg_tare_i, cfg_force_i, cfg_load_i,
                           cfg_zero_write_i, cfg_zero_word_i, cfg_zero_i, checked_id};
  end

endmodule
