// Products as boxes, on both sides of a proof; and carries one after the other, as both families have them.

(* blackbox *)
module msn_multiply #(
  parameter AWidth = 18,
  parameter BWidth = 16
) (
  input                             clk_i,
  input  signed [AWidth-1:0]        a_i,
  input         [BWidth-1:0]        b_i,
  output signed [AWidth+BWidth-1:0] y_o
);
endmodule

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
