// SPDX-License-Identifier: Apache-2.0
//
// The plan against its rules, clock by clock: a converter starts exactly Settle + 1 clocks after each switch, once, and
// never else; the next switch comes no sooner than Hold clocks after that, and triggers are Cycle clocks apart at the
// least while it is on. Slip rounds begin on their grid or are counted as left out, and convert their places in order;
// a frame begins at its tick or as soon as it can, gets only slots that end before the next round, and converts every
// row and group of the region that it began with, row by row or every second first. Registers count when they may.

module formal_scan_plan #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned Hold       = 2,
  parameter  int unsigned Cycle      = 268,
  parameter  int unsigned SlipSlots  = 1,
  parameter  int unsigned SettleBits = 16,
  parameter  int unsigned PeriodBits = 32,
  parameter  int unsigned GroupBits  = 1,
  localparam int unsigned RowBits    = msn_pkg::index_width(Rows),
  localparam int unsigned ColumnBits = msn_pkg::index_width(Columns),
  localparam int unsigned Beats      = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned BeatBits   = msn_pkg::index_width(Beats),
  localparam int unsigned SlotBits   = msn_pkg::index_width(SlipSlots)
) (
  input logic                             clk_i,
  input logic                             rst_i,
  input logic                             cfg_enable_i,
  input logic [SettleBits-1:0]            cfg_settle_i,
  input logic [PeriodBits-1:0]            cfg_period_i,
  input logic                             cfg_interleave_i,
  input logic [RowBits-1:0]               cfg_first_row_i,
  input logic [RowBits-1:0]               cfg_last_row_i,
  input logic [ColumnBits-1:0]            cfg_first_column_i,
  input logic [ColumnBits-1:0]            cfg_last_column_i,
  input logic [PeriodBits-1:0]            cfg_slip_period_i,
  input logic [SlipSlots*(RowBits+1)-1:0] cfg_slip_row_i,
  input logic [SlipSlots*GroupBits-1:0]   cfg_slip_group_i,
  input logic                             room_i
);

  logic                 idle_o, switch_o, trigger_o, done_slip_o, done_first_o, frame_interleave_o;
  logic [RowBits:0]     switch_row_o;
  logic [GroupBits-1:0] switch_group_o, done_group_o;
  logic [RowBits-1:0]   frame_first_row_o, frame_last_row_o;
  logic [BeatBits-1:0]  frame_first_beat_o, frame_last_beat_o;
  logic [31:0]          overrun_o, slip_overrun_o, held_o;
  msn_scan_plan #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Channels(Channels), .Hold(Hold), .Cycle(Cycle),
    .SlipSlots(SlipSlots), .SettleBits(SettleBits), .PeriodBits(PeriodBits), .GroupBits(GroupBits)
  ) dut (.*);

  // Registers of the plan, taken while it is off and up to the first clock of enable.
  localparam int unsigned Wide = 26;
  logic                             started = 1'b0, warm;
  logic                             off;
  logic [1:0]                       waits;
  logic [SettleBits-1:0]            settle;
  logic [PeriodBits-1:0]            period, slip_period;
  logic [SlipSlots*(RowBits+1)-1:0] slip_row;
  logic [SlipSlots*GroupBits-1:0]   slip_group;
  logic [Wide-1:0]                  gap, slot;
  assign gap  = (Wide'(settle) + Wide'(Hold + 1) >= Wide'(Cycle)) ? Wide'(Hold) : Wide'(Cycle - 1) - Wide'(settle);
  assign slot = Wide'(settle) + Wide'(1) + gap;

  // A region, cut to the array: {interleave, first row, last row, first beat, last beat}.
  typedef struct packed {
    logic                interleave;
    logic [RowBits-1:0]  first_row, last_row;
    logic [BeatBits-1:0] first_beat, last_beat;
  } region_t;
  region_t               cut, cut_q, fresh, now, frame;  // `fresh` is the registers' of two clocks ago
  logic [ColumnBits-1:0] last_column;
  always_comb begin
    last_column    = (32'(cfg_last_column_i) >= Columns) ? ColumnBits'(Columns - 1) : cfg_last_column_i;
    cut.interleave = cfg_interleave_i;
    cut.last_row   = (32'(cfg_last_row_i) >= Rows) ? RowBits'(Rows - 1) : cfg_last_row_i;
    cut.first_row  = (cfg_first_row_i > cut.last_row) ? cut.last_row : cfg_first_row_i;
    cut.last_beat  = BeatBits'(32'(last_column) / Lanes);
    cut.first_beat = (cfg_first_column_i > last_column) ? cut.last_beat : BeatBits'(32'(cfg_first_column_i) / Lanes);
  end

  // When: clocks to the next switch at the earliest, to the next round and to the frame's next tick.
  logic [Wide-1:0]       rest;
  logic [PeriodBits-1:0] left, ticks_left;
  logic                  free, round, due, fits, wanted, tick, take_slip, take_frame;
  logic [SlotBits-1:0]   index, index_q;
  // Where: the place to come and the one before it; `lag`: a frame counts as under way for two clocks more.
  logic                  more, active, odd, odd_was, first;
  logic [1:0]            lag;
  logic                  was_idle;  // the clock before no frame was under way, nor began, nor would have with an enable
  logic [RowBits-1:0]    row, row_was, from_row;
  logic [RowBits:0]      row_next;
  logic [GroupBits-1:0]  group, group_was, from_group, first_group, last_group;
  region_t               of;
  logic [31:0]           overrun, slip_overrun, held;
  assign free       = !off && rest == '0;
  assign due        = !off && slip_period != '0 && left == '0;
  assign fits       = slip_period == '0 || 64'(left) >= 64'(slot);
  assign take_slip  = free && (round || due);
  assign index      = round ? index_q : '0;
  assign active     = more || lag != '0;
  assign tick       = !off && cfg_enable_i && period != '0 && ticks_left == '0;
  assign take_frame = free && !take_slip && fits && room_i && (active || (cfg_enable_i && (period == '0 || wanted || tick)));
  assign of         = active ? now : fresh;
  assign from_row   = active ? row : fresh.first_row;
  assign first      = take_slip ? index == '0 : !active;
  if (Beats > Channels) begin : gen_groups
    assign first_group = GroupBits'(32'(of.first_beat) / Channels);
    assign last_group  = GroupBits'(32'(of.last_beat) / Channels);
  end else begin : gen_one_group
    assign first_group = '0;
    assign last_group  = '0;
  end
  assign from_group = active ? group : first_group;
  assign row_next   = (RowBits+1)'(from_row) + (of.interleave ? (RowBits+1)'(2) : (RowBits+1)'(1));

  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    warm    <= started;
    cut_q   <= cut;
    fresh   <= cut_q;
    if (off && waits == 2'd3) begin
      settle      <= cfg_settle_i;
      period      <= cfg_period_i;
      slip_period <= cfg_slip_period_i;
      slip_row    <= cfg_slip_row_i;
      slip_group  <= cfg_slip_group_i;
    end
    if (off) begin
      waits <= !cfg_enable_i ? 2'd3 : (waits == '0) ? '0 : waits - 1'b1;
      if (waits == '0 && cfg_enable_i) off <= 1'b0;
    end else if (free && !take_slip && !take_frame && !active && !cfg_enable_i) begin
      off   <= 1'b1;
      waits <= 2'd3;
    end

    rest       <= (take_slip || take_frame) ? slot - 1'b1 : (rest == '0) ? '0 : rest - 1'b1;
    left       <= off ? '0 : (due ? slip_period : left) - 1'b1;
    ticks_left <= (off || !cfg_enable_i) ? '0 : (tick ? period : ticks_left) - 1'b1;
    if (take_slip) begin
      round   <= index != SlotBits'(SlipSlots - 1);
      index_q <= index + 1'b1;
    end
    if (tick && !active) wanted <= 1'b1;
    if (take_frame) wanted <= 1'b0;
    if (off) wanted <= 1'b0;
    overrun      <= overrun + 32'(tick && (active || wanted));
    held         <= held + 32'(free && !take_slip && fits && !room_i && (active || (cfg_enable_i && (period == '0 || wanted || tick))));
    slip_overrun <= slip_overrun + 32'(due && (round || !free));

    lag      <= take_frame ? 2'd2 : (lag == '0) ? '0 : lag - 1'b1;
    was_idle <= !active && !dut.take_first;
    if (take_frame) begin
      now       <= of;
      row_was   <= from_row;
      group_was <= from_group;
      odd_was   <= active && odd;
      odd       <= active && odd;
      more      <= 1'b1;
      row       <= from_row;
      if (from_group != last_group) begin
        group <= from_group + 1'b1;
      end else begin
        group <= first_group;
        if (row_next <= (RowBits+1)'(of.last_row)) begin
          row <= row_next[RowBits-1:0];
        end else if (of.interleave && !(active && odd) && of.first_row != of.last_row) begin
          row <= of.first_row + 1'b1;
          odd <= 1'b1;
        end else begin
          more <= 1'b0;
        end
      end
    end
    if (rst_i) begin
      off          <= 1'b1;
      waits        <= 2'd3;
      rest         <= '0;
      round        <= 1'b0;
      wanted       <= 1'b0;
      more         <= 1'b0;
      lag          <= '0;
      was_idle     <= 1'b0;
      overrun      <= '0;
      slip_overrun <= '0;
      held         <= '0;
    end
  end

  // Conversions: a switch waits for its trigger; there was one since reset, since the plan is on; clocks since either.
  logic                 settling, triggered, apart, framed, slip, slip_done, first_q, first_done;
  logic [GroupBits-1:0] place, place_done;
  logic [Wide-1:0]      after;
  logic [19:0]          since;
  always_ff @(posedge clk_i) begin
    after <= after + 1'b1;
    since <= (since == '1) ? '1 : since + 1'b1;
    if (switch_o) begin
      settling <= 1'b1;
      after    <= Wide'(1);
      slip     <= take_slip;
      first_q  <= first;
      place    <= switch_group_o;
    end
    if (trigger_o) begin
      settling   <= 1'b0;
      triggered  <= 1'b1;
      apart      <= 1'b1;
      since      <= 20'd1;
      slip_done  <= slip;
      first_done <= first_q;
      place_done <= place;
      if (!slip) frame <= now;
      if (!slip) framed <= 1'b1;
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
      assert (switch_o == (take_slip || take_frame));
      assert (idle_o == (off || (free && !switch_o)));
      if (take_slip) assert (switch_row_o == slip_row[32'(index)*(RowBits+1)+:RowBits+1]);
      if (take_slip) assert (switch_group_o == slip_group[32'(index)*GroupBits+:GroupBits]);
      if (take_frame) assert (switch_row_o == (RowBits+1)'(from_row) && switch_group_o == from_group);
      if (take_frame) assert (32'(switch_row_o) < Rows && 32'(switch_group_o) * Channels < Beats);
    end
    if (started) begin
      assert (overrun_o == overrun && slip_overrun_o == slip_overrun && held_o == held);
      if (triggered) assert (done_slip_o == slip_done && done_first_o == first_done && done_group_o == place_done);
      if (framed) assert ({frame_interleave_o, frame_first_row_o, frame_last_row_o, frame_first_beat_o, frame_last_beat_o} == frame);
    end
  end

  // Invariant: where the plan's own registers stand in all this.
  logic blank;  // nothing was taken since reset
  assign blank = off && waits == 2'd3;
  function automatic logic legal(region_t r);
    return 32'(r.last_row) < Rows && r.first_row <= r.last_row && 32'(r.last_beat) < Beats && r.first_beat <= r.last_beat;
  endfunction
  always_comb begin
    if (started) begin
      assert (legal(cut_q) && cut_q == {dut.u_walk.region_interleave_q, dut.u_walk.region_first_row_q, dut.u_walk.region_last_row_q, dut.u_walk.region_first_beat_q, dut.u_walk.region_last_beat_q});
      if (warm) assert (legal(fresh) && fresh == {dut.u_walk.next_interleave_q, dut.u_walk.next_first_row_q, dut.u_walk.next_last_row_q, dut.u_walk.next_first_beat_q, dut.u_walk.next_last_beat_q});
      if (!warm) assert (blank);

      // States and counters.
      assert (!(settling && (off || rest == '0)));
      assert (dut.state_q == (off ? 2'd0 : rest == '0 ? 2'd1 : settling ? 2'd2 : 2'd3));
      if (off) assert (rest == '0 && !more && lag == '0 && !round && Wide'(dut.count_q) == Wide'(waits));
      if (settling) begin
        assert (after >= Wide'(1) && after <= Wide'(settle) + Wide'(1));
        assert (Wide'(dut.count_q) + after == Wide'(settle) + Wide'(1) && rest + after == slot);
      end
      if (!settling && rest != '0) assert (rest <= gap - Wide'(1) && Wide'(dut.count_q) == rest - Wide'(1));
      if (settling && apart) assert (since == '1 || 24'(since) >= 24'(gap) + 24'(after));
      if (!settling && apart && !off) assert (since == '1 || 24'(since) + 24'(rest) >= 24'(gap));
      assert (trigger_o == (settling && after == Wide'(settle) + Wide'(1)));

      // What follows from the registers.
      if (!blank) begin
        assert (dut.settle_q == settle && dut.period_q == period && dut.slip_period_q == slip_period);
        assert (dut.slip_row_q == slip_row && dut.slip_group_q == slip_group);
      end
      if (!off || waits <= 2'd1) begin
        assert (Wide'(dut.gap_q) == gap && dut.at_once_q == (settle == '0) && dut.slip_on_q == (slip_period != '0));
        assert (dut.slip_one_q == (slip_period == PeriodBits'(1)) && dut.period_one_q == (period == PeriodBits'(1)));
        assert (dut.timed_q == (period != '0));
      end
      if (!off || waits == '0) assert (Wide'(dut.rest_q) == gap - Wide'(2) && Wide'(dut.slot_q) == slot);
      if (!off) assert (dut.roomy_q == (64'(slip_period) > 64'(slot)) && dut.fits_q == fits);
      if (!blank) begin
        assert (dut.slip_left_q == left && dut.slip_zero_q == (left == '0));
        assert (dut.left_q == ticks_left && dut.zero_q == (ticks_left == '0));
      end
      if (off && !blank) assert (left == '0);
      assert (dut.round_q == round && (!round || dut.slot_index_q == index_q));
      if (round) assert (32'(index_q) < SlipSlots);
      assert (dut.want_q == wanted);

      // The walk.
      assert (dut.u_walk.active_o == active && dut.u_walk.find_q == (lag == 2'd2) && dut.u_walk.found_q == (lag == 2'd1) && lag <= 2'd2);
      if (lag != '0) begin
        assert (Wide'(lag) + slot == rest + Wide'(3));
        assert (dut.u_walk.row_o == row_was && dut.u_walk.group_o == group_was && dut.u_walk.odd_q == odd_was);
        if (lag == 2'd1) assert (dut.u_walk.row_next_q == (RowBits+1)'(row_was) + (now.interleave ? (RowBits+1)'(2) : (RowBits+1)'(1)));
        if (lag == 2'd1) assert (dut.u_walk.row_ends_q == (group_was == last_group));
        // What the place to come is of the one before it.
        if (group_was != last_group) assert (more && group == group_was + 1'b1 && row == row_was && odd == odd_was);
        else begin
          assert (group == first_group);
          if ((RowBits+1)'(row_was) + (now.interleave ? (RowBits+1)'(2) : (RowBits+1)'(1)) <= (RowBits+1)'(now.last_row))
            assert (more && odd == odd_was && row == row_was + (now.interleave ? RowBits'(2) : RowBits'(1)));
          else if (now.interleave && !odd_was && now.first_row != now.last_row) assert (more && odd && row == now.first_row + 1'b1);
          else assert (!more);
        end
      end else if (more) begin
        assert (dut.u_walk.row_o == row && dut.u_walk.group_o == group && dut.u_walk.odd_q == odd);
      end else if (was_idle) begin
        assert (dut.u_walk.row_o == fresh.first_row && dut.u_walk.group_o == first_group && !dut.u_walk.odd_q);
      end else begin
        assert ((off && waits == 2'd3) || rest + Wide'(3) == slot);
      end
      if (active) begin
        assert (legal(now) && row <= now.last_row && group >= first_group && group <= last_group);
        assert (now == {dut.u_walk.interleave_o, dut.u_walk.first_row_o, dut.u_walk.last_row_o, dut.u_walk.first_beat_o, dut.u_walk.last_beat_o});
      end
      if (settling && !slip) assert (now == {dut.u_walk.interleave_o, dut.u_walk.first_row_o, dut.u_walk.last_row_o, dut.u_walk.first_beat_o, dut.u_walk.last_beat_o});
      if (settling) assert (dut.slip_q == slip && dut.first_q == first_q && dut.place_q == place);
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (trigger_o && settle == SettleBits'(3));
      cover (switch_o && settle == '0 && switch_row_o == (RowBits + 1)'(1));
      cover (trigger_o && !idle_o && !slip);
      cover (take_frame && first && now.first_row != from_row);
      if (Cycle < 20) cover (take_frame && active);
      if (Cycle < 20) cover (take_slip && held_o != '0);
    end
  end

endmodule
