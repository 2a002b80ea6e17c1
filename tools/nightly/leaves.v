// A product as a black box, on both sides of a proof.
(* blackbox *)
module product #(
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
endmodule
