// SPDX-License-Identifier: Apache-2.0
//
// A beat passes unchanged, with its place, while its frame has no damage. A block that counts the beats that pass
// finds Beats of them, 0 .. Beats-1, in a frame if and only if its `last` fits, and one frame for each that came in.
// Each damaged frame is counted once.

module formal_frame_marker #(
  parameter  int unsigned Rows     = 64,
  parameter  int unsigned RowBeats = 64,
  localparam int unsigned Beats    = Rows * RowBeats,
  localparam int unsigned IdBits   = msn_pkg::index_width(Beats)
) (
  input logic              clk_i,
  input logic              rst_i,
  input logic              in_valid_i,
  input logic [IdBits-1:0] in_id_i,
  input logic              in_last_i,
  input logic              out_ready_i
);

  logic              in_ready_o, out_valid_o, out_fits_o, out_row_last_o, out_last_o;
  logic [IdBits-1:0] out_id_o;
  logic [31:0]       damaged_o;
  msn_frame_marker #(.Rows(Rows), .RowBeats(RowBeats)) dut (.*);

  // Input: right beats of the frame so far; the frame is broken; its final beat was reached without `last`.
  logic            started = 1'b0;
  logic            take, final_beat, right, broken, too_long, damage;
  logic [IdBits:0] seen;
  logic [31:0]     damages;
  assign take       = in_valid_i && out_ready_i;
  assign final_beat = seen == (IdBits + 1)'(Beats - 1);
  assign right      = final_beat ? in_last_i : (!in_last_i && {1'b0, in_id_i} == seen);
  // Output: beats of the frame that leaves, and whether it has ended while its beats still arrive.
  logic            give, ended;
  logic [IdBits:0] count;
  assign give = out_valid_o && out_ready_i;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    if (take) begin
      seen   <= (in_last_i || broken || !right) ? '0 : seen + 1'b1;
      broken <= !in_last_i && (broken || !right);
      if (!broken) too_long <= final_beat && !in_last_i;
      ended  <= !in_last_i && (ended || (out_valid_o && out_last_o));
    end
    damage <= take && !broken && !right;
    if (damage) damages <= damages + 1'b1;  // shown a clock later
    if (give) count <= out_last_o ? '0 : count + 1'b1;
    if (rst_i) begin
      seen    <= '0;
      broken  <= 1'b0;
      ended   <= 1'b0;
      damage  <= 1'b0;
      damages <= '0;
      count   <= '0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert (in_ready_o == out_ready_i && damaged_o == damages);
      assert (out_fits_o == (right && !broken));
      if (!broken) assert (out_valid_o == in_valid_i && out_last_o == (in_last_i || (!right && !final_beat)));
      else assert (out_valid_o == (in_valid_i && in_last_i && too_long));
      // what the consumer sees
      if (out_valid_o) begin
        assert (32'(count) <= Beats && (out_last_o || 32'(count) < Beats));
        if (out_last_o) assert (out_fits_o == (32'(count) == Beats - 1));
        else assert (out_fits_o || 32'(count) == Beats - 1);
        if (32'(count) < Beats) assert ({1'b0, out_id_o} == count);
        if (32'(count) < Beats) assert (out_row_last_o == (32'(count) % RowBeats == RowBeats - 1));
      end
      if (in_valid_i && in_last_i) assert (ended != (out_valid_o && out_last_o));
      if (ended) assert (!out_valid_o);
    end
  end

  // Invariant.
  always_comb begin
    if (started) begin
      assert (dut.dropping == broken && dut.damage == damage && 32'(out_id_o) < Beats);
      assert (32'(dut.column) == 32'(out_id_o) % RowBeats);
      assert (32'(seen) < Beats && (broken ? seen == '0 : {1'b0, out_id_o} == seen));
      if (broken) assert (dut.closed == !too_long);
      assert (ended == (broken && !too_long));
      assert (count == (!broken ? seen : (IdBits + 1)'(too_long ? Beats : 0)));
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (give && out_fits_o && 32'(out_id_o) == (Beats > 3 ? 3 : Beats - 1) && damaged_o == 32'd2);
      cover (take && in_last_i && broken);
      cover (Beats > 16 || (give && too_long && broken));
      cover (Beats > 16 || (give && out_last_o && out_fits_o && damaged_o == 32'd1));
    end
  end

endmodule
