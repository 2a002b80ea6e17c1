// SPDX-License-Identifier: Apache-2.0
//
// Forces of an array's samples.
//
//   F = clip(floor((raw - offset) gain / 2^GainShift + 1/2), 0, 65535)     offset, gain: msn_calibration_table
//
// Lanes columns a beat, row by row. Masked taxels give 0, and all of them until a calibration is swapped in.
// Offset = 0: the samples have lost theirs (msn_tare). Nothing is rounded before the one rounding.
//
//   clock  1             2        3            RowColumn:  1       2     3        4     5    6
//          raw - offset  x gain   round, clip              as left  copy  2 x gain  copy  sum  as left
//
// Latency 3 clocks (RowColumn 6), a beat a clock, frames without a gap; a few clocks wait after a swap and a
// damaged frame. Damaged frames leave too short or too long (msn_frame_place).
// Model: model/meissner/frontend/calibrate.py

module msn_calibrate #(
  parameter  int unsigned Rows       = 64,
  parameter  int unsigned Columns    = 64,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned GainShift  = 12,
  parameter  bit          Offset     = 1'b1,
  parameter  bit          RowColumn  = 1'b0,
  localparam int unsigned Beats      = Rows * ((Columns + Lanes - 1) / Lanes),
  localparam int unsigned IdBits     = msn_pkg::index_width(Beats),
  localparam int unsigned OffsetBits = SampleBits - 32'(RowColumn)
) (
  input  logic                        clk_i,
  input  logic                        rst_i,

  input  logic [Lanes-1:0]            cfg_write_i,      // msn_calibration_table
  input  logic                        cfg_write_row_i,
  input  logic [IdBits-1:0]           cfg_word_i,
  input  logic [OffsetBits-1:0]       cfg_offset_i,
  input  logic [15:0]                 cfg_gain_i,
  input  logic                        cfg_swap_i,
  output logic                        cfg_swapping_o,

  input  logic                        in_valid_i,
  output logic                        in_ready_o,
  input  logic [Lanes*SampleBits-1:0] in_data_i,        // signed, the leftmost column in the low bits
  input  logic [Lanes-1:0]            in_mask_i,        // taxels to leave out
  input  logic [IdBits-1:0]           in_id_i,
  input  logic                        in_last_i,

  output logic                        out_valid_o,
  input  logic                        out_ready_i,
  output logic [Lanes*16-1:0]         out_data_o,
  output logic [IdBits-1:0]           out_id_o,
  output logic                        out_last_o,

  output logic [31:0]                 damaged_o         // frames, since reset
);

  localparam int unsigned DiffBits    = SampleBits + 32'(Offset);
  localparam int unsigned GainBits    = RowColumn ? 32 : 16;
  localparam int unsigned ProductBits = DiffBits + GainBits + 1;
  localparam int unsigned Stages      = RowColumn ? 5 : 2;  // before the rounding

  if (GainShift < 1 || GainShift > GainBits) begin : gen_check_gain_shift
    $fatal(1, "msn_calibrate: GainShift = %0d must lie in 1 .. %0d", GainShift, GainBits);
  end

  // All stages move together.
  logic move, accept, word_valid, keep, last, whole, loaded, unused_fits;
  logic [IdBits-1:0]           unused_place;
  logic [Lanes*SampleBits-1:0] offset;
  logic [Lanes*GainBits-1:0]   gain;
  assign in_ready_o = move && word_valid;
  assign accept     = in_valid_i && in_ready_o;

  msn_frame_place #(.Beats(Beats)) u_place (
    .clk_i,
    .rst_i,
    .accept_i(accept),
    .in_id_i,
    .in_last_i,
    .place_o (unused_place),
    .keep_o  (keep),
    .last_o  (last),
    .fits_o  (unused_fits),
    .whole_o (whole),
    .damaged_o
  );

  msn_calibration_table #(
    .Rows      (Rows),
    .Columns   (Columns),
    .Lanes     (Lanes),
    .SampleBits(SampleBits),
    .Offset    (Offset),
    .RowColumn (RowColumn)
  ) u_table (
    .clk_i,
    .rst_i,
    .cfg_write_i,
    .cfg_write_row_i,
    .cfg_word_i,
    .cfg_offset_i,
    .cfg_gain_i,
    .cfg_swap_i,
    .cfg_swapping_o,
    .take_i      (accept),
    .last_i      (in_last_i),
    .restart_i   (accept && in_last_i && !whole),
    .out_valid_o (word_valid),
    .out_offset_o(offset),
    .out_gain_o  (gain),
    .loaded_o    (loaded)
  );

  logic [Stages:0]             valid, marks;
  logic [Stages:0][IdBits-1:0] id;
  assign valid[0] = accept && keep;
  assign marks[0] = last;
  assign id[0]    = in_id_i;
  for (genvar s = 0; s < Stages; s++) begin : gen_stage
    always_ff @(posedge clk_i) begin
      if (move) begin
        valid[s+1] <= valid[s];
        marks[s+1] <= marks[s];
        id[s+1]    <= id[s];
      end
      if (rst_i) valid[s+1] <= 1'b0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (move) begin
      out_last_o <= marks[Stages];
      out_id_o   <= id[Stages];
    end
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
    logic        [GainBits-1:0]    factor;
    logic signed [ProductBits-1:0] product;
    assign raw  = signed'(in_data_i[SampleBits*k+:SampleBits]);
    assign zero = signed'(offset[SampleBits*k+:SampleBits]);

    always_ff @(posedge clk_i) begin
      if (move) begin
        difference <= in_mask_i[k] || !loaded ? '0 : DiffBits'(raw) - DiffBits'(zero);
        factor     <= gain[GainBits*k+:GainBits];
      end
    end

    if (!RowColumn) begin : gen_product
      always_ff @(posedge clk_i) if (move) product <= difference * signed'({1'b0, factor});
    end else begin : gen_wide_product
      // Two products of 18 x 17 bits, one multiplier each. 24 multipliers lie all over the part: a register
      // on the way there and one on the way back.
      logic signed [DiffBits-1:0]  there;
      logic        [GainBits-1:0]  there_factor;
      logic signed [DiffBits+16:0] low, high, back_low, back_high;
      always_ff @(posedge clk_i) begin
        if (move) begin
          there        <= difference;
          there_factor <= factor;
          low          <= there * signed'({1'b0, there_factor[15:0]});
          high         <= there * signed'({1'b0, there_factor[31:16]});
          back_low     <= low;
          back_high    <= high;
          product      <= ProductBits'(back_low) + (ProductBits'(back_high) <<< 16);
        end
      end
    end

    msn_round_sat #(.InWidth(ProductBits), .OutWidth(16), .DropBits(GainShift), .Unsigned(1'b1)) u_round (
      .clk_i,
      .rst_i,
      .in_valid_i (valid[Stages]),
      .in_ready_o (ready[k]),
      .in_data_i  (product),
      .out_valid_o(out_valid[k]),
      .out_ready_i,
      .out_data_o (out_data_o[16*k+:16])
    );
  end

endmodule
