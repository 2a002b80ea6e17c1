// SPDX-License-Identifier: Apache-2.0
//
// y = clip(floor((x + 2^(DropBits-1)) / 2^DropBits), low, high), written in this form, for every word, in order.

module formal_round_sat #(
  parameter int unsigned InWidth  = 24,
  parameter int unsigned OutWidth = 16,
  parameter int unsigned DropBits = 8,
  parameter bit          Unsigned = 1'b0
) (
  input logic                      clk_i,
  input logic                      rst_i,
  input logic [1:0]                watch_i,
  input logic                      in_valid_i,
  input logic signed [InWidth-1:0] in_data_i,
  input logic                      out_ready_i
);

  logic                in_ready_o, out_valid_o;
  logic [OutWidth-1:0] out_data_o;
  msn_round_sat #(
    .InWidth(InWidth), .OutWidth(OutWidth), .DropBits(DropBits), .Unsigned(Unsigned)
  ) dut (.*);

  localparam logic signed [InWidth:0] One  = 1;
  localparam logic signed [InWidth:0] Half = One <<< (DropBits - 1);
  localparam logic signed [InWidth:0] High = (One <<< (Unsigned ? OutWidth : OutWidth - 1)) - One;
  localparam logic signed [InWidth:0] Low  = Unsigned ? '0 : -High - One;
  logic signed [InWidth:0] quotient, clipped;
  assign quotient = ((InWidth + 1)'(in_data_i) + Half) >>> DropBits;
  assign clipped  = quotient > High ? High : quotient < Low ? Low : quotient;

  logic                started, held;
  logic [1:0]          level, ahead;
  logic [OutWidth-1:0] kept;
  owed_stream #(.Width(OutWidth), .Capacity(1), .Timeout(0)) u_stream (
    .clk_i, .rst_i, .watch_i,
    .in_valid_i, .in_ready_i(in_ready_o), .in_data_i(clipped[OutWidth-1:0]),
    .out_valid_i(out_valid_o), .out_ready_i, .out_data_i(out_data_o),
    .started_o(started), .level_o(level), .inside_o(held), .ahead_o(ahead), .kept_o(kept)
  );

  always_comb begin
    if (started && !rst_i) assert (in_ready_o == (out_ready_i || level == '0));
    if (started) assert (out_valid_o == (level == 2'd1));                      // latency 1
    if (started && held) assert (out_data_o == kept);                        // invariant
    if (started && !rst_i && in_valid_i && in_ready_o) begin
      if (InWidth - DropBits >= OutWidth + 32'(Unsigned)) cover (quotient > High);
      cover (quotient == High);
      cover (quotient == Low);
    end
  end
  if (Unsigned || InWidth - DropBits > OutWidth) begin : gen_below
    always_comb cover (started && !rst_i && in_valid_i && in_ready_o && quotient < Low);
  end

endmodule
