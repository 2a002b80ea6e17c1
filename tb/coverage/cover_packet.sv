// Cover points of msn_packet: each source chosen while each of lower priority waits; in every state of the sender a
// byte stalled, a reset, each source's arrival, a CoP overwritten, a full slip queue; both ends of an image's packet.
module cover_packet #(
  parameter int unsigned SlipDepth = 1,
  parameter int unsigned Taxels    = 1
) (
  input logic       clk_i,
  input logic       rst_i,
  input logic [1:0] state,
  input logic       idle,
  input logic       some,
  input logic       emit,
  input logic       image_end,
  input logic       upper,
  input logic       slip_valid,
  input logic       answer_valid,
  input logic       states_valid,
  input logic       cop_valid,
  input logic       health_valid,
  input logic       statistic_valid,
  input logic       image_valid,
  input logic       slip_valid_i,
  input logic       slip_ready_o,
  input logic       cop_valid_i,
  input logic       cop_take,
  input logic       health_valid_i,
  input logic       answer_valid_i,
  input logic       states_i,
  input logic       image_valid_i,
  input logic       out_valid_o,
  input logic       out_ready_i,
  input logic       out_last_o
);
  logic [6:0] waits, comes;  // highest priority in bit 0
  assign waits = {image_valid, statistic_valid, health_valid, cop_valid, states_valid, answer_valid, slip_valid};
  assign comes = {image_valid_i, 1'b0, health_valid_i, cop_valid_i, states_i, answer_valid_i, slip_valid_i};
  for (genvar first = 0; first < 7; first++) begin : gen_first
    logic wins;
    assign wins = !rst_i && idle && waits[first] && !(|(waits & 7'((1 << first) - 1)));
    `BIN(alone, wins && waits == 7'(1 << first))
    for (genvar second = first + 1; second < 7; second++) begin : gen_second
      `BIN(passed_over, wins && waits[second])
    end
  end
  for (genvar s = 0; s < 4; s++) begin : gen_state
    logic here;
    assign here = !rst_i && state == 2'(s);
    `BIN(held, here && out_valid_o && !out_ready_i)
    `BIN(cleared, rst_i && state == 2'(s))
    `BIN(overwritten, here && cop_valid_i && cop_valid && !cop_take)
    `BIN(full, here && slip_valid_i && !slip_ready_o && SlipDepth > 0)
    for (genvar source = 0; source < 7; source++) begin : gen_source
      if (source != 5) begin : gen_outside  // statistics arise inside
        `BIN(comes_in, here && comes[source])
      end
      `BIN(waiting, here && waits[source])
    end
  end
  `BIN(last_held, !rst_i && out_valid_o && out_last_o && !out_ready_i)
  `BIN(at_once, !rst_i && out_valid_o && out_last_o && out_ready_i && some)
  `BIN(image_ends, !rst_i && emit && state == 2'd2 && upper && image_end)
  `BIN(image_goes_on, !rst_i && emit && state == 2'd2 && upper && !image_end)
  `BIN(image_and_slip, !rst_i && Taxels > 0 && SlipDepth > 0 && state == 2'd2 && slip_valid)
endmodule

bind msn_packet cover_packet #(.SlipDepth(SlipDepth), .Taxels(Taxels)) u_cover (.state(2'(state)), .*);
