// Cover points of msn_pin_limits: each limit met exactly and missed by one, alone; each kind of pass, with a window that
// moves on or not; a period that ends within a pass.
module cover_pin_limits #(
  parameter int unsigned AmplitudeBits = 4
) (
  input logic                     clk_i,
  input logic                     rst_i,
  input logic [AmplitudeBits-1:0] cfg_top_i,
  input logic [11:0]              cfg_most_i,
  input logic [3:0]               cfg_watchdog_i,
  input logic                     running_i,
  input logic                     off_i,
  input logic                     silent_i,
  input logic                     burst_i,
  input logic                     turn_i,
  input logic                     begin_i,
  input logic [3:0]               valid,
  input logic [3:0]               last,
  input logic                     reading,
  input logic                     compose,
  input logic                     turning,
  input logic                     due,
  input logic                     fresh,
  input logic                     full,
  input logic                     go,
  input logic                     on_a,
  input logic                     asks,
  input logic                     may,
  input logic                     none_allowed,
  input logic [15:0]              total_b,
  input logic [15:0]              allowed,
  input logic [3:0]               run_b_n,
  input logic [11:0]              counted,
  input logic [AmplitudeBits-1:0] level_b_n
);
  logic [3:0]               run_b;
  logic [AmplitudeBits-1:0] level_b;
  assign run_b   = ~run_b_n;
  assign level_b = ~level_b_n;
  logic leaves, has_duty, has_run, has_room;
  assign leaves   = valid[3] && compose && asks && cfg_top_i != '0 && !rst_i;
  assign has_duty = !none_allowed && total_b <= allowed;
  assign has_run  = run_b <= cfg_watchdog_i;
  assign has_room = counted < cfg_most_i;
  `BIN(duty_met, leaves && may && total_b == allowed)
  `BIN(duty_missed, leaves && has_run && has_room && !none_allowed && total_b == allowed + 1'b1)
  `BIN(no_duty, leaves && has_run && has_room && none_allowed)
  `BIN(watchdog_met, leaves && may && run_b == cfg_watchdog_i)
  `BIN(watchdog_missed, leaves && has_duty && has_room && run_b == cfg_watchdog_i + 1'b1)
  `BIN(most_met, leaves && may && counted + 1'b1 == cfg_most_i)
  `BIN(most_missed, leaves && has_duty && has_run && counted == cfg_most_i)
  `BIN(no_top, valid[3] && compose && asks && cfg_top_i == '0 && !rst_i)
  `BIN(below_top, leaves && may && level_b < cfg_top_i)
  `BIN(at_top, leaves && may && level_b == cfg_top_i)
  `BIN(above_top, leaves && may && level_b > cfg_top_i)
  for (genvar m = 0; m <= 1; m++) begin : gen_may
    `BIN(last_pin, leaves && last[3] && may == (m == 1))
    `BIN(silent, leaves && silent_i && may == (m == 1))
    `BIN(between_bursts, leaves && !burst_i && may == (m == 1))
  end
  for (genvar c = 0; c <= 1; c++) begin : gen_compose
    for (genvar t = 0; t <= 1; t++) begin : gen_turning
      `BIN(charges, valid[2] && !rst_i && on_a && compose == (c == 1) && turning == (t == 1))
      `BIN(early, valid[2] && !rst_i && !full && compose == (c == 1) && turning == (t == 1))
    end
    `BIN(first, valid[1] && !rst_i && fresh && compose == (c == 1))
  end
  `BIN(ends_within_a_pass, reading && off_i && !rst_i)
  `BIN(ends_behind_a_pass, !reading && valid != '0 && off_i && !rst_i)
  `BIN(turns_within_a_pass, reading && turn_i && !rst_i)
  `BIN(turns_as_it_begins, begin_i && turn_i && !rst_i)
  `BIN(turns_at_rest, go && !running_i && due && !rst_i)
endmodule

bind msn_pin_limits cover_pin_limits #(.AmplitudeBits(AmplitudeBits)) u_cover (.*);
