// SPDX-License-Identifier: Apache-2.0
//
// A memory with one place to write and one to read, and the register of its output that block RAMs have.
//
//   out_data_o = the word at read_address_i, two reads later        a read: a clock with read_i
//
// The word's first register is the memory's slow output (5.8 ns on ECP5), the second the one beside it, so nothing but
// that register may follow the memory. Reading a word in the clock in which it is written is undefined: the user
// checks that no result depends on it. Where synthesis does not use the memory's own output register there is another
// version: rtl/ecp5/msn_ram.sv. Latency 2 reads.   Model: model/meissner/twins/common/delay.py
// Error: none.

module msn_ram #(
  parameter  int unsigned Words       = 1024,
  parameter  int unsigned Width       = 18,
  localparam int unsigned AddressBits = msn_pkg::index_width(Words)
) (
  input  logic                   clk_i,

  input  logic                   write_i,
  input  logic [AddressBits-1:0] write_address_i,
  input  logic [Width-1:0]       write_data_i,

  input  logic                   read_i,
  input  logic [AddressBits-1:0] read_address_i,
  output logic [Width-1:0]       out_data_o
);

  if (Words < 1) begin : gen_check_words
    $fatal(1, "msn_ram: Words = %0d must be at least 1", Words);
  end
  if (Width < 1) begin : gen_check_width
    $fatal(1, "msn_ram: Width = %0d must be at least 1", Width);
  end

  (* no_rw_check *) logic [Width-1:0] memory [Words];
  logic [Width-1:0] fetched;
  always_ff @(posedge clk_i) begin
    if (write_i) memory[write_address_i] <= write_data_i;
    if (read_i) begin
      fetched    <= memory[read_address_i];
      out_data_o <= fetched;
    end
  end

endmodule
