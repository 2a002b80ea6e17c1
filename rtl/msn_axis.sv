// SPDX-License-Identifier: Apache-2.0
//
// The core with AXI interfaces: samples in and packets out as AXI4-Streams, registers as AXI4-Lite.
//
//   s_axis   complete frames, tlast on the final beat; a beat has Lanes samples in 32 bits each, low SampleBits used
//   m_axis   packets (docs/link.md) byte by byte, tlast on the final byte; no answer packets: AXI4-Lite answers
//   s_axil   docs/registers.md
//
// Every ready is low in reset: what a reset would forget is not taken.
// A packet's time is the clock tick of its frame's first beat. Model: model/meissner/twins/core.py

module msn_axis #(
  parameter  bit          Array            = 1'b1,   // this and the following: msn_core
  parameter  int unsigned Rows             = 16,
  parameter  int unsigned Columns          = 16,
  parameter  int unsigned Lanes            = 1,      // of an array
  parameter  int unsigned Channels         = 1,
  parameter  int unsigned ClkKhz           = 100_000,
  parameter  bit          Health           = 1'b0,
  parameter  bit          Tare             = 1'b0,
  parameter  bit          RowColumn        = 1'b0,
  parameter  bit          Slip             = 1'b1,
  parameter  bit          Image            = 1'b1,
  parameter  bit          Cop4             = 1'b0,
  parameter  bit          Correct          = 1'b0,
  parameter  bit          CopSlip          = 1'b0,
  parameter  bit          Grip             = 1'b0,
  parameter  bit          ShearSpeed       = 1'b0,
  parameter  bit          Forest           = 1'b0,
  parameter  bit          ForestFrames     = 1'b1,
  parameter  bit          Display          = 1'b0,
  parameter  int unsigned PinRows          = 5,
  parameter  int unsigned PinColumns       = 20,
  parameter  int unsigned PinChains        = 1,
  parameter  int unsigned AmplitudeBits    = 4,
  parameter  bit          Statistics       = 1'b1,
  parameter  int unsigned Level            = 1,
  parameter  int unsigned Window           = 64,
  parameter  int unsigned Hop              = 64,
  parameter  int unsigned GainShift        = RowColumn ? 24 : 12,
  parameter  int unsigned TareLog2         = 4,
  parameter  int unsigned Lag              = 16,
  parameter  int unsigned SlipDepth        = 64,
  parameter  int unsigned StatisticBits    = 22,
  parameter  int unsigned Chunk            = 64,
  parameter  int unsigned ForestFeatures   = 54,
  parameter  int unsigned ForestBits       = 18,
  parameter  int unsigned ForestClasses    = 2,
  parameter  int unsigned ForestTrees      = 64,
  parameter  int unsigned ForestNodes      = 1024,
  parameter  int unsigned ForestLeaves     = 256,
  parameter  int unsigned ForestEngines    = 1,
  parameter  int unsigned ForestBanks      = 2,
  parameter  int unsigned ForestLanes      = 4,
  parameter  logic [msn_registers_pkg::ResetBits-1:0] Resets = msn_registers_pkg::Reset,
  localparam int unsigned SampleBits       = 17,
  localparam int unsigned Wide             = Array ? Lanes : 1
) (
  input  logic               clk_i,
  input  logic               rst_i,

  input  logic               s_axis_tvalid,
  output logic               s_axis_tready,
  input  logic [32*Wide-1:0] s_axis_tdata,
  input  logic               s_axis_tlast,

  output logic               m_axis_tvalid,
  input  logic               m_axis_tready,
  output logic [7:0]         m_axis_tdata,
  output logic               m_axis_tlast,

  input  logic               s_axil_awvalid,
  output logic               s_axil_awready,
  input  logic [11:0]        s_axil_awaddr,
  input  logic [2:0]         s_axil_awprot,
  input  logic               s_axil_wvalid,
  output logic               s_axil_wready,
  input  logic [31:0]        s_axil_wdata,
  input  logic [3:0]         s_axil_wstrb,
  output logic               s_axil_bvalid,
  input  logic               s_axil_bready,
  output logic [1:0]         s_axil_bresp,
  input  logic               s_axil_arvalid,
  output logic               s_axil_arready,
  input  logic [11:0]        s_axil_araddr,
  input  logic [2:0]         s_axil_arprot,
  output logic               s_axil_rvalid,
  input  logic               s_axil_rready,
  output logic [31:0]        s_axil_rdata,
  output logic [1:0]         s_axil_rresp,

  input  logic               actuator_moving_i,
  output logic               slip_o,
  output logic               gross_o,
  output logic               touched_o,
  output logic               pressed_o,
  output logic               grip_valid_o,
  output logic signed [16:0] grip_word_o,
  output logic               pwm_o,
  output logic [PinChains-1:0] hv_data_o,
  output logic               hv_clk_o,
  output logic               hv_le_o,
  output logic               hv_bl_o,
  output logic               hv_pol_o,
  output logic               hv_dir_o
);

  localparam int unsigned Beats  = Array ? Rows * ((Columns + Wide - 1) / Wide) : Channels;
  localparam int unsigned IdBits = msn_pkg::index_width(Beats);

  logic        bus_valid, bus_write, bus_done, bus_error;
  logic [11:0] bus_address;
  logic [31:0] bus_wdata, bus_rdata;
  logic [3:0]  bus_strobe;
  msn_axil u_axil (
    .clk_i, .rst_i,
    .s_axil_awvalid, .s_axil_awready, .s_axil_awaddr, .s_axil_awprot, .s_axil_wvalid, .s_axil_wready,
    .s_axil_wdata, .s_axil_wstrb, .s_axil_bvalid, .s_axil_bready, .s_axil_bresp, .s_axil_arvalid,
    .s_axil_arready, .s_axil_araddr, .s_axil_arprot, .s_axil_rvalid, .s_axil_rready, .s_axil_rdata,
    .s_axil_rresp,
    .bus_valid_o(bus_valid), .bus_write_o(bus_write), .bus_address_o(bus_address), .bus_wdata_o(bus_wdata),
    .bus_strobe_o(bus_strobe), .bus_done_i(bus_done), .bus_error_i(bus_error), .bus_rdata_i(bus_rdata)
  );

  // Number the beats of a frame; the blocks downstream detect a frame that is too short or too long.
  logic [IdBits-1:0] id;
  always_ff @(posedge clk_i) begin
    if (s_axis_tvalid && s_axis_tready) id <= s_axis_tlast ? '0 : id + 1'b1;
    if (rst_i) id <= '0;
  end

  logic ready;
  assign s_axis_tready = ready && !rst_i;

  logic [Wide*SampleBits-1:0] samples;
  for (genvar k = 0; k < Wide; k++) begin : gen_lane
    assign samples[k*SampleBits+:SampleBits] = s_axis_tdata[32*k+:SampleBits];
    logic unused_upper;
    assign unused_upper = ^s_axis_tdata[32*k+SampleBits+:32-SampleBits];
  end

  localparam int unsigned CoreRows    = Array ? Rows : 1;
  localparam int unsigned CoreColumns = Array ? Columns : 1;
  logic [CoreRows-1:0] unused_row;
  logic [Wide-1:0]     unused_cs_n, unused_sclk, unused_mosi, unused_convst, unused_reset;
  logic                unused_group, unused_tx;
  msn_pkg::sdram_t     unused_sdram;
  msn_pkg::verdict_t   unused_verdict;
  msn_pkg::decision_t  unused_decision;
  msn_core #(
    .Converters(Wide),
    .AdcChannels  ((CoreColumns + Wide - 1) / Wide),  // one group
    .ClkKhz(ClkKhz), .Array(Array), .Rows(CoreRows), .Columns(CoreColumns), .Channels(Channels),
    .Health(Health), .Tare(Tare), .RowColumn(RowColumn), .Slip(Slip), .Image(Image), .Cop4(Cop4),
    .Correct(Correct), .CopSlip(CopSlip), .Grip(Grip), .ShearSpeed(ShearSpeed), .Forest(Forest),
    .ForestFrames(ForestFrames), .ForestFeatures(ForestFeatures), .ForestBits(ForestBits),
    .ForestClasses(ForestClasses), .ForestTrees(ForestTrees), .ForestNodes(ForestNodes),
    .ForestLeaves(ForestLeaves), .ForestEngines(ForestEngines), .ForestBanks(ForestBanks),
    .ForestLanes(ForestLanes), .Statistics(Statistics), .Uart(1'b0),
    .Display(Display), .PinRows(PinRows), .PinColumns(PinColumns), .PinChains(PinChains),
    .AmplitudeBits(AmplitudeBits), .Level(Level), .Window(Window), .Hop(Hop), .GainShift(GainShift),
    .TareLog2(TareLog2),
    .Lag(Lag), .SlipDepth(SlipDepth), .StatisticBits(StatisticBits), .Chunk(Chunk), .Resets(Resets)
  ) u_core (
    .clk_i, .rst_i,
    .row_o(unused_row), .group_o(unused_group),
    .adc_cs_n_o(unused_cs_n), .adc_sclk_o(unused_sclk), .adc_mosi_o(unused_mosi), .adc_miso_i('0),
    .adc_convst_o(unused_convst), .adc_busy_i('0), .adc_reset_o(unused_reset),
    .actuator_moving_i,
    .in_valid_i(s_axis_tvalid), .in_ready_o(ready), .in_data_i(samples), .in_id_i(id),
    .in_last_i(s_axis_tlast),
    .slip_o, .gross_o, .touched_o, .pressed_o, .grip_valid_o, .grip_word_o, .pwm_o,
    .hv_data_o, .hv_clk_o, .hv_le_o, .hv_bl_o, .hv_pol_o, .hv_dir_o,
    .sdram_o(unused_sdram), .sdram_dq_i('0), .verdict_o(unused_verdict), .decision_o(unused_decision),
    .rx_i(1'b1), .tx_o(unused_tx),
    .bus_valid_i(bus_valid), .bus_write_i(bus_write), .bus_address_i(bus_address), .bus_wdata_i(bus_wdata),
    .bus_strobe_i(bus_strobe), .bus_done_o(bus_done), .bus_error_o(bus_error), .bus_rdata_o(bus_rdata),
    .out_valid_o(m_axis_tvalid), .out_ready_i(m_axis_tready), .out_data_o(m_axis_tdata),
    .out_last_o(m_axis_tlast)
  );

endmodule
