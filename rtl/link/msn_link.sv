// SPDX-License-Identifier: Apache-2.0
//
// The link to the host, with the clock count for the times in packets and the last centre of pressure's `pressed`.
//
//   Uart:      changes, classes, CoP, health, counters, images ── packet ── cobs ── uart_tx ── line
//              register bus ── bridge ── uart_rx ── line,   bridge ── answers ── packet
//   else:      changes, classes, CoP, health, counters, images ── packet ── bytes, unframed;   register bus ── the host's bus
//   SlipOnly:  changes ── link_slip ── line
//   changes:   decisions ── slip_changes
//
// The statistics are counters from status_i: with Array the scan's, else the converter's. Specification: docs/link.md.
// With Registers = 0 nothing is received on the line.
// Model: model/meissner/twins/link/link.py

module msn_link #(
  parameter int unsigned ClkKhz        = 25_000,
  parameter int unsigned BaudHz        = 3_000_000,
  parameter bit          SlipOnly      = 1'b0,
  parameter bit          Uart          = 1'b1,
  parameter bit          Registers     = 1'b1,  // over the line; the host's bus (Uart = 0) does not need it
  parameter bit          Array         = 1'b0,
  parameter int unsigned TimeoutClocks = 10 * ClkKhz,
  parameter int unsigned DetailBits    = 18,
  parameter int unsigned SlipChannels  = 1,     // of the decisions
  parameter int unsigned FirstState    = 0,     // as in msn_packet, like the ones below
  parameter int unsigned SlipDepth     = 64,
  parameter bit          Cop           = 1'b1,
  parameter bit          Classes       = 1'b0,
  parameter bit          Health        = 1'b1,
  parameter bit          Statistics    = 1'b1,
  parameter int unsigned StatisticBits = 22,
  parameter int unsigned Taxels        = 4096,
  parameter int unsigned Chunk         = 64
) (
  input  logic                            clk_i,
  input  logic                            rst_i,
  output logic [47:0]                     now_o,             // clocks since reset

  input  msn_registers_pkg::link_cfg_t    cfg_i,
  input  msn_registers_pkg::status_t      status_i,          // of the entire core
  output msn_registers_pkg::link_status_t status_o,

  input  logic                            convert_i,         // SlipOnly
  input  logic [47:0]                     time_i,            // of the frame that the results are from
  input  logic                            decision_valid_i,
  output logic                            decision_ready_o,
  input  msn_pkg::decision_t              decision_i,
  input  logic                            class_valid_i,
  output logic                            class_ready_o,
  input  msn_pkg::class_t                 class_i,
  input  logic                            cop_valid_i,
  input  msn_pkg::cop_t                   cop_i,
  output logic                            pressed_o,         // the last centre of pressure
  input  logic                            health_valid_i,
  output logic                            health_ready_o,
  input  msn_pkg::health_t                health_i,
  input  logic                            image_valid_i,
  input  logic [15:0]                     image_data_i,
  input  logic                            image_last_i,

  output logic                            bus_valid_o,       // to the registers
  output logic                            bus_write_o,
  output logic [11:0]                     bus_address_o,
  output logic [31:0]                     bus_wdata_o,
  output logic [3:0]                      bus_strobe_o,
  input  logic                            bus_done_i,
  input  logic                            bus_error_i,
  input  logic [31:0]                     bus_rdata_i,

  input  logic                            rx_i,
  output logic                            tx_o,
  input  logic                            host_valid_i,      // Uart = 0
  input  logic                            host_write_i,
  input  logic [11:0]                     host_address_i,
  input  logic [31:0]                     host_wdata_i,
  input  logic [3:0]                      host_strobe_i,
  output logic                            host_done_o,
  output logic                            host_error_o,
  output logic [31:0]                     host_rdata_o,
  output logic                            out_valid_o,
  input  logic                            out_ready_i,
  output logic [7:0]                      out_data_o,
  output logic                            out_last_o
);

  localparam int unsigned ClkHz = 1000 * ClkKhz;

  always_ff @(posedge clk_i) begin
    now_o <= now_o + 1'b1;
    if (cop_valid_i) pressed_o <= cop_i.pressed;
    if (rst_i) {now_o, pressed_o} <= '0;
  end

  // The registers' bus.
  logic        answer_valid, answer_ready;
  logic [63:0] answer;
  if (!SlipOnly && !Uart) begin : gen_host
    assign {bus_valid_o, bus_write_o, bus_address_o, bus_wdata_o, bus_strobe_o} =
        {host_valid_i, host_write_i, host_address_i, host_wdata_i, host_strobe_i};
    assign {host_done_o, host_error_o, host_rdata_o} = {bus_done_i, bus_error_i, bus_rdata_i};
    assign {answer_valid, answer, status_o.rejected} = '0;
  end else begin : gen_no_host
    assign {host_done_o, host_error_o, host_rdata_o} = '0;
  end
  if (!SlipOnly && Uart && Registers) begin : gen_registers
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
      .rejected_o(status_o.rejected)
    );
  end else if (SlipOnly || Uart) begin : gen_no_registers
    assign {bus_valid_o, bus_write_o, bus_address_o, bus_wdata_o, bus_strobe_o} = '0;
    assign {answer_valid, answer, status_o.rejected} = '0;
  end

  // The changes of channels' states.
  localparam int unsigned IdBits = msn_pkg::index_width(SlipChannels);
  logic                 change_valid, change_ready, room;
  msn_pkg::change_t     change;
  logic [IdBits-1:0]    states_id;
  msn_pkg::slip_state_e states_state;
  if (SlipOnly || SlipDepth > 0) begin : gen_changes
    msn_slip_changes #(.Channels(SlipChannels)) u_changes (
      .clk_i, .rst_i,
      .cfg_events_i({cfg_i.events_release, cfg_i.events_gross, cfg_i.events_incipient, cfg_i.events_contact,
                     cfg_i.events_none}),
      .in_valid_i(decision_valid_i), .in_ready_o(decision_ready_o), .in_i(decision_i),
      .room_i(room), .out_valid_o(change_valid), .out_ready_i(change_ready), .out_o(change),
      .read_id_i(states_id), .read_state_o(states_state), .lost_o(status_o.changes_lost)
    );
  end else begin : gen_no_changes
    assign decision_ready_o = 1'b1;
    assign {change_valid, change, status_o.changes_lost} = '0;
    assign states_state = msn_pkg::None;
    logic unused_changes;
    assign unused_changes = ^{decision_valid_i, change_ready, room, states_id};
  end

  if (SlipOnly) begin : gen_slip_only
    msn_link_slip #(.ClkHz(ClkHz), .BaudHz(BaudHz), .P2pBits(DetailBits)) u_link (
      .clk_i, .rst_i, .convert_i,
      .in_valid_i(change_valid), .in_ready_o(change_ready), .in_i(change), .room_o(room),
      .tx_o
    );
    assign {status_o.packets, status_o.cop_dropped, status_o.image_dropped, health_ready_o} = '0;
    assign {class_ready_o, answer_ready, states_id, out_valid_o, out_data_o, out_last_o} = '0;

  end else begin : gen_packets
    localparam int unsigned StatisticsBits = Statistics ? 288 : 32;
    localparam int unsigned States         = (SlipDepth > 0 && (Registers || !Uart)) ? SlipChannels : 0;
    logic [95:0]               frames;
    logic [StatisticsBits-1:0] statistics;
    assign frames = Array ? {status_i.scan.lost, status_i.scan.overrun, status_i.scan.dropped} :
                    {status_i.adc.timeout, status_i.adc.overrun, status_i.adc.dropped};
    assign statistics = StatisticsBits'({
        status_i.link.changes_lost, status_i.link.rejected, status_i.link.image_dropped,
        status_i.cop.damaged, status_i.slip.blanked, status_i.slip.damaged, frames});

    logic       packet_begin, packet_valid, packet_ready, packet_last;
    logic [7:0] packet_data;
    logic [msn_pkg::index_width(States)-1:0] asked_id;
    assign states_id = IdBits'(asked_id);
    msn_packet #(
      .SlipDepth(SlipDepth), .States(States), .FirstState(FirstState), .Cop(Cop),
      .Classes(Classes), .Health(Health), .Answers(Uart && Registers), .Statistics(Statistics ? 9 : 0),
      .StatisticBits(StatisticBits),
      .Taxels(Taxels), .Chunk(Chunk)
    ) u_packet (
      .clk_i, .rst_i,
      .now_i(now_o),
      .slip_valid_i(change_valid), .slip_ready_o(change_ready), .slip_room_o(room), .slip_i(change),
      .slip_time_i(time_i), .states_i(cfg_i.states), .states_id_o(asked_id), .states_state_i(states_state),
      .class_valid_i, .class_ready_o, .class_i, .cop_valid_i, .cop_i, .cop_time_i(time_i),
      .health_valid_i, .health_ready_o, .health_i,
      .answer_valid_i(answer_valid), .answer_ready_o(answer_ready), .answer_data_i(answer),
      .statistics_i(statistics),
      .image_valid_i, .image_data_i, .image_last_i, .image_time_i(time_i),
      .out_begin_o(packet_begin), .out_valid_o(packet_valid), .out_ready_i(packet_ready),
      .out_data_o(packet_data), .out_last_o(packet_last),
      .packets_o(status_o.packets), .cop_dropped_o(status_o.cop_dropped),
      .image_dropped_o(status_o.image_dropped)
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
    end else begin : gen_bytes
      assign {out_valid_o, packet_ready, out_data_o} = {packet_valid, out_ready_i, packet_data};
      assign {out_last_o, tx_o} = {packet_last, 1'b1};
      logic unused_begin;
      assign unused_begin = packet_begin;
    end
  end

  // Signals that some builds do not use.
  logic unused;
  assign unused = ^{cfg_i, status_i, convert_i, time_i, decision_i, cop_i, health_valid_i, health_i,
                    class_valid_i, class_i,
                    image_valid_i, image_data_i, image_last_i, bus_done_i, bus_error_i, bus_rdata_i, rx_i,
                    host_valid_i, host_write_i, host_address_i, host_wdata_i, host_strobe_i, out_ready_i,
                    answer_valid, answer, answer_ready, states_state};

endmodule
