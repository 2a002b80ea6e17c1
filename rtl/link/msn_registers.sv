// SPDX-License-Identifier: Apache-2.0
//
// Made by tools/registers.py from rtl/registers.rdl: change that, then `make registers`.
//
// The registers of the core. bus_valid_i for one clock asks; bus_done_o answers two clocks later, once; an
// access is an error, and changes nothing, at an address without a register in this build, at one that is no
// multiple of four, and for a write where all is read-only. bus_strobe_i: the bytes that a write changes. A
// group with commit_i keeps two copies: a read sees what was written, the core what was committed.
// Resets: the reset value of every setting, in the page's order, the first lowest. Without a bus: constants.
// Some settings are wider than the build has bits for. What was written is kept byte by byte; what a read and
// the core get is held at the ends of DetailBits, TimerBits, LoadBits or OffsetBits.
// Model: model/meissner/link/registers.py

// verilog_lint: waive-start line-length

module msn_registers #(
  parameter bit Adc = 1'b1,
  parameter bit Slip = 1'b1,
  parameter bit Scan = 1'b1,
  parameter bit Health = 1'b1,
  parameter bit Tare = 1'b1,
  parameter bit Calibrate = 1'b1,
  parameter bit Cop = 1'b1,
  parameter bit Cop4 = 1'b1,
  parameter bit CopSlip = 1'b1,
  parameter bit Link = 1'b1,
  parameter logic [msn_registers_pkg::ResetBits-1:0] Resets = msn_registers_pkg::Reset,
  parameter int unsigned DetailBits = 20,
  parameter int unsigned TimerBits = 16,
  parameter int unsigned LoadBits = 32,
  parameter int unsigned OffsetBits = 17
) (
  input  logic        clk_i,
  input  logic        rst_i,

  input  logic        bus_valid_i,
  input  logic        bus_write_i,
  input  logic [11:0] bus_address_i,
  input  logic [31:0] bus_data_i,
  input  logic [3:0]  bus_strobe_i,
  output logic        bus_done_o,
  output logic        bus_error_o,
  output logic [31:0] bus_data_o,

  input  logic [31:0] core_features_i,
  input  logic [15:0] core_size_columns_i,
  input  logic [15:0] core_size_rows_i,
  input  logic [31:0] core_clk_khz_i,
  output logic [31:0] core_scratch_o,
  input  logic [7:0]  core_widths_offset_i,
  input  logic [7:0]  core_widths_load_i,
  input  logic [7:0]  core_widths_timer_i,
  input  logic [7:0]  core_widths_detail_i,
  input  logic [20:0] core_beats_i,

  output logic        adc_enable_o,
  output logic [23:0] adc_period_o,
  input  logic [31:0] adc_dropped_i,
  input  logic [31:0] adc_overrun_i,
  input  logic [31:0] adc_timeout_i,
  input  logic [31:0] adc_mistagged_i,
  input  logic [31:0] adc_over_range_i,

  input  logic        slip_commit_i,  // written values take effect
  output logic        slip_pending_o,  // some wait for it
  output logic [DetailBits-1:0] slip_threshold_o,
  output logic [DetailBits-1:0] slip_gross_threshold_o,
  output logic [DetailBits-1:0] slip_contact_level_o,
  output logic [DetailBits-1:0] slip_release_level_o,
  output logic        slip_contact_rises_o,
  output logic [TimerBits-1:0] slip_hold_o,
  output logic [TimerBits-1:0] slip_refractory_o,
  output logic [TimerBits-1:0] slip_blank_o,
  input  logic [31:0] slip_damaged_i,
  input  logic [31:0] slip_blanked_i,
  output logic [DetailBits-1:0] slip_keep_threshold_o,

  output logic        scan_enable_o,
  output logic [15:0] scan_settle_o,
  output logic [31:0] scan_period_o,
  output logic        scan_interleave_o,
  input  logic [31:0] scan_dropped_i,
  input  logic [31:0] scan_overrun_i,
  input  logic [31:0] scan_held_i,
  input  logic [31:0] scan_lost_i,

  output logic [16:0] health_band_o,
  output logic [16:0] health_jump_o,
  output logic [16:0] health_low_o,
  output logic [16:0] health_high_o,
  output logic        health_use_edges_o,
  output logic        health_use_user_o,
  output logic [7:0]  health_still_o,
  output logic [7:0]  health_rail_o,
  output logic [7:0]  health_blink_o,
  output logic        health_clear_o,
  output logic        health_report_o,
  input  logic [20:0] health_dead_i,
  input  logic [20:0] health_railed_i,
  input  logic [20:0] health_blinking_i,

  output logic [16:0] tare_contact_o,
  output logic [7:0]  tare_step_o,
  output logic        tare_force_o,
  output logic        tare_at_start_o,
  output logic        tare_average_o,
  output logic        tare_load_o,
  output logic [19:0] tare_word_o,
  output logic [16:0] tare_zero_o,
  output logic        tare_write_written_o,
  output logic [7:0]  tare_write_o,
  input  logic        tare_state_pressed_i,
  input  logic        tare_state_taring_i,
  input  logic        tare_state_loading_i,
  input  logic [15:0] tare_tared_i,
  input  logic [15:0] tare_refused_i,
  input  logic [31:0] tare_swallowed_i,

  output logic [15:0] calibrate_preset_o,
  output logic [19:0] calibrate_word_o,
  output logic [OffsetBits-1:0] calibrate_offset_o,
  output logic [15:0] calibrate_gain_o,
  output logic        calibrate_write_written_o,
  output logic        calibrate_write_row_o,
  output logic [7:0]  calibrate_write_lanes_o,
  output logic        calibrate_swap_o,
  input  logic        calibrate_swapping_i,

  input  logic        cop_commit_i,  // written values take effect
  output logic        cop_pending_o,  // some wait for it
  output logic [LoadBits-1:0] cop_min_load_o,
  input  logic [31:0] cop_damaged_i,

  input  logic        cop4_commit_i,  // written values take effect
  output logic        cop4_pending_o,  // some wait for it
  output logic [16:0] cop4_rail_o,
  output logic [16:0] cop4_kx_o,
  output logic [3:0]  cop4_shift_x_o,
  output logic [16:0] cop4_ky_o,
  output logic [3:0]  cop4_shift_y_o,
  output logic [16:0] cop4_kf_o,
  output logic [3:0]  cop4_shift_load_o,
  output logic [17:0] cop4_p0_o,
  output logic [17:0] cop4_p1_o,
  output logic [17:0] cop4_p2_o,
  output logic [17:0] cop4_p3_o,
  output logic [17:0] cop4_p4_o,
  output logic [17:0] cop4_p5_o,
  output logic [15:0] cop4_min_load_o,
  output logic [15:0] cop4_top_o,
  output logic [16:0] cop4_idle_o,
  output logic [16:0] cop4_busy_o,
  output logic [17:0] cop4_imbalance_o,

  input  logic        cop_slip_commit_i,  // written values take effect
  output logic        cop_slip_pending_o,  // some wait for it
  output logic [7:0]  cop_slip_drop_o,
  output logic [15:0] cop_slip_move_o,
  output logic [15:0] cop_slip_min_load_o,
  output logic [15:0] cop_slip_hold_o,
  output logic [15:0] cop_slip_refractory_o,

  output logic        link_images_o,
  input  logic [31:0] link_packets_i,
  input  logic [31:0] link_cop_dropped_i,
  input  logic [31:0] link_image_dropped_i,
  input  logic [31:0] link_rejected_i
);

  if (DetailBits < 1 || DetailBits > 20) begin : gen_check_detail_bits
    $fatal(1, "msn_registers: DetailBits = %0d must lie in 1 .. 20", DetailBits);
  end
  if (TimerBits < 1 || TimerBits > 16) begin : gen_check_timer_bits
    $fatal(1, "msn_registers: TimerBits = %0d must lie in 1 .. 16", TimerBits);
  end
  if (LoadBits < 1 || LoadBits > 32) begin : gen_check_load_bits
    $fatal(1, "msn_registers: LoadBits = %0d must lie in 1 .. 32", LoadBits);
  end
  if (OffsetBits < 1 || OffsetBits > 17) begin : gen_check_offset_bits
    $fatal(1, "msn_registers: OffsetBits = %0d must lie in 1 .. 17", OffsetBits);
  end

  logic        write;
  logic [9:0]  word;
  logic [31:0] mask;
  assign write = bus_valid_i && bus_write_i && bus_address_i[1:0] == 2'd0;
  assign word  = bus_address_i[11:2];
  assign mask  = {{8{bus_strobe_i[3]}}, {8{bus_strobe_i[2]}}, {8{bus_strobe_i[1]}}, {8{bus_strobe_i[0]}}};

  logic core_id_hit;
  assign core_id_hit = word == 10'h000;

  logic core_version_hit;
  assign core_version_hit = word == 10'h001;

  logic core_features_hit;
  assign core_features_hit = word == 10'h002;

  logic core_size_hit;
  assign core_size_hit = word == 10'h003;

  logic core_clk_khz_hit;
  assign core_clk_khz_hit = word == 10'h004;

  logic core_scratch_hit, core_scratch_write;
  assign core_scratch_hit = word == 10'h005;
  assign core_scratch_write = core_scratch_hit && write;
  always_ff @(posedge clk_i) begin
    if (core_scratch_write) core_scratch_o <= (core_scratch_o & ~mask[31:0]) | (bus_data_i[31:0] & mask[31:0]);
    if (rst_i) core_scratch_o <= Resets[0+:32];
  end

  logic core_widths_hit;
  assign core_widths_hit = word == 10'h006;

  logic core_beats_hit;
  assign core_beats_hit = word == 10'h007;

  logic adc_enable_hit, adc_enable_write;
  assign adc_enable_hit = Adc && word == 10'h040;
  assign adc_enable_write = adc_enable_hit && write;
  always_ff @(posedge clk_i) begin
    if (adc_enable_write) adc_enable_o <= (adc_enable_o & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) adc_enable_o <= Resets[32];
  end

  logic adc_period_hit, adc_period_write;
  assign adc_period_hit = Adc && word == 10'h041;
  assign adc_period_write = adc_period_hit && write;
  always_ff @(posedge clk_i) begin
    if (adc_period_write) adc_period_o <= (adc_period_o & ~mask[23:0]) | (bus_data_i[23:0] & mask[23:0]);
    if (rst_i) adc_period_o <= Resets[33+:24];
  end

  logic adc_dropped_hit;
  assign adc_dropped_hit = Adc && word == 10'h042;

  logic adc_overrun_hit;
  assign adc_overrun_hit = Adc && word == 10'h043;

  logic adc_timeout_hit;
  assign adc_timeout_hit = Adc && word == 10'h044;

  logic adc_mistagged_hit;
  assign adc_mistagged_hit = Adc && word == 10'h045;

  logic adc_over_range_hit;
  assign adc_over_range_hit = Adc && word == 10'h046;

  logic slip_threshold_hit, slip_threshold_write;
  assign slip_threshold_hit = Slip && word == 10'h080;
  assign slip_threshold_write = slip_threshold_hit && write;
  logic [19:0] slip_threshold_q;
  always_ff @(posedge clk_i) begin
    if (slip_threshold_write) slip_threshold_q <= (slip_threshold_q & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) slip_threshold_q <= Resets[57+:20];
  end
  logic [DetailBits-1:0] slip_threshold_fit;
  assign slip_threshold_fit = ({1'b0, slip_threshold_q} >> DetailBits) == '0 ? DetailBits'(slip_threshold_q) : '1;
  localparam logic [19:0] SlipThresholdReset = Resets[57+:20];
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_threshold_o <= slip_threshold_fit;
    if (rst_i) slip_threshold_o <= ({1'b0, SlipThresholdReset} >> DetailBits) == '0 ? DetailBits'(SlipThresholdReset) : '1;
  end

  logic slip_gross_threshold_hit, slip_gross_threshold_write;
  assign slip_gross_threshold_hit = Slip && word == 10'h081;
  assign slip_gross_threshold_write = slip_gross_threshold_hit && write;
  logic [19:0] slip_gross_threshold_q;
  always_ff @(posedge clk_i) begin
    if (slip_gross_threshold_write) slip_gross_threshold_q <= (slip_gross_threshold_q & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) slip_gross_threshold_q <= Resets[77+:20];
  end
  logic [DetailBits-1:0] slip_gross_threshold_fit;
  assign slip_gross_threshold_fit = ({1'b0, slip_gross_threshold_q} >> DetailBits) == '0 ? DetailBits'(slip_gross_threshold_q) : '1;
  localparam logic [19:0] SlipGrossThresholdReset = Resets[77+:20];
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_gross_threshold_o <= slip_gross_threshold_fit;
    if (rst_i) slip_gross_threshold_o <= ({1'b0, SlipGrossThresholdReset} >> DetailBits) == '0 ? DetailBits'(SlipGrossThresholdReset) : '1;
  end

  logic slip_contact_level_hit, slip_contact_level_write;
  assign slip_contact_level_hit = Slip && word == 10'h082;
  assign slip_contact_level_write = slip_contact_level_hit && write;
  logic [19:0] slip_contact_level_q;
  always_ff @(posedge clk_i) begin
    if (slip_contact_level_write) slip_contact_level_q <= (slip_contact_level_q & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) slip_contact_level_q <= Resets[97+:20];
  end
  logic [DetailBits-1:0] slip_contact_level_fit;
  assign slip_contact_level_fit = (&slip_contact_level_q[19:DetailBits-1] || !(|slip_contact_level_q[19:DetailBits-1])) ? DetailBits'(slip_contact_level_q) : {slip_contact_level_q[19], {(DetailBits-1){!slip_contact_level_q[19]}}};
  localparam logic [19:0] SlipContactLevelReset = Resets[97+:20];
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_contact_level_o <= slip_contact_level_fit;
    if (rst_i) slip_contact_level_o <= (&SlipContactLevelReset[19:DetailBits-1] || !(|SlipContactLevelReset[19:DetailBits-1])) ? DetailBits'(SlipContactLevelReset) : {SlipContactLevelReset[19], {(DetailBits-1){!SlipContactLevelReset[19]}}};
  end

  logic slip_release_level_hit, slip_release_level_write;
  assign slip_release_level_hit = Slip && word == 10'h083;
  assign slip_release_level_write = slip_release_level_hit && write;
  logic [19:0] slip_release_level_q;
  always_ff @(posedge clk_i) begin
    if (slip_release_level_write) slip_release_level_q <= (slip_release_level_q & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) slip_release_level_q <= Resets[117+:20];
  end
  logic [DetailBits-1:0] slip_release_level_fit;
  assign slip_release_level_fit = (&slip_release_level_q[19:DetailBits-1] || !(|slip_release_level_q[19:DetailBits-1])) ? DetailBits'(slip_release_level_q) : {slip_release_level_q[19], {(DetailBits-1){!slip_release_level_q[19]}}};
  localparam logic [19:0] SlipReleaseLevelReset = Resets[117+:20];
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_release_level_o <= slip_release_level_fit;
    if (rst_i) slip_release_level_o <= (&SlipReleaseLevelReset[19:DetailBits-1] || !(|SlipReleaseLevelReset[19:DetailBits-1])) ? DetailBits'(SlipReleaseLevelReset) : {SlipReleaseLevelReset[19], {(DetailBits-1){!SlipReleaseLevelReset[19]}}};
  end

  logic slip_contact_rises_hit, slip_contact_rises_write;
  assign slip_contact_rises_hit = Slip && word == 10'h084;
  assign slip_contact_rises_write = slip_contact_rises_hit && write;
  logic slip_contact_rises_q;
  always_ff @(posedge clk_i) begin
    if (slip_contact_rises_write) slip_contact_rises_q <= (slip_contact_rises_q & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) slip_contact_rises_q <= Resets[137];
  end
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_contact_rises_o <= slip_contact_rises_q;
    if (rst_i) slip_contact_rises_o <= Resets[137];
  end

  logic slip_hold_hit, slip_hold_write;
  assign slip_hold_hit = Slip && word == 10'h085;
  assign slip_hold_write = slip_hold_hit && write;
  logic [15:0] slip_hold_q;
  always_ff @(posedge clk_i) begin
    if (slip_hold_write) slip_hold_q <= (slip_hold_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) slip_hold_q <= Resets[138+:16];
  end
  logic [TimerBits-1:0] slip_hold_fit;
  assign slip_hold_fit = ({1'b0, slip_hold_q} >> TimerBits) == '0 ? TimerBits'(slip_hold_q) : '1;
  localparam logic [15:0] SlipHoldReset = Resets[138+:16];
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_hold_o <= slip_hold_fit;
    if (rst_i) slip_hold_o <= ({1'b0, SlipHoldReset} >> TimerBits) == '0 ? TimerBits'(SlipHoldReset) : '1;
  end

  logic slip_refractory_hit, slip_refractory_write;
  assign slip_refractory_hit = Slip && word == 10'h086;
  assign slip_refractory_write = slip_refractory_hit && write;
  logic [15:0] slip_refractory_q;
  always_ff @(posedge clk_i) begin
    if (slip_refractory_write) slip_refractory_q <= (slip_refractory_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) slip_refractory_q <= Resets[154+:16];
  end
  logic [TimerBits-1:0] slip_refractory_fit;
  assign slip_refractory_fit = ({1'b0, slip_refractory_q} >> TimerBits) == '0 ? TimerBits'(slip_refractory_q) : '1;
  localparam logic [15:0] SlipRefractoryReset = Resets[154+:16];
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_refractory_o <= slip_refractory_fit;
    if (rst_i) slip_refractory_o <= ({1'b0, SlipRefractoryReset} >> TimerBits) == '0 ? TimerBits'(SlipRefractoryReset) : '1;
  end

  logic slip_blank_hit, slip_blank_write;
  assign slip_blank_hit = Slip && word == 10'h087;
  assign slip_blank_write = slip_blank_hit && write;
  logic [15:0] slip_blank_q;
  always_ff @(posedge clk_i) begin
    if (slip_blank_write) slip_blank_q <= (slip_blank_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) slip_blank_q <= Resets[170+:16];
  end
  logic [TimerBits-1:0] slip_blank_fit;
  assign slip_blank_fit = ({1'b0, slip_blank_q} >> TimerBits) == '0 ? TimerBits'(slip_blank_q) : '1;
  localparam logic [15:0] SlipBlankReset = Resets[170+:16];
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_blank_o <= slip_blank_fit;
    if (rst_i) slip_blank_o <= ({1'b0, SlipBlankReset} >> TimerBits) == '0 ? TimerBits'(SlipBlankReset) : '1;
  end

  logic slip_damaged_hit;
  assign slip_damaged_hit = Slip && word == 10'h088;

  logic slip_blanked_hit;
  assign slip_blanked_hit = Slip && word == 10'h089;

  logic slip_keep_threshold_hit, slip_keep_threshold_write;
  assign slip_keep_threshold_hit = Slip && word == 10'h08a;
  assign slip_keep_threshold_write = slip_keep_threshold_hit && write;
  logic [19:0] slip_keep_threshold_q;
  always_ff @(posedge clk_i) begin
    if (slip_keep_threshold_write) slip_keep_threshold_q <= (slip_keep_threshold_q & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) slip_keep_threshold_q <= Resets[186+:20];
  end
  logic [DetailBits-1:0] slip_keep_threshold_fit;
  assign slip_keep_threshold_fit = ({1'b0, slip_keep_threshold_q} >> DetailBits) == '0 ? DetailBits'(slip_keep_threshold_q) : '1;
  localparam logic [19:0] SlipKeepThresholdReset = Resets[186+:20];
  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_keep_threshold_o <= slip_keep_threshold_fit;
    if (rst_i) slip_keep_threshold_o <= ({1'b0, SlipKeepThresholdReset} >> DetailBits) == '0 ? DetailBits'(SlipKeepThresholdReset) : '1;
  end

  always_ff @(posedge clk_i) begin
    if (slip_commit_i) slip_pending_o <= 1'b0;
    if (slip_threshold_write || slip_gross_threshold_write || slip_contact_level_write || slip_release_level_write || slip_contact_rises_write || slip_hold_write || slip_refractory_write || slip_blank_write || slip_keep_threshold_write) slip_pending_o <= 1'b1;
    if (rst_i) slip_pending_o <= 1'b0;
  end

  logic scan_enable_hit, scan_enable_write;
  assign scan_enable_hit = Scan && word == 10'h0c0;
  assign scan_enable_write = scan_enable_hit && write;
  always_ff @(posedge clk_i) begin
    if (scan_enable_write) scan_enable_o <= (scan_enable_o & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) scan_enable_o <= Resets[206];
  end

  logic scan_settle_hit, scan_settle_write;
  assign scan_settle_hit = Scan && word == 10'h0c1;
  assign scan_settle_write = scan_settle_hit && write;
  always_ff @(posedge clk_i) begin
    if (scan_settle_write) scan_settle_o <= (scan_settle_o & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) scan_settle_o <= Resets[207+:16];
  end

  logic scan_period_hit, scan_period_write;
  assign scan_period_hit = Scan && word == 10'h0c2;
  assign scan_period_write = scan_period_hit && write;
  always_ff @(posedge clk_i) begin
    if (scan_period_write) scan_period_o <= (scan_period_o & ~mask[31:0]) | (bus_data_i[31:0] & mask[31:0]);
    if (rst_i) scan_period_o <= Resets[223+:32];
  end

  logic scan_interleave_hit, scan_interleave_write;
  assign scan_interleave_hit = Scan && word == 10'h0c3;
  assign scan_interleave_write = scan_interleave_hit && write;
  always_ff @(posedge clk_i) begin
    if (scan_interleave_write) scan_interleave_o <= (scan_interleave_o & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) scan_interleave_o <= Resets[255];
  end

  logic scan_dropped_hit;
  assign scan_dropped_hit = Scan && word == 10'h0c4;

  logic scan_overrun_hit;
  assign scan_overrun_hit = Scan && word == 10'h0c5;

  logic scan_held_hit;
  assign scan_held_hit = Scan && word == 10'h0c6;

  logic scan_lost_hit;
  assign scan_lost_hit = Scan && word == 10'h0c7;

  logic health_band_hit, health_band_write;
  assign health_band_hit = Health && word == 10'h100;
  assign health_band_write = health_band_hit && write;
  always_ff @(posedge clk_i) begin
    if (health_band_write) health_band_o <= (health_band_o & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) health_band_o <= Resets[256+:17];
  end

  logic health_jump_hit, health_jump_write;
  assign health_jump_hit = Health && word == 10'h101;
  assign health_jump_write = health_jump_hit && write;
  always_ff @(posedge clk_i) begin
    if (health_jump_write) health_jump_o <= (health_jump_o & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) health_jump_o <= Resets[273+:17];
  end

  logic health_low_hit, health_low_write;
  assign health_low_hit = Health && word == 10'h102;
  assign health_low_write = health_low_hit && write;
  always_ff @(posedge clk_i) begin
    if (health_low_write) health_low_o <= (health_low_o & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) health_low_o <= Resets[290+:17];
  end

  logic health_high_hit, health_high_write;
  assign health_high_hit = Health && word == 10'h103;
  assign health_high_write = health_high_hit && write;
  always_ff @(posedge clk_i) begin
    if (health_high_write) health_high_o <= (health_high_o & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) health_high_o <= Resets[307+:17];
  end

  logic health_use_hit, health_use_write;
  assign health_use_hit = Health && word == 10'h104;
  assign health_use_write = health_use_hit && write;
  always_ff @(posedge clk_i) begin
    if (health_use_write) health_use_edges_o <= (health_use_edges_o & ~mask[1]) | (bus_data_i[1] & mask[1]);
    if (rst_i) health_use_edges_o <= Resets[325];
  end
  always_ff @(posedge clk_i) begin
    if (health_use_write) health_use_user_o <= (health_use_user_o & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) health_use_user_o <= Resets[324];
  end

  logic health_still_hit, health_still_write;
  assign health_still_hit = Health && word == 10'h105;
  assign health_still_write = health_still_hit && write;
  always_ff @(posedge clk_i) begin
    if (health_still_write) health_still_o <= (health_still_o & ~mask[7:0]) | (bus_data_i[7:0] & mask[7:0]);
    if (rst_i) health_still_o <= Resets[326+:8];
  end

  logic health_rail_hit, health_rail_write;
  assign health_rail_hit = Health && word == 10'h106;
  assign health_rail_write = health_rail_hit && write;
  always_ff @(posedge clk_i) begin
    if (health_rail_write) health_rail_o <= (health_rail_o & ~mask[7:0]) | (bus_data_i[7:0] & mask[7:0]);
    if (rst_i) health_rail_o <= Resets[334+:8];
  end

  logic health_blink_hit, health_blink_write;
  assign health_blink_hit = Health && word == 10'h107;
  assign health_blink_write = health_blink_hit && write;
  always_ff @(posedge clk_i) begin
    if (health_blink_write) health_blink_o <= (health_blink_o & ~mask[7:0]) | (bus_data_i[7:0] & mask[7:0]);
    if (rst_i) health_blink_o <= Resets[342+:8];
  end

  logic health_clear_hit, health_clear_write;
  assign health_clear_hit = Health && word == 10'h108;
  assign health_clear_write = health_clear_hit && write;
  always_ff @(posedge clk_i) begin
    health_clear_o <= health_clear_write && mask[0] && bus_data_i[0];
    if (rst_i) health_clear_o <= 1'b0;
  end

  logic health_report_hit, health_report_write;
  assign health_report_hit = Health && word == 10'h109;
  assign health_report_write = health_report_hit && write;
  always_ff @(posedge clk_i) begin
    health_report_o <= health_report_write && mask[0] && bus_data_i[0];
    if (rst_i) health_report_o <= 1'b0;
  end

  logic health_dead_hit;
  assign health_dead_hit = Health && word == 10'h10a;

  logic health_railed_hit;
  assign health_railed_hit = Health && word == 10'h10b;

  logic health_blinking_hit;
  assign health_blinking_hit = Health && word == 10'h10c;

  logic tare_contact_hit, tare_contact_write;
  assign tare_contact_hit = Tare && word == 10'h120;
  assign tare_contact_write = tare_contact_hit && write;
  always_ff @(posedge clk_i) begin
    if (tare_contact_write) tare_contact_o <= (tare_contact_o & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) tare_contact_o <= Resets[350+:17];
  end

  logic tare_step_hit, tare_step_write;
  assign tare_step_hit = Tare && word == 10'h121;
  assign tare_step_write = tare_step_hit && write;
  always_ff @(posedge clk_i) begin
    if (tare_step_write) tare_step_o <= (tare_step_o & ~mask[7:0]) | (bus_data_i[7:0] & mask[7:0]);
    if (rst_i) tare_step_o <= Resets[367+:8];
  end

  logic tare_force_hit, tare_force_write;
  assign tare_force_hit = Tare && word == 10'h122;
  assign tare_force_write = tare_force_hit && write;
  always_ff @(posedge clk_i) begin
    if (tare_force_write) tare_force_o <= (tare_force_o & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) tare_force_o <= Resets[375];
  end

  logic tare_at_start_hit, tare_at_start_write;
  assign tare_at_start_hit = Tare && word == 10'h123;
  assign tare_at_start_write = tare_at_start_hit && write;
  always_ff @(posedge clk_i) begin
    if (tare_at_start_write) tare_at_start_o <= (tare_at_start_o & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) tare_at_start_o <= Resets[376];
  end

  logic tare_average_hit, tare_average_write;
  assign tare_average_hit = Tare && word == 10'h124;
  assign tare_average_write = tare_average_hit && write;
  always_ff @(posedge clk_i) begin
    tare_average_o <= tare_average_write && mask[0] && bus_data_i[0];
    if (rst_i) tare_average_o <= 1'b0;
  end

  logic tare_load_hit, tare_load_write;
  assign tare_load_hit = Tare && word == 10'h125;
  assign tare_load_write = tare_load_hit && write;
  always_ff @(posedge clk_i) begin
    if (tare_load_write) tare_load_o <= (tare_load_o & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) tare_load_o <= Resets[377];
  end

  logic tare_word_hit, tare_word_write;
  assign tare_word_hit = Tare && word == 10'h126;
  assign tare_word_write = tare_word_hit && write;
  always_ff @(posedge clk_i) begin
    if (tare_word_write) tare_word_o <= (tare_word_o & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) tare_word_o <= Resets[378+:20];
  end

  logic tare_zero_hit, tare_zero_write;
  assign tare_zero_hit = Tare && word == 10'h127;
  assign tare_zero_write = tare_zero_hit && write;
  always_ff @(posedge clk_i) begin
    if (tare_zero_write) tare_zero_o <= (tare_zero_o & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) tare_zero_o <= Resets[398+:17];
  end

  logic tare_write_hit, tare_write_write;
  assign tare_write_hit = Tare && word == 10'h128;
  assign tare_write_write = tare_write_hit && write;
  always_ff @(posedge clk_i) begin
    tare_write_written_o <= tare_write_write;
    if (rst_i) tare_write_written_o <= 1'b0;
  end
  always_ff @(posedge clk_i) begin
    if (tare_write_write) tare_write_o <= (tare_write_o & ~mask[7:0]) | (bus_data_i[7:0] & mask[7:0]);
    if (rst_i) tare_write_o <= Resets[415+:8];
  end

  logic tare_state_hit;
  assign tare_state_hit = Tare && word == 10'h129;

  logic tare_tared_hit;
  assign tare_tared_hit = Tare && word == 10'h12a;

  logic tare_refused_hit;
  assign tare_refused_hit = Tare && word == 10'h12b;

  logic tare_swallowed_hit;
  assign tare_swallowed_hit = Tare && word == 10'h12c;

  logic calibrate_preset_hit, calibrate_preset_write;
  assign calibrate_preset_hit = Calibrate && word == 10'h140;
  assign calibrate_preset_write = calibrate_preset_hit && write;
  always_ff @(posedge clk_i) begin
    if (calibrate_preset_write) calibrate_preset_o <= (calibrate_preset_o & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) calibrate_preset_o <= Resets[423+:16];
  end

  logic calibrate_word_hit, calibrate_word_write;
  assign calibrate_word_hit = Calibrate && word == 10'h141;
  assign calibrate_word_write = calibrate_word_hit && write;
  always_ff @(posedge clk_i) begin
    if (calibrate_word_write) calibrate_word_o <= (calibrate_word_o & ~mask[19:0]) | (bus_data_i[19:0] & mask[19:0]);
    if (rst_i) calibrate_word_o <= Resets[439+:20];
  end

  logic calibrate_offset_hit, calibrate_offset_write;
  assign calibrate_offset_hit = Calibrate && word == 10'h142;
  assign calibrate_offset_write = calibrate_offset_hit && write;
  logic [16:0] calibrate_offset_q;
  always_ff @(posedge clk_i) begin
    if (calibrate_offset_write) calibrate_offset_q <= (calibrate_offset_q & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) calibrate_offset_q <= Resets[459+:17];
  end
  logic [OffsetBits-1:0] calibrate_offset_fit;
  assign calibrate_offset_fit = (&calibrate_offset_q[16:OffsetBits-1] || !(|calibrate_offset_q[16:OffsetBits-1])) ? OffsetBits'(calibrate_offset_q) : {calibrate_offset_q[16], {(OffsetBits-1){!calibrate_offset_q[16]}}};
  assign calibrate_offset_o = calibrate_offset_fit;

  logic calibrate_gain_hit, calibrate_gain_write;
  assign calibrate_gain_hit = Calibrate && word == 10'h143;
  assign calibrate_gain_write = calibrate_gain_hit && write;
  always_ff @(posedge clk_i) begin
    if (calibrate_gain_write) calibrate_gain_o <= (calibrate_gain_o & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) calibrate_gain_o <= Resets[476+:16];
  end

  logic calibrate_write_hit, calibrate_write_write;
  assign calibrate_write_hit = Calibrate && word == 10'h144;
  assign calibrate_write_write = calibrate_write_hit && write;
  always_ff @(posedge clk_i) begin
    calibrate_write_written_o <= calibrate_write_write;
    if (rst_i) calibrate_write_written_o <= 1'b0;
  end
  always_ff @(posedge clk_i) begin
    if (calibrate_write_write) calibrate_write_row_o <= (calibrate_write_row_o & ~mask[8]) | (bus_data_i[8] & mask[8]);
    if (rst_i) calibrate_write_row_o <= Resets[500];
  end
  always_ff @(posedge clk_i) begin
    if (calibrate_write_write) calibrate_write_lanes_o <= (calibrate_write_lanes_o & ~mask[7:0]) | (bus_data_i[7:0] & mask[7:0]);
    if (rst_i) calibrate_write_lanes_o <= Resets[492+:8];
  end

  logic calibrate_swap_hit, calibrate_swap_write;
  assign calibrate_swap_hit = Calibrate && word == 10'h145;
  assign calibrate_swap_write = calibrate_swap_hit && write;
  always_ff @(posedge clk_i) begin
    calibrate_swap_o <= calibrate_swap_write && mask[0] && bus_data_i[0];
    if (rst_i) calibrate_swap_o <= 1'b0;
  end

  logic calibrate_swapping_hit;
  assign calibrate_swapping_hit = Calibrate && word == 10'h146;

  logic cop_min_load_hit, cop_min_load_write;
  assign cop_min_load_hit = Cop && word == 10'h180;
  assign cop_min_load_write = cop_min_load_hit && write;
  logic [31:0] cop_min_load_q;
  always_ff @(posedge clk_i) begin
    if (cop_min_load_write) cop_min_load_q <= (cop_min_load_q & ~mask[31:0]) | (bus_data_i[31:0] & mask[31:0]);
    if (rst_i) cop_min_load_q <= Resets[501+:32];
  end
  logic [LoadBits-1:0] cop_min_load_fit;
  assign cop_min_load_fit = ({1'b0, cop_min_load_q} >> LoadBits) == '0 ? LoadBits'(cop_min_load_q) : '1;
  localparam logic [31:0] CopMinLoadReset = Resets[501+:32];
  always_ff @(posedge clk_i) begin
    if (cop_commit_i) cop_min_load_o <= cop_min_load_fit;
    if (rst_i) cop_min_load_o <= ({1'b0, CopMinLoadReset} >> LoadBits) == '0 ? LoadBits'(CopMinLoadReset) : '1;
  end

  logic cop_damaged_hit;
  assign cop_damaged_hit = Cop && word == 10'h181;

  always_ff @(posedge clk_i) begin
    if (cop_commit_i) cop_pending_o <= 1'b0;
    if (cop_min_load_write) cop_pending_o <= 1'b1;
    if (rst_i) cop_pending_o <= 1'b0;
  end

  logic cop4_rail_hit, cop4_rail_write;
  assign cop4_rail_hit = Cop4 && word == 10'h1c0;
  assign cop4_rail_write = cop4_rail_hit && write;
  logic [16:0] cop4_rail_q;
  always_ff @(posedge clk_i) begin
    if (cop4_rail_write) cop4_rail_q <= (cop4_rail_q & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) cop4_rail_q <= Resets[533+:17];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_rail_o <= cop4_rail_q;
    if (rst_i) cop4_rail_o <= Resets[533+:17];
  end

  logic cop4_kx_hit, cop4_kx_write;
  assign cop4_kx_hit = Cop4 && word == 10'h1c1;
  assign cop4_kx_write = cop4_kx_hit && write;
  logic [16:0] cop4_kx_q;
  always_ff @(posedge clk_i) begin
    if (cop4_kx_write) cop4_kx_q <= (cop4_kx_q & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) cop4_kx_q <= Resets[550+:17];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_kx_o <= cop4_kx_q;
    if (rst_i) cop4_kx_o <= Resets[550+:17];
  end

  logic cop4_shift_x_hit, cop4_shift_x_write;
  assign cop4_shift_x_hit = Cop4 && word == 10'h1c2;
  assign cop4_shift_x_write = cop4_shift_x_hit && write;
  logic [3:0] cop4_shift_x_q;
  always_ff @(posedge clk_i) begin
    if (cop4_shift_x_write) cop4_shift_x_q <= (cop4_shift_x_q & ~mask[3:0]) | (bus_data_i[3:0] & mask[3:0]);
    if (rst_i) cop4_shift_x_q <= Resets[567+:4];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_shift_x_o <= cop4_shift_x_q;
    if (rst_i) cop4_shift_x_o <= Resets[567+:4];
  end

  logic cop4_ky_hit, cop4_ky_write;
  assign cop4_ky_hit = Cop4 && word == 10'h1c3;
  assign cop4_ky_write = cop4_ky_hit && write;
  logic [16:0] cop4_ky_q;
  always_ff @(posedge clk_i) begin
    if (cop4_ky_write) cop4_ky_q <= (cop4_ky_q & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) cop4_ky_q <= Resets[571+:17];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_ky_o <= cop4_ky_q;
    if (rst_i) cop4_ky_o <= Resets[571+:17];
  end

  logic cop4_shift_y_hit, cop4_shift_y_write;
  assign cop4_shift_y_hit = Cop4 && word == 10'h1c4;
  assign cop4_shift_y_write = cop4_shift_y_hit && write;
  logic [3:0] cop4_shift_y_q;
  always_ff @(posedge clk_i) begin
    if (cop4_shift_y_write) cop4_shift_y_q <= (cop4_shift_y_q & ~mask[3:0]) | (bus_data_i[3:0] & mask[3:0]);
    if (rst_i) cop4_shift_y_q <= Resets[588+:4];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_shift_y_o <= cop4_shift_y_q;
    if (rst_i) cop4_shift_y_o <= Resets[588+:4];
  end

  logic cop4_kf_hit, cop4_kf_write;
  assign cop4_kf_hit = Cop4 && word == 10'h1c5;
  assign cop4_kf_write = cop4_kf_hit && write;
  logic [16:0] cop4_kf_q;
  always_ff @(posedge clk_i) begin
    if (cop4_kf_write) cop4_kf_q <= (cop4_kf_q & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) cop4_kf_q <= Resets[592+:17];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_kf_o <= cop4_kf_q;
    if (rst_i) cop4_kf_o <= Resets[592+:17];
  end

  logic cop4_shift_load_hit, cop4_shift_load_write;
  assign cop4_shift_load_hit = Cop4 && word == 10'h1c6;
  assign cop4_shift_load_write = cop4_shift_load_hit && write;
  logic [3:0] cop4_shift_load_q;
  always_ff @(posedge clk_i) begin
    if (cop4_shift_load_write) cop4_shift_load_q <= (cop4_shift_load_q & ~mask[3:0]) | (bus_data_i[3:0] & mask[3:0]);
    if (rst_i) cop4_shift_load_q <= Resets[609+:4];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_shift_load_o <= cop4_shift_load_q;
    if (rst_i) cop4_shift_load_o <= Resets[609+:4];
  end

  logic cop4_p0_hit, cop4_p0_write;
  assign cop4_p0_hit = Cop4 && word == 10'h1c7;
  assign cop4_p0_write = cop4_p0_hit && write;
  logic [17:0] cop4_p0_q;
  always_ff @(posedge clk_i) begin
    if (cop4_p0_write) cop4_p0_q <= (cop4_p0_q & ~mask[17:0]) | (bus_data_i[17:0] & mask[17:0]);
    if (rst_i) cop4_p0_q <= Resets[613+:18];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_p0_o <= cop4_p0_q;
    if (rst_i) cop4_p0_o <= Resets[613+:18];
  end

  logic cop4_p1_hit, cop4_p1_write;
  assign cop4_p1_hit = Cop4 && word == 10'h1c8;
  assign cop4_p1_write = cop4_p1_hit && write;
  logic [17:0] cop4_p1_q;
  always_ff @(posedge clk_i) begin
    if (cop4_p1_write) cop4_p1_q <= (cop4_p1_q & ~mask[17:0]) | (bus_data_i[17:0] & mask[17:0]);
    if (rst_i) cop4_p1_q <= Resets[631+:18];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_p1_o <= cop4_p1_q;
    if (rst_i) cop4_p1_o <= Resets[631+:18];
  end

  logic cop4_p2_hit, cop4_p2_write;
  assign cop4_p2_hit = Cop4 && word == 10'h1c9;
  assign cop4_p2_write = cop4_p2_hit && write;
  logic [17:0] cop4_p2_q;
  always_ff @(posedge clk_i) begin
    if (cop4_p2_write) cop4_p2_q <= (cop4_p2_q & ~mask[17:0]) | (bus_data_i[17:0] & mask[17:0]);
    if (rst_i) cop4_p2_q <= Resets[649+:18];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_p2_o <= cop4_p2_q;
    if (rst_i) cop4_p2_o <= Resets[649+:18];
  end

  logic cop4_p3_hit, cop4_p3_write;
  assign cop4_p3_hit = Cop4 && word == 10'h1ca;
  assign cop4_p3_write = cop4_p3_hit && write;
  logic [17:0] cop4_p3_q;
  always_ff @(posedge clk_i) begin
    if (cop4_p3_write) cop4_p3_q <= (cop4_p3_q & ~mask[17:0]) | (bus_data_i[17:0] & mask[17:0]);
    if (rst_i) cop4_p3_q <= Resets[667+:18];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_p3_o <= cop4_p3_q;
    if (rst_i) cop4_p3_o <= Resets[667+:18];
  end

  logic cop4_p4_hit, cop4_p4_write;
  assign cop4_p4_hit = Cop4 && word == 10'h1cb;
  assign cop4_p4_write = cop4_p4_hit && write;
  logic [17:0] cop4_p4_q;
  always_ff @(posedge clk_i) begin
    if (cop4_p4_write) cop4_p4_q <= (cop4_p4_q & ~mask[17:0]) | (bus_data_i[17:0] & mask[17:0]);
    if (rst_i) cop4_p4_q <= Resets[685+:18];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_p4_o <= cop4_p4_q;
    if (rst_i) cop4_p4_o <= Resets[685+:18];
  end

  logic cop4_p5_hit, cop4_p5_write;
  assign cop4_p5_hit = Cop4 && word == 10'h1cc;
  assign cop4_p5_write = cop4_p5_hit && write;
  logic [17:0] cop4_p5_q;
  always_ff @(posedge clk_i) begin
    if (cop4_p5_write) cop4_p5_q <= (cop4_p5_q & ~mask[17:0]) | (bus_data_i[17:0] & mask[17:0]);
    if (rst_i) cop4_p5_q <= Resets[703+:18];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_p5_o <= cop4_p5_q;
    if (rst_i) cop4_p5_o <= Resets[703+:18];
  end

  logic cop4_min_load_hit, cop4_min_load_write;
  assign cop4_min_load_hit = Cop4 && word == 10'h1cd;
  assign cop4_min_load_write = cop4_min_load_hit && write;
  logic [15:0] cop4_min_load_q;
  always_ff @(posedge clk_i) begin
    if (cop4_min_load_write) cop4_min_load_q <= (cop4_min_load_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) cop4_min_load_q <= Resets[721+:16];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_min_load_o <= cop4_min_load_q;
    if (rst_i) cop4_min_load_o <= Resets[721+:16];
  end

  logic cop4_top_hit, cop4_top_write;
  assign cop4_top_hit = Cop4 && word == 10'h1ce;
  assign cop4_top_write = cop4_top_hit && write;
  logic [15:0] cop4_top_q;
  always_ff @(posedge clk_i) begin
    if (cop4_top_write) cop4_top_q <= (cop4_top_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) cop4_top_q <= Resets[737+:16];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_top_o <= cop4_top_q;
    if (rst_i) cop4_top_o <= Resets[737+:16];
  end

  logic cop4_idle_hit, cop4_idle_write;
  assign cop4_idle_hit = Cop4 && word == 10'h1cf;
  assign cop4_idle_write = cop4_idle_hit && write;
  logic [16:0] cop4_idle_q;
  always_ff @(posedge clk_i) begin
    if (cop4_idle_write) cop4_idle_q <= (cop4_idle_q & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) cop4_idle_q <= Resets[753+:17];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_idle_o <= cop4_idle_q;
    if (rst_i) cop4_idle_o <= Resets[753+:17];
  end

  logic cop4_busy_hit, cop4_busy_write;
  assign cop4_busy_hit = Cop4 && word == 10'h1d0;
  assign cop4_busy_write = cop4_busy_hit && write;
  logic [16:0] cop4_busy_q;
  always_ff @(posedge clk_i) begin
    if (cop4_busy_write) cop4_busy_q <= (cop4_busy_q & ~mask[16:0]) | (bus_data_i[16:0] & mask[16:0]);
    if (rst_i) cop4_busy_q <= Resets[770+:17];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_busy_o <= cop4_busy_q;
    if (rst_i) cop4_busy_o <= Resets[770+:17];
  end

  logic cop4_imbalance_hit, cop4_imbalance_write;
  assign cop4_imbalance_hit = Cop4 && word == 10'h1d1;
  assign cop4_imbalance_write = cop4_imbalance_hit && write;
  logic [17:0] cop4_imbalance_q;
  always_ff @(posedge clk_i) begin
    if (cop4_imbalance_write) cop4_imbalance_q <= (cop4_imbalance_q & ~mask[17:0]) | (bus_data_i[17:0] & mask[17:0]);
    if (rst_i) cop4_imbalance_q <= Resets[787+:18];
  end
  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_imbalance_o <= cop4_imbalance_q;
    if (rst_i) cop4_imbalance_o <= Resets[787+:18];
  end

  always_ff @(posedge clk_i) begin
    if (cop4_commit_i) cop4_pending_o <= 1'b0;
    if (cop4_rail_write || cop4_kx_write || cop4_shift_x_write || cop4_ky_write || cop4_shift_y_write || cop4_kf_write || cop4_shift_load_write || cop4_p0_write || cop4_p1_write || cop4_p2_write || cop4_p3_write || cop4_p4_write || cop4_p5_write || cop4_min_load_write || cop4_top_write || cop4_idle_write || cop4_busy_write || cop4_imbalance_write) cop4_pending_o <= 1'b1;
    if (rst_i) cop4_pending_o <= 1'b0;
  end

  logic cop_slip_drop_hit, cop_slip_drop_write;
  assign cop_slip_drop_hit = CopSlip && word == 10'h200;
  assign cop_slip_drop_write = cop_slip_drop_hit && write;
  logic [7:0] cop_slip_drop_q;
  always_ff @(posedge clk_i) begin
    if (cop_slip_drop_write) cop_slip_drop_q <= (cop_slip_drop_q & ~mask[7:0]) | (bus_data_i[7:0] & mask[7:0]);
    if (rst_i) cop_slip_drop_q <= Resets[805+:8];
  end
  always_ff @(posedge clk_i) begin
    if (cop_slip_commit_i) cop_slip_drop_o <= cop_slip_drop_q;
    if (rst_i) cop_slip_drop_o <= Resets[805+:8];
  end

  logic cop_slip_move_hit, cop_slip_move_write;
  assign cop_slip_move_hit = CopSlip && word == 10'h201;
  assign cop_slip_move_write = cop_slip_move_hit && write;
  logic [15:0] cop_slip_move_q;
  always_ff @(posedge clk_i) begin
    if (cop_slip_move_write) cop_slip_move_q <= (cop_slip_move_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) cop_slip_move_q <= Resets[813+:16];
  end
  always_ff @(posedge clk_i) begin
    if (cop_slip_commit_i) cop_slip_move_o <= cop_slip_move_q;
    if (rst_i) cop_slip_move_o <= Resets[813+:16];
  end

  logic cop_slip_min_load_hit, cop_slip_min_load_write;
  assign cop_slip_min_load_hit = CopSlip && word == 10'h202;
  assign cop_slip_min_load_write = cop_slip_min_load_hit && write;
  logic [15:0] cop_slip_min_load_q;
  always_ff @(posedge clk_i) begin
    if (cop_slip_min_load_write) cop_slip_min_load_q <= (cop_slip_min_load_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) cop_slip_min_load_q <= Resets[829+:16];
  end
  always_ff @(posedge clk_i) begin
    if (cop_slip_commit_i) cop_slip_min_load_o <= cop_slip_min_load_q;
    if (rst_i) cop_slip_min_load_o <= Resets[829+:16];
  end

  logic cop_slip_hold_hit, cop_slip_hold_write;
  assign cop_slip_hold_hit = CopSlip && word == 10'h203;
  assign cop_slip_hold_write = cop_slip_hold_hit && write;
  logic [15:0] cop_slip_hold_q;
  always_ff @(posedge clk_i) begin
    if (cop_slip_hold_write) cop_slip_hold_q <= (cop_slip_hold_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) cop_slip_hold_q <= Resets[845+:16];
  end
  always_ff @(posedge clk_i) begin
    if (cop_slip_commit_i) cop_slip_hold_o <= cop_slip_hold_q;
    if (rst_i) cop_slip_hold_o <= Resets[845+:16];
  end

  logic cop_slip_refractory_hit, cop_slip_refractory_write;
  assign cop_slip_refractory_hit = CopSlip && word == 10'h204;
  assign cop_slip_refractory_write = cop_slip_refractory_hit && write;
  logic [15:0] cop_slip_refractory_q;
  always_ff @(posedge clk_i) begin
    if (cop_slip_refractory_write) cop_slip_refractory_q <= (cop_slip_refractory_q & ~mask[15:0]) | (bus_data_i[15:0] & mask[15:0]);
    if (rst_i) cop_slip_refractory_q <= Resets[861+:16];
  end
  always_ff @(posedge clk_i) begin
    if (cop_slip_commit_i) cop_slip_refractory_o <= cop_slip_refractory_q;
    if (rst_i) cop_slip_refractory_o <= Resets[861+:16];
  end

  always_ff @(posedge clk_i) begin
    if (cop_slip_commit_i) cop_slip_pending_o <= 1'b0;
    if (cop_slip_drop_write || cop_slip_move_write || cop_slip_min_load_write || cop_slip_hold_write || cop_slip_refractory_write) cop_slip_pending_o <= 1'b1;
    if (rst_i) cop_slip_pending_o <= 1'b0;
  end

  logic link_images_hit, link_images_write;
  assign link_images_hit = Link && word == 10'h240;
  assign link_images_write = link_images_hit && write;
  always_ff @(posedge clk_i) begin
    if (link_images_write) link_images_o <= (link_images_o & ~mask[0]) | (bus_data_i[0] & mask[0]);
    if (rst_i) link_images_o <= Resets[877];
  end

  logic link_packets_hit;
  assign link_packets_hit = Link && word == 10'h241;

  logic link_cop_dropped_hit;
  assign link_cop_dropped_hit = Link && word == 10'h242;

  logic link_image_dropped_hit;
  assign link_image_dropped_hit = Link && word == 10'h243;

  logic link_rejected_hit;
  assign link_rejected_hit = Link && word == 10'h244;

  // Which register, a clock after the address: decoding takes one clock, the word another.
  logic core_id_hit_q, core_version_hit_q, core_features_hit_q, core_size_hit_q, core_clk_khz_hit_q, core_scratch_hit_q, core_widths_hit_q, core_beats_hit_q, adc_enable_hit_q, adc_period_hit_q, adc_dropped_hit_q, adc_overrun_hit_q, adc_timeout_hit_q, adc_mistagged_hit_q, adc_over_range_hit_q, slip_threshold_hit_q, slip_gross_threshold_hit_q, slip_contact_level_hit_q, slip_release_level_hit_q, slip_contact_rises_hit_q, slip_hold_hit_q, slip_refractory_hit_q, slip_blank_hit_q, slip_damaged_hit_q, slip_blanked_hit_q, slip_keep_threshold_hit_q, scan_enable_hit_q, scan_settle_hit_q, scan_period_hit_q, scan_interleave_hit_q, scan_dropped_hit_q, scan_overrun_hit_q, scan_held_hit_q, scan_lost_hit_q, health_band_hit_q, health_jump_hit_q, health_low_hit_q, health_high_hit_q, health_use_hit_q, health_still_hit_q, health_rail_hit_q, health_blink_hit_q, health_clear_hit_q, health_report_hit_q, health_dead_hit_q, health_railed_hit_q, health_blinking_hit_q, tare_contact_hit_q, tare_step_hit_q, tare_force_hit_q, tare_at_start_hit_q, tare_average_hit_q, tare_load_hit_q, tare_word_hit_q, tare_zero_hit_q, tare_write_hit_q, tare_state_hit_q, tare_tared_hit_q, tare_refused_hit_q, tare_swallowed_hit_q, calibrate_preset_hit_q, calibrate_word_hit_q, calibrate_offset_hit_q, calibrate_gain_hit_q, calibrate_write_hit_q, calibrate_swap_hit_q, calibrate_swapping_hit_q, cop_min_load_hit_q, cop_damaged_hit_q, cop4_rail_hit_q, cop4_kx_hit_q, cop4_shift_x_hit_q, cop4_ky_hit_q, cop4_shift_y_hit_q, cop4_kf_hit_q, cop4_shift_load_hit_q, cop4_p0_hit_q, cop4_p1_hit_q, cop4_p2_hit_q, cop4_p3_hit_q, cop4_p4_hit_q, cop4_p5_hit_q, cop4_min_load_hit_q, cop4_top_hit_q, cop4_idle_hit_q, cop4_busy_hit_q, cop4_imbalance_hit_q, cop_slip_drop_hit_q, cop_slip_move_hit_q, cop_slip_min_load_hit_q, cop_slip_hold_hit_q, cop_slip_refractory_hit_q, link_images_hit_q, link_packets_hit_q, link_cop_dropped_hit_q, link_image_dropped_hit_q, link_rejected_hit_q;
  always_ff @(posedge clk_i) begin
    core_id_hit_q <= core_id_hit;
    core_version_hit_q <= core_version_hit;
    core_features_hit_q <= core_features_hit;
    core_size_hit_q <= core_size_hit;
    core_clk_khz_hit_q <= core_clk_khz_hit;
    core_scratch_hit_q <= core_scratch_hit;
    core_widths_hit_q <= core_widths_hit;
    core_beats_hit_q <= core_beats_hit;
    adc_enable_hit_q <= adc_enable_hit;
    adc_period_hit_q <= adc_period_hit;
    adc_dropped_hit_q <= adc_dropped_hit;
    adc_overrun_hit_q <= adc_overrun_hit;
    adc_timeout_hit_q <= adc_timeout_hit;
    adc_mistagged_hit_q <= adc_mistagged_hit;
    adc_over_range_hit_q <= adc_over_range_hit;
    slip_threshold_hit_q <= slip_threshold_hit;
    slip_gross_threshold_hit_q <= slip_gross_threshold_hit;
    slip_contact_level_hit_q <= slip_contact_level_hit;
    slip_release_level_hit_q <= slip_release_level_hit;
    slip_contact_rises_hit_q <= slip_contact_rises_hit;
    slip_hold_hit_q <= slip_hold_hit;
    slip_refractory_hit_q <= slip_refractory_hit;
    slip_blank_hit_q <= slip_blank_hit;
    slip_damaged_hit_q <= slip_damaged_hit;
    slip_blanked_hit_q <= slip_blanked_hit;
    slip_keep_threshold_hit_q <= slip_keep_threshold_hit;
    scan_enable_hit_q <= scan_enable_hit;
    scan_settle_hit_q <= scan_settle_hit;
    scan_period_hit_q <= scan_period_hit;
    scan_interleave_hit_q <= scan_interleave_hit;
    scan_dropped_hit_q <= scan_dropped_hit;
    scan_overrun_hit_q <= scan_overrun_hit;
    scan_held_hit_q <= scan_held_hit;
    scan_lost_hit_q <= scan_lost_hit;
    health_band_hit_q <= health_band_hit;
    health_jump_hit_q <= health_jump_hit;
    health_low_hit_q <= health_low_hit;
    health_high_hit_q <= health_high_hit;
    health_use_hit_q <= health_use_hit;
    health_still_hit_q <= health_still_hit;
    health_rail_hit_q <= health_rail_hit;
    health_blink_hit_q <= health_blink_hit;
    health_clear_hit_q <= health_clear_hit;
    health_report_hit_q <= health_report_hit;
    health_dead_hit_q <= health_dead_hit;
    health_railed_hit_q <= health_railed_hit;
    health_blinking_hit_q <= health_blinking_hit;
    tare_contact_hit_q <= tare_contact_hit;
    tare_step_hit_q <= tare_step_hit;
    tare_force_hit_q <= tare_force_hit;
    tare_at_start_hit_q <= tare_at_start_hit;
    tare_average_hit_q <= tare_average_hit;
    tare_load_hit_q <= tare_load_hit;
    tare_word_hit_q <= tare_word_hit;
    tare_zero_hit_q <= tare_zero_hit;
    tare_write_hit_q <= tare_write_hit;
    tare_state_hit_q <= tare_state_hit;
    tare_tared_hit_q <= tare_tared_hit;
    tare_refused_hit_q <= tare_refused_hit;
    tare_swallowed_hit_q <= tare_swallowed_hit;
    calibrate_preset_hit_q <= calibrate_preset_hit;
    calibrate_word_hit_q <= calibrate_word_hit;
    calibrate_offset_hit_q <= calibrate_offset_hit;
    calibrate_gain_hit_q <= calibrate_gain_hit;
    calibrate_write_hit_q <= calibrate_write_hit;
    calibrate_swap_hit_q <= calibrate_swap_hit;
    calibrate_swapping_hit_q <= calibrate_swapping_hit;
    cop_min_load_hit_q <= cop_min_load_hit;
    cop_damaged_hit_q <= cop_damaged_hit;
    cop4_rail_hit_q <= cop4_rail_hit;
    cop4_kx_hit_q <= cop4_kx_hit;
    cop4_shift_x_hit_q <= cop4_shift_x_hit;
    cop4_ky_hit_q <= cop4_ky_hit;
    cop4_shift_y_hit_q <= cop4_shift_y_hit;
    cop4_kf_hit_q <= cop4_kf_hit;
    cop4_shift_load_hit_q <= cop4_shift_load_hit;
    cop4_p0_hit_q <= cop4_p0_hit;
    cop4_p1_hit_q <= cop4_p1_hit;
    cop4_p2_hit_q <= cop4_p2_hit;
    cop4_p3_hit_q <= cop4_p3_hit;
    cop4_p4_hit_q <= cop4_p4_hit;
    cop4_p5_hit_q <= cop4_p5_hit;
    cop4_min_load_hit_q <= cop4_min_load_hit;
    cop4_top_hit_q <= cop4_top_hit;
    cop4_idle_hit_q <= cop4_idle_hit;
    cop4_busy_hit_q <= cop4_busy_hit;
    cop4_imbalance_hit_q <= cop4_imbalance_hit;
    cop_slip_drop_hit_q <= cop_slip_drop_hit;
    cop_slip_move_hit_q <= cop_slip_move_hit;
    cop_slip_min_load_hit_q <= cop_slip_min_load_hit;
    cop_slip_hold_hit_q <= cop_slip_hold_hit;
    cop_slip_refractory_hit_q <= cop_slip_refractory_hit;
    link_images_hit_q <= link_images_hit;
    link_packets_hit_q <= link_packets_hit;
    link_cop_dropped_hit_q <= link_cop_dropped_hit;
    link_image_dropped_hit_q <= link_image_dropped_hit;
    link_rejected_hit_q <= link_rejected_hit;
  end

  logic hit, writable;
  assign hit      = core_id_hit_q
      || core_version_hit_q
      || core_features_hit_q
      || core_size_hit_q
      || core_clk_khz_hit_q
      || core_scratch_hit_q
      || core_widths_hit_q
      || core_beats_hit_q
      || adc_enable_hit_q
      || adc_period_hit_q
      || adc_dropped_hit_q
      || adc_overrun_hit_q
      || adc_timeout_hit_q
      || adc_mistagged_hit_q
      || adc_over_range_hit_q
      || slip_threshold_hit_q
      || slip_gross_threshold_hit_q
      || slip_contact_level_hit_q
      || slip_release_level_hit_q
      || slip_contact_rises_hit_q
      || slip_hold_hit_q
      || slip_refractory_hit_q
      || slip_blank_hit_q
      || slip_damaged_hit_q
      || slip_blanked_hit_q
      || slip_keep_threshold_hit_q
      || scan_enable_hit_q
      || scan_settle_hit_q
      || scan_period_hit_q
      || scan_interleave_hit_q
      || scan_dropped_hit_q
      || scan_overrun_hit_q
      || scan_held_hit_q
      || scan_lost_hit_q
      || health_band_hit_q
      || health_jump_hit_q
      || health_low_hit_q
      || health_high_hit_q
      || health_use_hit_q
      || health_still_hit_q
      || health_rail_hit_q
      || health_blink_hit_q
      || health_clear_hit_q
      || health_report_hit_q
      || health_dead_hit_q
      || health_railed_hit_q
      || health_blinking_hit_q
      || tare_contact_hit_q
      || tare_step_hit_q
      || tare_force_hit_q
      || tare_at_start_hit_q
      || tare_average_hit_q
      || tare_load_hit_q
      || tare_word_hit_q
      || tare_zero_hit_q
      || tare_write_hit_q
      || tare_state_hit_q
      || tare_tared_hit_q
      || tare_refused_hit_q
      || tare_swallowed_hit_q
      || calibrate_preset_hit_q
      || calibrate_word_hit_q
      || calibrate_offset_hit_q
      || calibrate_gain_hit_q
      || calibrate_write_hit_q
      || calibrate_swap_hit_q
      || calibrate_swapping_hit_q
      || cop_min_load_hit_q
      || cop_damaged_hit_q
      || cop4_rail_hit_q
      || cop4_kx_hit_q
      || cop4_shift_x_hit_q
      || cop4_ky_hit_q
      || cop4_shift_y_hit_q
      || cop4_kf_hit_q
      || cop4_shift_load_hit_q
      || cop4_p0_hit_q
      || cop4_p1_hit_q
      || cop4_p2_hit_q
      || cop4_p3_hit_q
      || cop4_p4_hit_q
      || cop4_p5_hit_q
      || cop4_min_load_hit_q
      || cop4_top_hit_q
      || cop4_idle_hit_q
      || cop4_busy_hit_q
      || cop4_imbalance_hit_q
      || cop_slip_drop_hit_q
      || cop_slip_move_hit_q
      || cop_slip_min_load_hit_q
      || cop_slip_hold_hit_q
      || cop_slip_refractory_hit_q
      || link_images_hit_q
      || link_packets_hit_q
      || link_cop_dropped_hit_q
      || link_image_dropped_hit_q
      || link_rejected_hit_q;
  assign writable = core_scratch_hit_q
      || adc_enable_hit_q
      || adc_period_hit_q
      || slip_threshold_hit_q
      || slip_gross_threshold_hit_q
      || slip_contact_level_hit_q
      || slip_release_level_hit_q
      || slip_contact_rises_hit_q
      || slip_hold_hit_q
      || slip_refractory_hit_q
      || slip_blank_hit_q
      || slip_keep_threshold_hit_q
      || scan_enable_hit_q
      || scan_settle_hit_q
      || scan_period_hit_q
      || scan_interleave_hit_q
      || health_band_hit_q
      || health_jump_hit_q
      || health_low_hit_q
      || health_high_hit_q
      || health_use_hit_q
      || health_still_hit_q
      || health_rail_hit_q
      || health_blink_hit_q
      || health_clear_hit_q
      || health_report_hit_q
      || tare_contact_hit_q
      || tare_step_hit_q
      || tare_force_hit_q
      || tare_at_start_hit_q
      || tare_average_hit_q
      || tare_load_hit_q
      || tare_word_hit_q
      || tare_zero_hit_q
      || tare_write_hit_q
      || calibrate_preset_hit_q
      || calibrate_word_hit_q
      || calibrate_offset_hit_q
      || calibrate_gain_hit_q
      || calibrate_write_hit_q
      || calibrate_swap_hit_q
      || cop_min_load_hit_q
      || cop4_rail_hit_q
      || cop4_kx_hit_q
      || cop4_shift_x_hit_q
      || cop4_ky_hit_q
      || cop4_shift_y_hit_q
      || cop4_kf_hit_q
      || cop4_shift_load_hit_q
      || cop4_p0_hit_q
      || cop4_p1_hit_q
      || cop4_p2_hit_q
      || cop4_p3_hit_q
      || cop4_p4_hit_q
      || cop4_p5_hit_q
      || cop4_min_load_hit_q
      || cop4_top_hit_q
      || cop4_idle_hit_q
      || cop4_busy_hit_q
      || cop4_imbalance_hit_q
      || cop_slip_drop_hit_q
      || cop_slip_move_hit_q
      || cop_slip_min_load_hit_q
      || cop_slip_hold_hit_q
      || cop_slip_refractory_hit_q
      || link_images_hit_q;

  logic [31:0] read_word;
  assign read_word = ({32{core_id_hit_q}} & 32'h4d534e52)
      | ({32{core_version_hit_q}} & {16'h0, 8'h4, 8'h0})
      | ({32{core_features_hit_q}} & core_features_i)
      | ({32{core_size_hit_q}} & {core_size_columns_i, core_size_rows_i})
      | ({32{core_clk_khz_hit_q}} & core_clk_khz_i)
      | ({32{core_scratch_hit_q}} & core_scratch_o)
      | ({32{core_widths_hit_q}} & {core_widths_offset_i, core_widths_load_i, core_widths_timer_i, core_widths_detail_i})
      | ({32{core_beats_hit_q}} & {11'd0, core_beats_i})
      | ({32{adc_enable_hit_q}} & {31'd0, adc_enable_o})
      | ({32{adc_period_hit_q}} & {8'd0, adc_period_o})
      | ({32{adc_dropped_hit_q}} & adc_dropped_i)
      | ({32{adc_overrun_hit_q}} & adc_overrun_i)
      | ({32{adc_timeout_hit_q}} & adc_timeout_i)
      | ({32{adc_mistagged_hit_q}} & adc_mistagged_i)
      | ({32{adc_over_range_hit_q}} & adc_over_range_i)
      | ({32{slip_threshold_hit_q}} & {12'd0, 20'(slip_threshold_fit)})
      | ({32{slip_gross_threshold_hit_q}} & {12'd0, 20'(slip_gross_threshold_fit)})
      | ({32{slip_contact_level_hit_q}} & {12'd0, 20'(signed'(slip_contact_level_fit))})
      | ({32{slip_release_level_hit_q}} & {12'd0, 20'(signed'(slip_release_level_fit))})
      | ({32{slip_contact_rises_hit_q}} & {31'd0, slip_contact_rises_q})
      | ({32{slip_hold_hit_q}} & {16'd0, 16'(slip_hold_fit)})
      | ({32{slip_refractory_hit_q}} & {16'd0, 16'(slip_refractory_fit)})
      | ({32{slip_blank_hit_q}} & {16'd0, 16'(slip_blank_fit)})
      | ({32{slip_damaged_hit_q}} & slip_damaged_i)
      | ({32{slip_blanked_hit_q}} & slip_blanked_i)
      | ({32{slip_keep_threshold_hit_q}} & {12'd0, 20'(slip_keep_threshold_fit)})
      | ({32{scan_enable_hit_q}} & {31'd0, scan_enable_o})
      | ({32{scan_settle_hit_q}} & {16'd0, scan_settle_o})
      | ({32{scan_period_hit_q}} & scan_period_o)
      | ({32{scan_interleave_hit_q}} & {31'd0, scan_interleave_o})
      | ({32{scan_dropped_hit_q}} & scan_dropped_i)
      | ({32{scan_overrun_hit_q}} & scan_overrun_i)
      | ({32{scan_held_hit_q}} & scan_held_i)
      | ({32{scan_lost_hit_q}} & scan_lost_i)
      | ({32{health_band_hit_q}} & {15'd0, health_band_o})
      | ({32{health_jump_hit_q}} & {15'd0, health_jump_o})
      | ({32{health_low_hit_q}} & {15'd0, health_low_o})
      | ({32{health_high_hit_q}} & {15'd0, health_high_o})
      | ({32{health_use_hit_q}} & {30'd0, health_use_edges_o, health_use_user_o})
      | ({32{health_still_hit_q}} & {24'd0, health_still_o})
      | ({32{health_rail_hit_q}} & {24'd0, health_rail_o})
      | ({32{health_blink_hit_q}} & {24'd0, health_blink_o})
      | ({32{health_clear_hit_q}} & {31'd0, 1'b0})
      | ({32{health_report_hit_q}} & {31'd0, 1'b0})
      | ({32{health_dead_hit_q}} & {11'd0, health_dead_i})
      | ({32{health_railed_hit_q}} & {11'd0, health_railed_i})
      | ({32{health_blinking_hit_q}} & {11'd0, health_blinking_i})
      | ({32{tare_contact_hit_q}} & {15'd0, tare_contact_o})
      | ({32{tare_step_hit_q}} & {24'd0, tare_step_o})
      | ({32{tare_force_hit_q}} & {31'd0, tare_force_o})
      | ({32{tare_at_start_hit_q}} & {31'd0, tare_at_start_o})
      | ({32{tare_average_hit_q}} & {31'd0, 1'b0})
      | ({32{tare_load_hit_q}} & {31'd0, tare_load_o})
      | ({32{tare_word_hit_q}} & {12'd0, tare_word_o})
      | ({32{tare_zero_hit_q}} & {15'd0, tare_zero_o})
      | ({32{tare_write_hit_q}} & {24'd0, tare_write_o})
      | ({32{tare_state_hit_q}} & {29'd0, tare_state_pressed_i, tare_state_taring_i, tare_state_loading_i})
      | ({32{tare_tared_hit_q}} & {16'd0, tare_tared_i})
      | ({32{tare_refused_hit_q}} & {16'd0, tare_refused_i})
      | ({32{tare_swallowed_hit_q}} & tare_swallowed_i)
      | ({32{calibrate_preset_hit_q}} & {16'd0, calibrate_preset_o})
      | ({32{calibrate_word_hit_q}} & {12'd0, calibrate_word_o})
      | ({32{calibrate_offset_hit_q}} & {15'd0, 17'(signed'(calibrate_offset_fit))})
      | ({32{calibrate_gain_hit_q}} & {16'd0, calibrate_gain_o})
      | ({32{calibrate_write_hit_q}} & {23'd0, calibrate_write_row_o, calibrate_write_lanes_o})
      | ({32{calibrate_swap_hit_q}} & {31'd0, 1'b0})
      | ({32{calibrate_swapping_hit_q}} & {31'd0, calibrate_swapping_i})
      | ({32{cop_min_load_hit_q}} & 32'(cop_min_load_fit))
      | ({32{cop_damaged_hit_q}} & cop_damaged_i)
      | ({32{cop4_rail_hit_q}} & {15'd0, cop4_rail_q})
      | ({32{cop4_kx_hit_q}} & {15'd0, cop4_kx_q})
      | ({32{cop4_shift_x_hit_q}} & {28'd0, cop4_shift_x_q})
      | ({32{cop4_ky_hit_q}} & {15'd0, cop4_ky_q})
      | ({32{cop4_shift_y_hit_q}} & {28'd0, cop4_shift_y_q})
      | ({32{cop4_kf_hit_q}} & {15'd0, cop4_kf_q})
      | ({32{cop4_shift_load_hit_q}} & {28'd0, cop4_shift_load_q})
      | ({32{cop4_p0_hit_q}} & {14'd0, cop4_p0_q})
      | ({32{cop4_p1_hit_q}} & {14'd0, cop4_p1_q})
      | ({32{cop4_p2_hit_q}} & {14'd0, cop4_p2_q})
      | ({32{cop4_p3_hit_q}} & {14'd0, cop4_p3_q})
      | ({32{cop4_p4_hit_q}} & {14'd0, cop4_p4_q})
      | ({32{cop4_p5_hit_q}} & {14'd0, cop4_p5_q})
      | ({32{cop4_min_load_hit_q}} & {16'd0, cop4_min_load_q})
      | ({32{cop4_top_hit_q}} & {16'd0, cop4_top_q})
      | ({32{cop4_idle_hit_q}} & {15'd0, cop4_idle_q})
      | ({32{cop4_busy_hit_q}} & {15'd0, cop4_busy_q})
      | ({32{cop4_imbalance_hit_q}} & {14'd0, cop4_imbalance_q})
      | ({32{cop_slip_drop_hit_q}} & {24'd0, cop_slip_drop_q})
      | ({32{cop_slip_move_hit_q}} & {16'd0, cop_slip_move_q})
      | ({32{cop_slip_min_load_hit_q}} & {16'd0, cop_slip_min_load_q})
      | ({32{cop_slip_hold_hit_q}} & {16'd0, cop_slip_hold_q})
      | ({32{cop_slip_refractory_hit_q}} & {16'd0, cop_slip_refractory_q})
      | ({32{link_images_hit_q}} & {31'd0, link_images_o})
      | ({32{link_packets_hit_q}} & link_packets_i)
      | ({32{link_cop_dropped_hit_q}} & link_cop_dropped_i)
      | ({32{link_image_dropped_hit_q}} & link_image_dropped_i)
      | ({32{link_rejected_hit_q}} & link_rejected_i);

  logic asked, wrote, odd;
  always_ff @(posedge clk_i) begin
    asked       <= bus_valid_i;
    wrote       <= bus_write_i;
    odd         <= bus_address_i[1:0] != 2'd0;
    bus_done_o  <= asked;
    bus_error_o <= !hit || odd || (wrote && !writable);
    bus_data_o  <= (wrote || odd) ? 32'd0 : read_word;
    if (rst_i) begin
      asked      <= 1'b0;
      bus_done_o <= 1'b0;
    end
  end

endmodule
