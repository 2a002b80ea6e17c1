// SPDX-License-Identifier: Apache-2.0
//
// Lets settings change only between two frames. While pending_i, the gate closes after a frame's last beat (on
// the next clock if no frame has begun), waits until the chain downstream is empty (busy_i is low), gives commit_o
// for one clock and opens on the next. No beat is lost: a closed gate is not ready. It never closes on a beat
// that has been offered but not taken.
//
// busy_i must be high from the clock after a beat is taken until the last of its results has left.
//
// Latency 0; each closing costs the clocks until the chain is empty, plus 2. With pending_i low it costs nothing.
// Model: model/meissner/twins/common/frames.py

module msn_frame_gate (
  input  logic clk_i,
  input  logic rst_i,

  input  logic pending_i,
  output logic commit_o,
  input  logic busy_i,      // the chain downstream holds a beat or owes a result

  input  logic in_valid_i,
  output logic in_ready_o,
  input  logic in_last_i,

  output logic out_valid_o,
  input  logic out_ready_i,
  output logic out_first_o  // this beat is its frame's first
);

  logic begun, closed;
  assign out_valid_o = in_valid_i && !closed;
  assign in_ready_o  = out_ready_i && !closed;
  assign out_first_o = !begun;

  logic taken;
  assign taken = out_valid_o && out_ready_i;

  // commit_o is registered because busy_i comes from the entire chain and the settings are spread over the device.
  always_ff @(posedge clk_i) begin
    commit_o <= closed && !begun && !busy_i && !commit_o;
    if (closed) closed <= !commit_o && !begun;  // never inside a frame, not even after an upset
    else        closed <= pending_i && (taken ? in_last_i : (!begun && !out_valid_o));
    if (taken) begun <= !in_last_i;
    if (rst_i) begin
      begun    <= 1'b0;
      closed   <= 1'b0;
      commit_o <= 1'b0;
    end
  end

endmodule
