// SPDX-License-Identifier: Apache-2.0
//
// Tracks whether the results of a frame have left. From its first beat on, a frame owes each of Results results (a
// centre of pressure, the last beat of a tap); busy_o is high until all have left, however long that takes. A damaged
// frame may give a result before its last beat arrives; a frame that is dropped entirely owes nothing (drop_i).
//
// An upset can lose a result. So that the sensor does not stall for ever, busy_o falls after 2^QuietBits - 1 clocks
// between two frames in which no output waits (quiet_i).
//
// One frame at a time: msn_frame_gate is closed while busy_o.   Model: model/meissner/twins/common/frames.py
// Error: at most 1 clock (tb/extremes).

module msn_frame_owed #(
  parameter int unsigned Results   = 1,
  parameter int unsigned QuietBits = 9   // 2^QuietBits - 1 clocks: no stage works longer without a beat
) (
  input  logic               clk_i,
  input  logic               rst_i,

  input  logic               taken_i,  // a beat enters
  input  logic               first_i,  // that beat, or the next one, is its frame's first
  input  logic [Results-1:0] done_i,   // a result leaves
  input  logic               drop_i,
  input  logic               quiet_i,  // nothing waits at an output

  output logic               busy_o
);

  if (Results < 1) begin : gen_check_results
    $fatal(1, "msn_frame_owed: Results = %0d must be at least 1", Results);
  end
  if (QuietBits < 2 || QuietBits > 16) begin : gen_check_quiet_bits
    $fatal(1, "msn_frame_owed: QuietBits = %0d must lie in 2 .. 16", QuietBits);
  end

  logic [Results-1:0]   owed;
  logic [QuietBits-1:0] still;
  logic                 lost;
  assign busy_o = |owed;
  assign lost   = &still;

  always_ff @(posedge clk_i) begin
    if (taken_i && first_i) owed <= '1;
    else owed <= (drop_i || lost) ? '0 : owed & ~done_i;
    still <= (taken_i || !first_i || !quiet_i || !busy_o) ? '0 : still + 1'b1;
    if (rst_i) begin
      owed  <= '0;
      still <= '0;
    end
  end

endmodule
