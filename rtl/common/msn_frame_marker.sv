// SPDX-License-Identifier: Apache-2.0
//
// Checks an array's frames: numbers the beats, marks the ends of rows and never passes a damaged frame as a complete
// one. No other block of the array path checks places; msn_frame_filter does again where taxels enter the slip path.
//
// Beats must count 0 .. Beats-1 with `last` on the final one (whose id is not checked). A frame that breaks
// this is counted once, and of it there pass
//   broken before the final beat:     the beats so far and the broken one, marked `last`: too short
//   `last` missing on the final beat: all beats so far and the one with `last`: too long by one
// so that a block that counts beats drops the frame and is in step again. out_fits_o needs no counting: the beat has
// its expected place and no earlier beat of the frame is damaged. A frame is undamaged if its `last` beat fits.
//
// Combinational; the data bypass this block. Every beat, dropped or not, waits for out_ready_i. A stream without
// numbers loops out_id_o back to in_id_i: then only `last` is checked.
// Error: none.
// Model: model/meissner/twins/common/frames.py

module msn_frame_marker #(
  parameter  int unsigned Rows     = 64,
  parameter  int unsigned RowBeats = 64,
  localparam int unsigned Beats    = Rows * RowBeats,
  localparam int unsigned IdBits   = msn_pkg::index_width(Beats)
) (
  input  logic              clk_i,
  input  logic              rst_i,

  input  logic              in_valid_i,
  output logic              in_ready_o,
  input  logic [IdBits-1:0] in_id_i,
  input  logic              in_last_i,

  output logic              out_valid_o,
  input  logic              out_ready_i,
  output logic [IdBits-1:0] out_id_o,        // the beat's place in the frame
  output logic              out_fits_o,
  output logic              out_row_last_o,
  output logic              out_last_o,

  output logic [31:0]       damaged_o        // frames, since reset
);

  if (Rows < 1) begin : gen_check_rows
    $fatal(1, "msn_frame_marker: Rows = %0d must be at least 1", Rows);
  end
  if (RowBeats < 1) begin : gen_check_row_beats
    $fatal(1, "msn_frame_marker: RowBeats = %0d must be at least 1", RowBeats);
  end

  localparam int unsigned ColumnBits = msn_pkg::index_width(RowBeats);

  logic [ColumnBits-1:0] column;
  logic                  dropping, closed, at_final, right, damage;
  assign at_final       = out_id_o == IdBits'(Beats - 1);
  assign right          = at_final ? in_last_i : !in_last_i && in_id_i == out_id_o;
  assign in_ready_o     = out_ready_i;
  assign out_valid_o    = in_valid_i && (!dropping || (in_last_i && !closed));
  assign out_fits_o     = right && !dropping;
  assign out_row_last_o = column == ColumnBits'(RowBeats - 1);
  assign out_last_o     = in_last_i || (!right && !at_final);

  always_ff @(posedge clk_i) begin
    if (in_valid_i && in_ready_o) begin
      out_id_o <= in_last_i || at_final || dropping ? '0 : out_id_o + 1'b1;
      column   <= in_last_i || out_row_last_o || dropping ? '0 : column + 1'b1;
      dropping <= !in_last_i && (dropping || !right);
      if (!dropping) closed <= !at_final;
    end
    damage <= in_valid_i && in_ready_o && !right && !dropping;
    if (damage) damaged_o <= damaged_o + 1'b1;  // a clock later: 32 clock enables are slow
    if (rst_i) begin
      out_id_o  <= '0;
      column    <= '0;
      dropping  <= 1'b0;
      damage    <= 1'b0;
      damaged_o <= '0;
    end
  end

endmodule
