// SPDX-License-Identifier: Apache-2.0
//
// After reset, writes the same gain and offset 0 for every taxel and swaps them in; then passes the host's writes on.
// So a core gives forces before a host sets it up. RowColumn: this gain for the columns, 4096 for the rows. A write to
// a word that does not exist is ignored: it would change an existing word with the same low address bits.
//
// This takes Words + 1 clocks (RowColumn: a row's beats + Rows + 1), in which a host's writes are lost; then done_o.
// Error: none.
// Model: model/meissner/twins/frontend/calibrate.py

module msn_calibration_preset #(
  parameter  int unsigned Rows       = 64,
  parameter  int unsigned Columns    = 64,
  parameter  int unsigned Lanes      = 1,
  parameter  bit          RowColumn  = 1'b0,
  localparam int unsigned RowBeats   = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned IdBits     = msn_pkg::index_width(Rows * RowBeats)
) (
  input  logic                              clk_i,
  input  logic                              rst_i,

  input  msn_registers_pkg::calibrate_cfg_t in_i,
  output msn_registers_pkg::calibrate_cfg_t out_o,
  output logic                              done_o  // for one clock
);

  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_calibration_preset: Lanes = %0d must be 1, 2, 4 or 8", Lanes);
  end

  localparam int unsigned Words   = RowColumn ? RowBeats : Rows * RowBeats;
  localparam int unsigned RowGain = 4096;

  logic              busy, rows, swap, final_word, there;
  logic [IdBits-1:0] word;
  assign final_word = word == (rows ? IdBits'(Rows - 1) : IdBits'(Words - 1));
  assign there      = {1'b0, in_i.word} < (in_i.write_row ? 21'(Rows) : 21'(Words));

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

  always_comb begin
    out_o               = in_i;
    out_o.write_written = in_i.write_written && there;
    if (busy) begin
      out_o.word          = 20'(word);
      out_o.offset        = '0;
      out_o.gain          = rows ? 16'(RowGain) : in_i.preset;
      out_o.write_lanes   = '1;
      out_o.write_row     = rows;
      out_o.write_written = !swap;
      out_o.swap          = swap;
    end
  end

endmodule
