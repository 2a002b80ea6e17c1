// SPDX-License-Identifier: Apache-2.0
//
// Pulse-width modulator: a word sets the width of the pulses on a pin.
//
//   high for word (divide + 1) of the (2^Bits - 1)(divide + 1) clocks of a period: 0 always low, 2^Bits - 1 always high
//
// Words arrive at any time; each period uses the last word before it begins, so a new word never changes a pulse under
// way. No pulses until the first word after a reset: a motor driver that holds without pulses then holds, where a word
// of 0 would be a command to open. The first period begins at the pin 3 clocks after the first word.
// Error: none.
// Model: model/meissner/twins/actuate/actuate.py

module msn_pwm #(
  parameter int unsigned Bits       = 16,
  parameter int unsigned DivideBits = 8
) (
  input  logic                  clk_i,
  input  logic                  rst_i,

  input  logic [DivideBits-1:0] cfg_divide_i,  // read when a period begins

  input  logic                  in_valid_i,
  input  logic [Bits-1:0]       in_data_i,

  output logic                  pwm_o,
  output logic                  begin_o        // the clock in which a period begins at the pin
);

  if (Bits < 2 || Bits > 16) begin : gen_check_bits
    $fatal(1, "msn_pwm: Bits = %0d must lie in 2 .. 16", Bits);
  end
  if (DivideBits < 1 || DivideBits > 16) begin : gen_check_divide_bits
    $fatal(1, "msn_pwm: DivideBits = %0d must lie in 1 .. 16", DivideBits);
  end

  localparam logic [Bits-1:0] LastStep = {{(Bits - 1){1'b1}}, 1'b0};  // not ~Bits'(1): Yosys makes that 1

  logic                  known, runs;        // a word has arrived; a period is under way
  logic [Bits-1:0]       word, width, step;
  logic [DivideBits-1:0] divide, clocks;
  logic                  step_ends, period_ends;
  assign step_ends   = clocks >= divide;
  assign period_ends = !runs || (step_ends && step >= LastStep);

  always_ff @(posedge clk_i) begin
    if (in_valid_i) word <= in_data_i;
    if (period_ends) begin
      width  <= word;
      divide <= cfg_divide_i;
      step   <= '0;
      clocks <= '0;
    end else begin
      step   <= step + Bits'(step_ends);
      clocks <= step_ends ? '0 : clocks + 1'b1;
    end
    known   <= known || in_valid_i;
    runs    <= known;
    pwm_o   <= runs && step < width;
    begin_o <= runs && step == '0 && clocks == '0;
    if (rst_i) begin
      known   <= 1'b0;
      runs    <= 1'b0;
      pwm_o   <= 1'b0;
      begin_o <= 1'b0;
    end
  end

endmodule
