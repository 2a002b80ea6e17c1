// SPDX-License-Identifier: Apache-2.0
//
// Position and load from the four electrodes' codes; N = 2V0-E1-E3, M = 2V0+E2+E4, D = E1+E3-E2-E4:
//
//   x = Cx (E1-E3) / N     y = Cy (E2-E4) / M     load = Kf N / D
//
// x, y in Q2.14, saturated at +-1.0; the load in its LSBs, saturated to 0 .. 65535 (`over`); each rounded once, to
// nearest, ties away from zero. Cx = kx / 2^shift_x, Cy likewise; Kf / (65536 LSB) = kf / 2^(8 + shift_load).
// N (M) <= 0, nothing pressed: 0. D <= 0 < N: over. N above 2V0, which no sensor gives, is limited to 2V0 in the
// load's numerator. The settings must not change while samples flow. Faults:
//   saturated  a code at or beyond an end of the converter's range, top or -top - 1
//   open       an electrode without current (code >= idle) whose partner on the same layer has current
//              (code <= busy); E2, E4 as mirrored codes -E - 1
//   imbalance  |N - M| > cfg_imbalance: the two expressions of the current in eq. 18 disagree
// pressed = load >= min_load, load > 0 and no fault; else x = y = 0. over and the faults are for users of the block
// alone, as engine rtl: the core sends x, y, load and pressed.
// Correct: the load follows the position, as its D is corrected for the layers' drop (msn_cop4_correct).
// Latency S + 8 clocks, S + P + 20 if Correct; a sample every S + 1. Division steps: load S = 9, position P = 8, at one
// bit a clock 17, 15. Back-to-back samples fill the stages and wait: 62 clocks, 141 if Correct, at one bit 110, 271.
// Error: at most 1/2 LSB of x, y; at most 1/2 LSB of load (tb/extremes).
// Model: model/meissner/twins/cop/cop4.py

module msn_cop4 #(
  parameter  int unsigned SampleBits   = 17,
  parameter  int unsigned BitsPerClock = 2,
  parameter  bit          Correct      = 1'b0,
  localparam int unsigned SumBits      = SampleBits + 2
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic        [SampleBits-1:0] cfg_rail_i,        // 2V0 in codes
  input  logic        [16:0]           cfg_kx_i,
  input  logic        [3:0]            cfg_shift_x_i,
  input  logic        [16:0]           cfg_ky_i,
  input  logic        [3:0]            cfg_shift_y_i,
  input  logic        [16:0]           cfg_kf_i,
  input  logic        [3:0]            cfg_shift_load_i,
  input  logic        [6*18-1:0]       cfg_p_i,           // p0 lowest; unused unless Correct
  input  logic        [15:0]           cfg_min_load_i,    // LSBs
  input  logic        [SampleBits-2:0] cfg_top_i,
  input  logic signed [SampleBits-1:0] cfg_idle_i,
  input  logic signed [SampleBits-1:0] cfg_busy_i,
  input  logic        [SampleBits:0]   cfg_imbalance_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_e1_i,
  input  logic signed [SampleBits-1:0] in_e2_i,
  input  logic signed [SampleBits-1:0] in_e3_i,
  input  logic signed [SampleBits-1:0] in_e4_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [15:0]           out_x_o,
  output logic signed [15:0]           out_y_o,
  output logic        [15:0]           out_load_o,
  output logic                         out_pressed_o,     // x, y and load are valid
  output logic                         out_over_o,
  output logic                         out_saturated_o,
  output logic                         out_imbalance_o,
  output logic        [3:0]            out_open_o         // E1 lowest
);

  if (SampleBits < 4 || SampleBits > 24) begin : gen_check_sample_bits
    $fatal(1, "msn_cop4: SampleBits = %0d must lie in 4 .. 24", SampleBits);
  end

  // 1: sums and differences, compare codes with levels. 2: N, M, D. Both advance together.
  logic step, sum_valid, total_valid, ratios_ready;
  assign step       = ratios_ready || !total_valid;
  assign in_ready_o = step;

  // The lower layer's codes are mirrored, so that for all electrodes a high code means no current.
  logic [4*SampleBits-1:0] upper;
  logic [3:0]              at_idle, has_current, at_end;
  assign upper = {~in_e4_i, in_e3_i, ~in_e2_i, in_e1_i};
  for (genvar i = 0; i < 4; i++) begin : gen_electrode
    logic signed [SampleBits-1:0] code;
    logic        [SampleBits-2:0] size;
    logic                         below_idle, above_busy;
    assign code = signed'(upper[i*SampleBits+:SampleBits]);
    msn_compare #(.Width(SampleBits)) u_idle (.a_i(cfg_idle_i), .b_i(code), .greater_o(below_idle));
    msn_compare #(.Width(SampleBits)) u_busy (.a_i(code), .b_i(cfg_busy_i), .greater_o(above_busy));
    assign size           = code[SampleBits-2:0] ^ {(SampleBits - 1) {code[SampleBits-1]}};
    assign at_idle[i]     = !below_idle;
    assign has_current[i] = !above_busy;
    assign at_end[i]      = size >= cfg_top_i;
  end

  logic signed [SampleBits:0] sum_upper, sum_lower, sum_dx, sum_dy, total_dx, total_dy;
  logic        [3:0]          sum_open, total_open;
  logic                       sum_saturated, total_saturated, total_above;
  logic signed [SumBits-1:0]  n, m, d, mismatch;
  always_ff @(posedge clk_i) begin
    if (step) begin
      sum_valid       <= in_valid_i;
      sum_upper       <= (SampleBits + 1)'(in_e1_i) + (SampleBits + 1)'(in_e3_i);
      sum_lower       <= (SampleBits + 1)'(in_e2_i) + (SampleBits + 1)'(in_e4_i);
      sum_dx          <= (SampleBits + 1)'(in_e1_i) - (SampleBits + 1)'(in_e3_i);
      sum_dy          <= (SampleBits + 1)'(in_e2_i) - (SampleBits + 1)'(in_e4_i);
      sum_open        <= at_idle & {has_current[1:0], has_current[3:2]};
      sum_saturated   <= |at_end;

      total_valid     <= sum_valid;
      n               <= signed'(SumBits'(cfg_rail_i)) - SumBits'(sum_upper);
      m               <= signed'(SumBits'(cfg_rail_i)) + SumBits'(sum_lower);
      d               <= SumBits'(sum_upper) - SumBits'(sum_lower);
      mismatch        <= SumBits'(sum_upper) + SumBits'(sum_lower);  // M - N, in which the rail cancels
      total_dx        <= sum_dx;
      total_dy        <= sum_dy;
      total_open      <= sum_open;
      total_saturated <= sum_saturated;
      total_above     <= sum_upper[SampleBits];
    end
    if (rst_i) begin
      sum_valid   <= 1'b0;
      total_valid <= 1'b0;
    end
  end

  // The ratios of x and y in parallel; a sample starts when all dividers that it enters here are ready. Its number
  // travels with it: if an upset takes one of its ratios away, or adds one, those that are behind are dropped until the
  // numbers agree again.
  localparam int unsigned PlaceBits = SumBits + 15;
  localparam int unsigned LoadBits  = SumBits + (Correct ? 24 : 23);
  localparam int unsigned FlagBits  = 6;
  logic signed [SampleBits:0]  num_x, num_y, num_load;  // 18 bits at most: the multiplier's width
  logic signed [PlaceBits-1:0] den_x, den_y;
  logic signed [SumBits:0]     limit;
  logic                        high, low, imbalance;
  assign num_x    = (n > 0) ? total_dx : '0;
  assign num_y    = (m > 0) ? total_dy : '0;
  assign num_load = (n <= 0) ? '0 : total_above ? (SampleBits + 1)'(cfg_rail_i) : n[SampleBits:0];
  assign den_x    = PlaceBits'(n) <<< cfg_shift_x_i;
  assign den_y    = PlaceBits'(m) <<< cfg_shift_y_i;
  assign limit    = signed'((SumBits + 1)'(cfg_imbalance_i));
  msn_compare #(.Width(SumBits + 1)) u_high (
    .a_i((SumBits + 1)'(mismatch)), .b_i(limit), .greater_o(high)
  );
  msn_compare #(.Width(SumBits + 1)) u_low (
    .a_i('0 - limit), .b_i((SumBits + 1)'(mismatch)), .greater_o(low)
  );
  assign imbalance = high || low;

  logic                       start, ready_x, ready_y, valid_x, valid_y, place_valid, pop_x, pop_y, pop_load;
  logic                       load_start, load_ready, load_valid, take, free, over;
  logic                       unused_sign;
  logic        [1:0]          number_q, number_x, number_y, number_load;
  logic signed [15:0]         place_x, place_y, x, y;
  logic        [FlagBits-1:0] place_flags, load_flags;
  logic signed [SampleBits:0] place_n, load_n;
  logic signed [SumBits-1:0]  place_d;
  logic signed [LoadBits-1:0] load_den;
  logic        [37:0]         load_side, result_side;  // x, y, flags
  logic        [15:0]         fraction;
  assign start = total_valid && ratios_ready;
  always_ff @(posedge clk_i) begin
    if (start) number_q <= number_q + 1'b1;
    if (rst_i) number_q <= '0;
  end

  function automatic logic behind(logic [1:0] one, logic [1:0] other);
    behind = 2'(other - one) == 2'd1 || 2'(other - one) == 2'd2;
  endfunction

  msn_ratio #(
    .NumBits(SampleBits + 1), .DenBits(PlaceBits), .FractionBits(14), .BitsPerClock(BitsPerClock),
    .SideBits(2 + FlagBits + 2 * SumBits - 1)
  ) u_x (
    .clk_i, .rst_i,
    .cfg_scale_i(cfg_kx_i),
    .in_valid_i(start), .in_ready_o(ready_x), .in_num_i(num_x), .in_den_i(den_x),
    .in_side_i({number_q, total_open, total_saturated, imbalance, num_load, d}),
    .out_valid_o(valid_x), .out_ready_i(pop_x), .out_quotient_o(place_x),
    .out_side_o({number_x, place_flags, place_n, place_d})
  );

  msn_ratio #(
    .NumBits(SampleBits + 1), .DenBits(PlaceBits), .FractionBits(14), .BitsPerClock(BitsPerClock),
    .SideBits(2)
  ) u_y (
    .clk_i, .rst_i,
    .cfg_scale_i(cfg_ky_i),
    .in_valid_i(start), .in_ready_o(ready_y), .in_num_i(num_y), .in_den_i(den_y), .in_side_i(number_q),
    .out_valid_o(valid_y), .out_ready_i(pop_y), .out_quotient_o(place_y), .out_side_o(number_y)
  );

  if (Correct) begin : gen_correct
    logic correct_ready;
    assign ratios_ready = ready_x && ready_y;
    assign place_valid  = valid_x && valid_y && number_x == number_y;
    assign pop_x        = (place_valid && correct_ready) || (valid_y && behind(number_x, number_y));
    assign pop_y        = (place_valid && correct_ready) || (valid_x && behind(number_y, number_x));
    assign pop_load     = take;
    msn_cop4_correct #(.SumBits(SumBits), .SideBits(38)) u_correct (
      .clk_i, .rst_i,
      .cfg_p_i, .cfg_shift_i(cfg_shift_load_i),
      .in_valid_i(place_valid), .in_ready_o(correct_ready), .in_x_i(place_x), .in_y_i(place_y),
      .in_n_i(place_n), .in_d_i(place_d), .in_side_i({place_x, place_y, place_flags}),
      .out_valid_o(load_start), .out_ready_i(load_ready), .out_den_o(load_den), .out_n_o(load_n),
      .out_side_o(load_side)
    );
    assign take                = load_valid && free;
    assign {x, y, load_flags}  = result_side;
    logic unused;
    assign unused = ^number_load;

  end else begin : gen_plain
    // All three start together. The load takes two digits more than the position, which waits for it.
    assign ratios_ready = ready_x && ready_y && load_ready;
    assign load_start   = start;
    assign load_n       = num_load;
    assign load_den     = (LoadBits'(d) <<< 8) <<< cfg_shift_load_i;
    assign load_side    = '0;
    assign place_valid  = valid_x && valid_y && load_valid;
    assign take         = place_valid && number_x == number_load && number_y == number_load && free;
    assign pop_x        = take || (place_valid &&
                                   (behind(number_x, number_y) || behind(number_x, number_load)));
    assign pop_y        = take || (place_valid &&
                                   (behind(number_y, number_x) || behind(number_y, number_load)));
    assign pop_load     = take || (place_valid &&
                                   (behind(number_load, number_x) || behind(number_load, number_y)));
    assign x            = place_x;
    assign y            = place_y;
    assign load_flags   = place_flags;
    logic unused;
    assign unused = &{1'b0, cfg_p_i, place_n, place_d, result_side};
  end

  msn_ratio #(
    .NumBits(SampleBits + 1), .DenBits(LoadBits), .FractionBits(16), .BitsPerClock(BitsPerClock),
    .SideBits(2 + 38)
  ) u_load (
    .clk_i, .rst_i,
    .cfg_scale_i(cfg_kf_i),
    .in_valid_i(load_start), .in_ready_o(load_ready), .in_num_i(load_n), .in_den_i(load_den),
    .in_side_i({number_q, load_side}),
    .out_valid_o(load_valid), .out_ready_i(pop_load), .out_quotient_o({unused_sign, over, fraction}),
    .out_side_o({number_load, result_side})
  );

  // Hold the load, then gate by it. `free` is true only once the register is empty, so that out_ready_i has no
  // path back through three dividers; samples are far enough apart for that.
  logic                       held_valid, pass, pressed;
  logic signed [15:0]         held_x, held_y;
  logic        [15:0]         held_load;
  logic                       held_over;
  logic        [FlagBits-1:0] held_flags;
  assign free    = !held_valid;
  assign pass    = out_ready_i || !out_valid_o;
  assign pressed = held_load != '0 && held_load >= cfg_min_load_i && held_flags == '0;

  always_ff @(posedge clk_i) begin
    if (free) begin
      held_x        <= x;
      held_y        <= y;
      held_load     <= fraction | {16{over}};
      held_over     <= over;
      held_flags    <= load_flags;
    end
    if (free) held_valid <= take;
    else if (pass) held_valid <= 1'b0;
    if (pass) begin
      out_valid_o   <= held_valid;
      out_x_o       <= pressed ? held_x : '0;
      out_y_o       <= pressed ? held_y : '0;
      out_load_o    <= held_load;
      out_pressed_o <= pressed;
      out_over_o    <= held_over;
      {out_open_o, out_saturated_o, out_imbalance_o} <= held_flags;
    end
    if (rst_i) begin
      held_valid  <= 1'b0;
      out_valid_o <= 1'b0;
    end
  end

endmodule
