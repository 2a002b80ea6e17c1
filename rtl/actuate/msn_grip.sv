// SPDX-License-Identifier: Apache-2.0
//
// The grip reflex: one command a control cycle, from the windows over the slip threshold of each finger. In doubt it
// keeps the command.
//   wish = sum of (step << n) + (speed_gain * speed >> SpeedShift) over a finger's windows over the threshold; of the
//          fingers the largest, or the smallest. n: windows over in a row just before that window, up to `boost`
//   goal = command + wish (a finger slips), command - decay (every finger reported, none was over), else command
//   command = goal, limited to minimum .. maximum and to `rate` from the last command               docs/grip.md
//
//   clock  1                  2                    3                  4
//          count the window   begin, join fingers  goal and limits    command
//
// A command leaves 4 clocks after a decision that arrives at the end of a period, or, with cfg_immediate_i, after the
// first decision over in a period; 5 clocks if the period's end has just given a command. A decision and a speed a
// clock; a speed is used for windows from 3 clocks after it. No back-pressure: nothing waits for the hand. A change of
// cfg_mode_i is a reset of one clock.
// fault_o: silent, unhealthy, at the limit, minimum > maximum, unarmed.   Model: model/meissner/twins/actuate/grip.py
// Error: none.

module msn_grip #(
  parameter  int unsigned Fingers     = 2,
  parameter  int unsigned CommandBits = 16,
  parameter  int unsigned PeriodBits  = 24,
  parameter  int unsigned TimerBits   = 16,
  parameter  int unsigned SpeedBits   = 16,
  parameter  int unsigned GainBits    = 16,
  parameter  int unsigned SpeedShift  = 8,
  localparam int unsigned IdBits      = msn_pkg::index_width(Fingers)
) (
  input  logic                          clk_i,
  input  logic                          rst_i,

  input  logic        [PeriodBits-1:0]  cfg_period_i,     // clocks; below 16: 16
  input  logic        [CommandBits-1:0] cfg_step_i,
  input  logic        [GainBits-1:0]    cfg_speed_gain_i,
  input  logic        [2:0]             cfg_boost_i,
  input  logic        [CommandBits-1:0] cfg_decay_i,
  input  logic        [CommandBits-1:0] cfg_minimum_i,
  input  logic        [CommandBits-1:0] cfg_maximum_i,
  input  logic        [CommandBits-1:0] cfg_rate_i,
  input  logic        [TimerBits-1:0]   cfg_watchdog_i,   // cycles
  input  logic                          cfg_rule_i,       // 0: any finger, 1: the weakest
  input  logic                          cfg_mode_i,       // 0: position, 1: force
  input  logic                          cfg_immediate_i,
  input  logic                          cfg_override_i,
  input  logic        [CommandBits-1:0] cfg_override_value_i,

  input  logic                          over_valid_i,     // msn_slip's decisions, or one per window
  input  logic        [IdBits-1:0]      over_id_i,        // the finger
  input  logic                          over_i,
  input  logic                          over_end_i,       // the window's last decision

  input  logic                          speed_valid_i,
  input  logic        [IdBits-1:0]      speed_id_i,
  input  logic                          speed_ok_i,       // 0: the estimator flags it as invalid
  input  logic        [SpeedBits-1:0]   speed_i,

  input  logic        [Fingers-1:0]     healthy_i,

  output logic                          out_valid_o,      // for one clock
  output logic signed [CommandBits:0]   out_word_o,       // position: the increment; force: the command
  output logic signed [CommandBits:0]   out_increment_o,
  output logic        [CommandBits-1:0] out_command_o,
  output logic                          out_force_o,      // out_word_o is the command

  output logic        [4:0]             fault_o,          // of the last cycle
  output logic        [Fingers-1:0]     faulty_o          // fingers left out of that cycle
);

  if (Fingers < 1 || Fingers > 8) begin : gen_check_fingers
    $fatal(1, "msn_grip: Fingers = %0d must lie in 1 .. 8", Fingers);
  end
  if (CommandBits < 2 || CommandBits > 16) begin : gen_check_command_bits
    $fatal(1, "msn_grip: CommandBits = %0d must lie in 2 .. 16", CommandBits);
  end
  if (PeriodBits < 5 || PeriodBits > 32) begin : gen_check_period_bits
    $fatal(1, "msn_grip: PeriodBits = %0d must lie in 5 .. 32", PeriodBits);
  end
  if (TimerBits < 1 || TimerBits > 31) begin : gen_check_timer_bits
    $fatal(1, "msn_grip: TimerBits = %0d must lie in 1 .. 31", TimerBits);
  end
  if (SpeedBits < 1 || SpeedBits > 17) begin : gen_check_speed_bits
    $fatal(1, "msn_grip: SpeedBits = %0d must lie in 1 .. 17", SpeedBits);
  end
  if (GainBits < 1 || GainBits > 17) begin : gen_check_gain_bits
    $fatal(1, "msn_grip: GainBits = %0d must lie in 1 .. 17", GainBits);
  end
  if (SpeedShift >= SpeedBits + GainBits) begin : gen_check_speed_shift
    $fatal(1, "msn_grip: SpeedShift = %0d must be below %0d", SpeedShift, SpeedBits + GainBits);
  end

  localparam logic [CommandBits-1:0] Top = '1;

  // The mode and whether it has had a command, with a parity bit: an upset of a single bit would otherwise reset a
  // position to its minimum. With a wrong parity the hand goes on as fault_o says, and the code is written again.
  logic [2:0] given;
  logic       known, live, rst;
  function automatic logic [2:0] code(logic mode, logic armed);
    code = {mode, armed, mode ^ armed};
  endfunction
  assign known = !(^given);
  assign live  = known ? given[1] : !fault_o[4];
  assign rst   = rst_i || (known && given[2] != cfg_mode_i);

  // The speed's part of a window's wish, for each finger: 0 until the first report, after a report without a speed,
  // and after a cycle in which the finger was faulty.
  localparam int unsigned ProductBits = SpeedBits + 1 + GainBits;
  logic signed [ProductBits-1:0]              product;
  logic        [ProductBits-1:0]              scaled;
  logic        [CommandBits-1:0]              new_term;
  logic        [Fingers-1:0][CommandBits-1:0] term;
  logic                                       speed_valid_1, speed_valid_2, speed_ok_1, speed_ok_2;
  logic        [IdBits-1:0]                   speed_id_1, speed_id_2;
  msn_multiply #(.AWidth(SpeedBits + 1), .BWidth(GainBits)) u_speed (
    .clk_i, .enable_i(1'b1), .a_i(signed'({1'b0, speed_i})), .b_i(cfg_speed_gain_i), .y_o(product)
  );
  assign scaled   = unsigned'(product) >> SpeedShift;
  assign new_term = !speed_ok_2 ? '0 : scaled > ProductBits'(Top) ? Top : CommandBits'(scaled);

  // A cycle begins once a period: at its end, or earlier at the first window over (cfg_immediate_i).
  localparam logic [PeriodBits-1:0] Shortest = PeriodBits'(16);
  logic [PeriodBits-1:0] clocks, last_clock;
  logic                  ends, done, early, go, go_2, go_3;
  logic [Fingers-1:0]    counted, fresh, over, seen, sick;  // the last four since the last cycle
  assign early = cfg_immediate_i && !done && !go_2 && |(fresh & ~sick);
  assign go    = (ends && !done) || (!ends && early);

  always_ff @(posedge clk_i) begin
    last_clock    <= (cfg_period_i < Shortest ? Shortest : cfg_period_i) - 1'b1;
    ends          <= clocks >= last_clock;
    clocks        <= clocks >= last_clock ? '0 : clocks + 1'b1;
    done          <= !ends && (done || go);
    go_2          <= go;
    go_3          <= go_2;
    speed_valid_1 <= speed_valid_i;
    speed_valid_2 <= speed_valid_1;
    speed_ok_1    <= speed_ok_i;
    speed_ok_2    <= speed_ok_1;
    speed_id_1    <= speed_id_i;
    speed_id_2    <= speed_id_1;
    if (rst) begin
      ends          <= 1'b0;
      clocks        <= '0;
      done          <= 1'b0;
      go_2          <= 1'b0;
      go_3          <= 1'b0;
      speed_valid_1 <= 1'b0;
      speed_valid_2 <= 1'b0;
    end
  end

  // 1: a window counts once, at its first decision over. The begin of a cycle clears what was gathered, and a decision
  // in its first clock belongs to the next cycle, without the speeds that the cycle clears.
  logic [Fingers-1:0]                  hit, counts, faulty;
  logic [Fingers-1:0][CommandBits-1:0] wish;
  logic [Fingers-1:0][2:0]             streak, streak_next;  // windows over in a row before, 7 at most
  logic [Fingers-1:0][2:0]             doublings;            // of the step: min(streak, cfg_boost_i)
  logic [CommandBits-1:0]              old_wish, old_term, new_wish;
  logic [2:0]                          old_doublings;
  always_comb begin
    {old_wish, old_term, old_doublings} = '0;
    for (int unsigned f = 0; f < Fingers; f++) begin
      hit[f]    = over_valid_i && over_id_i == IdBits'(f);
      counts[f] = hit[f] && over_i && !counted[f];
      if (hit[f]) begin
        old_wish      = go ? '0 : wish[f];
        old_term      = (go && faulty[f]) ? '0 : term[f];
        old_doublings = doublings[f];
      end
      streak_next[f] = streak[f];
      if (hit[f] && over_end_i) begin
        streak_next[f] = (counted[f] || over_i) ? streak[f] + 3'(streak[f] != '1) : '0;
      end
    end
  end
  localparam int unsigned SumBits = CommandBits + 8;
  logic [SumBits-1:0] step, sum;
  assign step     = SumBits'(cfg_step_i) << old_doublings;
  assign sum      = SumBits'(old_wish) + SumBits'(old_term) + step;
  assign new_wish = sum > SumBits'(Top) ? Top : CommandBits'(sum);

  // 2: join the working fingers. Cycles begin at least two clocks apart, so the watchdog's comparison has a clock.
  logic [Fingers-1:0][TimerBits-1:0] quiet;   // cycles in a row without a decision
  logic [Fingers-1:0]                nearly;  // one more quiet cycle reaches cfg_watchdog_i
  logic [Fingers-1:0]                silent, faulty_2;
  logic [CommandBits-1:0]            largest, smallest, joined;
  logic                              slips, falls, any_silent, any_sick;
  assign silent = nearly & ~seen;
  assign faulty = silent | sick;
  always_comb begin
    largest  = '0;
    smallest = Top;
    for (int unsigned f = 0; f < Fingers; f++) begin
      if (!faulty[f] && wish[f] > largest) largest = wish[f];
      if (!faulty[f] && wish[f] < smallest) smallest = wish[f];
    end
  end

  always_ff @(posedge clk_i) begin
    for (int unsigned f = 0; f < Fingers; f++) begin
      if (hit[f]) counted[f] <= !over_end_i && (counted[f] || over_i);
      streak[f]    <= streak_next[f];
      doublings[f] <= streak_next[f] < cfg_boost_i ? streak_next[f] : cfg_boost_i;
      if (counts[f]) wish[f] <= new_wish;
      else if (go) wish[f] <= '0;
      fresh[f]  <= (fresh[f] && !go) || counts[f];
      over[f]   <= (over[f] && !go) || (hit[f] && over_i);
      seen[f]   <= (seen[f] && !go) || hit[f];
      sick[f]   <= (sick[f] && !go) || !healthy_i[f];
      nearly[f] <= (TimerBits + 1)'(quiet[f]) + 1'b1 >= (TimerBits + 1)'(cfg_watchdog_i);
      if (go) quiet[f] <= seen[f] ? '0 : quiet[f] + TimerBits'(quiet[f] != '1);
      if (speed_valid_2 && speed_id_2 == IdBits'(f)) term[f] <= new_term;
      else if (go && faulty[f]) term[f] <= '0;
    end
    if (go) begin
      joined     <= &faulty ? '0 : cfg_rule_i ? smallest : largest;
      slips      <= |(over & ~faulty);
      falls      <= &seen && over == '0 && faulty == '0;
      any_silent <= |silent;
      any_sick   <= |sick;
      faulty_2   <= faulty;
    end
    if (rst) begin
      {counted, fresh, over, seen, sick, nearly} <= '0;
      {wish, term, quiet, streak, doublings}     <= '0;
    end
  end

  // 3: the goal and the limits of the command. The first command in a mode is not limited by `rate`: a position starts
  // at the minimum, a force at the host's override value.
  logic                   gives, live_3, gives_3;
  logic [CommandBits:0]   raised, lowered;
  logic [CommandBits-1:0] goal, ceiling, floor, low, high, at_least, next;
  logic                   reaches, below;  // `rate` allows the maximum; the command is below its limit
  assign gives   = live || !cfg_mode_i || cfg_override_i;
  assign raised  = (CommandBits + 1)'(out_command_o) + (CommandBits + 1)'(joined);
  assign lowered = (CommandBits + 1)'(out_command_o) - (CommandBits + 1)'(cfg_decay_i);

  logic [CommandBits:0] up, down;
  assign up      = (CommandBits + 1)'(out_command_o) + (CommandBits + 1)'(cfg_rate_i);
  assign down    = (CommandBits + 1)'(out_command_o) - (CommandBits + 1)'(cfg_rate_i);
  assign ceiling = !live || up[CommandBits] ? Top : CommandBits'(up);
  assign floor   = !live || down[CommandBits] ? '0 : CommandBits'(down);

  // 4: the command.
  assign at_least = goal < low ? low : goal;
  assign below    = at_least < high;
  assign next     = below ? at_least : high;
  assign out_word_o = out_force_o ? signed'({1'b0, out_command_o}) : out_increment_o;

  always_ff @(posedge clk_i) begin
    if (!live) goal <= cfg_mode_i ? cfg_override_value_i : '0;
    else if (cfg_override_i) goal <= cfg_override_value_i;
    else if (slips) goal <= raised[CommandBits] ? Top : CommandBits'(raised);
    else if (falls) goal <= lowered[CommandBits] ? '0 : CommandBits'(lowered);
    else goal <= out_command_o;
    low     <= cfg_minimum_i < floor ? floor : cfg_minimum_i > ceiling ? ceiling : cfg_minimum_i;
    high    <= cfg_maximum_i < floor ? floor : cfg_maximum_i > ceiling ? ceiling : cfg_maximum_i;
    reaches <= cfg_maximum_i <= ceiling;
    live_3  <= live;
    gives_3 <= gives;

    given       <= code(cfg_mode_i, go_3 ? gives_3 : live);
    out_valid_o <= go_3 && gives_3;
    if (go_3) begin
      if (gives_3) out_command_o <= next;
      out_increment_o <= live_3 ? signed'({1'b0, next}) - signed'({1'b0, out_command_o}) : '0;
      out_force_o     <= cfg_mode_i;
      faulty_o        <= faulty_2;
      fault_o         <= {!gives_3, cfg_minimum_i > cfg_maximum_i, gives_3 && reaches && !below,
                          any_sick, any_silent};
    end
    if (rst) begin
      out_valid_o     <= 1'b0;
      out_increment_o <= '0;
      out_command_o   <= '0;
      given           <= code(cfg_mode_i, 1'b0);
      out_force_o     <= 1'b0;
      faulty_o        <= '0;
      fault_o         <= 5'b10000;
    end
  end

endmodule
