// Cover points of msn_pin_phase: each cause that switches all off, alone, at a wrap and within a period; each reason
// not to start, alone; bursts and changes of the frequency at a wrap, with a frame and without; where a seventh ends.
module cover_pin_phase (
  input logic        clk_i,
  input logic        rst_i,
  input logic        cfg_enable_i,
  input logic [11:0] cfg_burst_period_i,
  input logic [11:0] cfg_burst_on_i,
  input logic        fault_i,
  input logic        frame_valid_i,
  input logic        idle_i,
  input logic        running_o,
  input logic        off_o,
  input logic        begin_o,
  input logic        turn_o,
  input logic        wrap,
  input logic        fast,
  input logic        start,
  input logic        stopped,
  input logic        stuck,
  input logic        changed,
  input logic        tick,
  input logic [11:0] burst_n
);
  logic [11:0] burst, burst_next;  // from 0 on
  assign burst_next = ~burst_n;
  assign burst      = burst_next - 1'b1;
  logic [4:0] off, rest;
  assign off  = {wrap && !fast, stuck, stopped, fault_i, !cfg_enable_i};
  assign rest = {turn_o, !idle_i, !fast, stopped, fault_i} & {5{cfg_enable_i}};
  for (genvar k = 0; k < 5; k++) begin : gen_cause
    if (k != 4) begin : gen_within
      `BIN(in_a_period, !rst_i && running_o && !wrap && off == 5'(1 << k))
    end
    if (k != 3) begin : gen_at
      `BIN(at_a_wrap, !rst_i && running_o && wrap && off == 5'(1 << k))
    end
    `BIN(rests, !rst_i && !running_o && cfg_enable_i && rest == 5'(1 << k))
  end
  for (genvar c = 0; c <= 1; c++) begin : gen_changed
    for (genvar f = 0; f <= 1; f++) begin : gen_frame
      `BIN(begins, begin_o && !rst_i && changed == (c == 1) && frame_valid_i == (f == 1))
    end
    `BIN(no_burst, begin_o && !rst_i && changed == (c == 1) && cfg_burst_period_i == '0)
    `BIN(burst_goes_on, begin_o && !rst_i && changed == (c == 1) && burst_next < cfg_burst_period_i)
    `BIN(burst_ends, begin_o && !rst_i && changed == (c == 1) && burst_next == cfg_burst_period_i)
    `BIN(burst_was_cut, begin_o && !rst_i && changed == (c == 1) && burst_next > cfg_burst_period_i
                        && cfg_burst_period_i != '0)
  end
  `BIN(last_on, begin_o && !rst_i && cfg_burst_period_i != '0 && burst + 1'b1 == cfg_burst_on_i)
  `BIN(first_off, begin_o && !rst_i && cfg_burst_period_i != '0 && burst == cfg_burst_on_i)
  `BIN(turns_at_a_wrap, turn_o && begin_o && !rst_i)
  `BIN(turns_in_a_period, turn_o && running_o && !wrap && !off_o && !rst_i)
  `BIN(turns_as_it_ends, turn_o && off_o && !rst_i)
  `BIN(turns_at_rest, turn_o && !running_o && !rst_i)
  `BIN(ticks_at_a_wrap, tick && begin_o && !rst_i)
  `BIN(ticks_as_it_starts, tick && start && !rst_i)
endmodule

bind msn_pin_phase cover_pin_phase u_cover (.*);
