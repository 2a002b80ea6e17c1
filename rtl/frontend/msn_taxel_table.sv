// SPDX-License-Identifier: Apache-2.0
//
// Offset and gain of the next beat's taxels, read ahead from two banks: one in use, the other for writes.
//
// A write goes to the bank that is not in use; swap exchanges the two before the next frame's first beat, never
// inside a frame. A word is a beat, written for every lane set in write_lanes; a write to one that does not exist is
// ignored, as it would change another with the same low address bits. Before the first swap after a reset every offset
// is 0 and every gain is preset. Offsets are signed, gains unsigned.
//
// A word a clock; none for 3 clocks after a swap and for 4 after a damaged frame.
// Model: model/meissner/twins/frontend/calibrate.py

module msn_taxel_table #(
  parameter  int unsigned Rows       = 64,
  parameter  int unsigned Columns    = 64,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  bit          Offset     = 1'b1,
  localparam int unsigned Words      = Rows * ((Columns + Lanes - 1) / Lanes),
  localparam int unsigned IdBits     = msn_pkg::index_width(Words)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  msn_registers_pkg::calibrate_cfg_t    cfg_i,
  output msn_registers_pkg::calibrate_status_t status_o,      // swapping: not done yet

  input  logic                         take_i,         // of a beat, only while out_valid_o
  input  logic                         last_i,         // with it: the frame's last
  output logic                         out_valid_o,
  output logic [Lanes*SampleBits-1:0]  out_offset_o,
  output logic [Lanes*16-1:0]          out_gain_o
);

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_taxel_table: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_taxel_table: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_taxel_table: Lanes = %0d must lie in 1 .. 8", Lanes);
  end
  if (SampleBits < 2 || SampleBits > 18) begin : gen_check_sample_bits
    $fatal(1, "msn_taxel_table: SampleBits = %0d must lie in 2 .. 18", SampleBits);
  end

  // Banks change only between frames. Words read ahead from the old bank are discarded, and no beat is taken
  // until the new bank's first word is valid.
  logic bank, midway, stale, swap, restart, bank_next, at_end, swapping, loaded;
  assign status_o  = swapping;
  assign swap      = swapping && !midway;
  assign restart   = rst_i || stale || swap;
  assign bank_next = bank ^ swap;

  always_ff @(posedge clk_i) begin
    if (take_i) midway <= !last_i;
    stale          <= take_i && last_i && !at_end;  // of a damaged frame; a clock later: take_i is known late
    bank           <= bank_next;
    swapping       <= cfg_i.swap || (swapping && !swap);
    loaded         <= loaded || swap;
    if (rst_i) begin
      midway         <= 1'b0;
      stale          <= 1'b0;
      bank           <= 1'b0;
      swapping       <= 1'b0;
      loaded         <= 1'b0;
    end
  end

  localparam int unsigned PartBits = Offset ? 16 + SampleBits : 16;

  logic                      valid, spoilt;
  logic [PartBits-1:0]       entry;
  logic [Lanes*PartBits-1:0] word;
  if (Offset) begin : gen_entry
    assign entry = {SampleBits'(signed'(cfg_i.offset)), cfg_i.gain};
  end else begin : gen_entry_gain
    assign entry = cfg_i.gain;
  end
  logic             there;
  logic [Lanes-1:0] write;
  assign there = {1'b0, cfg_i.word} < 21'(Words);
  assign write = (cfg_i.write_written && !cfg_i.write_row && there) ? Lanes'(cfg_i.write_lanes) : '0;
  logic unused_cfg;
  assign unused_cfg  = ^cfg_i;
  assign out_valid_o = valid && !swap && !stale;

  msn_frame_table #(.Words(Words), .Parts(Lanes), .PartBits(PartBits)) u_beats (
    .clk_i, .restart_i(restart), .bank_i(bank_next), .advance_i(take_i || !valid),
    .out_valid_o(valid), .out_data_o(word), .out_spoilt_o(spoilt),
    .at_end_o(at_end),
    .write_i(write), .write_bank_i(!bank), .write_word_i(cfg_i.word[IdBits-1:0]),
    .write_data_i({Lanes{entry}})
  );

  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    assign out_gain_o[16*k+:16] = loaded ? word[PartBits*k+:16] : cfg_i.preset;
    if (Offset) begin : gen_offset
      assign out_offset_o[SampleBits*k+:SampleBits] = loaded ? word[PartBits*k+16+:SampleBits] : '0;
    end else begin : gen_none
      assign out_offset_o[SampleBits*k+:SampleBits] = '0;
    end
  end

  // The bank read is never the one written, except before the first swap, when nothing is loaded.
  msn_check u_word_is_defined (
    .clk_i, .rst_i, .wrong_i(!rst_i && loaded && take_i && spoilt)
  );

endmodule
