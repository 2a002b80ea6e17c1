// SPDX-License-Identifier: Apache-2.0
//
// Calibrates an array's samples to forces, with an offset and a gain for each taxel.
//
//   F = clip(floor((raw - offset) gain / 2^GainShift + 1/2), 0, 65535)
//
// Lanes columns a beat, row by row. Masked taxels give 0; until a calibration is swapped in, all taxels give 0.
// Offset = 0: the offsets are already subtracted (msn_tare). The result is rounded only once.
//
//   clock  1             2        3
//          raw - offset  x gain   round, clip
//
// Latency 3 clocks, a beat a clock, frames without a gap, but a few clocks' wait after a swap and a damaged frame.
// Beats as msn_frame_marker gives them; their marks travel with them. The same ports as msn_calibrate_grid.
// Error: at most 1/2 LSB (tb/extremes).
// Model: model/meissner/twins/frontend/calibrate_taxels.py

module msn_calibrate_taxels #(
  parameter  int unsigned Rows       = 64,
  parameter  int unsigned Columns    = 64,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          Offset     = 1'b1,
  parameter  int unsigned GainShift  = 12,  // 4096: gain 1.0
  localparam int unsigned IdBits     = msn_pkg::index_width(Rows * ((Columns + Lanes - 1) / Lanes)),
  localparam int unsigned OffsetBits = SampleBits
) (
  input  logic                        clk_i,
  input  logic                        rst_i,

  input  logic [Lanes-1:0]            cfg_write_i,      // of the tables
  input  logic                        cfg_write_row_i,
  input  logic [IdBits-1:0]           cfg_word_i,
  input  logic [OffsetBits-1:0]       cfg_offset_i,
  input  logic [15:0]                 cfg_gain_i,
  input  logic                        cfg_swap_i,
  output logic                        cfg_swapping_o,

  input  logic                        in_valid_i,
  output logic                        in_ready_o,
  input  logic [Lanes*SampleBits-1:0] in_data_i,        // signed, the leftmost column in the low bits
  input  logic [Lanes-1:0]            in_mask_i,        // taxels that give 0
  input  logic                        in_fits_i,
  input  logic                        in_row_last_i,
  input  logic                        in_last_i,

  output logic                        out_valid_o,
  input  logic                        out_ready_i,
  output logic [Lanes*16-1:0]         out_data_o,
  output logic [Lanes-1:0]            out_mask_o,       // as it came in
  output logic                        out_fits_o,
  output logic                        out_row_last_o,
  output logic                        out_last_o
);

  localparam int unsigned DiffBits    = SampleBits + 32'(Offset);
  localparam int unsigned ProductBits = DiffBits + 16 + 1;

  if (GainShift < 1 || GainShift > 16) begin : gen_check_gain_shift
    $fatal(1, "msn_calibrate_taxels: GainShift = %0d must lie in 1 .. 16", GainShift);
  end

  logic [2:0] marks_in, marks_out;
  assign marks_in = {in_fits_i, in_row_last_i, in_last_i};
  assign {out_fits_o, out_row_last_o, out_last_o} = marks_out;

  // All stages advance together.
  logic move, accept, word_valid, loaded, unused_row;
  logic [Lanes*SampleBits-1:0] offset;
  logic [Lanes*16-1:0]         gain;
  assign in_ready_o = move && word_valid;
  assign accept     = in_valid_i && in_ready_o;
  assign unused_row = cfg_write_row_i;

  msn_calibration_table #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .Offset(Offset)
  ) u_table (
    .clk_i, .rst_i,
    .cfg_write_i, .cfg_word_i, .cfg_offset_i, .cfg_gain_i, .cfg_swap_i, .cfg_swapping_o,
    .take_i(accept), .last_i(in_last_i), .restart_i(accept && in_last_i && !in_fits_i),
    .out_valid_o(word_valid), .out_offset_o(offset), .out_gain_o(gain),
    .loaded_o(loaded)
  );

  logic [2:1]         valid;
  logic [5:0]         marks;
  logic [2*Lanes-1:0] mask;
  always_ff @(posedge clk_i) begin
    if (move) begin
      valid              <= {valid[1], accept};
      {marks_out, marks} <= {marks, marks_in};
      {out_mask_o, mask} <= {mask, in_mask_i};
    end
    if (rst_i) valid <= '0;
  end

  logic [Lanes-1:0] ready, out_valid;
  assign move        = ready[0];
  assign out_valid_o = out_valid[0];
  if (Lanes > 1) begin : gen_alike
    logic unused_alike;
    assign unused_alike = ^{ready[Lanes-1:1], out_valid[Lanes-1:1]};
  end

  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    logic signed [SampleBits-1:0]  raw, zero;
    logic signed [DiffBits-1:0]    difference;
    logic signed [DiffBits+15:0]   product;  // two clocks later: the multiplier's own registers
    assign raw        = signed'(in_data_i[SampleBits*k+:SampleBits]);
    assign zero       = signed'(offset[SampleBits*k+:SampleBits]);
    assign difference = in_mask_i[k] || !loaded ? '0 : DiffBits'(raw) - DiffBits'(zero);

    msn_multiply #(.AWidth(DiffBits), .BWidth(16)) u_product (
      .clk_i, .enable_i(move), .a_i(difference), .b_i(gain[16*k+:16]), .y_o(product)
    );

    msn_round_sat #(.InWidth(ProductBits), .OutWidth(16), .DropBits(GainShift), .Unsigned(1'b1)) u_round (
      .clk_i, .rst_i,
      .in_valid_i(valid[2]), .in_ready_o(ready[k]), .in_data_i(ProductBits'(product)),
      .out_valid_o(out_valid[k]), .out_ready_i, .out_data_o(out_data_o[16*k+:16])
    );
  end

endmodule
