// SPDX-License-Identifier: Apache-2.0
//
// Product with a constant from shifts and adds, without a multiplier.
//
//   out = Constant * in
//
// In canonical signed digits: Constant = Plus - Minus with as few bits set as possible and no two set bits
// adjacent; 63 = 64 - 1 costs one subtraction. Latency 0.   Model: model/meissner/twins/common/arithmetic.py
// Error: none.

module msn_constant_multiplier #(
  parameter  int unsigned Constant = 63,
  parameter  int unsigned InBits   = 28,
  localparam int unsigned OutBits  = InBits + msn_pkg::index_width(Constant + 1)
) (
  input  logic [InBits-1:0]  in_data_i,
  output logic [OutBits-1:0] out_data_o
);

  if (Constant >= 65536) begin : gen_check_constant
    $fatal(1, "msn_constant_multiplier: Constant = %0d must be below 65536", Constant);
  end
  if (InBits < 1) begin : gen_check_in_bits
    $fatal(1, "msn_constant_multiplier: InBits = %0d must be at least 1", InBits);
  end

  // From 3c - c = 2c: a digit is +1 where only 3c has the bit set and -1 where only c has it set.
  localparam logic [17:0] Once   = 18'(Constant);
  localparam logic [17:0] Thrice = 18'(3 * Constant);
  localparam logic [17:0] Plus   = (Thrice & ~Once) >> 1;
  localparam logic [17:0] Minus  = (Once & ~Thrice) >> 1;

  // Two sums in parallel, whose carry chains overlap in time.
  logic [OutBits-1:0] more, less;
  always_comb begin
    more = '0;
    less = '0;
    for (int i = 0; i < 17; i++) begin
      if (Plus[i]) more = more + (OutBits'(in_data_i) << i);
      if (Minus[i]) less = less + (OutBits'(in_data_i) << i);
    end
  end
  assign out_data_o = more - less;

endmodule
