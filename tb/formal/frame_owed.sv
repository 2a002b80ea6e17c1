// SPDX-License-Identifier: Apache-2.0
//
// For any one result: busy from the clock after a frame's first beat until that result, the drop or the limit; never
// busy without an outstanding result; and never for more than 2^QuietBits quiet clocks in a row.

module formal_frame_owed #(
  parameter int unsigned Results   = 2,
  parameter int unsigned QuietBits = 9
) (
  input logic               clk_i,
  input logic               rst_i,
  input logic               taken_i,
  input logic               first_i,
  input logic [Results-1:0] done_i,
  input logic               drop_i,
  input logic               quiet_i
);

  logic busy_o;
  msn_frame_owed #(.Results(Results), .QuietBits(QuietBits)) dut (.*);

  logic                 started = 1'b0;
  logic [Results-1:0]   due;    // since the last first beat
  logic [QuietBits:0]   quiet;  // clocks in a row, busy among them
  logic                 given_up;
  assign given_up = quiet == (QuietBits + 1)'((1 << QuietBits) - 1);
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    if (taken_i && first_i) due <= '1;
    else due <= (drop_i || given_up) ? '0 : due & ~done_i;
    quiet <= (first_i && !taken_i && quiet_i && due != '0 && !given_up) ? quiet + 1'b1 : '0;
    if (rst_i) begin
      due   <= '0;
      quiet <= '0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert (busy_o == (due != '0));
      assert (quiet < (QuietBits + 1)'(1 << QuietBits));
      // Invariant.
      assert (dut.owed == due && quiet == {1'b0, dut.still});
    end
    if (started && !rst_i) begin
      cover (busy_o && done_i == '1);
      cover (busy_o && drop_i);
      cover (taken_i && first_i && busy_o);
    end
  end

endmodule
