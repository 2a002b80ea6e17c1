// SPDX-License-Identifier: Apache-2.0
//
// What a block of the slip path may rely on (assumed; msn_frame_filter guarantees it, msn_haar preserves it): frames
// whose samples count 0 .. Channels-1, the final one marked `last`; `restart` is constant within a frame, and set in
// the first after reset. watch_i is any channel, constant.

module owed_frames #(
  parameter  int unsigned Channels = 8,
  localparam int unsigned IdBits   = msn_pkg::index_width(Channels)
) (
  input  logic              clk_i,
  input  logic              rst_i,
  input  logic [IdBits-1:0] watch_i,
  input  logic              accept_i,
  input  logic              in_valid_i,
  input  logic [IdBits-1:0] in_id_i,
  input  logic              in_last_i,
  input  logic              in_restart_i,

  output logic              started_o,
  output logic [IdBits-1:0] at_o,      // the next sample's channel
  output logic              first_o,   // no frame since reset
  output logic              again_o,   // the present frame has restart
  output logic              watched_o  // the watched channel's sample is taken now
);

  logic              started = 1'b0;
  logic [IdBits-1:0] watch;
  assign started_o = started;
  assign watched_o = accept_i && at_o == watch_i;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    watch   <= watch_i;
    if (accept_i) begin
      at_o    <= in_last_i ? '0 : at_o + 1'b1;
      again_o <= in_restart_i;
      if (in_last_i) first_o <= 1'b0;
    end
    if (rst_i) begin
      at_o    <= '0;
      first_o <= 1'b1;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    assume (32'(watch_i) < Channels);
    if (started) begin
      assume (watch_i == watch);
      if (in_valid_i) begin
        assume (in_id_i == at_o && in_last_i == (32'(at_o) == Channels - 1));
        if (at_o != '0) assume (in_restart_i == again_o);
        else if (first_o) assume (in_restart_i);
      end
      assert (32'(at_o) < Channels);
      if (first_o && at_o != '0) assert (again_o);
    end
  end

endmodule
