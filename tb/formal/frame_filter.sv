// SPDX-License-Identifier: Apache-2.0
//
// The samples that pass count 0 .. Channels-1 without a gap, each unchanged a clock later; no sample of a frame passes
// from the first one out of place on; the next frame, and the first since reset, have `restart` on each sample; a
// damaged frame is counted once, with its last sample. The slip path's proofs assume this of their frames.

module formal_frame_filter #(
  parameter  int unsigned Channels = 8,
  parameter  int unsigned DataBits = 17,
  localparam int unsigned IdBits   = msn_pkg::index_width(Channels)
) (
  input logic                clk_i,
  input logic                rst_i,
  input logic                in_valid_i,
  input logic [DataBits-1:0] in_data_i,
  input logic [IdBits-1:0]   in_id_i,
  input logic                in_last_i,
  input logic                out_ready_i
);

  logic                in_ready_o, out_valid_o, out_last_o, out_restart_o;
  logic [DataBits-1:0] out_data_o;
  logic [IdBits-1:0]   out_id_o;
  logic [31:0]         damaged_o;
  msn_frame_filter #(.Channels(Channels), .DataBits(DataBits)) dut (.*);

  logic                started = 1'b0;
  logic                take, give, stalled;
  logic [16:0]         seen;      // samples of the incoming frame
  logic                broken, right, after_damage, damage;
  logic                due, due_last;
  logic [DataBits-1:0] due_data;
  logic [IdBits-1:0]   due_id;
  logic [31:0]         damages;
  assign take  = in_valid_i && in_ready_o;
  assign give  = out_valid_o && out_ready_i;
  assign right = 17'(in_id_i) == seen && in_last_i == (seen == 17'(Channels - 1));
  // At the output: the sample expected next if no damage occurs, whether it is inside a frame, its restart.
  logic [16:0] next;
  logic        fresh, marked;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    stalled <= out_valid_o && !out_ready_i && !rst_i;
    if (take) begin
      seen   <= in_last_i ? '0 : (seen == '1) ? '1 : seen + 1'b1;
      broken <= !in_last_i && (broken || !right);
      if (in_last_i) after_damage <= broken || !right;
    end
    damage <= take && in_last_i && (broken || !right);
    if (damage) damages <= damages + 1'b1;  // shown a clock later
    if (in_ready_o) begin
      due      <= take && right && !broken;
      due_data <= in_data_i;
      due_id   <= in_id_i;
      due_last <= in_last_i;
      marked   <= after_damage;
    end
    if (give) begin
      next  <= out_last_o ? '0 : 17'(out_id_o) + 1'b1;
      fresh <= out_restart_o;
    end
    if (rst_i) begin
      seen         <= '0;
      broken       <= 1'b0;
      after_damage <= 1'b1;
      due          <= 1'b0;
      damages      <= '0;
      damage       <= 1'b0;
      next         <= '0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert (out_valid_o == due && damaged_o == damages);
      if (!rst_i) assert (in_ready_o == (out_ready_i || !due));
      if (due) assert (out_data_o == due_data && out_id_o == due_id && out_last_o == due_last && out_restart_o == marked);
      if (stalled) assert (out_valid_o);
      // what the consumer sees
      if (out_valid_o) begin
        assert (32'(out_id_o) < Channels && out_last_o == (32'(out_id_o) == Channels - 1));
        assert (out_id_o == '0 || 17'(out_id_o) == next && out_restart_o == fresh);
        if (next != '0 && out_id_o == '0) assert (out_restart_o);
      end
    end
  end

  // Invariant.
  always_comb begin
    if (started) begin
      assert (dut.dropping == broken && dut.restart == after_damage && dut.damage == damage);
      if (!broken) assert (17'(dut.expected) == seen && seen < 17'(Channels));
      if (due) assert (broken || after_damage || !due_last || seen == '0);
      if (due && !broken) assert (due_last ? seen == '0 && !after_damage
                                  : (17'(due_id) + 1'b1 == seen && marked == after_damage));
      if (!due && !broken && seen != '0) assert (next == seen && fresh == after_damage);
      if (!due && !broken && seen == '0) assert (next == '0 || after_damage);
      if (due && due_id != '0) assert (next == 17'(due_id) && fresh == marked);
      if (due && due_id == '0) assert (next == '0 || marked);
      assert (next < 17'(Channels));
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (give && out_restart_o && damaged_o == 32'd1);
      cover (give && out_id_o == IdBits'(Channels > 3 ? 3 : 0) && stalled);
      cover (take && broken && in_last_i);
    end
  end

endmodule
