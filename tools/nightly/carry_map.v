// Ripple carry, as in both families, so that the proof has the same sums on both sides.
(* techmap_celltype = "$lcu" *)
module ripple #(
  parameter WIDTH = 1
) (
  input  [WIDTH-1:0] P,
  input  [WIDTH-1:0] G,
  input              CI,
  output [WIDTH-1:0] CO
);
  wire [WIDTH:0] c;
  assign c  = {CO, CI};
  assign CO = G | P & c[WIDTH-1:0];
endmodule
