// A part-select beyond a word's end is undefined in the source; here it is 0.
(* techmap_celltype = "$shiftx" *)
module to_shift #(
  parameter A_WIDTH = 1,
  parameter B_WIDTH = 1,
  parameter Y_WIDTH = 1,
  parameter A_SIGNED = 0,
  parameter B_SIGNED = 0
) (
  input  [A_WIDTH-1:0] A,
  input  [B_WIDTH-1:0] B,
  output [Y_WIDTH-1:0] Y
);
  \$shift #(
    .A_WIDTH (A_WIDTH),
    .B_WIDTH (B_WIDTH),
    .Y_WIDTH (Y_WIDTH),
    .A_SIGNED(0),
    .B_SIGNED(B_SIGNED)
  ) _TECHMAP_REPLACE_ (.A(A), .B(B), .Y(Y));
endmodule
