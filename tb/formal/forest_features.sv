// SPDX-License-Identifier: Apache-2.0
//
// Of any channel (`watch_i`, constant): after each frame that ends Window differences since a restart, and after no
// other, Channels * Window features leave, the oldest difference first, `last` on the final one; none comes from before
// the restart. Frames are as msn_frame_filter sends them (assumed).

module formal_forest_features #(
  parameter  int unsigned Channels   = 2,
  parameter  int unsigned SampleBits = 3,
  parameter  int unsigned Window     = 2,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels),
  localparam int unsigned Words      = Channels * Window
) (
  input logic                         clk_i,
  input logic                         rst_i,
  input logic                         in_valid_i,
  input logic signed [SampleBits-1:0] in_data_i,
  input logic                         in_restart_i,
  input logic                         out_ready_i,
  input logic [IdBits-1:0]            watch_i
);

  logic                       in_ready_o, out_valid_o, out_last_o, in_last_i;
  logic signed [SampleBits:0] out_data_o;
  logic [IdBits-1:0]          in_id_i;
  msn_forest_features #(.Channels(Channels), .SampleBits(SampleBits), .Window(Window)) dut (.*);

  logic                         started = 1'b0;
  logic                         accept, advance, restart_q, sending, sends;
  logic                         whole, known;  // since the reset: a frame, a sample of the watched channel
  logic [IdBits-1:0]            watch_q;
  logic [7:0]                   channel, slot, frames, frames_next;
  logic [7:0]                   sent;  // features of this row that were read
  logic [Window-1:0]            clean;     // of a slot: a whole frame of differences since the restart
  logic [Window-1:0]            kept_known;
  logic [Window-1:0][SampleBits:0] kept;   // of a slot: the watched channel's difference
  logic signed [SampleBits-1:0] earlier;
  logic                         fetched, fetched_last, fetched_ours, out, out_last, out_ours;
  logic [SampleBits:0]          fetched_value, out_value;
  assign accept      = in_valid_i && in_ready_o;
  assign advance     = out_ready_i || !out_valid_o;
  assign in_id_i     = IdBits'(channel);
  assign in_last_i   = channel == 8'(Channels - 1);
  assign frames_next = in_restart_i ? 8'd0 : frames == 8'(Window) ? frames : frames + 8'd1;
  assign sends       = accept && in_last_i && frames_next == 8'(Window);

  function automatic logic [7:0] turned(logic [7:0] place, int unsigned size);
    turned = place >= 8'(size) ? place - 8'(size) : place;
  endfunction

  logic [7:0] of_slot, of_channel;  // of the feature that is read next
  assign of_slot    = turned(slot + sent / 8'(Channels), Window);
  assign of_channel = sent % 8'(Channels);

  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    watch_q <= watch_i;
    if (accept) begin
      restart_q <= in_restart_i;
      channel   <= in_last_i ? 8'd0 : channel + 8'd1;
      if (channel == 8'(watch_i)) begin
        kept[slot] <= (SampleBits + 1)'(in_data_i) - (SampleBits + 1)'(earlier);
        earlier     <= in_data_i;
        known      <= 1'b1;
        kept_known[slot] <= known;
      end
      clean[slot] <= in_last_i && !in_restart_i;
      if (in_last_i) begin
        whole  <= 1'b1;
        slot   <= turned(slot + 8'd1, Window);
        frames <= frames_next;
      end
    end
    if (sends) begin
      sending <= 1'b1;
      sent    <= 8'd0;
    end
    if (advance) begin
      fetched       <= sending;
      fetched_last  <= sent == 8'(Words - 1);
      fetched_ours  <= of_channel == 8'(watch_i);
      fetched_value <= kept[of_slot];
      out           <= fetched;
      out_last      <= fetched_last;
      out_ours      <= fetched_ours;
      out_value     <= fetched_value;
      if (sending) begin
        sent    <= sent + 8'd1;
        sending <= sent != 8'(Words - 1);
      end
    end
    if (rst_i) begin
      {channel, slot, frames, whole, known, clean, kept_known} <= '0;
      {sending, fetched, out} <= '0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    assume (32'(watch_i) < Channels);
    // The first frame is a restart, and a frame is one or is not.
    if (started && !whole) assume (in_restart_i);
    if (started && channel != '0) assume (in_restart_i == restart_q);
    if (started) begin
      assume (watch_i == watch_q);
      assert (in_ready_o == !sending && out_valid_o == out);
      if (out) assert (out_last_o == out_last);
      if (out && out_ours) assert (out_data_o == signed'(out_value));
      if (sending) assert (clean == '1);
      // Invariant.
      assert (channel < 8'(Channels) && slot < 8'(Window) && frames <= 8'(Window));
      assert (32'(dut.write) == 32'(slot) * Channels + 32'(channel));
      assert (32'(dut.full) == 32'(frames) && dut.sending == sending && dut.fetched == fetched);
      if (whole || (channel > 8'(watch_i))) assert (known);
      if (!whole) assert (frames == '0 && (channel == '0 || restart_q));
      if (sending) begin
        assert (channel == '0 && sent < 8'(Words) && frames == 8'(Window));
        assert (32'(dut.read) == (32'(slot) * Channels + 32'(sent)) % Words);
        assert (32'(dut.left) == Words - 1 - 32'(sent));
      end
      if (fetched) assert (dut.fetched_last == fetched_last);
      if (fetched && fetched_ours) assert (dut.u_ring.fetched == fetched_value);
    end
  end
  for (genvar k = 0; k < Window; k++) begin : gen_slot
    // The frames since a restart lie before the slot of the next.
    logic [7:0] age;
    assign age = 8'((32'(slot) + 2 * Window - 1 - k) % Window);
    always_comb begin
      if (started) begin
        if (kept_known[k]) assert (dut.u_ring.memory[k*Channels+32'(watch_i)] == kept[k]);
        if (age < frames && !(channel != '0 && age == 8'(Window - 1))) assert (clean[k]);
        if (clean[k]) assert (kept_known[k]);
        if (channel > 8'(watch_i) && age == 8'(Window - 1) && !restart_q) assert (kept_known[k]);
      end
    end
  end
  // The delay line's words, the newest lowest: that of the watched channel.
  logic [7:0] behind;
  assign behind = 8'((32'(channel) + 2 * Channels - 1 - 32'(watch_i)) % Channels);
  for (genvar k = 0; k < Channels; k++) begin : gen_word
    always_comb begin
      if (started && known && behind == 8'(k)) begin
        assert (dut.u_before.gen_registers.line[k*SampleBits+:SampleBits] == earlier);
      end
    end
  end

  always_comb begin
    if (started) begin
      cover (out && out_last && out_ours && out_value != '0);
      cover (sending && out && !out_ready_i);
    end
  end

endmodule
