// SPDX-License-Identifier: Apache-2.0
//
// A core's link: msn_link, or with SlipOnly the smaller msn_link_slip, connected to a core's signals; the clock count
// for the times in packets, and whether the last centre of pressure was pressed. The statistics are counters from
// status_i: with Array the scan's, else the converter's.
// Model: model/meissner/twins/link/core_link.py

module msn_core_link #(
  parameter int unsigned ClkKhz        = 25_000,
  parameter int unsigned BaudHz        = 3_000_000,
  parameter bit          SlipOnly      = 1'b0,
  parameter bit          Uart          = 1'b1,
  parameter bit          Registers     = 1'b1,
  parameter bit          Array         = 1'b0,
  parameter int unsigned DetailBits    = 18,
  parameter int unsigned SlipDepth     = 64,    // as in msn_packet, like the ones below
  parameter bit          Cop           = 1'b1,
  parameter bit          Health        = 1'b1,
  parameter bit          Statistics    = 1'b1,
  parameter int unsigned StatisticBits = 22,
  parameter int unsigned Taxels        = 4096,
  parameter int unsigned Chunk         = 64
) (
  input  logic                            clk_i,
  input  logic                            rst_i,
  output logic [47:0]                     now_o,             // clocks since reset

  input  msn_registers_pkg::status_t      status_i,          // of the entire core
  output msn_registers_pkg::link_status_t status_o,

  input  logic                            convert_i,         // SlipOnly
  input  logic [47:0]                     time_i,            // of the frame that the results are from
  input  logic                            decision_valid_i,
  output logic                            decision_ready_o,
  input  msn_pkg::decision_t              decision_i,
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

  always_ff @(posedge clk_i) begin
    now_o <= now_o + 1'b1;
    if (cop_valid_i) pressed_o <= cop_i.pressed;
    if (rst_i) {now_o, pressed_o} <= '0;
  end

  if (SlipOnly) begin : gen_slip_only
    msn_link_slip #(.ClkHz(1000 * ClkKhz), .BaudHz(BaudHz), .P2pBits(DetailBits)) u_link (
      .clk_i, .rst_i, .convert_i,
      .in_valid_i(decision_valid_i), .in_ready_o(decision_ready_o), .in_i(decision_i),
      .tx_o
    );
    assign {status_o, health_ready_o, bus_valid_o, bus_write_o, bus_address_o, bus_wdata_o,
            bus_strobe_o} = '0;
    assign {host_done_o, host_error_o, host_rdata_o, out_valid_o, out_data_o, out_last_o} = '0;
    logic unused;
    assign unused = ^{status_i, time_i, cop_i, health_valid_i, health_i, image_valid_i,
                      image_data_i, image_last_i, bus_done_i, bus_error_i, bus_rdata_i, rx_i, host_valid_i,
                      host_write_i, host_address_i, host_wdata_i, host_strobe_i, out_ready_i};

  end else begin : gen_link
    localparam int unsigned StatisticsBits = Statistics ? 256 : 32;
    logic [95:0] frames;
    assign frames = Array ? {status_i.scan.lost, status_i.scan.overrun, status_i.scan.dropped} :
                    {status_i.adc.timeout, status_i.adc.overrun, status_i.adc.dropped};
    logic [StatisticsBits-1:0] statistics;
    assign statistics = StatisticsBits'({
        status_i.link.rejected, status_i.link.image_dropped, status_i.cop.damaged, status_i.slip.blanked,
        status_i.slip.damaged, frames});

    logic slip_ready;
    assign decision_ready_o = !decision_i.raised || slip_ready;
    msn_link #(
      .ClkHz(1000 * ClkKhz), .BaudHz(BaudHz), .Uart(Uart), .Registers(Registers), .SlipDepth(SlipDepth),
      .Cop(Cop), .Health(Health), .Statistics(Statistics ? 8 : 0), .StatisticBits(StatisticBits),
      .Taxels(Taxels), .Chunk(Chunk)
    ) u_link (
      .clk_i, .rst_i, .now_i(now_o),
      .rx_i, .tx_o,
      .out_valid_o, .out_ready_i, .out_data_o, .out_last_o,
      .host_valid_i, .host_write_i, .host_address_i, .host_wdata_i, .host_strobe_i,
      .host_done_o, .host_error_o, .host_rdata_o,
      .bus_valid_o, .bus_write_o, .bus_address_o, .bus_wdata_o, .bus_strobe_o,
      .bus_done_i, .bus_error_i, .bus_rdata_i,
      .slip_valid_i(decision_valid_i && decision_i.raised), .slip_ready_o(slip_ready),
      .slip_id_i(decision_i.id), .slip_state_i(decision_i.state), .slip_p2p_i(decision_i.p2p),
      .slip_time_i(time_i),
      .cop_valid_i, .cop_x_i(cop_i.x), .cop_y_i(cop_i.y), .cop_load_i(cop_i.load),
      .cop_pressed_i(cop_i.pressed), .cop_time_i(time_i),
      .health_valid_i, .health_ready_o, .health_id_i(health_i.id), .health_faults_i(health_i.faults),
      .statistics_i(statistics),
      .image_valid_i, .image_data_i, .image_last_i, .image_time_i(time_i),
      .packets_o(status_o.packets), .cop_dropped_o(status_o.cop_dropped),
      .image_dropped_o(status_o.image_dropped), .rejected_o(status_o.rejected)
    );
    logic unused;
    assign unused = ^{status_i, convert_i, decision_i};
  end

endmodule
