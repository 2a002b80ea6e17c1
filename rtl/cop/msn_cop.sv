// SPDX-License-Identifier: Apache-2.0
//
// Centre of pressure and load of each frame of forces: msn_cop_accumulate, then msn_cop_divide.
//
// Latency after a frame's last beat: 3 + log2(Lanes), rounded up, clocks and the divider's Steps, the same in every
// frame: 11 at one lane, Q2.14 and two bits a clock. Frames of Steps + 1 beats or more never wait.
// Model: model/meissner/twins/cop/cop.py
// Error: at most 1/2 LSB of x, y (tb/extremes).

module msn_cop #(
  parameter  int unsigned Rows         = 64,
  parameter  int unsigned Columns      = 64,
  parameter  int unsigned Lanes        = 1,
  parameter  int unsigned FractionBits = 14,
  parameter  int unsigned BitsPerClock = 2,
  localparam int unsigned SumBits      = 16 + $clog2(Rows * Columns),
  localparam int unsigned MxBits       = SumBits + msn_pkg::index_width(Columns),
  localparam int unsigned MyBits       = SumBits + msn_pkg::index_width(Rows),
  localparam int unsigned CopBits      = FractionBits + 2
) (
  input  logic                       clk_i,
  input  logic                       rst_i,

  input  logic        [SumBits-1:0]  cfg_min_load_i,

  input  logic                       in_valid_i,
  output logic                       in_ready_o,
  input  logic        [Lanes*16-1:0] in_data_i,      // the leftmost column in the low bits
  input  logic                       in_fits_i,      // marks of msn_frame_marker
  input  logic                       in_row_last_i,
  input  logic                       in_last_i,

  output logic                       out_valid_o,
  input  logic                       out_ready_i,
  output logic signed [CopBits-1:0]  out_x_o,
  output logic signed [CopBits-1:0]  out_y_o,
  output logic        [SumBits-1:0]  out_load_o,
  output logic                       out_pressed_o,  // x and y are valid

  output logic        [31:0]         damaged_o       // frames, since reset
);

  logic                      sums_valid, sums_ready;
  logic        [SumBits-1:0] sum;
  logic signed [MxBits-1:0]  mx;
  logic signed [MyBits-1:0]  my;

  msn_cop_accumulate #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes)) u_accumulate (
    .clk_i, .rst_i,
    .in_valid_i, .in_ready_o, .in_data_i, .in_fits_i, .in_row_last_i, .in_last_i,
    .out_valid_o(sums_valid), .out_ready_i(sums_ready), .out_sum_o(sum), .out_mx_o(mx), .out_my_o(my),
    .damaged_o
  );

  msn_cop_divide #(
    .Rows(Rows), .Columns(Columns), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock)
  ) u_divide (
    .clk_i, .rst_i,
    .cfg_min_load_i,
    .in_valid_i(sums_valid), .in_ready_o(sums_ready), .in_sum_i(sum), .in_mx_i(mx), .in_my_i(my),
    .out_valid_o, .out_ready_i, .out_x_o, .out_y_o, .out_load_o, .out_pressed_o
  );

endmodule
