// SPDX-License-Identifier: Apache-2.0
//
// After reset, writes the same gain and offset 0 for every taxel and swaps them in; then passes the host's writes on.
// So a core gives forces before a host sets it up. RowColumn: this gain for the columns, 4096 for the rows.
//
// This takes Words + 1 clocks (RowColumn: a row's beats + Rows + 1), in which a host's writes are lost; then done_o.
// Error: none.
// Model: model/meissner/twins/frontend/calibration_preset.py

module msn_calibration_preset #(
  parameter  int unsigned Rows       = 64,
  parameter  int unsigned Columns    = 64,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned OffsetBits = 17,
  parameter  bit          RowColumn  = 1'b0,
  localparam int unsigned RowBeats   = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned IdBits     = msn_pkg::index_width(Rows * RowBeats)
) (
  input  logic                  clk_i,
  input  logic                  rst_i,

  input  logic [15:0]           cfg_gain_i,

  input  logic [Lanes-1:0]      in_write_i,      // as in msn_calibration_table
  input  logic                  in_write_row_i,
  input  logic [IdBits-1:0]     in_word_i,
  input  logic [OffsetBits-1:0] in_offset_i,
  input  logic [15:0]           in_gain_i,
  input  logic                  in_swap_i,

  output logic [Lanes-1:0]      out_write_o,
  output logic                  out_write_row_o,
  output logic [IdBits-1:0]     out_word_o,
  output logic [OffsetBits-1:0] out_offset_o,
  output logic [15:0]           out_gain_o,
  output logic                  out_swap_o,
  output logic                  done_o           // for one clock
);

  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_calibration_preset: Lanes = %0d must be 1, 2, 4 or 8", Lanes);
  end

  localparam int unsigned Words   = RowColumn ? RowBeats : Rows * RowBeats;
  localparam int unsigned RowGain = 4096;

  logic              busy, rows, swap, final_word;
  logic [IdBits-1:0] word;
  assign final_word = word == (rows ? IdBits'(Rows - 1) : IdBits'(Words - 1));

  always_ff @(posedge clk_i) begin
    if (busy && !swap) begin
      word <= final_word ? '0 : word + 1'b1;
      if (final_word) begin
        rows <= RowColumn;
        swap <= rows || !RowColumn;
      end
    end
    done_o <= swap && busy;
    if (swap) busy <= 1'b0;
    if (rst_i) begin
      busy   <= 1'b1;
      rows   <= 1'b0;
      swap   <= 1'b0;
      word   <= '0;
      done_o <= 1'b0;
    end
  end

  assign out_write_o     = busy ? {Lanes{!swap && !rows}} : in_write_i;
  assign out_write_row_o = busy ? !swap && rows : in_write_row_i;
  assign out_word_o      = busy ? word : in_word_i;
  assign out_offset_o    = busy ? '0 : in_offset_i;
  assign out_gain_o      = !busy ? in_gain_i : rows ? 16'(RowGain) : cfg_gain_i;
  assign out_swap_o      = busy ? swap : in_swap_i;

endmodule
