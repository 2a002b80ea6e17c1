// SPDX-License-Identifier: Apache-2.0
//
// The smallest link: sends the changes of one channel to the line and receives nothing.
//
//   changes ─ packet_slip ─ cobs ─ uart_tx ─ line
//
// Specification: docs/link.md. convert_i: the convert start; a change's packet carries its time.
// Model: model/meissner/twins/link/link.py

module msn_link_slip #(
  parameter int unsigned ClkHz   = 12_000_000,
  parameter int unsigned BaudHz  = 1_000_000,
  parameter int unsigned P2pBits = 18
) (
  input  logic             clk_i,
  input  logic             rst_i,

  input  logic             convert_i,
  input  logic             in_valid_i,
  output logic             in_ready_o,
  input  msn_pkg::change_t in_i,
  output logic             room_o,
  output logic             tx_o
);

  logic       packet_begin, packet_valid, packet_ready, packet_last;
  logic [7:0] packet_data;
  msn_packet_slip #(.P2pBits(P2pBits)) u_packet_slip (
    .clk_i, .rst_i,
    .convert_i,
    .in_valid_i, .in_ready_o, .in_i, .room_o,
    .out_begin_o(packet_begin), .out_valid_o(packet_valid), .out_ready_i(packet_ready),
    .out_data_o(packet_data), .out_last_o(packet_last)
  );

  logic       framed_valid, framed_ready;
  logic [7:0] framed_data;
  msn_cobs #(.MaxBytes(18)) u_cobs (
    .clk_i, .rst_i,
    .in_begin_i(packet_begin), .in_valid_i(packet_valid), .in_ready_o(packet_ready), .in_data_i(packet_data),
    .in_last_i(packet_last),
    .out_valid_o(framed_valid), .out_ready_i(framed_ready), .out_data_o(framed_data)
  );

  msn_uart_tx #(.ClkHz(ClkHz), .BaudHz(BaudHz)) u_uart_tx (
    .clk_i, .rst_i,
    .in_valid_i(framed_valid), .in_ready_o(framed_ready), .in_data_i(framed_data),
    .tx_o
  );

endmodule
