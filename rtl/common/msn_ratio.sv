// SPDX-License-Identifier: Apache-2.0
//
// Scaled quotient of two signed numbers, saturated at +-1.0, rounded once: to nearest, ties away from zero.
//
//   out = k a / d   in Q2.FractionBits, 1.0 = 2^FractionBits;   d <= 0 saturates too: +-1.0 by the sign of k a, or 0
//
// The exact product is computed first, so that only the division rounds; dividing first would multiply its
// rounding error by k. Where |k a| exceeds d, the divider computes the sign of k a over 1 instead, so that its
// denominator is always positive.
//
//   clock  1     2    3      4 .. Steps + 4
//          a, d  k a  limit  msn_divide      (clock 1 fills the multiplier's own input registers)
//
// Latency Steps + 4 clocks, a quotient every Steps + 1 (Steps: see msn_divide). `side` travels along.
// Error: at most 1/2 LSB (tb/extremes).
// Model: model/meissner/twins/common/ratio.py

module msn_ratio #(
  parameter int unsigned ScaleBits    = 17,
  parameter int unsigned NumBits      = 18,  // of a
  parameter int unsigned DenBits      = 34,  // of d, including its sign
  parameter int unsigned FractionBits = 14,
  parameter int unsigned BitsPerClock = 2,
  parameter int unsigned SideBits     = 1
) (
  input  logic                           clk_i,
  input  logic                           rst_i,

  input  logic        [ScaleBits-1:0]    cfg_scale_i,     // k; must not change while numbers flow

  input  logic                           in_valid_i,
  output logic                           in_ready_o,
  input  logic signed [NumBits-1:0]      in_num_i,        // a
  input  logic signed [DenBits-1:0]      in_den_i,        // d
  input  logic        [SideBits-1:0]     in_side_i,

  output logic                           out_valid_o,
  input  logic                           out_ready_i,
  output logic signed [FractionBits+1:0] out_quotient_o,
  output logic        [SideBits-1:0]     out_side_o
);

  if (ScaleBits < 1 || ScaleBits > 32) begin : gen_check_scale_bits
    $fatal(1, "msn_ratio: ScaleBits = %0d must lie in 1 .. 32", ScaleBits);
  end
  if (NumBits < 2 || NumBits > 32) begin : gen_check_num_bits
    $fatal(1, "msn_ratio: NumBits = %0d must lie in 2 .. 32", NumBits);
  end
  if (DenBits < 2 || DenBits > 62) begin : gen_check_den_bits
    $fatal(1, "msn_ratio: DenBits = %0d must lie in 2 .. 62", DenBits);
  end

  // The stages in front of the divider advance together.
  logic operand_valid, product_valid, limit_valid, step, divide_ready;
  assign step       = divide_ready || !limit_valid;
  assign in_ready_o = step;

  localparam int unsigned ProductBits = ScaleBits + NumBits;
  logic        [ScaleBits-1:0]   scale;
  logic signed [NumBits-1:0]     operand;
  logic signed [DenBits-1:0]     operand_den;
  logic        [SideBits-1:0]    operand_side;
  logic signed [ProductBits-1:0] product;
  logic signed [DenBits-1:0]     den;
  logic        [SideBits-1:0]    side;

  // 3: -d <= k a < d is false unless d is positive.
  localparam int unsigned CompareBits = ((ProductBits > DenBits) ? ProductBits : DenBits) + 1;
  logic [CompareBits-1:0] wide_product, wide_den, above, below;
  logic                   fits, something;
  assign wide_product = CompareBits'(product);
  assign wide_den     = CompareBits'(den);
  assign above        = wide_product - wide_den;
  assign below        = wide_product + wide_den;
  assign fits         = above[CompareBits-1] && !below[CompareBits-1];
  assign something    = product != '0;

  logic signed [DenBits-1:0]  limit_num;
  logic        [DenBits-2:0]  limit_den;
  logic        [SideBits-1:0] limit_side;

  always_ff @(posedge clk_i) begin
    if (step) begin
      operand_valid <= in_valid_i;
      scale         <= cfg_scale_i;
      operand       <= in_num_i;
      operand_den   <= in_den_i;
      operand_side  <= in_side_i;
      product_valid <= operand_valid;
      product       <= ProductBits'(signed'({1'b0, scale}) * operand);
      den           <= operand_den;
      side          <= operand_side;
      limit_valid   <= product_valid;
      limit_num     <= fits ? DenBits'(product) : {{(DenBits-1){product[ProductBits-1]}}, something};
      limit_den     <= fits ? den[DenBits-2:0] : (DenBits-1)'(1);
      limit_side    <= side;
    end
    if (rst_i) begin
      operand_valid <= 1'b0;
      product_valid <= 1'b0;
      limit_valid   <= 1'b0;
    end
  end

  msn_divide #(
    .DenBits(DenBits - 1), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock), .SideBits(SideBits)
  ) u_divide (
    .clk_i, .rst_i,
    .in_valid_i(limit_valid), .in_ready_o(divide_ready), .in_num_i(limit_num), .in_den_i(limit_den),
    .in_side_i(limit_side),
    .out_valid_o, .out_ready_i, .out_quotient_o, .out_side_o
  );

endmodule
