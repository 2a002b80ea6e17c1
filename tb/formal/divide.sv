// SPDX-License-Identifier: Apache-2.0

module formal_divide #(
  parameter int unsigned DenBits      = 34,
  parameter int unsigned FractionBits = 14,
  parameter int unsigned BitsPerClock = 2,
  parameter int unsigned SideBits     = 1
) (
  input logic                    clk_i,
  input logic                    rst_i,
  input logic                    in_valid_i,
  input logic signed [DenBits:0] in_num_i,
  input logic [DenBits-1:0]      in_den_i,
  input logic [SideBits-1:0]     in_side_i,
  input logic                    out_ready_i
);

  logic                           in_ready_o, out_valid_o;
  logic signed [FractionBits+1:0] out_quotient_o;
  logic [SideBits-1:0]            out_side_o;
  msn_divide #(
    .DenBits(DenBits), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock), .SideBits(SideBits)
  ) dut (.*);

  logic [DenBits+BitsPerClock-1:0] triple;
  if (BitsPerClock == 2) begin : gen_two
    assign triple = dut.gen_two.triple;
  end else begin : gen_one
    assign triple = '0;
  end
  owed_divide #(
    .DenBits(DenBits), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock), .SideBits(SideBits)
  ) u_owed (
    .clk_i, .rst_i, .in_valid_i, .in_ready_i(in_ready_o), .in_num_i, .in_den_i, .in_side_i,
    .out_valid_i(out_valid_o), .out_ready_i, .out_quotient_i(out_quotient_o), .out_side_i(out_side_o),
    .turn_i(dut.turn), .count_i(8'(dut.count)), .rest_i(dut.rest),
    .den_i(dut.den), .low_i(dut.low), .high_i(dut.high),
    .step_i(dut.step), .negative_i(dut.negative), .digit_i(dut.digit),
    .triple_i(triple)
  );

  always_comb begin
    if (u_owed.busy && u_owed.started) assert (dut.out_side_o == u_owed.side);
  end

endmodule
