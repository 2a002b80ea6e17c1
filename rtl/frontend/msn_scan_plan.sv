// SPDX-License-Identifier: Apache-2.0
//
// When a matrix is switched to which row and column group, and when the converters start.
//
//   clock  s          s+1          s+2            s+1+Settle   then, slot = Settle + 1 + gap clocks after s,
//          switch_o   lines off    lines settle   trigger_o    the next switch; gap = max(Hold, Cycle-1-Settle)
//
// Frames start every cfg_period_i clocks (0: one after the other) and convert the rows and groups of a region, row
// by row or, cfg_interleave_i, every second row first. Slip rounds start exactly every cfg_slip_period_i clocks (0:
// never) and convert SlipSlots places; the frame (msn_scan_walk) gets only slots that end before the next begins.
// Settle, periods and slip places are taken while off, region and order as a frame starts; a region is cut to the
// array. cfg_enable_i low: off after the frame.   Model: model/meissner/twins/frontend/scan_plan.py

module msn_scan_plan #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,    // converters side by side: columns in a beat
  parameter  int unsigned Channels   = 8,    // beats of one conversion
  parameter  int unsigned Hold       = 2,    // clocks from trigger_o in which the lines may not change
  parameter  int unsigned Cycle      = 268,  // clocks from trigger_o to trigger_o that the converters need
  parameter  int unsigned SlipSlots  = 1,
  parameter  int unsigned SettleBits = 16,
  parameter  int unsigned PeriodBits = 32,
  localparam int unsigned RowBits    = msn_pkg::index_width(Rows),
  localparam int unsigned ColumnBits = msn_pkg::index_width(Columns),
  localparam int unsigned Beats      = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned BeatBits   = msn_pkg::index_width(Beats),
  localparam int unsigned Groups     = (Beats + Channels - 1) / Channels,
  parameter  int unsigned GroupBits  = msn_pkg::index_width(Groups),  // more: places beside the array
  localparam int unsigned SlotBits   = msn_pkg::index_width(SlipSlots)
) (
  input  logic                               clk_i,
  input  logic                               rst_i,

  input  logic                               cfg_enable_i,
  input  logic [SettleBits-1:0]              cfg_settle_i,  // clocks from the lines to convert start
  input  logic [PeriodBits-1:0]              cfg_period_i,
  input  logic                               cfg_interleave_i,
  input  logic [RowBits-1:0]                 cfg_first_row_i,
  input  logic [RowBits-1:0]                 cfg_last_row_i,
  input  logic [ColumnBits-1:0]              cfg_first_column_i,
  input  logic [ColumnBits-1:0]              cfg_last_column_i,
  input  logic [PeriodBits-1:0]              cfg_slip_period_i,
  input  logic [SlipSlots*(RowBits+1)-1:0]   cfg_slip_row_i,  // slot 0 lowest; Rows or more: no row is driven
  input  logic [SlipSlots*GroupBits-1:0]     cfg_slip_group_i,

  input  logic                               room_i,        // the frame's buffer has room for a conversion

  output logic                               idle_o,        // nothing to do: no line
  output logic                               switch_o,
  output logic [RowBits:0]                   switch_row_o,  // Rows or more: none
  output logic [GroupBits-1:0]               switch_group_o,
  output logic                               trigger_o,

  // Of the conversion triggered last, from the clock after trigger_o on.
  output logic                               done_slip_o,   // it belongs to a slip round, not to a frame
  output logic                               done_first_o,  // of its frame or round
  output logic [GroupBits-1:0]               done_group_o,
  // Of the frame it belongs to.
  output logic [RowBits-1:0]                 frame_first_row_o,
  output logic [RowBits-1:0]                 frame_last_row_o,
  output logic [BeatBits-1:0]                frame_first_beat_o,
  output logic [BeatBits-1:0]                frame_last_beat_o,
  output logic                               frame_interleave_o,

  output logic [31:0]                        overrun_o,       // frame ticks: the frame before was not done
  output logic [31:0]                        slip_overrun_o,  // rounds left out: one did not fit its period
  output logic [31:0]                        held_o           // clocks for which the frame waited for room
);

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_scan_plan: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_scan_plan: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_scan_plan: Lanes = %0d must be 1, 2, 4 or 8", Lanes);
  end
  if (Channels < 1 || Channels > 8) begin : gen_check_channels
    $fatal(1, "msn_scan_plan: Channels = %0d must lie in 1 .. 8", Channels);
  end
  if (Groups > 1 && !msn_pkg::is_power(Channels)) begin : gen_check_groups
    $fatal(1, "msn_scan_plan: Channels = %0d must be 1, 2, 4 or 8 for %0d groups", Channels, Groups);
  end
  if (Hold < 2) begin : gen_check_hold
    $fatal(1, "msn_scan_plan: Hold = %0d must be at least 2", Hold);
  end
  if (Cycle < Channels + 8) begin : gen_check_cycle
    $fatal(1, "msn_scan_plan: Cycle = %0d must be at least Channels + 8", Cycle);
  end
  if (SlipSlots < 1 || SlipSlots > 16) begin : gen_check_slip_slots
    $fatal(1, "msn_scan_plan: SlipSlots = %0d must lie in 1 .. 16", SlipSlots);
  end
  if (GroupBits < msn_pkg::index_width(Groups)) begin : gen_check_group_bits
    $fatal(1, "msn_scan_plan: GroupBits = %0d must number %0d groups", GroupBits, Groups);
  end
  if (SettleBits < 1 || SettleBits > 24) begin : gen_check_settle_bits
    $fatal(1, "msn_scan_plan: SettleBits = %0d must lie in 1 .. 24", SettleBits);
  end
  if (PeriodBits < 1 || PeriodBits > 32) begin : gen_check_period_bits
    $fatal(1, "msn_scan_plan: PeriodBits = %0d must lie in 1 .. 32", PeriodBits);
  end

  localparam int unsigned CountBits = msn_pkg::index_width(
      ((1 << SettleBits) > Cycle + Hold) ? (1 << SettleBits) : Cycle + Hold) + 1;

  typedef enum logic [1:0] {
    Off,     // takes the registers; four clocks from enable to Free, as much as follows from them needs
    Free,    // may switch
    Settle,
    Busy     // the lines may not change, or the next trigger would come too early
  } state_e;

  state_e                state_q;
  logic [CountBits-1:0]  count_q;
  logic                  take_slip, take_frame, take_first, off_end;
  logic                  active;  // a frame has conversions left
  assign switch_o  = take_slip || take_frame;
  assign idle_o    = state_q == Off || (state_q == Free && !switch_o);
  assign off_end   = state_q == Off && count_q == '0 && cfg_enable_i;

  // Registers taken while off, and what follows from them.
  logic [SettleBits-1:0] settle_q;
  logic [CountBits-1:0]  gap_q, rest_q;  // clocks from trigger to Free: all, and what is left as Busy begins
  logic [PeriodBits-1:0] period_q, slip_period_q;
  logic [CountBits:0]    slot_q;    // clocks from switch to switch
  logic                  roomy_q;   // a slip round leaves room for a conversion of the frame
  logic                  slip_on_q, slip_one_q, period_one_q, at_once_q;
  logic [SlipSlots*(RowBits+1)-1:0] slip_row_q;
  logic [SlipSlots*GroupBits-1:0]   slip_group_q;
  always_ff @(posedge clk_i) begin
    if (state_q == Off && count_q == CountBits'(3)) begin
      settle_q      <= cfg_settle_i;
      period_q      <= cfg_period_i;
      slip_period_q <= cfg_slip_period_i;
      slip_row_q    <= cfg_slip_row_i;
      slip_group_q  <= cfg_slip_group_i;
    end
    gap_q     <= (CountBits'(settle_q) + CountBits'(Hold + 1) >= CountBits'(Cycle)) ? CountBits'(Hold)
                 : CountBits'(Cycle - 1) - CountBits'(settle_q);
    rest_q    <= gap_q - CountBits'(2);
    slot_q    <= (CountBits+1)'(settle_q) + (CountBits+1)'(gap_q) + 1'b1;
    roomy_q   <= 64'(slip_period_q) > 64'(slot_q);
    slip_on_q <= slip_period_q != '0;

    at_once_q    <= settle_q == '0;
    slip_one_q   <= slip_period_q == PeriodBits'(1);
    period_one_q <= period_q == PeriodBits'(1);
  end

  // In the clock in which Settle has counted down, registered a clock ahead, for timing.
  always_ff @(posedge clk_i) begin
    trigger_o <= !rst_i && ((state_q == Settle && count_q == CountBits'(1)) || (switch_o && at_once_q));
  end

  always_ff @(posedge clk_i) begin
    if (count_q != '0) count_q <= count_q - 1'b1;
    case (state_q)
      Off: begin
        if (off_end) state_q <= Free;
        if (!cfg_enable_i) count_q <= CountBits'(3);
      end
      Free: begin
        // Without an enable and a frame under way it is a slip round or nothing: no need to wait for take_frame.
        count_q <= (!cfg_enable_i && !active && !take_slip) ? CountBits'(3) : CountBits'(settle_q);
        if (switch_o) state_q <= Settle;
        else if (!cfg_enable_i && !active) state_q <= Off;
      end
      Settle: begin
        if (trigger_o) begin
          state_q <= Busy;
          count_q <= rest_q;
        end
      end
      default: if (count_q == '0) state_q <= Free;
    endcase
    if (rst_i) begin
      state_q <= Off;
      count_q <= CountBits'(3);
    end
  end

  // Slip rounds: exactly on their grid, or left out.
  logic [PeriodBits-1:0] slip_left_q;
  logic                  slip_zero_q;  // slip_left_q is 0: compared a clock ahead
  logic                  round_q;      // slots of a round are left
  logic                  slip_due, fits_q;
  logic [SlotBits-1:0]   slot_index_q, slot_index;
  assign slip_due   = state_q != Off && slip_on_q && slip_zero_q;
  assign take_slip  = state_q == Free && (round_q || slip_due);
  assign slot_index = round_q ? slot_index_q : '0;
  always_ff @(posedge clk_i) begin
    if (state_q == Off) slip_left_q <= '0;
    else                slip_left_q <= (slip_due ? slip_period_q : slip_left_q) - 1'b1;
    slip_zero_q <= state_q == Off || (slip_due ? slip_one_q : slip_left_q == PeriodBits'(1));
    fits_q <= !slip_on_q || (slip_due ? roomy_q : 64'(slip_left_q) > 64'(slot_q));
    if (take_slip) begin
      round_q      <= slot_index != SlotBits'(SlipSlots - 1);
      slot_index_q <= slot_index + 1'b1;
    end
    slip_overrun_o <= slip_overrun_o + 32'(slip_due && (round_q || state_q != Free));
    if (rst_i) begin
      round_q        <= 1'b0;
      slip_overrun_o <= '0;
    end
  end

  // Where the frame goes.
  logic [RowBits-1:0]   row, now_first_row, now_last_row;
  logic [GroupBits-1:0] group;
  logic [BeatBits-1:0]  now_first_beat, now_last_beat;
  logic                 now_interleave;
  msn_scan_walk #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Channels(Channels), .GroupBits(GroupBits)
  ) u_walk (
    .clk_i, .rst_i,
    .cfg_interleave_i, .cfg_first_row_i, .cfg_last_row_i, .cfg_first_column_i, .cfg_last_column_i,
    .begin_i(take_first), .step_i(take_frame), .active_o(active),
    .row_o(row), .group_o(group),
    .first_row_o(now_first_row), .last_row_o(now_last_row), .first_beat_o(now_first_beat),
    .last_beat_o(now_last_beat), .interleave_o(now_interleave)
  );

  // A frame starts at its tick, or as soon as it can.
  logic [PeriodBits-1:0] left_q;
  logic                  zero_q;  // left_q is 0: compared a clock ahead
  logic                  timed_q, tick, want_q, want;
  assign tick       = state_q != Off && cfg_enable_i && timed_q && zero_q;
  assign want       = cfg_enable_i && (!timed_q || want_q || tick);
  assign take_frame = state_q == Free && !take_slip && (active || want) && fits_q && room_i;
  // A frame's first, or, without an enable, none: then Off follows, and all is as if it had not been.
  assign take_first = state_q == Free && !take_slip && (!timed_q || want_q || zero_q) && fits_q && room_i;
  always_ff @(posedge clk_i) begin
    if (state_q == Off || !cfg_enable_i) left_q <= '0;
    else                                 left_q <= (tick ? period_q : left_q) - 1'b1;
    zero_q  <= state_q == Off || !cfg_enable_i || (tick ? period_one_q : left_q == PeriodBits'(1));
    timed_q <= period_q != '0;
    if (tick && !active) want_q <= 1'b1;
    if (take_frame) want_q <= 1'b0;
    overrun_o <= overrun_o + 32'(tick && (active || want_q));
    held_o    <= held_o + 32'(state_q == Free && !take_slip && (active || want) && fits_q && !room_i);
    if (rst_i || state_q == Off) want_q <= 1'b0;
    if (rst_i) begin
      overrun_o <= '0;
      held_o    <= '0;
    end
  end

  assign switch_row_o   = take_slip ? slip_row_q[32'(slot_index)*(RowBits+1)+:RowBits+1] : {1'b0, row};
  assign switch_group_o = take_slip ? slip_group_q[32'(slot_index)*GroupBits+:GroupBits] : group;

  // What was switched to becomes what was converted.
  logic                  slip_q, first_q;
  logic [GroupBits-1:0]  place_q;
  always_ff @(posedge clk_i) begin
    if (switch_o) begin
      slip_q  <= take_slip;
      first_q <= take_slip ? slot_index == '0 : !active;
      place_q <= switch_group_o;
    end
    if (trigger_o) begin
      done_slip_o  <= slip_q;
      done_first_o <= first_q;
      done_group_o <= place_q;
      if (!slip_q) begin
        frame_first_row_o  <= now_first_row;
        frame_last_row_o   <= now_last_row;
        frame_first_beat_o <= now_first_beat;
        frame_last_beat_o  <= now_last_beat;
        frame_interleave_o <= now_interleave;
      end
    end
  end

endmodule
