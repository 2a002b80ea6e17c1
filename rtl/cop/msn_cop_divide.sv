// SPDX-License-Identifier: Apache-2.0
//
// Centre of pressure of a frame from its load and first moments.
//
//   x = Mx / ((n-1) S)     y = My / ((m-1) S)
//
// in Q2.FractionBits, -1 .. +1 from the first column (last row) to the last column (first row), rounded
// to nearest, ties away from zero. Not pressed, and x = y = 0, if S is 0 or below cfg_min_load. One column
// has x = 0, one row y = 0. S = 0 is divided as 0 / 1: no divider ever gets a zero denominator.
//
// Latency: that of msn_divide, both coordinates in parallel; the load travels with them.
// Error: at most 1/2 LSB of x, y (tb/extremes).
// Model: model/meissner/twins/cop/cop.py

module msn_cop_divide #(
  parameter  int unsigned Rows         = 64,
  parameter  int unsigned Columns      = 64,
  parameter  int unsigned FractionBits = 14,
  parameter  int unsigned BitsPerClock = 2,
  localparam int unsigned SumBits      = 16 + $clog2(Rows * Columns),
  localparam int unsigned MxBits       = SumBits + msn_pkg::index_width(Columns),
  localparam int unsigned MyBits       = SumBits + msn_pkg::index_width(Rows),
  localparam int unsigned CopBits      = FractionBits + 2
) (
  input  logic                      clk_i,
  input  logic                      rst_i,

  input  logic        [SumBits-1:0] cfg_min_load_i,

  input  logic                      in_valid_i,
  output logic                      in_ready_o,
  input  logic        [SumBits-1:0] in_sum_i,
  input  logic signed [MxBits-1:0]  in_mx_i,
  input  logic signed [MyBits-1:0]  in_my_i,

  output logic                      out_valid_o,
  input  logic                      out_ready_i,
  output logic signed [CopBits-1:0] out_x_o,
  output logic signed [CopBits-1:0] out_y_o,
  output logic        [SumBits-1:0] out_load_o,
  output logic                      out_pressed_o  // x and y are valid
);

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_cop_divide: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_cop_divide: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (FractionBits < 4 || FractionBits > 20) begin : gen_check_fraction_bits
    $fatal(1, "msn_cop_divide: FractionBits = %0d must lie in 4 .. 20", FractionBits);
  end

  logic nothing, pressed;
  assign nothing = in_sum_i == '0;
  assign pressed = !nothing && in_sum_i >= cfg_min_load_i;

  // One column (row): span 1 and moment 0, so that no other logic needs a special case.
  localparam int unsigned SpanX = (Columns > 1) ? Columns - 1 : 1;
  localparam int unsigned SpanY = (Rows > 1) ? Rows - 1 : 1;
  localparam int unsigned DenXBits = SumBits + msn_pkg::index_width(SpanX + 1);
  localparam int unsigned DenYBits = SumBits + msn_pkg::index_width(SpanY + 1);
  logic        [DenXBits-1:0] span_x, den_x;
  logic        [DenYBits-1:0] span_y, den_y;
  logic signed [DenXBits:0]   num_x;
  logic signed [DenYBits:0]   num_y;
  msn_constant_multiplier #(.Constant(SpanX), .InBits(SumBits))
    u_span_x (.in_data_i(in_sum_i), .out_data_o(span_x));
  msn_constant_multiplier #(.Constant(SpanY), .InBits(SumBits))
    u_span_y (.in_data_i(in_sum_i), .out_data_o(span_y));
  assign den_x = span_x | DenXBits'(nothing);
  assign den_y = span_y | DenYBits'(nothing);
  assign num_x = (Columns > 1) ? (DenXBits + 1)'(in_mx_i) : '0;
  assign num_y = (Rows > 1) ? (DenYBits + 1)'(in_my_i) : '0;

  // The dividers run in step, as their clocks do not depend on the operands. If an upset separates them, no division
  // begins until both are free, and a result that only the second has is dropped: the next division is right.
  logic signed [CopBits-1:0] quotient_x, quotient_y;
  logic                      ready_x, ready_y;
  assign in_ready_o = ready_x && ready_y;
  msn_divide #(
    .DenBits(DenXBits), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock),
    .SideBits(SumBits + 1)
  ) u_x (
    .clk_i, .rst_i,
    .in_valid_i(in_valid_i && ready_y), .in_ready_o(ready_x), .in_num_i(num_x), .in_den_i(den_x),
    .in_side_i({in_sum_i, pressed}),
    .out_valid_o, .out_ready_i, .out_quotient_o(quotient_x), .out_side_o({out_load_o, out_pressed_o})
  );

  logic unused_valid, unused_side;
  msn_divide #(
    .DenBits(DenYBits), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock),
    .SideBits(1)
  ) u_y (
    .clk_i, .rst_i,
    .in_valid_i(in_valid_i && ready_x), .in_ready_o(ready_y), .in_num_i(num_y), .in_den_i(den_y),
    .in_side_i(1'b0),
    .out_valid_o(unused_valid), .out_ready_i(out_ready_i || !out_valid_o), .out_quotient_o(quotient_y),
    .out_side_o(unused_side)
  );

  assign out_x_o = out_pressed_o ? quotient_x : '0;
  assign out_y_o = out_pressed_o ? quotient_y : '0;

endmodule
