// SPDX-License-Identifier: Apache-2.0
//
// Two-flop synchroniser for asynchronous levels, such as a converter's BUSY.
//
//   out[n] = in[n-2]
//
// The bits of a wider input are synchronised separately and may arrive a clock apart.
// Latency 2 cycles.   Model: model/meissner/twins/common/delay.py

module msn_sync #(
  parameter int unsigned Width = 1
) (
  input  logic             clk_i,

  input  logic [Width-1:0] in_data_i,
  output logic [Width-1:0] out_data_o
);

  if (Width < 1) begin : gen_check_width
    $fatal(1, "msn_sync: Width = %0d must be at least 1", Width);
  end

  // The attribute makes placers keep the two flops together, so that the first has a full clock to settle.
  (* ASYNC_REG = "TRUE" *) logic [Width-1:0] first_q;
  (* ASYNC_REG = "TRUE" *) logic [Width-1:0] second_q;

  always_ff @(posedge clk_i) begin
    first_q  <= in_data_i;
    second_q <= first_q;
  end

  assign out_data_o = second_q;

endmodule
