// SPDX-License-Identifier: Apache-2.0
//
// Of what leaves in a pass, at most `most` pins are on; and a pin is on only if what is charged to it leaves room in its
// duty for a period as long as the one before and two ticks (msn_check in the block). Limits are constant; a period
// begins while no pass is under way, as msn_pin_phase does.

module formal_pin_limits #(
  parameter  int unsigned Pins          = 100,
  parameter  int unsigned AmplitudeBits = 4,
  localparam int unsigned PlaceBits     = msn_pkg::index_width(Pins),
  localparam int unsigned PinBits       = $clog2(Pins + 1)
) (
  input logic                     clk_i,
  input logic                     rst_i,
  input logic [AmplitudeBits-1:0] cfg_top_i,
  input logic [11:0]              cfg_most_i,
  input logic [15:0]              cfg_duty_i,
  input logic [3:0]               cfg_watchdog_i,
  input logic                     running_i,
  input logic                     begin_i,
  input logic                     off_i,
  input logic                     silent_i,
  input logic                     burst_i,
  input logic [12:0]              length_i,
  input logic                     turn_i,
  input logic [AmplitudeBits-1:0] frame_level_i
);

  logic                     frame_begun_o, frame_done_o, out_valid_o, out_last_o, busy_o, idle_o, limited_o;
  logic [PlaceBits-1:0]     frame_place_o;
  logic [AmplitudeBits-1:0] out_level_o;
  logic [PinBits-1:0]       pins_o;
  msn_pin_limits #(.Pins(Pins), .AmplitudeBits(AmplitudeBits)) dut (.*);

  logic        started = 1'b0;
  logic [12:0] used;  // pins on, of those that have left
  logic [15:0] duty_q;
  logic [11:0] most_q;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    duty_q  <= cfg_duty_i;
    most_q  <= cfg_most_i;
    if (dut.valid[3]) used <= dut.last[3] ? '0 : used + 13'(out_valid_o && out_level_o != '0);
    if (rst_i) used <= '0;
  end

  logic [3:0] lowest;
  logic [2:0] flight;  // pins between the memories and the way out
  assign lowest = dut.valid & (~dut.valid + 1'b1);
  assign flight = 3'(dut.valid[0]) + 3'(dut.valid[1]) + 3'(dut.valid[2]) + 3'(dut.valid[3]);
  always_comb begin
    if (!started) assume (rst_i);
    assume (!begin_i || !busy_o);
    if (started) assume (cfg_duty_i == duty_q && cfg_most_i == most_q);
    if (started) begin
      if (out_valid_o && out_level_o != '0) assert (used < 13'(cfg_most_i) && out_level_o <= cfg_top_i);
      // Invariants: places in order, and one `last` at the end of a pass.
      assert (used <= 13'(dut.counted) && 13'(dut.counted) <= 13'(dut.write_place));
      assert (dut.last == ((dut.reading || dut.valid == '0) ? 4'd0 : lowest));
      assert (dut.valid == '0 || ((dut.valid + lowest) & dut.valid) == '0);
      if (dut.reading) begin
        assert (dut.valid == '0 || dut.valid[0]);
        assert (13'(dut.place) == 13'(dut.write_place) + 13'(flight) && 32'(dut.place) < Pins);
      end else begin
        assert (dut.place == '0);
        assert (32'(dut.write_place) + 32'(flight) == (dut.valid == '0 ? 0 : Pins));
      end
      if (dut.valid != '0) begin
        assert ({dut.none_allowed, dut.allowed} == {1'b0, cfg_duty_i} + {1'b1, ~dut.charge});
      end
    end
    if (started && !rst_i) cover (out_valid_o && out_level_o != '0);
  end

endmodule
