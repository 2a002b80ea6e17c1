// SPDX-License-Identifier: Apache-2.0
//
// Quotient of a signed numerator by an unsigned denominator, |num| <= den, den > 0, rounded to nearest,
// ties away from zero:   out = num / den   in Q2.FractionBits; 1.0 = 2^FractionBits is reached exactly.
//
// Restoring division of |num|, BitsPerClock bits a clock: the remainder is compared with den, at two bits also
// with 2 den and 3 den. The last bit weighs half an LSB and decides the rounding. The quotient so far is kept
// as floor and floor + 1, so neither rounding nor the sign needs an adder.
//
//   Steps = FractionBits + 1 (one bit a clock), (FractionBits + 3) / 2 (two bits)
//   clock  1               2 .. Steps + 1
//          |num|, den      one digit a clock; at two bits 3 den is computed in clock 2: the first digit is below 3
//
// Latency Steps + 1 clocks; a quotient every Steps + 1 clocks, every clock if Pipelined.
// `side` travels along.   Model: model/meissner/twins/common/divide.py
// Error: at most 1/2 LSB (tb/extremes).

module msn_divide #(
  parameter  int unsigned DenBits      = 34,
  parameter  int unsigned FractionBits = 14,
  parameter  int unsigned BitsPerClock = 2,
  parameter  bit          Pipelined    = 1'b0,
  parameter  int unsigned SideBits     = 1,  // payload that only travels along
  localparam int unsigned QuotientBits = FractionBits + 2
) (
  input  logic                           clk_i,
  input  logic                           rst_i,

  input  logic                           in_valid_i,
  output logic                           in_ready_o,
  input  logic signed [DenBits:0]        in_num_i,
  input  logic        [DenBits-1:0]      in_den_i,
  input  logic        [SideBits-1:0]     in_side_i,

  output logic                           out_valid_o,
  input  logic                           out_ready_i,
  output logic signed [QuotientBits-1:0] out_quotient_o,
  output logic        [SideBits-1:0]     out_side_o
);

  if (DenBits < 1) begin : gen_check_den_bits
    $fatal(1, "msn_divide: DenBits = %0d must be at least 1", DenBits);
  end
  if (FractionBits < 1 || FractionBits > 30) begin : gen_check_fraction_bits
    $fatal(1, "msn_divide: FractionBits = %0d must lie in 1 .. 30", FractionBits);
  end
  if (BitsPerClock < 1 || BitsPerClock > 2) begin : gen_check_bits_per_clock
    $fatal(1, "msn_divide: BitsPerClock = %0d must be 1 or 2", BitsPerClock);
  end

  localparam int unsigned Steps = (BitsPerClock == 1) ? FractionBits + 1 : (FractionBits + 3) / 2;
  localparam int unsigned Ranks = Pipelined ? Steps + 1 : 1;  // of registers: one a step, or one for all
  localparam int unsigned Units = Pipelined ? Steps : 1;      // each computes one digit
  localparam int unsigned RestBits = DenBits + BitsPerClock;

  // A rank holds: rest, the remainder shifted for the next digit, never above den << BitsPerClock; low and
  // high = low + 1, which enclose the quotient so far; and step, the digit not yet added to them.
  localparam int unsigned RankBits = RestBits + DenBits + 2 * QuotientBits + BitsPerClock + 1 + SideBits;
  logic [Ranks-1:0][RankBits-1:0] rank;
  logic [Units-1:0][RankBits-1:0] after;  // a rank after its unit's digit

  logic                below;
  logic [DenBits-1:0]  magnitude;
  logic [RankBits-1:0] loaded;
  assign below     = in_num_i[DenBits];
  if (BitsPerClock == 1) begin : gen_select
    assign magnitude = below ? -in_num_i[DenBits-1:0] : in_num_i[DenBits-1:0];
  end else begin : gen_carry
    // The same value, selected before the carry chain: at two bits a clock the remainder's selection already
    // follows its carry chain. 145 instead of 121 MHz; at one bit a clock this form has 132 instead of 143 MHz.
    assign magnitude = (in_num_i[DenBits-1:0] ^ {DenBits{below}}) + DenBits'(below);
  end
  assign loaded    = {
    RestBits'({magnitude, 1'b0}), in_den_i, {QuotientBits{below}}, QuotientBits'(0), {BitsPerClock{below}},
    below, in_side_i
  };

  // load: rank 0 accepts a division; turn: the units advance.
  logic load, turn;
  assign load = in_valid_i && in_ready_o;

  for (genvar u = 0; u < Units; u++) begin : gen_unit
    logic [RestBits-1:0]     rest;
    logic [DenBits-1:0]      den;
    logic [QuotientBits-1:0] low, high;
    logic [BitsPerClock-1:0] step;
    logic                    negative;
    logic [SideBits-1:0]     side;
    assign {rest, den, low, high, step, negative, side} = rank[u];

    logic [BitsPerClock-1:0] digit;
    logic [DenBits-1:0]      remainder;

    if (BitsPerClock == 1) begin : gen_one
      logic [RestBits:0] minus_1;
      assign minus_1   = {1'b0, rest} - (RestBits + 1)'(den);
      assign digit     = !minus_1[RestBits];
      assign remainder = minus_1[RestBits] ? rest[DenBits-1:0] : minus_1[DenBits-1:0];
    end else begin : gen_two
      // 3 den of rank u; all ones in the first clock, when it is not computed yet.
      logic [RestBits-1:0] triple;
      logic [RestBits:0]   minus_1, minus_2, minus_3;
      logic                upper, lower;  // the digit's bits
      assign minus_1   = {1'b0, rest} - (RestBits + 1)'(den);
      assign minus_2   = {1'b0, rest} - (RestBits + 1)'({den, 1'b0});
      assign minus_3   = {1'b0, rest} - {1'b0, triple};
      assign upper     = !minus_2[RestBits];
      assign lower     = upper ? !minus_3[RestBits] : !minus_1[RestBits];
      assign digit     = {upper, lower};
      assign remainder = upper ? (lower ? minus_3[DenBits-1:0] : minus_2[DenBits-1:0])
                               : (lower ? minus_1[DenBits-1:0] : rest[DenBits-1:0]);

      if (!Pipelined) begin : gen_turning
        always_ff @(posedge clk_i) begin
          if (turn) triple <= RestBits'(den) + RestBits'({den, 1'b0});
          if (load) triple <= '1;
        end
      end else if (u == 0) begin : gen_first
        assign triple = '1;
      end else if (u == 1) begin : gen_second
        always_ff @(posedge clk_i) begin
          if (turn) triple <= RestBits'(gen_unit[0].den) + RestBits'({gen_unit[0].den, 1'b0});
        end
      end else begin : gen_later
        always_ff @(posedge clk_i) if (turn) triple <= gen_unit[u-1].gen_two.triple;
      end
    end

    // A digit enters the quotient one clock after it is found, so that only the remainder depends on it at once.
    logic [QuotientBits-1:0] low_next, high_next;
    assign low_next  = (low << BitsPerClock) | QuotientBits'(step);
    assign high_next = (&step) ? high << BitsPerClock
                               : (low << BitsPerClock) | QuotientBits'(BitsPerClock'(step + 1'b1));

    // A negative quotient starts at -1 and counts down: the complement of each digit is appended to `low`.
    assign after[u] = {
      remainder, BitsPerClock'(0), den, low_next, high_next, digit ^ {BitsPerClock{negative}}, negative, side
    };
  end

  // The last digit is not in the quotient yet and has the rounding bit: its upper bit, or the lower one at two
  // bits a clock with even FractionBits. Only a digit of all ones carries and selects `high`.
  logic [QuotientBits-1:0] last_low, last_high;
  logic [BitsPerClock-1:0] last_step;
  assign {last_low, last_high, last_step} = rank[Ranks-1][SideBits+1+:2*QuotientBits+BitsPerClock];
  assign out_side_o                       = rank[Ranks-1][SideBits-1:0];
  if (BitsPerClock == 2 && FractionBits % 2 == 0) begin : gen_round_second
    assign out_quotient_o = signed'((&last_step) ? last_high << 1
                                                 : (last_low << 1) | QuotientBits'(|last_step));
  end else begin : gen_round_first
    assign out_quotient_o = signed'(last_step[BitsPerClock-1] ? last_high : last_low);
  end

  if (Pipelined) begin : gen_pipe
    logic [Steps:0] valid;
    assign in_ready_o  = out_ready_i || !out_valid_o;
    assign out_valid_o = valid[Steps];
    assign turn        = in_ready_o;
    always_ff @(posedge clk_i) begin
      if (load) rank[0] <= loaded;
      if (turn) rank[Steps:1] <= after;
      if (turn) valid <= {valid[Steps-1:0], in_valid_i};
      if (rst_i) valid <= '0;
    end

  end else begin : gen_turn
    localparam int unsigned CountBits = msn_pkg::index_width(Steps);
    logic [CountBits-1:0] count;
    logic                 final_turn;
    assign in_ready_o = out_valid_o ? out_ready_i : !turn;
    assign final_turn = count == CountBits'(Steps - 1);
    always_ff @(posedge clk_i) begin
      if (turn) rank[0] <= after[0];
      if (load) rank[0] <= loaded;
      count <= turn ? count + 1'b1 : '0;
      if (load) turn <= 1'b1;
      else if (final_turn) turn <= 1'b0;
      if (turn && final_turn) out_valid_o <= 1'b1;
      else if (out_ready_i) out_valid_o <= 1'b0;
      if (rst_i) begin
        turn        <= 1'b0;
        count       <= '0;
        out_valid_o <= 1'b0;
      end
    end
  end

endmodule
