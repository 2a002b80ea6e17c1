// SPDX-License-Identifier: Apache-2.0
//
// Beats pass in the clock in which they are taken, and none is lost; an offered beat stays offered. Settings change
// only on request and between frames: commit_o is high for one clock, right after a clock in which the chain was empty
// and no beat entered, at most three clocks after that is possible. The first beat of each frame is marked.

module formal_frame_gate (
  input logic clk_i,
  input logic rst_i,
  input logic pending_i,
  input logic busy_i,
  input logic in_valid_i,
  input logic in_last_i,
  input logic out_ready_i
);

  logic commit_o, in_ready_o, out_valid_o, out_first_o;
  msn_frame_gate dut (.*);

  logic       started = 1'b0;
  logic       taken, in_frame, in_stalled, out_stalled, asked, committed, last, was_busy, was_taken;
  logic [2:0] waiting;  // clocks in which a change waits, no beat arrives and the chain is empty
  assign taken = in_valid_i && in_ready_o;
  always_ff @(posedge clk_i) begin
    started     <= 1'b1;
    in_stalled  <= in_valid_i && !in_ready_o && !rst_i;
    out_stalled <= out_valid_o && !out_ready_i && !rst_i;
    last        <= in_last_i;
    asked       <= pending_i || (asked && !commit_o);
    committed   <= commit_o && !rst_i;
    was_busy    <= busy_i;
    was_taken   <= taken && !rst_i;
    if (taken) in_frame <= !in_last_i;
    if (!pending_i || commit_o || out_valid_o || in_frame || busy_i) waiting <= '0;
    else waiting <= waiting + 1'b1;
    if (rst_i) begin
      in_frame <= 1'b0;
      asked    <= 1'b0;
      waiting  <= '0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started && in_stalled) assume (in_valid_i && in_last_i == last);
    if (started && !rst_i) begin
      assert (taken == (out_valid_o && out_ready_i));
      assert (out_first_o == !in_frame);
      if (out_stalled) assert (out_valid_o);
      if (commit_o) assert (!in_frame && !was_busy && !was_taken && !taken && asked);
      if (committed) assert (!commit_o && out_valid_o == in_valid_i && in_ready_o == out_ready_i);
      if (in_frame) assert (out_valid_o == in_valid_i && in_ready_o == out_ready_i);  // never inside one
      if (!asked) assert (out_valid_o == in_valid_i);
    end
    if (started) assert (waiting <= 3'd2);
  end

  // Invariant.
  always_comb begin
    if (started) begin
      assert (dut.begun == in_frame);
      if (dut.closed) assert (asked && !in_frame && !out_stalled);
      if (commit_o) assert (dut.closed && !was_busy && !was_taken);
      assert (waiting <= (dut.closed ? (commit_o ? 3'd2 : 3'd1) : 3'd0));
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (commit_o && in_valid_i);
      cover (committed && taken && in_last_i);
      cover (in_frame && pending_i && taken && in_last_i);
    end
  end

endmodule
