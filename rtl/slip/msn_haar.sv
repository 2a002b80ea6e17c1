// SPDX-License-Identifier: Apache-2.0
//
// Haar wavelet detail of interleaved channels, exact integers, level 1 to 3.
//
//   a0 = x;   d_l[k] = a_(l-1)[2k] - a_(l-1)[2k+1];   a_l[k] = a_(l-1)[2k] + a_(l-1)[2k+1]
//
// sqrt(2)^l times the orthonormal wavelet, with its sign; a level adds a bit, nothing is rounded. Frames
// enter sample by sample; every 2^Level frames a frame of details (d) and sums (a) leaves.
// `restart` begins new groups and leaves with the first details after it. Mask: a group with a masked sample
// has d = a = 0 and leaves masked.
//
// Latency Level clocks after the sample that completes a group; one sample per clock.
// Error: none.
// Model: model/meissner/twins/slip/haar.py

module msn_haar #(
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Level      = 1,
  parameter  bit          Mask       = 1'b0,  // of samples that cannot be trusted
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels),
  localparam int unsigned DetailBits = SampleBits + Level
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic        [IdBits-1:0]     in_id_i,
  input  logic                         in_last_i,
  input  logic                         in_restart_i,
  input  logic                         in_mask_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [DetailBits-1:0] out_detail_o,
  output logic signed [DetailBits-1:0] out_total_o,
  output logic        [IdBits-1:0]     out_id_o,
  output logic                         out_last_o,
  output logic                         out_restart_o,
  output logic                         out_mask_o,

  output logic                         busy_o         // a sample or a detail is under way, or offered
);

  if (Channels < 1 || Channels > 4096) begin : gen_check_channels
    $fatal(1, "msn_haar: Channels = %0d must lie in 1 .. 4096", Channels);
  end
  if (Level < 1 || Level > 3) begin : gen_check_level
    $fatal(1, "msn_haar: Level = %0d must be 1, 2 or 3", Level);
  end
  if (SampleBits < 2) begin : gen_check_sample_bits
    $fatal(1, "msn_haar: SampleBits = %0d must be at least 2", SampleBits);
  end

  // All levels advance together, so that a stall passes one gate instead of one per level.
  assign in_ready_o = out_ready_i || !out_valid_o;

  // Signals between the levels: index 0 is the input, index Level the output. All have the width of the last sum.
  logic [Level:0]                 valid, last, restart, mask;
  logic [Level:0][IdBits-1:0]     id;
  logic [Level:0][DetailBits-1:0] total;

  assign valid[0]      = in_valid_i;
  assign total[0]      = DetailBits'(in_data_i);
  assign id[0]         = in_id_i;
  assign last[0]       = in_last_i;
  assign restart[0]    = in_restart_i;
  assign mask[0]       = Mask && in_mask_i;

  assign out_valid_o   = valid[Level];
  assign busy_o        = |valid[Level:1];
  assign out_total_o   = signed'(total[Level]);
  assign out_id_o      = id[Level];
  assign out_last_o    = last[Level];
  assign out_restart_o = restart[Level];
  assign out_mask_o    = mask[Level];

  for (genvar l = 0; l < Level; l++) begin : gen_level
    localparam int unsigned Width = SampleBits + l;

    logic accept, odd, odd_q, restart_q, even_mask, masked;
    assign accept = valid[l] && in_ready_o;
    assign odd    = odd_q && !restart[l];

    // One step per sample: in an odd frame the delay line returns the even sample of the same channel.
    logic        [Width-1:0]      even_bits;
    logic signed [DetailBits-1:0] even_sample, odd_sample;
    if (Mask) begin : gen_masked
      msn_delay #(.Depth(Channels), .Width(Width + 1)) u_even (
        .clk_i, .rst_i,
        .step_i(accept), .in_data_i({mask[l], total[l][Width-1:0]}), .out_data_o({even_mask, even_bits})
      );
    end else begin : gen_plain
      msn_delay #(.Depth(Channels), .Width(Width)) u_even (
        .clk_i, .rst_i,
        .step_i(accept), .in_data_i(total[l][Width-1:0]), .out_data_o(even_bits)
      );
      assign even_mask = 1'b0;
    end
    assign masked      = mask[l] || even_mask;
    assign even_sample = DetailBits'(signed'(even_bits));
    assign odd_sample  = signed'(total[l]);

    always_ff @(posedge clk_i) begin
      if (in_ready_o) begin
        valid[l+1]   <= valid[l] && odd;
        total[l+1]   <= masked ? '0 : even_sample + odd_sample;
        mask[l+1]    <= masked;
        id[l+1]      <= id[l];
        last[l+1]    <= last[l];
        restart[l+1] <= restart_q;
      end
      if (accept && !odd) restart_q <= restart[l];
      if (accept && last[l]) odd_q <= !odd;
      if (rst_i) begin
        valid[l+1] <= 1'b0;
        odd_q      <= 1'b0;
      end
    end

    if (l == Level - 1) begin : gen_detail
      always_ff @(posedge clk_i) if (in_ready_o) out_detail_o <= masked ? '0 : even_sample - odd_sample;
    end
  end

endmodule
