// SPDX-License-Identifier: Apache-2.0
//
// A tactile display at a core: what its sensor feels, or frames of a host, on the pins. Instances and wires only.
//
//   image, centre of pressure, slip ── render ──┬── pin_display ── drivers
//   levels of a host ── fifo ── width_converter ┘
//
// Display = 0: no logic is built. Image: the sensor has an image of Rows x Columns. A conversion that is lost is a fault
// of one clock, a taxel that cannot be trusted one that lasts; both only while the frames are the sensor's. A host's
// levels come three at a time, row by row. The slip's octant is kept from its beginning on.
// Error: none.
// Model: model/meissner/twins/actuate/display.py

module msn_display #(
  parameter  bit          Display       = 1'b1,
  parameter  bit          Suits         = 1'b1,  // the core has an image or a centre of pressure
  parameter  bit          Image         = 1'b1,
  parameter  bit          Directed      = 1'b0,  // octant_i is known
  parameter  int unsigned Rows          = 16,
  parameter  int unsigned Columns       = 16,
  parameter  int unsigned PinRows       = 5,
  parameter  int unsigned PinColumns    = 20,
  parameter  int unsigned Chains        = 1,
  parameter  int unsigned AmplitudeBits = 4,
  parameter  int unsigned ClkKhz        = 25_000
) (
  input  logic                               clk_i,
  input  logic                               rst_i,

  input  msn_registers_pkg::display_cfg_t    cfg_i,
  output msn_registers_pkg::display_status_t status_o,

  input  logic                               image_valid_i,  // taxels, never stalled
  input  logic [15:0]                        image_data_i,
  input  logic                               image_last_i,
  input  logic                               cop_valid_i,
  input  msn_pkg::cop_t                      cop_i,
  input  logic                               slip_i,
  input  logic                               raised_i,       // a slip begins, in the direction of
  input  logic [2:0]                         octant_i,
  input  msn_registers_pkg::status_t         sensor_i,       // its counters

  output logic [Chains-1:0]                  hv_data_o,
  output logic                               hv_clk_o,
  output logic                               hv_le_o,
  output logic                               hv_bl_o,
  output logic                               hv_pol_o,
  output logic                               hv_dir_o
);

  if (Display && !Suits) begin : gen_check_suits
    $fatal(1, "msn_display: Display = 1 must go with an array, two channels or more, or Cop4");
  end

  if (Display) begin : gen_display
    localparam int unsigned Pins    = PinRows * PinColumns;
    localparam int unsigned Lanes   = 3;
    localparam int unsigned Beats   = (PinColumns + Lanes - 1) / Lanes;  // of a row
    localparam int unsigned PinBits = $clog2(Pins + 1);

    // The sensor's faults.
    logic        lost, bad, fault, running;
    logic [3:0]  lost_now, lost_q;
    logic [31:0] faults;
    assign lost_now = sensor_i.scan.lost[3:0] ^ {2'd0, sensor_i.adc.timeout[0], sensor_i.adc.mistagged[0]};
    assign bad      = cfg_i.health && (sensor_i.health.dead != '0 || sensor_i.health.railed != '0
                                       || sensor_i.health.blinking != '0);
    assign fault    = !cfg_i.source && (lost || bad);
    always_ff @(posedge clk_i) begin
      lost_q <= lost_now;
      lost   <= lost_now != lost_q;
      faults <= faults + 32'(fault && running);
      if (rst_i) begin
        lost_q <= '0;
        lost   <= 1'b0;
        faults <= '0;
      end
    end

    logic [2:0] octant;
    always_ff @(posedge clk_i) if (raised_i) octant <= octant_i;
    logic       felt_valid, felt_last, unused_busy;
    logic [7:0] felt;
    msn_render #(
      .Image(Image), .Rows(Rows), .Columns(Columns), .PinRows(PinRows), .PinColumns(PinColumns),
      .AmplitudeBits(AmplitudeBits)
    ) u_render (
      .clk_i, .rst_i, .cfg_floor_i(cfg_i.floor), .cfg_step_i(cfg_i.step), .cfg_marker_i(cfg_i.marker),
      .cfg_cue_i(cfg_i.cue),
      .in_valid_i(image_valid_i), .in_data_i(image_data_i), .in_last_i(image_last_i),
      .cop_valid_i, .cop_x_i(signed'(cop_i.x[15:0])), .cop_y_i(signed'(cop_i.y[15:0])),
      .cop_pressed_i(cop_i.pressed), .slip_i, .octant_i(Directed ? octant : cfg_i.octant),
      .out_valid_o(felt_valid), .out_data_o(felt), .out_last_o(felt_last), .busy_o(unused_busy)
    );

    // A host's frame: words of three levels.
    logic        word_valid, word_ready, word_last, row_last, sent_valid, sent_last;
    logic        unused_ready, unused_half;
    logic [23:0] word;
    logic [7:0]  sent, beat;
    logic [msn_pkg::index_width(Pins)-1:0] unused_id;
    assign row_last = beat == 8'(Beats - 1);
    msn_fifo #(.Depth(16), .Width(25)) u_words (
      .clk_i, .rst_i, .in_valid_i(cfg_i.levels_written && cfg_i.source), .in_ready_o(unused_ready),
      .in_data_i({cfg_i.levels_last, cfg_i.levels_next}),
      .out_valid_o(word_valid), .out_ready_i(word_ready), .out_data_o({word_last, word}), .half_o(unused_half)
    );
    always_ff @(posedge clk_i) begin
      if (word_valid && word_ready) beat <= (word_last || row_last) ? '0 : beat + 1'b1;
      if (rst_i) beat <= '0;
    end
    msn_width_converter #(.Rows(PinRows), .Columns(PinColumns), .Lanes(Lanes), .DataBits(8)) u_levels (
      .clk_i, .rst_i, .in_valid_i(word_valid), .in_ready_o(word_ready), .in_data_i(word),
      .in_row_last_i(row_last), .in_last_i(word_last), .out_valid_o(sent_valid), .out_ready_i(1'b1),
      .out_data_o(sent), .out_id_o(unused_id), .out_last_o(sent_last)
    );

    logic               unused_wrap;
    logic [PinBits-1:0] pins;
    logic               limited;
    logic [15:0]        dropped;
    msn_pin_display #(
      .Pins(Pins), .Chains(Chains), .AmplitudeBits(AmplitudeBits), .ClkKhz(ClkKhz)
    ) u_pins (
      .clk_i, .rst_i, .cfg_enable_i(cfg_i.enable), .cfg_increment_i(cfg_i.increment),
      .cfg_burst_period_i(cfg_i.burst_period), .cfg_burst_on_i(cfg_i.burst_on), .cfg_top_i(cfg_i.top),
      .cfg_most_i(cfg_i.most), .cfg_duty_i(cfg_i.duty), .cfg_watchdog_i(cfg_i.watchdog),
      .cfg_stop_i(cfg_i.stop), .fault_i(fault),
      .in_valid_i(cfg_i.source ? sent_valid : felt_valid), .in_data_i(cfg_i.source ? sent : felt),
      .in_last_i(cfg_i.source ? sent_last : felt_last),
      .hv_data_o, .hv_clk_o, .hv_le_o, .hv_bl_o, .hv_pol_o, .hv_dir_o,
      .running_o(running), .wrap_o(unused_wrap), .pins_o(pins), .limited_o(limited), .dropped_o(dropped)
    );
    assign status_o = {8'(PinRows), 8'(PinColumns), 8'(AmplitudeBits), running, fault, limited, 12'(pins),
                       dropped, faults};

    logic unused;
    assign unused = ^{sensor_i, cop_i, octant, unused_busy, unused_ready, unused_half, unused_id,
                      unused_wrap};
  end else begin : gen_none
    assign {status_o, hv_data_o, hv_clk_o, hv_le_o, hv_bl_o, hv_dir_o} = '0;
    assign hv_pol_o = 1'b1;
    logic unused;
    assign unused = ^{clk_i, rst_i, cfg_i, image_valid_i, image_data_i, image_last_i, cop_valid_i, cop_i,
                      slip_i, raised_i, octant_i, sensor_i};
  end

endmodule
