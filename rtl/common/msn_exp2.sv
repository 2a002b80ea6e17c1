// SPDX-License-Identifier: Apache-2.0
//
// Power of two of a signed number, by a table and the chord between its entries.
//
//   y = i + f, FractionBits of fraction;  T[j] = 2^(j/2^TableBits) - 1, j the leading bits of f, r the others
//   out = 2^i (1 + T[j] + (T[j+1] - T[j]) r)     unsigned, OutFraction bits of fraction, rounded half up
//
// Larger results saturate at 2^OutBits - 1. Error relative to 2^y: at most 2^-FractionBits / 8 + 2^-29
// + 0.0601/4^TableBits (the chord) above, 2^-FractionBits 3/8 + 2^-29 below, -0.00000573 .. +0.0000166 at the
// default; and half an LSB of the output for the rounding, which is the only error where f = 0.
//
//   clock  1         2, 3          4    5      6
//          T, T' - T  msn_multiply  sum  shift  msn_round_sat
//
// Latency 6 clocks, a number a clock.   Model: model/meissner/twins/common/exp2.py
// Error: at most 1/2 LSB and 0.0000166 of the result at the default size, exact at whole exponents (tb/extremes).

module msn_exp2 #(
  parameter  int unsigned WholeBits    = 11,  // of y, including its sign
  parameter  int unsigned TableBits    = 6,
  parameter  int unsigned FractionBits = 16,
  parameter  int unsigned OutBits      = 24,
  parameter  int unsigned OutFraction  = 20,
  localparam int unsigned InBits       = WholeBits + FractionBits
) (
  input  logic                     clk_i,
  input  logic                     rst_i,

  input  logic                     in_valid_i,
  output logic                     in_ready_o,
  input  logic signed [InBits-1:0] in_data_i,

  output logic                     out_valid_o,
  input  logic                     out_ready_i,
  output logic [OutBits-1:0]       out_data_o
);

  if (TableBits < 3 || TableBits > 8) begin : gen_check_table_bits
    $fatal(1, "msn_exp2: TableBits = %0d must lie in 3 .. 8", TableBits);
  end
  if (FractionBits <= TableBits || FractionBits > TableBits + 14) begin : gen_check_fraction_bits
    $fatal(1, "msn_exp2: FractionBits = %0d must lie in TableBits + 1 .. + 14", FractionBits);
  end
  if (WholeBits < 2 || WholeBits > 12) begin : gen_check_whole_bits
    $fatal(1, "msn_exp2: WholeBits = %0d must lie in 2 .. 12", WholeBits);
  end
  if (OutBits < 2 || OutBits > 32) begin : gen_check_out_bits
    $fatal(1, "msn_exp2: OutBits = %0d must lie in 2 .. 32", OutBits);
  end
  if (OutFraction > 32) begin : gen_check_out_fraction
    $fatal(1, "msn_exp2: OutFraction = %0d must lie in 0 .. 32", OutFraction);
  end

  localparam int unsigned Entries   = 2 ** TableBits;
  localparam int unsigned EntryBits = FractionBits + 2;
  localparam int unsigned StepBits  = FractionBits - TableBits + 3;  // of T' - T
  localparam int unsigned RestBits  = FractionBits - TableBits;
  localparam int unsigned Drop      = 28 - EntryBits;
  localparam int unsigned Stride    = 2 ** (8 - TableBits);
  localparam logic [257*29-1:0] Finest = msn_exp2_pkg::Entries;

  // A word is an entry and the step to the next entry.
  localparam int unsigned RomBits = EntryBits + StepBits;
  function automatic logic [28:0] entry_at(int unsigned i);
    entry_at = (Finest[i*Stride*29+:29] + 29'(1 << (Drop - 1))) >> Drop;
  endfunction
  logic [RomBits-1:0] rom [Entries];
  initial begin
    for (int i = 0; i < Entries; i++) begin
      rom[i] = {EntryBits'(entry_at(i)), StepBits'(entry_at(i + 1) - entry_at(i))};
    end
  end

  // All stages advance together.
  logic       step;
  logic [5:1] valid;
  assign in_ready_o = step;

  // Right shift from the position where the leading bit is the output's highest; negative: overflow.
  localparam int unsigned ShiftBits = ((WholeBits > 7) ? WholeBits : 7) + 1;
  localparam int unsigned WordBits  = (EntryBits > OutBits) ? EntryBits + 1 : OutBits + 1;
  localparam int          AtZero    = int'(OutBits) - 1 - int'(OutFraction);

  logic        [EntryBits-1:0]       entry, entry_2, entry_3;
  logic        [StepBits-1:0]        rise;
  logic        [RestBits-1:0]        rest;
  logic signed [StepBits+RestBits:0] product;
  logic signed [ShiftBits-1:0]       right, right_2, right_3, right_4;
  logic        [EntryBits:0]         mantissa;
  logic        [WordBits-1:0]        word, shifted;  // the mantissa, its leading bit highest
  logic        [OutBits:0]           placed;         // with the bit that rounds
  assign word    = WordBits'(mantissa) << (WordBits - EntryBits - 1);
  assign shifted = word >> unsigned'(right_4);

  always_ff @(posedge clk_i) begin
    if (step) begin
      valid         <= {valid[4:1], in_valid_i};
      {entry, rise} <= rom[in_data_i[FractionBits-1-:TableBits]];
      rest          <= in_data_i[RestBits-1:0];
      right         <= ShiftBits'(AtZero) - ShiftBits'(signed'(in_data_i[InBits-1:FractionBits]));
      entry_2       <= entry;
      right_2       <= right;
      entry_3       <= entry_2;
      right_3       <= right_2;
      mantissa      <= {1'b1, entry_3} + (EntryBits + 1)'(unsigned'(product >>> RestBits));
      right_4       <= right_3;
      placed        <= right_4[ShiftBits-1] ? '1 : (OutBits + 1)'(shifted >> (WordBits - OutBits - 1));
    end
    if (rst_i) valid <= '0;
  end

  msn_multiply #(.AWidth(StepBits + 1), .BWidth(RestBits)) u_multiply (
    .clk_i, .enable_i(step), .a_i(signed'({1'b0, rise})), .b_i(rest), .y_o(product)
  );

  msn_round_sat #(.InWidth(OutBits + 2), .OutWidth(OutBits), .DropBits(1), .Unsigned(1'b1)) u_round (
    .clk_i, .rst_i,
    .in_valid_i(valid[5]), .in_ready_o(step), .in_data_i(signed'({1'b0, placed})),
    .out_valid_o, .out_ready_i, .out_data_o
  );

endmodule
