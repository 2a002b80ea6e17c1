// SPDX-License-Identifier: Apache-2.0
//
// Lets settings change between two frames only. While pending_i, the gate closes after a frame's last beat (on
// the next clock if no frame has begun), waits Drain clocks in which the chain behind it is not stalled, so that
// the frame has left it, gives commit_o for one clock and opens on the next. Nothing is lost: a closed gate is
// not ready. It never closes on a beat that was offered and not taken.
//
// Latency 0; a change costs Drain + 1 clocks, nothing pending costs nothing.
// Model: model/meissner/common/frame_gate.py

module msn_frame_gate #(
  parameter int unsigned Drain = 8  // clocks from the last beat in to the last result out of the chain
) (
  input  logic clk_i,
  input  logic rst_i,

  input  logic pending_i,
  output logic commit_o,
  input  logic stalled_i,  // the chain's result waits: valid and not ready

  input  logic in_valid_i,
  output logic in_ready_o,
  input  logic in_last_i,

  output logic out_valid_o,
  input  logic out_ready_i
);

  if (Drain < 1 || Drain > 255) begin : gen_check_drain
    $fatal(1, "msn_frame_gate: Drain = %0d clocks must lie in 1 .. 255", Drain);
  end

  logic [7:0] left;  // clocks until the chain is empty
  logic       begun, closed, drained;
  assign drained = left == 8'd0;

  assign out_valid_o = in_valid_i && !closed;
  assign in_ready_o  = out_ready_i && !closed;
  assign commit_o    = closed && drained;

  logic taken;
  assign taken = out_valid_o && out_ready_i;

  always_ff @(posedge clk_i) begin
    if (closed) closed <= !drained;
    else        closed <= pending_i && (taken ? in_last_i : (!begun && !out_valid_o));
    if (taken) begin
      begun <= !in_last_i;
      left  <= 8'(Drain);
    end else if (!stalled_i && !drained) begin
      left <= left - 8'd1;
    end
    if (rst_i) begin
      begun  <= 1'b0;
      closed <= 1'b0;
      left   <= 8'd0;
    end
  end

endmodule
