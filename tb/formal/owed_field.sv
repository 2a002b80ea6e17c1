// SPDX-License-Identifier: Apache-2.0
//
// A register field that the host sets: only a write to its word, in the bytes written, and reset change its bits.
// held_i: the value written, which the core gets immediately as member_i, or with Waits after commit_i. A build with
// Bits bits for the field gives the core the nearest number that fits into them, fit_o. Each clock is compared with
// the one before, which is far easier for solvers than a second copy of every field.

module owed_field #(
  parameter bit               On     = 1'b1,
  parameter logic [9:0]       Word   = 10'h000,
  parameter int unsigned      Low    = 0,
  parameter int unsigned      Width  = 32,
  parameter logic [Width-1:0] Reset  = '0,
  parameter bit               Waits  = 1'b0,
  parameter int unsigned      Bits   = Width,
  parameter bit               Signed = 1'b0
) (
  input  logic             clk_i,
  input  logic             rst_i,
  input  logic             write_i,
  input  logic [9:0]       word_i,
  input  logic [31:0]      data_i,
  input  logic [31:0]      mask_i,
  input  logic             commit_i,
  input  logic [Width-1:0] member_i,
  input  logic [Width-1:0] held_i,
  output logic [Width-1:0] fit_o,
  output logic             written_o  // in this clock
);

  // Compared with one extra bit, in which both ends of the range can be represented.
  localparam logic signed [Width:0] Top = (Width + 1)'((33'd1 << (Signed ? Bits - 1 : Bits)) - 33'd1);
  localparam logic signed [Width:0] Bottom = Signed ? -Top - 1 : '0;
  function automatic logic [Width-1:0] fit(input logic [Width-1:0] bits);
    logic signed [Width:0] number;
    number = signed'({Signed && bits[Width-1], bits});
    fit = Width'(number > Top ? Top : number < Bottom ? Bottom : number);
  endfunction

  logic             started = 1'b0;
  logic [Width-1:0] held, shown;  // expected values
  assign written_o = On && write_i && word_i == Word && mask_i[Low+:Width] != '0;
  assign fit_o     = fit(held_i);
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    held    <= held_i;
    shown   <= member_i;
    if (written_o) held <= (held_i & ~mask_i[Low+:Width]) | (data_i[Low+:Width] & mask_i[Low+:Width]);
    if (commit_i) shown <= fit_o;
    if (rst_i) {held, shown} <= {Reset, fit(Reset)};
  end
  always_comb begin
    if (started) assert (held_i == held);
    if (started && Waits) assert (member_i == shown);
    if (!Waits) assert (member_i == fit_o);
  end

endmodule
