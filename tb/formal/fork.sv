// SPDX-License-Identifier: Apache-2.0
//
// Each consumer takes every word once: in words taken, it is ahead of the source by at most the present word.

module formal_fork (
  input logic clk_i,
  input logic rst_i,
  input logic in_valid_i,
  input logic a_ready_i,
  input logic b_ready_i
);

  logic in_ready_o, a_valid_o, b_valid_o;
  msn_fork dut (.*);

  logic       started = 1'b0;
  logic       in_stalled, a_stalled, b_stalled;
  logic [3:0] words, a_words, b_words;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    if (in_valid_i && in_ready_o) words <= words + 1'b1;
    if (a_valid_o && a_ready_i) a_words <= a_words + 1'b1;
    if (b_valid_o && b_ready_i) b_words <= b_words + 1'b1;
    in_stalled <= in_valid_i && !in_ready_o && !rst_i;
    a_stalled  <= a_valid_o && !a_ready_i && !rst_i;
    b_stalled  <= b_valid_o && !b_ready_i && !rst_i;
    if (rst_i) begin
      words   <= '0;
      a_words <= '0;
      b_words <= '0;
    end
  end

  logic a_took, b_took, a_done, b_done;
  assign a_took = a_words != words;
  assign b_took = b_words != words;
  assign a_done = a_took || (a_valid_o && a_ready_i);
  assign b_done = b_took || (b_valid_o && b_ready_i);

  always_comb begin
    if (!started) assume (rst_i);
    if (started && in_stalled) assume (in_valid_i);
    if (started) begin
      assert (a_words == words || a_words == words + 4'd1);
      assert (b_words == words || b_words == words + 4'd1);
    end
    if (started && !rst_i) begin
      assert (a_valid_o == (in_valid_i && !a_took));
      assert (b_valid_o == (in_valid_i && !b_took));
      if (in_valid_i) assert (in_ready_o == (a_done && b_done));
      if (a_stalled) assert (a_valid_o);
      if (b_stalled) assert (b_valid_o);
    end
  end

  // Invariant: which consumer has the present word, and that there is one.
  always_comb begin
    if (started) begin
      assert (dut.a_has == a_took);
      assert (dut.b_has == b_took);
      assert (!(dut.a_has && dut.b_has));
      if (dut.a_has || dut.b_has) assert (in_stalled);
    end
  end

  always_comb begin
    cover (started && !rst_i && a_took && !b_took && in_ready_o && words == 4'd2);
    cover (started && !rst_i && b_took && !a_took && in_ready_o && words == 4'd2);
    cover (started && !rst_i && in_ready_o && in_valid_i && !a_took && !b_took && words == 4'd3);
  end

endmodule
