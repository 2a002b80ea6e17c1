// SPDX-License-Identifier: Apache-2.0
//
// Tumbling windows, as in all shipped configurations. For any channel: p2p is the largest minus the smallest detail of
// the window so far and never falls within a window; for any threshold, p2p is above it at the window's end if and only
// if it ever was: the early decision is the window's decision. Masked details are ignored.

`include "owed_ports.svh"

module formal_peak_to_peak #(
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned DetailBits = 18,
  parameter  int unsigned Span       = 32,
  parameter  int unsigned Hop        = 32,
  parameter  bit          Mask       = 1'b0,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input logic                         clk_i,
  input logic                         rst_i,
  input logic [IdBits-1:0]            watch_i,
  input logic [DetailBits-1:0]        threshold_i,
  input logic                         in_valid_i,
  input logic signed [DetailBits-1:0] in_detail_i,
  input logic signed [DetailBits-1:0] in_total_i,
  input logic [IdBits-1:0]            in_id_i,
  input logic                         in_last_i,
  input logic                         in_restart_i,
  input logic                         in_mask_i,
  input logic                         out_ready_i
);

  logic                         in_ready_o, out_valid_o, out_last_o, out_restart_o, out_mask_o, out_end_o, busy_o;
  logic [DetailBits-1:0]        out_p2p_o;
  logic signed [DetailBits-1:0] out_total_o;
  logic [IdBits-1:0]            out_id_o;
  msn_peak_to_peak #(
    .Channels(Channels), .DetailBits(DetailBits), .Span(Span), .Hop(Hop), .Mask(Mask)
  ) dut (.*);

  logic              accept, started, first, again, watched;
  logic [IdBits-1:0] at;
  assign accept = in_valid_i && in_ready_o;
  owed_frames #(.Channels(Channels)) u_frames (
    .clk_i, .rst_i, .watch_i, .accept_i(accept), .in_valid_i, .in_id_i, .in_last_i, .in_restart_i,
    .started_o(started), .at_o(at), .first_o(first), .again_o(again), .watched_o(watched)
  );

  localparam logic signed [DetailBits-1:0] Lowest = {1'b1, {(DetailBits - 1) {1'b0}}};
  localparam int unsigned SpanBits = $clog2(Span);

  // The window: frames in it before this one; for the watched channel, its result so far.
  logic [SpanBits-1:0]          place_q, place;
  logic                         any_q, any, fired_q, fired, full_q, masked;
  logic signed [DetailBits-1:0] high_q, low_q, high, low;
  logic [DetailBits-1:0]        threshold, p2p_q, p2p;
  assign place  = in_restart_i ? '0 : place_q;
  assign masked = Mask && in_mask_i;
  assign any    = !masked || (place != '0 && any_q);
  assign high   = (!masked && (place == '0 || !any_q || in_detail_i > high_q)) ? in_detail_i : high_q;
  assign low    = (!masked && (place == '0 || !any_q || in_detail_i < low_q)) ? in_detail_i : low_q;
  assign p2p_q  = any_q ? high_q - low_q : '0;
  assign p2p    = any ? high - low : '0;
  assign fired  = (place != '0 && fired_q) || p2p > threshold_i;
  always_ff @(posedge clk_i) begin
    threshold <= threshold_i;
    if (accept && in_last_i) begin
      place_q <= place + 1'b1;
      full_q  <= (full_q && !in_restart_i) || place == '1;
    end
    if (watched) begin
      any_q   <= any;
      high_q  <= high;
      low_q   <= low;
      fired_q <= fired;
    end
  end

  // The block's two pipeline stages.
  logic                  due1, due2, mask1, mask2, end1, end2, last1, last2, restart1, restart2, stalled;
  logic [DetailBits-1:0] p2p1, p2p2, total1, total2;
  logic [IdBits-1:0]     id1, id2;
  always_ff @(posedge clk_i) begin
    stalled <= out_valid_o && !out_ready_i && !rst_i;
    if (in_ready_o) begin
      {due2, p2p2, total2, id2, mask2, end2, last2, restart2} <=
          {due1, p2p1, total1, id1, mask1, end1, last1, restart1};
      {due1, p2p1, total1, id1, mask1, end1, last1, restart1} <=
          {accept, p2p, in_total_i, at, masked, place == '1, in_last_i, in_restart_i};
    end
    if (rst_i) {due1, due2} <= '0;
  end

  always_comb begin
    if (started) begin
      assume (threshold_i == threshold);
      if (Mask && in_valid_i && !in_mask_i) assume (in_detail_i != Lowest);  // msn_haar never gives it
      assert (out_valid_o == due2 && busy_o == (due1 || due2));
      if (!rst_i) assert (in_ready_o == (out_ready_i || !out_valid_o));
      if (stalled) assert (out_valid_o);
      if (out_valid_o) begin
        assert (out_id_o == id2 && out_last_o == last2 && out_restart_o == restart2);
        assert (out_total_o == total2 && out_mask_o == mask2 && out_end_o == end2);
        if (out_id_o == watch_i) assert (out_p2p_o == p2p2);
      end
      // never falls; early fire
      if (watched && place != '0) assert (p2p >= p2p_q);
      if (watched) assert (fired == (p2p > threshold_i));
    end
  end

  // Invariant.
  localparam int unsigned AgeBits = $clog2(Channels + 2);
  logic [msn_pkg::index_width(Channels > 4 ? Channels - 3 : 1)-1:0] slot;
  logic [AgeBits-1:0]            age;
  logic [2*DetailBits-1:0]       kept;
  if (Channels > 4) begin : gen_ring
    owed_delay #(.Depth(Channels), .Width(2 * DetailBits)) u_owed (
      .clk_i, .rst_i, .step_i(accept), .catch_i(at == watch_i),
      .in_data_i(any ? {high, low} : {Lowest, ~Lowest}), .out_data_i(dut.gen_parts.u_part.out_data_o),
      `OWED_RING(dut.gen_parts.u_part), .slot_o(slot), .age_o(age), .kept_o(kept)
    );
  end else begin : gen_line
    owed_delay #(.Depth(Channels), .Width(2 * DetailBits)) u_owed (
      .clk_i, .rst_i, .step_i(accept), .catch_i(at == watch_i),
      .in_data_i(any ? {high, low} : {Lowest, ~Lowest}), .out_data_i(dut.gen_parts.u_part.out_data_o),
      `OWED_LINE(dut.gen_parts.u_part), .slot_o(slot), .age_o(age), .kept_o(kept)
    );
  end
  always_comb begin
    if (started) begin
      if (!first) begin
        assert (dut.gen_parts.place_q == place_q);
      end
      assert ((age != '0) == (!first || at > watch_i));
      if (age != '0) begin
        assert (32'(age) == ((at > watch_i) ? 32'(at) - 32'(watch_i) : Channels + 32'(at) - 32'(watch_i)));
        assert (kept == (any_q ? {high_q, low_q} : {Lowest, ~Lowest}));
        assert (!any_q || high_q >= low_q);
        assert (fired_q == (p2p_q > threshold_i));
        if (Mask && any_q) assert (high_q != Lowest && low_q != Lowest);
        if (!Mask) assert (any_q);
      end
      assert (dut.gen_parts.part_valid == due1);
      if (due1) begin
        assert (dut.gen_parts.part_side == {total1, id1, end1, mask1});
        assert (dut.gen_parts.part_last == last1 && dut.gen_parts.part_restart == restart1);
        if (id1 == watch_i) begin
          assert (((Mask && dut.gen_parts.part_high == Lowest) ? '0
                   : dut.gen_parts.part_high - dut.gen_parts.part_low) == p2p1);
        end
      end
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      if (Channels < 16) cover (out_valid_o && id2 == watch_i && out_p2p_o == '1 && !restart2);
      if (Channels < 16) cover (watched && place == SpanBits'(2) && p2p == p2p_q && fired && any);
      cover (watched && stalled);
    end
  end

endmodule
