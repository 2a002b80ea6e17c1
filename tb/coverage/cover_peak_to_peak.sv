// Cover points of msn_peak_to_peak: in windows of one channel, whose length decides the kind, an increase of p2p at
// every place, upwards and downwards; a beat stalled, ended, restarted and masked in each kind of window; and every
// pair of kind, masks, and one or several channels.
module cover_peak_to_peak #(
  parameter int unsigned Channels   = 1,
  parameter int unsigned DetailBits = 18,
  parameter int unsigned Span       = 32,
  parameter int unsigned Hop        = 32,
  parameter bit          Mask       = 1'b0
) (
  input logic                         clk_i,
  input logic                         rst_i,
  input logic                         in_valid_i,
  input logic                         in_ready_o,
  input logic signed [DetailBits-1:0] in_detail_i,
  input logic                         in_restart_i,
  input logic                         masked,
  input logic                         accept,
  input logic                         closes,
  input logic                         out_valid_o,
  input logic                         out_ready_i,
  input logic        [DetailBits-1:0] out_p2p_o,
  input logic                         out_mask_o,
  input logic                         out_end_o
);
  // 0 tumbling, 1 half-overlapped, 2 sliding by one, 3 sliding by more.
  localparam int unsigned Kind = (Hop == Span) ? 0 : (2 * Hop == Span) ? 1 : (Hop == 1) ? 2 : 3;
  logic given;
  assign given = !rst_i && out_valid_o && out_ready_i;

  // Place since the last window closed, and the extremes since; whether a window has closed since a restart.
  int   place;
  logic filled;
  logic signed [DetailBits-1:0] high, low;
  logic                         begins;
  always_ff @(posedge clk_i) begin
    if (accept) begin
      begins <= closes;
      filled <= closes || filled && !in_restart_i;
      place  <= closes ? 0 : in_restart_i ? 1 : place + 1;
      high   <= (begins || in_restart_i || in_detail_i > high) ? in_detail_i : high;
      low    <= (begins || in_restart_i || in_detail_i < low) ? in_detail_i : low;
    end
    if (rst_i) begin
      begins <= 1'b1;
      filled <= 1'b0;
      place  <= 0;
    end
  end
  for (genvar k = 1; k < 32; k++) begin : gen_place
    logic here;
    assign here = !rst_i && accept && !in_restart_i && Channels == 1 && Kind == 0 && Span == 32 && place == k;
    `BIN(up, here && in_detail_i > high)
    `BIN(down, here && in_detail_i < low)
  end

  for (genvar kind = 0; kind <= 3; kind++) begin : gen_kind
    logic here;
    assign here = !rst_i && Kind == kind;
    for (genvar full = 0; full <= 1; full++) begin : gen_full
      logic now;
      assign now = here && in_valid_i && filled == (full == 1);
      `BIN(held, now && !in_ready_o)
      `BIN(restarted, now && in_ready_o && in_restart_i)
    end
    `BIN(held_end, here && out_valid_o && out_end_o && !out_ready_i)
    `BIN(ended, given && Kind == kind && out_end_o)
    `BIN(widest, given && Kind == kind && &out_p2p_o)
    `BIN(nothing, given && Kind == kind && out_p2p_o == 0)
    `BIN(masked_end, given && Kind == kind && out_end_o && out_mask_o)
    `BIN(all_masked, given && Kind == kind && out_end_o && out_mask_o && out_p2p_o == 0)
    `BIN(masked_close, here && accept && masked && closes)
    for (genvar bits = 0; bits <= 1; bits++) begin : gen_pair
      `BIN(masks, given && Kind == kind && Mask == (bits == 1))
      `BIN(many, given && Kind == kind && (Channels > 1) == (bits == 1))
      for (genvar m = 0; m <= 1; m++) begin : gen_other
        `BIN(masks_many, given && Mask == (bits == 1) && (Channels > 1) == (m == 1))
      end
    end
  end
endmodule

bind msn_peak_to_peak cover_peak_to_peak #(
  .Channels(Channels), .DetailBits(DetailBits), .Span(Span), .Hop(Hop), .Mask(Mask)
) u_cover (.*);
