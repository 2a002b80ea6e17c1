// SPDX-License-Identifier: Apache-2.0
//
// One stream for two followers: each takes every word once, in its own time; the next comes when both have.
//
// Latency 0 clocks, a word a clock. No data pass here: both followers see the source's.
// Model: model/meissner/twins/common/fork.py

module msn_fork (
  input  logic clk_i,
  input  logic rst_i,

  input  logic in_valid_i,
  output logic in_ready_o,

  output logic a_valid_o,
  input  logic a_ready_i,
  output logic b_valid_o,
  input  logic b_ready_i
);

  logic a_has, b_has;  // the word at hand was taken
  assign a_valid_o  = in_valid_i && !a_has;
  assign b_valid_o  = in_valid_i && !b_has;
  assign in_ready_o = (a_has || a_ready_i) && (b_has || b_ready_i);

  always_ff @(posedge clk_i) begin
    a_has <= in_valid_i && !in_ready_o && (a_has || a_ready_i);
    b_has <= in_valid_i && !in_ready_o && (b_has || b_ready_i);
    if (rst_i) begin
      a_has <= 1'b0;
      b_has <= 1'b0;
    end
  end

endmodule
