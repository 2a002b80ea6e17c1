// Cover points of msn_divide: each digit (the signs of the trial remainders) of positive and negative dividends, each
// rounding, quotients 0 and 1, a division refused or held in every state, and each pair of BitsPerClock and an
// odd or even number of fraction bits.
module cover_divide #(
  parameter int unsigned BitsPerClock = 1,
  parameter int unsigned FractionBits = 1,
  parameter int unsigned QuotientBits = 3
) (
  input logic                           clk_i,
  input logic                           rst_i,
  input logic                           in_valid_i,
  input logic                           in_ready_o,
  input logic                           out_valid_o,
  input logic                           out_ready_i,
  input logic                           load,
  input logic                           turn,
  input logic        [1:0]              digit,
  input logic                           negative,
  input logic        [1:0]              step,
  input logic signed [QuotientBits-1:0] out_quotient_o
);
  localparam logic signed [QuotientBits-1:0] One = QuotientBits'(1) << FractionBits;
  logic again, fresh, given;
  assign given = out_valid_o && out_ready_i;
  always_ff @(posedge clk_i) begin
    fresh <= load && !rst_i;
    again <= !in_ready_o && in_valid_i && !rst_i;
  end

  for (genvar a = 0; a <= 1; a++) begin : gen_pair
    for (genvar b = 0; b <= 1; b++) begin : gen_with
      `BIN(rate_odd, load && BitsPerClock == 1 + a && FractionBits % 2 == b)
    end
  end
  for (genvar rate = 1; rate <= 2; rate++) begin : gen_rate
    logic here;
    assign here = !rst_i && BitsPerClock == rate;
    for (genvar below = 0; below <= 1; below++) begin : gen_below
      for (genvar d = 0; d < 2 ** rate; d++) begin : gen_digit
        // The first clock, where digit 3 is impossible because |num| is at most den; and any later one.
        if (d < 3) begin : gen_first
          `BIN(first, here && fresh && digit == 2'(d) && negative == (below == 1))
        end
        `BIN(later, here && turn && !fresh && digit == 2'(d) && negative == (below == 1))
        `BIN(rounded, here && given && step == 2'(d) && (out_quotient_o < 0) == (below == 1))
      end
      `BIN(one, here && given && out_quotient_o == (below == 1 ? -One : One))
    end
    `BIN(nothing, here && given && out_quotient_o == 0)
    `BIN(held, here && out_valid_o && !out_ready_i)
    `BIN(chained, here && given && load)
    `BIN(turned_away_by_a_held_result, here && again && in_valid_i && !in_ready_o && out_valid_o)
    `BIN(reset_at_work, rst_i && fresh && BitsPerClock == rate)
    `BIN(turned_away_at_work, here && in_valid_i && turn && !in_ready_o)
  end
endmodule

bind msn_divide cover_divide #(
  .BitsPerClock(BitsPerClock), .FractionBits(FractionBits), .QuotientBits(QuotientBits)
) u_cover (
  .digit(2'(digit)), .step(2'(step)), .*
);
