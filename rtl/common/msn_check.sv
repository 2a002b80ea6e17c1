// SPDX-License-Identifier: Apache-2.0
//
// A rule that a block states about itself: from the first rst_i on, wrong_i is low at every clock edge. A simulation
// stops where it is not, and names the instance; a proof shows that it never is. No hardware: it has no output, so
// a tool that does not define SYNTHESIS has nothing to build either. No other block has code for simulation only.

module msn_check (
  input logic clk_i,
  input logic rst_i,
  input logic wrong_i
);

`ifndef SYNTHESIS
  // verilator coverage_off
  logic begun;
  initial begun = 1'b0;
  always @(posedge clk_i) if (rst_i) begun <= 1'b1;
  always_ff @(posedge clk_i) if (begun) assert (!wrong_i) else $fatal(1, "%m: a rule of the block is broken");
  // verilator coverage_on
`endif

endmodule
