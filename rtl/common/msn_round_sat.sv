// SPDX-License-Identifier: Apache-2.0
//
// Drops fraction bits (round half up), then saturates the result at the ends of the output's range.
//
//   y = clip(floor(x / 2^DropBits + 1/2), low, high)
//   low, high = -2^(OutWidth-1), 2^(OutWidth-1) - 1;   Unsigned: 0, 2^OutWidth - 1
//
// The only block that drops bits. Latency 1 clock, one sample per clock.
// Error: at most 1/2 LSB (tb/extremes).
// Model: model/meissner/twins/common/arithmetic.py

module msn_round_sat #(
  parameter  int unsigned InWidth  = 24,
  parameter  int unsigned OutWidth = 16,
  parameter  int unsigned DropBits = 8,
  parameter  bit          Unsigned = 1'b0,
  localparam int unsigned MidWidth = InWidth - DropBits + 1  // after rounding, before clipping
) (
  input  logic                      clk_i,
  input  logic                      rst_i,

  input  logic                      in_valid_i,
  output logic                      in_ready_o,
  input  logic signed [InWidth-1:0] in_data_i,

  output logic                      out_valid_o,
  input  logic                      out_ready_i,
  output logic [OutWidth-1:0]       out_data_o   // two's complement unless Unsigned
);

  if (DropBits < 1 || DropBits >= InWidth) begin : gen_check_drop_bits
    $fatal(1, "msn_round_sat: DropBits = %0d must lie in 1 .. InWidth-1 = %0d", DropBits, InWidth - 1);
  end
  if (OutWidth < 1 || OutWidth + 32'(Unsigned) > MidWidth) begin : gen_check_out_width
    $fatal(1, "msn_round_sat: OutWidth = %0d must lie in 1 .. %0d", OutWidth, MidWidth - 32'(Unsigned));
  end

  // floor(x + 1/2): the shift rounds down; the highest dropped bit adds the half.
  logic signed [MidWidth-1:0] floored, rounded;
  assign floored = MidWidth'(in_data_i >>> DropBits);
  assign rounded = floored + MidWidth'({1'b0, in_data_i[DropBits-1]});

  // The result fits if all bits above it equal its sign (Unsigned: are 0).
  localparam int unsigned SignAt = Unsigned ? OutWidth : OutWidth - 1;
  logic negative, fits;
  assign negative = rounded[MidWidth-1];
  assign fits     = rounded[MidWidth-1:SignAt] == {(MidWidth - SignAt) {Unsigned ? 1'b0 : negative}};

  logic [OutWidth-1:0] limit;
  assign limit = Unsigned ? {OutWidth{!negative}} : {negative, {(OutWidth - 1) {!negative}}};

  assign in_ready_o = out_ready_i || !out_valid_o;

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      out_valid_o <= in_valid_i;
      out_data_o  <= fits ? rounded[OutWidth-1:0] : limit;
    end
    if (rst_i) out_valid_o <= 1'b0;
  end

endmodule
