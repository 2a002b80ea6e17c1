// SPDX-License-Identifier: Apache-2.0
//
// The core: one sensor, from its pins to packets. Instances and wires only, in data-path order; what a parameter
// leaves out is not there.
//
//   Array:     scan ─ health ─ tare ─ calibrate ─┬─ cop ────────────────┬─ packet ─ cobs ─ uart
//                                                └─ narrow ─┬─ slip ────┤
//                                                           └─ image ───┘
//   else:      acquire ─ frame_gate ─┬─ slip of each channel (Slip)
//                                    └─ electrodes ─ cop4 ─ cop_slip (Cop4)
//
// Adc = AdcNone: samples come in on the stream, whole frames, an array's Converters lanes wide. Uart = 0: packets
// leave as bytes and the registers' bus is open, for msn_axis. SlipOnly: the small sender of slip events alone.
// Model: model/meissner/core.py

module msn_core #(
  // The sensor and its converters.
  parameter  int unsigned Adc              = msn_pkg::AdcNone,  // msn_pkg::adc_part_e
  parameter  int unsigned Converters       = 1,
  parameter  int unsigned AdcLanes         = 1,
  parameter  int unsigned AdcChannels      = 8,                 // of each converter of an array
  parameter  int unsigned ClkKhz           = 25_000,
  parameter  int unsigned SclkKhz          = msn_adc_pkg::sclk_default_khz(Adc),
  parameter  int unsigned AdcPeriod        = 0,                 // clocks, built in: msn_acquire
  parameter  bit          Array            = 1'b0,
  parameter  int unsigned Rows             = 1,
  parameter  int unsigned Columns          = 1,
  parameter  int unsigned Channels         = 1,                 // where there is no array
  // What is done with it.
  parameter  bit          Demod            = 1'b0,
  parameter  bit          Health           = 1'b0,
  parameter  bit          Tare             = 1'b0,
  parameter  bit          RowColumn        = 1'b0,
  parameter  bit          Slip             = 1'b1,
  parameter  bit          Serial           = 1'b0,
  parameter  bit          Image            = 1'b0,
  parameter  bit          Cop4             = 1'b0,
  parameter  bit          Correct          = 1'b0,
  parameter  bit          CopSlip          = 1'b0,
  parameter  bit          Statistics       = 1'b1,
  parameter  bit          Registers        = 1'b1,
  parameter  bit          Uart             = 1'b1,
  parameter  bit          SlipOnly         = 1'b0,
  // How.
  parameter  int unsigned Level            = 1,
  parameter  int unsigned Window           = 64,
  parameter  int unsigned Hop              = 64,
  parameter  int unsigned TimerBits        = 16,
  parameter  int unsigned SampleBits       = 17,                // narrower for single channels only
  parameter  int unsigned GainShift        = RowColumn ? 24 : 12,  // 4096 and 4096^2 are a gain of 1.0
  parameter  int unsigned TareLog2         = 4,
  parameter  int unsigned FractionBits     = 14,
  parameter  int unsigned BitsPerClock     = 2,
  parameter  int unsigned Form             = msn_pkg::DemodIq,
  parameter  int unsigned SamplesPerPeriod = 4,
  parameter  int unsigned SamplePeriod     = 160,
  parameter  int unsigned Periods          = 4,
  parameter  int unsigned Skip             = 4,
  parameter  int unsigned Shift            = 3,
  parameter  int unsigned Lag              = 16,
  parameter  int unsigned BaudHz           = 3_000_000,
  parameter  int unsigned SlipDepth        = 64,
  parameter  int unsigned StatisticBits    = 22,
  parameter  int unsigned Chunk            = 64,
  parameter  logic [msn_registers_pkg::ResetBits-1:0] Resets = msn_registers_pkg::Reset,
  localparam int unsigned Lanes            = (!Array || Demod) ? 1 : Converters,
  localparam int unsigned RowBeats         = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned Taxels           = Array ? Rows * Columns : Channels,
  localparam int unsigned InIdBits         = msn_pkg::index_width(Array ? Rows * RowBeats : Channels),
  localparam int unsigned Inputs           = Demod ? 1 : AdcChannels,
  localparam int unsigned GroupBits        = msn_pkg::index_width((Columns + Converters * Inputs - 1)
                                                                  / (Converters * Inputs))
) (
  input  logic                            clk_i,
  input  logic                            rst_i,

  output logic [Rows-1:0]                 row_o,
  output logic [GroupBits-1:0]            group_o,
  output logic [Converters-1:0]           adc_cs_n_o,
  output logic [Converters-1:0]           adc_sclk_o,
  output logic [Converters-1:0]           adc_mosi_o,
  input  logic [Converters*AdcLanes-1:0]  adc_miso_i,
  output logic [Converters-1:0]           adc_convst_o,
  input  logic [Converters-1:0]           adc_busy_i,
  output logic [Converters-1:0]           adc_reset_o,
  input  logic                            actuator_moving_i,

  input  logic                            in_valid_i,        // Adc = AdcNone
  output logic                            in_ready_o,
  input  logic [Lanes*SampleBits-1:0]     in_data_i,
  input  logic [InIdBits-1:0]             in_id_i,
  input  logic                            in_last_i,

  output logic                            slip_o,            // of any channel
  output logic                            gross_o,
  output logic                            touched_o,
  output logic                            pressed_o,         // the last centre of pressure

  input  logic                            rx_i,
  output logic                            tx_o,

  input  logic                            bus_valid_i,       // Uart = 0
  input  logic                            bus_write_i,
  input  logic [11:0]                     bus_address_i,
  input  logic [31:0]                     bus_data_i,
  input  logic [3:0]                      bus_strobe_i,
  output logic                            bus_done_o,
  output logic                            bus_error_o,
  output logic [31:0]                     bus_data_o,
  output logic                            out_valid_o,
  input  logic                            out_ready_i,
  output logic [7:0]                      out_data_o,
  output logic                            out_last_o
);

  if (Array && (Cop4 || Serial)) begin : gen_check_array
    $fatal(1, "msn_core: Array = 1 must go without Cop4 and Serial: a core reads one sensor");
  end
  if (Cop4 && (Slip || Channels != 4)) begin : gen_check_cop4
    $fatal(1, "msn_core: Cop4 = 1 must go with Channels = 4 and without Slip (CopSlip is its own)");
  end
  if ((Health || Tare || Demod || RowColumn || Image) && !Array) begin : gen_check_of_array
    $fatal(1, "msn_core: Health, Tare, Demod, RowColumn and Image must go with Array = 1");
  end
  if ((CopSlip || Correct) && !Cop4) begin : gen_check_of_cop4
    $fatal(1, "msn_core: CopSlip and Correct must go with Cop4 = 1");
  end
  if (Array && Columns % Lanes != 0 && (Health || SampleBits != 17)) begin : gen_check_columns
    $fatal(1, "msn_core: Columns = %0d must be a multiple of Converters = %0d", Columns, Converters);
  end
  if (SampleBits > 17 || (SampleBits != 17 && (Array || Cop4))) begin : gen_check_sample_bits
    $fatal(1, "msn_core: SampleBits = %0d must be at most 17, and 17 with Array or Cop4", SampleBits);
  end
  if (SlipOnly && (!Slip || Array || Registers || !Uart)) begin : gen_check_slip_only
    $fatal(1, "msn_core: SlipOnly = 1 must go with Slip and Uart, without Array and Registers");
  end

  localparam int unsigned DetailBits = SampleBits + Level;
  localparam int unsigned ChannelBits = msn_pkg::index_width(Taxels);

  logic [47:0] now;
  always_ff @(posedge clk_i) now <= rst_i ? '0 : now + 1'b1;

  // Registers. A setting is as wide here as the block that takes it: msn_registers holds it at the ends of that, so
  // that nothing here cuts it. OffsetBits, SumBits: of msn_array.
  localparam int unsigned OffsetBits = (Tare ? 18 : 17) - 32'(RowColumn);
  localparam int unsigned SumBits    = 16 + $clog2(Taxels);
  localparam int unsigned GivenBits  = OffsetBits < 17 ? OffsetBits : 17;
  localparam int unsigned LoadBits   = SumBits < 32 ? SumBits : 32;
  localparam int unsigned Beats      = Rows * RowBeats;
  logic        bus_valid, bus_write, bus_done, bus_error;
  logic [11:0] bus_address;
  logic [31:0] bus_question, bus_answer;
  logic [3:0]  bus_strobe;
  logic [9:0]  features;
  assign features = {1'b1, CopSlip, Cop4, Array, Array, Tare, Health, Array && Adc != msn_pkg::AdcNone, Slip,
                     !Array && Adc != msn_pkg::AdcNone};

  logic        cfg_adc_enable, cfg_scan_enable, cfg_interleave, cfg_edges, cfg_user, cfg_clear, cfg_report;
  logic [23:0] cfg_adc_period;
  logic [DetailBits-1:0] cfg_threshold, cfg_gross_threshold, cfg_contact_level, cfg_release_level;
  logic        cfg_contact_rises;
  logic [TimerBits-1:0] cfg_hold, cfg_refractory, cfg_blank;
  logic [DetailBits-1:0] cfg_keep_threshold;
  logic [15:0] cfg_settle;
  logic [31:0] cfg_scan_period;
  logic [LoadBits-1:0] cfg_min_load;
  logic [16:0] cfg_band, cfg_jump, cfg_low, cfg_high, cfg_contact, cfg_zero;
  logic [GivenBits-1:0] cfg_offset;
  logic [7:0]  cfg_still, cfg_rail, cfg_blink, cfg_step, cfg_zero_lanes, cfg_lanes;
  logic        cfg_force, cfg_at_start, cfg_average, cfg_load, cfg_zero_written;
  logic        cfg_written, cfg_row, cfg_swap;
  logic [19:0] cfg_zero_word, cfg_word;
  logic [15:0] cfg_preset, cfg_gain;
  logic [16:0] cop4_rail, cop4_kx, cop4_ky, cop4_kf, cop4_idle, cop4_busy;
  logic [3:0]  cop4_shift_x, cop4_shift_y, cop4_shift_load;
  logic [17:0] cop4_p0, cop4_p1, cop4_p2, cop4_p3, cop4_p4, cop4_p5, cop4_imbalance;
  logic [15:0] cop4_min_load, cop4_top;
  logic [7:0]  cop_slip_drop;
  logic [15:0] cop_slip_move, cop_slip_min_load, cop_slip_hold, cop_slip_refractory;
  logic        cfg_images, commit, slip_pending, cop_pending, cop4_pending, cop_slip_pending;
  logic [31:0] adc_dropped, adc_overrun, adc_timeout, adc_mistagged, adc_over_range;
  logic [31:0] slip_damaged, slip_blanked;
  logic [31:0] scan_dropped, scan_overrun, scan_held, scan_lost, cop_damaged, tare_swallowed;
  logic [20:0] dead_count, railed_count, blinking_count;
  logic        tare_pressed, taring, loading, swapping;
  logic [15:0] tared, refused;
  logic [31:0] packets, cop_dropped, image_dropped, rejected;
  logic [31:0] unused_scratch;
  msn_registers #(
    .Adc      (!Array && Adc != msn_pkg::AdcNone),
    .Slip     (Slip),
    .Scan     (Array && Adc != msn_pkg::AdcNone),
    .Health   (Health),
    .Tare     (Tare),
    .Calibrate(Array),
    .Cop      (Array),
    .Cop4     (Cop4),
    .CopSlip  (CopSlip),
    .Link     (1'b1),
    .Resets   (Resets),
    .DetailBits(DetailBits),
    .TimerBits (TimerBits),
    .LoadBits  (LoadBits),
    .OffsetBits(GivenBits)
  ) u_registers (
    .clk_i,
    .rst_i,
    .bus_valid_i             (bus_valid),
    .bus_write_i             (bus_write),
    .bus_address_i           (bus_address),
    .bus_data_i              (bus_question),
    .bus_strobe_i            (bus_strobe),
    .bus_done_o              (bus_done),
    .bus_error_o             (bus_error),
    .bus_data_o              (bus_answer),
    .core_features_i         (32'(features)),
    .core_size_columns_i     (Array ? 16'(Columns) : 16'(Channels)),
    .core_size_rows_i        (Array ? 16'(Rows) : 16'd1),
    .core_clk_khz_i          (32'(ClkKhz)),
    .core_scratch_o          (unused_scratch),
    .core_widths_detail_i    (8'(DetailBits)),
    .core_widths_timer_i     (8'(TimerBits)),
    .core_widths_load_i      (8'(LoadBits)),
    .core_widths_offset_i    (8'(GivenBits)),
    .core_beats_i            (Array ? 21'(Beats) : 21'd0),
    .adc_enable_o            (cfg_adc_enable),
    .adc_period_o            (cfg_adc_period),
    .adc_dropped_i           (adc_dropped),
    .adc_overrun_i           (adc_overrun),
    .adc_timeout_i           (adc_timeout),
    .adc_mistagged_i         (adc_mistagged),
    .adc_over_range_i        (adc_over_range),
    .slip_commit_i           (commit),
    .slip_pending_o          (slip_pending),
    .slip_threshold_o        (cfg_threshold),
    .slip_gross_threshold_o  (cfg_gross_threshold),
    .slip_contact_level_o    (cfg_contact_level),
    .slip_release_level_o    (cfg_release_level),
    .slip_contact_rises_o    (cfg_contact_rises),
    .slip_hold_o             (cfg_hold),
    .slip_refractory_o       (cfg_refractory),
    .slip_blank_o            (cfg_blank),
    .slip_damaged_i          (slip_damaged),
    .slip_blanked_i          (slip_blanked),
    .slip_keep_threshold_o   (cfg_keep_threshold),
    .scan_enable_o           (cfg_scan_enable),
    .scan_settle_o           (cfg_settle),
    .scan_period_o           (cfg_scan_period),
    .scan_interleave_o       (cfg_interleave),
    .scan_dropped_i          (scan_dropped),
    .scan_overrun_i          (scan_overrun),
    .scan_held_i             (scan_held),
    .scan_lost_i             (scan_lost),
    .health_band_o           (cfg_band),
    .health_jump_o           (cfg_jump),
    .health_low_o            (cfg_low),
    .health_high_o           (cfg_high),
    .health_use_edges_o      (cfg_edges),
    .health_use_user_o       (cfg_user),
    .health_still_o          (cfg_still),
    .health_rail_o           (cfg_rail),
    .health_blink_o          (cfg_blink),
    .health_clear_o          (cfg_clear),
    .health_report_o         (cfg_report),
    .health_dead_i           (dead_count),
    .health_railed_i         (railed_count),
    .health_blinking_i       (blinking_count),
    .tare_contact_o          (cfg_contact),
    .tare_step_o             (cfg_step),
    .tare_force_o            (cfg_force),
    .tare_at_start_o         (cfg_at_start),
    .tare_average_o          (cfg_average),
    .tare_load_o             (cfg_load),
    .tare_word_o             (cfg_zero_word),
    .tare_zero_o             (cfg_zero),
    .tare_write_written_o    (cfg_zero_written),
    .tare_write_o            (cfg_zero_lanes),
    .tare_state_pressed_i    (tare_pressed),
    .tare_state_taring_i     (taring),
    .tare_state_loading_i    (loading),
    .tare_tared_i            (tared),
    .tare_refused_i          (refused),
    .tare_swallowed_i        (tare_swallowed),
    .calibrate_preset_o      (cfg_preset),
    .calibrate_word_o        (cfg_word),
    .calibrate_offset_o      (cfg_offset),
    .calibrate_gain_o        (cfg_gain),
    .calibrate_write_written_o(cfg_written),
    .calibrate_write_row_o   (cfg_row),
    .calibrate_write_lanes_o (cfg_lanes),
    .calibrate_swap_o        (cfg_swap),
    .calibrate_swapping_i    (swapping),
    .cop_commit_i            (commit),
    .cop_pending_o           (cop_pending),
    .cop_min_load_o          (cfg_min_load),
    .cop_damaged_i           (cop_damaged),
    .cop4_commit_i           (commit),
    .cop4_pending_o          (cop4_pending),
    .cop4_rail_o             (cop4_rail),
    .cop4_kx_o               (cop4_kx),
    .cop4_shift_x_o          (cop4_shift_x),
    .cop4_ky_o               (cop4_ky),
    .cop4_shift_y_o          (cop4_shift_y),
    .cop4_kf_o               (cop4_kf),
    .cop4_shift_load_o       (cop4_shift_load),
    .cop4_p0_o               (cop4_p0),
    .cop4_p1_o               (cop4_p1),
    .cop4_p2_o               (cop4_p2),
    .cop4_p3_o               (cop4_p3),
    .cop4_p4_o               (cop4_p4),
    .cop4_p5_o               (cop4_p5),
    .cop4_min_load_o         (cop4_min_load),
    .cop4_top_o              (cop4_top),
    .cop4_idle_o             (cop4_idle),
    .cop4_busy_o             (cop4_busy),
    .cop4_imbalance_o        (cop4_imbalance),
    .cop_slip_commit_i       (commit),
    .cop_slip_pending_o      (cop_slip_pending),
    .cop_slip_drop_o         (cop_slip_drop),
    .cop_slip_move_o         (cop_slip_move),
    .cop_slip_min_load_o     (cop_slip_min_load),
    .cop_slip_hold_o         (cop_slip_hold),
    .cop_slip_refractory_o   (cop_slip_refractory),
    .link_images_o           (cfg_images),
    .link_packets_i          (packets),
    .link_cop_dropped_i      (cop_dropped),
    .link_image_dropped_i    (image_dropped),
    .link_rejected_i         (rejected)
  );

  // Settings of what a build does not have.
  logic unused_settings;
  assign unused_settings = ^{
      cfg_adc_enable, cfg_adc_period, cfg_threshold, cfg_gross_threshold, cfg_contact_level,
      cfg_release_level, cfg_contact_rises, cfg_hold, cfg_refractory, cfg_blank, cfg_scan_enable,
      cfg_keep_threshold, cfg_interleave, cfg_settle,
      cfg_scan_period, cfg_min_load, cfg_band, cfg_jump, cfg_low, cfg_high, cfg_edges, cfg_user, cfg_still,
      cfg_rail, cfg_blink, cfg_clear, cfg_report, cfg_contact, cfg_step, cfg_force, cfg_at_start, cfg_average,
      cfg_load, cfg_zero_word, cfg_zero, cfg_zero_written, cfg_zero_lanes, cfg_preset, cfg_word, cfg_offset,
      cfg_gain, cfg_written, cfg_row, cfg_lanes, cfg_swap, cop4_rail, cop4_kx, cop4_ky, cop4_kf, cop4_idle,
      cop4_busy, cop4_shift_x, cop4_shift_y, cop4_shift_load, cop4_p0, cop4_p1, cop4_p2, cop4_p3, cop4_p4,
      cop4_p5, cop4_imbalance, cop4_min_load, cop4_top, cop_slip_drop, cop_slip_move, cop_slip_min_load,
      cop_slip_hold, cop_slip_refractory, cfg_images};

  logic pending;
  assign pending = slip_pending || cop_pending || cop4_pending || cop_slip_pending;

  // The sensor, up to single samples that the slip path takes, and to the centre of pressure.
  logic                         sample_valid, sample_ready, sample_last, sample_mask, convert;
  logic signed [SampleBits-1:0] sample;
  logic        [ChannelBits-1:0] sample_id;
  logic        [47:0]           frame_time;
  logic                         slip_busy;  // the slip path holds something
  logic                         cop_valid, cop_pressed;
  logic signed [23:0]           cop_x, cop_y;
  logic        [39:0]           cop_load;
  logic                         report_valid, report_ready;
  logic        [23:0]           report_id;
  logic        [7:0]            report_faults;
  logic        decision_valid, decision_ready, decision_raised, decision_last;
  logic [2:0]  decision_state;
  logic [23:0] decision_p2p;
  logic [15:0] decision_id;

  if (Array) begin : gen_array
    localparam int unsigned IdBits     = msn_pkg::index_width(Beats);
    localparam int unsigned CountBits  = msn_pkg::index_width(Rows * Columns + 1);
    localparam int unsigned CopBits    = FractionBits + 2;

    logic signed [GivenBits-1:0]  narrow_offset;
    logic signed [OffsetBits-1:0] given_offset;  // as wide as the table's: behind a tare one bit more
    assign narrow_offset = cfg_offset;
    assign given_offset  = OffsetBits'(narrow_offset);

    // A write to a word that is not there would be one to another word, whose number has the same low bits.
    localparam int unsigned Words = RowColumn ? RowBeats : Beats;
    logic word_there, row_there, zero_there;
    assign word_there = {1'b0, cfg_word} < 21'(Words);
    assign row_there  = {1'b0, cfg_word} < 21'(Rows);
    assign zero_there = {1'b0, cfg_zero_word} < 21'(Beats);

    // A gain from reset on, and a zero as soon as it is in use.
    logic [Lanes-1:0]      write;
    logic                  write_row, swap, started;
    logic [IdBits-1:0]     word;
    logic [OffsetBits-1:0] offset;
    logic [15:0]           gain;
    msn_calibration_preset #(
      .Rows      (Rows),
      .Columns   (Columns),
      .Lanes     (Lanes),
      .OffsetBits(OffsetBits),
      .RowColumn (RowColumn)
    ) u_preset (
      .clk_i,
      .rst_i,
      .cfg_gain_i     (cfg_preset),
      .in_write_i     ((cfg_written && !cfg_row && word_there) ? cfg_lanes[Lanes-1:0] : '0),
      .in_write_row_i (cfg_written && cfg_row && row_there),
      .in_word_i      (cfg_word[IdBits-1:0]),
      .in_offset_i    (given_offset),
      .in_gain_i      (cfg_gain),
      .in_swap_i      (cfg_swap),
      .out_write_o    (write),
      .out_write_row_o(write_row),
      .out_word_o     (word),
      .out_offset_o   (offset),
      .out_gain_o     (gain),
      .out_swap_o     (swap),
      .done_o         (started)
    );

    logic                      tap_valid, tap_ready, tap_last;
    logic [Lanes*16-1:0]       tap_data;
    logic [Lanes-1:0]          tap_mask;
    logic [Lanes*17-1:0]       tap;  // lane by lane, the mask above the force
    logic signed [CopBits-1:0] x, y;
    logic [SumBits-1:0]        load;
    logic                      event_valid, event_ready;
    logic [IdBits-1:0]         event_id;
    logic [Lanes-1:0]          event_dead, event_railed, event_blinking;
    logic [CountBits-1:0]      dead, railed, blinking;
    localparam int unsigned SlipIdBits = msn_pkg::index_width(Inputs);
    logic                  unused_slip_valid, unused_slip_last;
    logic [Lanes*17-1:0]   unused_slip_data;
    logic [SlipIdBits-1:0] unused_slip_id;
    logic [Lanes-1:0]      unused_slip_user;
    logic [31:0]           unused_slip_frame, unused_slip_dropped, unused_slip_overrun;
    logic [47:0]           unused_slip_time;
    msn_array #(
      .Rows            (Rows),
      .Columns         (Columns),
      .Demod           (Demod),
      .Health          (Health),
      .Tare            (Tare),
      .Part            (Adc),
      .Converters      (Converters),
      .Channels        (AdcChannels),
      .AdcLanes        (AdcLanes),
      .ClkKhz          (ClkKhz),
      .SclkKhz         (SclkKhz),
      .Form            (Form),
      .SamplesPerPeriod(SamplesPerPeriod),
      .SamplePeriod    (SamplePeriod),
      .Periods         (Periods),
      .Skip            (Skip),
      .Shift           (Shift),
      .RowColumn       (RowColumn),
      .GainShift       (GainShift),
      .TareLog2        (TareLog2),
      .FractionBits    (FractionBits),
      .BitsPerClock    (BitsPerClock),
      .Tap             (Slip || Image)
    ) u_array (
      .clk_i,
      .rst_i,
      .now_i           (now),
      .cfg_enable_i    (cfg_scan_enable),
      .cfg_settle_i    (cfg_settle),
      .cfg_period_i    (cfg_scan_period),
      .cfg_interleave_i(cfg_interleave),
      .cfg_slip_period_i('0),
      .cfg_slip_row_i  ('0),
      .cfg_slip_group_i('0),
      .cfg_band_i      (cfg_band),
      .cfg_jump_i      (cfg_jump),
      .cfg_low_i       (cfg_low),
      .cfg_high_i      (cfg_high),
      .cfg_user_i      (cfg_user),
      .cfg_edges_i     (cfg_edges),
      .cfg_still_i     (cfg_still),
      .cfg_rail_i      (cfg_rail),
      .cfg_blink_i     (cfg_blink),
      .cfg_clear_i     (cfg_clear),
      .cfg_report_i    (cfg_report),
      .cfg_contact_i   (cfg_contact),
      .cfg_step_i      (cfg_step),
      .cfg_tare_i      (cfg_average || (started && cfg_at_start)),
      .cfg_force_i     (cfg_force || started),
      .cfg_load_i      (cfg_load),
      .cfg_zero_write_i((cfg_zero_written && zero_there) ? cfg_zero_lanes[Lanes-1:0] : '0),
      .cfg_zero_word_i (cfg_zero_word[IdBits-1:0]),
      .cfg_zero_i      (cfg_zero),
      .cfg_loading_o   (loading),
      .cfg_write_i     (write),
      .cfg_write_row_i (write_row),
      .cfg_word_i      (word),
      .cfg_offset_i    (offset),
      .cfg_gain_i      (gain),
      .cfg_swap_i      (swap),
      .cfg_swapping_o  (swapping),
      .cfg_min_load_i  (SumBits'(cfg_min_load)),
      .row_o,
      .group_o,
      .adc_cs_n_o,
      .adc_sclk_o,
      .adc_mosi_o,
      .adc_miso_i,
      .adc_convst_o,
      .adc_busy_i,
      .adc_reset_o,
      .convert_o       (convert),
      .in_valid_i,
      .in_ready_o,
      .in_data_i,
      .in_id_i,
      .in_last_i,
      .cfg_pending_i   (pending),
      .commit_o        (commit),
      .busy_i          (slip_busy),
      .time_o          (frame_time),
      .tap_valid_o     (tap_valid),
      .tap_ready_i     (tap_ready),
      .tap_data_o      (tap_data),
      .tap_mask_o      (tap_mask),
      .tap_last_o      (tap_last),
      .out_valid_o     (cop_valid),
      .out_ready_i     (1'b1),
      .out_x_o         (x),
      .out_y_o         (y),
      .out_load_o      (load),
      .out_pressed_o   (cop_pressed),
      .slip_valid_o    (unused_slip_valid),
      .slip_ready_i    (1'b1),
      .slip_data_o     (unused_slip_data),
      .slip_id_o       (unused_slip_id),
      .slip_last_o     (unused_slip_last),
      .slip_user_o     (unused_slip_user),
      .slip_frame_o    (unused_slip_frame),
      .slip_time_o     (unused_slip_time),
      .event_valid_o   (event_valid),
      .event_ready_i   (event_ready),
      .event_id_o      (event_id),
      .event_dead_o    (event_dead),
      .event_railed_o  (event_railed),
      .event_blinking_o(event_blinking),
      .dead_o          (dead),
      .railed_o        (railed),
      .blinking_o      (blinking),
      .taring_o        (taring),
      .pressed_o       (tare_pressed),
      .tared_o         (tared),
      .refused_o       (refused),
      .dropped_o       (scan_dropped),
      .overrun_o       (scan_overrun),
      .held_o          (scan_held),
      .lost_o          (scan_lost),
      .slip_dropped_o  (unused_slip_dropped),
      .slip_overrun_o  (unused_slip_overrun),
      .swallowed_o     (tare_swallowed),
      .damaged_o       (cop_damaged)
    );

    assign cop_x          = 24'(x);
    assign cop_y          = 24'(y);
    assign cop_load       = 40'(load);
    assign dead_count     = 21'(dead);
    assign railed_count   = 21'(railed);
    assign blinking_count = 21'(blinking);

    msn_health_report #(.IdBits(IdBits), .Lanes(Lanes)) u_health_report (
      .clk_i,
      .rst_i,
      .in_valid_i   (event_valid),
      .in_ready_o   (event_ready),
      .in_id_i      (event_id),
      .in_dead_i    (event_dead),
      .in_railed_i  (event_railed),
      .in_blinking_i(event_blinking),
      .out_valid_o  (report_valid),
      .out_ready_i  (report_ready),
      .out_id_o     (report_id),
      .out_faults_o (report_faults)
    );

    for (genvar k = 0; k < Lanes; k++) begin : gen_lane
      assign tap[17*k+:17] = {tap_mask[k], tap_data[16*k+:16]};
    end
    logic [15:0] force_of_taxel;
    msn_narrow #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes), .DataBits(17)) u_narrow (
      .clk_i,
      .rst_i,
      .in_valid_i (tap_valid),
      .in_ready_o (tap_ready),
      .in_data_i  (tap),
      .in_last_i  (tap_last),
      .out_valid_o(sample_valid),
      .out_ready_i(sample_ready),
      .out_data_o ({sample_mask, force_of_taxel}),
      .out_id_o   (sample_id),
      .out_last_o (sample_last)
    );
    assign sample = {1'b0, force_of_taxel};
    assign {adc_dropped, adc_overrun, adc_timeout, adc_mistagged, adc_over_range} = '0;
    logic unused_array;
    assign unused_array = convert;

  end else begin : gen_channels
    logic                         adc_valid, adc_ready, adc_last;
    logic signed [SampleBits-1:0] adc_data, stream;
    logic [ChannelBits-1:0]       adc_id;
    assign stream = signed'(in_data_i);
    msn_acquire #(
      .Adc       (Adc),
      .AdcLanes  (AdcLanes),
      .ClkKhz    (ClkKhz),
      .SclkKhz   (SclkKhz),
      .AdcPeriod (AdcPeriod),
      .Channels  (Channels),
      .SampleBits(SampleBits)
    ) u_acquire (
      .clk_i,
      .rst_i,
      .cfg_enable_i(cfg_adc_enable),
      .cfg_period_i(cfg_adc_period),
      .adc_cs_n_o  (adc_cs_n_o[0]),
      .adc_sclk_o  (adc_sclk_o[0]),
      .adc_mosi_o  (adc_mosi_o[0]),
      .adc_miso_i  (adc_miso_i[AdcLanes-1:0]),
      .adc_convst_o(adc_convst_o[0]),
      .adc_busy_i  (adc_busy_i[0]),
      .adc_reset_o (adc_reset_o[0]),
      .convert_o   (convert),
      .in_valid_i,
      .in_ready_o,
      .in_data_i   (stream),
      .in_id_i,
      .in_last_i,
      .out_valid_o (adc_valid),
      .out_ready_i (adc_ready),
      .out_data_o  (adc_data),
      .out_id_o    (adc_id),
      .out_last_o  (adc_last),
      .dropped_o   (adc_dropped),
      .overrun_o   (adc_overrun),
      .timeout_o   (adc_timeout),
      .mistagged_o (adc_mistagged),
      .over_range_o(adc_over_range)
    );

    logic gate_valid, gate_ready;
    logic cop4_done, cop4_offers;  // a frame of four electrodes has left; something of it waits at an output
    if (SlipOnly) begin : gen_no_gate  // settings are constants; the sender keeps the time itself
      assign gate_valid = adc_valid;
      assign adc_ready  = gate_ready;
      assign commit     = 1'b0;
      assign frame_time = '0;
      logic unused_gate;
      assign unused_gate = ^{pending, slip_busy, now, cop4_done, cop4_offers};
    end else begin : gen_gate
      logic owed, gate_first;
      msn_frame_gate u_frame_gate (
        .clk_i,
        .rst_i,
        .pending_i  (gate_valid || pending),
        .commit_o   (commit),
        .busy_i     (owed || slip_busy),
        .in_valid_i (adc_valid),
        .in_ready_o (adc_ready),
        .in_last_i  (adc_last),
        .out_valid_o(gate_valid),
        .out_ready_i(gate_ready),
        .out_first_o(gate_first)
      );
      if (Cop4) begin : gen_owed
        msn_frame_owed #(.Results(1)) u_owed (
          .clk_i,
          .rst_i,
          .taken_i(gate_valid && gate_ready),
          .first_i(gate_first),
          .done_i (cop4_done),
          .drop_i (1'b0),
          .quiet_i(!cop4_offers),
          .busy_o (owed)
        );
      end else begin : gen_none_owed  // the slip path itself says when it is empty
        assign owed = 1'b0;
        logic unused_first;
        assign unused_first = ^{gate_first, cop4_done, cop4_offers};
      end
      if (Adc == msn_pkg::AdcNone) begin : gen_stream_time  // as in msn_array
        always_ff @(posedge clk_i) if (gate_valid && gate_ready && gate_first) frame_time <= now;
        logic unused_convert;
        assign unused_convert = convert;
      end else begin : gen_convert_time
        msn_convert_time u_convert_time (
          .clk_i,
          .rst_i,
          .now_i    (now),
          .convert_i(convert),
          .valid_i  (adc_valid),
          .ready_i  (adc_ready),
          .last_i   (adc_last),
          .time_o   (frame_time)
        );
      end
    end

    if (Cop4) begin : gen_cop4
      logic               frame_valid, frame_ready, found_valid, found_ready;
      logic signed [16:0] e1, e2, e3, e4;
      logic signed [15:0] x, y;
      logic        [15:0] load;
      logic               unused_over, unused_saturated, unused_imbalance;
      logic        [3:0]  unused_open;
      msn_electrodes u_electrodes (
        .clk_i,
        .rst_i,
        .in_valid_i (gate_valid),
        .in_ready_o (gate_ready),
        .in_data_i  (adc_data),
        .in_id_i    (adc_id),
        .in_last_i  (adc_last),
        .out_valid_o(frame_valid),
        .out_ready_i(frame_ready),
        .out_e1_o   (e1),
        .out_e2_o   (e2),
        .out_e3_o   (e3),
        .out_e4_o   (e4),
        .damaged_o  (cop_damaged)
      );
      msn_cop4 #(.BitsPerClock(BitsPerClock), .Correct(Correct)) u_cop4 (
        .clk_i,
        .rst_i,
        .cfg_rail_i      (cop4_rail),
        .cfg_kx_i        (cop4_kx),
        .cfg_shift_x_i   (cop4_shift_x),
        .cfg_ky_i        (cop4_ky),
        .cfg_shift_y_i   (cop4_shift_y),
        .cfg_kf_i        (cop4_kf),
        .cfg_shift_load_i(cop4_shift_load),
        .cfg_p_i         ({cop4_p5, cop4_p4, cop4_p3, cop4_p2, cop4_p1, cop4_p0}),
        .cfg_min_load_i  (cop4_min_load),
        .cfg_top_i       (cop4_top),
        .cfg_idle_i      (cop4_idle),
        .cfg_busy_i      (cop4_busy),
        .cfg_imbalance_i (cop4_imbalance),
        .in_valid_i      (frame_valid),
        .in_ready_o      (frame_ready),
        .in_e1_i         (e1),
        .in_e2_i         (e2),
        .in_e3_i         (e3),
        .in_e4_i         (e4),
        .out_valid_o     (found_valid),
        .out_ready_i     (found_ready),
        .out_x_o         (x),
        .out_y_o         (y),
        .out_load_o      (load),
        .out_pressed_o   (cop_pressed),
        .out_over_o      (unused_over),
        .out_saturated_o (unused_saturated),
        .out_imbalance_o (unused_imbalance),
        .out_open_o      (unused_open)
      );
      logic damaged_q;  // a damaged frame gives no result: its counter says so
      always_ff @(posedge clk_i) damaged_q <= rst_i ? 1'b0 : cop_damaged[0];
      assign cop4_done = cop_damaged[0] != damaged_q ||
                         (CopSlip ? decision_valid && decision_ready : cop_valid);
      assign cop4_offers = frame_valid || found_valid || decision_valid;
      assign cop_valid = found_valid && found_ready;
      assign cop_x     = 24'(x);
      assign cop_y     = 24'(y);
      assign cop_load  = 40'(load);

      if (CopSlip) begin : gen_cop_slip
        logic signed [16:0] unused_dx, unused_dy;
        logic               unused_over_load;
        logic        [2:0]  octant;
        logic               slips, raised, slip_valid;
        msn_cop_slip #(.Lag(Lag)) u_cop_slip (
          .clk_i,
          .rst_i,
          .cfg_drop_i      (cop_slip_drop),
          .cfg_move_i      (cop_slip_move),
          .cfg_min_load_i  (cop_slip_min_load),
          .cfg_hold_i      (cop_slip_hold),
          .cfg_refractory_i(cop_slip_refractory),
          .in_valid_i      (found_valid),
          .in_ready_o      (found_ready),
          .in_x_i          (x),
          .in_y_i          (y),
          .in_load_i       (load),
          .in_pressed_i    (cop_pressed),
          .out_valid_o     (slip_valid),
          .out_ready_i     (decision_ready),
          .out_slip_o      (slips),
          .out_raised_o    (raised),
          .out_over_o      (unused_over_load),
          .out_dx_o        (unused_dx),
          .out_dy_o        (unused_dy),
          .out_octant_o    (octant)
        );
        assign decision_valid  = slip_valid;
        assign decision_raised = raised;
        assign decision_state  = slips ? 3'(msn_pkg::Incipient) : 3'(msn_pkg::Contact);
        assign decision_p2p    = 24'(octant);
        assign decision_id     = '1;
        assign decision_last   = 1'b1;
      end else begin : gen_no_cop_slip
        assign found_ready = 1'b1;
      end
      assign {sample_valid, sample, sample_id, sample_last, sample_mask} = '0;
      logic unused_sample;
      assign unused_sample = sample_ready;
    end else begin : gen_no_cop4
      assign sample_valid = gate_valid;
      assign gate_ready   = sample_ready;
      assign sample       = adc_data;
      assign sample_id    = adc_id;
      assign sample_last  = adc_last;
      assign sample_mask  = 1'b0;
      assign {cop_valid, cop_x, cop_y, cop_load, cop_pressed, cop_damaged, cop4_done, cop4_offers} = '0;
    end

    assign {row_o, group_o} = '0;
    assign {report_valid, report_id, report_faults} = '0;
    assign {scan_dropped, scan_overrun, scan_held, scan_lost, tare_swallowed} = '0;
    assign {dead_count, railed_count, blinking_count} = '0;
    assign {tare_pressed, taring, loading, swapping, tared, refused} = '0;
    logic unused_array;
    assign unused_array = report_ready;
  end

  // Slip of every channel or taxel.
  if (Slip) begin : gen_slip
    // A long way back for ready: packet, slip, array, scan. An array's is cut before and behind the slip path.
    logic                         slip_valid, slip_ready, slip_last, slip_mask;
    logic signed [SampleBits-1:0] slip_sample;
    logic        [ChannelBits-1:0] slip_id;
    if (Array) begin : gen_skid
      msn_skid #(.Width(SampleBits + ChannelBits + 2)) u_skid (
        .clk_i,
        .rst_i,
        .in_valid_i (sample_valid),
        .in_ready_o (sample_ready),
        .in_data_i  ({sample, sample_id, sample_last, sample_mask}),
        .out_valid_o(slip_valid),
        .out_ready_i(slip_ready),
        .out_data_o ({slip_sample, slip_id, slip_last, slip_mask})
      );
    end else begin : gen_no_skid
      assign slip_valid   = sample_valid;
      assign sample_ready = slip_ready;
      assign slip_sample  = sample;
      assign slip_id      = sample_id;
      assign slip_last    = sample_last;
      assign slip_mask    = sample_mask;
    end

    // A pin: it changes whenever the actuator does, and every flip-flop that it steers must see the same.
    logic moving;
    msn_sync u_moving (
      .clk_i,
      .in_data_i (actuator_moving_i),
      .out_data_o(moving)
    );

    logic                   found_valid, found_ready, found_raised, found_last;
    logic [2:0]             found_state;
    logic [DetailBits-1:0]  found_p2p, p2p;
    logic [ChannelBits-1:0] found_id, id;
    logic                   unused_over, unused_end, path_busy;
    assign slip_busy = slip_valid || path_busy || decision_valid;
    msn_slip_path #(
      .Channels  (Taxels),
      .SampleBits(SampleBits),
      .Level     (Level),
      .Window    (Window),
      .Hop       (Hop),
      .TimerBits (TimerBits),
      .Mask      (Health),
      .Serial    (Serial)
    ) u_slip_path (
      .clk_i,
      .rst_i,
      .cfg_threshold_i      (cfg_threshold),
      .cfg_gross_threshold_i(cfg_gross_threshold),
      .cfg_contact_level_i  (cfg_contact_level),
      .cfg_release_level_i  (cfg_release_level),
      .cfg_contact_rises_i  (cfg_contact_rises),
      .cfg_hold_i           (cfg_hold),
      .cfg_refractory_i     (cfg_refractory),
      .cfg_blank_i          (cfg_blank),
      .cfg_keep_threshold_i (cfg_keep_threshold),
      .actuator_moving_i    (moving),
      .in_valid_i           (slip_valid),
      .in_ready_o           (slip_ready),
      .in_data_i            (slip_sample),
      .in_id_i              (slip_id),
      .in_last_i            (slip_last),
      .in_mask_i            (slip_mask),
      .out_valid_o          (found_valid),
      .out_ready_i          (found_ready),
      .out_state_o          (found_state),
      .out_raised_o         (found_raised),
      .out_over_o           (unused_over),
      .out_p2p_o            (found_p2p),
      .out_id_o             (found_id),
      .out_last_o           (found_last),
      .out_end_o            (unused_end),
      .busy_o               (path_busy),
      .damaged_o            (slip_damaged),
      .blanked_o            (slip_blanked)
    );
    if (Array && Lanes > 1) begin : gen_decision_skid
      msn_skid #(.Width(DetailBits + ChannelBits + 5)) u_skid (
        .clk_i,
        .rst_i,
        .in_valid_i (found_valid),
        .in_ready_o (found_ready),
        .in_data_i  ({found_state, found_raised, found_last, found_p2p, found_id}),
        .out_valid_o(decision_valid),
        .out_ready_i(decision_ready),
        .out_data_o ({decision_state, decision_raised, decision_last, p2p, id})
      );
    end else begin : gen_no_decision_skid
      assign decision_valid = found_valid;
      assign found_ready    = decision_ready;
      assign {decision_state, decision_raised, decision_last} = {found_state, found_raised, found_last};
      assign {p2p, id}      = {found_p2p, found_id};
    end
    assign decision_p2p = 24'(p2p);
    assign decision_id  = 16'(id);
  end else begin : gen_no_slip
    assign sample_ready = 1'b1;
    assign slip_busy    = 1'b0;
    assign {slip_damaged, slip_blanked} = '0;
    logic unused_slip;
    assign unused_slip = ^{actuator_moving_i, sample, sample_id, sample_mask};
    if (!CopSlip) begin : gen_no_decision
      assign {decision_valid, decision_raised, decision_last, decision_state, decision_p2p, decision_id} = '0;
      logic unused_decision;
      assign unused_decision = ^{decision_last, decision_ready};
    end
  end

  if (Slip || CopSlip) begin : gen_flags
    logic offered;  // the decision is one that the flags have seen: a packet's sender may let it wait
    always_ff @(posedge clk_i) offered <= !rst_i && decision_valid && !decision_ready;
    msn_slip_flags u_flags (
      .clk_i,
      .rst_i,
      .in_valid_i(decision_valid && !offered),
      .in_state_i(decision_state),
      .in_last_i (decision_last),
      .slip_o,
      .gross_o,
      .touched_o
    );
  end else begin : gen_no_flags
    assign {slip_o, gross_o, touched_o} = '0;
  end

  always_ff @(posedge clk_i) begin
    if (cop_valid) pressed_o <= cop_pressed;
    if (rst_i) pressed_o <= 1'b0;
  end

  // Packets, and commands.
  logic slip_event, slip_event_ready, image_valid;
  assign slip_event  = decision_valid && decision_raised;
  assign image_valid = Image && cfg_images && sample_valid && sample_ready;

  localparam int unsigned Counters = Statistics ? 8 : 0;
  localparam int unsigned StatisticsBits = Statistics ? 256 : 32;
  logic [StatisticsBits-1:0] statistics;
  assign statistics = StatisticsBits'({
      rejected, image_dropped, cop_damaged, slip_blanked, slip_damaged,
      Array ? scan_lost : adc_timeout, Array ? scan_overrun : adc_overrun, Array ? scan_dropped : adc_dropped
  });

  if (SlipOnly) begin : gen_slip_only
    logic       packet_begin, packet_valid, packet_ready, packet_last;
    logic [7:0] packet_data;
    msn_packet_slip #(.P2pBits(DetailBits)) u_packet_slip (
      .clk_i,
      .rst_i,
      .convert_i  (convert),
      .in_valid_i (decision_valid),
      .in_ready_o (decision_ready),
      .in_raised_i(decision_raised),
      .in_state_i (decision_state),
      .in_p2p_i   (decision_p2p[DetailBits-1:0]),
      .out_begin_o(packet_begin),
      .out_valid_o(packet_valid),
      .out_ready_i(packet_ready),
      .out_data_o (packet_data),
      .out_last_o (packet_last)
    );
    logic       framed_valid, framed_ready;
    logic [7:0] framed_data;
    msn_cobs #(.MaxBytes(18)) u_cobs (
      .clk_i,
      .rst_i,
      .in_begin_i (packet_begin),
      .in_valid_i (packet_valid),
      .in_ready_o (packet_ready),
      .in_data_i  (packet_data),
      .in_last_i  (packet_last),
      .out_valid_o(framed_valid),
      .out_ready_i(framed_ready),
      .out_data_o (framed_data)
    );
    msn_uart_tx #(.ClkHz(1000 * ClkKhz), .BaudHz(BaudHz)) u_uart_tx (
      .clk_i,
      .rst_i,
      .in_valid_i(framed_valid),
      .in_ready_o(framed_ready),
      .in_data_i (framed_data),
      .tx_o
    );
    assign slip_event_ready = 1'b0;
    assign {packets, cop_dropped, image_dropped, rejected, report_ready} = '0;
    assign {bus_valid, bus_write, bus_address, bus_question, bus_strobe} = '0;
    assign {bus_done_o, bus_error_o, bus_data_o, out_valid_o, out_data_o, out_last_o} = '0;
    logic unused_link;
    assign unused_link = ^{slip_event, slip_event_ready, image_valid, statistics, decision_id, decision_p2p,
                           cop_valid, cop_x, cop_y, cop_load, cop_pressed, report_valid, report_id,
                           report_faults, frame_time, rx_i, bus_valid_i, bus_write_i, bus_address_i,
                           bus_data_i, bus_strobe_i, bus_done, bus_error, bus_answer, out_ready_i};

  end else begin : gen_link
    assign decision_ready = !decision_raised || slip_event_ready;
    msn_link #(
      .ClkHz        (1000 * ClkKhz),
      .BaudHz       (BaudHz),
      .Uart         (Uart),
      .Registers    (Registers),
      .SlipDepth    ((Slip || CopSlip) ? SlipDepth : 0),
      .Cop          (Array || Cop4),
      .Health       (Health),
      .Statistics   (Counters),
      .StatisticBits(StatisticBits),
      .Taxels       (Image ? Taxels : 0),
      .Chunk        (Chunk)
    ) u_link (
      .clk_i,
      .rst_i,
      .rx_i,
      .tx_o,
      .out_valid_o,
      .out_ready_i,
      .out_data_o,
      .out_last_o,
      .host_valid_i   (bus_valid_i),
      .host_write_i   (bus_write_i),
      .host_address_i (bus_address_i),
      .host_data_i    (bus_data_i),
      .host_strobe_i  (bus_strobe_i),
      .host_done_o    (bus_done_o),
      .host_error_o   (bus_error_o),
      .host_data_o    (bus_data_o),
      .bus_valid_o    (bus_valid),
      .bus_write_o    (bus_write),
      .bus_address_o  (bus_address),
      .bus_data_o     (bus_question),
      .bus_strobe_o   (bus_strobe),
      .bus_done_i     (bus_done),
      .bus_error_i    (bus_error),
      .bus_data_i     (bus_answer),
      .now_i          (now),
      .slip_valid_i   (slip_event),
      .slip_ready_o   (slip_event_ready),
      .slip_id_i      (decision_id),
      .slip_state_i   (decision_state),
      .slip_p2p_i     (decision_p2p),
      .slip_time_i    (frame_time),
      .cop_valid_i    (cop_valid),
      .cop_x_i        (cop_x),
      .cop_y_i        (cop_y),
      .cop_load_i     (cop_load),
      .cop_pressed_i  (cop_pressed),
      .cop_time_i     (frame_time),
      .health_valid_i (report_valid),
      .health_ready_o (report_ready),
      .health_id_i    (report_id),
      .health_faults_i(report_faults),
      .statistics_i   (statistics),
      .image_valid_i  (image_valid),
      .image_data_i   (16'(sample)),
      .image_last_i   (sample_last),
      .image_time_i   (frame_time),
      .packets_o      (packets),
      .cop_dropped_o  (cop_dropped),
      .image_dropped_o(image_dropped),
      .rejected_o     (rejected)
    );
  end

endmodule
