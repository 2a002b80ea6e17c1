// Cover points of msn_haar, level by level: a sample taken and one stalled in even and in odd frames, restarts and
// masks in both, the ends of the number range, details of both signs and 0, and every pair of parameters.
module cover_haar #(
  parameter int unsigned Channels   = 1,
  parameter int unsigned SampleBits = 17,
  parameter int unsigned Level      = 1,
  parameter bit          Mask       = 1'b0
) (
  input logic                               clk_i,
  input logic                               rst_i,
  input logic                               in_ready_o,
  input logic                               out_valid_o,
  input logic                               out_ready_i,
  input logic signed [SampleBits+Level-1:0] out_detail_o,
  input logic signed [SampleBits+Level-1:0] out_total_o,
  input logic                               out_mask_o,
  input logic        [3:0]                  valid,  // one bit per level
  input logic        [3:0]                  restart,  // one bit per level
  input logic        [3:0]                  mask,  // one bit per level
  input logic        [3:0]                  last,  // one bit per level
  input logic                               odd_q
);
  localparam logic signed [SampleBits+Level-1:0] Half = (SampleBits+Level)'(1) << (SampleBits + Level - 1);
  localparam logic signed [SampleBits+Level-1:0] Unit = (SampleBits+Level)'(1) << Level;
  logic given;
  assign given = !rst_i && out_valid_o && out_ready_i;

  for (genvar l = 1; l <= 3; l++) begin : gen_level
    logic here;
    assign here = Level == l;
    for (genvar odd = 0; odd <= 1; odd++) begin : gen_odd
      logic now;
      assign now = here && !rst_i && valid[0] && odd_q == (odd == 1);
      `BIN(taken, now && in_ready_o)
      `BIN(held, now && !in_ready_o)
      `BIN(restarted, now && in_ready_o && restart[0])
      `BIN(masked, now && in_ready_o && mask[0])
      `BIN(cleared, here && rst_i && valid[0] && odd_q == (odd == 1))
    end
    for (genvar masks = 0; masks <= 1; masks++) begin : gen_masks
      `BIN(built, here && given && Mask == (masks == 1))
      for (genvar many = 0; many <= 1; many++) begin : gen_many
        // One channel and many, both with and without masks.
        `BIN(many_built, given && Mask == (masks == 1) && (Channels > 1) == (many == 1))
      end
    end
    for (genvar s = 0; s < l; s++) begin : gen_between
      `BIN(held, here && !rst_i && valid[s+1] && !in_ready_o)
      `BIN(held_last, here && !rst_i && valid[s+1] && last[s+1] && !in_ready_o)
    end
    `BIN(masked_out, here && given && out_mask_o && out_total_o == 0)
    `BIN(highest, here && given && out_total_o == ~Half - Unit + 1)
    `BIN(lowest, here && given && out_total_o == Half)
    `BIN(steepest_up, here && given && out_detail_o < -((Unit / 2) << (SampleBits - 1)))
    `BIN(steepest_down, here && given && out_detail_o > (Unit / 2) << (SampleBits - 1))
    `BIN(flat, here && given && out_detail_o == 0 && !out_mask_o)
  end
endmodule

bind msn_haar cover_haar #(.Channels(Channels), .SampleBits(SampleBits), .Level(Level), .Mask(Mask)) u_cover (
  .valid(4'(valid)), .restart(4'(restart)), .mask(4'(mask)), .last(4'(last)), .odd_q(gen_level[0].odd_q), .*
);
