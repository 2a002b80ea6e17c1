// SPDX-License-Identifier: Apache-2.0
//
// Beats pass in the clock in which they are taken, none is lost; an offered beat stays offered; settings change
// between frames only, Drain unstalled clocks after the last beat at the least, one clock long, when asked.

module formal_frame_gate #(
  parameter int unsigned Drain = 8
) (
  input logic clk_i,
  input logic rst_i,
  input logic pending_i,
  input logic stalled_i,
  input logic in_valid_i,
  input logic in_last_i,
  input logic out_ready_i
);

  logic commit_o, in_ready_o, out_valid_o;
  msn_frame_gate #(.Drain(Drain)) dut (.*);

  logic       started = 1'b0;
  logic       taken, in_frame, in_stalled, out_stalled, asked, committed, last;
  logic [7:0] quiet;    // unstalled clocks since the last beat, up to Drain
  logic [9:0] waiting;  // of those in which a change waits, nothing comes and nothing stalls
  assign taken = in_valid_i && in_ready_o;
  always_ff @(posedge clk_i) begin
    started     <= 1'b1;
    in_stalled  <= in_valid_i && !in_ready_o && !rst_i;
    out_stalled <= out_valid_o && !out_ready_i && !rst_i;
    last        <= in_last_i;
    asked       <= pending_i || (asked && !commit_o);
    committed   <= commit_o && !rst_i;
    if (taken) quiet <= '0;
    else if (!stalled_i && quiet != 8'(Drain)) quiet <= quiet + 1'b1;
    if (taken) in_frame <= !in_last_i;
    if (!pending_i || commit_o || out_valid_o || in_frame) waiting <= '0;
    else if (!stalled_i) waiting <= waiting + 1'b1;
    if (rst_i) begin
      quiet    <= 8'(Drain);
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
      if (out_stalled) assert (out_valid_o);
      if (commit_o) assert (!in_frame && quiet == 8'(Drain) && !taken && asked);
      if (committed) assert (!commit_o && out_valid_o == in_valid_i && in_ready_o == out_ready_i);
      if (in_frame) assert (out_valid_o == in_valid_i && in_ready_o == out_ready_i);  // never inside one
      if (!asked) assert (out_valid_o == in_valid_i);
    end
    if (started) assert (waiting <= 10'(Drain + 2));
  end

  // Invariant.
  always_comb begin
    if (started) begin
      assert (dut.begun == in_frame && dut.left == 8'(Drain) - quiet && quiet <= 8'(Drain));
      if (dut.closed) assert (asked && !in_frame && !out_stalled);
      assert (waiting <= (dut.closed ? 10'd1 + 10'(quiet) : 10'd0));
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
