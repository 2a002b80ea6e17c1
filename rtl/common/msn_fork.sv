// SPDX-License-Identifier: Apache-2.0
//
// One stream for two consumers: each takes every word once, independently; the next word follows when both have it.
//
// Latency 0 clocks, a word a clock. The data bypass this block: both consumers read the source's.
// Model: model/meissner/twins/common/handshake.py

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

  logic a_has, b_has;  // this consumer has taken the present word
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
