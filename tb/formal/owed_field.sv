// SPDX-License-Identifier: Apache-2.0
//
// A field of the registers that the host sets: a write to its word changes the bits of the bytes that are written,
// nothing else does but reset. held_i: what was written, which the core has at once, as port_i, or with Waits after
// commit_i. Each clock against the one before: solvers find that far easier than a second copy of every field.

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
  input  logic [Width-1:0] port_i,
  input  logic [Width-1:0] held_i,
  output logic             written_o  // in this clock
);

  logic             started = 1'b0;
  logic [Width-1:0] held, shown;  // what has to be there
  assign written_o = On && write_i && word_i == Word;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    held    <= held_i;
    shown   <= port_i;
    if (written_o) held <= (held_i & ~mask_i[Low+:Width]) | (data_i[Low+:Width] & mask_i[Low+:Width]);
    if (commit_i) shown <= held_i;
    if (rst_i) {held, shown} <= {Reset, Reset};
  end
  always_comb begin
    if (started) assert (held_i == held);
    if (started && Waits) assert (port_i == shown);
  end

endmodule
