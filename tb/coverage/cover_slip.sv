// Cover points of msn_slip: every transition of the state machine, and in each state every event, stalled and taken:
// over and not, gross, moving, lifted, pressed, timer running, restart, reset.
module cover_slip #(
  parameter int unsigned Channels = 1,
  parameter bit          Mask     = 1'b0
) (
  input logic       clk_i,
  input logic       rst_i,
  input logic       in_ready_o,
  input logic       seen_valid,
  input logic       step,
  input logic [2:0] kept_state,
  input logic [2:0] state,
  input logic [2:0] next_state,
  input logic       restart,
  input logic       masked,
  input logic       over,
  input logic       gross,
  input logic       moving,
  input logic       lifted,
  input logic       pressed,
  input logic       running,
  input logic       blanking
);
  // Row: from; bit: to. States: None, Contact, Incipient, Gross, Release.
  localparam logic [4:0][4:0] Steps = {5'b10011, 5'b11010, 5'b11110, 5'b11110, 5'b00011};

  for (genvar from = 0; from < 5; from++) begin : gen_from
    logic here, now;
    assign here = !rst_i && seen_valid && state == 3'(from);
    assign now  = step && !rst_i && state == 3'(from);
    for (genvar to = 0; to < 5; to++) begin : gen_to
      if (Steps[from][to]) begin : gen_step
        `BIN(goes, now && next_state == 3'(to))
      end
    end
    `BIN(held, here && !in_ready_o)
    `BIN(restarted, step && !rst_i && restart && kept_state == 3'(from))
    `BIN(cleared, rst_i && seen_valid && kept_state == 3'(from))
    for (genvar m = 0; m <= 1; m++) begin : gen_moving
      `BIN(at_rest, now && !over && moving == (m == 1))
      `BIN(slips, now && over && !gross && moving == (m == 1))
      `BIN(slides, now && over && gross && moving == (m == 1))
    end
    for (genvar l = 0; l <= 1; l++) begin : gen_lifted
      `BIN(lifts, now && lifted == (l == 1) && !pressed)
      `BIN(presses, now && lifted == (l == 1) && pressed)
      `BIN(lifts_over, now && lifted == (l == 1) && over)
    end
    if (from != 0) begin : gen_timer  // the timer has no meaning in None
      for (genvar r = 0; r <= 1; r++) begin : gen_running
        `BIN(over_while, now && over && running == (r == 1))
        `BIN(rest_while, now && !over && running == (r == 1))
        `BIN(lifted_while, now && lifted && running == (r == 1))
      end
    end
  end
  for (genvar b = 0; b <= 1; b++) begin : gen_blanking
    `BIN(over_early, step && !rst_i && state == 3'd1 && running && over && !lifted && blanking == (b == 1))
    `BIN(over_late, step && !rst_i && state == 3'd1 && !running && over && !lifted && blanking == (b == 1))
    for (genvar m = 0; m <= 1; m++) begin : gen_pair
      `BIN(built, step && Mask == (b == 1) && (Channels > 1) == (m == 1))
    end
  end
  `BIN(masked_now, in_ready_o && masked)
endmodule

bind msn_slip cover_slip #(.Channels(Channels), .Mask(Mask)) u_cover (.*);
