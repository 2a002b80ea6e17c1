// SPDX-License-Identifier: Apache-2.0
//
// The convert start of the frame under way, in clock ticks.
//
//   convert_i: time C = now      a frame's first sample offered: W = C      that sample taken: time_o = W
//
// ReadDuring: the next frame is converted meanwhile; C becomes that time when the frame's transfer begins (read_i).
// So a frame keeps its own time while it waits, however many conversions are lost meanwhile, and time_o keeps the
// previous frame's time until then. The converter must offer a frame's first sample before it converts (ReadDuring:
// reads) the next.
// Error: none.
// Model: model/meissner/twins/frontend/timing.py

module msn_time_stamp #(
  parameter bit ReadDuring = 1'b0
) (
  input  logic        clk_i,
  input  logic        rst_i,
  input  logic [47:0] now_i,

  input  logic        convert_i,
  input  logic        read_i,
  input  logic        valid_i,    // a sample is offered
  input  logic        ready_i,    // and taken
  input  logic        last_i,     // the frame's last

  output logic [47:0] time_o      // from the clock after the first sample is taken
);

  logic        midway, offered;
  logic [47:0] converted, waiting, first;
  assign first = offered ? waiting : converted;

  if (ReadDuring) begin : gen_during
    logic [47:0] started;
    always_ff @(posedge clk_i) begin
      if (convert_i) started <= now_i;
      if (read_i) converted <= started;
    end
  end else begin : gen_after
    always_ff @(posedge clk_i) if (convert_i) converted <= now_i;
    logic unused_read;
    assign unused_read = read_i;
  end

  always_ff @(posedge clk_i) begin
    if (valid_i && !midway) begin
      offered <= !ready_i;
      waiting <= first;
      if (ready_i) time_o <= first;
    end
    if (valid_i && ready_i) midway <= !last_i;
    if (rst_i) begin
      midway  <= 1'b0;
      offered <= 1'b0;
    end
  end

endmodule
