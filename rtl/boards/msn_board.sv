// SPDX-License-Identifier: Apache-2.0
//
// The reset and the core, the same for every board. A board's top adds only the clock and the pins that the
// configuration needs (model/meissner/builds/pins.py writes it).
//
// The converters run in parallel: they share all lines but DOUT and BUSY. Up to eight rows have one line each. More
// rows leave as a binary number for external decoders, with an enable above it that is low while a row is driven:
// between two conversions and in pauses no row is driven, which a number cannot express. Until the next row the number
// stays at the last one, so that no other row is selected. All lines are registered (one clock) and do not glitch.

`include "msn_build.svh"  // the configuration, written by tools/make/synth.py

module msn_board (
  input  logic                       clk_i,
  input  logic                       good_i,       // the clock runs

  output logic [`MSN_ROW_PINS-1:0]   row_o,
  output logic [`MSN_GROUP_BITS-1:0] group_o,      // of columns: the multiplexers in front of the converters
  output logic                       adc_cs_n_o,
  output logic                       adc_sclk_o,
  output logic                       adc_mosi_o,
  output logic                       adc_convst_o,
  output logic                       adc_reset_o,
  input  logic [`MSN_DATA_LINES-1:0] adc_miso_i,   // converter by converter, DOUTA lowest
  input  logic [`MSN_CONVERTERS-1:0] adc_busy_i,
  input  logic                       moving_i,     // the actuator moves

  input  logic                       rx_i,
  output logic                       tx_o,

  output logic                       slip_o,       // levels, for LEDs or pins
  output logic                       gross_o,
  output logic                       touched_o,
`ifdef MSN_SLIP_PINS
  output logic [`MSN_SLIP_PINS-1:0]  slip_each_o,  // of channel k, by its last decision
`endif
`ifdef MSN_SDRAM
  output msn_pkg::sdram_t            sdram_o,      // of the forest's nodes
  input  logic [15:0]                sdram_dq_i,
`endif
  output logic                       pressed_o,
`ifdef MSN_PIN_CHAINS
  output logic [`MSN_PIN_CHAINS-1:0] hv_data_o,    // of the pin display
  output logic                       hv_clk_o,
  output logic                       hv_le_o,
  output logic                       hv_bl_o,
  output logic                       hv_pol_o,
  output logic                       hv_dir_o,
`endif
  output logic                       pwm_o         // of the grip reflex
);

  localparam int unsigned Rows       = `MSN_ROWS;
  localparam int unsigned Converters = `MSN_CONVERTERS;

  logic rst;
  msn_board_reset u_reset (
    .clk_i, .good_i, .rst_o(rst)
  );

  logic [Rows-1:0]       row;
  logic [Converters-1:0] cs_n, sclk, mosi, convst, reset;
  msn_pkg::verdict_t     verdict;
  msn_pkg::decision_t    decision;
  msn_pkg::sdram_t       sdram;
  logic [15:0]           sdram_dq;
`ifdef MSN_SDRAM
  assign {sdram_o, sdram_dq} = {sdram, sdram_dq_i};
`else
  assign sdram_dq = '0;
`endif
  msn_core #(
    `MSN_PARAMETERS
  ) u_core (
    .clk_i, .rst_i(rst),
    .row_o(row), .group_o,
    .adc_cs_n_o(cs_n), .adc_sclk_o(sclk), .adc_mosi_o(mosi), .adc_miso_i, .adc_convst_o(convst), .adc_busy_i,
    .adc_reset_o(reset),
    .actuator_moving_i(moving_i),
    .in_valid_i(1'b0), .in_ready_o(), .in_data_i('0), .in_id_i('0), .in_last_i(1'b0),
    .slip_o, .gross_o, .touched_o, .pressed_o, .grip_valid_o(), .grip_word_o(), .pwm_o,
    .sdram_o(sdram), .sdram_dq_i(sdram_dq),
`ifdef MSN_PIN_CHAINS
    .hv_data_o, .hv_clk_o, .hv_le_o, .hv_bl_o, .hv_pol_o, .hv_dir_o,
`else
    .hv_data_o(), .hv_clk_o(), .hv_le_o(), .hv_bl_o(), .hv_pol_o(), .hv_dir_o(),
`endif
    .verdict_o(verdict), .decision_o(decision), .rx_i, .tx_o,
    .bus_valid_i(1'b0), .bus_write_i(1'b0), .bus_address_i('0), .bus_wdata_i('0), .bus_strobe_i('0),
    .bus_done_o(), .bus_error_o(), .bus_rdata_o(),
    .out_valid_o(), .out_ready_i(1'b1), .out_data_o(), .out_last_o()
  );

  // A converter that does not answer is not read with the others: its own lines rest, and must not hold the shared ones.
  // The others move their lines in the same clock and the same direction, so AND and OR do not glitch.
  assign adc_cs_n_o   = &cs_n;
  assign adc_sclk_o   = msn_adc_pkg::idles_high(`MSN_ADC) ? &sclk : |sclk;
  assign adc_mosi_o   = (Converters > 1) ? |(mosi & ~cs_n) : mosi[0];
  assign adc_convst_o = |convst;
  assign adc_reset_o  = reset[0];

  if (Rows <= 8) begin : gen_lines
    assign row_o = row;
  end else begin : gen_number
    localparam int unsigned NumberBits = $clog2(Rows);
    logic [NumberBits-1:0] number, number_q;
    logic                  driven, driven_q;
    assign driven = |row;
    always_comb begin
      number = '0;
      for (int unsigned i = 0; i < Rows; i++) number |= row[i] ? NumberBits'(i) : '0;
    end
    always_ff @(posedge clk_i) begin
      driven_q <= driven;
      if (driven) number_q <= number;
    end
    assign row_o = {!driven_q, number_q};
  end

`ifdef MSN_SLIP_PINS
  always_ff @(posedge clk_i) begin
    for (int unsigned k = 0; k < `MSN_SLIP_PINS; k++) begin
      if (verdict.valid && decision.id == 16'(k)) begin
        slip_each_o[k] <= decision.state == msn_pkg::Incipient || decision.state == msn_pkg::Gross;
      end
    end
    if (rst) slip_each_o <= '0;
  end
`endif

  logic unused;
  assign unused = ^{cs_n, sclk, mosi, convst, reset, verdict, decision, sdram};

endmodule
