// SPDX-License-Identifier: Apache-2.0
//
// A field of the registers that the host sets: what the bytes written to its word made of it since reset. The core has
// it at once, or with Waits after commit_i. read_o: the field in its place of the word that is asked, else 0.

module owed_field #(
  parameter bit               On    = 1'b1,
  parameter logic [9:0]       Word  = 10'h000,
  parameter int unsigned      Low   = 0,
  parameter int unsigned      Width = 32,
  parameter logic [Width-1:0] Reset = '0,
  parameter bit               Waits = 1'b0
) (
  input  logic             clk_i,
  input  logic             rst_i,
  input  logic             write_i,
  input  logic [9:0]       word_i,
  input  logic [31:0]      data_i,
  input  logic [31:0]      mask_i,
  input  logic             commit_i,
  input  logic [9:0]       read_word_i,
  input  logic [Width-1:0] port_i,
  input  logic [Width-1:0] inner_i,   // the block's own copy of what was written, for the invariant
  output logic [31:0]      read_o,
  output logic             written_o  // in this clock
);

  logic             started = 1'b0;
  logic [Width-1:0] held, shown;
  assign written_o = On && write_i && word_i == Word;
  assign read_o    = (On && read_word_i == Word) ? 32'(held) << Low : '0;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    if (commit_i) shown <= held;
    for (int unsigned b = 0; b < Width; b++) if (written_o && mask_i[Low+b]) held[b] <= data_i[Low+b];
    if (rst_i) {held, shown} <= {Reset, Reset};
  end
  always_comb if (started) assert (port_i == (Waits ? shown : held) && inner_i == held);

endmodule
