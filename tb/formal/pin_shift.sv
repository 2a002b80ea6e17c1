// SPDX-License-Identifier: Apache-2.0
//
// Blanked in the clock after a reset, after off_i and while nothing runs; the blanking ends only after a latch that ended
// while it ran; polarity is never low; the latch opens only in its clock, and not onto a load that has not ended.

module formal_pin_shift #(
  parameter  int unsigned Pins          = 100,
  parameter  int unsigned Chains        = 1,
  parameter  int unsigned AmplitudeBits = 4,
  parameter  int unsigned ClkKhz        = 25_000,
  parameter  int unsigned SclkKhz       = 8_000,
  parameter  bit          Direction     = 1'b0,
  localparam int unsigned SlotBits      = AmplitudeBits + 1
) (
  input logic                     clk_i,
  input logic                     rst_i,
  input logic                     in_valid_i,
  input logic [AmplitudeBits-1:0] in_level_i,
  input logic                     in_last_i,
  input logic                     running_i,
  input logic                     off_i,
  input logic                     begin_i,
  input logic                     step_i,
  input logic [SlotBits-1:0]      slot_i,
  input logic                     busy_i
);

  logic              busy_o, hv_clk_o, hv_le_o, hv_bl_o, hv_pol_o, hv_dir_o, wrap_o;
  logic [Chains-1:0] hv_data_o;
  msn_pin_shift #(
    .Pins(Pins), .Chains(Chains), .AmplitudeBits(AmplitudeBits), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz),
    .Direction(Direction)
  ) dut (.*);

  logic started = 1'b0;
  logic stops_q, le_q, bl_q, loaded_q;
  always_ff @(posedge clk_i) begin
    started  <= 1'b1;
    stops_q  <= rst_i || off_i || !running_i;
    le_q     <= hv_le_o;
    bl_q     <= hv_bl_o;
    loaded_q <= dut.loaded;
  end
  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert (hv_pol_o && hv_dir_o == Direction);
      if (stops_q) assert (!hv_bl_o && !hv_le_o && !wrap_o);
      if (hv_bl_o && !bl_q) assert (le_q && !hv_le_o);
      if (hv_le_o && !le_q) assert (loaded_q);
      if (wrap_o) assert (hv_le_o);
    end
  end
endmodule
