// SPDX-License-Identifier: Apache-2.0
//
// Where in its frame a beat lies, and whether it may pass, so that no damaged frame looks whole behind.
//
// Beats must count 0 .. Beats-1 with `last` on the final one (whose id is then not asked). A frame that
// breaks this is counted once, and what its follower gets of it is
//   broken before the final beat:     the beats so far and the broken one, marked `last`: too short
//   `last` missing on the final beat: that beat and the one that brings `last`: one too long
// so that whoever counts beats drops it and is in step again.
//
// Combinational beside the caller's first register.   Model: model/meissner/twins/common/frame_place.py

module msn_frame_place #(
  parameter  int unsigned Beats  = 4096,
  localparam int unsigned IdBits = msn_pkg::index_width(Beats)
) (
  input  logic              clk_i,
  input  logic              rst_i,

  input  logic              accept_i,   // a beat is taken
  input  logic [IdBits-1:0] in_id_i,
  input  logic              in_last_i,

  output logic [IdBits-1:0] place_o,
  output logic              keep_o,     // let it pass
  output logic              last_o,     // marked so
  output logic              fits_o,     // it is the beat of this place, no damage before it
  output logic              whole_o,    // and it ends its frame

  output logic [31:0]       damaged_o   // frames, since reset
);

  if (Beats < 1) begin : gen_check_beats
    $fatal(1, "msn_frame_place: Beats = %0d must be at least 1", Beats);
  end

  logic dropping, closed, at_final, right, damage;
  assign at_final = place_o == IdBits'(Beats - 1);
  assign right    = at_final ? in_last_i : !in_last_i && in_id_i == place_o;
  assign fits_o   = right && !dropping;
  assign whole_o  = fits_o && at_final;
  assign keep_o   = !dropping || (in_last_i && !closed);
  assign last_o   = in_last_i || (!right && !at_final);

  always_ff @(posedge clk_i) begin
    if (accept_i) begin
      place_o  <= in_last_i || at_final ? '0 : place_o + 1'b1;
      dropping <= !in_last_i && (dropping || !right);
      if (!dropping) closed <= !at_final;
    end
    damage <= accept_i && !right && !dropping;
    if (damage) damaged_o <= damaged_o + 1'b1;  // a clock late: 32 enables are slow
    if (rst_i) begin
      place_o   <= '0;
      dropping  <= 1'b0;
      damage    <= 1'b0;
      damaged_o <= '0;
    end
  end

endmodule
