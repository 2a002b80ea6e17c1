// SPDX-License-Identifier: Apache-2.0
//
// Maximum and minimum over Taps values that lie Lag frames apart, of interleaved channels.
//
//   out_high(t) = max in_high(t - j Lag),  out_low(t) = min in_low(t - j Lag),  j = 0 .. Taps-1
//
// A chain of these, each with the span of all before it as Lag, is an exact sliding window: 2 x 4 x 4 = 32.
// Values from before the last `restart` are ignored. Latency 1 clock, one value per clock.
// Error: none.
// Model: model/meissner/twins/slip/peak_to_peak.py

module msn_sliding_extremes #(
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned DetailBits = 18,
  parameter  int unsigned Lag        = 1,
  parameter  int unsigned Taps       = 4,
  parameter  int unsigned SideBits   = 1,  // payload that only travels along
  localparam int unsigned CountBits  = msn_pkg::index_width(Taps / 2 * Lag + 1)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [DetailBits-1:0] in_high_i,
  input  logic signed [DetailBits-1:0] in_low_i,
  input  logic        [SideBits-1:0]   in_side_i,
  input  logic                         in_last_i,
  input  logic                         in_restart_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [DetailBits-1:0] out_high_o,
  output logic signed [DetailBits-1:0] out_low_o,
  output logic        [SideBits-1:0]   out_side_o,
  output logic                         out_last_o,
  output logic                         out_restart_o
);

  if (Taps != 2 && Taps != 4) begin : gen_check_taps
    $fatal(1, "msn_sliding_extremes: Taps = %0d must be 2 or 4", Taps);
  end
  if (Lag < 1) begin : gen_check_lag
    $fatal(1, "msn_sliding_extremes: Lag = %0d must be at least 1", Lag);
  end
  if (SideBits < 1) begin : gen_check_side_bits
    $fatal(1, "msn_sliding_extremes: SideBits = %0d must be at least 1", SideBits);
  end

  logic accept;
  assign in_ready_o = out_ready_i || !out_valid_o;
  assign accept     = in_valid_i && in_ready_o;

  // Frames since the restart, up to the oldest that a stored value reaches.
  localparam logic [CountBits-1:0] Oldest = CountBits'(Taps / 2 * Lag);
  logic [CountBits-1:0] frames, frames_q, frames_next;
  assign frames      = in_restart_i ? '0 : frames_q;
  assign frames_next = (frames == Oldest) ? Oldest : frames + 1'b1;

  // Values are joined in these places: 0: tap 0 and all older ones; 1: taps 0 and 1, which 2 Lag frames later are taps
  // 2 and 3; 2: those three, for the next step, as channels come in order and so its taps are known a step ahead.
  localparam int unsigned Joins = (Taps == 4) ? 3 : 1;
  logic                             near, far;  // taps 1, and 2 and 3, count; `far` for the next step
  logic [Joins-1:0][DetailBits-1:0] new_high, new_low, old_high, old_low, high, low;
  for (genvar j = 0; j < Joins; j++) begin : gen_join
    logic                         higher, lower;
    logic signed [DetailBits-1:0] old_top, new_top, old_bottom, new_bottom;
    assign {old_top, new_top, old_bottom, new_bottom} = {old_high[j], new_high[j], old_low[j], new_low[j]};
    msn_compare #(.Width(DetailBits)) u_higher (.a_i(old_top), .b_i(new_top), .greater_o(higher));
    msn_compare #(.Width(DetailBits)) u_lower (.a_i(new_bottom), .b_i(old_bottom), .greater_o(lower));
    assign high[j] = ((j == 2 ? far : near) && higher) ? old_top : new_top;
    assign low[j]  = ((j == 2 ? far : near) && lower) ? old_bottom : new_bottom;
  end
  assign near = frames >= CountBits'(Lag);
  assign far  = (in_last_i ? frames_next : frames) == Oldest;  // unless a restart comes
  assign {new_high[0], new_low[0]} = {in_high_i, in_low_i};

  // Tap 1 of the next step.
  logic [DetailBits-1:0] high_next, low_next;
  if (Channels * Lag == 1) begin : gen_now
    assign {high_next, low_next} = {in_high_i, in_low_i};
  end else begin : gen_lag
    msn_delay #(.Depth(Channels * Lag - 1), .Width(2 * DetailBits)) u_lag (
      .clk_i, .rst_i,
      .step_i(accept), .in_data_i({in_high_i, in_low_i}), .out_data_o({high_next, low_next})
    );
  end

  if (Taps == 4) begin : gen_four
    assign {new_high[1], new_low[1]} = {in_high_i, in_low_i};
    always_ff @(posedge clk_i) if (accept) {old_high[1], old_low[1]} <= {high_next, low_next};

    assign {new_high[2], new_low[2]} = {high_next, low_next};
    msn_delay #(.Depth(2 * Channels * Lag - 1), .Width(2 * DetailBits)) u_pairs (
      .clk_i, .rst_i,
      .step_i(accept), .in_data_i({high[1], low[1]}), .out_data_o({old_high[2], old_low[2]})
    );
    always_ff @(posedge clk_i) if (accept) {old_high[0], old_low[0]} <= {high[2], low[2]};
  end else begin : gen_two
    always_ff @(posedge clk_i) if (accept) {old_high[0], old_low[0]} <= {high_next, low_next};
  end

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      out_valid_o   <= in_valid_i;
      out_high_o    <= signed'(high[0]);
      out_low_o     <= signed'(low[0]);
      out_side_o    <= in_side_i;
      out_last_o    <= in_last_i;
      out_restart_o <= in_restart_i;
    end
    if (accept && in_last_i) frames_q <= frames_next;
    if (rst_i) out_valid_o <= 1'b0;
  end

endmodule
