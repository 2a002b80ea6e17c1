// SPDX-License-Identifier: Apache-2.0
//
// CRC-32 of a stream (ISO-HDLC, as in Ethernet, zip and zlib), Bits a step, lowest bit first.
//
//   crc = crc / x + (crc[0] + bit) (x^32 + x^26 + .. + 1), reflected: polynomial EDB88320, start FFFFFFFF
//
// The checksum is ~out_crc_o, sent lowest bit first. With Bits = 1, feeding back out_crc_o[0] only shifts, so that
// a serial sender can shift it out. After a packet with its checksum, out_crc_o is DEBB20E3.
// Error: none.
// Model: model/meissner/twins/link/packet.py

module msn_crc32 #(
  parameter int unsigned Bits = 8
) (
  input  logic            clk_i,

  input  logic            clear_i,  // start a packet; has priority over step_i
  input  logic            step_i,
  input  logic [Bits-1:0] in_data_i,
  output logic [31:0]     out_crc_o
);

  if (Bits < 1 || Bits > 32) begin : gen_check_bits
    $fatal(1, "msn_crc32: Bits = %0d must lie in 1 .. 32", Bits);
  end

  logic [31:0] next;
  always_comb begin
    next = out_crc_o;
    for (int unsigned i = 0; i < Bits; i++) begin
      next = (next >> 1) ^ ((next[0] ^ in_data_i[i]) ? 32'hEDB8_8320 : 32'h0);
    end
  end

  always_ff @(posedge clk_i) begin
    if (clear_i) out_crc_o <= '1;
    else if (step_i) out_crc_o <= next;
  end

endmodule
