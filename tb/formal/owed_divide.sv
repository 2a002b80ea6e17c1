// SPDX-License-Identifier: Apache-2.0
//
// What msn_divide guarantees, with m = |num| <= den, den > 0 (assumed):
//
//   L = floor(m 2^N / den), |out| = L rounded at its last N - FractionBits bits, up from the half on
//   out has the sign of num; |out| <= 1.0; Steps + 1 clocks after it was taken; side is that of the same division
//
// L is defined by 0 <= m 2^N - P < den with P = L den. No product is written: P and L take the same digits, from
// 0, so that P = L den by construction; the proof is that the digits are right. The registers of all three have the
// full width of Steps digits: nothing is lost. Solvers are slow with sums of three wide numbers: above 16 bits
// (Whole = 0) each turn's equation is proven, rest = digit den + remainder, 0 <= remainder < den; the identity is
// their sum over the turns.

module owed_divide #(
  parameter  int unsigned DenBits      = 34,
  parameter  int unsigned FractionBits = 14,
  parameter  int unsigned BitsPerClock = 2,
  parameter  int unsigned SideBits     = 1,
  localparam bit          Whole        = DenBits <= 16,
  localparam int unsigned QuotientBits = FractionBits + 2,
  localparam int unsigned Steps = (BitsPerClock == 1) ? FractionBits + 1 : (FractionBits + 3) / 2,
  localparam int unsigned RestBits     = DenBits + BitsPerClock,
  localparam int unsigned WideBits     = DenBits + BitsPerClock * (Steps + 1) + 2,
  localparam int unsigned LongBits     = QuotientBits + BitsPerClock
) (
  input logic                           clk_i,
  input logic                           rst_i,

  input logic                           in_valid_i,
  input logic                           in_ready_i,
  input logic signed [DenBits:0]        in_num_i,
  input logic        [DenBits-1:0]      in_den_i,
  input logic        [SideBits-1:0]     in_side_i,
  input logic                           out_valid_i,
  input logic                           out_ready_i,
  input logic signed [QuotientBits-1:0] out_quotient_i,
  input logic        [SideBits-1:0]     out_side_i,

  // signals of the divider, for the invariant
  input logic                           turn_i,
  input logic [7:0]                     count_i,
  input logic [RestBits-1:0]            rest_i,
  input logic [DenBits-1:0]             den_i,
  input logic [QuotientBits-1:0]        low_i,
  input logic [QuotientBits-1:0]        high_i,
  input logic [BitsPerClock-1:0]        step_i,
  input logic                           negative_i,
  input logic [BitsPerClock-1:0]        digit_i,
  input logic [RestBits-1:0]            triple_i
);

  localparam int unsigned Bits  = 1 + BitsPerClock * (Steps - 1);  // of L
  localparam int unsigned Extra = Bits - FractionBits;             // 1 or 2

  logic                 started = 1'b0;
  logic                 busy, negative, load, stalled;
  logic [7:0]           turns;
  logic [DenBits-1:0]   den;
  logic [SideBits-1:0]  side;
  logic [WideBits-1:0]  numerator, product;  // 2 m, P; both with the digits so far
  logic [LongBits-1:0]  digits;              // L
  logic [WideBits-1:0]  multiple;
  logic [RestBits-1:0]  rest, taken;                 // of the turn before, and digit den
  logic [DenBits:0]     magnitude;
  assign load      = in_valid_i && in_ready_i;
  assign magnitude = in_num_i[DenBits] ? -in_num_i : in_num_i;
  assign multiple  = (digit_i[0] ? WideBits'(den) : '0)
                     + ((BitsPerClock == 2 && digit_i[BitsPerClock-1]) ? WideBits'({den, 1'b0}) : '0);

  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    stalled <= out_valid_i && !out_ready_i && !rst_i;
    rest    <= rest_i;
    taken   <= RestBits'(multiple);
    if (busy && turns != 8'(Steps)) begin
      turns     <= turns + 8'd1;
      numerator <= numerator << BitsPerClock;
      product   <= (product << BitsPerClock) + multiple;
      digits    <= (digits << BitsPerClock) + LongBits'(digit_i);
    end
    if (out_valid_i && out_ready_i) busy <= 1'b0;
    if (load) begin
      busy      <= 1'b1;
      turns     <= '0;
      numerator <= WideBits'({magnitude, 1'b0});
      product   <= '0;
      digits    <= '0;
      den       <= in_den_i;
      negative  <= in_num_i[DenBits];
      side      <= in_side_i;
    end
    if (rst_i) busy <= 1'b0;
  end

  logic [LongBits-1:0]     rounded;
  logic [WideBits-1:0]     remainder;
  logic [QuotientBits-1:0] size;
  assign rounded   = (digits + (LongBits'(1) << (Extra - 1))) >> Extra;
  assign remainder = (numerator - (product << BitsPerClock)) >> BitsPerClock;
  assign size      = out_quotient_i[QuotientBits-1] ? -out_quotient_i : out_quotient_i;

  always_comb begin
    if (!started) assume (rst_i);
    if (in_valid_i) assume (in_den_i != '0 && magnitude <= {1'b0, in_den_i});
    if (started) begin
      assert (out_valid_i == (busy && turns == 8'(Steps)));
      if (!rst_i) assert (in_ready_i == (!busy || (out_valid_i && out_ready_i)));
      if (out_valid_i) begin
        if (Whole) assert (remainder < WideBits'(den));
        assert ((rest_i >> BitsPerClock) < RestBits'(den));
        assert (out_quotient_i == (negative ? -QuotientBits'(rounded) : QuotientBits'(rounded)));
        assert (size <= QuotientBits'(1) << FractionBits);
        assert (out_side_i == side);
      end
      if (stalled) assert (out_valid_i);
    end
  end

  // Invariant.
  logic [7:0] known;  // bits of L so far
  assign known = (turns == '0) ? '0 : 8'(1 + BitsPerClock * (32'(turns) - 1));
  always_comb begin
    if (started) begin
      assert (turn_i == (busy && turns != 8'(Steps)));
      if (busy) begin
        assert (turns <= 8'(Steps) && (!turn_i || count_i == turns));
        assert (den != '0 && den_i == den && negative_i == negative);
        if (Whole) assert (numerator == (product << BitsPerClock) + WideBits'(rest_i));
        assert ({low_i, step_i} == (negative ? ~digits : digits));
        if (turns != '0 && !stalled) assert (rest == taken + (rest_i >> BitsPerClock));
        if (turns == '0) assert (rest_i <= RestBits'({den, 1'b0}) && product == '0 && digits == '0);
        else begin
          assert (rest_i[BitsPerClock-1:0] == '0 && (rest_i >> BitsPerClock) < RestBits'(den));
          assert (high_i == low_i + 1'b1);
          assert (digits < (LongBits'(1) << known) || (digits == (LongBits'(1) << known) && rest_i == '0));
        end
        if (BitsPerClock == 2) begin
          if (turns == '0) assert (triple_i == '1 && !rest_i[0]);
          else assert (triple_i == RestBits'(den) + RestBits'({den, 1'b0}));
        end
        if (turns == '0) assert (low_i == {QuotientBits{negative}} && step_i == {BitsPerClock{negative}});
        if (turns == '0) assert (high_i == '0);
      end
    end
  end

  always_comb begin
    if (started && !rst_i && out_valid_i) begin
      cover (negative && digits[0] && den[DenBits-1]);
      cover (out_quotient_i == QuotientBits'(1) << FractionBits && out_ready_i && load);
      cover (out_quotient_i == '0 && negative);
      cover (stalled && rest_i != '0);
    end
  end

endmodule
