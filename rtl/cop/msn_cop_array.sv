// SPDX-License-Identifier: Apache-2.0
//
// From an array's samples to its centre of pressure and load: msn_calibrate_taxels, or msn_calibrate_grid with
// RowColumn, then msn_cop, and between them msn_skid, so that msn_cop's ready does not reach the calibration's
// registers in the same clock.
//
// Tap: the forces also go to a second consumer, which takes each beat independently (msn_fork).
//
// Latency after a frame's last beat: 3 clocks (RowColumn 15) and msn_cop's, the same in every frame: 14 at one
// lane, Q2.14 and two bits a clock.   Model: model/meissner/twins/cop/cop_array.py
// Error: at most 1/2 LSB of x, y (tb/extremes).

module msn_cop_array #(
  parameter  int unsigned Rows         = 64,
  parameter  int unsigned Columns      = 64,
  parameter  int unsigned Lanes        = 1,
  parameter  int unsigned SampleBits   = 17,
  parameter  bit          Offset       = 1'b1,
  parameter  bit          RowColumn    = 1'b0,
  parameter  int unsigned GainShift    = RowColumn ? 24 : 12,
  parameter  int unsigned FractionBits = 14,
  parameter  int unsigned BitsPerClock = 2,
  parameter  bit          Pipelined    = 1'b0,
  parameter  bit          Tap          = 1'b0,
  localparam int unsigned IdBits       = msn_pkg::index_width(Rows * ((Columns + Lanes - 1) / Lanes)),
  localparam int unsigned OffsetBits   = SampleBits - 32'(RowColumn),
  localparam int unsigned SumBits      = 16 + $clog2(Rows * Columns),
  localparam int unsigned CopBits      = FractionBits + 2
) (
  input  logic                        clk_i,
  input  logic                        rst_i,

  input  logic [Lanes-1:0]            cfg_write_i,      // msn_calibrate_taxels or _grid
  input  logic                        cfg_write_row_i,
  input  logic [IdBits-1:0]           cfg_word_i,
  input  logic [OffsetBits-1:0]       cfg_offset_i,
  input  logic [15:0]                 cfg_gain_i,
  input  logic                        cfg_swap_i,
  output logic                        cfg_swapping_o,
  input  logic [SumBits-1:0]          cfg_min_load_i,   // msn_cop

  input  logic                        in_valid_i,
  output logic                        in_ready_o,
  input  logic [Lanes*SampleBits-1:0] in_data_i,
  input  logic [Lanes-1:0]            in_mask_i,
  input  logic                        in_fits_i,
  input  logic                        in_row_last_i,
  input  logic                        in_last_i,

  output logic                        tap_valid_o,
  input  logic                        tap_ready_i,
  output logic [Lanes*16-1:0]         tap_data_o,
  output logic [Lanes-1:0]            tap_mask_o,
  output logic                        tap_row_last_o,
  output logic                        tap_last_o,

  output logic                        out_valid_o,
  input  logic                        out_ready_i,
  output logic signed [CopBits-1:0]   out_x_o,
  output logic signed [CopBits-1:0]   out_y_o,
  output logic [SumBits-1:0]          out_load_o,
  output logic                        out_pressed_o,

  output logic [31:0]                 damaged_o         // frames without a result, since reset
);

  logic                force_valid, force_ready, skid_valid, skid_ready, next_valid, next_ready, next_fits;
  logic [Lanes*16-1:0] force_data, next_data;
  logic [Lanes-1:0]    force_mask;
  logic [2:0]          force_marks;

  if (RowColumn) begin : gen_grid
    msn_calibrate_grid #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .GainShift(GainShift),
      .Offset(Offset)
    ) u_calibrate (
      .clk_i, .rst_i,
      .cfg_write_i, .cfg_write_row_i, .cfg_word_i, .cfg_offset_i, .cfg_gain_i, .cfg_swap_i, .cfg_swapping_o,
      .in_valid_i, .in_ready_o, .in_data_i, .in_mask_i, .in_fits_i, .in_row_last_i, .in_last_i,
      .out_valid_o(force_valid), .out_ready_i(force_ready), .out_data_o(force_data), .out_mask_o(force_mask),
      .out_fits_o(force_marks[2]), .out_row_last_o(force_marks[1]), .out_last_o(force_marks[0])
    );
  end else begin : gen_taxels
    msn_calibrate_taxels #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .GainShift(GainShift),
      .Offset(Offset)
    ) u_calibrate (
      .clk_i, .rst_i,
      .cfg_write_i, .cfg_write_row_i, .cfg_word_i, .cfg_offset_i, .cfg_gain_i, .cfg_swap_i, .cfg_swapping_o,
      .in_valid_i, .in_ready_o, .in_data_i, .in_mask_i, .in_fits_i, .in_row_last_i, .in_last_i,
      .out_valid_o(force_valid), .out_ready_i(force_ready), .out_data_o(force_data), .out_mask_o(force_mask),
      .out_fits_o(force_marks[2]), .out_row_last_o(force_marks[1]), .out_last_o(force_marks[0])
    );
  end

  // The blocks downstream stall this register, so that no path of ready goes through the calibration.
  msn_skid #(.Width(Lanes * 17 + 3)) u_skid (
    .clk_i, .rst_i,
    .in_valid_i(force_valid), .in_ready_o(force_ready), .in_data_i({force_marks, force_mask, force_data}),
    .out_valid_o(skid_valid), .out_ready_i(skid_ready),
    .out_data_o({next_fits, tap_row_last_o, tap_last_o, tap_mask_o, next_data})
  );

  assign tap_data_o = next_data;
  if (Tap) begin : gen_tap
    msn_fork u_fork (
      .clk_i, .rst_i,
      .in_valid_i(skid_valid), .in_ready_o(skid_ready),
      .a_valid_o(next_valid), .a_ready_i(next_ready),
      .b_valid_o(tap_valid_o), .b_ready_i(tap_ready_i)
    );
  end else begin : gen_no_tap
    assign next_valid  = skid_valid;
    assign skid_ready  = next_ready;
    assign tap_valid_o = 1'b0;
    logic unused_tap;
    assign unused_tap = tap_ready_i;
  end

  msn_cop #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock),
    .Pipelined(Pipelined)
  ) u_cop (
    .clk_i, .rst_i,
    .cfg_min_load_i,
    .in_valid_i(next_valid), .in_ready_o(next_ready), .in_data_i(next_data), .in_fits_i(next_fits),
    .in_row_last_i(tap_row_last_o), .in_last_i(tap_last_o),
    .out_valid_o, .out_ready_i, .out_x_o, .out_y_o, .out_load_o, .out_pressed_o,
    .damaged_o
  );

endmodule
