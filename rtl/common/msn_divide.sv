// SPDX-License-Identifier: Apache-2.0
//
// Quotient of a signed numerator by an unsigned denominator, |num| <= den, den > 0, rounded to nearest,
// ties away from zero:   out = num / den   in Q2.FractionBits; 1.0 = 2^FractionBits is reached exactly.
//
// Restoring, BitsPerClock bits a clock, on |num|: the remainder is compared with den, and at two bits
// with 2 den and 3 den too. The last bit weighs half an LSB and rounds. Of the quotient so far both
// neighbours are kept, floor and floor + 1, so neither rounding nor the sign needs an adder.
//
//   Steps = FractionBits + 1 (one bit a clock), (FractionBits + 3) / 2 (two bits)
//   clock  1               2 .. Steps + 1
//          |num|, den      a digit each; at two bits 3 den is made meanwhile, the first digit being below 3
//
// Latency Steps + 1 clocks; a quotient every Steps + 1 clocks, every clock if Pipelined.
// `side` travels along.   Model: model/meissner/common/divide.py

module msn_divide #(
  parameter  int unsigned DenBits      = 34,
  parameter  int unsigned FractionBits = 14,
  parameter  int unsigned BitsPerClock = 2,
  parameter  bit          Pipelined    = 1'b0,
  parameter  int unsigned SideBits     = 1,  // payload that only travels along
  localparam int unsigned QuotientBits = FractionBits + 2
) (
  input  logic                           clk_i,
  input  logic                           rst_i,

  input  logic                           in_valid_i,
  output logic                           in_ready_o,
  input  logic signed [DenBits:0]        in_num_i,
  input  logic        [DenBits-1:0]      in_den_i,
  input  logic        [SideBits-1:0]     in_side_i,

  output logic                           out_valid_o,
  input  logic                           out_ready_i,
  output logic signed [QuotientBits-1:0] out_quotient_o,
  output logic        [SideBits-1:0]     out_side_o
);

  if (DenBits < 1) begin : gen_check_den_bits
    $fatal(1, "msn_divide: DenBits = %0d must be at least 1", DenBits);
  end
  if (FractionBits < 1 || FractionBits > 30) begin : gen_check_fraction_bits
    $fatal(1, "msn_divide: FractionBits = %0d must lie in 1 .. 30", FractionBits);
  end
  if (BitsPerClock < 1 || BitsPerClock > 2) begin : gen_check_bits_per_clock
    $fatal(1, "msn_divide: BitsPerClock = %0d must be 1 or 2", BitsPerClock);
  end

  localparam int unsigned Steps = (BitsPerClock == 1) ? FractionBits + 1 : (FractionBits + 3) / 2;
  localparam int unsigned Ranks = Pipelined ? Steps + 1 : 1;  // of registers: one that turns, or a pipe
  localparam int unsigned Units = Pipelined ? Steps : 1;      // of one digit each
  localparam int unsigned RestBits = DenBits + BitsPerClock;

  // rest: the remainder, shifted for the next digit; never above den << BitsPerClock.
  logic [Ranks-1:0][RestBits-1:0]     rest;
  logic [Ranks-1:0][DenBits-1:0]      den;
  logic [Ranks-1:0][QuotientBits-1:0] low, high;  // the quotient so far lies in low .. high = low + 1
  logic [Ranks-1:0]                   negative;
  logic [Ranks-1:0][SideBits-1:0]     side;

  logic               below;
  logic [DenBits-1:0] magnitude;
  assign below     = in_num_i[DenBits];
  assign magnitude = (in_num_i[DenBits-1:0] ^ {DenBits{below}}) + DenBits'(below);

  // load: rank 0 takes a division; turn: the units work; final_turn: at the last digit.
  logic load, turn, final_turn;
  assign load = in_valid_i && in_ready_o;

  for (genvar u = 0; u < Units; u++) begin : gen_unit
    localparam int unsigned Next = Pipelined ? u + 1 : 0;

    logic [BitsPerClock-1:0] digit;
    logic [DenBits-1:0]      remainder;

    if (BitsPerClock == 1) begin : gen_one
      logic [RestBits:0] minus_1;
      assign minus_1   = {1'b0, rest[u]} - (RestBits + 1)'(den[u]);
      assign digit     = !minus_1[RestBits];
      assign remainder = minus_1[RestBits] ? rest[u][DenBits-1:0] : minus_1[DenBits-1:0];
    end else begin : gen_two
      // 3 den of rank u; in the first clock still the greatest number there is.
      logic [RestBits-1:0] triple;
      logic [RestBits:0]   minus_1, minus_2, minus_3;
      assign minus_1   = {1'b0, rest[u]} - (RestBits + 1)'(den[u]);
      assign minus_2   = {1'b0, rest[u]} - (RestBits + 1)'({den[u], 1'b0});
      assign minus_3   = {1'b0, rest[u]} - {1'b0, triple};
      logic                upper, lower;  // the digit's bits
      assign upper     = !minus_2[RestBits];
      assign lower     = upper ? !minus_3[RestBits] : !minus_1[RestBits];
      assign digit     = {upper, lower};
      assign remainder = upper ? (lower ? minus_3[DenBits-1:0] : minus_2[DenBits-1:0])
                               : (lower ? minus_1[DenBits-1:0] : rest[u][DenBits-1:0]);

      if (!Pipelined) begin : gen_turning
        always_ff @(posedge clk_i) begin
          if (turn) triple <= RestBits'(den[u]) + RestBits'({den[u], 1'b0});
          if (load) triple <= '1;
        end
      end else if (u == 0) begin : gen_first
        assign triple = '1;
      end else if (u == 1) begin : gen_second
        always_ff @(posedge clk_i) begin
          if (turn) triple <= RestBits'(den[0]) + RestBits'({den[0], 1'b0});
        end
      end else begin : gen_later
        always_ff @(posedge clk_i) if (turn) triple <= gen_unit[u-1].gen_two.triple;
      end
    end

    // Below zero the magnitude's digits count down from -1: complemented, they continue `low`.
    logic [BitsPerClock-1:0] step;
    logic [QuotientBits-1:0] low_next, high_next, rounded;
    assign step      = digit ^ {BitsPerClock{negative[u]}};
    assign low_next  = {low[u][QuotientBits-BitsPerClock-1:0], step};
    assign high_next = (&step) ? high[u] << BitsPerClock
                               : {low[u][QuotientBits-BitsPerClock-1:0], BitsPerClock'(step + 1'b1)};

    // The last digit ends with the bit that rounds; one bit later if it took two to reach it.
    if (BitsPerClock == 2 && FractionBits % 2 == 0) begin : gen_round_second
      assign rounded = (&step) ? high[u] << 1 : {low[u][QuotientBits-2:0], |step};
    end else begin : gen_round_first
      assign rounded = step[BitsPerClock-1] ? high[u] : low[u];
    end

    always_ff @(posedge clk_i) begin
      if (turn) begin
        rest[Next]     <= {remainder, BitsPerClock'(0)};
        low[Next]      <= (Pipelined ? u == Steps - 1 : final_turn) ? rounded : low_next;
        high[Next]     <= high_next;
        den[Next]      <= den[u];
        negative[Next] <= negative[u];
        side[Next]     <= side[u];
      end
      if (u == 0 && load) begin
        rest[0]     <= RestBits'({magnitude, 1'b0});
        low[0]      <= {QuotientBits{below}};
        high[0]     <= QuotientBits'(!below);
        den[0]      <= in_den_i;
        negative[0] <= below;
        side[0]     <= in_side_i;
      end
    end
  end

  assign out_quotient_o = signed'(low[Ranks-1]);
  assign out_side_o     = side[Ranks-1];

  if (Pipelined) begin : gen_pipe
    logic [Steps:0] valid;
    assign in_ready_o  = out_ready_i || !out_valid_o;
    assign out_valid_o = valid[Steps];
    assign turn        = in_ready_o;
    assign final_turn  = 1'b0;
    always_ff @(posedge clk_i) begin
      if (turn) valid <= {valid[Steps-1:0], in_valid_i};
      if (rst_i) valid <= '0;
    end

  end else begin : gen_turn
    localparam int unsigned CountBits = msn_pkg::index_width(Steps);
    logic [CountBits-1:0] count;
    assign in_ready_o = out_valid_o ? out_ready_i : !turn;
    assign final_turn = count == CountBits'(Steps - 1);
    always_ff @(posedge clk_i) begin
      count <= turn ? count + 1'b1 : '0;
      if (load) turn <= 1'b1;
      else if (final_turn) turn <= 1'b0;
      if (turn && final_turn) out_valid_o <= 1'b1;
      else if (out_ready_i) out_valid_o <= 1'b0;
      if (rst_i) begin
        turn        <= 1'b0;
        count       <= '0;
        out_valid_o <= 1'b0;
      end
    end
  end

endmodule
