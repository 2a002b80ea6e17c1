// SPDX-License-Identifier: Apache-2.0
//
// Offset and gain of a beat's taxels, from a row's and a column's: for arrays too large for a word per taxel.
//
//   offset = row's + column's    gain = row's * column's, exact, 32 bits
//
// A write goes to the bank that is not in use; swap exchanges the two before the next frame's first beat, never
// inside a frame. A word is a beat of a row, written for every lane set in write_lanes, or, with write_row, a row; a
// write to one that does not exist is ignored, as it would change another with the same low address bits. Before the
// first swap after a reset every offset is 0, a row's gain 4096 and a column's preset. Offsets are signed, gains unsigned.
//
//   clock  1        2     3, 4      5 .. 6
//          address  read  register  product, sum
//
// The words follow take_i by 6 clocks, a beat a clock. No stage stalls, so none needs a clock enable, and the
// memories' slow outputs have a full clock.   Model: model/meissner/twins/frontend/calibrate.py
// Error: none.

module msn_grid_table #(
  parameter  int unsigned Rows       = 1024,
  parameter  int unsigned Columns    = 1024,
  parameter  int unsigned Lanes      = 8,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          Offset     = 1'b1,
  localparam int unsigned RowBeats   = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned OffsetBits = SampleBits - 1  // so that the sum of two has SampleBits
) (
  input  logic                        clk_i,
  input  logic                        rst_i,

  input  msn_registers_pkg::calibrate_cfg_t    cfg_i,
  output msn_registers_pkg::calibrate_status_t status_o,     // swapping: requested, not done yet

  input  logic                        take_i,         // a beat
  input  logic                        fits_i,         // with it: its marks, of msn_frame_marker
  input  logic                        row_last_i,
  input  logic                        last_i,
  output logic [Lanes*SampleBits-1:0] out_offset_o,
  output logic [Lanes*32-1:0]         out_gain_o
);

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_grid_table: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_grid_table: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_grid_table: Lanes = %0d must lie in 1 .. 8", Lanes);
  end
  if (SampleBits < 2 || SampleBits > 18) begin : gen_check_sample_bits
    $fatal(1, "msn_grid_table: SampleBits = %0d must lie in 2 .. 18", SampleBits);
  end

  localparam int unsigned RowBits  = msn_pkg::index_width(Rows);
  localparam int unsigned BeatBits = msn_pkg::index_width(RowBeats);
  localparam int unsigned PartBits = Offset ? 16 + OffsetBits : 16;

  // The place of the next beat, and its bank. A beat that does not fit ends its frame or is the final one without
  // last: what comes next is at place 0 either way.
  logic [BeatBits-1:0] beat;
  logic [RowBits-1:0]  row;
  logic                bank, midway, swap, restart, swapping;
  assign status_o  = swapping;
  assign restart   = last_i || !fits_i;
  assign swap      = swapping && !midway;

  logic [3:1]        loaded;  // with the words of this clock of the pipeline
  logic [RowBits:0]  row_at;
  logic [BeatBits:0] beat_at;
  always_ff @(posedge clk_i) begin
    if (take_i) begin
      midway <= !last_i;
      beat   <= restart || row_last_i ? '0 : beat + 1'b1;
      row    <= restart ? '0 : row + RowBits'(row_last_i);
    end
    bank           <= bank ^ swap;
    swapping       <= cfg_i.swap || (swapping && !swap);
    row_at         <= {bank ^ swap, row};
    beat_at        <= {bank ^ swap, beat};
    loaded         <= {loaded[2:1], loaded[1] || swap};
    if (rst_i) begin
      {beat, row, midway, bank, swapping} <= '0;
      loaded <= '0;
    end
  end

  // A write reaches the memories a clock later, still before a swap asked for with it: they are far apart, so nothing
  // is decided on the way to them (133 MHz with the comparison on that way).
  localparam int unsigned WordBits = (RowBits > BeatBits) ? RowBits : BeatBits;
  logic                         there, write_row;
  logic        [Lanes-1:0]      write;
  logic        [WordBits-1:0]   word;
  logic        [15:0]           entry_gain;
  logic signed [OffsetBits-1:0] entry_offset;
  logic        [PartBits-1:0]   entry;
  assign there = {1'b0, cfg_i.word} < (cfg_i.write_row ? 21'(Rows) : 21'(RowBeats));
  always_ff @(posedge clk_i) begin
    write_row    <= cfg_i.write_written && cfg_i.write_row && there;
    write        <= (cfg_i.write_written && !cfg_i.write_row && there) ? Lanes'(cfg_i.write_lanes) : '0;
    word         <= WordBits'(cfg_i.word);
    entry_gain   <= cfg_i.gain;
    entry_offset <= OffsetBits'(signed'(cfg_i.offset));
  end
  if (Offset) begin : gen_entry
    assign entry = {entry_offset, entry_gain};
  end else begin : gen_entry_gain
    assign entry = entry_gain;
  end
  logic unused_cfg;
  assign unused_cfg = ^{cfg_i, entry_offset, word};

  logic [PartBits-1:0] row_read, of_row;
  msn_ram #(.Words(2 ** (RowBits + 1)), .Width(PartBits)) u_rows (
    .clk_i,
    .write_i(write_row), .write_address_i({!bank, RowBits'(word)}), .write_data_i(entry),
    .read_i(1'b1), .read_address_i(row_at), .out_data_o(row_read)
  );
  always_ff @(posedge clk_i) of_row <= loaded[3] ? row_read : PartBits'(16'd4096);

  // Gains and offsets in separate memories: their data go to different places, and the first register after a
  // memory must be placed next to it.
  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    logic [15:0]        gain_read, gain_column;
    logic signed [32:0] gain;
    msn_ram #(.Words(2 ** (BeatBits + 1)), .Width(16)) u_gains (
      .clk_i,
      .write_i(write[k]), .write_address_i({!bank, BeatBits'(word)}), .write_data_i(entry_gain),
      .read_i(1'b1), .read_address_i(beat_at), .out_data_o(gain_read)
    );
    msn_multiply #(.AWidth(17), .BWidth(16)) u_gain (
      .clk_i, .enable_i(1'b1), .a_i(signed'({1'b0, of_row[15:0]})), .b_i(gain_column), .y_o(gain)
    );
    assign out_gain_o[32*k+:32] = gain[31:0];
    logic unused_sign;
    assign unused_sign = gain[32];
    always_ff @(posedge clk_i) gain_column <= loaded[3] ? gain_read : cfg_i.preset;

    if (Offset) begin : gen_offset
      logic        [OffsetBits-1:0] offset_read;
      logic signed [OffsetBits-1:0] offset_column, column_offset, row_offset;
      msn_ram #(.Words(2 ** (BeatBits + 1)), .Width(OffsetBits)) u_offsets (
        .clk_i,
        .write_i(write[k]), .write_address_i({!bank, BeatBits'(word)}), .write_data_i(entry_offset),
        .read_i(1'b1), .read_address_i(beat_at), .out_data_o(offset_read)
      );
      always_ff @(posedge clk_i) begin
        offset_column <= loaded[3] ? signed'(offset_read) : '0;
        column_offset <= offset_column;
        row_offset    <= signed'(of_row[16+:OffsetBits]);
        out_offset_o[SampleBits*k+:SampleBits] <= SampleBits'(row_offset) + SampleBits'(column_offset);
      end
    end else begin : gen_none
      assign out_offset_o[SampleBits*k+:SampleBits] = '0;
    end
  end

  // Reading a word in the clock in which it is written is undefined. It cannot happen, as the bank read is never the
  // one written, except for a clock after a reset, when nothing is loaded.
  logic was_reset;
  always_ff @(posedge clk_i) was_reset <= rst_i;
  msn_check u_read_is_not_written (
    .clk_i, .rst_i,
    .wrong_i(!rst_i && !was_reset && ((write_row && row_at[RowBits] != bank) ||
                                      (write != '0 && beat_at[BeatBits] != bank)))
  );

endmodule
