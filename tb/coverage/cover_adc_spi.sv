// Cover points of msn_adc_spi, for each kind of part: in every state a reset, enable cleared, an extra tick and a
// waiting consumer; BUSY that hangs in either wait; frames dropped, mistagged, both; starts by timer and by trigger.
module cover_adc_spi #(
  parameter int unsigned Part    = 1,
  parameter int unsigned Lanes   = 1,
  parameter bit          Trigger = 1'b0
) (
  input logic       clk_i,
  input logic       rst_i,
  input logic       cfg_enable_i,
  input logic [2:0] state_q,
  input logic       tick,
  input logic       give_up,
  input logic       running,
  input logic       early,
  input logic       overrun,
  input logic       busy,
  input logic       await_q,
  input logic       wait_i,
  input logic       frame_end,
  input logic       drop_q,
  input logic       bad_q,
  input logic       convert_o,
  input logic       out_valid_o,
  input logic       out_ready_i,
  input logic       out_user_o,
  input logic       out_last_o
);
  // Kinds: 0 a CS per channel (MCP3208), 1 with BUSY (AD7606), 2 tagged answers (MAX1112x), 3 BUSY and setup (AD7606C).
  localparam int unsigned Kind = (Part <= 2) ? Part - 1 : (Part == 6) ? 3 : 2;
  // States of each kind, one bit each: Reset, Setup, Idle, BusyRise, BusyFall, Read, from bit 0.
  localparam logic [3:0][5:0] States = {6'b111111, 6'b100111, 6'b111101, 6'b100100};
  localparam logic [2:0] Reset = 3'd0, Idle = 3'd2;

  logic reset_q;
  always_ff @(posedge clk_i) reset_q <= rst_i;
  for (genvar kind = 0; kind <= 3; kind++) begin : gen_kind
    for (genvar s = 0; s <= 5; s++) begin : gen_state
      if (States[kind][s]) begin : gen_has
        logic here;
        assign here = Kind == kind && state_q == 3'(s);
        `BIN(seen, here && !rst_i)
        `BIN(cleared, here && rst_i)
        `BIN(off, here && !rst_i && !cfg_enable_i)
        if (3'(s) != Reset && !(kind >= 2 && s == 1)) begin : gen_frames  // none before a part is ready
          `BIN(held, here && !rst_i && out_valid_o && !out_ready_i)
          if (3'(s) != Idle) begin : gen_busy
            `BIN(overrun, here && !rst_i && tick)
          end
        end
      end
    end
    `BIN(dropped, Kind == kind && !rst_i && frame_end && drop_q && !bad_q)
    `BIN(over_range, Kind == kind && !rst_i && out_valid_o && out_user_o && out_ready_i)
    `BIN(over_range_held, Kind == kind && !rst_i && out_valid_o && out_user_o && !out_ready_i)
    `BIN(last_held, Kind == kind && !rst_i && out_valid_o && out_last_o && !out_ready_i)
    for (genvar t = 0; t <= 1; t++) begin : gen_trigger
      `BIN(started, Kind == kind && convert_o && Trigger == (t == 1))
    end
  end
  `BIN(started_during_read, !rst_i && convert_o && running)
  `BIN(busy_fell_during_read, !rst_i && early)
  `BIN(guarded, !rst_i && overrun && state_q == Idle)
  `BIN(waits_for_others, !rst_i && state_q == 3'd4 && !busy && wait_i && await_q)
  `BIN(waits_no_longer, !rst_i && state_q == 3'd4 && !busy && wait_i && !await_q)
  `BIN(hangs_low, !rst_i && give_up && state_q == 3'd3)
  `BIN(hangs_high, !rst_i && give_up && state_q == 3'd4)
  `BIN(hangs_and_tick, !rst_i && give_up && tick)
  `BIN(hangs_and_drop, !rst_i && give_up && drop_q)
  `BIN(mistagged, !rst_i && frame_end && bad_q && !drop_q)
  `BIN(mistagged_and_dropped, !rst_i && frame_end && bad_q && drop_q)
  `BIN(setup_again, !rst_i && !reset_q && state_q == 3'd1 && tick)
  `BIN(one_lane, Kind == 1 && convert_o && Lanes == 1)
  `BIN(two_lanes, Kind == 1 && convert_o && Lanes == 2)
  `BIN(four_lanes, Kind == 3 && convert_o && Lanes == 4)
  `BIN(eight_lanes, Kind == 3 && convert_o && Lanes == 8)
endmodule

bind msn_adc_spi cover_adc_spi #(.Part(Part), .Lanes(Lanes), .Trigger(Trigger)) u_cover (.state_q(3'(state_q)), .*);
