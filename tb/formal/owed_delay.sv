// SPDX-License-Identifier: Apache-2.0
//
// What msn_delay guarantees, with the invariant that proves it, for proofs of blocks that contain one: a word watched
// from catch_i on (in the step that takes it in) is at the output Depth steps later. The caller reads the ring at
// slot_o: word_i = ring[slot_o]. Depth <= 4: only line_i is used.

module owed_delay #(
  parameter  int unsigned Depth    = 8,
  parameter  int unsigned Width    = 16,
  localparam int unsigned Slots    = (Depth > 4) ? Depth - 3 : 1,
  localparam int unsigned SlotBits = msn_pkg::index_width(Slots),
  localparam int unsigned Line     = (Depth <= 4) ? Depth : 1,
  localparam int unsigned AgeBits  = $clog2(Depth + 2)
) (
  input  logic                  clk_i,
  input  logic                  rst_i,
  input  logic                  step_i,
  input  logic                  catch_i,
  input  logic [Width-1:0]      in_data_i,
  input  logic [Width-1:0]      out_data_i,

  input  logic [Line*Width-1:0] line_i,
  input  logic [SlotBits-1:0]   slot_i,
  input  logic [Width-1:0]      newest_i,
  input  logic [Width-1:0]      oldest_i,
  input  logic [Width-1:0]      oldest_q_i,
  input  logic [Width-1:0]      word_i,
  output logic [SlotBits-1:0]   slot_o,

  output logic [AgeBits-1:0]    age_o,  // steps since the word entered; 0: none is watched
  output logic [Width-1:0]      kept_o
);

  logic started = 1'b0;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    if (step_i) begin
      if (age_o != '0) age_o <= (age_o == AgeBits'(Depth)) ? '0 : age_o + 1'b1;
      if (age_o == AgeBits'(1)) slot_o <= slot_i;
      if (catch_i && (age_o == '0 || age_o == AgeBits'(Depth))) begin
        age_o  <= AgeBits'(1);
        kept_o <= in_data_i;
      end
    end
    if (rst_i) age_o <= '0;
  end

  always_comb begin
    if (started) begin
      assert (age_o <= AgeBits'(Depth));
      if (age_o == AgeBits'(Depth)) assert (out_data_i == kept_o);
    end
  end

  if (Depth <= 4) begin : gen_line
    always_comb begin
      for (int unsigned a = 1; a <= Depth; a++) begin
        if (started && age_o == AgeBits'(a)) assert (line_i[(a-1)*Width+:Width] == kept_o);
      end
    end
  end else begin : gen_ring
    logic [31:0] behind;
    assign behind = (slot_i >= slot_o) ? 32'(slot_i) - 32'(slot_o) : 32'(slot_i) + Slots - 32'(slot_o);
    always_comb begin
      if (started) begin
        assert (32'(slot_i) < Slots);
        if (age_o == AgeBits'(1)) assert (newest_i == kept_o);
        if (age_o >= AgeBits'(2) && age_o <= AgeBits'(Slots)) begin
          assert (32'(slot_o) < Slots && behind == 32'(age_o) - 32'd1);
          assert (word_i == kept_o);
        end
        if (age_o == AgeBits'(Depth - 2)) assert (oldest_i == kept_o);
        if (age_o == AgeBits'(Depth - 1)) assert (oldest_q_i == kept_o);
      end
    end
  end

endmodule
