// SPDX-License-Identifier: Apache-2.0
//
// Speed of shear from the level of one pressure-conductive rubber, or a flag with the reason why there is none.
//
//   v = ((level - Vi) / (k0 + k1 Vi))^(1/n) = exp2((log2(level - Vi) - log2(k0 + k1 Vi)) / n)
//
// The inverse of dV = k v^n; the papers print the exponent as -n. A level is the sum over a window of 2^WindowLog2
// samples, times 2^SettleLog2; Vi is the sum over 2^SettleLog2 windows at rest: so all levels have the same unit.
// The rules by which Vi is found, held and dropped, the flags and the bounds: docs/shear_speed.md
//
//   clock  1     2 .. 19  20  21 .. 29      30 .. 47  48     49 .. 54  55        56, 57  58
//          look  k1 Vi    k   log2 of both  y / n     round  exp2      v taken   judge   out
//
// A multiplication takes a clock a bit; a window takes far longer. With any flag the speed is 0. Latency 58
// clocks after a window's last sample, in which no sample is taken.   Model: model/meissner/twins/slip/shear_speed.py
// Error: at most 0.000023 + 0.000047 / n of v and 1/2 LSB at the default size (tb/extremes): 0.00045 at n = 0.11.

module msn_shear_speed #(
  parameter  int unsigned SampleBits    = 17,
  parameter  int unsigned WindowLog2    = 6,
  parameter  int unsigned SettleLog2    = 3,
  parameter  int unsigned TableBits     = 6,
  parameter  int unsigned FractionBits  = 16,
  parameter  int unsigned SpeedBits     = 24,
  parameter  int unsigned SpeedFraction = 20,
  localparam int unsigned LevelBits     = SampleBits + WindowLog2 + SettleLog2
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic        [LevelBits-1:0]  cfg_k0_i,
  input  logic signed [17:0]           cfg_k1_i,        // 16 bits of fraction
  input  logic        [15:0]           cfg_exponent_i,  // 1/n, 11 bits of fraction
  input  logic signed [LevelBits-1:0]  cfg_vi_min_i,    // Vi outside of min .. max: Range
  input  logic signed [LevelBits-1:0]  cfg_vi_max_i,
  input  logic        [LevelBits-1:0]  cfg_noise_i,     // a rise below this, or no rise: Small
  input  logic        [LevelBits-1:0]  cfg_still_i,     // a level that moves by more is not at rest
  input  logic signed [SampleBits-1:0] cfg_full_i,      // a code at or above this: Clipped
  input  logic        [SpeedBits-1:0]  cfg_limit_i,     // a speed above this: Fast
  input  logic        [31:0]           cfg_travel_i,    // Rising until the sum of speeds reaches this

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic                         in_hold_i,       // the normal force changes
  input  logic                         in_restart_i,    // samples were lost before this one

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic        [SpeedBits-1:0]  out_speed_o,
  output logic        [7:0]            out_flags_o,     // Saturated, Fast, Rising, Clipped,
                                                        // Denominator, Small, Range, Unsettled
  output logic signed [LevelBits-1:0]  out_vi_o,        // of this window; both 0 with Unsettled
  output logic signed [LevelBits:0]    out_rise_o
);

  if (SampleBits < 4 || SampleBits > 24) begin : gen_check_sample_bits
    $fatal(1, "msn_shear_speed: SampleBits = %0d must lie in 4 .. 24", SampleBits);
  end
  if (WindowLog2 < 1 || WindowLog2 > 12) begin : gen_check_window
    $fatal(1, "msn_shear_speed: WindowLog2 = %0d must lie in 1 .. 12", WindowLog2);
  end
  if (SettleLog2 > 8) begin : gen_check_settle
    $fatal(1, "msn_shear_speed: SettleLog2 = %0d must lie in 0 .. 8", SettleLog2);
  end
  if (SpeedBits < 8 || SpeedBits > 32) begin : gen_check_speed_bits
    $fatal(1, "msn_shear_speed: SpeedBits = %0d must lie in 8 .. 32", SpeedBits);
  end

  localparam int unsigned TotalBits  = SampleBits + WindowLog2;
  localparam int unsigned LogBits    = msn_pkg::index_width(LevelBits + 2) + FractionBits;
  localparam int unsigned PowerWhole = LogBits - FractionBits + 6;  // 1/n below 32, and the sign
  localparam int unsigned FactorBits = 18;
  localparam int unsigned TermBits   = (LevelBits > LogBits + 1) ? LevelBits : LogBits + 1;
  localparam int unsigned CountBits  = SettleLog2 + 1;

  typedef enum logic [2:0] {Gather, Look, Scale, Logs, Raise, Power, Judge, Report} state_e;
  state_e     state;
  logic [4:0] turn;  // clocks spent in a state
  logic       accept, window_ends, turns_end;
  assign in_ready_o  = state == Gather;
  assign out_valid_o = state == Report;
  assign accept      = in_valid_i && in_ready_o;
  assign turns_end   = turn == 5'(FactorBits - 1);

  // The window so far.
  logic        [WindowLog2-1:0] place, place_q;
  logic signed [TotalBits-1:0]  total, total_before;
  logic                         held, clipped, first;
  assign place        = in_restart_i ? '0 : place_q;
  assign first        = place == '0;
  assign window_ends  = &place;
  assign total_before = first ? '0 : total;
  always_ff @(posedge clk_i) begin
    if (accept) begin
      place_q <= place + 1'b1;
      total   <= total_before + TotalBits'(in_data_i);
      held    <= in_hold_i || (!first && held);
      clipped <= in_data_i >= cfg_full_i || (!first && clipped);
    end
    if (rst_i) place_q <= '0;
  end

  // State of the level: a reference near which it stays, and Vi once it has been at rest.
  logic                        seen, settled;
  logic signed [LevelBits-1:0] reference, vi, group;
  logic        [CountBits-1:0] count;
  logic        [31:0]          travel;

  // Look: compare the window's level with the reference and with Vi.
  localparam int unsigned WideBits = LevelBits + 2;
  logic signed [LevelBits-1:0] level;
  logic signed [LevelBits:0]   rise;
  logic signed [WideBits-1:0]  moved, still, noise;
  logic                        up, down, outside;
  assign level = LevelBits'(total) << SettleLog2;
  assign moved = WideBits'(level) - WideBits'(reference);
  assign still = signed'(WideBits'(cfg_still_i));
  assign noise = signed'(WideBits'(cfg_noise_i));
  always_ff @(posedge clk_i) begin
    if (state == Look) begin
      up      <= seen && moved > still;
      down    <= seen && moved < -still;
      rise    <= (LevelBits + 1)'(level) - (LevelBits + 1)'(vi);
      outside <= vi < cfg_vi_min_i || vi > cfg_vi_max_i;
    end
  end

  // Multiply a bit a clock, the factor's lowest bit first: the product's low bits shift into the factor's register.
  logic signed [TermBits-1:0]            term;
  logic signed [TermBits:0]              upper, addend, upper_next;
  logic        [FactorBits-1:0]          lower;
  logic signed [TermBits+FactorBits:0]   product;
  assign addend     = lower[0] ? (TermBits + 1)'(term) : '0;
  assign upper_next = turns_end ? upper - addend : upper + addend;  // the last bit is the sign
  assign product    = {upper, lower};

  // k0 + k1 Vi, and the logarithms: of k, then of the rise.
  localparam int unsigned KBits = LevelBits + 3;
  logic signed [KBits-1:0]   k;
  logic                      log_in, log_out, log_ready, positive, slight, slight_q;
  logic        [LevelBits:0] log_data;
  logic        [LogBits-1:0] log_result, log_k;
  logic                      log_second;
  assign positive = k > 0;
  assign slight    = WideBits'(rise) < noise || rise <= 0;
  assign log_in   = state == Logs && (turn == 5'd1 || turn == 5'd2);
  assign log_data = (turn == 5'd1) ? k[LevelBits:0] : unsigned'(rise);
  msn_log2 #(.InBits(LevelBits + 1), .TableBits(TableBits), .FractionBits(FractionBits)) u_log (
    .clk_i, .rst_i,
    .in_valid_i(log_in), .in_ready_o(log_ready), .in_data_i(log_data),
    .out_valid_o(log_out), .out_ready_i(1'b1), .out_data_o(log_result)
  );

  always_ff @(posedge clk_i) begin
    if (state == Logs && turn == '0) k <= KBits'(signed'({1'b0, cfg_k0_i})) + KBits'(product >>> 16);
    if (log_out) log_k <= log_result;
    log_second <= log_out;
    case (state)
      Look: begin
        term  <= TermBits'(vi);
        lower <= unsigned'(cfg_k1_i);
        upper <= '0;
      end
      Scale, Raise: {upper, lower} <= signed'({upper_next, lower}) >>> 1;
      Logs: begin
        term  <= TermBits'(signed'({1'b0, log_result})) - TermBits'(signed'({1'b0, log_k}));
        if (log_out) lower <= FactorBits'(cfg_exponent_i);
        if (log_out) upper <= '0;
      end
      default: ;
    endcase
  end

  localparam int unsigned PowerBits = PowerWhole + FractionBits;
  logic                        power_in, power_valid, power_ready, power_taken, speed_valid;
  logic signed [PowerBits-1:0] power;
  logic        [SpeedBits-1:0] speed_out, speed;
  assign power_in = state == Power && turn == '0;
  msn_round_sat #(.InWidth(TermBits + FactorBits + 1), .OutWidth(PowerBits), .DropBits(11)) u_round (
    .clk_i, .rst_i,
    .in_valid_i(power_in), .in_ready_o(power_taken), .in_data_i(product),
    .out_valid_o(power_valid), .out_ready_i(power_ready), .out_data_o(power)
  );
  msn_exp2 #(
    .WholeBits(PowerWhole), .TableBits(TableBits), .FractionBits(FractionBits), .OutBits(SpeedBits),
    .OutFraction(SpeedFraction)
  ) u_exp (
    .clk_i, .rst_i,
    .in_valid_i(power_valid), .in_ready_o(power_ready), .in_data_i(power),
    .out_valid_o(speed_valid), .out_ready_i(1'b1), .out_data_o(speed_out)
  );

  // Judge: flags, then the state after the window.
  logic       stays, blocked, fresh, rests, full;
  logic [4:0] reasons;  // flags that rule out a speed
  logic [7:0] flags;
  assign stays   = settled && !held && (clipped || !down);
  logic [32:0] travel_sum;
  logic        blocked_q, fast;
  assign reasons    = {clipped, {3{stays && !clipped}} & {!positive, slight, outside}, !stays};
  assign blocked    = |reasons;
  assign travel_sum = 33'(travel) + 33'(speed);
  assign flags      = {{3{!blocked_q}} & {&speed, fast, travel < cfg_travel_i}, reasons};
  always_ff @(posedge clk_i) begin
    blocked_q <= blocked;  // both are stable since k was computed
    slight_q  <= slight;
    if (state == Judge && turn == '0) begin
      travel <= (blocked_q || up) ? '0 : travel_sum[32] ? '1 : travel_sum[31:0];
      fast   <= speed > cfg_limit_i;
    end
  end

  logic        [CountBits-1:0] count_now;
  logic signed [LevelBits-1:0] group_now;
  assign fresh     = up || down || !seen;
  assign rests     = !stays || slight_q;
  assign count_now = fresh ? '0 : count;
  assign group_now = LevelBits'(total) + ((count_now == '0) ? '0 : group);
  assign full      = rests && count_now == CountBits'((1 << SettleLog2) - 1);

  always_ff @(posedge clk_i) begin
    turn <= turn + 1'b1;
    case (state)
      Gather: if (accept && window_ends) state <= Look;
      Look:   begin state <= Scale; turn <= '0; end
      Scale:  if (turns_end) begin state <= Logs; turn <= '0; end
      Logs:   if (log_out && log_second) begin state <= Raise; turn <= '0; end
      Raise:  if (turns_end) begin state <= Power; turn <= '0; end
      Power:  if (speed_valid) begin state <= Judge; turn <= '0; end
      Judge:  if (turn != '0) state <= Report;
      default: if (out_ready_i) state <= Gather;  // Report
    endcase
    if (speed_valid) speed <= speed_out;
    if (state == Judge && turn != '0) begin
      out_speed_o <= (|flags) ? '0 : speed;
      out_flags_o <= flags;
      out_vi_o    <= stays ? vi : '0;
      out_rise_o  <= stays ? rise : '0;
      if (held || clipped) begin
        count <= '0;
        if (held) {seen, settled} <= 2'b00;
      end else begin
        count   <= (full || !rests) ? '0 : count_now + 1'b1;
        group   <= group_now;
        if (full) vi <= group_now;
        if (fresh || full) reference <= level;
        seen    <= 1'b1;
        settled <= stays || full;
      end
    end
    if (accept && in_restart_i) {seen, settled} <= 2'b00;
    if (rst_i) begin
      state   <= Gather;
      seen    <= 1'b0;
      settled <= 1'b0;
    end
  end

  // The stages of logarithm and power are always ready: there is one number at a time, taken as soon as it is valid.
  logic unused_ready;
  assign unused_ready = log_ready & power_taken;

endmodule
