// SPDX-License-Identifier: Apache-2.0
//
// Plans the scan of a matrix: when to switch to which row and column group, and when to start the converters.
//
//   clock  s          s+1          s+2            s+1+Settle   then, slot = Settle + 1 + gap clocks after s,
//          switch_o   lines off    lines settle   trigger_o    the next switch; gap = max(Hold, Cycle-1-Settle)
//
// Frames start every cfg_period_i clocks (0: back to back) and convert every group of every row, row by row or, with
// cfg_interleave_i, rows 0, 2, 4 .. and then 1, 3, 5 ... Finding the next place takes two clocks after a switch, so
// after its last switch a frame counts as under way until then.
// Settle and period are taken in every clock in which no frame is under way, from the clock after its last trigger on,
// and no switch is due: a change up to a clock before a frame's first switch is in force for this frame, and a shorter
// period ends a long wait. The order is that of the first switch's clock. cfg_enable_i low: off after the frame.
// Model: model/meissner/twins/frontend/scan_plan.py
// Error: none.

module msn_scan_plan #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,    // converters side by side: columns in a beat
  parameter  int unsigned Channels   = 8,    // beats of one conversion
  parameter  int unsigned Hold       = 2,    // clocks from trigger_o in which the lines may not change
  parameter  int unsigned Cycle      = 268,  // clocks from trigger_o to trigger_o that the converters need
  parameter  int unsigned SettleBits = 16,
  parameter  int unsigned PeriodBits = 32,
  localparam int unsigned RowBits    = msn_pkg::index_width(Rows),
  localparam int unsigned Beats      = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned Groups     = (Beats + Channels - 1) / Channels,
  localparam int unsigned GroupBits  = msn_pkg::index_width(Groups)
) (
  input  logic                  clk_i,
  input  logic                  rst_i,

  input  logic                  cfg_enable_i,
  input  logic [SettleBits-1:0] cfg_settle_i,       // clocks from the lines to convert start
  input  logic [PeriodBits-1:0] cfg_period_i,
  input  logic                  cfg_interleave_i,

  input  logic                  room_i,             // the frame's buffer has room for a conversion

  output logic                  idle_o,             // nothing to do: all rows off
  output logic                  switch_o,
  output logic [RowBits-1:0]    switch_row_o,
  output logic [GroupBits-1:0]  switch_group_o,
  output logic                  trigger_o,

  // Of the conversion triggered last, from the clock after trigger_o on.
  output logic                  done_first_o,       // of its frame
  output logic [GroupBits-1:0]  done_group_o,
  output logic                  done_interleave_o,  // of its frame

  output logic [31:0]           overrun_o,          // frame ticks: the frame before was not done
  output logic [31:0]           held_o              // clocks in which the frame waited for room
);

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_scan_plan: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_scan_plan: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_scan_plan: Lanes = %0d must lie in 1 .. 8", Lanes);
  end
  if (Channels < 1 || Channels > 8) begin : gen_check_channels
    $fatal(1, "msn_scan_plan: Channels = %0d must lie in 1 .. 8", Channels);
  end
  if (Hold < 2) begin : gen_check_hold
    $fatal(1, "msn_scan_plan: Hold = %0d must be at least 2", Hold);
  end
  if (Cycle < Channels + 8) begin : gen_check_cycle
    $fatal(1, "msn_scan_plan: Cycle = %0d must be at least Channels + 8", Cycle);
  end
  if (SettleBits < 1 || SettleBits > 24) begin : gen_check_settle_bits
    $fatal(1, "msn_scan_plan: SettleBits = %0d must lie in 1 .. 24", SettleBits);
  end
  if (PeriodBits < 1 || PeriodBits > 32) begin : gen_check_period_bits
    $fatal(1, "msn_scan_plan: PeriodBits = %0d must lie in 1 .. 32", PeriodBits);
  end

  localparam int unsigned CountBits = SettleBits < 2 ? 2 : SettleBits;
  // Clocks from a trigger until anything may follow, and those of them that a settle time can save.
  localparam int unsigned Full      = (Cycle - 1 > Hold) ? Cycle - 1 : Hold;
  localparam int unsigned Saved     = Full - Hold;
  localparam int unsigned RestBits  = msn_pkg::index_width(Full + 1);

  typedef enum logic [1:0] {
    Off,     // four clocks from enable to Free
    Free,    // may switch if open_q
    Settle
  } state_e;

  state_e                state_q;
  logic [CountBits-1:0]  count_q;
  logic                  none_q;    // count_q is 0: compared a clock ahead
  logic                  active_q;  // a frame has conversions left
  logic                  open_q;    // gap clocks have passed since the trigger, with the settle time in force
  logic                  due;       // a switch, if there is room
  assign idle_o = state_q == Off || (state_q == Free && open_q && !switch_o);

  // Settings in force. The rest after a trigger is compared with the settle time that follows it, in the clock in which
  // that is taken, each limit apart for timing: triggers are never less than Cycle clocks apart, whatever changes.
  logic [SettleBits-1:0] settle_q;
  logic [PeriodBits-1:0] last_q;           // period - 1
  logic                  timed_q, at_once_q, take;
  logic [RestBits-1:0]   rest_q;           // of Full
  logic [RestBits-1:0]   most_q;           // open from this rest on, and one: settle + 1, at most Saved + 1
  logic                  fits;             // rest_q is no more
  assign take = !active_q && state_q != Settle && !due;
  assign fits = !take ? rest_q <= most_q : 32'(rest_q) <= Saved + 1 && 32'(rest_q) <= 32'(cfg_settle_i) + 1;
  always_ff @(posedge clk_i) begin
    if (take) begin
      settle_q  <= cfg_settle_i;
      at_once_q <= cfg_settle_i == '0;
      last_q    <= cfg_period_i - 1'b1;
      timed_q   <= cfg_period_i != '0;
      most_q    <= (32'(cfg_settle_i) >= Saved) ? RestBits'(Saved + 1) : RestBits'(cfg_settle_i) + 1'b1;
    end
    open_q <= !trigger_o && fits;
    if (trigger_o)         rest_q <= RestBits'(Full - 1);
    else if (rest_q != '0) rest_q <= rest_q - 1'b1;
    if (rst_i) {rest_q, open_q} <= {RestBits'(0), 1'b1};
  end

  // High in the clock in which Settle has counted down; computed a clock ahead, for timing.
  always_ff @(posedge clk_i) begin
    trigger_o <= !rst_i && ((state_q == Settle && count_q == CountBits'(1)) || (switch_o && at_once_q));
  end

  always_ff @(posedge clk_i) begin
    if (!none_q) count_q <= count_q - 1'b1;
    none_q <= count_q[CountBits-1:1] == '0;
    case (state_q)
      Off: begin
        if (none_q && cfg_enable_i) state_q <= Free;
        if (!cfg_enable_i) {count_q, none_q} <= {CountBits'(3), 1'b0};
      end
      Free: begin
        // With neither enable nor a frame under way there is no switch, so switch_o need not be checked.
        count_q <= (!cfg_enable_i && !active_q) ? CountBits'(3) : CountBits'(settle_q);
        none_q  <= (cfg_enable_i || active_q) && at_once_q;
        if (switch_o) state_q <= Settle;
        else if (open_q && !cfg_enable_i && !active_q) state_q <= Off;
      end
      default: if (none_q) state_q <= Free;  // with trigger_o; without one after an upset of the state
    endcase
    if (rst_i) begin
      state_q <= Off;
      count_q <= CountBits'(3);
      none_q  <= 1'b0;
    end
  end

  // A frame starts at its tick, or as soon as it can. Where state and enable are checked anyway, zero_q alone stands
  // for the tick, and the counters count a clock later: shorter paths to switch_o and to the carry chains.
  // since_q counts up from a tick, back to back from a frame's start: after a change of the period, or an upset, the
  // next tick is at most a period away.
  logic [PeriodBits-1:0] since_q;
  logic                  zero_q;  // since_q is the period, or more: compared a clock ahead
  logic                  tick, want_q, late_q, waits_q;
  logic                  first_q, find_q;  // the last switch was its frame's first; it was a clock ago
  assign tick     = state_q != Off && cfg_enable_i && timed_q && zero_q;
  assign due      = state_q == Free && open_q &&
                    (active_q || (cfg_enable_i && (!timed_q || want_q || zero_q)));
  assign switch_o = due && room_i;
  always_ff @(posedge clk_i) begin
    if (state_q == Off || !cfg_enable_i)    since_q <= '0;
    else if (zero_q)                        since_q <= PeriodBits'(1);
    else if (find_q && first_q && !timed_q) since_q <= PeriodBits'(2);
    else                                    since_q <= since_q + 1'b1;
    zero_q <= state_q == Off || !cfg_enable_i || (zero_q ? last_q == '0 : since_q >= last_q);
    if (tick && !active_q) want_q <= 1'b1;
    if (switch_o) want_q <= 1'b0;
    late_q    <= tick && (active_q || want_q);
    waits_q   <= due && !room_i;
    overrun_o <= overrun_o + 32'(late_q);
    held_o    <= held_o + 32'(waits_q);
    if (rst_i || state_q == Off) want_q <= 1'b0;
    if (rst_i) begin
      {late_q, waits_q} <= '0;
      overrun_o <= '0;
      held_o    <= '0;
    end
  end

  // The place to convert next; it wraps around to the first place at the end of a frame.
  logic [RowBits-1:0]   row_q;
  logic [RowBits:0]     row_next_q;
  logic [GroupBits-1:0] group_q;
  logic                 interleave_q, found_q, row_ends_q;
  assign switch_row_o   = row_q;
  assign switch_group_o = group_q;
  always_ff @(posedge clk_i) begin
    find_q     <= switch_o;
    found_q    <= find_q;
    row_next_q <= {1'b0, row_q} + (interleave_q ? (RowBits+1)'(2) : (RowBits+1)'(1));
    row_ends_q <= group_q == GroupBits'(Groups - 1);
    if (!active_q) interleave_q <= cfg_interleave_i;
    if (switch_o) active_q <= 1'b1;
    if (found_q) begin
      group_q <= row_ends_q ? '0 : group_q + 1'b1;
      if (row_ends_q) begin
        if (32'(row_next_q) < Rows) begin
          row_q <= row_next_q[RowBits-1:0];
        end else if (interleave_q && !row_q[0] && Rows > 1) begin  // the even rows are done
          row_q <= RowBits'(1);
        end else begin
          row_q    <= '0;
          active_q <= 1'b0;
        end
      end
    end
    if (rst_i) begin
      row_q    <= '0;
      group_q  <= '0;
      find_q   <= 1'b0;
      found_q  <= 1'b0;
      active_q <= 1'b0;
    end
  end

  // At the trigger the place switched to becomes the place converted.
  logic [GroupBits-1:0] place_q;
  always_ff @(posedge clk_i) begin
    if (switch_o) begin
      first_q <= !active_q;
      place_q <= group_q;
    end
    if (trigger_o) begin
      done_first_o <= first_q;
      done_group_o <= place_q;
      if (first_q) done_interleave_o <= interleave_q;
    end
  end

endmodule
