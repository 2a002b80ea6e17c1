// SPDX-License-Identifier: Apache-2.0
//
// Reset of a board: high from configuration until good_i has been high for 16 clocks, then low.
//
// The counter must start at zero: all FPGA families used here load this value with their configuration. No other
// register of the design needs a power-up value. good_i is asynchronous (a PLL's LOCK, or constant 1).

module msn_board_reset (
  input  logic clk_i,
  input  logic good_i,
  output logic rst_o
);

  logic       good;
  logic [4:0] count = '0;
  assign rst_o = !count[4];

  msn_sync u_good (
    .clk_i, .in_data_i(good_i), .out_data_o(good)
  );

  always_ff @(posedge clk_i) begin
    if (!good) count <= '0;
    else if (!count[4]) count <= count + 1'b1;
  end

endmodule
