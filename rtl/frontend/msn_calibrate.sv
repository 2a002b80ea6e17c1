// SPDX-License-Identifier: Apache-2.0
//
// Forces of an array's samples.
//
//   F = clip(floor((raw - offset) gain / 2^GainShift + 1/2), 0, 65535)
//   offset, gain: a word of each taxel, msn_calibration_table; RowColumn: row's and column's, msn_calibration_grid
//
// Lanes columns a beat, row by row. Masked taxels give 0, and all of them until a calibration is swapped in.
// Offset = 0: the samples have lost theirs (msn_tare). Nothing is rounded before the one rounding.
//
//   clock  1             2        3            RowColumn:  1 .. 6  7             8 .. 9    10    11   12     13 .. 15
//          raw - offset  x gain   round, clip              tables  raw - offset  2 x gain  copy  sum  round  fifo
//
// Latency 3 clocks (RowColumn 15), a beat a clock, frames without a gap; without RowColumn a few clocks wait after
// a swap and a damaged frame. Damaged frames leave too short or too long (msn_frame_place).
// Model: model/meissner/twins/frontend/calibrate.py

module msn_calibrate #(
  parameter  int unsigned Rows       = 64,
  parameter  int unsigned Columns    = 64,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          Offset     = 1'b1,
  parameter  bit          RowColumn  = 1'b0,
  parameter  int unsigned GainShift  = RowColumn ? 24 : 12,  // 4096 and 4096^2 are a gain of 1.0
  localparam int unsigned Beats      = Rows * ((Columns + Lanes - 1) / Lanes),
  localparam int unsigned IdBits     = msn_pkg::index_width(Beats),
  localparam int unsigned OffsetBits = SampleBits - 32'(RowColumn)
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
  input  logic [Lanes-1:0]            in_mask_i,        // taxels to leave out
  input  logic [IdBits-1:0]           in_id_i,
  input  logic                        in_last_i,

  output logic                        out_valid_o,
  input  logic                        out_ready_i,
  output logic [Lanes*16-1:0]         out_data_o,
  output logic [Lanes-1:0]            out_mask_o,       // as it came in
  output logic [IdBits-1:0]           out_id_o,
  output logic                        out_last_o,

  output logic [31:0]                 damaged_o         // frames, since reset
);

  localparam int unsigned DiffBits    = SampleBits + 32'(Offset);
  localparam int unsigned GainBits    = RowColumn ? 32 : 16;
  localparam int unsigned ProductBits = DiffBits + GainBits + 1;

  if (GainShift < 1 || GainShift > GainBits) begin : gen_check_gain_shift
    $fatal(1, "msn_calibrate: GainShift = %0d must lie in 1 .. %0d", GainShift, GainBits);
  end

  logic placed, keep, last, whole, unused_fits, placed_last;
  logic [IdBits-1:0] placed_id, unused_place;
  msn_frame_place #(.Beats(Beats)) u_place (
    .clk_i, .rst_i,
    .accept_i(placed),
    .in_id_i(placed_id), .in_last_i(placed_last),
    .place_o(unused_place), .keep_o(keep), .last_o(last), .fits_o(unused_fits), .whole_o(whole), .damaged_o
  );

  if (!RowColumn) begin : gen_taxels
    // All stages move together.
    logic move, accept, word_valid, loaded, unused_row;
    logic [Lanes*SampleBits-1:0] offset;
    logic [Lanes*16-1:0]         gain;
    assign in_ready_o  = move && word_valid;
    assign accept      = in_valid_i && in_ready_o;
    assign placed      = accept;
    assign placed_id   = in_id_i;
    assign placed_last = in_last_i;
    assign unused_row  = cfg_write_row_i;

    msn_calibration_table #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .Offset(Offset)
    ) u_table (
      .clk_i, .rst_i,
      .cfg_write_i, .cfg_word_i, .cfg_offset_i, .cfg_gain_i, .cfg_swap_i, .cfg_swapping_o,
      .take_i(accept), .last_i(in_last_i), .restart_i(accept && in_last_i && !whole),
      .out_valid_o(word_valid), .out_offset_o(offset), .out_gain_o(gain),
      .loaded_o(loaded)
    );

    logic [2:1]          valid, marks;
    logic [2*IdBits-1:0] id;
    logic [2*Lanes-1:0]  mask;
    always_ff @(posedge clk_i) begin
      if (move) begin
        valid      <= {valid[1], accept && keep};
        marks      <= {marks[1], last};
        out_last_o <= marks[2];
        {out_id_o, id}     <= {id, in_id_i};
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

  end else begin : gen_grid
    // 24 multipliers and 20 memories lie all over the part, too far for one ready to reach them in a clock: so
    // nothing behind the input ever waits, and a beat is let in only if the fifo at the end has a place for it.
    localparam int unsigned Stages   = 12;
    localparam int unsigned Places   = 32;
    localparam int unsigned RowBeats = Beats / Rows;
    localparam int unsigned WordBits = msn_pkg::index_width(Rows > RowBeats ? Rows : RowBeats);
    logic accept, unused_whole, unused_room, gone, dropped;
    logic [5:0] owed;  // places of the fifo, up to two clocks ago
    assign accept       = in_valid_i && in_ready_o;
    assign unused_whole = whole;

    logic [Stages:1]          valid, marks;
    logic [Stages*IdBits-1:0] id;
    assign placed      = valid[1];
    assign placed_id   = id[IdBits-1:0];
    assign placed_last = marks[1];

    always_ff @(posedge clk_i) begin
      valid <= {valid[Stages-1:2], valid[1] && keep, accept};
      marks <= {marks[Stages-1:2], last, in_last_i};
      id    <= {id[(Stages-1)*IdBits-1:0], in_id_i};

      gone       <= out_valid_o && out_ready_i;
      dropped    <= valid[1] && !keep;
      owed     <= owed + 6'(valid[1]) - 6'(gone) - 6'(dropped);
      in_ready_o <= owed < 6'(Places - 3);
      if (rst_i) begin
        valid      <= '0;
        owed     <= '0;
        gone       <= 1'b0;
        dropped    <= 1'b0;
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
      .take_i(accept), .last_i(in_last_i),
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

      // Two products of 18 x 16 bits, one multiplier each, a register more on the way there and back.
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

    msn_fifo #(.Depth(Places), .Width(Lanes * 17 + IdBits + 1)) u_fifo (
      .clk_i, .rst_i,
      .in_valid_i(valid[Stages]), .in_ready_o(unused_room),
      .in_data_i({marks[Stages], mask[Stages*Lanes-1-:Lanes], id[Stages*IdBits-1-:IdBits], rounded}),
      .out_valid_o, .out_ready_i, .out_data_o({out_last_o, out_mask_o, out_id_o, out_data_o})
    );
  end

endmodule
