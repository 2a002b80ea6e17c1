// Cover points of msn_scan: each lane alone and all lanes without an answer; over-range marks; beats stalled in
// mid-frame and at its end; waits for room.
module cover_scan #(
  parameter int unsigned Lanes    = 1,
  parameter int unsigned Channels = 1
) (
  input logic             clk_i,
  input logic             rst_i,
  input msn_registers_pkg::scan_cfg_t cfg_i,
  input logic             idle,
  input logic             trigger_o,
  input logic             room,
  input logic             beat,
  input logic             beat_end,
  input logic [Lanes-1:0] lost_q,
  input logic [Lanes-1:0] in_lost_i,
  input logic [Lanes-1:0] in_valid_i,
  input logic [Lanes-1:0] in_user_i,
  input logic             out_valid_o,
  input logic             out_ready_i,
  input logic             out_last_o
);
  logic here;
  assign here = !rst_i && beat && beat_end;
  `BIN(answered, here && lost_q == '0)
  `BIN(all_lost, here && &lost_q)
  `BIN(over_range, here && |in_user_i)
  for (genvar many = 0; many <= 1; many++) begin : gen_pair
    `BIN(lanes, here && (Lanes > 1) == (many == 1))
    `BIN(channels, here && (Channels > 1) == (many == 1))
    `BIN(interleaved, here && cfg_i.interleave == (many == 1))
  end
  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_lane
    `BIN(lost, !rst_i && in_lost_i[lane])
    `BIN(lost_beat, !rst_i && beat && lost_q[lane])
    if (Lanes > 1) begin : gen_many
      `BIN(lost_alone, !rst_i && beat && lost_q == Lanes'(1 << lane))
      `BIN(late, !rst_i && !beat && |in_valid_i && !in_valid_i[lane] && !lost_q[lane])
    end
  end
  `BIN(held, !rst_i && out_valid_o && !out_ready_i && !out_last_o)
  `BIN(held_last, !rst_i && out_valid_o && !out_ready_i && out_last_o)
  `BIN(waits_for_room, !rst_i && !idle && !room)
  `BIN(taken_away, !rst_i && !idle && !cfg_i.enable)
  `BIN(reset_while_converting, rst_i && trigger_o)
  `BIN(reset_while_leaving, rst_i && out_valid_o && !out_last_o)
endmodule

bind msn_scan cover_scan #(.Lanes(Lanes), .Channels(Channels)) u_cover (.*);
