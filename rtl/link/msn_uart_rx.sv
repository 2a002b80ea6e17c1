// SPDX-License-Identifier: Apache-2.0
//
// Serial line receiver: start bit, eight data bits lowest first, one stop bit, each sampled in its middle.
//
// A bit lasts ClkHz / BaudHz clocks, to a sixteenth of a clock, at least 4. A byte is valid for one clock, in
// the middle of its stop bit; if that bit is not 1, error_o rises instead, and reception pauses until the line
// rests. A start bit that has ended by its middle is ignored.   Model: model/meissner/twins/link/uart.py
// Error: none.

module msn_uart_rx #(
  parameter int unsigned ClkHz  = 12_000_000,
  parameter int unsigned BaudHz = 1_000_000
) (
  input  logic       clk_i,
  input  logic       rst_i,

  input  logic       rx_i,

  output logic       out_valid_o,
  output logic [7:0] out_data_o,
  output logic       error_o
);

  if (BaudHz < 300 || BaudHz > ClkHz / 4 || ClkHz > 400_000_000) begin : gen_check_baud
    $fatal(1, "msn_uart_rx: BaudHz = %0d must lie in 300 .. ClkHz / 4", BaudHz);
  end

  localparam longint unsigned Sixteenths = (16 * 64'(ClkHz) + 64'(BaudHz) / 2) / 64'(BaudHz);
  localparam int unsigned     Clocks     = 32'(Sixteenths / 16);
  localparam bit [3:0]        Fraction   = 4'(Sixteenths % 16);
  localparam int unsigned     CountBits  = $clog2(Clocks + 1);

  logic rx;
  msn_sync u_sync (
    .clk_i, .in_data_i(rx_i), .out_data_o(rx)
  );

  typedef enum logic [1:0] {
    Rest,
    Start,
    Data,
    Broken  // the stop bit was missing: wait until the line rests
  } state_e;

  state_e               state;
  logic [CountBits-1:0] left;
  logic [3:0]           part, part_q;
  logic                 longer, tick;
  logic [8:0]           shift;  // a 1 ahead of the first data bit reaches shift[0] with the eighth bit
  assign tick           = left == '0;
  assign {longer, part} = {1'b0, part_q} + 5'(Fraction);
  assign out_valid_o    = state == Data && tick && shift[0] && rx;
  assign error_o        = state == Data && tick && shift[0] && !rx;
  assign out_data_o     = shift[8:1];

  always_ff @(posedge clk_i) begin
    if (!tick) left <= left - 1'b1;
    case (state)
      Rest: if (!rx) begin
        state  <= Start;
        left   <= CountBits'((Clocks - 2) / 2);  // the line is seen low half a clock late on average
        part_q <= 4'd8;
      end
      Start: if (tick) begin
        state <= rx ? Rest : Data;
        shift <= 9'h100;
      end
      Data: if (tick) begin
        if (shift[0]) state <= rx ? Rest : Broken;
        else shift <= {rx, shift[8:1]};
      end
      default: if (rx) state <= Rest;
    endcase
    if (tick && (state == Start || state == Data)) begin
      left   <= CountBits'(Clocks - 1) + CountBits'(longer);
      part_q <= part;
    end
    if (rst_i) state <= Broken;
  end

endmodule
