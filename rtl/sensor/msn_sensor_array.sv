// SPDX-License-Identifier: Apache-2.0
//
// A scanned array, from its lines and pins or a stream to single forces, centres of pressure and health reports.
//
//   lines, ADC pins ─ scan_adc or scan_demod ─┬─ frame_gate ─ frame_marker ─ array_forces ─ samples, results, reports
//   stream (Adc = AdcNone) ───────────────────┘
//
// Demod: the taxels are read as amplitudes of a carrier, one lane; else Converters lanes. One frame is let through at
// a time: the next one waits until the results of the previous one have left and busy_i is low, so that settings
// (commit_o) and the frame's time change only between two frames. time_o: a scanned frame's convert start, of a
// stream the clock of its first beat.
// Latency from a scanned frame's last beat: 16 clocks with all stages, the same in every frame.
// Model: model/meissner/twins/sensor/sensors.py

module msn_sensor_array #(
  parameter  int unsigned Adc              = msn_pkg::AdcNone,  // msn_pkg::adc_part_e
  parameter  int unsigned Converters       = 1,
  parameter  int unsigned AdcLanes         = 1,
  parameter  int unsigned AdcChannels      = 8,                 // of each converter; Demod: one
  parameter  int unsigned ClkKhz           = 25_000,
  parameter  int unsigned SclkKhz          = msn_adc_pkg::sclk_default_khz(Adc),
  parameter  bit          ReadDuring       = 1'b0,              // read a conversion while the next one runs
  parameter  int unsigned Rows             = 1,
  parameter  int unsigned Columns          = 1,
  parameter  bit          Demod            = 1'b0,
  parameter  bit          Health           = 1'b0,
  parameter  bit          Tare             = 1'b0,
  parameter  bit          RowColumn        = 1'b0,
  parameter  bit          Tap              = 1'b1,              // samples are wanted
  parameter  int unsigned GainShift        = RowColumn ? 24 : 12,
  parameter  int unsigned TareLog2         = 4,
  parameter  int unsigned FractionBits     = 14,
  parameter  int unsigned BitsPerClock     = 2,
  parameter  int unsigned Form             = msn_pkg::DemodIq,  // this and the next five: msn_scan_demod
  parameter  int unsigned SamplesPerPeriod = 4,
  parameter  int unsigned SamplePeriod     = 160,
  parameter  int unsigned Periods          = 4,
  parameter  int unsigned Skip             = 4,
  parameter  int unsigned Shift            = 3,
  localparam int unsigned SampleBits       = 17,
  localparam int unsigned Lanes            = Demod ? 1 : Converters,
  localparam int unsigned RowBeats         = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned IdBits           = msn_pkg::index_width(Rows * RowBeats),
  localparam int unsigned TaxelBits        = msn_pkg::index_width(Rows * Columns),
  localparam int unsigned Inputs           = Demod ? 1 : AdcChannels,
  localparam int unsigned GroupBits        = msn_pkg::index_width((Columns + Converters * Inputs - 1)
                                                                  / (Converters * Inputs))
) (
  input  logic                           clk_i,
  input  logic                           rst_i,
  input  logic [47:0]                    now_i,

  input  msn_registers_pkg::cfg_t        cfg_i,
  output msn_registers_pkg::status_t     status_o,
  input  logic                           pending_i,          // settings wait for commit_o
  output logic                           commit_o,
  input  logic                           busy_i,             // the blocks behind the samples hold one

  output logic [Rows-1:0]                row_o,
  output logic [GroupBits-1:0]           group_o,
  output logic [Converters-1:0]          adc_cs_n_o,
  output logic [Converters-1:0]          adc_sclk_o,
  output logic [Converters-1:0]          adc_mosi_o,
  input  logic [Converters*AdcLanes-1:0] adc_miso_i,
  output logic [Converters-1:0]          adc_convst_o,
  input  logic [Converters-1:0]          adc_busy_i,
  output logic [Converters-1:0]          adc_reset_o,
  output logic                           convert_o,

  input  logic                           in_valid_i,         // Adc = AdcNone
  output logic                           in_ready_o,
  input  logic [Lanes*SampleBits-1:0]    in_data_i,
  input  logic [IdBits-1:0]              in_id_i,
  input  logic                           in_last_i,

  output logic                           sample_valid_o,
  input  logic                           sample_ready_i,
  output logic signed [SampleBits-1:0]   sample_data_o,
  output logic [TaxelBits-1:0]           sample_id_o,
  output logic                           sample_last_o,
  output logic                           sample_mask_o,
  output logic                           cop_valid_o,
  output msn_pkg::cop_t                  cop_o,
  output logic                           health_valid_o,
  input  logic                           health_ready_i,
  output msn_pkg::health_t               health_o,
  output logic [47:0]                    time_o
);

  if (ReadDuring && !msn_adc_pkg::has_busy(Adc)) begin : gen_check_read_during
    $fatal(1, "msn_sensor_array: ReadDuring = 1 must go with a converter that has BUSY");
  end

  logic                            scan_valid, scan_ready, scan_last;
  logic [Lanes*SampleBits-1:0]     scan_data;
  logic [IdBits-1:0]               scan_id;
  logic [Lanes-1:0]                scan_user;  // over-range
  logic [47:0]                     scan_time;
  msn_registers_pkg::scan_status_t scan;
  if (Adc == msn_pkg::AdcNone) begin : gen_stream
    assign {scan_valid, in_ready_o}         = {in_valid_i, scan_ready};
    assign {scan_data, scan_id, scan_last}  = {in_data_i, in_id_i, in_last_i};
    assign {scan_user, scan}                = '0;
    assign scan_time                        = now_i;  // read at the frame's first beat
    assign adc_cs_n_o                       = '1;
    assign {row_o, group_o, adc_sclk_o, adc_mosi_o, adc_convst_o, adc_reset_o, convert_o} = '0;
  end else if (!Demod) begin : gen_adc
    logic [31:0] unused_frame;
    msn_scan_adc #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Part(Adc), .Channels(AdcChannels), .AdcLanes(AdcLanes),
      .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .SampleBits(SampleBits), .ReadDuring(ReadDuring)
    ) u_scan_adc (
      .clk_i, .rst_i,
      .cfg_i(cfg_i.scan), .status_o(scan), .now_i, .row_o, .group_o,
      .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i, .adc_convst_o, .adc_busy_i, .adc_reset_o,
      .convert_o,
      .out_valid_o(scan_valid), .out_ready_i(scan_ready), .out_data_o(scan_data), .out_id_o(scan_id),
      .out_last_o(scan_last), .out_user_o(scan_user), .out_frame_o(unused_frame),
      .out_time_o(scan_time)
    );
  end else begin : gen_demod
    logic [31:0] unused_frame;
    msn_scan_demod #(
      .Rows(Rows), .Columns(Columns), .Converters(Converters), .Part(Adc), .ClkKhz(ClkKhz),
      .SclkKhz(SclkKhz), .SampleBits(SampleBits), .Form(Form), .SamplesPerPeriod(SamplesPerPeriod),
      .SamplePeriod(SamplePeriod), .Periods(Periods), .Skip(Skip), .Shift(Shift)
    ) u_scan_demod (
      .clk_i, .rst_i,
      .cfg_i(cfg_i.scan), .status_o(scan), .now_i, .row_o, .group_o,
      .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i(adc_miso_i[Converters-1:0]),
      .convert_o,
      .out_valid_o(scan_valid), .out_ready_i(scan_ready), .out_data_o(scan_data), .out_id_o(scan_id),
      .out_last_o(scan_last), .out_user_o(scan_user), .out_frame_o(unused_frame),
      .out_time_o(scan_time)
    );
    assign {adc_convst_o, adc_reset_o} = '0;
  end
  if (Adc != msn_pkg::AdcNone) begin : gen_no_stream
    assign in_ready_o = 1'b0;
  end

  // One frame at a time.
  logic open_valid, open_ready, open_first, owed, opened;
  msn_frame_gate u_gate (
    .clk_i, .rst_i,
    .pending_i(open_valid || pending_i), .commit_o, .busy_i(owed || busy_i),
    .in_valid_i(scan_valid), .in_ready_o(scan_ready), .in_last_i(scan_last),
    .out_valid_o(open_valid), .out_ready_i(open_ready), .out_first_o(open_first)
  );
  assign opened = open_valid && open_ready;

  // A damaged frame, or one that msn_tare swallows, gives no result: the change of a counter shows it.
  msn_registers_pkg::status_t forces;
  logic damaged, swallowed, damaged_q, swallowed_q;
  assign {damaged, swallowed} = {forces.cop.damaged[0], forces.tare.swallowed[0]};
  always_ff @(posedge clk_i) begin
    {damaged_q, swallowed_q} <= {damaged, swallowed};
    if (rst_i) {damaged_q, swallowed_q} <= '0;
    if (opened && open_first) time_o <= scan_time;
  end
  always_comb begin
    status_o      = forces;
    status_o.scan = scan;
  end

  logic cop_done, sample_done;
  assign cop_done    = cop_valid_o || damaged != damaged_q;
  assign sample_done = !Tap || (sample_valid_o && sample_ready_i && sample_last_o);
  msn_frame_owed #(.Results(2)) u_owed (
    .clk_i, .rst_i,
    .taken_i(opened), .first_i(open_first), .done_i({sample_done, cop_done}),
    .drop_i(swallowed != swallowed_q), .quiet_i(!busy_i && !sample_valid_o && !cop_valid_o), .busy_o(owed)
  );

  // Checks and marks each beat once, for all stages downstream.
  logic              placed_valid, placed_ready;
  logic [2:0]        placed_marks;
  logic [IdBits-1:0] placed_id;
  logic [31:0]       unused_damaged;  // msn_cop_accumulate counts these frames
  msn_frame_marker #(.Rows(Rows), .RowBeats(RowBeats)) u_place (
    .clk_i, .rst_i,
    .in_valid_i(open_valid), .in_ready_o(open_ready), .in_id_i(scan_id), .in_last_i(scan_last),
    .out_valid_o(placed_valid), .out_ready_i(placed_ready), .out_id_o(placed_id),
    .out_fits_o(placed_marks[2]), .out_row_last_o(placed_marks[1]), .out_last_o(placed_marks[0]),
    .damaged_o(unused_damaged)
  );

  msn_array_forces #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Health(Health), .Tare(Tare), .RowColumn(RowColumn),
    .Tap(Tap), .GainShift(GainShift), .TareLog2(TareLog2), .FractionBits(FractionBits),
    .BitsPerClock(BitsPerClock)
  ) u_forces (
    .clk_i, .rst_i,
    .cfg_i, .status_o(forces),
    .in_valid_i(placed_valid), .in_ready_o(placed_ready), .in_data_i(scan_data), .in_user_i(scan_user),
    .in_id_i(placed_id), .in_fits_i(placed_marks[2]), .in_row_last_i(placed_marks[1]),
    .in_last_i(placed_marks[0]),
    .sample_valid_o, .sample_ready_i, .sample_data_o, .sample_id_o, .sample_last_o, .sample_mask_o,
    .cop_valid_o, .cop_o, .health_valid_o, .health_ready_i, .health_o
  );

  // Signals that some builds do not use.
  logic unused;
  assign unused = ^{cfg_i, adc_miso_i, adc_busy_i, in_valid_i, in_data_i, in_id_i, in_last_i};

endmodule
