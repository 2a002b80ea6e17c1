// SPDX-License-Identifier: Apache-2.0
//
// Calibrates an array's samples to forces, with offset and gain of each taxel or, for large arrays (RowColumn), with
// a row's and a column's: offset = row's + column's, gain = row's * column's.
//
//   F = clip(floor((raw - offset) gain / 2^GainShift + 1/2), 0, 65535)
//
// Lanes columns a beat, row by row. Masked taxels give 0. Until a calibration is swapped in after a reset, all have
// offset 0 and the gain preset, so a host's writes are never lost and forces need no host.
// Offset = 0: the offsets are already subtracted (msn_tare). The result is rounded only once. Beats as
// msn_frame_marker gives them; their marks travel with them.
//
//   clock  1 raw - offset    2 x gain        3 round, clip                  RowColumn:
//          1 .. 6 tables     7 raw - offset  8, 9 x gain   10 copy   11 sum   12 round   13 .. 15 fifo
//
// Latency 3 clocks (RowColumn 15), a beat a clock, frames without a gap, but of taxels a few clocks' wait after a swap
// and a damaged frame.   Model: model/meissner/twins/frontend/calibrate.py   Error: at most 1/2 LSB (tb/extremes).

module msn_calibrate #(
  parameter  int unsigned Rows       = 64,
  parameter  int unsigned Columns    = 64,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          RowColumn  = 1'b0,
  parameter  bit          Offset     = 1'b1,
  parameter  int unsigned GainShift  = RowColumn ? 24 : 12  // 4096, with RowColumn 4096^2: gain 1.0
) (
  input  logic                                 clk_i,
  input  logic                                 rst_i,

  input  msn_registers_pkg::calibrate_cfg_t    cfg_i,          // of the table
  output msn_registers_pkg::calibrate_status_t status_o,

  input  logic                                 in_valid_i,
  output logic                                 in_ready_o,
  input  logic [Lanes*SampleBits-1:0]          in_data_i,      // signed, the leftmost column in the low bits
  input  logic [Lanes-1:0]                     in_mask_i,      // taxels that give 0
  input  logic                                 in_fits_i,
  input  logic                                 in_row_last_i,
  input  logic                                 in_last_i,

  output logic                                 out_valid_o,
  input  logic                                 out_ready_i,
  output logic [Lanes*16-1:0]                  out_data_o,
  output logic [Lanes-1:0]                     out_mask_o,     // as it came in
  output logic                                 out_fits_o,
  output logic                                 out_row_last_o,
  output logic                                 out_last_o
);

  localparam int unsigned GainBits    = RowColumn ? 32 : 16;
  localparam int unsigned DiffBits    = SampleBits + 32'(Offset);
  localparam int unsigned ProductBits = DiffBits + GainBits + 1;
  localparam int unsigned DataBits    = Lanes * SampleBits;

  if (GainShift < 1 || GainShift > GainBits) begin : gen_check_gain_shift
    $fatal(1, "msn_calibrate: GainShift = %0d must lie in 1 .. %0d", GainShift, GainBits);
  end

  logic                      accept;
  logic [2:0]                marks_in, marks_out;
  logic [DataBits-1:0]       offset;
  logic [Lanes*GainBits-1:0] gain;
  assign accept   = in_valid_i && in_ready_o;
  assign marks_in = {in_fits_i, in_row_last_i, in_last_i};
  assign {out_fits_o, out_row_last_o, out_last_o} = marks_out;

  if (!RowColumn) begin : gen_taxels
    // All stages advance together.
    logic move, word_valid;
    assign in_ready_o = move && word_valid;
    msn_taxel_table #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .Offset(Offset)
    ) u_table (
      .clk_i, .rst_i, .cfg_i, .status_o,
      .take_i(accept), .last_i(in_last_i), .out_valid_o(word_valid), .out_offset_o(offset), .out_gain_o(gain)
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
      logic signed [SampleBits-1:0] raw, zero;
      logic signed [DiffBits-1:0]   difference;
      logic signed [DiffBits+15:0]  product;  // two clocks later: the multiplier's own registers
      assign raw        = signed'(in_data_i[SampleBits*k+:SampleBits]);
      assign zero       = signed'(offset[SampleBits*k+:SampleBits]);
      assign difference = in_mask_i[k] ? '0 : DiffBits'(raw) - DiffBits'(zero);

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
    // 24 multipliers and 20 memories are spread over the device, too far apart for one ready to reach in a clock: so
    // no stage after the input stalls, and a beat enters only if the fifo at the end has room for it.
    localparam int unsigned Stages = 12;
    localparam int unsigned Places = 32;
    msn_grid_table #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .Offset(Offset)
    ) u_table (
      .clk_i, .rst_i, .cfg_i, .status_o,
      .take_i(accept), .fits_i(in_fits_i), .row_last_i(in_row_last_i), .last_i(in_last_i),
      .out_offset_o(offset), .out_gain_o(gain)
    );

    // Where no beat is under way and none has been for the fifo's 3 clocks, none is in the fifo either: so what an upset
    // changes of the credit lasts until the block is empty, and a block that takes no beat becomes empty.
    localparam int unsigned Inside = Stages + 3;
    logic unused_room, unused_half, gone, empty;
    logic [5:0]              owed;  // fifo places in use or promised, as of up to two clocks ago
    logic [Inside:1]         valid;
    assign empty = valid == '0 && !out_valid_o;
    logic [3*Stages-1:0]     marks;
    logic [6*DataBits-1:0]   data;
    logic [Stages*Lanes-1:0] mask;
    always_ff @(posedge clk_i) begin
      valid      <= {valid[Inside-1:1], accept};
      marks      <= {marks[3*(Stages-1)-1:0], marks_in};
      data       <= {data[5*DataBits-1:0], in_data_i};
      mask       <= {mask[(Stages-1)*Lanes-1:0], in_mask_i};
      gone       <= out_valid_o && out_ready_i;
      owed       <= empty ? '0 : owed + 6'(valid[1]) - 6'(gone);
      in_ready_o <= owed < 6'(Places - 3);
      if (rst_i) begin
        valid      <= '0;
        owed       <= '0;
        gone       <= 1'b0;
        in_ready_o <= 1'b0;
      end
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
        difference <= mask[5*Lanes+k] ? '0 : DiffBits'(raw) - DiffBits'(zero);
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
      .out_valid_o, .out_ready_i, .out_data_o({marks_out, out_mask_o, out_data_o}), .half_o(unused_half)
    );
  end

endmodule
