// SPDX-License-Identifier: Apache-2.0
//
// Calibrates an array's samples to forces, with offset and gain from a row's and a column's: for large arrays.
//
//   F = clip(floor((raw - offset) gain / 2^GainShift + 1/2), 0, 65535)
//   offset = row's + column's    gain = row's * column's
//
// Lanes columns a beat, row by row. Masked taxels give 0; until a calibration is swapped in, all taxels give 0.
// Offset = 0: the offsets are already subtracted (msn_tare). The result is rounded only once.
//
//   clock  1 .. 6  7             8 .. 9    10    11   12     13 .. 15
//          tables  raw - offset  2 x gain  copy  sum  round  fifo
//
// Latency 15 clocks, a beat a clock, frames without a gap, also after a swap or a damaged frame.
// Beats as msn_frame_marker gives them; their marks travel with them. The same ports as msn_calibrate_taxels.
// Error: at most 1/2 LSB (tb/extremes).
// Model: model/meissner/twins/frontend/calibrate_grid.py

module msn_calibrate_grid #(
  parameter  int unsigned Rows       = 1024,
  parameter  int unsigned Columns    = 1024,
  parameter  int unsigned Lanes      = 8,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          Offset     = 1'b1,
  parameter  int unsigned GainShift  = 24,  // 4096^2: gain 1.0
  localparam int unsigned RowBeats   = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned IdBits     = msn_pkg::index_width(Rows * RowBeats),
  localparam int unsigned OffsetBits = SampleBits - 1
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
  localparam int unsigned ProductBits = DiffBits + 32 + 1;

  if (GainShift < 1 || GainShift > 32) begin : gen_check_gain_shift
    $fatal(1, "msn_calibrate_grid: GainShift = %0d must lie in 1 .. 32", GainShift);
  end

  logic [2:0] marks_in, marks_out;
  assign marks_in = {in_fits_i, in_row_last_i, in_last_i};
  assign {out_fits_o, out_row_last_o, out_last_o} = marks_out;

  // 24 multipliers and 20 memories are spread over the device, too far apart for one ready to reach in a clock: so
  // no stage after the input stalls, and a beat enters only if the fifo at the end has room for it.
  localparam int unsigned Stages   = 12;
  localparam int unsigned Places   = 32;
  localparam int unsigned WordBits = msn_pkg::index_width(Rows > RowBeats ? Rows : RowBeats);
  logic accept, unused_room, gone;
  logic [5:0] owed;  // fifo places in use or promised, as of up to two clocks ago
  assign accept = in_valid_i && in_ready_o;

  logic [Stages:1]     valid;
  logic [3*Stages-1:0] marks;
  always_ff @(posedge clk_i) begin
    valid      <= {valid[Stages-1:1], accept};
    marks      <= {marks[3*(Stages-1)-1:0], marks_in};
    gone       <= out_valid_o && out_ready_i;
    owed       <= owed + 6'(valid[1]) - 6'(gone);
    in_ready_o <= owed < 6'(Places - 3);
    if (rst_i) begin
      valid      <= '0;
      owed       <= '0;
      gone       <= 1'b0;
      in_ready_o <= 1'b0;
    end
  end

  logic unused_word;  // a row's or a column's number has fewer bits than a beat's
  assign unused_word = ^cfg_word_i;

  logic loaded;
  logic [Lanes*SampleBits-1:0] offset;
  logic [Lanes*32-1:0]         gain;
  msn_calibration_grid #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .Offset(Offset)
  ) u_grid (
    .clk_i, .rst_i,
    .cfg_write_i, .cfg_write_row_i, .cfg_word_i(WordBits'(cfg_word_i)), .cfg_offset_i, .cfg_gain_i,
    .cfg_swap_i, .cfg_swapping_o,
    .take_i(accept), .fits_i(in_fits_i), .row_last_i(in_row_last_i), .last_i(in_last_i),
    .out_offset_o(offset), .out_gain_o(gain), .out_loaded_o(loaded)
  );

  localparam int unsigned DataBits = Lanes * SampleBits;
  logic [6*DataBits-1:0] data;
  logic [Stages*Lanes-1:0] mask;
  always_ff @(posedge clk_i) begin
    data <= {data[5*DataBits-1:0], in_data_i};
    mask <= {mask[(Stages-1)*Lanes-1:0], in_mask_i};
  end

  logic [Lanes*16-1:0] rounded;
  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    logic signed [SampleBits-1:0]  raw, zero;
    logic signed [DiffBits-1:0]    difference;
    logic        [31:0]            factor;
    logic signed [DiffBits+15:0]   low, high, back_low, back_high;
    logic signed [ProductBits-1:0] product;
    logic                          unused_ready, unused_valid;
    assign raw  = signed'(data[5*DataBits+SampleBits*k+:SampleBits]);
    assign zero = signed'(offset[SampleBits*k+:SampleBits]);

    // Two products of 18 x 16 bits, one multiplier each, with an extra register before and after it.
    always_ff @(posedge clk_i) begin
      difference <= mask[5*Lanes+k] || !loaded ? '0 : DiffBits'(raw) - DiffBits'(zero);
      factor     <= gain[32*k+:32];
      back_low   <= low;
      back_high  <= high;
      product    <= ProductBits'(back_low) + (ProductBits'(back_high) <<< 16);
    end
    msn_multiply #(.AWidth(DiffBits), .BWidth(16)) u_low (
      .clk_i, .enable_i(1'b1), .a_i(difference), .b_i(factor[15:0]), .y_o(low)
    );
    msn_multiply #(.AWidth(DiffBits), .BWidth(16)) u_high (
      .clk_i, .enable_i(1'b1), .a_i(difference), .b_i(factor[31:16]), .y_o(high)
    );

    msn_round_sat #(.InWidth(ProductBits), .OutWidth(16), .DropBits(GainShift), .Unsigned(1'b1)) u_round (
      .clk_i, .rst_i,
      .in_valid_i(1'b1), .in_ready_o(unused_ready), .in_data_i(product),
      .out_valid_o(unused_valid), .out_ready_i(1'b1), .out_data_o(rounded[16*k+:16])
    );
  end

  msn_fifo #(.Depth(Places), .Width(Lanes * 17 + 3)) u_fifo (
    .clk_i, .rst_i,
    .in_valid_i(valid[Stages]), .in_ready_o(unused_room),
    .in_data_i({marks[3*Stages-1-:3], mask[Stages*Lanes-1-:Lanes], rounded}),
    .out_valid_o, .out_ready_i, .out_data_o({marks_out, out_mask_o, out_data_o})
  );

endmodule
