// SPDX-License-Identifier: Apache-2.0
//
// An array's samples to single forces, centres of pressure and health reports: the stages in data-path order.
//
//   skid ─ health ─ skid ─ tare, skid ─ calibrate ─ skid ─┬─ width_converter (Tap) ─ samples
//                                                         └─ cop ─ x, y, load
//   health ─ health_report ─ reports
//
// Health = 0 or Tare = 0 leaves that stage out: its settings have no effect, its results are 0. With Tare samples are
// one bit wider and the calibration has gains only: msn_tare has already subtracted each taxel's zero. Beats as
// msn_frame_marker gives them. The skids cut the paths of ready.
// Latency after a frame's last beat: a clock each of health, tare and, with several lanes, the skid before and between
// them; 3 clocks (RowColumn 15) and msn_cop's; the same in every frame.
// Model: model/meissner/twins/sensor/array_forces.py

module msn_array_forces #(
  parameter  int unsigned Rows         = 16,
  parameter  int unsigned Columns      = 16,
  parameter  int unsigned Lanes        = 1,
  parameter  bit          Health       = 1'b1,
  parameter  bit          Tare         = 1'b1,
  parameter  bit          RowColumn    = 1'b0,                // gains of rows and columns, not of taxels
  parameter  bit          Tap          = 1'b1,                // samples are wanted
  parameter  int unsigned GainShift    = RowColumn ? 24 : 12,
  parameter  int unsigned TareLog2     = 4,
  parameter  int unsigned FractionBits = 14,
  parameter  int unsigned BitsPerClock = 2,
  localparam int unsigned SampleBits   = 17,
  localparam int unsigned IdBits       = msn_pkg::index_width(Rows * ((Columns + Lanes - 1) / Lanes)),
  localparam int unsigned TaxelBits    = msn_pkg::index_width(Rows * Columns)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  msn_registers_pkg::cfg_t      cfg_i,
  output msn_registers_pkg::status_t   status_o,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic [Lanes*SampleBits-1:0]  in_data_i,      // signed, the leftmost column in the low bits
  input  logic [Lanes-1:0]             in_user_i,      // over-range
  input  logic [IdBits-1:0]            in_id_i,
  input  logic                         in_fits_i,      // marks of msn_frame_marker
  input  logic                         in_row_last_i,
  input  logic                         in_last_i,

  output logic                         sample_valid_o,
  input  logic                         sample_ready_i,
  output logic signed [SampleBits-1:0] sample_data_o,
  output logic [TaxelBits-1:0]         sample_id_o,
  output logic                         sample_last_o,
  output logic                         sample_mask_o,
  output logic                         cop_valid_o,
  output msn_pkg::cop_t                cop_o,
  output logic                         health_valid_o,
  input  logic                         health_ready_i,
  output msn_pkg::health_t             health_o
);

  localparam int unsigned ZeroedBits = SampleBits + 32'(Tare);
  localparam int unsigned SumBits    = 16 + $clog2(Rows * Columns);
  localparam int unsigned CopBits    = FractionBits + 2;

  msn_registers_pkg::health_status_t    health;
  msn_registers_pkg::tare_status_t      tare;
  msn_registers_pkg::calibrate_status_t calibrate;
  msn_registers_pkg::cop_status_t       cop;
  always_comb begin
    status_o           = '0;
    status_o.health    = health;
    status_o.tare      = tare;
    status_o.calibrate = calibrate;
    status_o.cop       = cop;
  end

  logic                        gate_valid, gate_ready;
  logic [2:0]                  gate_marks;
  logic [Lanes*SampleBits-1:0] gate_data;
  logic [IdBits-1:0]           gate_id;
  logic [Lanes-1:0]            gate_user;
  if (Lanes > 1) begin : gen_skid
    msn_skid #(.Width(Lanes * (SampleBits + 1) + IdBits + 3)) u_skid (
      .clk_i, .rst_i,
      .in_valid_i, .in_ready_o,
      .in_data_i({in_data_i, in_user_i, in_id_i, in_fits_i, in_row_last_i, in_last_i}),
      .out_valid_o(gate_valid), .out_ready_i(gate_ready),
      .out_data_o({gate_data, gate_user, gate_id, gate_marks})
    );
  end else begin : gen_no_skid  // a small array: the path is short, and cells are scarce
    assign {gate_valid, in_ready_o} = {in_valid_i, gate_ready};
    assign {gate_data, gate_user, gate_id, gate_marks} =
        {in_data_i, in_user_i, in_id_i, in_fits_i, in_row_last_i, in_last_i};
  end

  // Taxels that cannot be trusted, and reports of their faults.
  logic                        seen_valid, seen_ready, checked_valid, checked_ready;
  logic [Lanes*SampleBits-1:0] seen_data, checked_data;
  logic [Lanes-1:0]            seen_mask, checked_mask;
  logic [IdBits-1:0]           seen_id, checked_id;
  logic [2:0]                  seen_marks, checked_marks;
  if (Health) begin : gen_health
    logic              event_valid, event_ready;
    logic [IdBits-1:0] event_id;
    logic [Lanes-1:0]  event_dead, event_railed, event_blinking;
    msn_health #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits)) u_health (
      .clk_i, .rst_i,
      .cfg_i(cfg_i.health), .status_o(health),
      .in_valid_i(gate_valid), .in_ready_o(gate_ready), .in_data_i(gate_data), .in_user_i(gate_user),
      .in_id_i(gate_id), .in_fits_i(gate_marks[2]), .in_row_last_i(gate_marks[1]), .in_last_i(gate_marks[0]),
      .out_valid_o(seen_valid), .out_ready_i(seen_ready), .out_data_o(seen_data), .out_mask_o(seen_mask),
      .out_id_o(seen_id), .out_fits_o(seen_marks[2]), .out_row_last_o(seen_marks[1]),
      .out_last_o(seen_marks[0]),
      .event_valid_o(event_valid), .event_ready_i(event_ready), .event_id_o(event_id),
      .event_dead_o(event_dead), .event_railed_o(event_railed), .event_blinking_o(event_blinking)
    );
    msn_health_report #(.IdBits(IdBits), .Lanes(Lanes), .Columns(Columns)) u_health_report (
      .clk_i, .rst_i,
      .in_valid_i(event_valid), .in_ready_o(event_ready), .in_id_i(event_id), .in_dead_i(event_dead),
      .in_railed_i(event_railed), .in_blinking_i(event_blinking),
      .out_valid_o(health_valid_o), .out_ready_i(health_ready_i), .out_id_o(health_o.id),
      .out_faults_o(health_o.faults)
    );
  end else begin : gen_no_health
    assign {seen_valid, gate_ready, seen_data, seen_id} = {gate_valid, seen_ready, gate_data, gate_id};
    assign {seen_mask, seen_marks} = {Lanes'(0), gate_marks};
    assign {health, health_valid_o, health_o} = '0;
  end

  // Between the two a skid cuts the path of ready from tare to the states of health.
  if (Lanes > 1 && Health && Tare) begin : gen_health_skid
    msn_skid #(.Width(Lanes * (SampleBits + 1) + IdBits + 3)) u_skid (
      .clk_i, .rst_i,
      .in_valid_i(seen_valid), .in_ready_o(seen_ready),
      .in_data_i({seen_data, seen_mask, seen_id, seen_marks}),
      .out_valid_o(checked_valid), .out_ready_i(checked_ready),
      .out_data_o({checked_data, checked_mask, checked_id, checked_marks})
    );
  end else begin : gen_no_health_skid
    assign {checked_valid, seen_ready}  = {seen_valid, checked_ready};
    assign {checked_data, checked_mask} = {seen_data, seen_mask};
    assign {checked_id, checked_marks}  = {seen_id, seen_marks};
  end

  // The taxels' zeros subtracted. In the first clock after a reset `started` asks for the first tare.
  logic                        started, zeroed_valid, zeroed_ready;
  logic [Lanes*ZeroedBits-1:0] zeroed_data;
  logic [Lanes-1:0]            zeroed_mask;
  logic [2:0]                  zeroed_marks;
  always_ff @(posedge clk_i) started <= rst_i;
  if (Tare) begin : gen_tare
    logic                        tared_valid, tared_ready;
    logic [Lanes*ZeroedBits-1:0] tared_data;
    logic [Lanes-1:0]            tared_mask;
    logic [IdBits-1:0]           unused_id;  // the blocks downstream do not need it
    logic [2:0]                  tared_marks;
    msn_tare #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .TareLog2(TareLog2)
    ) u_tare (
      .clk_i, .rst_i,
      .cfg_i(cfg_i.tare), .start_i(started), .status_o(tare),
      .in_valid_i(checked_valid), .in_ready_o(checked_ready), .in_data_i(checked_data),
      .in_mask_i(checked_mask), .in_id_i(checked_id), .in_fits_i(checked_marks[2]),
      .in_row_last_i(checked_marks[1]), .in_last_i(checked_marks[0]),
      .out_valid_o(tared_valid), .out_ready_i(tared_ready), .out_data_o(tared_data), .out_mask_o(tared_mask),
      .out_id_o(unused_id), .out_fits_o(tared_marks[2]), .out_row_last_o(tared_marks[1]),
      .out_last_o(tared_marks[0])
    );
    msn_skid #(.Width(Lanes * (ZeroedBits + 1) + 3)) u_skid (
      .clk_i, .rst_i,
      .in_valid_i(tared_valid), .in_ready_o(tared_ready), .in_data_i({tared_data, tared_mask, tared_marks}),
      .out_valid_o(zeroed_valid), .out_ready_i(zeroed_ready),
      .out_data_o({zeroed_data, zeroed_mask, zeroed_marks})
    );
  end else begin : gen_no_tare
    assign {zeroed_valid, checked_ready}             = {checked_valid, zeroed_ready};
    assign {zeroed_data, zeroed_mask, zeroed_marks}  = {checked_data, checked_mask, checked_marks};
    assign tare = '0;
  end

  // Forces. The blocks downstream stall the skid, so that no path of ready goes through the calibration.
  logic                force_valid, force_ready, next_valid, next_ready, next_fits, next_row_last, next_last;
  logic [Lanes*16-1:0] force_data, next_data;
  logic [Lanes-1:0]    force_mask, next_mask;
  logic [2:0]          force_marks;
  msn_calibrate #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(ZeroedBits), .RowColumn(RowColumn),
    .GainShift(GainShift), .Offset(!Tare)
  ) u_calibrate (
    .clk_i, .rst_i,
    .cfg_i(cfg_i.calibrate), .status_o(calibrate),
    .in_valid_i(zeroed_valid), .in_ready_o(zeroed_ready), .in_data_i(zeroed_data), .in_mask_i(zeroed_mask),
    .in_fits_i(zeroed_marks[2]), .in_row_last_i(zeroed_marks[1]), .in_last_i(zeroed_marks[0]),
    .out_valid_o(force_valid), .out_ready_i(force_ready), .out_data_o(force_data), .out_mask_o(force_mask),
    .out_fits_o(force_marks[2]), .out_row_last_o(force_marks[1]), .out_last_o(force_marks[0])
  );
  msn_skid #(.Width(Lanes * 17 + 3)) u_skid (
    .clk_i, .rst_i,
    .in_valid_i(force_valid), .in_ready_o(force_ready), .in_data_i({force_marks, force_mask, force_data}),
    .out_valid_o(next_valid), .out_ready_i(next_ready),
    .out_data_o({next_fits, next_row_last, next_last, next_mask, next_data})
  );

  // Each beat goes to the centre of pressure and, with Tap, taxel by taxel to the samples.
  logic cop_valid, cop_ready, tap_valid, tap_ready;
  if (Tap) begin : gen_tap
    msn_fork u_fork (
      .clk_i, .rst_i,
      .in_valid_i(next_valid), .in_ready_o(next_ready),
      .a_valid_o(cop_valid), .a_ready_i(cop_ready), .b_valid_o(tap_valid), .b_ready_i(tap_ready)
    );
  end else begin : gen_no_tap
    assign {cop_valid, next_ready, tap_valid} = {next_valid, cop_ready, 1'b0};
    logic unused_tap;
    assign unused_tap = tap_ready;
  end

  logic signed [CopBits-1:0] x, y;
  logic [SumBits-1:0]        load;
  msn_cop #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock)
  ) u_cop (
    .clk_i, .rst_i,
    .cfg_min_load_i(SumBits'(cfg_i.cop.min_load)),
    .in_valid_i(cop_valid), .in_ready_o(cop_ready), .in_data_i(next_data), .in_fits_i(next_fits),
    .in_row_last_i(next_row_last), .in_last_i(next_last),
    .out_valid_o(cop_valid_o), .out_ready_i(1'b1), .out_x_o(x), .out_y_o(y), .out_load_o(load),
    .out_pressed_o(cop_o.pressed),
    .damaged_o(cop.damaged)
  );
  assign {cop_o.x, cop_o.y, cop_o.load} = {24'(x), 24'(y), 40'(load)};

  logic [Lanes*17-1:0] tap_data;  // lane by lane, the mask above the force
  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    assign tap_data[17*k+:17] = {next_mask[k], next_data[16*k+:16]};
  end
  msn_width_converter #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes), .DataBits(17)) u_width_converter (
    .clk_i, .rst_i,
    .in_valid_i(tap_valid), .in_ready_o(tap_ready), .in_data_i(tap_data), .in_row_last_i(next_row_last),
    .in_last_i(next_last),
    .out_valid_o(sample_valid_o), .out_ready_i(sample_ready_i),
    .out_data_o({sample_mask_o, sample_data_o[15:0]}), .out_id_o(sample_id_o), .out_last_o(sample_last_o)
  );
  assign sample_data_o[16] = 1'b0;

  // Signals that some builds do not use.
  logic unused;
  assign unused = ^{cfg_i, started, gate_user, checked_id, health_ready_i};

endmodule
