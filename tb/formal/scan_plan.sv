// SPDX-License-Identifier: Apache-2.0
//
// The plan against its rules, clock by clock: a converter starts exactly Settle + 1 clocks after each switch, once, and
// at no other time; the next switch follows at least Hold clocks later, and triggers are at least Cycle clocks apart
// while the plan is on. A frame begins at its tick or as soon as possible after it, and converts every row and group,
// row by row or, if it began with that order, every second row first. Settings are read only when they may be.

module formal_scan_plan #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned Hold       = 2,
  parameter  int unsigned Cycle      = 268,
  parameter  int unsigned SettleBits = 16,
  parameter  int unsigned PeriodBits = 32,
  localparam int unsigned RowBits    = msn_pkg::index_width(Rows),
  localparam int unsigned Beats      = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned Groups     = (Beats + Channels - 1) / Channels,
  localparam int unsigned GroupBits  = msn_pkg::index_width(Groups)
) (
  input logic                  clk_i,
  input logic                  rst_i,
  input logic                  cfg_enable_i,
  input logic [SettleBits-1:0] cfg_settle_i,
  input logic [PeriodBits-1:0] cfg_period_i,
  input logic                  cfg_interleave_i,
  input logic                  room_i
);

  logic                 idle_o, switch_o, trigger_o, done_first_o, done_interleave_o;
  logic [RowBits-1:0]   switch_row_o;
  logic [GroupBits-1:0] switch_group_o, done_group_o;
  logic [31:0]          overrun_o, held_o;
  msn_scan_plan #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Channels(Channels), .Hold(Hold), .Cycle(Cycle),
    .SettleBits(SettleBits), .PeriodBits(PeriodBits)
  ) dut (.*);

  // Settings of the plan, read while it is off and up to the first clock of enable.
  localparam int unsigned Wide = 26;
  logic                             started = 1'b0;
  logic                             off;
  logic [1:0]                       waits;
  logic [SettleBits-1:0]            settle;
  logic [PeriodBits-1:0]            period;
  logic [Wide-1:0]                  gap, slot;
  assign gap  = (Wide'(settle) + Wide'(Hold + 1) >= Wide'(Cycle)) ? Wide'(Hold) : Wide'(Cycle - 1) - Wide'(settle);
  assign slot = Wide'(settle) + Wide'(1) + gap;

  // When: minimum of clocks to the next switch, and clocks to the frame's next tick.
  logic [Wide-1:0]       rest;
  logic [PeriodBits-1:0] ticks_left;
  logic                  free, due, wanted, tick, take, late, waiting;
  // Where: the next place and the one before it; `lag`: a frame counts as under way for two more clocks.
  logic                  more, active, odd, odd_was, interleave, order;
  logic [1:0]            lag;
  logic [RowBits-1:0]    row, row_was;
  logic [RowBits:0]      row_next;
  logic [GroupBits-1:0]  group, group_was;
  logic [31:0]           overrun, held;
  assign free     = !off && rest == '0;
  assign active   = more || lag != '0;
  assign tick     = !off && cfg_enable_i && period != '0 && ticks_left == '0;
  assign due      = free && (active || (cfg_enable_i && (period == '0 || wanted || tick)));
  assign take     = due && room_i;
  assign order    = active ? interleave : cfg_interleave_i;
  assign row_next = (RowBits+1)'(row) + (order ? (RowBits+1)'(2) : (RowBits+1)'(1));

  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    if (off && waits == 2'd3) begin
      settle <= cfg_settle_i;
      period <= cfg_period_i;
    end
    if (off) begin
      waits <= !cfg_enable_i ? 2'd3 : (waits == '0) ? '0 : waits - 1'b1;
      if (waits == '0 && cfg_enable_i) off <= 1'b0;
    end else if (free && !take && !active && !cfg_enable_i) begin
      off   <= 1'b1;
      waits <= 2'd3;
    end

    rest       <= take ? slot - 1'b1 : (rest == '0) ? '0 : rest - 1'b1;
    ticks_left <= (off || !cfg_enable_i) ? '0 : (tick ? period : ticks_left) - 1'b1;
    if (tick && !active) wanted <= 1'b1;
    if (take) wanted <= 1'b0;
    if (off) wanted <= 1'b0;
    late    <= tick && (active || wanted);
    waiting <= due && !room_i;
    overrun <= overrun + 32'(late);
    held    <= held + 32'(waiting);

    lag <= take ? 2'd2 : (lag == '0) ? '0 : lag - 1'b1;
    if (take) begin
      interleave <= order;
      row_was    <= row;
      group_was  <= group;
      odd_was    <= odd;
      more       <= 1'b1;
      if (32'(group) + 1 != Groups) begin
        group <= group + 1'b1;
      end else begin
        group <= '0;
        if (32'(row_next) < Rows) begin
          row <= row_next[RowBits-1:0];
        end else if (order && !odd && Rows != 1) begin
          row <= RowBits'(1);
          odd <= 1'b1;
        end else begin
          row  <= '0;
          odd  <= 1'b0;
          more <= 1'b0;
        end
      end
    end
    if (rst_i) begin
      off     <= 1'b1;
      waits   <= 2'd3;
      rest    <= '0;
      wanted  <= 1'b0;
      more    <= 1'b0;
      odd     <= 1'b0;
      row     <= '0;
      group   <= '0;
      lag     <= '0;
      late    <= 1'b0;
      waiting <= 1'b0;
      overrun <= '0;
      held    <= '0;
    end
  end

  // Conversions: a switch waits for its trigger; a trigger came since reset, since the plan is on; clocks since both.
  logic                 settling, triggered, apart, framed, first_q, first_done, order_done;
  logic [GroupBits-1:0] place, place_done;
  logic [Wide-1:0]      after;
  logic [19:0]          since;
  always_ff @(posedge clk_i) begin
    after <= after + 1'b1;
    since <= (since == '1) ? '1 : since + 1'b1;
    if (switch_o) begin
      settling <= 1'b1;
      after    <= Wide'(1);
      first_q  <= !active;
      place    <= switch_group_o;
    end
    if (trigger_o) begin
      settling   <= 1'b0;
      triggered  <= 1'b1;
      apart      <= 1'b1;
      since      <= 20'd1;
      first_done <= first_q;
      place_done <= place;
      if (first_q) order_done <= interleave;
      if (first_q) framed <= 1'b1;
    end
    if (off || rst_i) apart <= 1'b0;
    if (rst_i) begin
      settling  <= 1'b0;
      triggered <= 1'b0;
      framed    <= 1'b0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started && !rst_i) begin
      assert (trigger_o == (settling && after == Wide'(settle) + Wide'(1)));
      if (switch_o && apart) assert (since >= 20'(Hold));
      if (trigger_o && apart) assert (since >= 20'(Cycle));
      assert (switch_o == take);
      assert (idle_o == (off || (free && !switch_o)));
      if (take) assert (switch_row_o == row && switch_group_o == group);
      if (take) assert (32'(switch_row_o) < Rows && 32'(switch_group_o) * Channels < Beats);
    end
    if (started) begin
      assert (overrun_o == overrun && held_o == held);
      if (triggered) assert (done_first_o == first_done && done_group_o == place_done);
      if (framed && Rows != 1) assert (done_interleave_o == order_done);
    end
  end

  // Invariant: the block's registers agree with this model.
  logic blank;  // no settings were read since reset
  assign blank = off && waits == 2'd3;
  always_comb begin
    if (started) begin
      // States and counters.
      assert (dut.none_q == (dut.count_q == '0));
      assert (!(settling && (off || rest == '0)));
      assert (dut.state_q == (off ? 2'd0 : rest == '0 ? 2'd1 : settling ? 2'd2 : 2'd3));
      if (off) assert (rest == '0 && !more && lag == '0 && Wide'(dut.count_q) == Wide'(waits));
      if (settling) begin
        assert (after >= Wide'(1) && after <= Wide'(settle) + Wide'(1));
        assert (Wide'(dut.count_q) + after == Wide'(settle) + Wide'(1) && rest + after == slot);
      end
      if (!settling && rest != '0) assert (rest <= gap - Wide'(1) && Wide'(dut.count_q) == rest - Wide'(1));
      if (settling && apart) assert (since == '1 || 24'(since) >= 24'(gap) + 24'(after));
      if (!settling && apart && !off) assert (since == '1 || 24'(since) + 24'(rest) >= 24'(gap));
      assert (trigger_o == (settling && after == Wide'(settle) + Wide'(1)));

      // Values derived from the settings.
      if (!blank) assert (dut.settle_q == settle && dut.period_q == period);
      if (!off || waits <= 2'd1) begin
        assert (Wide'(dut.gap_q) == gap && dut.at_once_q == (settle == '0));
        assert (dut.period_one_q == (period == PeriodBits'(1)) && dut.timed_q == (period != '0));
      end
      if (!off || waits == '0) assert (Wide'(dut.rest_q) == gap - Wide'(2) && dut.rest_none_q == (gap == Wide'(2)));
      if (!blank) assert (dut.left_q == ticks_left && dut.zero_q == (ticks_left == '0));
      assert (dut.want_q == wanted && dut.late_q == late && dut.waits_q == waiting);

      // The place.
      assert (dut.active_q == active && dut.find_q == (lag == 2'd2) && dut.found_q == (lag == 2'd1) && lag <= 2'd2);
      assert (32'(row) < Rows && 32'(group) < Groups && (!more || !interleave || odd == row[0]));
      if (!more) assert (row == '0 && group == '0 && !odd);
      if (active) assert (dut.interleave_q == interleave);
      if (lag != '0) begin
        assert (Wide'(lag) + slot == rest + Wide'(3));
        assert (dut.row_q == row_was && dut.group_q == group_was && (!interleave || odd_was == row_was[0]));
        assert (32'(row_was) < Rows && 32'(group_was) < Groups);
        if (lag == 2'd1) assert (dut.row_next_q == (RowBits+1)'(row_was) + (interleave ? (RowBits+1)'(2) : (RowBits+1)'(1)));
        if (lag == 2'd1) assert (dut.row_ends_q == (32'(group_was) + 1 == Groups));
        // The next place as a function of the one before it.
        if (32'(group_was) + 1 != Groups) assert (more && group == group_was + 1'b1 && row == row_was && odd == odd_was);
        else begin
          assert (group == '0);
          if (32'(row_was) + (interleave ? 32'd2 : 32'd1) < Rows)
            assert (more && odd == odd_was && row == row_was + (interleave ? RowBits'(2) : RowBits'(1)));
          else if (interleave && !odd_was && Rows != 1) assert (more && odd && row == RowBits'(1));
          else assert (!more);
        end
      end else begin
        assert (dut.row_q == row && dut.group_q == group);
      end
      if (settling) assert (dut.first_q == first_q && dut.place_q == place);
      if (settling && first_q && Rows != 1) assert (more);
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (trigger_o && settle == SettleBits'(3));
      cover (switch_o && settle == '0);
      cover (trigger_o && !idle_o);
      if (Cycle < 20) cover (take && active && switch_group_o == GroupBits'(Groups - 1));
      if (Cycle < 20) cover (take && held_o != '0);
    end
  end

endmodule
