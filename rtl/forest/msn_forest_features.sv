// SPDX-License-Identifier: Apache-2.0
//
// Features of a forest from the frames of an array: the differences of successive frames, in a window of frames.
//
//   d[n] = x[n] - x[n-1] of each channel
//   out    d[n-Window+1] .. d[n], each of channels 0 .. Channels-1, after frame n;  last on the final one
//
// Frames as msn_frame_filter sends them: the first frame after a restart has no difference, so there are no features
// until Window more have come. A ring holds the window, its oldest word at the place of the next write.
//
// Takes a sample a clock, and none while it sends Channels * Window features, one a clock, the first 3 clocks after
// the frame's last sample.
// Error: none.
// Model: model/meissner/twins/forest/forest_features.py

module msn_forest_features #(
  parameter  int unsigned Channels   = 9,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Window     = 6,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic        [IdBits-1:0]     in_id_i,
  input  logic                         in_last_i,
  input  logic                         in_restart_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [SampleBits:0]   out_data_o,
  output logic                         out_last_o
);

  if (Channels < 1 || Channels > 4096) begin : gen_check_channels
    $fatal(1, "msn_forest_features: Channels = %0d must lie in 1 .. 4096", Channels);
  end
  if (SampleBits < 2) begin : gen_check_sample_bits
    $fatal(1, "msn_forest_features: SampleBits = %0d must be at least 2", SampleBits);
  end
  if (Window < 1 || Window > 256) begin : gen_check_window
    $fatal(1, "msn_forest_features: Window = %0d must lie in 1 .. 256", Window);
  end

  localparam int unsigned Words    = Channels * Window;
  localparam int unsigned WordBits = msn_pkg::index_width(Words);
  localparam int unsigned FullBits = $clog2(Window + 1);

  logic accept, sending, advance;
  assign in_ready_o = !sending;
  assign accept     = in_valid_i && in_ready_o;
  assign advance    = out_ready_i || !out_valid_o;

  logic        [SampleBits-1:0] earlier;
  logic signed [SampleBits:0]   difference;
  msn_delay #(.Depth(Channels), .Width(SampleBits)) u_before (
    .clk_i, .rst_i, .step_i(accept), .in_data_i(in_data_i), .out_data_o(earlier)
  );
  assign difference = (SampleBits + 1)'(in_data_i) - (SampleBits + 1)'(signed'(earlier));

  // The place of the next write, and of the oldest word; the word that is read.
  logic [WordBits-1:0] write, read, write_next, read_next;
  assign write_next = write == WordBits'(Words - 1) ? '0 : write + 1'b1;
  assign read_next  = read == WordBits'(Words - 1) ? '0 : read + 1'b1;
  logic [SampleBits:0] ring_word;
  assign out_data_o = signed'(ring_word);
  msn_ram #(.Words(Words), .Width(SampleBits + 1)) u_ring (
    .clk_i,
    .write_i(accept), .write_address_i(write), .write_data_i(difference),
    .read_i(advance), .read_address_i(read), .out_data_o(ring_word)
  );

  // Frames with differences in the ring, up to Window.
  logic [FullBits-1:0] full, full_next;
  assign full_next = in_restart_i ? '0 : full == FullBits'(Window) ? full : full + 1'b1;

  // The two reads of the ring: what is fetched, and what is at the output. Words are counted: a comparison of the places
  // would never end after an upset of one.
  logic fetched, fetched_last, final_read;
  logic [WordBits-1:0] left;
  assign final_read = left == '0;
  always_ff @(posedge clk_i) begin
    if (accept) begin
      write <= write_next;
      if (in_last_i) begin
        full    <= full_next;
        sending <= full_next == FullBits'(Window);
        read    <= write_next;
        left    <= WordBits'(Words - 1);
      end
    end
    if (advance) begin
      fetched      <= sending;
      fetched_last <= final_read;
      out_valid_o  <= fetched;
      out_last_o   <= fetched_last;
      if (sending) begin
        read    <= read_next;
        left    <= left - 1'b1;
        sending <= !final_read;
      end
    end
    if (rst_i) begin
      write       <= '0;
      full        <= '0;
      sending     <= 1'b0;
      fetched     <= 1'b0;
      out_valid_o <= 1'b0;
    end
  end

  logic unused;
  assign unused = ^in_id_i;

endmodule
