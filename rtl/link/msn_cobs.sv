// SPDX-License-Identifier: Apache-2.0
//
// Frames packets for a serial line: 00, the packet without a zero byte in it, 00.
//
// Consistent overhead byte stuffing with each code after its run instead of before it: each zero of the packet,
// and its end, is replaced by one more than the number of bytes since the zero before (or the start). So the
// sender needs a counter and no memory; the receiver, which has the complete frame, reads it from its end. For
// packets of up to 253 bytes this equals plain COBS of the reversed packet, reversed.
//
// The first 00 leaves as soon as in_begin_i announces a packet; the packet's bytes may follow later.
// A byte a clock, no latency: out_valid_o follows in_valid_i, which must stay high until taken.
// Error: none.
// Model: model/meissner/twins/link/cobs.py

module msn_cobs #(
  parameter  int unsigned MaxBytes  = 253,  // of a packet
  localparam int unsigned CountBits = $clog2(MaxBytes + 2)
) (
  input  logic       clk_i,
  input  logic       rst_i,

  input  logic       in_begin_i,  // a packet begins now or soon
  input  logic       in_valid_i,
  output logic       in_ready_o,
  input  logic [7:0] in_data_i,
  input  logic       in_last_i,

  output logic       out_valid_o,
  input  logic       out_ready_i,
  output logic [7:0] out_data_o
);

  if (MaxBytes < 1 || MaxBytes > 253) begin : gen_check_max_bytes
    $fatal(1, "msn_cobs: MaxBytes = %0d must lie in 1 .. 253", MaxBytes);
  end

  typedef enum logic [1:0] {
    Open,   // the first 00
    Body,
    Final,  // the last code
    Close   // the second 00
  } state_e;

  state_e               state;
  logic [CountBits-1:0] count;  // bytes since the last zero, plus one
  logic                 zero, code, sent;
  assign zero = in_data_i == '0;
  assign code = state == Final || (state == Body && zero);
  assign sent = out_valid_o && out_ready_i;

  assign in_ready_o  = state == Body && out_ready_i;
  assign out_valid_o = (state == Open) ? in_begin_i || in_valid_i : (state == Body) ? in_valid_i : 1'b1;
  assign out_data_o  = code ? 8'(count) : (state == Body) ? in_data_i : '0;

  always_ff @(posedge clk_i) begin
    if (sent) begin
      case (state)
        Open:    state <= Body;
        Body:    if (in_last_i) state <= Final;
        Final:   state <= Close;
        default: state <= Open;
      endcase
      count <= (code || state == Open) ? CountBits'(1) : count + 1'b1;
    end
    if (rst_i) state <= Open;
  end

endmodule
