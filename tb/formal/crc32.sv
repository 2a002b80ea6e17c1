// SPDX-License-Identifier: Apache-2.0
//
// The register mirrors a CRC computed bit by bit as in textbooks: highest power first, polynomial 04C11DB7.

module formal_crc32 #(
  parameter int unsigned Bits = 8
) (
  input logic            clk_i,
  input logic            clear_i,
  input logic            step_i,
  input logic [Bits-1:0] in_data_i
);

  logic [31:0] out_crc_o;
  msn_crc32 #(.Bits(Bits)) dut (.*);

  logic        started = 1'b0;
  logic [31:0] remainder, next, mirrored;
  always_comb begin
    next = remainder;
    for (int unsigned i = 0; i < Bits; i++) begin
      next = {next[30:0], 1'b0} ^ ((next[31] != in_data_i[i]) ? 32'h04C1_1DB7 : 32'h0);
    end
    for (int unsigned i = 0; i < 32; i++) mirrored[i] = remainder[31-i];
  end
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    if (clear_i) remainder <= '1;
    else if (step_i) remainder <= next;
  end

  always_comb begin
    if (!started) assume (clear_i);
    if (started) assert (out_crc_o == mirrored);
    cover (started && !clear_i && step_i && out_crc_o == 32'hDEBB_20E3);
    cover (started && clear_i && step_i && out_crc_o != '1);
  end

endmodule
