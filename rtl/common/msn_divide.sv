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
// Latency Steps + 1 clocks; a quotient every Steps + 1 clocks.
// `side` travels along.   Model: model/meissner/twins/common/divide.py
// Error: at most 1/2 LSB (tb/extremes).

module msn_divide #(
  parameter  int unsigned DenBits      = 34,
  parameter  int unsigned FractionBits = 14,
  parameter  int unsigned BitsPerClock = 2,
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
  localparam int unsigned RestBits = DenBits + BitsPerClock;

  // The remainder shifted for the next digit, never above den << BitsPerClock; low and high = low + 1, which enclose
  // the quotient so far; and step, the digit not yet added to them.
  logic [RestBits-1:0]     rest;
  logic [DenBits-1:0]      den;
  logic [QuotientBits-1:0] low, high;
  logic [BitsPerClock-1:0] step;
  logic                    negative;

  logic               below;
  logic [DenBits-1:0] magnitude;
  assign below = in_num_i[DenBits];
  if (BitsPerClock == 1) begin : gen_select
    assign magnitude = below ? -in_num_i[DenBits-1:0] : in_num_i[DenBits-1:0];
  end else begin : gen_carry
    // The same value, selected before the carry chain: at two bits a clock the remainder's selection already
    // follows its carry chain. 145 instead of 121 MHz; at one bit a clock this form has 132 instead of 143 MHz.
    assign magnitude = (in_num_i[DenBits-1:0] ^ {DenBits{below}}) + DenBits'(below);
  end

  logic load, turn;  // a division is accepted; a digit is found
  assign load = in_valid_i && in_ready_o;

  logic [BitsPerClock-1:0] digit;
  logic [DenBits-1:0]      remainder;
  logic [RestBits:0]       minus_1;
  assign minus_1 = {1'b0, rest} - (RestBits + 1)'(den);
  if (BitsPerClock == 1) begin : gen_one
    assign digit     = !minus_1[RestBits];
    assign remainder = minus_1[RestBits] ? rest[DenBits-1:0] : minus_1[DenBits-1:0];
  end else begin : gen_two
    logic [RestBits-1:0] triple;  // 3 den; all ones in the first clock, when it is not computed yet
    logic [RestBits:0]   minus_2, minus_3;
    logic                upper, lower;  // the digit's bits
    assign minus_2   = {1'b0, rest} - (RestBits + 1)'({den, 1'b0});
    assign minus_3   = {1'b0, rest} - {1'b0, triple};
    assign upper     = !minus_2[RestBits];
    assign lower     = upper ? !minus_3[RestBits] : !minus_1[RestBits];
    assign digit     = {upper, lower};
    assign remainder = upper ? (lower ? minus_3[DenBits-1:0] : minus_2[DenBits-1:0])
                             : (lower ? minus_1[DenBits-1:0] : rest[DenBits-1:0]);
    always_ff @(posedge clk_i) begin
      if (turn) triple <= RestBits'(den) + RestBits'({den, 1'b0});
      if (load) triple <= '1;
    end
  end

  // The last digit is not in the quotient yet and has the rounding bit: its upper bit, or the lower one at two
  // bits a clock with even FractionBits. Only a digit of all ones carries and selects `high`.
  if (BitsPerClock == 2 && FractionBits % 2 == 0) begin : gen_round_second
    assign out_quotient_o = signed'((&step) ? high << 1 : (low << 1) | QuotientBits'(|step));
  end else begin : gen_round_first
    assign out_quotient_o = signed'(step[BitsPerClock-1] ? high : low);
  end

  localparam int unsigned CountBits = msn_pkg::index_width(Steps);
  logic [CountBits-1:0] count;
  logic                 final_turn;
  assign in_ready_o = out_valid_o ? out_ready_i : !turn;
  assign final_turn = count == CountBits'(Steps - 1);
  always_ff @(posedge clk_i) begin
    if (turn) begin
      rest <= {remainder, BitsPerClock'(0)};
      // A digit enters the quotient one clock after it is found, so that only the remainder depends on it at once. A
      // negative quotient starts at -1 and counts down: the complement of each digit is appended to `low`.
      low  <= (low << BitsPerClock) | QuotientBits'(step);
      high <= (&step) ? high << BitsPerClock :
                        (low << BitsPerClock) | QuotientBits'(BitsPerClock'(step + 1'b1));
      step <= digit ^ {BitsPerClock{negative}};
    end
    if (load) begin
      {rest, den, negative} <= {RestBits'({magnitude, 1'b0}), in_den_i, below};
      {low, high, step}     <= {{QuotientBits{below}}, QuotientBits'(0), {BitsPerClock{below}}};
      out_side_o            <= in_side_i;
    end
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

endmodule
