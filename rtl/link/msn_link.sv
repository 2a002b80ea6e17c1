// SPDX-License-Identifier: Apache-2.0
//
// The link to the host: instances and wires only.
//
//   Uart:  events, CoP, health, counters, images ── packet ── cobs ── uart_tx ── line
//          register bus ── bridge ── uart_rx ── line,   bridge ── answers ── packet
//   else:  events, CoP, health, counters, images ── packet ── bytes, unframed
//          register bus ── the host's bus
//
// Specification: docs/link.md. With Registers = 0 nothing is received on the line.
// Model: model/meissner/twins/link/link.py

module msn_link #(
  parameter  int unsigned ClkHz         = 25_000_000,
  parameter  int unsigned BaudHz        = 3_000_000,
  parameter  bit          Uart          = 1'b1,
  parameter  bit          Registers     = 1'b1,  // over the line; the host's bus (Uart = 0) does not need it
  parameter  int unsigned TimeoutClocks = ClkHz / 100,
  parameter  int unsigned SlipDepth     = 64,    // as in msn_packet
  parameter  bit          Cop           = 1'b1,
  parameter  bit          Health        = 1'b1,
  parameter  int unsigned Statistics    = 4,
  parameter  int unsigned StatisticBits = 20,
  parameter  int unsigned Taxels        = 4096,
  parameter  int unsigned Chunk         = 64,
  localparam int unsigned Counters      = (Statistics > 0) ? Statistics : 1
) (
  input  logic                   clk_i,
  input  logic                   rst_i,

  input  logic                   rx_i,
  output logic                   tx_o,

  output logic                   out_valid_o,      // Uart = 0
  input  logic                   out_ready_i,
  output logic [7:0]             out_data_o,
  output logic                   out_last_o,

  input  logic                   host_valid_i,     // Uart = 0
  input  logic                   host_write_i,
  input  logic [11:0]            host_address_i,
  input  logic [31:0]            host_wdata_i,
  input  logic [3:0]             host_strobe_i,
  output logic                   host_done_o,
  output logic                   host_error_o,
  output logic [31:0]            host_rdata_o,

  output logic                   bus_valid_o,
  output logic                   bus_write_o,
  output logic [11:0]            bus_address_o,
  output logic [31:0]            bus_wdata_o,
  output logic [3:0]             bus_strobe_o,
  input  logic                   bus_done_i,
  input  logic                   bus_error_i,
  input  logic [31:0]            bus_rdata_i,

  input  logic [47:0]            now_i,

  input  logic                   slip_valid_i,
  output logic                   slip_ready_o,
  input  logic [15:0]            slip_id_i,
  input  msn_pkg::slip_state_e   slip_state_i,
  input  logic [23:0]            slip_p2p_i,
  input  logic [47:0]            slip_time_i,

  input  logic                   cop_valid_i,
  input  logic [23:0]            cop_x_i,
  input  logic [23:0]            cop_y_i,
  input  logic [39:0]            cop_load_i,
  input  logic                   cop_pressed_i,
  input  logic [47:0]            cop_time_i,

  input  logic                   health_valid_i,
  output logic                   health_ready_o,
  input  logic [23:0]            health_id_i,
  input  logic [7:0]             health_faults_i,

  input  logic [Counters*32-1:0] statistics_i,

  input  logic                   image_valid_i,
  input  logic [15:0]            image_data_i,
  input  logic                   image_last_i,
  input  logic [47:0]            image_time_i,

  output logic [31:0]            packets_o,
  output logic [31:0]            cop_dropped_o,
  output logic [31:0]            image_dropped_o,
  output logic [31:0]            rejected_o
);

  logic        answer_valid, answer_ready;
  logic [63:0] answer;
  if (!Uart) begin : gen_host
    assign {bus_valid_o, bus_write_o, bus_address_o, bus_wdata_o, bus_strobe_o} =
        {host_valid_i, host_write_i, host_address_i, host_wdata_i, host_strobe_i};
    assign {host_done_o, host_error_o, host_rdata_o} = {bus_done_i, bus_error_i, bus_rdata_i};
    assign {answer_valid, answer, rejected_o} = '0;
    logic unused_line;
    assign unused_line = ^{rx_i, answer_ready};
  end else if (Registers) begin : gen_registers
    logic       byte_valid, byte_error;
    logic [7:0] byte_data;
    msn_uart_rx #(.ClkHz(ClkHz), .BaudHz(BaudHz)) u_uart_rx (
      .clk_i, .rst_i,
      .rx_i,
      .out_valid_o(byte_valid), .out_data_o(byte_data),
      .error_o(byte_error)
    );
    msn_bridge #(.TimeoutClocks(TimeoutClocks)) u_bridge (
      .clk_i, .rst_i,
      .in_valid_i(byte_valid), .in_data_i(byte_data), .in_error_i(byte_error),
      .bus_valid_o, .bus_write_o, .bus_address_o, .bus_wdata_o, .bus_strobe_o, .bus_done_i, .bus_error_i,
      .bus_rdata_i,
      .answer_valid_o(answer_valid), .answer_ready_i(answer_ready), .answer_data_o(answer),
      .rejected_o
    );
  end else begin : gen_no_registers
    assign {bus_valid_o, bus_write_o, bus_address_o, bus_wdata_o, bus_strobe_o} = '0;
    assign {answer_valid, answer, rejected_o} = '0;
    logic unused_registers;
    assign unused_registers = ^{rx_i, bus_done_i, bus_error_i, bus_rdata_i, answer_ready};
  end
  if (Uart) begin : gen_no_host
    assign {host_done_o, host_error_o, host_rdata_o} = '0;
    logic unused_host;
    assign unused_host = ^{host_valid_i, host_write_i, host_address_i, host_wdata_i, host_strobe_i};
  end

  logic       packet_begin, packet_valid, packet_ready, packet_last;
  logic [7:0] packet_data;
  msn_packet #(
    .SlipDepth(SlipDepth), .Cop(Cop), .Health(Health), .Answers(Uart && Registers), .Statistics(Statistics),
    .StatisticBits(StatisticBits), .Taxels(Taxels), .Chunk(Chunk)
  ) u_packet (
    .clk_i, .rst_i,
    .now_i,
    .slip_valid_i, .slip_ready_o, .slip_id_i, .slip_state_i, .slip_p2p_i, .slip_time_i,
    .cop_valid_i, .cop_x_i, .cop_y_i, .cop_load_i, .cop_pressed_i, .cop_time_i,
    .health_valid_i, .health_ready_o, .health_id_i, .health_faults_i,
    .answer_valid_i(answer_valid), .answer_ready_o(answer_ready), .answer_data_i(answer),
    .statistics_i,
    .image_valid_i, .image_data_i, .image_last_i, .image_time_i,
    .out_begin_o(packet_begin), .out_valid_o(packet_valid), .out_ready_i(packet_ready),
    .out_data_o(packet_data), .out_last_o(packet_last),
    .packets_o, .cop_dropped_o, .image_dropped_o
  );

  if (Uart) begin : gen_line
    logic       framed_valid, framed_ready;
    logic [7:0] framed_data;
    msn_cobs u_cobs (
      .clk_i, .rst_i,
      .in_begin_i(packet_begin), .in_valid_i(packet_valid), .in_ready_o(packet_ready),
      .in_data_i(packet_data), .in_last_i(packet_last),
      .out_valid_o(framed_valid), .out_ready_i(framed_ready), .out_data_o(framed_data)
    );
    msn_uart_tx #(.ClkHz(ClkHz), .BaudHz(BaudHz)) u_uart_tx (
      .clk_i, .rst_i,
      .in_valid_i(framed_valid), .in_ready_o(framed_ready), .in_data_i(framed_data),
      .tx_o
    );
    assign {out_valid_o, out_data_o, out_last_o} = '0;
    logic unused_ready;
    assign unused_ready = out_ready_i;
  end else begin : gen_bytes
    assign out_valid_o  = packet_valid;
    assign packet_ready = out_ready_i;
    assign out_data_o   = packet_data;
    assign out_last_o   = packet_last;
    assign tx_o         = 1'b1;
    logic unused_begin;
    assign unused_begin = packet_begin;
  end

endmodule
