// SPDX-License-Identifier: Apache-2.0
//
// A scanned array from its pins to the centre of pressure, in data-path order.
//
//   lines, ADC pins or stream ─ array_source ─ frame_gate ─ frame_marker ─ condition ─ cop_array ─ x, y, load
//
// Demod: the taxels are read as amplitudes of a carrier (msn_scan_demod), one lane; else Converters lanes. Health = 0
// or Tare = 0 leaves that stage out. With Tare the calibration has gains only: msn_tare has already subtracted each
// taxel's zero. Tap: the forces are an output too. msn_frame_gate lets one frame through at a time, so that settings
// and the frame's time change only between two frames.
// Latency from a scanned frame's last beat: 16 clocks with all stages, the same in every frame.
// Model: model/meissner/twins/cop/array.py

module msn_array #(
  parameter  int unsigned Rows             = 16,
  parameter  int unsigned Columns          = 16,
  parameter  bit          Demod            = 1'b0,
  parameter  bit          Health           = 1'b1,
  parameter  bit          Tare             = 1'b1,
  parameter  int unsigned Part             = msn_pkg::AdcAd7606,  // msn_pkg::adc_part_e
  parameter  int unsigned Converters       = 1,
  parameter  int unsigned Channels         = 8,                   // of each converter; Demod: one
  parameter  int unsigned AdcLanes         = 1,
  parameter  int unsigned ClkKhz           = 25_000,
  parameter  int unsigned SclkKhz          = msn_adc_pkg::sclk_default_khz(Part),
  parameter  int unsigned SettleBits       = 16,
  parameter  int unsigned PeriodBits       = 32,
  parameter  int unsigned Form             = msn_pkg::DemodIq,    // this and the next five: msn_scan_demod
  parameter  int unsigned SamplesPerPeriod = 4,
  parameter  int unsigned SamplePeriod     = 160,
  parameter  int unsigned Periods          = 4,
  parameter  int unsigned Skip             = 4,
  parameter  int unsigned Shift            = 3,
  parameter  bit          RowColumn        = 1'b0,                // gains of rows and columns, not of taxels
  parameter  int unsigned GainShift        = RowColumn ? 24 : 12,
  parameter  int unsigned TareLog2         = 4,
  parameter  int unsigned FractionBits     = 14,
  parameter  int unsigned BitsPerClock     = 2,
  parameter  bit          Tap              = 1'b0,
  localparam int unsigned SampleBits       = 17,
  localparam int unsigned Lanes            = Demod ? 1 : Converters,
  localparam int unsigned ZeroedBits       = Tare ? SampleBits + 1 : SampleBits,
  localparam int unsigned OffsetBits       = ZeroedBits - 32'(RowColumn),
  localparam int unsigned Beats            = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned IdBits           = msn_pkg::index_width(Rows * Beats),
  localparam int unsigned Inputs           = Demod ? 1 : Channels,
  localparam int unsigned GroupBits        = msn_pkg::index_width((Columns + Converters * Inputs - 1)
                                                                  / (Converters * Inputs)),
  localparam int unsigned CountBits        = msn_pkg::index_width(Rows * Columns + 1),
  localparam int unsigned SumBits          = 16 + $clog2(Rows * Columns),
  localparam int unsigned CopBits          = FractionBits + 2
) (
  input  logic                             clk_i,
  input  logic                             rst_i,
  input  logic [47:0]                      now_i,

  input  logic                             cfg_enable_i,         // msn_scan
  input  logic [SettleBits-1:0]            cfg_settle_i,
  input  logic [PeriodBits-1:0]            cfg_period_i,
  input  logic                             cfg_interleave_i,

  input  logic [SampleBits-1:0]            cfg_band_i,           // msn_health
  input  logic [SampleBits-1:0]            cfg_jump_i,
  input  logic signed [SampleBits-1:0]     cfg_low_i,
  input  logic signed [SampleBits-1:0]     cfg_high_i,
  input  logic                             cfg_over_range_enable_i,
  input  logic                             cfg_edges_i,
  input  logic [7:0]                       cfg_still_i,
  input  logic [7:0]                       cfg_rail_i,
  input  logic [7:0]                       cfg_blink_i,
  input  logic                             cfg_clear_i,
  input  logic                             cfg_report_i,

  input  logic [SampleBits-1:0]            cfg_contact_i,        // msn_tare
  input  logic [7:0]                       cfg_step_i,
  input  logic                             cfg_tare_i,
  input  logic                             cfg_force_i,
  input  logic                             cfg_load_i,
  input  logic [Lanes-1:0]                 cfg_zero_write_i,
  input  logic [IdBits-1:0]                cfg_zero_word_i,
  input  logic [SampleBits-1:0]            cfg_zero_i,
  output logic                             cfg_loading_o,

  input  logic [Lanes-1:0]                 cfg_write_i,          // msn_cop_array
  input  logic                             cfg_write_row_i,
  input  logic [IdBits-1:0]                cfg_word_i,
  input  logic [OffsetBits-1:0]            cfg_offset_i,
  input  logic [15:0]                      cfg_gain_i,
  input  logic                             cfg_swap_i,
  output logic                             cfg_swapping_o,
  input  logic [SumBits-1:0]               cfg_min_load_i,       // msn_cop

  output logic [Rows-1:0]                  row_o,
  output logic [GroupBits-1:0]             group_o,
  output logic [Converters-1:0]            adc_cs_n_o,
  output logic [Converters-1:0]            adc_sclk_o,
  output logic [Converters-1:0]            adc_mosi_o,
  input  logic [Converters*AdcLanes-1:0]   adc_miso_i,
  output logic [Converters-1:0]            adc_convst_o,
  input  logic [Converters-1:0]            adc_busy_i,
  output logic [Converters-1:0]            adc_reset_o,
  output logic                             convert_o,

  input  logic                             in_valid_i,           // Part = AdcNone: frames on a stream
  output logic                             in_ready_o,
  input  logic [Lanes*SampleBits-1:0]      in_data_i,
  input  logic [IdBits-1:0]                in_id_i,
  input  logic                             in_last_i,

  input  logic                             cfg_pending_i,        // settings wait
  output logic                             commit_o,             // no frame is under way: settings may change
  input  logic                             busy_i,               // the blocks after the tap hold a beat
  output logic [47:0]                      time_o,               // convert start of the frame under way

  output logic                             tap_valid_o,
  input  logic                             tap_ready_i,
  output logic [Lanes*16-1:0]              tap_data_o,
  output logic [Lanes-1:0]                 tap_mask_o,
  output logic                             tap_row_last_o,
  output logic                             tap_last_o,

  output logic                             out_valid_o,
  input  logic                             out_ready_i,
  output logic signed [CopBits-1:0]        out_x_o,
  output logic signed [CopBits-1:0]        out_y_o,
  output logic [SumBits-1:0]               out_load_o,
  output logic                             out_pressed_o,

  output logic                             event_valid_o,        // msn_health
  input  logic                             event_ready_i,
  output logic [IdBits-1:0]                event_id_o,
  output logic [Lanes-1:0]                 event_dead_o,
  output logic [Lanes-1:0]                 event_railed_o,
  output logic [Lanes-1:0]                 event_blinking_o,
  output logic [CountBits-1:0]             dead_o,
  output logic [CountBits-1:0]             railed_o,
  output logic [CountBits-1:0]             blinking_o,

  output logic                             taring_o,             // msn_tare
  output logic                             pressed_o,
  output logic [15:0]                      tared_o,
  output logic [15:0]                      refused_o,

  output logic [31:0]                      dropped_o,            // msn_scan
  output logic [31:0]                      overrun_o,
  output logic [31:0]                      held_o,
  output logic [31:0]                      lost_o,
  output logic [31:0]                      swallowed_o,          // frames dropped while zeros are loaded
  output logic [31:0]                      damaged_o             // frames that came without a result
);

  logic                        scan_valid, scan_ready, scan_last;
  logic [Lanes*SampleBits-1:0] scan_data;
  logic [IdBits-1:0]           scan_id;
  logic [Lanes-1:0]            scan_user;
  logic [47:0]                 scan_time;
  msn_array_source #(
    .Rows(Rows), .Columns(Columns), .Demod(Demod), .Part(Part), .Converters(Converters), .Channels(Channels),
    .AdcLanes(AdcLanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .SettleBits(SettleBits), .PeriodBits(PeriodBits),
    .Form(Form), .SamplesPerPeriod(SamplesPerPeriod), .SamplePeriod(SamplePeriod), .Periods(Periods),
    .Skip(Skip), .Shift(Shift)
  ) u_source (
    .clk_i, .rst_i,
    .now_i,
    .cfg_enable_i, .cfg_settle_i, .cfg_period_i, .cfg_interleave_i,
    .row_o, .group_o,
    .adc_cs_n_o, .adc_sclk_o, .adc_mosi_o, .adc_miso_i, .adc_convst_o, .adc_busy_i, .adc_reset_o,
    .convert_o,
    .in_valid_i, .in_ready_o, .in_data_i, .in_id_i, .in_last_i,
    .out_valid_o(scan_valid), .out_ready_i(scan_ready), .out_data_o(scan_data), .out_user_o(scan_user),
    .out_id_o(scan_id), .out_last_o(scan_last), .out_time_o(scan_time),
    .dropped_o, .overrun_o, .held_o, .lost_o
  );

  // One frame at a time: the next frame waits until the centre of pressure and the tap's last beat of this one have
  // left and the blocks after the tap are empty. time_o is stable until then.
  logic open_valid, open_ready, open_first, owed, opened;
  msn_frame_gate u_gate (
    .clk_i, .rst_i,
    .pending_i(open_valid || cfg_pending_i), .commit_o, .busy_i(owed || busy_i),
    .in_valid_i(scan_valid), .in_ready_o(scan_ready), .in_last_i(scan_last),
    .out_valid_o(open_valid), .out_ready_i(open_ready), .out_first_o(open_first)
  );
  assign opened = open_valid && open_ready;

  // A damaged frame, or one that msn_tare swallows, gives no result: the change of a counter shows it.
  logic damaged_q, swallowed_q;
  always_ff @(posedge clk_i) begin
    {damaged_q, swallowed_q} <= {damaged_o[0], swallowed_o[0]};
    if (rst_i) {damaged_q, swallowed_q} <= '0;
    if (opened && open_first) time_o <= scan_time;
  end

  logic cop_done, tap_done;
  assign cop_done = (out_valid_o && out_ready_i) || damaged_o[0] != damaged_q;
  assign tap_done = !Tap || (tap_valid_o && tap_ready_i && tap_last_o);
  msn_frame_owed #(.Results(2)) u_owed (
    .clk_i, .rst_i,
    .taken_i(opened), .first_i(open_first), .done_i({tap_done, cop_done}),
    .drop_i(swallowed_o[0] != swallowed_q), .quiet_i(!busy_i && !tap_valid_o && !out_valid_o), .busy_o(owed)
  );

  // Checks and marks each beat once, for all stages downstream.
  logic              placed_valid, placed_ready;
  logic [2:0]        placed_marks;
  logic [IdBits-1:0] placed_id;
  logic [31:0]       unused_damaged;  // msn_cop_accumulate counts these frames
  msn_frame_marker #(.Rows(Rows), .RowBeats(Beats)) u_place (
    .clk_i, .rst_i,
    .in_valid_i(open_valid), .in_ready_o(open_ready), .in_id_i(scan_id), .in_last_i(scan_last),
    .out_valid_o(placed_valid), .out_ready_i(placed_ready), .out_id_o(placed_id),
    .out_fits_o(placed_marks[2]), .out_row_last_o(placed_marks[1]), .out_last_o(placed_marks[0]),
    .damaged_o(unused_damaged)
  );

  // This skid cuts the path of ready from the stages to the scan's buffer.
  logic                        gate_valid, gate_ready;
  logic [2:0]                  gate_marks;
  logic [Lanes*SampleBits-1:0] gate_data;
  logic [IdBits-1:0]           gate_id;
  logic [Lanes-1:0]            gate_user;
  if (Lanes > 1) begin : gen_skid
    msn_skid #(.Width(Lanes * (SampleBits + 1) + IdBits + 3)) u_skid (
      .clk_i, .rst_i,
      .in_valid_i(placed_valid), .in_ready_o(placed_ready),
      .in_data_i({scan_data, scan_user, placed_id, placed_marks}),
      .out_valid_o(gate_valid), .out_ready_i(gate_ready),
      .out_data_o({gate_data, gate_user, gate_id, gate_marks})
    );
  end else begin : gen_no_skid  // a small array: the path is short, and cells are scarce
    assign {gate_valid, placed_ready} = {placed_valid, gate_ready};
    assign {gate_data, gate_user, gate_id, gate_marks} = {scan_data, scan_user, placed_id, placed_marks};
  end

  logic                        zeroed_valid, zeroed_ready;
  logic [Lanes*ZeroedBits-1:0] zeroed_data;
  logic [Lanes-1:0]            zeroed_mask;
  logic [2:0]                  zeroed_marks;
  msn_condition #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(SampleBits), .Health(Health), .Tare(Tare),
    .TareLog2(TareLog2)
  ) u_condition (
    .clk_i, .rst_i,
    .cfg_band_i, .cfg_jump_i, .cfg_low_i, .cfg_high_i, .cfg_over_range_enable_i, .cfg_edges_i, .cfg_still_i,
    .cfg_rail_i,
    .cfg_blink_i, .cfg_clear_i, .cfg_report_i,
    .cfg_contact_i, .cfg_step_i, .cfg_tare_i, .cfg_force_i, .cfg_load_i, .cfg_zero_write_i, .cfg_zero_word_i,
    .cfg_zero_i, .cfg_loading_o,
    .in_valid_i(gate_valid), .in_ready_o(gate_ready), .in_data_i(gate_data), .in_user_i(gate_user),
    .in_id_i(gate_id), .in_fits_i(gate_marks[2]), .in_row_last_i(gate_marks[1]), .in_last_i(gate_marks[0]),
    .out_valid_o(zeroed_valid), .out_ready_i(zeroed_ready), .out_data_o(zeroed_data),
    .out_mask_o(zeroed_mask), .out_fits_o(zeroed_marks[2]), .out_row_last_o(zeroed_marks[1]),
    .out_last_o(zeroed_marks[0]),
    .event_valid_o, .event_ready_i, .event_id_o, .event_dead_o, .event_railed_o, .event_blinking_o,
    .dead_o, .railed_o, .blinking_o,
    .taring_o, .pressed_o, .tared_o, .refused_o, .swallowed_o
  );

  msn_cop_array #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .SampleBits(ZeroedBits), .GainShift(GainShift),
    .Offset(!Tare), .RowColumn(RowColumn), .FractionBits(FractionBits), .BitsPerClock(BitsPerClock), .Tap(Tap)
  ) u_cop_array (
    .clk_i, .rst_i,
    .cfg_write_i, .cfg_write_row_i, .cfg_word_i, .cfg_offset_i, .cfg_gain_i, .cfg_swap_i, .cfg_swapping_o,
    .cfg_min_load_i,
    .in_valid_i(zeroed_valid), .in_ready_o(zeroed_ready), .in_data_i(zeroed_data), .in_mask_i(zeroed_mask),
    .in_fits_i(zeroed_marks[2]), .in_row_last_i(zeroed_marks[1]), .in_last_i(zeroed_marks[0]),
    .tap_valid_o, .tap_ready_i, .tap_data_o, .tap_mask_o, .tap_row_last_o, .tap_last_o,
    .out_valid_o, .out_ready_i, .out_x_o, .out_y_o, .out_load_o, .out_pressed_o,
    .damaged_o
  );

endmodule
