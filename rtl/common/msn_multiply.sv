// SPDX-License-Identifier: Apache-2.0
//
// A product with registers at its inputs and its output, to be mapped to the registers inside a hardware multiplier.
//
//   y = a b     a signed, b unsigned
//
// Latency 2 clocks in which enable_i is high, a product a clock. Where synthesis does not use the multiplier's own
// registers there is another version: rtl/ecp5/msn_multiply.sv.   Model: model/meissner/twins/common/arithmetic.py
// Error: none.

module msn_multiply #(
  parameter int unsigned AWidth = 18,
  parameter int unsigned BWidth = 16
) (
  input  logic                            clk_i,
  input  logic                            enable_i,

  input  logic signed [AWidth-1:0]        a_i,
  input  logic        [BWidth-1:0]        b_i,
  output logic signed [AWidth+BWidth-1:0] y_o
);

  if (AWidth < 2 || AWidth > 18) begin : gen_check_a_width
    $fatal(1, "msn_multiply: AWidth = %0d must lie in 2 .. 18", AWidth);
  end
  if (BWidth < 1 || BWidth > 17) begin : gen_check_b_width
    $fatal(1, "msn_multiply: BWidth = %0d must lie in 1 .. 17", BWidth);
  end

  logic signed [AWidth-1:0] a;
  logic        [BWidth-1:0] b;
  always_ff @(posedge clk_i) begin
    if (enable_i) begin
      a   <= a_i;
      b   <= b_i;
      y_o <= (AWidth + BWidth)'(a * signed'({1'b0, b}));
    end
  end

endmodule
