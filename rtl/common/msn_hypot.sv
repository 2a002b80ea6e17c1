// SPDX-License-Identifier: Apache-2.0
//
// Magnitude of two unsigned numbers.
//
//   Exact:      out = floor(sqrt(a^2 + b^2))
//   otherwise:  out = floor(max(8 M, 7 M + 4 m) / 8), M the larger, m the smaller: -3.0 .. +0.8 %
//
// Exact, without multipliers or squares: A, B are the leading bits of a, b so far, R the root of A^2 + B^2, and
// rest = A^2 + B^2 - R^2. One more bit i of a and j of b adds i(4A+1) + j(4B+1) to 4 rest, and to 2R a digit
// 0 .. 3, found bit by bit. Three clocks a bit, in registers of about the root's width:
//
//   clock  1      3k+2                                 3k+3             3k+4
//          a, b   rest = 4 rest + .., R = 2R, next bit  rest - (4R+4)?   rest - (2R+1)?
//
// Latency 3 Bits + 1 clocks, 3 unless Exact; the period is the same.   Model: model/meissner/twins/common/hypot.py
// Error: at most 1 LSB of the root; at most 2.99 % and 1 LSB of the estimate (tb/extremes).

module msn_hypot #(
  parameter int unsigned Bits  = 24,
  parameter bit          Exact = 1'b1
) (
  input  logic            clk_i,
  input  logic            rst_i,

  input  logic            in_valid_i,
  output logic            in_ready_o,
  input  logic [Bits-1:0] in_a_i,
  input  logic [Bits-1:0] in_b_i,

  output logic            out_valid_o,
  input  logic            out_ready_i,
  output logic [Bits:0]   out_root_o
);

  if (Bits < 1 || Bits > 30) begin : gen_check_bits
    $fatal(1, "msn_hypot: Bits = %0d must lie in 1 .. 30", Bits);
  end

  logic turn, load, final_turn;  // turn: at work
  assign in_ready_o = out_valid_o ? out_ready_i : !turn;
  assign load       = in_valid_i && in_ready_o;

  always_ff @(posedge clk_i) begin
    if (load) turn <= 1'b1;
    else if (final_turn) turn <= 1'b0;
    if (turn && final_turn) out_valid_o <= 1'b1;
    else if (out_ready_i) out_valid_o <= 1'b0;
    if (rst_i) begin
      turn        <= 1'b0;
      out_valid_o <= 1'b0;
    end
  end

  if (Exact) begin : gen_exact
    localparam int unsigned RestBits  = Bits + 4;  // up to 14 R + 12 before a digit, R below 2^(Bits - 1/2)
    localparam int unsigned IndexBits = msn_pkg::index_width(Bits);

    logic [2:0]           phase;  // one-hot: next bits, try 2, try 1; recovers from any other value
    logic [IndexBits-1:0] left;
    logic [Bits-1:0]      a_rest, b_rest, a, b;  // the remaining bits, and the prefixes A, B
    logic [Bits:0]        root;
    logic [RestBits-1:0]  rest, brought;
    logic [RestBits:0]    less;  // rest minus 4R+4 or 2R+1, as the sum with the complement of 4R+3 or 2R

    assign brought = (rest << 2) + (a_rest[Bits-1] ? RestBits'({a, 2'b01}) : '0)
                                 + (b_rest[Bits-1] ? RestBits'({b, 2'b01}) : '0);
    assign less    = {1'b0, rest}
                     + ~(phase[1] ? (RestBits + 1)'({root, 2'b11}) : (RestBits + 1)'({root, 1'b0}));

    always_ff @(posedge clk_i) begin
      if (turn) begin
        phase <= {phase[1:0], ~|phase[1:0]};
        if (phase[0]) begin
          rest   <= brought;
          root   <= root << 1;
          a      <= (a << 1) | Bits'(a_rest[Bits-1]);
          b      <= (b << 1) | Bits'(b_rest[Bits-1]);
          a_rest <= a_rest << 1;
          b_rest <= b_rest << 1;
        end else if (!less[RestBits]) begin
          rest <= less[RestBits-1:0];
          if (phase[1]) root[Bits:1] <= root[Bits:1] + 1'b1;
          else root[0] <= 1'b1;
        end
        if (phase[2]) left <= left - 1'b1;
      end
      if (load) begin
        phase  <= 3'b001;
        left   <= IndexBits'(Bits - 1);
        a_rest <= in_a_i;
        b_rest <= in_b_i;
        a      <= '0;
        b      <= '0;
        rest   <= '0;
        root   <= '0;
      end
    end
    assign final_turn = phase[2] && left == '0;
    assign out_root_o = root;

  end else begin : gen_estimate
    logic            sorted, steep;
    logic [Bits-1:0] major, minor;
    logic [Bits:0]   difference;
    logic [Bits+2:0] excess;  // M - 4 m
    logic [Bits+3:0] sum;     // 7 M + 4 m, below 2^(Bits + 4)
    logic [Bits:0]   root;
    logic [2:0]      unused_sum;
    assign difference = {1'b0, major} - {1'b0, minor};
    assign excess     = (Bits + 3)'(major) - {1'b0, minor, 2'b00};
    assign steep      = excess[Bits+2];  // 7 M + 4 m is more than 8 M
    assign sum        = {1'b0, major, 3'b000} - (Bits + 4)'(major) + {2'b00, minor, 2'b00};
    assign unused_sum = sum[2:0];
    assign final_turn = sorted;

    always_ff @(posedge clk_i) begin
      sorted <= turn && !sorted;
      if (turn && difference[Bits]) begin
        major <= minor;
        minor <= major;
      end
      root <= steep ? sum[Bits+3:3] : (Bits + 1)'(major);
      if (load) begin
        sorted <= 1'b0;
        major  <= in_a_i;
        minor  <= in_b_i;
      end
    end
    assign out_root_o = root;
  end

endmodule
