// SPDX-License-Identifier: Apache-2.0
//
// The plan against its rules, clock by clock: a converter starts exactly Settle + 1 clocks after each switch, once, and
// at no other time; the next switch follows at least Hold clocks later, and triggers are at least Cycle clocks apart
// while the plan is on. A frame begins at its tick or as soon as possible after it, and converts every row and group,
// row by row or, if it began with that order, every second row first. The settings in force are those of the last clock
// in which no frame was under way and none was due.

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

  // Settings in force.
  localparam int unsigned Wide = 26;
  logic                             started = 1'b0;
  logic                             off;
  logic [1:0]                       waits;
  logic [SettleBits-1:0]            settle;
  logic [PeriodBits-1:0]            period;
  logic [Wide-1:0]                  gap;
  assign gap  = (Wide'(settle) + Wide'(Hold + 1) >= Wide'(Cycle)) ? Wide'(Hold) : Wide'(Cycle - 1) - Wide'(settle);

  // When: clocks since the last trigger, if there was one since the reset, and to the frame's next tick.
  logic [19:0]           since;
  logic                  apart;
  logic [PeriodBits-1:0] age;    // clocks since the last tick, back to back since the frame's start
  logic                  ripe;   // age was a period, or more
  logic                  free, due, wanted, tick, take, late, waiting, settling, first_q;
  // Where: the next place and the one before it; `lag`: a frame counts as under way for two more clocks.
  logic                  more, active, odd, odd_was, interleave, order;
  logic [1:0]            lag;
  logic [RowBits-1:0]    row, row_was;
  logic [RowBits:0]      row_next;
  logic [GroupBits-1:0]  group, group_was;
  logic [31:0]           overrun, held;
  assign free     = !off && !settling && (!apart || 24'(since) >= 24'(gap));
  assign active   = more || lag != '0;
  assign tick     = !off && cfg_enable_i && period != '0 && ripe;
  assign due      = free && (active || (cfg_enable_i && (period == '0 || wanted || tick)));
  assign take     = due && room_i;
  assign order    = active ? interleave : cfg_interleave_i;
  assign row_next = (RowBits+1)'(row) + (order ? (RowBits+1)'(2) : (RowBits+1)'(1));

  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    if (!active && !settling && !due) begin
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

    age  <= (off || !cfg_enable_i) ? '0 : ripe ? PeriodBits'(1) :
            (lag == 2'd2 && first_q && period == '0) ? PeriodBits'(2) : age + 1'b1;
    ripe <= off || !cfg_enable_i ||
            (period != '0 && (PeriodBits+1)'(ripe ? '0 : age) + (PeriodBits+1)'(1) >= (PeriodBits+1)'(period)) ||
            (period == '0 && !ripe && age == '1);
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

  // Conversions: a switch waits for its trigger; a trigger came since reset; clocks since both.
  logic                 triggered, framed, first_done, order_done;
  logic [GroupBits-1:0] place, place_done;
  logic [Wide-1:0]      after;
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
    if (rst_i) begin
      apart     <= 1'b0;
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
  logic blank = 1'b1;  // no settings were read since the start
  always_ff @(posedge clk_i) blank <= !started;
  localparam int unsigned Full = (Cycle - 1 > Hold) ? Cycle - 1 : Hold;
  always_comb begin
    if (started) begin
      if (blank) assert (off);
      // States and counters.
      assert (dut.none_q == (dut.count_q == '0) || !(off || settling));
      assert (dut.state_q == (off ? 2'd0 : settling ? 2'd2 : 2'd1));
      if (off) assert (!settling && !more && lag == '0 && Wide'(dut.count_q) == Wide'(waits));
      if (settling) begin
        assert (after >= Wide'(1) && after <= Wide'(settle) + Wide'(1));
        assert (Wide'(dut.count_q) + after == Wide'(settle) + Wide'(1));
        if (apart) assert (since == '1 || 24'(since) >= 24'(gap) + 24'(after));
      end
      if (apart) assert (since != '0 && 32'(dut.rest_q) == (32'(since) >= Full ? 0 : Full - 32'(since)));
      else assert (dut.rest_q == '0);
      assert (trigger_o == (settling && after == Wide'(settle) + Wide'(1)));
      if (lag != '0) assert (after + Wide'(lag) == Wide'(3));
      if (lag != '0 && !settling) assert (apart && 24'(since) + 24'(settle) + 24'(1) == 24'(after));

      // Values derived from the settings.
      if (!blank) begin
        assert (dut.settle_q == settle && dut.at_once_q == (settle == '0));
        assert (dut.last_q == period - 1'b1 && dut.timed_q == (period != '0));
        assert (dut.since_q == age && dut.zero_q == ripe);
        assert (Wide'(dut.most_q) == (Wide'(settle) < Wide'(Full - Hold) ? Wide'(settle) : Wide'(Full - Hold)) + Wide'(1));
        assert (dut.open_q == (!apart || 24'(since) >= 24'(gap)) || settling);
      end
      assert (dut.want_q == wanted && dut.late_q == late && dut.waits_q == waiting);

      // The place.
      assert (dut.active_q == active && dut.find_q == (lag == 2'd2) && dut.found_q == (lag == 2'd1) && lag <= 2'd2);
      assert (32'(row) < Rows && 32'(group) < Groups && (!more || !interleave || odd == row[0]));
      if (!more) assert (row == '0 && group == '0 && !odd);
      if (active) assert (dut.interleave_q == interleave);
      if (lag != '0) begin
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
