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
  localparam int unsigned CountBits  = msn_pkg::index_width((Taps - 1) * Lag + 1)
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

  // Frames since the restart, up to the oldest that a tap reaches.
  localparam logic [CountBits-1:0] Oldest = CountBits'((Taps - 1) * Lag);
  logic [CountBits-1:0] frames, frames_q;
  assign frames = in_restart_i ? '0 : frames_q;

  logic signed [Taps-1:0][DetailBits-1:0] high, low;  // tap j is j Lag frames old
  logic        [Taps-1:1]                 exists;
  assign high[0] = in_high_i;
  assign low[0]  = in_low_i;
  for (genvar j = 1; j < Taps; j++) begin : gen_tap
    msn_delay #(.Depth(Channels * Lag), .Width(2 * DetailBits)) u_lag (
      .clk_i, .rst_i,
      .step_i(accept), .in_data_i({high[j-1], low[j-1]}), .out_data_o({high[j], low[j]})
    );
    assign exists[j] = frames >= CountBits'(j * Lag);
  end

  // Compare taps in pairs, then the pairs. A tap is valid only if all newer taps are.
  logic [Taps/2-1:0][DetailBits-1:0] high_pair, low_pair;
  for (genvar p = 0; p < Taps / 2; p++) begin : gen_pair
    logic higher, lower;
    msn_compare #(.Width(DetailBits)) u_higher (
      .a_i(signed'(high[2*p+1])), .b_i(signed'(high[2*p])), .greater_o(higher)
    );
    msn_compare #(.Width(DetailBits)) u_lower (
      .a_i(signed'(low[2*p])), .b_i(signed'(low[2*p+1])), .greater_o(lower)
    );
    assign high_pair[p] = (exists[2*p+1] && higher) ? high[2*p+1] : high[2*p];
    assign low_pair[p]  = (exists[2*p+1] && lower) ? low[2*p+1] : low[2*p];
  end

  logic [DetailBits-1:0] highest, lowest;
  if (Taps == 4) begin : gen_four
    logic higher, lower;
    msn_compare #(.Width(DetailBits)) u_higher (
      .a_i(signed'(high_pair[1])), .b_i(signed'(high_pair[0])), .greater_o(higher)
    );
    msn_compare #(.Width(DetailBits)) u_lower (
      .a_i(signed'(low_pair[0])), .b_i(signed'(low_pair[1])), .greater_o(lower)
    );
    assign highest = (exists[2] && higher) ? high_pair[1] : high_pair[0];
    assign lowest  = (exists[2] && lower) ? low_pair[1] : low_pair[0];
  end else begin : gen_two
    assign highest = high_pair[0];
    assign lowest  = low_pair[0];
  end

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      out_valid_o   <= in_valid_i;
      out_high_o    <= signed'(highest);
      out_low_o     <= signed'(lowest);
      out_side_o    <= in_side_i;
      out_last_o    <= in_last_i;
      out_restart_o <= in_restart_i;
    end
    if (accept && in_last_i) frames_q <= (frames == Oldest) ? Oldest : frames + 1'b1;
    if (rst_i) out_valid_o <= 1'b0;
  end

endmodule
