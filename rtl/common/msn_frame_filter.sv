// SPDX-License-Identifier: Apache-2.0
//
// Passes the samples of undamaged frames, resynchronises on `last`.
//
// Channels must count 0 .. Channels-1 with `last` on the final one. The first sample that breaks this and
// the rest of its frame, up to `last`, are dropped, and the frame is counted as damaged. The next frame is
// marked `restart`, as is the first after reset: blocks downstream must discard their history there.
//
// Latency 1 clock, one sample per clock.   Model: model/meissner/twins/common/frames.py
// Error: none.

module msn_frame_filter #(
  parameter  int unsigned Channels = 8,
  parameter  int unsigned DataBits = 17,
  localparam int unsigned IdBits   = msn_pkg::index_width(Channels)
) (
  input  logic                clk_i,
  input  logic                rst_i,

  input  logic                in_valid_i,
  output logic                in_ready_o,
  input  logic [DataBits-1:0] in_data_i,
  input  logic [IdBits-1:0]   in_id_i,
  input  logic                in_last_i,

  output logic                out_valid_o,
  input  logic                out_ready_i,
  output logic [DataBits-1:0] out_data_o,
  output logic [IdBits-1:0]   out_id_o,
  output logic                out_last_o,
  output logic                out_restart_o,

  output logic [31:0]         damaged_o  // frames, since reset
);

  if (Channels < 1) begin : gen_check_channels
    $fatal(1, "msn_frame_filter: Channels = %0d must be at least 1", Channels);
  end
  if (DataBits < 1) begin : gen_check_data_bits
    $fatal(1, "msn_frame_filter: DataBits = %0d must be at least 1", DataBits);
  end

  logic [IdBits-1:0] expected;
  logic              dropping, restart, damage;

  logic final_expected, fits, keep;
  assign final_expected = expected == IdBits'(Channels - 1);
  assign fits = (in_id_i == expected) && (in_last_i == final_expected);
  assign keep = fits && !dropping;

  assign in_ready_o = out_ready_i || !out_valid_o;

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      out_valid_o   <= in_valid_i && keep;
      out_data_o    <= in_data_i;
      out_id_o      <= in_id_i;
      out_last_o    <= in_last_i;
      out_restart_o <= restart;
    end
    if (in_valid_i && in_ready_o) begin
      expected <= in_last_i ? '0 : expected + 1'b1;  // wraps around only while dropping
      dropping <= !in_last_i && !keep;
      if (in_last_i) restart <= !keep;
    end
    damage    <= in_valid_i && in_ready_o && in_last_i && !keep;
    if (damage) damaged_o <= damaged_o + 1'b1;  // a clock later: 32 clock enables are slow
    if (rst_i) begin
      out_valid_o <= 1'b0;
      expected    <= '0;
      dropping    <= 1'b0;
      restart     <= 1'b1;
      damage      <= 1'b0;
      damaged_o   <= '0;
    end
  end

endmodule
