// Yosys's operator * becomes a black box, except with a constant factor, which becomes shifts and adds.
(* techmap_celltype = "$mul" *)
module to_product #(
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
  parameter _TECHMAP_CONSTMSK_A_ = 0;
  parameter _TECHMAP_CONSTMSK_B_ = 0;
  wire _TECHMAP_FAIL_ = &_TECHMAP_CONSTMSK_A_ || &_TECHMAP_CONSTMSK_B_;
  product #(
    .A_WIDTH (A_WIDTH),
    .B_WIDTH (B_WIDTH),
    .Y_WIDTH (Y_WIDTH),
    .A_SIGNED(A_SIGNED),
    .B_SIGNED(B_SIGNED)
  ) _TECHMAP_REPLACE_ (.A(A), .B(B), .Y(Y));
endmodule
