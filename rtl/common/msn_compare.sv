// SPDX-License-Identifier: Apache-2.0
//
// Compares two signed numbers by the sign of their difference.
//
//   greater_o = a_i > b_i
//
// Written as one subtraction, which is one carry chain; Yosys maps the operator `>` on signed numbers to two
// chains and two tables: 112 instead of 143 MHz on ECP5 where the comparison selects what is stored.
// Combinational.   Model: model/meissner/twins/common/arithmetic.py
// Error: none.

module msn_compare #(
  parameter int unsigned Width = 18
) (
  input  logic signed [Width-1:0] a_i,
  input  logic signed [Width-1:0] b_i,
  output logic                    greater_o
);

  if (Width < 1) begin : gen_check_width
    $fatal(1, "msn_compare: Width = %0d must be at least 1", Width);
  end

  logic [Width-1:0] unused_difference;
  assign {greater_o, unused_difference} = (Width + 1)'(b_i) - (Width + 1)'(a_i);

endmodule
