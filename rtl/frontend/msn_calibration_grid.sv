// SPDX-License-Identifier: Apache-2.0
//
// Offset and gain of a beat's taxels, from a row's and a column's: for arrays too large for a word per taxel.
//
//   offset = row's + column's    gain = row's * column's, exact, 32 bits
//
// A write goes to the bank that is not in use; cfg_swap_i exchanges the two before the next frame's first
// beat, never inside a frame. cfg_word_i is a beat of a row, written for every lane set in cfg_write_i, or, with
// cfg_write_row_i, a row. Before the first swap out_loaded_o is low. Offsets are signed, gains unsigned.
//
//   clock  1        2     3, 4      5 .. 6
//          address  read  register  product, sum
//
// The words follow take_i by 6 clocks, a beat a clock. No stage stalls, so none needs a clock enable, and the
// memories' slow outputs have a full clock.   Model: model/meissner/twins/frontend/calibration_grid.py
// Error: none.

module msn_calibration_grid #(
  parameter  int unsigned Rows       = 1024,
  parameter  int unsigned Columns    = 1024,
  parameter  int unsigned Lanes      = 8,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          Offset     = 1'b1,
  localparam int unsigned RowBeats   = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned WordBits   = msn_pkg::index_width(Rows > RowBeats ? Rows : RowBeats),
  localparam int unsigned OffsetBits = SampleBits - 1  // so that the sum of two has SampleBits
) (
  input  logic                        clk_i,
  input  logic                        rst_i,

  input  logic [Lanes-1:0]            cfg_write_i,
  input  logic                        cfg_write_row_i,
  input  logic [WordBits-1:0]         cfg_word_i,
  input  logic [OffsetBits-1:0]       cfg_offset_i,
  input  logic [15:0]                 cfg_gain_i,
  input  logic                        cfg_swap_i,
  output logic                        cfg_swapping_o, // requested, not done yet

  input  logic                        take_i,         // a beat
  input  logic                        fits_i,         // with it: its marks, of msn_frame_marker
  input  logic                        row_last_i,
  input  logic                        last_i,
  output logic [Lanes*SampleBits-1:0] out_offset_o,
  output logic [Lanes*32-1:0]         out_gain_o,
  output logic                        out_loaded_o
);

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_calibration_grid: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_calibration_grid: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_calibration_grid: Lanes = %0d must be 1, 2, 4 or 8", Lanes);
  end
  if (SampleBits < 2 || SampleBits > 18) begin : gen_check_sample_bits
    $fatal(1, "msn_calibration_grid: SampleBits = %0d must lie in 2 .. 18", SampleBits);
  end

  localparam int unsigned RowBits  = msn_pkg::index_width(Rows);
  localparam int unsigned BeatBits = msn_pkg::index_width(RowBeats);
  localparam int unsigned PartBits = Offset ? 16 + OffsetBits : 16;

  // The place of the next beat, and its bank. A beat that does not fit ends its frame or is the final one without
  // last: what comes next is at place 0 either way.
  logic [BeatBits-1:0] beat;
  logic [RowBits-1:0]  row;
  logic                bank, midway, swap, restart;
  assign restart = last_i || !fits_i;
  assign swap    = cfg_swapping_o && !midway;

  logic [5:1]        loaded;
  logic [RowBits:0]  row_at;
  logic [BeatBits:0] beat_at;
  always_ff @(posedge clk_i) begin
    if (take_i) begin
      midway <= !last_i;
      beat   <= restart || row_last_i ? '0 : beat + 1'b1;
      row    <= restart ? '0 : row + RowBits'(row_last_i);
    end
    bank           <= bank ^ swap;
    cfg_swapping_o <= cfg_swap_i || (cfg_swapping_o && !swap);
    row_at         <= {bank ^ swap, row};
    beat_at        <= {bank ^ swap, beat};
    loaded         <= {loaded[4:1], loaded[1] || swap};
    out_loaded_o   <= loaded[5];
    if (rst_i) begin
      {beat, row, midway, bank, cfg_swapping_o} <= '0;
      loaded <= '0;
    end
  end

  logic [PartBits-1:0] entry;
  if (Offset) begin : gen_entry
    assign entry = {cfg_offset_i, cfg_gain_i};
  end else begin : gen_entry_gain
    logic unused_offset;
    assign unused_offset = ^cfg_offset_i;
    assign entry         = cfg_gain_i;
  end

  (* no_rw_check *) logic [PartBits-1:0] rows [2**(RowBits+1)];
  logic [PartBits-1:0] row_read, row_near, of_row;
  always_ff @(posedge clk_i) begin
    if (cfg_write_row_i) rows[{!bank, RowBits'(cfg_word_i)}] <= entry;
    row_read <= rows[row_at];
    row_near <= row_read;
    of_row   <= row_near;
  end

  // Gains and offsets in separate memories: their data go to different places, and the first register after a
  // memory must be placed next to it.
  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    (* no_rw_check *) logic [15:0] gains [2**(BeatBits+1)];
    logic [15:0]        gain_read, gain_near, gain_column;
    logic signed [32:0] gain;
    msn_multiply #(.AWidth(17), .BWidth(16)) u_gain (
      .clk_i, .enable_i(1'b1), .a_i(signed'({1'b0, of_row[15:0]})), .b_i(gain_column), .y_o(gain)
    );
    assign out_gain_o[32*k+:32] = gain[31:0];
    logic unused_sign;
    assign unused_sign = gain[32];
    always_ff @(posedge clk_i) begin
      if (cfg_write_i[k]) gains[{!bank, BeatBits'(cfg_word_i)}] <= cfg_gain_i;
      gain_read   <= gains[beat_at];
      gain_near   <= gain_read;
      gain_column <= gain_near;
    end

    if (Offset) begin : gen_offset
      (* no_rw_check *) logic [OffsetBits-1:0] offsets [2**(BeatBits+1)];
      logic        [OffsetBits-1:0] offset_read, offset_near;
      logic signed [OffsetBits-1:0] offset_column, column_offset, row_offset;
      always_ff @(posedge clk_i) begin
        if (cfg_write_i[k]) offsets[{!bank, BeatBits'(cfg_word_i)}] <= cfg_offset_i;
        offset_read   <= offsets[beat_at];
        offset_near   <= offset_read;
        offset_column <= signed'(offset_near);
        column_offset <= offset_column;
        row_offset    <= signed'(of_row[16+:OffsetBits]);
        out_offset_o[SampleBits*k+:SampleBits] <= SampleBits'(row_offset) + SampleBits'(column_offset);
      end
    end else begin : gen_none
      assign out_offset_o[SampleBits*k+:SampleBits] = '0;
    end
  end

`ifndef SYNTHESIS
  // Reading a word in the clock in which it is written is undefined. It cannot happen, as the bank read is never the
  // one written, except before the first reset and for a clock after a reset, when nothing is loaded.
  // verilator coverage_off
  logic begun, was_reset;
  initial {begun, was_reset} = '0;
  always @(posedge clk_i) begin
    was_reset <= rst_i;
    begun     <= !rst_i && (begun || was_reset);
    if (begun && !rst_i) begin
      assert (!cfg_write_row_i || row_at[RowBits] == bank)
      else $fatal(1, "msn_calibration_grid: bank %0d of rows is read and written in one clock", !bank);
      assert (cfg_write_i == '0 || beat_at[BeatBits] == bank)
      else $fatal(1, "msn_calibration_grid: bank %0d of columns is read and written in one clock", !bank);
    end
  end
  // verilator coverage_on
`endif

endmodule
