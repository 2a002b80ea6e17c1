// SPDX-License-Identifier: Apache-2.0
//
// Keeps the newest complete image for a slow reader: two banks, one written, one read.
//
// An image is one beat per taxel with in_valid_i, `last` on the final one; it is never stalled. A complete image goes
// to the reader if the reader has none, or has not begun the one it has (which is dropped); else it waits in the
// written bank, and is dropped when the next image begins there. An image whose `last` is early, late or
// missing is dropped too. dropped_o counts all dropped images.
//
// The reader sets read_begun_i while it reads and read_done_i for a clock at the end; read_data_o is the taxel at
// the read_address_i of two clocks before. Until a new image it may read the last one again.   Model: model/meissner/twins/link/images.py

module msn_image_store #(
  parameter  int unsigned Taxels      = 4096,
  localparam int unsigned AddressBits = msn_pkg::index_width(Taxels)
) (
  input  logic                   clk_i,
  input  logic                   rst_i,

  input  logic                   in_valid_i,
  input  logic [15:0]            in_data_i,
  input  logic                   in_last_i,
  input  logic [47:0]            in_time_i,       // read with the first taxel

  output logic                   read_valid_o,    // there is an image
  output logic [47:0]            read_time_o,
  input  logic                   read_begun_i,
  input  logic                   read_done_i,
  input  logic [AddressBits-1:0] read_address_i,
  output logic [15:0]            read_data_o,

  output logic [31:0]            dropped_o
);

  if (Taxels < 2 || Taxels > 65536) begin : gen_check_taxels
    $fatal(1, "msn_image_store: Taxels = %0d must lie in 2 .. 65536", Taxels);
  end

  logic [AddressBits-1:0] place;
  logic                   bank;     // being written
  logic                   held;     // the written bank has a complete image, and no part of the next one
  logic                   dropping, first, final_place, whole, broken, replaced, move;
  logic [47:0]            written_time;
  logic [1:0]             drops;
  assign first       = place == '0 && !dropping;
  assign final_place = place == AddressBits'(Taxels - 1);
  assign whole       = in_valid_i && in_last_i && final_place && !dropping;
  assign broken      = in_valid_i && !dropping && in_last_i != final_place;
  assign move        = held && !read_begun_i && !read_done_i;
  assign replaced    = in_valid_i && first && held && !move;

  always_ff @(posedge clk_i) begin
    if (in_valid_i) begin
      place    <= (in_last_i || final_place) ? '0 : place + 1'b1;
      dropping <= !in_last_i && (dropping || final_place);
      if (first) written_time <= in_time_i;
    end
    held <= whole || (held && !move && !replaced);
    if (read_done_i) read_valid_o <= 1'b0;
    if (move) begin
      bank         <= !bank;
      read_valid_o <= 1'b1;
      read_time_o  <= written_time;
    end
    drops     <= 2'(broken) + 2'(replaced) + 2'(move && read_valid_o);  // counted a clock later, for timing
    dropped_o <= dropped_o + 32'(drops);
    if (rst_i) begin
      place        <= '0;
      dropping     <= 1'b0;
      bank         <= 1'b0;
      held         <= 1'b0;
      read_valid_o <= 1'b0;
      drops        <= '0;
      dropped_o    <= '0;
    end
  end

  msn_ram #(.Words(2 << AddressBits), .Width(16)) u_taxels (
    .clk_i,
    .write_i(in_valid_i && !dropping), .write_address_i({bank ^ move, place}), .write_data_i(in_data_i),
    .read_i(1'b1), .read_address_i({!bank, read_address_i}), .out_data_o(read_data_o)
  );

  // Reading a taxel in the clock in which it is written is undefined: while an image is read, new taxels must go to
  // the other bank.
  msn_check u_read_is_not_written (
    .clk_i, .rst_i,
    .wrong_i(!rst_i && (read_begun_i || read_done_i) && in_valid_i && !dropping && move)
  );

endmodule
