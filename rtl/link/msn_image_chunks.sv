// SPDX-License-Identifier: Apache-2.0
//
// Cuts the newest complete image (msn_image_store) into chunks of Chunk taxels, the last one shorter if need be.
//
//   first = 0, Chunk, 2 Chunk, ..    final = first + Chunk >= Taxels    number: images sent before this one, mod 256
//
// chunk_valid_o: a chunk waits. take_i, for a clock, begins it: from then on the image is kept until its final taxel.
// step_i goes on to the next taxel; with end_o the present taxel is the chunk's last, and step_i completes the chunk.
// The next take_i may follow 2 clocks after that: in the first clock chunk_valid_o is still of an image that has ended.
//
// Latency: 3 clocks from step_i to the next taxel, 2 clocks from take_i to the first.
// Error: none.
// Model: model/meissner/twins/link/images.py

module msn_image_chunks #(
  parameter  int unsigned Taxels      = 4096,
  parameter  int unsigned Chunk       = 64,
  localparam int unsigned AddressBits = msn_pkg::index_width(Taxels)
) (
  input  logic                   clk_i,
  input  logic                   rst_i,

  input  logic                   in_valid_i,      // a taxel, as msn_image_store takes them
  input  logic [15:0]            in_data_i,
  input  logic                   in_last_i,
  input  logic [47:0]            in_time_i,

  output logic                   chunk_valid_o,
  output logic [47:0]            chunk_time_o,
  output logic [7:0]             chunk_number_o,
  output logic [AddressBits-1:0] chunk_first_o,   // until the first step_i
  output logic                   chunk_final_o,
  input  logic                   take_i,

  output logic [15:0]            taxel_o,
  output logic                   end_o,
  input  logic                   step_i,

  output logic [31:0]            dropped_o        // images
);

  if (Taxels < 2 || Taxels > 65536) begin : gen_check_taxels
    $fatal(1, "msn_image_chunks: Taxels = %0d must lie in 2 .. 65536", Taxels);
  end
  if (Chunk < 1 || Chunk > 116) begin : gen_check_chunk
    $fatal(1, "msn_image_chunks: Chunk = %0d must lie in 1 .. 116", Chunk);
  end

  logic [AddressBits-1:0] place;
  logic [6:0]             left;   // taxels of the chunk after the present one
  logic                   begun;  // this image
  logic                   final_place, done, done_q;
  assign final_place   = place == AddressBits'(Taxels - 1);
  assign done          = step_i && final_place;
  assign end_o         = left == '0 || final_place;
  assign chunk_first_o = place;
  assign chunk_final_o = 32'(place) + Chunk >= Taxels;

  always_ff @(posedge clk_i) begin
    if (take_i) begin
      begun <= 1'b1;
      left  <= 7'(Chunk - 1);
    end
    if (step_i) begin
      place <= final_place ? '0 : place + 1'b1;
      left  <= left - 1'b1;
    end
    done_q <= done;  // a clock later, for timing
    if (done) begin
      begun          <= 1'b0;
      chunk_number_o <= chunk_number_o + 1'b1;
    end
    if (rst_i) begin
      place          <= '0;
      begun          <= 1'b0;
      done_q         <= 1'b0;
      chunk_number_o <= '0;
    end
  end

  msn_image_store #(.Taxels(Taxels)) u_store (
    .clk_i, .rst_i,
    .in_valid_i, .in_data_i, .in_last_i, .in_time_i,
    .read_valid_o(chunk_valid_o), .read_time_o(chunk_time_o), .read_begun_i(begun || take_i),
    .read_done_i(done_q), .read_address_i(place), .read_data_o(taxel_o),
    .dropped_o
  );

endmodule
