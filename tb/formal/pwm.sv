// SPDX-License-Identifier: Apache-2.0
//
// Pulses: low until the first word; a period lasts (2^Bits - 1)(divide + 1) clocks and is high for its first
// word (divide + 1) clocks, with the word and the divider read at its beginning; periods follow back to back.

module formal_pwm #(
  parameter int unsigned Bits       = 16,
  parameter int unsigned DivideBits = 8
) (
  input logic                  clk_i,
  input logic                  rst_i,
  input logic [DivideBits-1:0] cfg_divide_i,
  input logic                  in_valid_i,
  input logic [Bits-1:0]       in_data_i
);

  logic pwm_o, begin_o;
  msn_pwm #(.Bits(Bits), .DivideBits(DivideBits)) dut (.*);

  // The words given, and the settings of a period that would begin now.
  logic                  started = 1'b0;
  logic                  given, given_2;
  logic [Bits-1:0]       word, word_2;
  logic [DivideBits-1:0] divide_2;
  // The period at the pin: steps left after the present one, and clocks left in it.
  logic                  on;
  logic [Bits-1:0]       width, steps;
  logic [DivideBits-1:0] divide, clocks;
  logic                  ends;
  assign ends = !on || (steps == '0 && clocks == '0);
  always_ff @(posedge clk_i) begin
    started  <= 1'b1;
    given    <= given || in_valid_i;
    given_2  <= given;
    if (in_valid_i) word <= in_data_i;
    word_2   <= word;
    divide_2 <= cfg_divide_i;
    on       <= given_2;
    if (ends) begin
      width  <= word_2;
      divide <= divide_2;
      steps  <= (Bits)'((1 << Bits) - 2);
      clocks <= divide_2;
    end else begin
      clocks <= clocks == '0 ? divide : clocks - 1'b1;
      steps  <= steps - Bits'(clocks == '0);
    end
    if (rst_i) {given, given_2, on} <= '0;
  end

  // The present step, from 0: the number of steps minus one, minus those left.
  logic [Bits-1:0] at;
  assign at = (Bits)'((1 << Bits) - 2) - steps;
  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert (pwm_o == (on && at < width));
      assert (begin_o == (on && at == '0 && clocks == divide));
      // Invariant: the block is a clock ahead of its pin.
      assert (dut.known == given && dut.runs == given_2);
      if (given) assert (dut.word == word);
      if (on) assert (steps <= (Bits)'((1 << Bits) - 2) && clocks <= divide && given_2);
      if (given_2) begin
        assert (dut.step <= (Bits)'((1 << Bits) - 2) && dut.clocks <= dut.divide);
        if (ends) assert (dut.step == '0 && dut.clocks == '0 && dut.width == word_2 && dut.divide == divide_2);
        else begin
          assert (dut.width == width && dut.divide == divide);
          if (clocks == '0) assert (dut.step == at + 1'b1 && dut.clocks == '0);
          else assert (dut.step == at && dut.clocks == divide - clocks + 1'b1);
        end
      end
    end
    if (started && !rst_i) begin
      cover (begin_o && pwm_o);
      cover (begin_o && !pwm_o);
      cover (on && divide == DivideBits'(2) && at == Bits'(2) && !pwm_o && width == Bits'(2));
    end
  end

endmodule
