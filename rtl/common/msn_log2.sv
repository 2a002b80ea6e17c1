// SPDX-License-Identifier: Apache-2.0
//
// Binary logarithm of an unsigned number, by a table and the chord between its entries.
//
//   x = 2^e (1 + m);   T[i] = log2(1 + i/2^TableBits), i the leading bits of m, r the others
//   out = e + T[i] + (T[i+1] - T[i]) r   unsigned, FractionBits of fraction, rounded half up; T has two more
//
// Error against log2(x), lsb = 2^-FractionBits: at most 5/8 lsb + 2^-29 above; below, 1/4 lsb + 0.1804/4^TableBits
// (the chord) more, and 1.4427/2^(TableBits + 17) more where r has over 17 bits, as the rest are dropped. At the
// default -0.0000576 .. +0.0000096. Exact at powers of two; x = 0 gives 0, as x = 1 does.
//
//   clock  1           2      3         4, 5          6    7
//          leading bit  shift  T, T' - T  msn_multiply  sum  msn_round_sat
//
// Latency 7 clocks, a number a clock.   Model: model/meissner/twins/common/log2.py
// Error: at most 0.0000576 at the default size, exact at powers of two (tb/extremes).

module msn_log2 #(
  parameter  int unsigned InBits       = 27,
  parameter  int unsigned TableBits    = 6,
  parameter  int unsigned FractionBits = 16,
  localparam int unsigned WholeBits    = msn_pkg::index_width(InBits + 1),  // rounding can give InBits itself
  localparam int unsigned OutBits      = WholeBits + FractionBits
) (
  input  logic               clk_i,
  input  logic               rst_i,

  input  logic               in_valid_i,
  output logic               in_ready_o,
  input  logic [InBits-1:0]  in_data_i,

  output logic               out_valid_o,
  input  logic               out_ready_i,
  output logic [OutBits-1:0] out_data_o
);

  if (TableBits < 3 || TableBits > 8) begin : gen_check_table_bits
    $fatal(1, "msn_log2: TableBits = %0d must lie in 3 .. 8", TableBits);
  end
  if (FractionBits <= TableBits || FractionBits > TableBits + 14) begin : gen_check_fraction_bits
    $fatal(1, "msn_log2: FractionBits = %0d must lie in TableBits + 1 .. + 14", FractionBits);
  end
  if (InBits < TableBits + 2 || InBits > 48) begin : gen_check_in_bits
    $fatal(1, "msn_log2: InBits = %0d must lie in TableBits + 2 .. 48", InBits);
  end

  localparam int unsigned Entries   = 2 ** TableBits;
  localparam int unsigned EntryBits = FractionBits + 2;
  localparam int unsigned StepBits  = FractionBits - TableBits + 3;  // of T' - T
  localparam int unsigned LongRest  = InBits - 1 - TableBits;
  localparam int unsigned RestBits  = (LongRest > 17) ? 17 : LongRest;
  localparam int unsigned MantissaBits = TableBits + RestBits;
  localparam int unsigned Drop      = 28 - EntryBits;
  localparam int unsigned Stride    = 2 ** (8 - TableBits);
  localparam logic [257*29-1:0] Finest = msn_log2_pkg::Entries;

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
  logic [6:1] valid;
  assign in_ready_o = step;

  logic [WholeBits-1:0] leading;
  always_comb begin
    leading = '0;
    for (int k = 1; k < InBits; k++) if (in_data_i[k]) leading = WholeBits'(k);
  end

  logic [InBits-1:0]             number;
  logic [MantissaBits-1:0]           mantissa;  // without its leading one
  logic [WholeBits-1:0]          whole, whole_2, whole_3, whole_4, whole_5;
  logic [EntryBits-1:0]          entry, entry_4, entry_5;
  logic [StepBits-1:0]           rise;
  logic [RestBits-1:0]           rest;
  logic signed [StepBits+RestBits:0] product;
  logic [OutBits+1:0]            sum;

  always_ff @(posedge clk_i) begin
    if (step) begin
      valid         <= {valid[5:1], in_valid_i};
      number        <= in_data_i;
      whole         <= leading;
      mantissa      <= MantissaBits'((number << (WholeBits'(InBits - 1) - whole)) >> (LongRest - RestBits));
      whole_2       <= whole;
      {entry, rise} <= rom[mantissa[RestBits+:TableBits]];
      rest          <= mantissa[RestBits-1:0];
      whole_3       <= whole_2;
      entry_4       <= entry;
      whole_4       <= whole_3;
      entry_5       <= entry_4;
      whole_5       <= whole_4;
      sum           <= {whole_5, entry_5} + (OutBits + 2)'(unsigned'(product >>> RestBits));
    end
    if (rst_i) valid <= '0;
  end

  msn_multiply #(.AWidth(StepBits + 1), .BWidth(RestBits)) u_multiply (
    .clk_i, .enable_i(step), .a_i(signed'({1'b0, rise})), .b_i(rest), .y_o(product)
  );

  msn_round_sat #(.InWidth(OutBits + 3), .OutWidth(OutBits), .DropBits(2), .Unsigned(1'b1)) u_round (
    .clk_i, .rst_i,
    .in_valid_i(valid[6]), .in_ready_o(step), .in_data_i(signed'({1'b0, sum})),
    .out_valid_o, .out_ready_i, .out_data_o
  );

endmodule
