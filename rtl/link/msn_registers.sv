// SPDX-License-Identifier: Apache-2.0
//
// Made by tools/make/registers.py from rtl/registers.rdl: change that, then `make registers`.
//
// The registers of the core. bus_valid_i for one clock asks; bus_done_o answers two clocks later, once; an
// access is an error, and changes nothing, at an address without a register in this build, at one that is no
// multiple of four, and for a write where all is read-only. bus_strobe_i: the bytes that a write changes. A
// group that waits for a frame's boundary, commit_i, keeps two copies: a read sees what was written, the core
// what was committed.
// Resets: the reset value of every setting, in the page's order, the first lowest. Without a bus: constants.
// Some settings are wider than the build has bits for. What was written is kept byte by byte; what a read and
// the core get is held at the ends of DetailBits, TimerBits, LoadBits or OffsetBits: the lowest bits say all.
// Model: model/meissner/twins/link/registers.py

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
  parameter bit Grip = 1'b1,
  parameter bit ShearSpeed = 1'b1,
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
  input  logic [31:0] bus_wdata_i,
  input  logic [3:0]  bus_strobe_i,
  output logic        bus_done_o,
  output logic        bus_error_o,
  output logic [31:0] bus_rdata_o,

  input  logic        commit_i,   // between two frames: what groups that wait were given takes effect
  output logic        pending_o,  // some wait for it
  output msn_registers_pkg::cfg_t    cfg_o,
  input  msn_registers_pkg::status_t status_i
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

  localparam logic [11:0] Features = {ShearSpeed, Grip, Link, CopSlip, Cop4, Cop, Calibrate, Tare, Health, Scan, Slip, Adc};

  logic        write;
  logic [9:0]  word;
  logic [31:0] mask;
  assign write = bus_valid_i && bus_write_i && bus_address_i[1:0] == 2'd0;
  assign word  = bus_address_i[11:2];
  assign mask  = {{8{bus_strobe_i[3]}}, {8{bus_strobe_i[2]}}, {8{bus_strobe_i[1]}}, {8{bus_strobe_i[0]}}};

  // core
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
  logic core_widths_hit;
  assign core_widths_hit = word == 10'h006;
  logic core_beats_hit;
  assign core_beats_hit = word == 10'h007;
  always_ff @(posedge clk_i) begin
    if (core_scratch_write) cfg_o.core.scratch <= (cfg_o.core.scratch & ~mask[31:0]) | (bus_wdata_i[31:0] & mask[31:0]);
    if (rst_i) begin
      cfg_o.core.scratch <= Resets[0+:32];
    end
  end

  // adc
  logic adc_enable_hit, adc_enable_write;
  assign adc_enable_hit = Adc && word == 10'h040;
  assign adc_enable_write = adc_enable_hit && write;
  logic adc_period_hit, adc_period_write;
  assign adc_period_hit = Adc && word == 10'h041;
  assign adc_period_write = adc_period_hit && write;
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
  always_ff @(posedge clk_i) begin
    if (adc_enable_write) cfg_o.adc.enable <= (cfg_o.adc.enable & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (adc_period_write) cfg_o.adc.period <= (cfg_o.adc.period & ~mask[23:0]) | (bus_wdata_i[23:0] & mask[23:0]);
    if (rst_i) begin
      cfg_o.adc.enable <= Resets[32];
      cfg_o.adc.period <= Resets[33+:24];
    end
  end

  // slip
  logic slip_threshold_hit, slip_threshold_write;
  assign slip_threshold_hit = Slip && word == 10'h080;
  assign slip_threshold_write = slip_threshold_hit && write;
  logic slip_gross_threshold_hit, slip_gross_threshold_write;
  assign slip_gross_threshold_hit = Slip && word == 10'h081;
  assign slip_gross_threshold_write = slip_gross_threshold_hit && write;
  logic slip_contact_level_hit, slip_contact_level_write;
  assign slip_contact_level_hit = Slip && word == 10'h082;
  assign slip_contact_level_write = slip_contact_level_hit && write;
  logic slip_release_level_hit, slip_release_level_write;
  assign slip_release_level_hit = Slip && word == 10'h083;
  assign slip_release_level_write = slip_release_level_hit && write;
  logic slip_contact_rises_hit, slip_contact_rises_write;
  assign slip_contact_rises_hit = Slip && word == 10'h084;
  assign slip_contact_rises_write = slip_contact_rises_hit && write;
  logic slip_hold_hit, slip_hold_write;
  assign slip_hold_hit = Slip && word == 10'h085;
  assign slip_hold_write = slip_hold_hit && write;
  logic slip_refractory_hit, slip_refractory_write;
  assign slip_refractory_hit = Slip && word == 10'h086;
  assign slip_refractory_write = slip_refractory_hit && write;
  logic slip_blank_hit, slip_blank_write;
  assign slip_blank_hit = Slip && word == 10'h087;
  assign slip_blank_write = slip_blank_hit && write;
  logic slip_damaged_hit;
  assign slip_damaged_hit = Slip && word == 10'h088;
  logic slip_blanked_hit;
  assign slip_blanked_hit = Slip && word == 10'h089;
  logic slip_keep_threshold_hit, slip_keep_threshold_write;
  assign slip_keep_threshold_hit = Slip && word == 10'h08a;
  assign slip_keep_threshold_write = slip_keep_threshold_hit && write;
  logic [19:0] slip_threshold_q;
  logic [19:0] slip_threshold_fit;
  assign slip_threshold_fit = ({1'b0, slip_threshold_q} >> DetailBits) == '0 ? slip_threshold_q : 20'({DetailBits{1'b1}});
  localparam logic [19:0] SlipThresholdReset = Resets[57+:20];
  logic [19:0] slip_gross_threshold_q;
  logic [19:0] slip_gross_threshold_fit;
  assign slip_gross_threshold_fit = ({1'b0, slip_gross_threshold_q} >> DetailBits) == '0 ? slip_gross_threshold_q : 20'({DetailBits{1'b1}});
  localparam logic [19:0] SlipGrossThresholdReset = Resets[77+:20];
  logic [19:0] slip_contact_level_q;
  logic [19:0] slip_contact_level_fit;
  assign slip_contact_level_fit = (&slip_contact_level_q[19:DetailBits-1] || !(|slip_contact_level_q[19:DetailBits-1])) ? slip_contact_level_q : {{(21-DetailBits){slip_contact_level_q[19]}}, {(DetailBits-1){!slip_contact_level_q[19]}}};
  localparam logic [19:0] SlipContactLevelReset = Resets[97+:20];
  logic [19:0] slip_release_level_q;
  logic [19:0] slip_release_level_fit;
  assign slip_release_level_fit = (&slip_release_level_q[19:DetailBits-1] || !(|slip_release_level_q[19:DetailBits-1])) ? slip_release_level_q : {{(21-DetailBits){slip_release_level_q[19]}}, {(DetailBits-1){!slip_release_level_q[19]}}};
  localparam logic [19:0] SlipReleaseLevelReset = Resets[117+:20];
  logic slip_contact_rises_q;
  logic [15:0] slip_hold_q;
  logic [15:0] slip_hold_fit;
  assign slip_hold_fit = ({1'b0, slip_hold_q} >> TimerBits) == '0 ? slip_hold_q : 16'({TimerBits{1'b1}});
  localparam logic [15:0] SlipHoldReset = Resets[138+:16];
  logic [15:0] slip_refractory_q;
  logic [15:0] slip_refractory_fit;
  assign slip_refractory_fit = ({1'b0, slip_refractory_q} >> TimerBits) == '0 ? slip_refractory_q : 16'({TimerBits{1'b1}});
  localparam logic [15:0] SlipRefractoryReset = Resets[154+:16];
  logic [15:0] slip_blank_q;
  logic [15:0] slip_blank_fit;
  assign slip_blank_fit = ({1'b0, slip_blank_q} >> TimerBits) == '0 ? slip_blank_q : 16'({TimerBits{1'b1}});
  localparam logic [15:0] SlipBlankReset = Resets[170+:16];
  logic [19:0] slip_keep_threshold_q;
  logic [19:0] slip_keep_threshold_fit;
  assign slip_keep_threshold_fit = ({1'b0, slip_keep_threshold_q} >> DetailBits) == '0 ? slip_keep_threshold_q : 20'({DetailBits{1'b1}});
  localparam logic [19:0] SlipKeepThresholdReset = Resets[186+:20];
  logic slip_pending;
  always_ff @(posedge clk_i) begin
    if (slip_threshold_write) slip_threshold_q <= (slip_threshold_q & ~mask[19:0]) | (bus_wdata_i[19:0] & mask[19:0]);
    if (slip_gross_threshold_write) slip_gross_threshold_q <= (slip_gross_threshold_q & ~mask[19:0]) | (bus_wdata_i[19:0] & mask[19:0]);
    if (slip_contact_level_write) slip_contact_level_q <= (slip_contact_level_q & ~mask[19:0]) | (bus_wdata_i[19:0] & mask[19:0]);
    if (slip_release_level_write) slip_release_level_q <= (slip_release_level_q & ~mask[19:0]) | (bus_wdata_i[19:0] & mask[19:0]);
    if (slip_contact_rises_write) slip_contact_rises_q <= (slip_contact_rises_q & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (slip_hold_write) slip_hold_q <= (slip_hold_q & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (slip_refractory_write) slip_refractory_q <= (slip_refractory_q & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (slip_blank_write) slip_blank_q <= (slip_blank_q & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (slip_keep_threshold_write) slip_keep_threshold_q <= (slip_keep_threshold_q & ~mask[19:0]) | (bus_wdata_i[19:0] & mask[19:0]);
    if (commit_i) begin
      cfg_o.slip.threshold <= slip_threshold_fit;
      cfg_o.slip.gross_threshold <= slip_gross_threshold_fit;
      cfg_o.slip.contact_level <= slip_contact_level_fit;
      cfg_o.slip.release_level <= slip_release_level_fit;
      cfg_o.slip.contact_rises <= slip_contact_rises_q;
      cfg_o.slip.hold <= slip_hold_fit;
      cfg_o.slip.refractory <= slip_refractory_fit;
      cfg_o.slip.blank <= slip_blank_fit;
      cfg_o.slip.keep_threshold <= slip_keep_threshold_fit;
      slip_pending <= 1'b0;
    end
    if (slip_threshold_write || slip_gross_threshold_write || slip_contact_level_write || slip_release_level_write || slip_contact_rises_write || slip_hold_write || slip_refractory_write || slip_blank_write || slip_keep_threshold_write) slip_pending <= 1'b1;
    if (rst_i) begin
      slip_threshold_q <= Resets[57+:20];
      cfg_o.slip.threshold <= ({1'b0, SlipThresholdReset} >> DetailBits) == '0 ? SlipThresholdReset : 20'({DetailBits{1'b1}});
      slip_gross_threshold_q <= Resets[77+:20];
      cfg_o.slip.gross_threshold <= ({1'b0, SlipGrossThresholdReset} >> DetailBits) == '0 ? SlipGrossThresholdReset : 20'({DetailBits{1'b1}});
      slip_contact_level_q <= Resets[97+:20];
      cfg_o.slip.contact_level <= (&SlipContactLevelReset[19:DetailBits-1] || !(|SlipContactLevelReset[19:DetailBits-1])) ? SlipContactLevelReset : {{(21-DetailBits){SlipContactLevelReset[19]}}, {(DetailBits-1){!SlipContactLevelReset[19]}}};
      slip_release_level_q <= Resets[117+:20];
      cfg_o.slip.release_level <= (&SlipReleaseLevelReset[19:DetailBits-1] || !(|SlipReleaseLevelReset[19:DetailBits-1])) ? SlipReleaseLevelReset : {{(21-DetailBits){SlipReleaseLevelReset[19]}}, {(DetailBits-1){!SlipReleaseLevelReset[19]}}};
      slip_contact_rises_q <= Resets[137];
      cfg_o.slip.contact_rises <= Resets[137];
      slip_hold_q <= Resets[138+:16];
      cfg_o.slip.hold <= ({1'b0, SlipHoldReset} >> TimerBits) == '0 ? SlipHoldReset : 16'({TimerBits{1'b1}});
      slip_refractory_q <= Resets[154+:16];
      cfg_o.slip.refractory <= ({1'b0, SlipRefractoryReset} >> TimerBits) == '0 ? SlipRefractoryReset : 16'({TimerBits{1'b1}});
      slip_blank_q <= Resets[170+:16];
      cfg_o.slip.blank <= ({1'b0, SlipBlankReset} >> TimerBits) == '0 ? SlipBlankReset : 16'({TimerBits{1'b1}});
      slip_keep_threshold_q <= Resets[186+:20];
      cfg_o.slip.keep_threshold <= ({1'b0, SlipKeepThresholdReset} >> DetailBits) == '0 ? SlipKeepThresholdReset : 20'({DetailBits{1'b1}});
      slip_pending <= 1'b0;
    end
  end

  // scan
  logic scan_enable_hit, scan_enable_write;
  assign scan_enable_hit = Scan && word == 10'h0c0;
  assign scan_enable_write = scan_enable_hit && write;
  logic scan_settle_hit, scan_settle_write;
  assign scan_settle_hit = Scan && word == 10'h0c1;
  assign scan_settle_write = scan_settle_hit && write;
  logic scan_period_hit, scan_period_write;
  assign scan_period_hit = Scan && word == 10'h0c2;
  assign scan_period_write = scan_period_hit && write;
  logic scan_interleave_hit, scan_interleave_write;
  assign scan_interleave_hit = Scan && word == 10'h0c3;
  assign scan_interleave_write = scan_interleave_hit && write;
  logic scan_dropped_hit;
  assign scan_dropped_hit = Scan && word == 10'h0c4;
  logic scan_overrun_hit;
  assign scan_overrun_hit = Scan && word == 10'h0c5;
  logic scan_held_hit;
  assign scan_held_hit = Scan && word == 10'h0c6;
  logic scan_lost_hit;
  assign scan_lost_hit = Scan && word == 10'h0c7;
  always_ff @(posedge clk_i) begin
    if (scan_enable_write) cfg_o.scan.enable <= (cfg_o.scan.enable & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (scan_settle_write) cfg_o.scan.settle <= (cfg_o.scan.settle & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (scan_period_write) cfg_o.scan.period <= (cfg_o.scan.period & ~mask[31:0]) | (bus_wdata_i[31:0] & mask[31:0]);
    if (scan_interleave_write) cfg_o.scan.interleave <= (cfg_o.scan.interleave & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (rst_i) begin
      cfg_o.scan.enable <= Resets[206];
      cfg_o.scan.settle <= Resets[207+:16];
      cfg_o.scan.period <= Resets[223+:32];
      cfg_o.scan.interleave <= Resets[255];
    end
  end

  // health
  logic health_band_hit, health_band_write;
  assign health_band_hit = Health && word == 10'h100;
  assign health_band_write = health_band_hit && write;
  logic health_jump_hit, health_jump_write;
  assign health_jump_hit = Health && word == 10'h101;
  assign health_jump_write = health_jump_hit && write;
  logic health_low_hit, health_low_write;
  assign health_low_hit = Health && word == 10'h102;
  assign health_low_write = health_low_hit && write;
  logic health_high_hit, health_high_write;
  assign health_high_hit = Health && word == 10'h103;
  assign health_high_write = health_high_hit && write;
  logic health_use_hit, health_use_write;
  assign health_use_hit = Health && word == 10'h104;
  assign health_use_write = health_use_hit && write;
  logic health_still_hit, health_still_write;
  assign health_still_hit = Health && word == 10'h105;
  assign health_still_write = health_still_hit && write;
  logic health_rail_hit, health_rail_write;
  assign health_rail_hit = Health && word == 10'h106;
  assign health_rail_write = health_rail_hit && write;
  logic health_blink_hit, health_blink_write;
  assign health_blink_hit = Health && word == 10'h107;
  assign health_blink_write = health_blink_hit && write;
  logic health_clear_hit, health_clear_write;
  assign health_clear_hit = Health && word == 10'h108;
  assign health_clear_write = health_clear_hit && write;
  logic health_report_hit, health_report_write;
  assign health_report_hit = Health && word == 10'h109;
  assign health_report_write = health_report_hit && write;
  logic health_dead_hit;
  assign health_dead_hit = Health && word == 10'h10a;
  logic health_railed_hit;
  assign health_railed_hit = Health && word == 10'h10b;
  logic health_blinking_hit;
  assign health_blinking_hit = Health && word == 10'h10c;
  always_ff @(posedge clk_i) begin
    if (health_band_write) cfg_o.health.band <= (cfg_o.health.band & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (health_jump_write) cfg_o.health.jump <= (cfg_o.health.jump & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (health_low_write) cfg_o.health.low <= (cfg_o.health.low & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (health_high_write) cfg_o.health.high <= (cfg_o.health.high & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (health_use_write) cfg_o.health.use_edges <= (cfg_o.health.use_edges & ~mask[1]) | (bus_wdata_i[1] & mask[1]);
    if (health_use_write) cfg_o.health.use_user <= (cfg_o.health.use_user & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (health_still_write) cfg_o.health.still <= (cfg_o.health.still & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    if (health_rail_write) cfg_o.health.rail <= (cfg_o.health.rail & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    if (health_blink_write) cfg_o.health.blink <= (cfg_o.health.blink & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    cfg_o.health.clear <= health_clear_write && mask[0] && bus_wdata_i[0];
    cfg_o.health.report <= health_report_write && mask[0] && bus_wdata_i[0];
    if (rst_i) begin
      cfg_o.health.band <= Resets[256+:17];
      cfg_o.health.jump <= Resets[273+:17];
      cfg_o.health.low <= Resets[290+:17];
      cfg_o.health.high <= Resets[307+:17];
      cfg_o.health.use_edges <= Resets[325];
      cfg_o.health.use_user <= Resets[324];
      cfg_o.health.still <= Resets[326+:8];
      cfg_o.health.rail <= Resets[334+:8];
      cfg_o.health.blink <= Resets[342+:8];
      cfg_o.health.clear <= 1'b0;
      cfg_o.health.report <= 1'b0;
    end
  end

  // tare
  logic tare_contact_hit, tare_contact_write;
  assign tare_contact_hit = Tare && word == 10'h120;
  assign tare_contact_write = tare_contact_hit && write;
  logic tare_step_hit, tare_step_write;
  assign tare_step_hit = Tare && word == 10'h121;
  assign tare_step_write = tare_step_hit && write;
  logic tare_force_hit, tare_force_write;
  assign tare_force_hit = Tare && word == 10'h122;
  assign tare_force_write = tare_force_hit && write;
  logic tare_at_start_hit, tare_at_start_write;
  assign tare_at_start_hit = Tare && word == 10'h123;
  assign tare_at_start_write = tare_at_start_hit && write;
  logic tare_average_hit, tare_average_write;
  assign tare_average_hit = Tare && word == 10'h124;
  assign tare_average_write = tare_average_hit && write;
  logic tare_load_hit, tare_load_write;
  assign tare_load_hit = Tare && word == 10'h125;
  assign tare_load_write = tare_load_hit && write;
  logic tare_word_hit, tare_word_write;
  assign tare_word_hit = Tare && word == 10'h126;
  assign tare_word_write = tare_word_hit && write;
  logic tare_zero_hit, tare_zero_write;
  assign tare_zero_hit = Tare && word == 10'h127;
  assign tare_zero_write = tare_zero_hit && write;
  logic tare_write_hit, tare_write_write;
  assign tare_write_hit = Tare && word == 10'h128;
  assign tare_write_write = tare_write_hit && write;
  logic tare_state_hit;
  assign tare_state_hit = Tare && word == 10'h129;
  logic tare_tared_hit;
  assign tare_tared_hit = Tare && word == 10'h12a;
  logic tare_refused_hit;
  assign tare_refused_hit = Tare && word == 10'h12b;
  logic tare_swallowed_hit;
  assign tare_swallowed_hit = Tare && word == 10'h12c;
  always_ff @(posedge clk_i) begin
    if (tare_contact_write) cfg_o.tare.contact <= (cfg_o.tare.contact & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (tare_step_write) cfg_o.tare.step <= (cfg_o.tare.step & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    if (tare_force_write) cfg_o.tare.force_ <= (cfg_o.tare.force_ & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (tare_at_start_write) cfg_o.tare.at_start <= (cfg_o.tare.at_start & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    cfg_o.tare.average <= tare_average_write && mask[0] && bus_wdata_i[0];
    if (tare_load_write) cfg_o.tare.load <= (cfg_o.tare.load & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (tare_word_write) cfg_o.tare.word <= (cfg_o.tare.word & ~mask[19:0]) | (bus_wdata_i[19:0] & mask[19:0]);
    if (tare_zero_write) cfg_o.tare.zero <= (cfg_o.tare.zero & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    cfg_o.tare.write_written <= tare_write_write;
    if (tare_write_write) cfg_o.tare.write <= (cfg_o.tare.write & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    if (rst_i) begin
      cfg_o.tare.contact <= Resets[350+:17];
      cfg_o.tare.step <= Resets[367+:8];
      cfg_o.tare.force_ <= Resets[375];
      cfg_o.tare.at_start <= Resets[376];
      cfg_o.tare.average <= 1'b0;
      cfg_o.tare.load <= Resets[377];
      cfg_o.tare.word <= Resets[378+:20];
      cfg_o.tare.zero <= Resets[398+:17];
      cfg_o.tare.write_written <= 1'b0;
      cfg_o.tare.write <= Resets[415+:8];
    end
  end

  // calibrate
  logic calibrate_preset_hit, calibrate_preset_write;
  assign calibrate_preset_hit = Calibrate && word == 10'h140;
  assign calibrate_preset_write = calibrate_preset_hit && write;
  logic calibrate_word_hit, calibrate_word_write;
  assign calibrate_word_hit = Calibrate && word == 10'h141;
  assign calibrate_word_write = calibrate_word_hit && write;
  logic calibrate_offset_hit, calibrate_offset_write;
  assign calibrate_offset_hit = Calibrate && word == 10'h142;
  assign calibrate_offset_write = calibrate_offset_hit && write;
  logic calibrate_gain_hit, calibrate_gain_write;
  assign calibrate_gain_hit = Calibrate && word == 10'h143;
  assign calibrate_gain_write = calibrate_gain_hit && write;
  logic calibrate_write_hit, calibrate_write_write;
  assign calibrate_write_hit = Calibrate && word == 10'h144;
  assign calibrate_write_write = calibrate_write_hit && write;
  logic calibrate_swap_hit, calibrate_swap_write;
  assign calibrate_swap_hit = Calibrate && word == 10'h145;
  assign calibrate_swap_write = calibrate_swap_hit && write;
  logic calibrate_swapping_hit;
  assign calibrate_swapping_hit = Calibrate && word == 10'h146;
  logic [16:0] calibrate_offset_q;
  logic [16:0] calibrate_offset_fit;
  assign calibrate_offset_fit = (&calibrate_offset_q[16:OffsetBits-1] || !(|calibrate_offset_q[16:OffsetBits-1])) ? calibrate_offset_q : {{(18-OffsetBits){calibrate_offset_q[16]}}, {(OffsetBits-1){!calibrate_offset_q[16]}}};
  always_comb cfg_o.calibrate.offset = calibrate_offset_fit;
  always_ff @(posedge clk_i) begin
    if (calibrate_preset_write) cfg_o.calibrate.preset <= (cfg_o.calibrate.preset & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (calibrate_word_write) cfg_o.calibrate.word <= (cfg_o.calibrate.word & ~mask[19:0]) | (bus_wdata_i[19:0] & mask[19:0]);
    if (calibrate_offset_write) calibrate_offset_q <= (calibrate_offset_q & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (calibrate_gain_write) cfg_o.calibrate.gain <= (cfg_o.calibrate.gain & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    cfg_o.calibrate.write_written <= calibrate_write_write;
    if (calibrate_write_write) cfg_o.calibrate.write_row <= (cfg_o.calibrate.write_row & ~mask[8]) | (bus_wdata_i[8] & mask[8]);
    if (calibrate_write_write) cfg_o.calibrate.write_lanes <= (cfg_o.calibrate.write_lanes & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    cfg_o.calibrate.swap <= calibrate_swap_write && mask[0] && bus_wdata_i[0];
    if (rst_i) begin
      cfg_o.calibrate.preset <= Resets[423+:16];
      cfg_o.calibrate.word <= Resets[439+:20];
      calibrate_offset_q <= Resets[459+:17];
      cfg_o.calibrate.gain <= Resets[476+:16];
      cfg_o.calibrate.write_written <= 1'b0;
      cfg_o.calibrate.write_row <= Resets[500];
      cfg_o.calibrate.write_lanes <= Resets[492+:8];
      cfg_o.calibrate.swap <= 1'b0;
    end
  end

  // cop
  logic cop_min_load_hit, cop_min_load_write;
  assign cop_min_load_hit = Cop && word == 10'h180;
  assign cop_min_load_write = cop_min_load_hit && write;
  logic cop_damaged_hit;
  assign cop_damaged_hit = Cop && word == 10'h181;
  logic [31:0] cop_min_load_q;
  logic [31:0] cop_min_load_fit;
  assign cop_min_load_fit = ({1'b0, cop_min_load_q} >> LoadBits) == '0 ? cop_min_load_q : 32'({LoadBits{1'b1}});
  localparam logic [31:0] CopMinLoadReset = Resets[501+:32];
  logic cop_pending;
  always_ff @(posedge clk_i) begin
    if (cop_min_load_write) cop_min_load_q <= (cop_min_load_q & ~mask[31:0]) | (bus_wdata_i[31:0] & mask[31:0]);
    if (commit_i) begin
      cfg_o.cop.min_load <= cop_min_load_fit;
      cop_pending <= 1'b0;
    end
    if (cop_min_load_write) cop_pending <= 1'b1;
    if (rst_i) begin
      cop_min_load_q <= Resets[501+:32];
      cfg_o.cop.min_load <= ({1'b0, CopMinLoadReset} >> LoadBits) == '0 ? CopMinLoadReset : 32'({LoadBits{1'b1}});
      cop_pending <= 1'b0;
    end
  end

  // cop4
  logic cop4_rail_hit, cop4_rail_write;
  assign cop4_rail_hit = Cop4 && word == 10'h1c0;
  assign cop4_rail_write = cop4_rail_hit && write;
  logic cop4_kx_hit, cop4_kx_write;
  assign cop4_kx_hit = Cop4 && word == 10'h1c1;
  assign cop4_kx_write = cop4_kx_hit && write;
  logic cop4_shift_x_hit, cop4_shift_x_write;
  assign cop4_shift_x_hit = Cop4 && word == 10'h1c2;
  assign cop4_shift_x_write = cop4_shift_x_hit && write;
  logic cop4_ky_hit, cop4_ky_write;
  assign cop4_ky_hit = Cop4 && word == 10'h1c3;
  assign cop4_ky_write = cop4_ky_hit && write;
  logic cop4_shift_y_hit, cop4_shift_y_write;
  assign cop4_shift_y_hit = Cop4 && word == 10'h1c4;
  assign cop4_shift_y_write = cop4_shift_y_hit && write;
  logic cop4_kf_hit, cop4_kf_write;
  assign cop4_kf_hit = Cop4 && word == 10'h1c5;
  assign cop4_kf_write = cop4_kf_hit && write;
  logic cop4_shift_load_hit, cop4_shift_load_write;
  assign cop4_shift_load_hit = Cop4 && word == 10'h1c6;
  assign cop4_shift_load_write = cop4_shift_load_hit && write;
  logic cop4_p0_hit, cop4_p0_write;
  assign cop4_p0_hit = Cop4 && word == 10'h1c7;
  assign cop4_p0_write = cop4_p0_hit && write;
  logic cop4_p1_hit, cop4_p1_write;
  assign cop4_p1_hit = Cop4 && word == 10'h1c8;
  assign cop4_p1_write = cop4_p1_hit && write;
  logic cop4_p2_hit, cop4_p2_write;
  assign cop4_p2_hit = Cop4 && word == 10'h1c9;
  assign cop4_p2_write = cop4_p2_hit && write;
  logic cop4_p3_hit, cop4_p3_write;
  assign cop4_p3_hit = Cop4 && word == 10'h1ca;
  assign cop4_p3_write = cop4_p3_hit && write;
  logic cop4_p4_hit, cop4_p4_write;
  assign cop4_p4_hit = Cop4 && word == 10'h1cb;
  assign cop4_p4_write = cop4_p4_hit && write;
  logic cop4_p5_hit, cop4_p5_write;
  assign cop4_p5_hit = Cop4 && word == 10'h1cc;
  assign cop4_p5_write = cop4_p5_hit && write;
  logic cop4_min_load_hit, cop4_min_load_write;
  assign cop4_min_load_hit = Cop4 && word == 10'h1cd;
  assign cop4_min_load_write = cop4_min_load_hit && write;
  logic cop4_top_hit, cop4_top_write;
  assign cop4_top_hit = Cop4 && word == 10'h1ce;
  assign cop4_top_write = cop4_top_hit && write;
  logic cop4_idle_hit, cop4_idle_write;
  assign cop4_idle_hit = Cop4 && word == 10'h1cf;
  assign cop4_idle_write = cop4_idle_hit && write;
  logic cop4_busy_hit, cop4_busy_write;
  assign cop4_busy_hit = Cop4 && word == 10'h1d0;
  assign cop4_busy_write = cop4_busy_hit && write;
  logic cop4_imbalance_hit, cop4_imbalance_write;
  assign cop4_imbalance_hit = Cop4 && word == 10'h1d1;
  assign cop4_imbalance_write = cop4_imbalance_hit && write;
  logic [16:0] cop4_rail_q;
  logic [16:0] cop4_kx_q;
  logic [3:0] cop4_shift_x_q;
  logic [16:0] cop4_ky_q;
  logic [3:0] cop4_shift_y_q;
  logic [16:0] cop4_kf_q;
  logic [3:0] cop4_shift_load_q;
  logic [17:0] cop4_p0_q;
  logic [17:0] cop4_p1_q;
  logic [17:0] cop4_p2_q;
  logic [17:0] cop4_p3_q;
  logic [17:0] cop4_p4_q;
  logic [17:0] cop4_p5_q;
  logic [15:0] cop4_min_load_q;
  logic [15:0] cop4_top_q;
  logic [16:0] cop4_idle_q;
  logic [16:0] cop4_busy_q;
  logic [17:0] cop4_imbalance_q;
  logic cop4_pending;
  always_ff @(posedge clk_i) begin
    if (cop4_rail_write) cop4_rail_q <= (cop4_rail_q & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (cop4_kx_write) cop4_kx_q <= (cop4_kx_q & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (cop4_shift_x_write) cop4_shift_x_q <= (cop4_shift_x_q & ~mask[3:0]) | (bus_wdata_i[3:0] & mask[3:0]);
    if (cop4_ky_write) cop4_ky_q <= (cop4_ky_q & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (cop4_shift_y_write) cop4_shift_y_q <= (cop4_shift_y_q & ~mask[3:0]) | (bus_wdata_i[3:0] & mask[3:0]);
    if (cop4_kf_write) cop4_kf_q <= (cop4_kf_q & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (cop4_shift_load_write) cop4_shift_load_q <= (cop4_shift_load_q & ~mask[3:0]) | (bus_wdata_i[3:0] & mask[3:0]);
    if (cop4_p0_write) cop4_p0_q <= (cop4_p0_q & ~mask[17:0]) | (bus_wdata_i[17:0] & mask[17:0]);
    if (cop4_p1_write) cop4_p1_q <= (cop4_p1_q & ~mask[17:0]) | (bus_wdata_i[17:0] & mask[17:0]);
    if (cop4_p2_write) cop4_p2_q <= (cop4_p2_q & ~mask[17:0]) | (bus_wdata_i[17:0] & mask[17:0]);
    if (cop4_p3_write) cop4_p3_q <= (cop4_p3_q & ~mask[17:0]) | (bus_wdata_i[17:0] & mask[17:0]);
    if (cop4_p4_write) cop4_p4_q <= (cop4_p4_q & ~mask[17:0]) | (bus_wdata_i[17:0] & mask[17:0]);
    if (cop4_p5_write) cop4_p5_q <= (cop4_p5_q & ~mask[17:0]) | (bus_wdata_i[17:0] & mask[17:0]);
    if (cop4_min_load_write) cop4_min_load_q <= (cop4_min_load_q & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (cop4_top_write) cop4_top_q <= (cop4_top_q & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (cop4_idle_write) cop4_idle_q <= (cop4_idle_q & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (cop4_busy_write) cop4_busy_q <= (cop4_busy_q & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (cop4_imbalance_write) cop4_imbalance_q <= (cop4_imbalance_q & ~mask[17:0]) | (bus_wdata_i[17:0] & mask[17:0]);
    if (commit_i) begin
      cfg_o.cop4.rail <= cop4_rail_q;
      cfg_o.cop4.kx <= cop4_kx_q;
      cfg_o.cop4.shift_x <= cop4_shift_x_q;
      cfg_o.cop4.ky <= cop4_ky_q;
      cfg_o.cop4.shift_y <= cop4_shift_y_q;
      cfg_o.cop4.kf <= cop4_kf_q;
      cfg_o.cop4.shift_load <= cop4_shift_load_q;
      cfg_o.cop4.p0 <= cop4_p0_q;
      cfg_o.cop4.p1 <= cop4_p1_q;
      cfg_o.cop4.p2 <= cop4_p2_q;
      cfg_o.cop4.p3 <= cop4_p3_q;
      cfg_o.cop4.p4 <= cop4_p4_q;
      cfg_o.cop4.p5 <= cop4_p5_q;
      cfg_o.cop4.min_load <= cop4_min_load_q;
      cfg_o.cop4.top <= cop4_top_q;
      cfg_o.cop4.idle <= cop4_idle_q;
      cfg_o.cop4.busy <= cop4_busy_q;
      cfg_o.cop4.imbalance <= cop4_imbalance_q;
      cop4_pending <= 1'b0;
    end
    if (cop4_rail_write || cop4_kx_write || cop4_shift_x_write || cop4_ky_write || cop4_shift_y_write || cop4_kf_write || cop4_shift_load_write || cop4_p0_write || cop4_p1_write || cop4_p2_write || cop4_p3_write || cop4_p4_write || cop4_p5_write || cop4_min_load_write || cop4_top_write || cop4_idle_write || cop4_busy_write || cop4_imbalance_write) cop4_pending <= 1'b1;
    if (rst_i) begin
      cop4_rail_q <= Resets[533+:17];
      cfg_o.cop4.rail <= Resets[533+:17];
      cop4_kx_q <= Resets[550+:17];
      cfg_o.cop4.kx <= Resets[550+:17];
      cop4_shift_x_q <= Resets[567+:4];
      cfg_o.cop4.shift_x <= Resets[567+:4];
      cop4_ky_q <= Resets[571+:17];
      cfg_o.cop4.ky <= Resets[571+:17];
      cop4_shift_y_q <= Resets[588+:4];
      cfg_o.cop4.shift_y <= Resets[588+:4];
      cop4_kf_q <= Resets[592+:17];
      cfg_o.cop4.kf <= Resets[592+:17];
      cop4_shift_load_q <= Resets[609+:4];
      cfg_o.cop4.shift_load <= Resets[609+:4];
      cop4_p0_q <= Resets[613+:18];
      cfg_o.cop4.p0 <= Resets[613+:18];
      cop4_p1_q <= Resets[631+:18];
      cfg_o.cop4.p1 <= Resets[631+:18];
      cop4_p2_q <= Resets[649+:18];
      cfg_o.cop4.p2 <= Resets[649+:18];
      cop4_p3_q <= Resets[667+:18];
      cfg_o.cop4.p3 <= Resets[667+:18];
      cop4_p4_q <= Resets[685+:18];
      cfg_o.cop4.p4 <= Resets[685+:18];
      cop4_p5_q <= Resets[703+:18];
      cfg_o.cop4.p5 <= Resets[703+:18];
      cop4_min_load_q <= Resets[721+:16];
      cfg_o.cop4.min_load <= Resets[721+:16];
      cop4_top_q <= Resets[737+:16];
      cfg_o.cop4.top <= Resets[737+:16];
      cop4_idle_q <= Resets[753+:17];
      cfg_o.cop4.idle <= Resets[753+:17];
      cop4_busy_q <= Resets[770+:17];
      cfg_o.cop4.busy <= Resets[770+:17];
      cop4_imbalance_q <= Resets[787+:18];
      cfg_o.cop4.imbalance <= Resets[787+:18];
      cop4_pending <= 1'b0;
    end
  end

  // cop_slip
  logic cop_slip_drop_hit, cop_slip_drop_write;
  assign cop_slip_drop_hit = CopSlip && word == 10'h200;
  assign cop_slip_drop_write = cop_slip_drop_hit && write;
  logic cop_slip_move_hit, cop_slip_move_write;
  assign cop_slip_move_hit = CopSlip && word == 10'h201;
  assign cop_slip_move_write = cop_slip_move_hit && write;
  logic cop_slip_min_load_hit, cop_slip_min_load_write;
  assign cop_slip_min_load_hit = CopSlip && word == 10'h202;
  assign cop_slip_min_load_write = cop_slip_min_load_hit && write;
  logic cop_slip_hold_hit, cop_slip_hold_write;
  assign cop_slip_hold_hit = CopSlip && word == 10'h203;
  assign cop_slip_hold_write = cop_slip_hold_hit && write;
  logic cop_slip_refractory_hit, cop_slip_refractory_write;
  assign cop_slip_refractory_hit = CopSlip && word == 10'h204;
  assign cop_slip_refractory_write = cop_slip_refractory_hit && write;
  logic [7:0] cop_slip_drop_q;
  logic [15:0] cop_slip_move_q;
  logic [15:0] cop_slip_min_load_q;
  logic [15:0] cop_slip_hold_q;
  logic [15:0] cop_slip_refractory_q;
  logic cop_slip_pending;
  always_ff @(posedge clk_i) begin
    if (cop_slip_drop_write) cop_slip_drop_q <= (cop_slip_drop_q & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    if (cop_slip_move_write) cop_slip_move_q <= (cop_slip_move_q & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (cop_slip_min_load_write) cop_slip_min_load_q <= (cop_slip_min_load_q & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (cop_slip_hold_write) cop_slip_hold_q <= (cop_slip_hold_q & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (cop_slip_refractory_write) cop_slip_refractory_q <= (cop_slip_refractory_q & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (commit_i) begin
      cfg_o.cop_slip.drop <= cop_slip_drop_q;
      cfg_o.cop_slip.move <= cop_slip_move_q;
      cfg_o.cop_slip.min_load <= cop_slip_min_load_q;
      cfg_o.cop_slip.hold <= cop_slip_hold_q;
      cfg_o.cop_slip.refractory <= cop_slip_refractory_q;
      cop_slip_pending <= 1'b0;
    end
    if (cop_slip_drop_write || cop_slip_move_write || cop_slip_min_load_write || cop_slip_hold_write || cop_slip_refractory_write) cop_slip_pending <= 1'b1;
    if (rst_i) begin
      cop_slip_drop_q <= Resets[805+:8];
      cfg_o.cop_slip.drop <= Resets[805+:8];
      cop_slip_move_q <= Resets[813+:16];
      cfg_o.cop_slip.move <= Resets[813+:16];
      cop_slip_min_load_q <= Resets[829+:16];
      cfg_o.cop_slip.min_load <= Resets[829+:16];
      cop_slip_hold_q <= Resets[845+:16];
      cfg_o.cop_slip.hold <= Resets[845+:16];
      cop_slip_refractory_q <= Resets[861+:16];
      cfg_o.cop_slip.refractory <= Resets[861+:16];
      cop_slip_pending <= 1'b0;
    end
  end

  // link
  logic link_images_hit, link_images_write;
  assign link_images_hit = Link && word == 10'h240;
  assign link_images_write = link_images_hit && write;
  logic link_packets_hit;
  assign link_packets_hit = Link && word == 10'h241;
  logic link_cop_dropped_hit;
  assign link_cop_dropped_hit = Link && word == 10'h242;
  logic link_image_dropped_hit;
  assign link_image_dropped_hit = Link && word == 10'h243;
  logic link_rejected_hit;
  assign link_rejected_hit = Link && word == 10'h244;
  always_ff @(posedge clk_i) begin
    if (link_images_write) cfg_o.link.images <= (cfg_o.link.images & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (rst_i) begin
      cfg_o.link.images <= Resets[877];
    end
  end

  // grip
  logic grip_enable_hit, grip_enable_write;
  assign grip_enable_hit = Grip && word == 10'h280;
  assign grip_enable_write = grip_enable_hit && write;
  logic grip_period_hit, grip_period_write;
  assign grip_period_hit = Grip && word == 10'h281;
  assign grip_period_write = grip_period_hit && write;
  logic grip_step_hit, grip_step_write;
  assign grip_step_hit = Grip && word == 10'h282;
  assign grip_step_write = grip_step_hit && write;
  logic grip_decay_hit, grip_decay_write;
  assign grip_decay_hit = Grip && word == 10'h283;
  assign grip_decay_write = grip_decay_hit && write;
  logic grip_minimum_hit, grip_minimum_write;
  assign grip_minimum_hit = Grip && word == 10'h284;
  assign grip_minimum_write = grip_minimum_hit && write;
  logic grip_maximum_hit, grip_maximum_write;
  assign grip_maximum_hit = Grip && word == 10'h285;
  assign grip_maximum_write = grip_maximum_hit && write;
  logic grip_rate_hit, grip_rate_write;
  assign grip_rate_hit = Grip && word == 10'h286;
  assign grip_rate_write = grip_rate_hit && write;
  logic grip_watchdog_hit, grip_watchdog_write;
  assign grip_watchdog_hit = Grip && word == 10'h287;
  assign grip_watchdog_write = grip_watchdog_hit && write;
  logic grip_rule_hit, grip_rule_write;
  assign grip_rule_hit = Grip && word == 10'h288;
  assign grip_rule_write = grip_rule_hit && write;
  logic grip_mode_hit, grip_mode_write;
  assign grip_mode_hit = Grip && word == 10'h289;
  assign grip_mode_write = grip_mode_hit && write;
  logic grip_immediate_hit, grip_immediate_write;
  assign grip_immediate_hit = Grip && word == 10'h28a;
  assign grip_immediate_write = grip_immediate_hit && write;
  logic grip_override_hit, grip_override_write;
  assign grip_override_hit = Grip && word == 10'h28b;
  assign grip_override_write = grip_override_hit && write;
  logic grip_override_value_hit, grip_override_value_write;
  assign grip_override_value_hit = Grip && word == 10'h28c;
  assign grip_override_value_write = grip_override_value_hit && write;
  logic grip_divide_hit, grip_divide_write;
  assign grip_divide_hit = Grip && word == 10'h28d;
  assign grip_divide_write = grip_divide_hit && write;
  logic grip_low_hit, grip_low_write;
  assign grip_low_hit = Grip && word == 10'h28e;
  assign grip_low_write = grip_low_hit && write;
  logic grip_high_hit, grip_high_write;
  assign grip_high_hit = Grip && word == 10'h28f;
  assign grip_high_write = grip_high_hit && write;
  logic grip_rail_hit, grip_rail_write;
  assign grip_rail_hit = Grip && word == 10'h290;
  assign grip_rail_write = grip_rail_hit && write;
  logic grip_command_hit;
  assign grip_command_hit = Grip && word == 10'h291;
  logic grip_increment_hit;
  assign grip_increment_hit = Grip && word == 10'h292;
  logic grip_fault_hit;
  assign grip_fault_hit = Grip && word == 10'h293;
  logic grip_faulty_hit;
  assign grip_faulty_hit = Grip && word == 10'h294;
  logic grip_commands_hit;
  assign grip_commands_hit = Grip && word == 10'h295;
  logic grip_tightenings_hit;
  assign grip_tightenings_hit = Grip && word == 10'h296;
  logic grip_speed_gain_hit, grip_speed_gain_write;
  assign grip_speed_gain_hit = Grip && word == 10'h297;
  assign grip_speed_gain_write = grip_speed_gain_hit && write;
  logic grip_boost_hit, grip_boost_write;
  assign grip_boost_hit = Grip && word == 10'h298;
  assign grip_boost_write = grip_boost_hit && write;
  always_ff @(posedge clk_i) begin
    if (grip_enable_write) cfg_o.grip.enable <= (cfg_o.grip.enable & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (grip_period_write) cfg_o.grip.period <= (cfg_o.grip.period & ~mask[23:0]) | (bus_wdata_i[23:0] & mask[23:0]);
    if (grip_step_write) cfg_o.grip.step <= (cfg_o.grip.step & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (grip_decay_write) cfg_o.grip.decay <= (cfg_o.grip.decay & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (grip_minimum_write) cfg_o.grip.minimum <= (cfg_o.grip.minimum & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (grip_maximum_write) cfg_o.grip.maximum <= (cfg_o.grip.maximum & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (grip_rate_write) cfg_o.grip.rate <= (cfg_o.grip.rate & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (grip_watchdog_write) cfg_o.grip.watchdog <= (cfg_o.grip.watchdog & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (grip_rule_write) cfg_o.grip.rule <= (cfg_o.grip.rule & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (grip_mode_write) cfg_o.grip.mode <= (cfg_o.grip.mode & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (grip_immediate_write) cfg_o.grip.immediate <= (cfg_o.grip.immediate & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (grip_override_write) cfg_o.grip.override_ <= (cfg_o.grip.override_ & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (grip_override_value_write) cfg_o.grip.override_value <= (cfg_o.grip.override_value & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (grip_divide_write) cfg_o.grip.divide <= (cfg_o.grip.divide & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    if (grip_low_write) cfg_o.grip.low <= (cfg_o.grip.low & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (grip_high_write) cfg_o.grip.high <= (cfg_o.grip.high & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (grip_rail_write) cfg_o.grip.rail <= (cfg_o.grip.rail & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    if (grip_speed_gain_write) cfg_o.grip.speed_gain <= (cfg_o.grip.speed_gain & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (grip_boost_write) cfg_o.grip.boost <= (cfg_o.grip.boost & ~mask[2:0]) | (bus_wdata_i[2:0] & mask[2:0]);
    if (rst_i) begin
      cfg_o.grip.enable <= Resets[878];
      cfg_o.grip.period <= Resets[879+:24];
      cfg_o.grip.step <= Resets[903+:16];
      cfg_o.grip.decay <= Resets[919+:16];
      cfg_o.grip.minimum <= Resets[935+:16];
      cfg_o.grip.maximum <= Resets[951+:16];
      cfg_o.grip.rate <= Resets[967+:16];
      cfg_o.grip.watchdog <= Resets[983+:16];
      cfg_o.grip.rule <= Resets[999];
      cfg_o.grip.mode <= Resets[1000];
      cfg_o.grip.immediate <= Resets[1001];
      cfg_o.grip.override_ <= Resets[1002];
      cfg_o.grip.override_value <= Resets[1003+:16];
      cfg_o.grip.divide <= Resets[1019+:8];
      cfg_o.grip.low <= Resets[1027+:17];
      cfg_o.grip.high <= Resets[1044+:17];
      cfg_o.grip.rail <= Resets[1061+:8];
      cfg_o.grip.speed_gain <= Resets[1069+:16];
      cfg_o.grip.boost <= Resets[1085+:3];
    end
  end

  // shear_speed
  logic shear_speed_enable_hit, shear_speed_enable_write;
  assign shear_speed_enable_hit = ShearSpeed && word == 10'h2c0;
  assign shear_speed_enable_write = shear_speed_enable_hit && write;
  logic shear_speed_k0_hit, shear_speed_k0_write;
  assign shear_speed_k0_hit = ShearSpeed && word == 10'h2c1;
  assign shear_speed_k0_write = shear_speed_k0_hit && write;
  logic shear_speed_k1_hit, shear_speed_k1_write;
  assign shear_speed_k1_hit = ShearSpeed && word == 10'h2c2;
  assign shear_speed_k1_write = shear_speed_k1_hit && write;
  logic shear_speed_exponent_hit, shear_speed_exponent_write;
  assign shear_speed_exponent_hit = ShearSpeed && word == 10'h2c3;
  assign shear_speed_exponent_write = shear_speed_exponent_hit && write;
  logic shear_speed_vi_min_hit, shear_speed_vi_min_write;
  assign shear_speed_vi_min_hit = ShearSpeed && word == 10'h2c4;
  assign shear_speed_vi_min_write = shear_speed_vi_min_hit && write;
  logic shear_speed_vi_max_hit, shear_speed_vi_max_write;
  assign shear_speed_vi_max_hit = ShearSpeed && word == 10'h2c5;
  assign shear_speed_vi_max_write = shear_speed_vi_max_hit && write;
  logic shear_speed_noise_hit, shear_speed_noise_write;
  assign shear_speed_noise_hit = ShearSpeed && word == 10'h2c6;
  assign shear_speed_noise_write = shear_speed_noise_hit && write;
  logic shear_speed_still_hit, shear_speed_still_write;
  assign shear_speed_still_hit = ShearSpeed && word == 10'h2c7;
  assign shear_speed_still_write = shear_speed_still_hit && write;
  logic shear_speed_full_hit, shear_speed_full_write;
  assign shear_speed_full_hit = ShearSpeed && word == 10'h2c8;
  assign shear_speed_full_write = shear_speed_full_hit && write;
  logic shear_speed_limit_hit, shear_speed_limit_write;
  assign shear_speed_limit_hit = ShearSpeed && word == 10'h2c9;
  assign shear_speed_limit_write = shear_speed_limit_hit && write;
  logic shear_speed_travel_hit, shear_speed_travel_write;
  assign shear_speed_travel_hit = ShearSpeed && word == 10'h2ca;
  assign shear_speed_travel_write = shear_speed_travel_hit && write;
  logic shear_speed_hold_hit, shear_speed_hold_write;
  assign shear_speed_hold_hit = ShearSpeed && word == 10'h2cb;
  assign shear_speed_hold_write = shear_speed_hold_hit && write;
  logic shear_speed_hold_cycles_hit, shear_speed_hold_cycles_write;
  assign shear_speed_hold_cycles_hit = ShearSpeed && word == 10'h2cc;
  assign shear_speed_hold_cycles_write = shear_speed_hold_cycles_hit && write;
  logic shear_speed_select_hit, shear_speed_select_write;
  assign shear_speed_select_hit = ShearSpeed && word == 10'h2cd;
  assign shear_speed_select_write = shear_speed_select_hit && write;
  logic shear_speed_channel0_hit;
  assign shear_speed_channel0_hit = ShearSpeed && word == 10'h2ce;
  logic shear_speed_channel1_hit;
  assign shear_speed_channel1_hit = ShearSpeed && word == 10'h2cf;
  logic shear_speed_channel2_hit;
  assign shear_speed_channel2_hit = ShearSpeed && word == 10'h2d0;
  logic shear_speed_channel3_hit;
  assign shear_speed_channel3_hit = ShearSpeed && word == 10'h2d1;
  logic shear_speed_channel4_hit;
  assign shear_speed_channel4_hit = ShearSpeed && word == 10'h2d2;
  logic shear_speed_channel5_hit;
  assign shear_speed_channel5_hit = ShearSpeed && word == 10'h2d3;
  logic shear_speed_channel6_hit;
  assign shear_speed_channel6_hit = ShearSpeed && word == 10'h2d4;
  logic shear_speed_channel7_hit;
  assign shear_speed_channel7_hit = ShearSpeed && word == 10'h2d5;
  logic shear_speed_vi_hit;
  assign shear_speed_vi_hit = ShearSpeed && word == 10'h2d6;
  logic shear_speed_rise_hit;
  assign shear_speed_rise_hit = ShearSpeed && word == 10'h2d7;
  logic shear_speed_windows_hit;
  assign shear_speed_windows_hit = ShearSpeed && word == 10'h2d8;
  always_ff @(posedge clk_i) begin
    if (shear_speed_enable_write) cfg_o.shear_speed.enable <= (cfg_o.shear_speed.enable & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (shear_speed_k0_write) cfg_o.shear_speed.k0 <= (cfg_o.shear_speed.k0 & ~mask[25:0]) | (bus_wdata_i[25:0] & mask[25:0]);
    if (shear_speed_k1_write) cfg_o.shear_speed.k1 <= (cfg_o.shear_speed.k1 & ~mask[17:0]) | (bus_wdata_i[17:0] & mask[17:0]);
    if (shear_speed_exponent_write) cfg_o.shear_speed.exponent <= (cfg_o.shear_speed.exponent & ~mask[15:0]) | (bus_wdata_i[15:0] & mask[15:0]);
    if (shear_speed_vi_min_write) cfg_o.shear_speed.vi_min <= (cfg_o.shear_speed.vi_min & ~mask[25:0]) | (bus_wdata_i[25:0] & mask[25:0]);
    if (shear_speed_vi_max_write) cfg_o.shear_speed.vi_max <= (cfg_o.shear_speed.vi_max & ~mask[25:0]) | (bus_wdata_i[25:0] & mask[25:0]);
    if (shear_speed_noise_write) cfg_o.shear_speed.noise <= (cfg_o.shear_speed.noise & ~mask[25:0]) | (bus_wdata_i[25:0] & mask[25:0]);
    if (shear_speed_still_write) cfg_o.shear_speed.still <= (cfg_o.shear_speed.still & ~mask[25:0]) | (bus_wdata_i[25:0] & mask[25:0]);
    if (shear_speed_full_write) cfg_o.shear_speed.full <= (cfg_o.shear_speed.full & ~mask[16:0]) | (bus_wdata_i[16:0] & mask[16:0]);
    if (shear_speed_limit_write) cfg_o.shear_speed.limit <= (cfg_o.shear_speed.limit & ~mask[23:0]) | (bus_wdata_i[23:0] & mask[23:0]);
    if (shear_speed_travel_write) cfg_o.shear_speed.travel <= (cfg_o.shear_speed.travel & ~mask[31:0]) | (bus_wdata_i[31:0] & mask[31:0]);
    if (shear_speed_hold_write) cfg_o.shear_speed.hold <= (cfg_o.shear_speed.hold & ~mask[0]) | (bus_wdata_i[0] & mask[0]);
    if (shear_speed_hold_cycles_write) cfg_o.shear_speed.hold_cycles <= (cfg_o.shear_speed.hold_cycles & ~mask[7:0]) | (bus_wdata_i[7:0] & mask[7:0]);
    if (shear_speed_select_write) cfg_o.shear_speed.select <= (cfg_o.shear_speed.select & ~mask[2:0]) | (bus_wdata_i[2:0] & mask[2:0]);
    if (rst_i) begin
      cfg_o.shear_speed.enable <= Resets[1088];
      cfg_o.shear_speed.k0 <= Resets[1089+:26];
      cfg_o.shear_speed.k1 <= Resets[1115+:18];
      cfg_o.shear_speed.exponent <= Resets[1133+:16];
      cfg_o.shear_speed.vi_min <= Resets[1149+:26];
      cfg_o.shear_speed.vi_max <= Resets[1175+:26];
      cfg_o.shear_speed.noise <= Resets[1201+:26];
      cfg_o.shear_speed.still <= Resets[1227+:26];
      cfg_o.shear_speed.full <= Resets[1253+:17];
      cfg_o.shear_speed.limit <= Resets[1270+:24];
      cfg_o.shear_speed.travel <= Resets[1294+:32];
      cfg_o.shear_speed.hold <= Resets[1326];
      cfg_o.shear_speed.hold_cycles <= Resets[1327+:8];
      cfg_o.shear_speed.select <= Resets[1335+:3];
    end
  end

  assign pending_o = slip_pending || cop_pending || cop4_pending || cop_slip_pending;

  // Which register, a clock after the address: decoding takes one clock, the word another.
  logic core_id_hit_q, core_version_hit_q, core_features_hit_q, core_size_hit_q, core_clk_khz_hit_q, core_scratch_hit_q, core_widths_hit_q, core_beats_hit_q, adc_enable_hit_q, adc_period_hit_q, adc_dropped_hit_q, adc_overrun_hit_q, adc_timeout_hit_q, adc_mistagged_hit_q, adc_over_range_hit_q, slip_threshold_hit_q, slip_gross_threshold_hit_q, slip_contact_level_hit_q, slip_release_level_hit_q, slip_contact_rises_hit_q, slip_hold_hit_q, slip_refractory_hit_q, slip_blank_hit_q, slip_damaged_hit_q, slip_blanked_hit_q, slip_keep_threshold_hit_q, scan_enable_hit_q, scan_settle_hit_q, scan_period_hit_q, scan_interleave_hit_q, scan_dropped_hit_q, scan_overrun_hit_q, scan_held_hit_q, scan_lost_hit_q, health_band_hit_q, health_jump_hit_q, health_low_hit_q, health_high_hit_q, health_use_hit_q, health_still_hit_q, health_rail_hit_q, health_blink_hit_q, health_clear_hit_q, health_report_hit_q, health_dead_hit_q, health_railed_hit_q, health_blinking_hit_q, tare_contact_hit_q, tare_step_hit_q, tare_force_hit_q, tare_at_start_hit_q, tare_average_hit_q, tare_load_hit_q, tare_word_hit_q, tare_zero_hit_q, tare_write_hit_q, tare_state_hit_q, tare_tared_hit_q, tare_refused_hit_q, tare_swallowed_hit_q, calibrate_preset_hit_q, calibrate_word_hit_q, calibrate_offset_hit_q, calibrate_gain_hit_q, calibrate_write_hit_q, calibrate_swap_hit_q, calibrate_swapping_hit_q, cop_min_load_hit_q, cop_damaged_hit_q, cop4_rail_hit_q, cop4_kx_hit_q, cop4_shift_x_hit_q, cop4_ky_hit_q, cop4_shift_y_hit_q, cop4_kf_hit_q, cop4_shift_load_hit_q, cop4_p0_hit_q, cop4_p1_hit_q, cop4_p2_hit_q, cop4_p3_hit_q, cop4_p4_hit_q, cop4_p5_hit_q, cop4_min_load_hit_q, cop4_top_hit_q, cop4_idle_hit_q, cop4_busy_hit_q, cop4_imbalance_hit_q, cop_slip_drop_hit_q, cop_slip_move_hit_q, cop_slip_min_load_hit_q, cop_slip_hold_hit_q, cop_slip_refractory_hit_q, link_images_hit_q, link_packets_hit_q, link_cop_dropped_hit_q, link_image_dropped_hit_q, link_rejected_hit_q, grip_enable_hit_q, grip_period_hit_q, grip_step_hit_q, grip_decay_hit_q, grip_minimum_hit_q, grip_maximum_hit_q, grip_rate_hit_q, grip_watchdog_hit_q, grip_rule_hit_q, grip_mode_hit_q, grip_immediate_hit_q, grip_override_hit_q, grip_override_value_hit_q, grip_divide_hit_q, grip_low_hit_q, grip_high_hit_q, grip_rail_hit_q, grip_command_hit_q, grip_increment_hit_q, grip_fault_hit_q, grip_faulty_hit_q, grip_commands_hit_q, grip_tightenings_hit_q, grip_speed_gain_hit_q, grip_boost_hit_q, shear_speed_enable_hit_q, shear_speed_k0_hit_q, shear_speed_k1_hit_q, shear_speed_exponent_hit_q, shear_speed_vi_min_hit_q, shear_speed_vi_max_hit_q, shear_speed_noise_hit_q, shear_speed_still_hit_q, shear_speed_full_hit_q, shear_speed_limit_hit_q, shear_speed_travel_hit_q, shear_speed_hold_hit_q, shear_speed_hold_cycles_hit_q, shear_speed_select_hit_q, shear_speed_channel0_hit_q, shear_speed_channel1_hit_q, shear_speed_channel2_hit_q, shear_speed_channel3_hit_q, shear_speed_channel4_hit_q, shear_speed_channel5_hit_q, shear_speed_channel6_hit_q, shear_speed_channel7_hit_q, shear_speed_vi_hit_q, shear_speed_rise_hit_q, shear_speed_windows_hit_q;
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
    grip_enable_hit_q <= grip_enable_hit;
    grip_period_hit_q <= grip_period_hit;
    grip_step_hit_q <= grip_step_hit;
    grip_decay_hit_q <= grip_decay_hit;
    grip_minimum_hit_q <= grip_minimum_hit;
    grip_maximum_hit_q <= grip_maximum_hit;
    grip_rate_hit_q <= grip_rate_hit;
    grip_watchdog_hit_q <= grip_watchdog_hit;
    grip_rule_hit_q <= grip_rule_hit;
    grip_mode_hit_q <= grip_mode_hit;
    grip_immediate_hit_q <= grip_immediate_hit;
    grip_override_hit_q <= grip_override_hit;
    grip_override_value_hit_q <= grip_override_value_hit;
    grip_divide_hit_q <= grip_divide_hit;
    grip_low_hit_q <= grip_low_hit;
    grip_high_hit_q <= grip_high_hit;
    grip_rail_hit_q <= grip_rail_hit;
    grip_command_hit_q <= grip_command_hit;
    grip_increment_hit_q <= grip_increment_hit;
    grip_fault_hit_q <= grip_fault_hit;
    grip_faulty_hit_q <= grip_faulty_hit;
    grip_commands_hit_q <= grip_commands_hit;
    grip_tightenings_hit_q <= grip_tightenings_hit;
    grip_speed_gain_hit_q <= grip_speed_gain_hit;
    grip_boost_hit_q <= grip_boost_hit;
    shear_speed_enable_hit_q <= shear_speed_enable_hit;
    shear_speed_k0_hit_q <= shear_speed_k0_hit;
    shear_speed_k1_hit_q <= shear_speed_k1_hit;
    shear_speed_exponent_hit_q <= shear_speed_exponent_hit;
    shear_speed_vi_min_hit_q <= shear_speed_vi_min_hit;
    shear_speed_vi_max_hit_q <= shear_speed_vi_max_hit;
    shear_speed_noise_hit_q <= shear_speed_noise_hit;
    shear_speed_still_hit_q <= shear_speed_still_hit;
    shear_speed_full_hit_q <= shear_speed_full_hit;
    shear_speed_limit_hit_q <= shear_speed_limit_hit;
    shear_speed_travel_hit_q <= shear_speed_travel_hit;
    shear_speed_hold_hit_q <= shear_speed_hold_hit;
    shear_speed_hold_cycles_hit_q <= shear_speed_hold_cycles_hit;
    shear_speed_select_hit_q <= shear_speed_select_hit;
    shear_speed_channel0_hit_q <= shear_speed_channel0_hit;
    shear_speed_channel1_hit_q <= shear_speed_channel1_hit;
    shear_speed_channel2_hit_q <= shear_speed_channel2_hit;
    shear_speed_channel3_hit_q <= shear_speed_channel3_hit;
    shear_speed_channel4_hit_q <= shear_speed_channel4_hit;
    shear_speed_channel5_hit_q <= shear_speed_channel5_hit;
    shear_speed_channel6_hit_q <= shear_speed_channel6_hit;
    shear_speed_channel7_hit_q <= shear_speed_channel7_hit;
    shear_speed_vi_hit_q <= shear_speed_vi_hit;
    shear_speed_rise_hit_q <= shear_speed_rise_hit;
    shear_speed_windows_hit_q <= shear_speed_windows_hit;
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
      || link_rejected_hit_q
      || grip_enable_hit_q
      || grip_period_hit_q
      || grip_step_hit_q
      || grip_decay_hit_q
      || grip_minimum_hit_q
      || grip_maximum_hit_q
      || grip_rate_hit_q
      || grip_watchdog_hit_q
      || grip_rule_hit_q
      || grip_mode_hit_q
      || grip_immediate_hit_q
      || grip_override_hit_q
      || grip_override_value_hit_q
      || grip_divide_hit_q
      || grip_low_hit_q
      || grip_high_hit_q
      || grip_rail_hit_q
      || grip_command_hit_q
      || grip_increment_hit_q
      || grip_fault_hit_q
      || grip_faulty_hit_q
      || grip_commands_hit_q
      || grip_tightenings_hit_q
      || grip_speed_gain_hit_q
      || grip_boost_hit_q
      || shear_speed_enable_hit_q
      || shear_speed_k0_hit_q
      || shear_speed_k1_hit_q
      || shear_speed_exponent_hit_q
      || shear_speed_vi_min_hit_q
      || shear_speed_vi_max_hit_q
      || shear_speed_noise_hit_q
      || shear_speed_still_hit_q
      || shear_speed_full_hit_q
      || shear_speed_limit_hit_q
      || shear_speed_travel_hit_q
      || shear_speed_hold_hit_q
      || shear_speed_hold_cycles_hit_q
      || shear_speed_select_hit_q
      || shear_speed_channel0_hit_q
      || shear_speed_channel1_hit_q
      || shear_speed_channel2_hit_q
      || shear_speed_channel3_hit_q
      || shear_speed_channel4_hit_q
      || shear_speed_channel5_hit_q
      || shear_speed_channel6_hit_q
      || shear_speed_channel7_hit_q
      || shear_speed_vi_hit_q
      || shear_speed_rise_hit_q
      || shear_speed_windows_hit_q;
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
      || link_images_hit_q
      || grip_enable_hit_q
      || grip_period_hit_q
      || grip_step_hit_q
      || grip_decay_hit_q
      || grip_minimum_hit_q
      || grip_maximum_hit_q
      || grip_rate_hit_q
      || grip_watchdog_hit_q
      || grip_rule_hit_q
      || grip_mode_hit_q
      || grip_immediate_hit_q
      || grip_override_hit_q
      || grip_override_value_hit_q
      || grip_divide_hit_q
      || grip_low_hit_q
      || grip_high_hit_q
      || grip_rail_hit_q
      || grip_speed_gain_hit_q
      || grip_boost_hit_q
      || shear_speed_enable_hit_q
      || shear_speed_k0_hit_q
      || shear_speed_k1_hit_q
      || shear_speed_exponent_hit_q
      || shear_speed_vi_min_hit_q
      || shear_speed_vi_max_hit_q
      || shear_speed_noise_hit_q
      || shear_speed_still_hit_q
      || shear_speed_full_hit_q
      || shear_speed_limit_hit_q
      || shear_speed_travel_hit_q
      || shear_speed_hold_hit_q
      || shear_speed_hold_cycles_hit_q
      || shear_speed_select_hit_q;

  logic [31:0] read_word;
  assign read_word = ({32{core_id_hit_q}} & 32'h4d534e52)
      | ({32{core_version_hit_q}} & {16'h0, 8'h4, 8'h0})
      | ({32{core_features_hit_q}} & 32'(Features))
      | ({32{core_size_hit_q}} & {status_i.core.size_columns, status_i.core.size_rows})
      | ({32{core_clk_khz_hit_q}} & status_i.core.clk_khz)
      | ({32{core_scratch_hit_q}} & cfg_o.core.scratch)
      | ({32{core_widths_hit_q}} & {8'(OffsetBits), 8'(LoadBits), 8'(TimerBits), 8'(DetailBits)})
      | ({32{core_beats_hit_q}} & {11'd0, status_i.core.beats})
      | ({32{adc_enable_hit_q}} & {31'd0, cfg_o.adc.enable})
      | ({32{adc_period_hit_q}} & {8'd0, cfg_o.adc.period})
      | ({32{adc_dropped_hit_q}} & status_i.adc.dropped)
      | ({32{adc_overrun_hit_q}} & status_i.adc.overrun)
      | ({32{adc_timeout_hit_q}} & status_i.adc.timeout)
      | ({32{adc_mistagged_hit_q}} & status_i.adc.mistagged)
      | ({32{adc_over_range_hit_q}} & status_i.adc.over_range)
      | ({32{slip_threshold_hit_q}} & {12'd0, slip_threshold_fit})
      | ({32{slip_gross_threshold_hit_q}} & {12'd0, slip_gross_threshold_fit})
      | ({32{slip_contact_level_hit_q}} & {12'd0, slip_contact_level_fit})
      | ({32{slip_release_level_hit_q}} & {12'd0, slip_release_level_fit})
      | ({32{slip_contact_rises_hit_q}} & {31'd0, slip_contact_rises_q})
      | ({32{slip_hold_hit_q}} & {16'd0, slip_hold_fit})
      | ({32{slip_refractory_hit_q}} & {16'd0, slip_refractory_fit})
      | ({32{slip_blank_hit_q}} & {16'd0, slip_blank_fit})
      | ({32{slip_damaged_hit_q}} & status_i.slip.damaged)
      | ({32{slip_blanked_hit_q}} & status_i.slip.blanked)
      | ({32{slip_keep_threshold_hit_q}} & {12'd0, slip_keep_threshold_fit})
      | ({32{scan_enable_hit_q}} & {31'd0, cfg_o.scan.enable})
      | ({32{scan_settle_hit_q}} & {16'd0, cfg_o.scan.settle})
      | ({32{scan_period_hit_q}} & cfg_o.scan.period)
      | ({32{scan_interleave_hit_q}} & {31'd0, cfg_o.scan.interleave})
      | ({32{scan_dropped_hit_q}} & status_i.scan.dropped)
      | ({32{scan_overrun_hit_q}} & status_i.scan.overrun)
      | ({32{scan_held_hit_q}} & status_i.scan.held)
      | ({32{scan_lost_hit_q}} & status_i.scan.lost)
      | ({32{health_band_hit_q}} & {15'd0, cfg_o.health.band})
      | ({32{health_jump_hit_q}} & {15'd0, cfg_o.health.jump})
      | ({32{health_low_hit_q}} & {15'd0, cfg_o.health.low})
      | ({32{health_high_hit_q}} & {15'd0, cfg_o.health.high})
      | ({32{health_use_hit_q}} & {30'd0, cfg_o.health.use_edges, cfg_o.health.use_user})
      | ({32{health_still_hit_q}} & {24'd0, cfg_o.health.still})
      | ({32{health_rail_hit_q}} & {24'd0, cfg_o.health.rail})
      | ({32{health_blink_hit_q}} & {24'd0, cfg_o.health.blink})
      | ({32{health_clear_hit_q}} & {31'd0, 1'b0})
      | ({32{health_report_hit_q}} & {31'd0, 1'b0})
      | ({32{health_dead_hit_q}} & {11'd0, status_i.health.dead})
      | ({32{health_railed_hit_q}} & {11'd0, status_i.health.railed})
      | ({32{health_blinking_hit_q}} & {11'd0, status_i.health.blinking})
      | ({32{tare_contact_hit_q}} & {15'd0, cfg_o.tare.contact})
      | ({32{tare_step_hit_q}} & {24'd0, cfg_o.tare.step})
      | ({32{tare_force_hit_q}} & {31'd0, cfg_o.tare.force_})
      | ({32{tare_at_start_hit_q}} & {31'd0, cfg_o.tare.at_start})
      | ({32{tare_average_hit_q}} & {31'd0, 1'b0})
      | ({32{tare_load_hit_q}} & {31'd0, cfg_o.tare.load})
      | ({32{tare_word_hit_q}} & {12'd0, cfg_o.tare.word})
      | ({32{tare_zero_hit_q}} & {15'd0, cfg_o.tare.zero})
      | ({32{tare_write_hit_q}} & {24'd0, cfg_o.tare.write})
      | ({32{tare_state_hit_q}} & {29'd0, status_i.tare.state_pressed, status_i.tare.state_taring, status_i.tare.state_loading})
      | ({32{tare_tared_hit_q}} & {16'd0, status_i.tare.tared})
      | ({32{tare_refused_hit_q}} & {16'd0, status_i.tare.refused})
      | ({32{tare_swallowed_hit_q}} & status_i.tare.swallowed)
      | ({32{calibrate_preset_hit_q}} & {16'd0, cfg_o.calibrate.preset})
      | ({32{calibrate_word_hit_q}} & {12'd0, cfg_o.calibrate.word})
      | ({32{calibrate_offset_hit_q}} & {15'd0, calibrate_offset_fit})
      | ({32{calibrate_gain_hit_q}} & {16'd0, cfg_o.calibrate.gain})
      | ({32{calibrate_write_hit_q}} & {23'd0, cfg_o.calibrate.write_row, cfg_o.calibrate.write_lanes})
      | ({32{calibrate_swap_hit_q}} & {31'd0, 1'b0})
      | ({32{calibrate_swapping_hit_q}} & {31'd0, status_i.calibrate.swapping})
      | ({32{cop_min_load_hit_q}} & cop_min_load_fit)
      | ({32{cop_damaged_hit_q}} & status_i.cop.damaged)
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
      | ({32{link_images_hit_q}} & {31'd0, cfg_o.link.images})
      | ({32{link_packets_hit_q}} & status_i.link.packets)
      | ({32{link_cop_dropped_hit_q}} & status_i.link.cop_dropped)
      | ({32{link_image_dropped_hit_q}} & status_i.link.image_dropped)
      | ({32{link_rejected_hit_q}} & status_i.link.rejected)
      | ({32{grip_enable_hit_q}} & {31'd0, cfg_o.grip.enable})
      | ({32{grip_period_hit_q}} & {8'd0, cfg_o.grip.period})
      | ({32{grip_step_hit_q}} & {16'd0, cfg_o.grip.step})
      | ({32{grip_decay_hit_q}} & {16'd0, cfg_o.grip.decay})
      | ({32{grip_minimum_hit_q}} & {16'd0, cfg_o.grip.minimum})
      | ({32{grip_maximum_hit_q}} & {16'd0, cfg_o.grip.maximum})
      | ({32{grip_rate_hit_q}} & {16'd0, cfg_o.grip.rate})
      | ({32{grip_watchdog_hit_q}} & {16'd0, cfg_o.grip.watchdog})
      | ({32{grip_rule_hit_q}} & {31'd0, cfg_o.grip.rule})
      | ({32{grip_mode_hit_q}} & {31'd0, cfg_o.grip.mode})
      | ({32{grip_immediate_hit_q}} & {31'd0, cfg_o.grip.immediate})
      | ({32{grip_override_hit_q}} & {31'd0, cfg_o.grip.override_})
      | ({32{grip_override_value_hit_q}} & {16'd0, cfg_o.grip.override_value})
      | ({32{grip_divide_hit_q}} & {24'd0, cfg_o.grip.divide})
      | ({32{grip_low_hit_q}} & {15'd0, cfg_o.grip.low})
      | ({32{grip_high_hit_q}} & {15'd0, cfg_o.grip.high})
      | ({32{grip_rail_hit_q}} & {24'd0, cfg_o.grip.rail})
      | ({32{grip_command_hit_q}} & {16'd0, status_i.grip.command})
      | ({32{grip_increment_hit_q}} & {15'd0, status_i.grip.increment})
      | ({32{grip_fault_hit_q}} & {27'd0, status_i.grip.fault})
      | ({32{grip_faulty_hit_q}} & {24'd0, status_i.grip.faulty})
      | ({32{grip_commands_hit_q}} & status_i.grip.commands)
      | ({32{grip_tightenings_hit_q}} & status_i.grip.tightenings)
      | ({32{grip_speed_gain_hit_q}} & {16'd0, cfg_o.grip.speed_gain})
      | ({32{grip_boost_hit_q}} & {29'd0, cfg_o.grip.boost})
      | ({32{shear_speed_enable_hit_q}} & {31'd0, cfg_o.shear_speed.enable})
      | ({32{shear_speed_k0_hit_q}} & {6'd0, cfg_o.shear_speed.k0})
      | ({32{shear_speed_k1_hit_q}} & {14'd0, cfg_o.shear_speed.k1})
      | ({32{shear_speed_exponent_hit_q}} & {16'd0, cfg_o.shear_speed.exponent})
      | ({32{shear_speed_vi_min_hit_q}} & {6'd0, cfg_o.shear_speed.vi_min})
      | ({32{shear_speed_vi_max_hit_q}} & {6'd0, cfg_o.shear_speed.vi_max})
      | ({32{shear_speed_noise_hit_q}} & {6'd0, cfg_o.shear_speed.noise})
      | ({32{shear_speed_still_hit_q}} & {6'd0, cfg_o.shear_speed.still})
      | ({32{shear_speed_full_hit_q}} & {15'd0, cfg_o.shear_speed.full})
      | ({32{shear_speed_limit_hit_q}} & {8'd0, cfg_o.shear_speed.limit})
      | ({32{shear_speed_travel_hit_q}} & cfg_o.shear_speed.travel)
      | ({32{shear_speed_hold_hit_q}} & {31'd0, cfg_o.shear_speed.hold})
      | ({32{shear_speed_hold_cycles_hit_q}} & {24'd0, cfg_o.shear_speed.hold_cycles})
      | ({32{shear_speed_select_hit_q}} & {29'd0, cfg_o.shear_speed.select})
      | ({32{shear_speed_channel0_hit_q}} & {status_i.shear_speed.channel0_flags, status_i.shear_speed.channel0_speed})
      | ({32{shear_speed_channel1_hit_q}} & {status_i.shear_speed.channel1_flags, status_i.shear_speed.channel1_speed})
      | ({32{shear_speed_channel2_hit_q}} & {status_i.shear_speed.channel2_flags, status_i.shear_speed.channel2_speed})
      | ({32{shear_speed_channel3_hit_q}} & {status_i.shear_speed.channel3_flags, status_i.shear_speed.channel3_speed})
      | ({32{shear_speed_channel4_hit_q}} & {status_i.shear_speed.channel4_flags, status_i.shear_speed.channel4_speed})
      | ({32{shear_speed_channel5_hit_q}} & {status_i.shear_speed.channel5_flags, status_i.shear_speed.channel5_speed})
      | ({32{shear_speed_channel6_hit_q}} & {status_i.shear_speed.channel6_flags, status_i.shear_speed.channel6_speed})
      | ({32{shear_speed_channel7_hit_q}} & {status_i.shear_speed.channel7_flags, status_i.shear_speed.channel7_speed})
      | ({32{shear_speed_vi_hit_q}} & {6'd0, status_i.shear_speed.vi})
      | ({32{shear_speed_rise_hit_q}} & {5'd0, status_i.shear_speed.rise})
      | ({32{shear_speed_windows_hit_q}} & status_i.shear_speed.windows);

  logic asked, wrote, odd;
  always_ff @(posedge clk_i) begin
    asked       <= bus_valid_i;
    wrote       <= bus_write_i;
    odd         <= bus_address_i[1:0] != 2'd0;
    bus_done_o  <= asked;
    bus_error_o <= !hit || odd || (wrote && !writable);
    bus_rdata_o  <= (wrote || odd) ? 32'd0 : read_word;
    if (rst_i) begin
      asked      <= 1'b0;
      bus_done_o <= 1'b0;
    end
  end

endmodule
