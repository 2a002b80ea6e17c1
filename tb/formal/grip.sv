// SPDX-License-Identifier: Apache-2.0
//
// The commands, against docs/grip.md written with wide signed sums, and separately the properties that a hand needs:
//   a command stays within the limits, if minimum <= maximum; it never changes by more than `rate`; without an override
//   it falls by at most `decay`, and only if every finger reported, was healthy and never over since the last cycle
//   the command does not change between cycles; cycles are at least two clocks apart, and a period has one
//   the first command after a reset has an increment of 0; in mode force it needs an override
//   a change of mode is a reset of one clock
// The speed's part of a window is read from the block. Limits, rate and watchdog do not change while it runs.

module formal_grip #(
  parameter  int unsigned Fingers     = 2,
  parameter  int unsigned CommandBits = 16,
  parameter  int unsigned PeriodBits  = 24,
  parameter  int unsigned TimerBits   = 16,
  parameter  int unsigned SpeedBits   = 16,
  parameter  int unsigned GainBits    = 16,
  parameter  int unsigned SpeedShift  = 8,
  localparam int unsigned IdBits      = msn_pkg::index_width(Fingers),
  localparam int unsigned WideBits    = CommandBits + 10
) (
  input logic                   clk_i,
  input logic                   rst_i,
  input logic [PeriodBits-1:0]  cfg_period_i,
  input logic [CommandBits-1:0] cfg_step_i,
  input logic [GainBits-1:0]    cfg_speed_gain_i,
  input logic [2:0]             cfg_boost_i,
  input logic [CommandBits-1:0] cfg_decay_i,
  input logic [CommandBits-1:0] cfg_minimum_i,
  input logic [CommandBits-1:0] cfg_maximum_i,
  input logic [CommandBits-1:0] cfg_rate_i,
  input logic [TimerBits-1:0]   cfg_watchdog_i,
  input logic                   cfg_rule_i,
  input logic                   cfg_mode_i,
  input logic                   cfg_immediate_i,
  input logic                   cfg_override_i,
  input logic [CommandBits-1:0] cfg_override_value_i,
  input logic                   over_valid_i,
  input logic [IdBits-1:0]      over_id_i,
  input logic                   over_i,
  input logic                   over_end_i,
  input logic                   speed_valid_i,
  input logic [IdBits-1:0]      speed_id_i,
  input logic                   speed_ok_i,
  input logic [SpeedBits-1:0]   speed_i,
  input logic [Fingers-1:0]     healthy_i
);

  logic                        out_valid_o;
  logic signed [CommandBits:0] out_word_o, out_increment_o;
  logic [CommandBits-1:0]      out_command_o;
  logic                        out_force_o;
  logic [4:0]                  fault_o;
  logic [Fingers-1:0]          faulty_o;
  msn_grip #(
    .Fingers(Fingers), .CommandBits(CommandBits), .PeriodBits(PeriodBits), .TimerBits(TimerBits),
    .SpeedBits(SpeedBits), .GainBits(GainBits), .SpeedShift(SpeedShift)
  ) dut (.*);

  logic started = 1'b0;
  logic [3*CommandBits+TimerBits-1:0] cfg, cfg_q;
  assign cfg = {cfg_minimum_i, cfg_maximum_i, cfg_rate_i, cfg_watchdog_i};
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    cfg_q   <= cfg;
  end
  always_comb begin
    if (!started) assume (rst_i);
    if (started) assume (cfg == cfg_q);
  end

  logic mode_q, rst;
  assign rst = rst_i || (started && cfg_mode_i != mode_q);
  always_ff @(posedge clk_i) mode_q <= cfg_mode_i;

  // For each finger, since the last cycle.
  localparam logic [WideBits-1:0] Top = (WideBits)'((1 << CommandBits) - 1);
  logic [Fingers-1:0][WideBits-1:0] wish;
  logic [Fingers-1:0]               open, heard, over, unwell, counts, hit, silent, faulty;
  logic [Fingers-1:0][TimerBits-1:0] unheard, unheard_next;
  logic                             go;
  assign go = dut.go;
  always_comb begin
    for (int unsigned f = 0; f < Fingers; f++) begin
      hit[f]    = over_valid_i && 32'(over_id_i) == f;
      counts[f] = hit[f] && over_i && !open[f];
      unheard_next[f] = heard[f] ? '0 : (&unheard[f]) ? unheard[f] : unheard[f] + 1'b1;
    end
  end

  // Windows over in a row before the present one, at most seven, and the step that follows from them.
  logic [Fingers-1:0][2:0]          row;
  logic [2:0]                       boost;  // a clock ago
  logic [Fingers-1:0][WideBits-1:0] earlier, step, added;
  always_comb begin
    for (int unsigned f = 0; f < Fingers; f++) begin
      earlier[f] = go ? '0 : wish[f];
      step[f] = WideBits'(cfg_step_i);
      for (int unsigned n = 0; n < 7; n++) if (n < 32'(row[f]) && n < 32'(boost)) step[f] = step[f] + step[f];
      added[f] = earlier[f] + step[f] + ((go && faulty[f]) ? '0 : WideBits'(dut.term[f]));
    end
  end
  always_ff @(posedge clk_i) begin
    for (int unsigned f = 0; f < Fingers; f++) begin
      wish[f] <= !counts[f] ? earlier[f] : added[f] > Top ? Top : added[f];
      if (hit[f]) open[f] <= !over_end_i && (open[f] || over_i);
      if (hit[f] && over_end_i && !(open[f] || over_i)) row[f] <= '0;
      else if (hit[f] && over_end_i && row[f] != 3'd7) row[f] <= row[f] + 1'b1;
      if (go) unheard[f] <= unheard_next[f];
    end
    boost  <= cfg_boost_i;
    heard  <= go ? hit : heard | hit;
    over   <= go ? (hit & {Fingers{over_i}}) : over | (hit & {Fingers{over_i}});
    unwell <= go ? ~healthy_i : unwell | ~healthy_i;
    if (rst) begin
      {wish, unheard}             <= '0;
      {open, heard, over, unwell} <= '0;
      row                         <= '0;
      boost                       <= '0;
    end
  end

  // The fingers joined.
  logic [WideBits-1:0] most, least;
  always_comb begin
    most  = '0;
    least = Top;
    for (int unsigned f = 0; f < Fingers; f++) begin
      silent[f] = !heard[f] && unheard_next[f] >= cfg_watchdog_i;
      faulty[f] = silent[f] || unwell[f];
      if (!faulty[f] && wish[f] > most) most = wish[f];
      if (!faulty[f] && wish[f] < least) least = wish[f];
    end
  end

  logic                go_2, go_3, slips, falls;
  logic [Fingers-1:0]  was_silent, was_unwell, was_heard, was_over;  // of the last cycle
  logic [WideBits-1:0] joined;
  always_ff @(posedge clk_i) begin
    go_2 <= go && !rst;
    go_3 <= go_2 && !rst;
    if (go) begin
      joined     <= (&faulty) ? '0 : cfg_rule_i ? least : most;
      slips      <= |(over & ~faulty);
      falls      <= &heard && !(|over) && !(|faulty);
      was_silent <= silent;
      was_unwell <= unwell;
      was_heard  <= heard;
      was_over   <= over;
    end
  end

  // The goal, limited to minimum .. maximum, then by `rate`.
  logic                       armed, gives;
  logic signed [WideBits-1:0] was, goal, bounded, next;
  logic signed [WideBits-1:0] low, high, rate;
  assign was  = signed'(WideBits'(out_command_o));
  assign low  = signed'(WideBits'(cfg_minimum_i));
  assign high = signed'(WideBits'(cfg_maximum_i));
  assign rate = signed'(WideBits'(cfg_rate_i));
  assign gives = armed || !cfg_mode_i || cfg_override_i;
  always_comb begin
    goal = was;
    if (!armed && !cfg_mode_i) goal = low;
    else if (!armed || cfg_override_i) goal = signed'(WideBits'(cfg_override_value_i));
    else if (slips) goal = was + signed'(joined);
    else if (falls) goal = was - signed'(WideBits'(cfg_decay_i));
    bounded = goal;
    if (bounded < low) bounded = low;
    if (bounded > high) bounded = high;
    next = bounded;
    if (armed && next > was + rate) next = was + rate;
    if (armed && next < was - rate) next = was - rate;
  end

  logic                       due, due_live, due_mode, due_override, went;
  logic signed [WideBits-1:0] due_next, due_was;
  logic [CommandBits-1:0]     due_decay;
  logic                       out_due, out_live, out_mode, out_override;
  logic signed [WideBits-1:0] out_was, out_next;
  logic [CommandBits-1:0]     out_decay, command_q;
  logic [Fingers-1:0]         out_silent, out_unwell, out_heard, out_over;  // of the command
  logic                       ordered;
  assign ordered = cfg_minimum_i <= cfg_maximum_i;
  always_ff @(posedge clk_i) begin
    due          <= go_2 && gives && !rst;
    due_live     <= armed;
    due_mode     <= cfg_mode_i;
    due_override <= cfg_override_i;
    due_next     <= next;
    due_was      <= was;
    due_decay    <= cfg_decay_i;
    out_due      <= due && !rst;
    if (due) armed <= 1'b1;
    {out_live, out_mode, out_override} <= {due_live, due_mode, due_override};
    {out_was, out_next, out_decay}     <= {due_was, due_next, due_decay};
    went      <= go_3 && !rst;
    if (go_3) {out_silent, out_unwell, out_heard, out_over} <= {was_silent, was_unwell, was_heard, was_over};
    command_q <= out_command_o;
    if (rst) armed <= 1'b0;
  end

  // Whether this period has had its cycle.
  logic ended, had;
  always_ff @(posedge clk_i) begin
    ended <= dut.ends && !rst;
    had   <= (had && !dut.ends) || (go && !dut.ends);
    if (rst) had <= 1'b0;
  end

  logic signed [WideBits-1:0] increment;
  assign increment = WideBits'(out_increment_o);
  always_comb begin
    if (started) begin
      assert (out_valid_o == out_due);
      if (out_due) begin
        assert (was == out_next);
        assert (increment == (out_live ? out_next - out_was : '0));
        assert (out_word_o == (out_mode ? signed'({1'b0, out_command_o}) : out_increment_o));
        assert (out_force_o == out_mode);
        if (ordered) assert (was >= low && was <= high);
        assert (increment <= rate && -increment <= rate);
        if (ordered && increment < 0 && !out_override) begin
          assert (-increment <= signed'(WideBits'(out_decay)));
          assert (&out_heard && !(|out_over) && !(|out_unwell) && !(|out_silent));
        end
        if (|out_unwell || |out_silent) begin
          if (ordered && !out_override) assert (increment >= 0);
        end
        if (!out_live && out_mode) assert (out_override);
      end else if (armed) assert (out_command_o == command_q);
      if (went) begin
        assert (fault_o[0] == |out_silent && fault_o[1] == |out_unwell && fault_o[3] == !ordered);
        assert (fault_o[2] == (out_due && was >= high) && fault_o[4] == !out_due);
        assert (faulty_o == (out_silent | out_unwell));
      end
      assert (!(go && go_2));
      if (!dut.ends) assert (!(go && had));
      if (dut.ends) assert (go == !had);
    end
  end

  // Invariant.
  always_comb begin
    if (started) begin
      for (int unsigned f = 0; f < Fingers; f++) begin
        assert (WideBits'(dut.wish[f]) == wish[f] && dut.quiet[f] == unheard[f]);
        assert (dut.streak[f] == row[f] && dut.doublings[f] == (row[f] < boost ? row[f] : boost));
        if (dut.fresh[f]) assert (over[f]);
      end
      assert (dut.counted == open && dut.seen == heard && dut.over == over && dut.sick == unwell);
      assert (dut.go_2 == go_2 && dut.go_3 == go_3);
      assert (dut.given == {mode_q, armed, mode_q ^ armed} && dut.fault_o[4] == !armed);
      if (armed && ordered) assert (was >= low && was <= high);
      assert (dut.done == had && dut.last_clock >= PeriodBits'(15));
      if (dut.ends) assert (dut.clocks == '0);
      if (go_2) begin
        assert (WideBits'(dut.joined) == joined && dut.slips == slips && dut.falls == falls);
        assert (dut.any_silent == |was_silent && dut.any_sick == |was_unwell);
        assert (dut.faulty_2 == (was_silent | was_unwell));
      end
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (out_valid_o && out_live && increment > 0 && fault_o[2] && !out_override);
      cover (out_valid_o && out_live && increment > 0 && fault_o[1] && !out_override);
      cover (out_valid_o && out_live && increment < 0);
      cover (out_valid_o && out_mode && !out_live);
    end
  end

endmodule
