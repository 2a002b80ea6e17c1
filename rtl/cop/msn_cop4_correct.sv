// SPDX-License-Identifier: Apache-2.0
//
// The load's denominator, corrected for the voltage drop in the sensor's layers (docs/mesh.md, Correction):
//
//   den = D 2^s - N p     X = x^2 / 2^12   Y = y^2 / 2^12   (1.0 = 65536)   s = 8 + cfg_shift
//   p = p0 + (X (p1 + (p3 X + p4 Y) / 2^16) + Y (p2 + p5 Y / 2^16)) / 2^16   divisions rounded down
//
// for x, y of Q2.14 in -1 .. +1 and signed registers p0 .. p5 with |p0| + .. + |p5| < 2^17 - 2, so that every
// operand has 18 bits: 8 products. den is exact; it may be 0 or less, which msn_ratio handles.
//
//   clock  1     2     3                 4           5               6  7    8
//          x, y  X, Y  p3 X, p4 Y, p5 Y  their sums  X (..), Y (..)  p  N p  den
//
// Latency 8 clocks, a result every 2: in_ready_o is registered, so that out_ready_i has no combinational path
// to the blocks upstream. `side` travels along.
// Error: none; at most 5 N of the polynomial (tb/extremes).
// Model: model/meissner/twins/cop/cop4_correct.py

module msn_cop4_correct #(
  parameter  int unsigned SumBits  = 19,
  parameter  int unsigned SideBits = 1,
  localparam int unsigned LoadBits = SumBits + 24
) (
  input  logic                       clk_i,
  input  logic                       rst_i,

  input  logic        [6*18-1:0]     cfg_p_i,      // p0 lowest
  input  logic        [3:0]          cfg_shift_i,

  input  logic                       in_valid_i,
  output logic                       in_ready_o,
  input  logic signed [15:0]         in_x_i,
  input  logic signed [15:0]         in_y_i,
  input  logic signed [SumBits-2:0]  in_n_i,
  input  logic signed [SumBits-1:0]  in_d_i,
  input  logic        [SideBits-1:0] in_side_i,

  output logic                       out_valid_o,
  input  logic                       out_ready_i,
  output logic signed [LoadBits-1:0] out_den_o,
  output logic signed [SumBits-2:0]  out_n_o,
  output logic        [SideBits-1:0] out_side_o
);

  if (SumBits < 6 || SumBits > 26) begin : gen_check_sum_bits
    $fatal(1, "msn_cop4_correct: SumBits = %0d must lie in 6 .. 26", SumBits);
  end

  logic signed [17:0] p0, p1, p2, p3, p4, p5;
  assign {p5, p4, p3, p2, p1, p0} = cfg_p_i;

  // All stages but the first advance together.
  logic [8:1] valid;
  logic       step;
  assign in_ready_o  = !valid[1];
  assign step        = out_ready_i || !out_valid_o;
  assign out_valid_o = valid[8];

  // Operands that wait for later stages. The suffix _k: valid after clock k.
  localparam int unsigned WaitBits = 2 * SumBits - 1 + SideBits;
  logic [WaitBits-1:0] wait_1, wait_2, wait_3, wait_4, wait_5, wait_6, wait_7;
  logic [33:0]         squares_3, squares_4;

  logic signed [15:0]         x_1, y_1;  // the multipliers' input registers, after a divider's selection
  logic [28:0]                x_square, y_square;
  logic [23:0]                unused_low;
  logic [16:0]                x_2, y_2, x_4, y_4;
  logic signed [34:0]         along_x, along_y, across_y, inner_along, inner_across;
  logic signed [17:0]         along, across, p;
  logic signed [35:0]         moment_x, moment_y, moment;
  logic signed [SumBits-2:0]  n_6, n_7;
  logic signed [SumBits-1:0]  d_7;
  logic        [SideBits-1:0] side_7;
  logic signed [SumBits+16:0] drop;
  logic signed [LoadBits-1:0] scaled_d;

  assign x_square     = 29'(x_1) * 29'(x_1);
  assign y_square     = 29'(y_1) * 29'(y_1);
  assign unused_low   = {x_square[11:0], y_square[11:0]};
  assign inner_along  = along_x + along_y;
  assign inner_across = across_y;
  assign {x_4, y_4}   = squares_4;
  assign moment       = moment_x + moment_y;
  assign n_6          = signed'(wait_6[WaitBits-1-:SumBits-1]);
  assign {n_7, d_7, side_7} = wait_7;
  assign scaled_d     = (LoadBits'(d_7) <<< 8) <<< cfg_shift_i;

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      valid[1] <= in_valid_i;
      wait_1   <= {in_n_i, in_d_i, in_side_i};
      x_1      <= in_x_i;
      y_1      <= in_y_i;
    end else if (step) begin
      valid[1] <= 1'b0;
    end
    if (step) begin
      valid[8:2] <= valid[7:1];
      wait_2     <= wait_1;
      wait_3     <= wait_2;
      wait_4     <= wait_3;
      wait_5     <= wait_4;
      wait_6     <= wait_5;
      wait_7     <= wait_6;

      x_2        <= x_square[28:12];
      y_2        <= y_square[28:12];
      squares_3  <= {x_2, y_2};
      along_x    <= p3 * signed'({1'b0, x_2});
      along_y    <= p4 * signed'({1'b0, y_2});
      across_y   <= p5 * signed'({1'b0, y_2});
      squares_4  <= squares_3;
      along      <= p1 + 18'(inner_along >>> 16);
      across     <= p2 + 18'(inner_across >>> 16);
      moment_x   <= along * signed'({1'b0, x_4});
      moment_y   <= across * signed'({1'b0, y_4});
      p          <= p0 + 18'(moment >>> 16);
      drop       <= n_6 * p;
      out_den_o  <= scaled_d - LoadBits'(drop);
      out_n_o    <= n_7;
      out_side_o <= side_7;
    end
    if (rst_i) valid <= '0;
  end

endmodule
