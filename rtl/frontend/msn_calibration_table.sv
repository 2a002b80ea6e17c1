// SPDX-License-Identifier: Apache-2.0
//
// Offset and gain of the next beat's taxels, read ahead from two banks: one in use, one to be written.
//
//   per taxel:    offset, gain from a word a beat
//   RowColumn:    offset = row's + column's, gain = row's * column's, exact: for arrays too big for the RAM
//
// A write goes to the bank that is not in use; cfg_swap_i exchanges the two before the next frame's first
// beat, never inside a frame. Words count beats, of every lane named in cfg_write_i; with RowColumn
// the beats of a row, and cfg_write_row_i rows. Before the first swap loaded_o is low.
//
// A word a clock, none for 3 clocks (RowColumn 5) after a swap and one more after a restart. Gains are unsigned,
// 16 bits, as a product 32.
// Model: model/meissner/frontend/calibration_table.py

module msn_calibration_table #(
  parameter  int unsigned Rows       = 64,
  parameter  int unsigned Columns    = 64,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          Offset     = 1'b1,
  parameter  bit          RowColumn  = 1'b0,
  localparam int unsigned RowBeats   = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned IdBits     = msn_pkg::index_width(Rows * RowBeats),
  localparam int unsigned OffsetBits = SampleBits - 32'(RowColumn),  // so that the sum of two has SampleBits
  localparam int unsigned GainBits   = RowColumn ? 32 : 16
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic [Lanes-1:0]             cfg_write_i,
  input  logic                         cfg_write_row_i,
  input  logic [IdBits-1:0]            cfg_word_i,
  input  logic [OffsetBits-1:0]        cfg_offset_i,   // signed
  input  logic [15:0]                  cfg_gain_i,
  input  logic                         cfg_swap_i,
  output logic                         cfg_swapping_o, // asked for, not done yet

  input  logic                         take_i,         // of a beat, only while out_valid_o
  input  logic                         last_i,         // with it: the frame's last
  input  logic                         restart_i,      // with it: the frame was not whole
  output logic                         out_valid_o,
  output logic [Lanes*SampleBits-1:0]  out_offset_o,
  output logic [Lanes*GainBits-1:0]    out_gain_o,
  output logic                         loaded_o
);

  if (Rows < 1 || Rows > 1024) begin : gen_check_rows
    $fatal(1, "msn_calibration_table: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (Columns < 1 || Columns > 1024) begin : gen_check_columns
    $fatal(1, "msn_calibration_table: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (Lanes != 1 && Lanes != 2 && Lanes != 4 && Lanes != 8) begin : gen_check_lanes
    $fatal(1, "msn_calibration_table: Lanes = %0d must be 1, 2, 4 or 8", Lanes);
  end
  if (SampleBits < 2 || SampleBits > 18) begin : gen_check_sample_bits
    $fatal(1, "msn_calibration_table: SampleBits = %0d must lie in 2 .. 18", SampleBits);
  end

  // Banks change between frames only. What was read ahead from the old one is thrown away, and no beat
  // goes before the new one's first word is there.
  logic bank, midway, stale, swap, restart, bank_next;
  assign swap      = cfg_swapping_o && !midway;
  assign restart   = rst_i || stale || swap;
  assign bank_next = bank ^ swap;

  always_ff @(posedge clk_i) begin
    if (take_i) midway <= !last_i;
    stale          <= restart_i;  // a clock late: who takes a beat is known late
    bank           <= bank_next;
    cfg_swapping_o <= cfg_swap_i || (cfg_swapping_o && !swap);
    loaded_o       <= loaded_o || swap;
    if (rst_i) begin
      midway         <= 1'b0;
      stale          <= 1'b0;
      bank           <= 1'b0;
      cfg_swapping_o <= 1'b0;
      loaded_o       <= 1'b0;
    end
  end

  localparam int unsigned PartBits = Offset ? 16 + OffsetBits : 16;
  localparam int unsigned Words    = RowColumn ? RowBeats : Rows * RowBeats;
  localparam int unsigned WordBits = msn_pkg::index_width(Words);

  logic                      valid, beat_valid, advance;
  logic [PartBits-1:0]       entry;
  logic [Lanes*PartBits-1:0] word;
  if (Offset) begin : gen_entry
    assign entry = {cfg_offset_i, cfg_gain_i};
  end else begin : gen_entry_gain
    logic unused_offset;
    assign unused_offset = ^cfg_offset_i;
    assign entry         = cfg_gain_i;
  end
  assign advance     = take_i || !valid;
  assign out_valid_o = valid && !swap && !stale;

  // Of every beat, or with RowColumn of every beat of a row.
  msn_frame_table #(.Words(Words), .Parts(Lanes), .PartBits(PartBits)) u_beats (
    .clk_i,
    .restart_i   (restart),
    .bank_i      (bank_next),
    .advance_i   (advance),
    .out_valid_o (beat_valid),
    .out_data_o  (word),
    .write_i     (cfg_write_i),
    .write_bank_i(!bank),
    .write_word_i(WordBits'(cfg_word_i)),
    .write_data_i({Lanes{entry}})
  );

  if (!RowColumn) begin : gen_taxels
    assign valid = beat_valid;
    for (genvar k = 0; k < Lanes; k++) begin : gen_lane
      assign out_gain_o[16*k+:16] = word[PartBits*k+:16];
      if (Offset) begin : gen_offset
        assign out_offset_o[SampleBits*k+:SampleBits] = word[PartBits*k+16+:SampleBits];
      end else begin : gen_none
        assign out_offset_o[SampleBits*k+:SampleBits] = '0;
      end
    end
    logic unused_row;
    assign unused_row = cfg_write_row_i;

  end else begin : gen_rows
    localparam int unsigned RowBits  = msn_pkg::index_width(Rows);
    localparam int unsigned BeatBits = msn_pkg::index_width(RowBeats);
    logic                row_valid, row_end;
    logic [PartBits-1:0] row;
    logic [BeatBits-1:0] beat;
    assign row_end = beat == BeatBits'(RowBeats - 1);

    // Both tables fill in the same clocks, so beat_valid speaks for both.
    msn_frame_table #(.Words(Rows), .Parts(1), .PartBits(PartBits)) u_rows (
      .clk_i,
      .restart_i   (restart),
      .bank_i      (bank_next),
      .advance_i   ((advance && row_end) || !row_valid),
      .out_valid_o (row_valid),
      .out_data_o  (row),
      .write_i     (cfg_write_row_i),
      .write_bank_i(!bank),
      .write_word_i(RowBits'(cfg_word_i)),
      .write_data_i(entry)
    );

    // Two more steps ahead, so that the lanes' multipliers have registers of their own on both sides.
    logic near_valid;
    always_ff @(posedge clk_i) begin
      if (advance && beat_valid) beat <= row_end ? '0 : beat + 1'b1;
      if (advance) {valid, near_valid} <= {near_valid, beat_valid};
      if (restart) begin
        beat                <= '0;
        {valid, near_valid} <= '0;
      end
    end

    for (genvar k = 0; k < Lanes; k++) begin : gen_lane
      (* keep *) logic [15:0] gain_row, gain_column;
      always_ff @(posedge clk_i) begin
        if (advance) begin
          gain_row             <= row[15:0];
          gain_column          <= word[PartBits*k+:16];
          out_gain_o[32*k+:32] <= 32'(gain_row) * 32'(gain_column);
        end
      end
      if (Offset) begin : gen_offset
        logic signed [OffsetBits-1:0] of_row, of_column;
        logic signed [SampleBits-1:0] total;
        assign of_row    = signed'(row[16+:OffsetBits]);
        assign of_column = signed'(word[PartBits*k+16+:OffsetBits]);
        always_ff @(posedge clk_i) begin
          if (advance) begin
            total                                  <= SampleBits'(of_row) + SampleBits'(of_column);
            out_offset_o[SampleBits*k+:SampleBits] <= total;
          end
        end
      end else begin : gen_none
        assign out_offset_o[SampleBits*k+:SampleBits] = '0;
      end
    end
  end

endmodule
