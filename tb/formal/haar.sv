// SPDX-License-Identifier: Apache-2.0
//
// Level 1, as in all shipped configurations. For the samples x0, x1 of a channel's group: a + d = 2 x0, a - d = 2 x1;
// d of equal samples is 0; masked, both are 0. One result per group, in the clock after x1 is taken.

`include "owed_ports.svh"

module formal_haar #(
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Level      = 1,
  parameter  bit          Mask       = 1'b0,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels),
  localparam int unsigned DetailBits = SampleBits + Level,
  localparam int unsigned Width      = SampleBits + 32'(Mask)
) (
  input logic                         clk_i,
  input logic                         rst_i,
  input logic [IdBits-1:0]            watch_i,
  input logic                         in_valid_i,
  input logic signed [SampleBits-1:0] in_data_i,
  input logic [IdBits-1:0]            in_id_i,
  input logic                         in_last_i,
  input logic                         in_restart_i,
  input logic                         in_mask_i,
  input logic                         out_ready_i
);

  logic                         in_ready_o, out_valid_o, out_last_o, out_restart_o, out_mask_o, busy_o;
  logic signed [DetailBits-1:0] out_detail_o, out_total_o;
  logic [IdBits-1:0]            out_id_o;
  msn_haar #(.Channels(Channels), .SampleBits(SampleBits), .Level(Level), .Mask(Mask)) dut (.*);

  logic              accept, started, first, again, watched;
  logic [IdBits-1:0] at;
  assign accept = in_valid_i && in_ready_o;
  owed_frames #(.Channels(Channels)) u_frames (
    .clk_i, .rst_i, .watch_i, .accept_i(accept), .in_valid_i, .in_id_i, .in_last_i, .in_restart_i,
    .started_o(started), .at_o(at), .first_o(first), .again_o(again), .watched_o(watched)
  );

  // The present frame is the second of its group; the group's first sample, mask, and whether it began with restart.
  logic                         second_q, second, mask0, renewed, renewed_q;
  logic signed [SampleBits-1:0] x0;
  logic                         due, due_mask, due_last, due_restart, stalled;
  logic [IdBits-1:0]            due_id;
  logic signed [SampleBits-1:0] due_x0, due_x1;
  assign second = second_q && !in_restart_i;
  always_ff @(posedge clk_i) begin
    stalled <= out_valid_o && !out_ready_i && !rst_i;
    if (accept && in_last_i) second_q <= !second;
    if (accept && !second) renewed <= in_restart_i;
    if (watched && !second) begin
      x0    <= in_data_i;
      mask0 <= Mask && in_mask_i;
    end
    if (in_ready_o) begin
      due         <= accept && second;
      due_id      <= at;
      due_last    <= in_last_i;
      due_restart <= renewed;
      due_x0      <= x0;
      due_x1      <= in_data_i;
      due_mask    <= mask0 || (Mask && in_mask_i);
    end
    if (rst_i) begin
      second_q <= 1'b0;
      due      <= 1'b0;
    end
  end

  logic signed [DetailBits:0] twice_x0, twice_x1;
  assign twice_x0 = (DetailBits + 1)'(due_x0) <<< 1;
  assign twice_x1 = (DetailBits + 1)'(due_x1) <<< 1;
  always_comb begin
    if (started) begin
      assert (out_valid_o == due && busy_o == due);
      if (!rst_i) assert (in_ready_o == (out_ready_i || !out_valid_o));
      if (stalled) assert (out_valid_o);
      if (out_valid_o) assert (out_id_o == due_id && out_last_o == due_last && out_restart_o == due_restart);
      if (out_valid_o && out_id_o == watch_i) begin
        assert (out_mask_o == due_mask);
        if (due_mask) assert (out_detail_o == '0 && out_total_o == '0);
        else begin
          assert ((DetailBits + 1)'(out_total_o) + (DetailBits + 1)'(out_detail_o) == twice_x0);
          assert ((DetailBits + 1)'(out_total_o) - (DetailBits + 1)'(out_detail_o) == twice_x1);
          if (due_x0 == due_x1) assert (out_detail_o == '0);
        end
      end
    end
  end

  // Invariant: the watched sample's way through the delay line.
  localparam int unsigned AgeBits = $clog2(Channels + 2);
  logic [msn_pkg::index_width(Channels > 4 ? Channels - 3 : 1)-1:0] slot;
  logic [AgeBits-1:0]            age;
  logic [Width-1:0]              kept;
  logic                          frame_second;
  assign frame_second = second_q && !(again && at != '0);
  if (Mask && Channels > 4) begin : gen_masked_ring
    owed_delay #(.Depth(Channels), .Width(Width)) u_owed (
      .clk_i, .rst_i, .step_i(accept), .catch_i(at == watch_i && !second), .in_data_i({in_mask_i, in_data_i}),
      .out_data_i(dut.gen_level[0].gen_masked.u_even.out_data_o), `OWED_RING(dut.gen_level[0].gen_masked.u_even), .slot_o(slot),
      .age_o(age), .kept_o(kept)
    );
  end else if (Mask) begin : gen_masked_line
    owed_delay #(.Depth(Channels), .Width(Width)) u_owed (
      .clk_i, .rst_i, .step_i(accept), .catch_i(at == watch_i && !second), .in_data_i({in_mask_i, in_data_i}),
      .out_data_i(dut.gen_level[0].gen_masked.u_even.out_data_o), `OWED_LINE(dut.gen_level[0].gen_masked.u_even), .slot_o(slot),
      .age_o(age), .kept_o(kept)
    );
  end else if (Channels > 4) begin : gen_ring
    owed_delay #(.Depth(Channels), .Width(Width)) u_owed (
      .clk_i, .rst_i, .step_i(accept), .catch_i(at == watch_i && !second), .in_data_i(in_data_i[SampleBits-1:0]),
      .out_data_i(dut.gen_level[0].gen_plain.u_even.out_data_o), `OWED_RING(dut.gen_level[0].gen_plain.u_even), .slot_o(slot),
      .age_o(age), .kept_o(kept)
    );
  end else begin : gen_line
    owed_delay #(.Depth(Channels), .Width(Width)) u_owed (
      .clk_i, .rst_i, .step_i(accept), .catch_i(at == watch_i && !second), .in_data_i(in_data_i[SampleBits-1:0]),
      .out_data_i(dut.gen_level[0].gen_plain.u_even.out_data_o), `OWED_LINE(dut.gen_level[0].gen_plain.u_even), .slot_o(slot),
      .age_o(age), .kept_o(kept)
    );
  end
  always_comb begin
    if (started) begin
      assert (dut.gen_level[0].odd_q == second_q);
      if (frame_second || (at != '0 && at > watch_i)) assert (dut.gen_level[0].restart_q == renewed);
      if (at != '0 && !frame_second) assert (dut.gen_level[0].restart_q == renewed);
      if (age != '0) begin
        assert (32'(age) == ((at > watch_i) ? 32'(at) - 32'(watch_i) : Channels + 32'(at) - 32'(watch_i)));
        assert (kept[SampleBits-1:0] == x0);
        if (Mask) assert (kept[Width-1] == mask0);
        else assert (!mask0);
      end
      if ((frame_second && at <= watch_i) || (!frame_second && at > watch_i)) assert (age != '0);
      if (out_valid_o) assert (dut.out_id_o == due_id);
    end
  end

  // With many channels the second sample of a channel is far from reset.
  always_comb begin
    if (started && !rst_i) begin
      if (Channels < 16) cover (out_valid_o && out_id_o == watch_i && out_detail_o == '1 && !due_mask);
      if (Channels < 16) cover (stalled && out_valid_o && out_restart_o);
      if (Channels < 16 && Mask) cover (out_valid_o && out_mask_o && out_id_o == watch_i);
      cover (watched && age == '0);
    end
  end

endmodule
