// SPDX-License-Identifier: Apache-2.0
//
// Running peak-to-peak of interleaved channels over a window of Span details, a new one every Hop.
//
//   p2p = max d - min d   over the window so far
//
// p2p only grows inside a window, so p2p > threshold is decided at the detail that crosses it, and that is
// the window's decision (early fire). `end` marks the detail that closes a window of Span details.
//   Hop = Span      tumbling: one maximum and minimum per channel
//   Hop = Span / 2  half-overlapped: those of the present half and of the half before
//   other           exact sliding window: Span - 1 delayed maxima and minima per channel
// Mask: masked details are left out of their windows; a window of only masked details has p2p 0; the others must be
// above the lowest number, as msn_haar's are. `total` travels along. Latency: 2 clocks, 3 half-overlapped,
// 1 + ceil(log4(Span)) sliding; one detail per clock.   Model: model/meissner/twins/slip/peak_to_peak.py
// Error: none.

module msn_peak_to_peak #(
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned DetailBits = 18,
  parameter  int unsigned Span       = 32,
  parameter  int unsigned Hop        = 32,
  parameter  bit          Mask       = 1'b0,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [DetailBits-1:0] in_detail_i,
  input  logic signed [DetailBits-1:0] in_total_i,
  input  logic        [IdBits-1:0]     in_id_i,
  input  logic                         in_last_i,
  input  logic                         in_restart_i,
  input  logic                         in_mask_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic        [DetailBits-1:0] out_p2p_o,
  output logic signed [DetailBits-1:0] out_total_o,
  output logic        [IdBits-1:0]     out_id_o,
  output logic                         out_last_o,
  output logic                         out_restart_o,
  output logic                         out_mask_o,
  output logic                         out_end_o,

  output logic                         busy_o         // a detail is under way, or offered
);

  if (Channels < 1 || Channels > 4096) begin : gen_check_channels
    $fatal(1, "msn_peak_to_peak: Channels = %0d must lie in 1 .. 4096", Channels);
  end
  if (Span < 2 || !msn_pkg::is_power(Span)) begin : gen_check_span
    $fatal(1, "msn_peak_to_peak: Span = %0d details must be a power of two, 2 or more", Span);
  end
  if (Hop < 1 || Hop > Span) begin : gen_check_hop
    $fatal(1, "msn_peak_to_peak: Hop = %0d details must lie in 1 .. Span", Hop);
  end

  // The first window closes at detail Span-1, then one every Hop.
  logic closes, accept;
  assign accept = in_valid_i && in_ready_o;
  // The window's maximum and minimum, then their difference. All stages advance together, so that a stall
  // passes one gate instead of one per stage.
  assign in_ready_o = out_ready_i || !out_valid_o;
  localparam int unsigned SideBits = DetailBits + IdBits + 2;
  logic                         window_valid, window_last, window_restart, stages_busy;
  assign busy_o = stages_busy || out_valid_o;
  logic signed [DetailBits-1:0] window_high, window_low;
  logic        [SideBits-1:0]   window_side, side_in;

  // A masked detail becomes neither the maximum nor the minimum.
  localparam logic signed [DetailBits-1:0] Lowest = {1'b1, {(DetailBits - 1) {1'b0}}};
  logic                         masked;
  logic signed [DetailBits-1:0] high_in, low_in;
  assign masked  = Mask && in_mask_i;
  assign high_in = masked ? Lowest : in_detail_i;
  assign low_in  = masked ? ~Lowest : in_detail_i;
  assign side_in = {in_total_i, in_id_i, closes, masked};

  if (Hop == Span || 2 * Hop == Span) begin : gen_parts
    // The maximum restarts with each part of Hop details.
    localparam int unsigned HopBits = msn_pkg::index_width(Hop);
    logic [HopBits-1:0] place, place_q;
    logic               first, final_place;
    assign place       = in_restart_i ? '0 : place_q;
    assign first       = place == '0;
    assign final_place = place == HopBits'(Hop - 1);

    logic signed [DetailBits-1:0] old_high, old_low, new_high, new_low;
    logic higher, lower;
    msn_compare #(.Width(DetailBits)) u_higher (.a_i(high_in), .b_i(old_high), .greater_o(higher));
    msn_compare #(.Width(DetailBits)) u_lower (.a_i(old_low), .b_i(low_in), .greater_o(lower));
    assign new_high = (first || higher) ? high_in : old_high;
    assign new_low  = (first || lower) ? low_in : old_low;
    msn_delay #(.Depth(Channels), .Width(2 * DetailBits)) u_part (
      .clk_i, .rst_i,
      .step_i(accept), .in_data_i({new_high, new_low}), .out_data_o({old_high, old_low})
    );

    logic                         part_valid, part_last, part_restart;
    logic signed [DetailBits-1:0] part_high, part_low;
    logic        [SideBits-1:0]   part_side;

    always_ff @(posedge clk_i) begin
      if (in_ready_o) begin
        part_valid   <= in_valid_i;
        part_high    <= new_high;
        part_low     <= new_low;
        part_side    <= side_in;
        part_last    <= in_last_i;
        part_restart <= in_restart_i;
      end
      if (accept && in_last_i) place_q <= final_place ? '0 : place + 1'b1;
      if (rst_i) part_valid <= 1'b0;
    end

    if (Hop == Span) begin : gen_tumbling
      assign closes         = final_place;
      assign stages_busy    = part_valid;
      assign window_valid   = part_valid;
      assign window_high    = part_high;
      assign window_low     = part_low;
      assign window_side    = part_side;
      assign window_last    = part_last;
      assign window_restart = part_restart;

    end else begin : gen_half
      // Joined with the part before, once there is one: its extremes are kept from when the present part began.
      logic later, later_q;
      assign later  = later_q && !in_restart_i;
      assign closes = later && final_place;
      assign stages_busy = part_valid || window_valid;
      logic signed [DetailBits-1:0] kept_high, kept_low, before_high, before_low, half_high, half_low;
      logic                         half_exists;
      assign before_high = first ? old_high : kept_high;
      assign before_low  = first ? old_low : kept_low;
      msn_delay #(.Depth(Channels), .Width(2 * DetailBits)) u_before (
        .clk_i, .rst_i,
        .step_i(accept), .in_data_i({before_high, before_low}), .out_data_o({kept_high, kept_low})
      );

      logic half_higher, half_lower;
      msn_compare #(.Width(DetailBits)) u_half_higher (
        .a_i(half_high), .b_i(part_high), .greater_o(half_higher)
      );
      msn_compare #(.Width(DetailBits)) u_half_lower (
        .a_i(part_low), .b_i(half_low), .greater_o(half_lower)
      );

      always_ff @(posedge clk_i) begin
        if (accept && in_last_i) later_q <= later || final_place;
        if (in_ready_o) begin
          half_high   <= before_high;
          half_low    <= before_low;
          half_exists <= later;
          window_valid   <= part_valid;
          window_high    <= (half_exists && half_higher) ? half_high : part_high;
          window_low     <= (half_exists && half_lower) ? half_low : part_low;
          window_side    <= part_side;
          window_last    <= part_last;
          window_restart <= part_restart;
        end
        if (rst_i) window_valid <= 1'b0;
      end
    end

  end else begin : gen_sliding
    // Span = 2^K: K/2 stages that quadruple the window, after one that doubles it if K is odd.
    localparam int unsigned SpanBits = $clog2(Span);
    localparam int unsigned Stages   = (SpanBits + 1) / 2;
    localparam int unsigned Odd      = SpanBits % 2;

    // Details to come until a window closes: Span - 1 at the first of all, Hop - 1 after each window's end.
    logic [SpanBits-1:0] left, left_next;
    logic                closes_q;  // left is 0, computed a detail ahead
    assign closes    = !in_restart_i && closes_q;
    assign left_next = in_restart_i ? SpanBits'(Span - 2) : closes_q ? SpanBits'(Hop - 1) : left - 1'b1;
    always_ff @(posedge clk_i) begin
      if (accept && in_last_i) begin
        left     <= left_next;
        closes_q <= in_restart_i ? Span == 2 : closes_q ? Hop == 1 : left == SpanBits'(1);
      end
    end

    // Between the stages; flat, because Yosys loses packed arrays that are declared in a generate block.
    logic [Stages:0]                  valid, last, restart;
    logic [(Stages+1)*DetailBits-1:0] high, low;
    logic [(Stages+1)*SideBits-1:0]   side;
    assign valid[0]      = in_valid_i;
    assign high[DetailBits-1:0] = high_in;
    assign low[DetailBits-1:0]  = low_in;
    assign side[SideBits-1:0]   = side_in;
    assign last[0]       = in_last_i;
    assign restart[0]    = in_restart_i;

    for (genvar s = 0; s < Stages; s++) begin : gen_stage
      logic unused_ready;  // a stage is offered a detail only when all stages advance
      msn_sliding_extremes #(
        .Channels(Channels), .DetailBits(DetailBits), .Lag((s == 0) ? 1 : 4 ** s / (Odd + 1)),
        .Taps((s == 0 && Odd == 1) ? 2 : 4), .SideBits(SideBits)
      ) u_extremes (
        .clk_i, .rst_i,
        .in_valid_i(valid[s] && in_ready_o), .in_ready_o(unused_ready),
        .in_high_i(signed'(high[s*DetailBits+:DetailBits])),
        .in_low_i(signed'(low[s*DetailBits+:DetailBits])), .in_side_i(side[s*SideBits+:SideBits]),
        .in_last_i(last[s]), .in_restart_i(restart[s]),
        .out_valid_o(valid[s+1]), .out_ready_i(in_ready_o), .out_high_o(high[(s+1)*DetailBits+:DetailBits]),
        .out_low_o(low[(s+1)*DetailBits+:DetailBits]), .out_side_o(side[(s+1)*SideBits+:SideBits]),
        .out_last_o(last[s+1]), .out_restart_o(restart[s+1])
      );
    end

    assign window_valid   = valid[Stages];
    assign stages_busy    = |valid[Stages:1];
    assign window_high    = signed'(high[Stages*DetailBits+:DetailBits]);
    assign window_low     = signed'(low[Stages*DetailBits+:DetailBits]);
    assign window_side    = side[Stages*SideBits+:SideBits];
    assign window_last    = last[Stages];
    assign window_restart = restart[Stages];
  end

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      out_valid_o                         <= window_valid;
      // The difference is never negative.
      out_p2p_o     <= Mask && window_high == Lowest ? '0 : window_high - window_low;
      out_last_o    <= window_last;
      out_restart_o <= window_restart;
      {out_total_o, out_id_o, out_end_o, out_mask_o} <= window_side;
    end
    if (rst_i) out_valid_o <= 1'b0;
  end

endmodule
