// SPDX-License-Identifier: Apache-2.0
//
// Cuts the path of `ready` at a boundary: in_ready_o is registered, data and valid are not.
//
//   out = in, in order; the one word that arrives while the consumer stalls is held
//
// Latency 0 clocks, a word a clock.   Model: model/meissner/twins/common/handshake.py

module msn_skid #(
  parameter int unsigned Width = 16
) (
  input  logic             clk_i,
  input  logic             rst_i,

  input  logic             in_valid_i,
  output logic             in_ready_o,
  input  logic [Width-1:0] in_data_i,

  output logic             out_valid_o,
  input  logic             out_ready_i,
  output logic [Width-1:0] out_data_o
);

  if (Width < 1) begin : gen_check_width
    $fatal(1, "msn_skid: Width = %0d must be at least 1", Width);
  end

  logic             held;
  logic [Width-1:0] kept;
  assign in_ready_o  = !held;
  assign out_valid_o = in_valid_i || held;
  assign out_data_o  = held ? kept : in_data_i;

  always_ff @(posedge clk_i) begin
    if (!held) kept <= in_data_i;
    held <= out_valid_o && !out_ready_i;
    if (rst_i) held <= 1'b0;
  end

endmodule
