// SPDX-License-Identifier: Apache-2.0
//
// Serial line sender: start bit, eight data bits lowest first, one stop bit, 10 bits a byte without a gap.
//
// A bit lasts ClkHz / BaudHz clocks on average, to a sixteenth of a clock (0.8 % at 4 clocks a bit, the minimum;
// exact where it divides). tx_o falls on the clock after a byte is taken while the line is idle.
// Error: at most 1/32 clock (tb/extremes).
// Model: model/meissner/twins/link/uart.py

module msn_uart_tx #(
  parameter int unsigned ClkHz  = 12_000_000,
  parameter int unsigned BaudHz = 1_000_000
) (
  input  logic       clk_i,
  input  logic       rst_i,

  input  logic       in_valid_i,
  output logic       in_ready_o,
  input  logic [7:0] in_data_i,

  output logic       tx_o
);

  if (BaudHz < 300 || BaudHz > ClkHz / 4 || ClkHz > 400_000_000) begin : gen_check_baud
    $fatal(1, "msn_uart_tx: BaudHz = %0d must lie in 300 .. ClkHz / 4", BaudHz);
  end

  localparam longint unsigned Sixteenths = (16 * 64'(ClkHz) + 64'(BaudHz) / 2) / 64'(BaudHz);
  localparam int unsigned     Clocks     = 32'(Sixteenths / 16);
  localparam bit [3:0]        Fraction   = 4'(Sixteenths % 16);
  localparam int unsigned     CountBits  = $clog2(Clocks + 1);

  // The remaining bits, the present one lowest; a single 1 is the stop bit and also the line at rest.
  logic [9:0]           shift;
  logic [CountBits-1:0] left;  // clocks of this bit after this one
  logic                 tick, load, longer;
  assign tick       = left == '0;
  assign in_ready_o = tick && shift[9:1] == '0;
  assign load       = in_valid_i && in_ready_o;
  assign tx_o       = shift[0];

  if (Fraction == '0) begin : gen_whole
    assign longer = 1'b0;
  end else begin : gen_fraction
    logic [3:0] part, part_q;
    assign {longer, part} = {1'b0, part_q} + 5'(Fraction);
    always_ff @(posedge clk_i) begin
      if (tick && (load || !in_ready_o)) part_q <= part;
      if (rst_i) part_q <= '0;
    end
  end

  always_ff @(posedge clk_i) begin
    if (!tick) left <= left - 1'b1;
    else if (load || !in_ready_o) left <= CountBits'(Clocks - 1) + CountBits'(longer);
    // An idle line keeps its 1 by data, not by a clock enable: the enable would depend on in_valid_i, which comes late.
    if (tick) shift <= load ? {1'b1, in_data_i, 1'b0} : {1'b0, shift[9:2], shift[1] || in_ready_o};
    if (rst_i) begin
      shift <= 10'd1;
      left  <= '0;
    end
  end

endmodule
