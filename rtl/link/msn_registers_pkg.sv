// SPDX-License-Identifier: Apache-2.0
//
// Made by tools/make/registers.py from rtl/registers.rdl: change that, then `make registers`.
//
// A struct per group of registers: what the core gets of it, what it gives. Members have no sign:
// `signed'()` where docs/registers.md has one. Then the table of all fields, and the settings' reset values
// as one number, the first setting lowest.

// Most blocks use the structs only.
// verilator lint_off UNUSEDPARAM
package msn_registers_pkg;

  typedef struct packed {
    logic [31:0] scratch;
    logic        hold;
  } core_cfg_t;

  typedef struct packed {
    logic        enable;
    logic [23:0] period;
  } adc_cfg_t;

  typedef struct packed {
    logic [19:0] threshold;
    logic [19:0] gross_threshold;
    logic [19:0] contact_level;
    logic [19:0] release_level;
    logic        contact_rises;
    logic [15:0] hold;
    logic [15:0] refractory;
    logic [15:0] blank;
    logic [19:0] keep_threshold;
  } slip_cfg_t;

  typedef struct packed {
    logic        enable;
    logic [15:0] settle;
    logic [31:0] period;
    logic        interleave;
  } scan_cfg_t;

  typedef struct packed {
    logic [16:0] band;
    logic [16:0] jump;
    logic [16:0] low;
    logic [16:0] high;
    logic        use_user;
    logic        use_edges;
    logic [7:0]  still;
    logic [7:0]  rail;
    logic [7:0]  blink;
    logic        clear;
    logic        report;
  } health_cfg_t;

  typedef struct packed {
    logic [16:0] contact;
    logic [7:0]  step;
    logic        force_;
    logic        at_start;
    logic        average;
    logic        load;
    logic [19:0] word;
    logic [16:0] zero;
    logic [7:0]  write;
    logic        write_written;
  } tare_cfg_t;

  typedef struct packed {
    logic [15:0] preset;
    logic [19:0] word;
    logic [16:0] offset;
    logic [15:0] gain;
    logic [7:0]  write_lanes;
    logic        write_row;
    logic        write_written;
    logic        swap;
  } calibrate_cfg_t;

  typedef struct packed {
    logic [31:0] min_load;
  } cop_cfg_t;

  typedef struct packed {
    logic [16:0] rail;
    logic [16:0] kx;
    logic [3:0]  shift_x;
    logic [16:0] ky;
    logic [3:0]  shift_y;
    logic [16:0] kf;
    logic [3:0]  shift_load;
    logic [17:0] p0;
    logic [17:0] p1;
    logic [17:0] p2;
    logic [17:0] p3;
    logic [17:0] p4;
    logic [17:0] p5;
    logic [15:0] min_load;
    logic [15:0] top;
    logic [16:0] idle;
    logic [16:0] busy;
    logic [17:0] imbalance;
  } cop4_cfg_t;

  typedef struct packed {
    logic [7:0]  drop;
    logic [15:0] move;
    logic [15:0] min_load;
    logic [15:0] hold;
    logic [15:0] refractory;
  } cop_slip_cfg_t;

  typedef struct packed {
    logic        images;
    logic        events_none;
    logic        events_contact;
    logic        events_incipient;
    logic        events_gross;
    logic        events_release;
    logic        states;
  } link_cfg_t;

  typedef struct packed {
    logic        enable;
    logic [23:0] period;
    logic [15:0] step;
    logic [15:0] decay;
    logic [15:0] minimum;
    logic [15:0] maximum;
    logic [15:0] rate;
    logic [15:0] watchdog;
    logic        rule;
    logic        mode;
    logic        immediate;
    logic        override_;
    logic [15:0] override_value;
    logic [7:0]  divide;
    logic [16:0] low;
    logic [16:0] high;
    logic [7:0]  rail;
    logic [15:0] speed_gain;
    logic [2:0]  boost;
  } grip_cfg_t;

  typedef struct packed {
    logic        enable;
    logic [25:0] k0;
    logic [17:0] k1;
    logic [15:0] exponent;
    logic [25:0] vi_min;
    logic [25:0] vi_max;
    logic [25:0] noise;
    logic [25:0] still;
    logic [16:0] full;
    logic [23:0] limit;
    logic [31:0] travel;
    logic        hold;
    logic [7:0]  hold_cycles;
    logic [2:0]  select;
  } shear_speed_cfg_t;

  typedef struct packed {
    logic [1:0]  target_kind;
    logic [5:0]  target_engine;
    logic [15:0] target_label;
    logic [21:0] address;
    logic        address_written;
    logic [31:0] high;
    logic [31:0] data;
    logic        data_written;
    logic        clear;
    logic        swap;
    logic [21:0] feature;
    logic [7:0]  feature_index;
    logic        feature_written;
    logic        start;
    logic [31:0] slip;
    logic        grip;
    logic [15:0] select;
  } forest_cfg_t;

  typedef struct packed {
    logic        enable;
    logic [31:0] increment;
    logic [11:0] burst_period;
    logic [11:0] burst_on;
    logic [7:0]  top;
    logic [11:0] most;
    logic [15:0] duty;
    logic [3:0]  watchdog;
    logic [15:0] stop;
    logic        source;
    logic [15:0] floor;
    logic [15:0] step;
    logic        marker;
    logic [7:0]  cue;
    logic [2:0]  octant;
    logic        health;
    logic [23:0] levels_next;
    logic        levels_last;
    logic        levels_written;
  } display_cfg_t;

  typedef struct packed {
    core_cfg_t core;
    adc_cfg_t adc;
    slip_cfg_t slip;
    scan_cfg_t scan;
    health_cfg_t health;
    tare_cfg_t tare;
    calibrate_cfg_t calibrate;
    cop_cfg_t cop;
    cop4_cfg_t cop4;
    cop_slip_cfg_t cop_slip;
    link_cfg_t link;
    grip_cfg_t grip;
    shear_speed_cfg_t shear_speed;
    forest_cfg_t forest;
    display_cfg_t display;
  } cfg_t;

  typedef struct packed {
    logic [15:0] size_rows;
    logic [15:0] size_columns;
    logic [31:0] clk_khz;
    logic [20:0] beats;
    logic [3:0]  lanes;
  } core_status_t;

  typedef struct packed {
    logic [31:0] dropped;
    logic [31:0] overrun;
    logic [31:0] timeout;
    logic [31:0] mistagged;
    logic [31:0] over_range;
  } adc_status_t;

  typedef struct packed {
    logic [31:0] damaged;
    logic [31:0] blanked;
  } slip_status_t;

  typedef struct packed {
    logic [31:0] dropped;
    logic [31:0] overrun;
    logic [31:0] held;
    logic [31:0] lost;
  } scan_status_t;

  typedef struct packed {
    logic [20:0] dead;
    logic [20:0] railed;
    logic [20:0] blinking;
  } health_status_t;

  typedef struct packed {
    logic        state_loading;
    logic        state_taring;
    logic        state_pressed;
    logic [15:0] tared;
    logic [15:0] refused;
    logic [31:0] swallowed;
  } tare_status_t;

  typedef struct packed {
    logic        swapping;
  } calibrate_status_t;

  typedef struct packed {
    logic [31:0] damaged;
  } cop_status_t;

  typedef struct packed {
    logic [31:0] packets;
    logic [31:0] cop_dropped;
    logic [31:0] image_dropped;
    logic [31:0] rejected;
    logic [31:0] changes_lost;
  } link_status_t;

  typedef struct packed {
    logic [15:0] command;
    logic [16:0] increment;
    logic [4:0]  fault;
    logic [7:0]  faulty;
    logic [31:0] commands;
    logic [31:0] tightenings;
  } grip_status_t;

  typedef struct packed {
    logic [23:0] channel0_speed;
    logic [7:0]  channel0_flags;
    logic [23:0] channel1_speed;
    logic [7:0]  channel1_flags;
    logic [23:0] channel2_speed;
    logic [7:0]  channel2_flags;
    logic [23:0] channel3_speed;
    logic [7:0]  channel3_flags;
    logic [23:0] channel4_speed;
    logic [7:0]  channel4_flags;
    logic [23:0] channel5_speed;
    logic [7:0]  channel5_flags;
    logic [23:0] channel6_speed;
    logic [7:0]  channel6_flags;
    logic [23:0] channel7_speed;
    logic [7:0]  channel7_flags;
    logic [25:0] vi;
    logic [26:0] rise;
    logic [31:0] windows;
  } shear_speed_status_t;

  typedef struct packed {
    logic [8:0]  size_features;
    logic [4:0]  size_bits;
    logic [6:0]  size_engines;
    logic [1:0]  size_banks;
    logic        size_frames;
    logic [15:0] room_trees;
    logic [15:0] room_classes;
    logic [22:0] nodes;
    logic [16:0] leaves;
    logic        state_loaded;
    logic        state_waits;
    logic        state_swapping;
    logic        state_refused;
    logic [2:0]  state_error;
    logic [31:0] written;
    logic [15:0] label;
    logic [31:0] best;
    logic [31:0] votes;
    logic [31:0] decisions;
    logic [31:0] changes;
    logic [15:0] missed;
    logic [15:0] absent;
    logic [15:0] late;
    logic [15:0] broken;
  } forest_status_t;

  typedef struct packed {
    logic [7:0]  size_rows;
    logic [7:0]  size_columns;
    logic [7:0]  size_bits;
    logic        state_running;
    logic        state_fault;
    logic        state_limited;
    logic [11:0] state_pins;
    logic [15:0] dropped;
    logic [31:0] faults;
  } display_status_t;

  typedef struct packed {
    core_status_t core;
    adc_status_t adc;
    slip_status_t slip;
    scan_status_t scan;
    health_status_t health;
    tare_status_t tare;
    calibrate_status_t calibrate;
    cop_status_t cop;
    link_status_t link;
    grip_status_t grip;
    shear_speed_status_t shear_speed;
    forest_status_t forest;
    display_status_t display;
  } status_t;

  typedef enum logic [3:0] {
    Core, Adc, Slip, Scan, Health, Tare, Calibrate, Cop, Cop4, CopSlip, Link, Grip, ShearSpeed, Forest,
    Display
  } group_e;
  localparam int unsigned Groups = 15;

  typedef enum logic [2:0] {
    Setting,   // what the host writes is kept, for the core
    Command,   // a 1 that the host writes is a pulse for the core
    Strobe,    // a write of the byte with bit `low` is one
    Status,    // the core's
    Constant,
    Features,  // a bit for each group that a build may leave out
    Widths     // the bits that a build has for fields that are held to them
  } kind_e;

  // When a written setting takes effect. AtScan: as AtOnce for the registers; the scan waits for a frame.
  typedef enum logic [2:0] {AtOnce, AtFrame, AtScan, WhileOff, AtReset} applies_e;

  // The bits that a build has for a field: all, or its parameter DetailBits ...
  typedef enum logic [2:0] {Whole, Detail, Timer, Load, Offset} held_e;

  localparam int unsigned RowBits = 79;
  typedef struct packed {
    group_e      group;
    logic [9:0]  word;       // the address, in words
    logic [4:0]  low;        // its lowest bit in the word
    logic [5:0]  width;
    kind_e       kind;
    applies_e    applies;
    held_e       held;
    logic        is_signed;
    logic [11:0] place;      // its lowest bit in cfg_t or status_t
    logic [31:0] value;      // the constant; of a setting its lowest bit in the reset values
  } row_t;

  localparam int unsigned Rows       = 245;
  localparam int unsigned CfgBits    = 1731;
  localparam int unsigned StatusBits = 1645;
  // The first row highest.
  localparam logic [Rows*RowBits-1:0] Table = {
  {Core,      10'h000, 5'd0,  6'd32, Constant, AtOnce,   Whole,  1'b0, 12'd0, 32'h4d534e52},  // id
  {Core,      10'h001, 5'd0,  6'd8,  Constant, AtOnce,   Whole,  1'b0, 12'd0, 32'h0},  // version_patch
  {Core,      10'h001, 5'd8,  6'd8,  Constant, AtOnce,   Whole,  1'b0, 12'd0, 32'h7},  // version_minor
  {Core,      10'h001, 5'd16, 6'd16, Constant, AtOnce,   Whole,  1'b0, 12'd0, 32'h0},  // version_major
  {Core,      10'h002, 5'd0,  6'd32, Features, AtOnce,   Whole,  1'b0, 12'd0, 32'h0},  // features
  {Core,      10'h003, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd1629, 32'h0},  // size_rows
  {Core,      10'h003, 5'd16, 6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd1613, 32'h0},  // size_columns
  {Core,      10'h004, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1581, 32'h0},  // clk_khz
  {Core,      10'h005, 5'd0,  6'd32, Setting,  AtOnce,   Whole,  1'b0, 12'd1699, 32'h0},  // scratch
  {Core,      10'h006, 5'd0,  6'd8,  Widths,   AtOnce,   Detail, 1'b0, 12'd0, 32'h0},  // widths_detail
  {Core,      10'h006, 5'd8,  6'd8,  Widths,   AtOnce,   Timer,  1'b0, 12'd0, 32'h0},  // widths_timer
  {Core,      10'h006, 5'd16, 6'd8,  Widths,   AtOnce,   Load,   1'b0, 12'd0, 32'h0},  // widths_load
  {Core,      10'h006, 5'd24, 6'd8,  Widths,   AtOnce,   Offset, 1'b0, 12'd0, 32'h0},  // widths_offset
  {Core,      10'h007, 5'd0,  6'd21, Status,   AtOnce,   Whole,  1'b0, 12'd1560, 32'h0},  // beats
  {Core,      10'h008, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1698, 32'h20},  // hold
  {Core,      10'h009, 5'd0,  6'd4,  Status,   AtOnce,   Whole,  1'b0, 12'd1556, 32'h0},  // lanes
  {Adc,       10'h040, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1697, 32'h21},  // enable
  {Adc,       10'h041, 5'd0,  6'd24, Setting,  AtOnce,   Whole,  1'b0, 12'd1673, 32'h22},  // period
  {Adc,       10'h042, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1524, 32'h0},  // dropped
  {Adc,       10'h043, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1492, 32'h0},  // overrun
  {Adc,       10'h044, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1460, 32'h0},  // timeout
  {Adc,       10'h045, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1428, 32'h0},  // mistagged
  {Adc,       10'h046, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1396, 32'h0},  // over_range
  {Slip,      10'h080, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b0, 12'd1653, 32'h3a},  // threshold
  {Slip,      10'h081, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b0, 12'd1633, 32'h4e},  // gross_threshold
  {Slip,      10'h082, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b1, 12'd1613, 32'h62},  // contact_level
  {Slip,      10'h083, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b1, 12'd1593, 32'h76},  // release_level
  {Slip,      10'h084, 5'd0,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd1592, 32'h8a},  // contact_rises
  {Slip,      10'h085, 5'd0,  6'd16, Setting,  AtFrame,  Timer,  1'b0, 12'd1576, 32'h8b},  // hold
  {Slip,      10'h086, 5'd0,  6'd16, Setting,  AtFrame,  Timer,  1'b0, 12'd1560, 32'h9b},  // refractory
  {Slip,      10'h087, 5'd0,  6'd16, Setting,  AtFrame,  Timer,  1'b0, 12'd1544, 32'hab},  // blank
  {Slip,      10'h088, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1364, 32'h0},  // damaged
  {Slip,      10'h089, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1332, 32'h0},  // blanked
  {Slip,      10'h08a, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b0, 12'd1524, 32'hbb},  // keep_threshold
  {Scan,      10'h0c0, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1523, 32'hcf},  // enable
  {Scan,      10'h0c1, 5'd0,  6'd16, Setting,  AtScan,   Whole,  1'b0, 12'd1507, 32'hd0},  // settle
  {Scan,      10'h0c2, 5'd0,  6'd32, Setting,  AtScan,   Whole,  1'b0, 12'd1475, 32'he0},  // period
  {Scan,      10'h0c3, 5'd0,  6'd1,  Setting,  AtScan,   Whole,  1'b0, 12'd1474, 32'h100},  // interleave
  {Scan,      10'h0c4, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1300, 32'h0},  // dropped
  {Scan,      10'h0c5, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1268, 32'h0},  // overrun
  {Scan,      10'h0c6, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1236, 32'h0},  // held
  {Scan,      10'h0c7, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1204, 32'h0},  // lost
  {Health,    10'h100, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1457, 32'h101},  // band
  {Health,    10'h101, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1440, 32'h112},  // jump
  {Health,    10'h102, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b1, 12'd1423, 32'h123},  // low
  {Health,    10'h103, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b1, 12'd1406, 32'h134},  // high
  {Health,    10'h104, 5'd0,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd1405, 32'h145},  // use_user
  {Health,    10'h104, 5'd1,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd1404, 32'h146},  // use_edges
  {Health,    10'h105, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd1396, 32'h147},  // still
  {Health,    10'h106, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd1388, 32'h14f},  // rail
  {Health,    10'h107, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd1380, 32'h157},  // blink
  {Health,    10'h108, 5'd0,  6'd1,  Command,  AtFrame,  Whole,  1'b0, 12'd1379, 32'h0},  // clear
  {Health,    10'h109, 5'd0,  6'd1,  Command,  AtFrame,  Whole,  1'b0, 12'd1378, 32'h0},  // report
  {Health,    10'h10a, 5'd0,  6'd21, Status,   AtOnce,   Whole,  1'b0, 12'd1183, 32'h0},  // dead
  {Health,    10'h10b, 5'd0,  6'd21, Status,   AtOnce,   Whole,  1'b0, 12'd1162, 32'h0},  // railed
  {Health,    10'h10c, 5'd0,  6'd21, Status,   AtOnce,   Whole,  1'b0, 12'd1141, 32'h0},  // blinking
  {Tare,      10'h120, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1361, 32'h15f},  // contact
  {Tare,      10'h121, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd1353, 32'h170},  // step
  {Tare,      10'h122, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1352, 32'h178},  // force_
  {Tare,      10'h123, 5'd0,  6'd1,  Setting,  AtReset,  Whole,  1'b0, 12'd1351, 32'h179},  // at_start
  {Tare,      10'h124, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd1350, 32'h0},  // average
  {Tare,      10'h125, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1349, 32'h17a},  // load
  {Tare,      10'h126, 5'd0,  6'd20, Setting,  AtOnce,   Whole,  1'b0, 12'd1329, 32'h17b},  // word
  {Tare,      10'h127, 5'd0,  6'd17, Setting,  AtOnce,   Whole,  1'b1, 12'd1312, 32'h18f},  // zero
  {Tare,      10'h128, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd1304, 32'h1a0},  // write
  {Tare,      10'h128, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd1303, 32'h0},  // write_written
  {Tare,      10'h129, 5'd0,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd1140, 32'h0},  // state_loading
  {Tare,      10'h129, 5'd1,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd1139, 32'h0},  // state_taring
  {Tare,      10'h129, 5'd2,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd1138, 32'h0},  // state_pressed
  {Tare,      10'h12a, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd1122, 32'h0},  // tared
  {Tare,      10'h12b, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd1106, 32'h0},  // refused
  {Tare,      10'h12c, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1074, 32'h0},  // swallowed
  {Calibrate, 10'h140, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd1287, 32'h1a8},  // preset
  {Calibrate, 10'h141, 5'd0,  6'd20, Setting,  AtOnce,   Whole,  1'b0, 12'd1267, 32'h1b8},  // word
  {Calibrate, 10'h142, 5'd0,  6'd17, Setting,  AtOnce,   Offset, 1'b1, 12'd1250, 32'h1cc},  // offset
  {Calibrate, 10'h143, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd1234, 32'h1dd},  // gain
  {Calibrate, 10'h144, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd1226, 32'h1ed},  // write_lanes
  {Calibrate, 10'h144, 5'd8,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1225, 32'h1f5},  // write_row
  {Calibrate, 10'h144, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd1224, 32'h0},  // write_written
  {Calibrate, 10'h145, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd1223, 32'h0},  // swap
  {Calibrate, 10'h146, 5'd0,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd1073, 32'h0},  // swapping
  {Cop,       10'h180, 5'd0,  6'd32, Setting,  AtFrame,  Load,   1'b0, 12'd1191, 32'h1f6},  // min_load
  {Cop,       10'h181, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1041, 32'h0},  // damaged
  {Cop4,      10'h1c0, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1174, 32'h216},  // rail
  {Cop4,      10'h1c1, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1157, 32'h227},  // kx
  {Cop4,      10'h1c2, 5'd0,  6'd4,  Setting,  AtFrame,  Whole,  1'b0, 12'd1153, 32'h238},  // shift_x
  {Cop4,      10'h1c3, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1136, 32'h23c},  // ky
  {Cop4,      10'h1c4, 5'd0,  6'd4,  Setting,  AtFrame,  Whole,  1'b0, 12'd1132, 32'h24d},  // shift_y
  {Cop4,      10'h1c5, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1115, 32'h251},  // kf
  {Cop4,      10'h1c6, 5'd0,  6'd4,  Setting,  AtFrame,  Whole,  1'b0, 12'd1111, 32'h262},  // shift_load
  {Cop4,      10'h1c7, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd1093, 32'h266},  // p0
  {Cop4,      10'h1c8, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd1075, 32'h278},  // p1
  {Cop4,      10'h1c9, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd1057, 32'h28a},  // p2
  {Cop4,      10'h1ca, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd1039, 32'h29c},  // p3
  {Cop4,      10'h1cb, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd1021, 32'h2ae},  // p4
  {Cop4,      10'h1cc, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd1003, 32'h2c0},  // p5
  {Cop4,      10'h1cd, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd987, 32'h2d2},  // min_load
  {Cop4,      10'h1ce, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd971, 32'h2e2},  // top
  {Cop4,      10'h1cf, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b1, 12'd954, 32'h2f2},  // idle
  {Cop4,      10'h1d0, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b1, 12'd937, 32'h303},  // busy
  {Cop4,      10'h1d1, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b0, 12'd919, 32'h314},  // imbalance
  {CopSlip,   10'h200, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd911, 32'h326},  // drop
  {CopSlip,   10'h201, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd895, 32'h32e},  // move
  {CopSlip,   10'h202, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd879, 32'h33e},  // min_load
  {CopSlip,   10'h203, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd863, 32'h34e},  // hold
  {CopSlip,   10'h204, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd847, 32'h35e},  // refractory
  {Link,      10'h240, 5'd0,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd846, 32'h36e},  // images
  {Link,      10'h241, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1009, 32'h0},  // packets
  {Link,      10'h242, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd977, 32'h0},  // cop_dropped
  {Link,      10'h243, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd945, 32'h0},  // image_dropped
  {Link,      10'h244, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd913, 32'h0},  // rejected
  {Link,      10'h245, 5'd0,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd845, 32'h36f},  // events_none
  {Link,      10'h245, 5'd1,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd844, 32'h370},  // events_contact
  {Link,      10'h245, 5'd2,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd843, 32'h371},  // events_incipient
  {Link,      10'h245, 5'd3,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd842, 32'h372},  // events_gross
  {Link,      10'h245, 5'd4,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd841, 32'h373},  // events_release
  {Link,      10'h246, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd840, 32'h0},  // states
  {Link,      10'h247, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd881, 32'h0},  // changes_lost
  {Grip,      10'h280, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd839, 32'h374},  // enable
  {Grip,      10'h281, 5'd0,  6'd24, Setting,  AtOnce,   Whole,  1'b0, 12'd815, 32'h375},  // period
  {Grip,      10'h282, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd799, 32'h38d},  // step
  {Grip,      10'h283, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd783, 32'h39d},  // decay
  {Grip,      10'h284, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd767, 32'h3ad},  // minimum
  {Grip,      10'h285, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd751, 32'h3bd},  // maximum
  {Grip,      10'h286, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd735, 32'h3cd},  // rate
  {Grip,      10'h287, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd719, 32'h3dd},  // watchdog
  {Grip,      10'h288, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd718, 32'h3ed},  // rule
  {Grip,      10'h289, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd717, 32'h3ee},  // mode
  {Grip,      10'h28a, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd716, 32'h3ef},  // immediate
  {Grip,      10'h28b, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd715, 32'h3f0},  // override_
  {Grip,      10'h28c, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd699, 32'h3f1},  // override_value
  {Grip,      10'h28d, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd691, 32'h401},  // divide
  {Grip,      10'h28e, 5'd0,  6'd17, Setting,  AtOnce,   Whole,  1'b1, 12'd674, 32'h409},  // low
  {Grip,      10'h28f, 5'd0,  6'd17, Setting,  AtOnce,   Whole,  1'b1, 12'd657, 32'h41a},  // high
  {Grip,      10'h290, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd649, 32'h42b},  // rail
  {Grip,      10'h291, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd865, 32'h0},  // command
  {Grip,      10'h292, 5'd0,  6'd17, Status,   AtOnce,   Whole,  1'b1, 12'd848, 32'h0},  // increment
  {Grip,      10'h293, 5'd0,  6'd5,  Status,   AtOnce,   Whole,  1'b0, 12'd843, 32'h0},  // fault
  {Grip,      10'h294, 5'd0,  6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd835, 32'h0},  // faulty
  {Grip,      10'h295, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd803, 32'h0},  // commands
  {Grip,      10'h296, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd771, 32'h0},  // tightenings
  {Grip,      10'h297, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd633, 32'h433},  // speed_gain
  {Grip,      10'h298, 5'd0,  6'd3,  Setting,  AtOnce,   Whole,  1'b0, 12'd630, 32'h443},  // boost
  {ShearSpeed,10'h2c0, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd629, 32'h446},  // enable
  {ShearSpeed,10'h2c1, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b0, 12'd603, 32'h447},  // k0
  {ShearSpeed,10'h2c2, 5'd0,  6'd18, Setting,  WhileOff, Whole,  1'b1, 12'd585, 32'h461},  // k1
  {ShearSpeed,10'h2c3, 5'd0,  6'd16, Setting,  WhileOff, Whole,  1'b0, 12'd569, 32'h473},  // exponent
  {ShearSpeed,10'h2c4, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b1, 12'd543, 32'h483},  // vi_min
  {ShearSpeed,10'h2c5, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b1, 12'd517, 32'h49d},  // vi_max
  {ShearSpeed,10'h2c6, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b0, 12'd491, 32'h4b7},  // noise
  {ShearSpeed,10'h2c7, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b0, 12'd465, 32'h4d1},  // still
  {ShearSpeed,10'h2c8, 5'd0,  6'd17, Setting,  WhileOff, Whole,  1'b1, 12'd448, 32'h4eb},  // full
  {ShearSpeed,10'h2c9, 5'd0,  6'd24, Setting,  WhileOff, Whole,  1'b0, 12'd424, 32'h4fc},  // limit
  {ShearSpeed,10'h2ca, 5'd0,  6'd32, Setting,  WhileOff, Whole,  1'b0, 12'd392, 32'h514},  // travel
  {ShearSpeed,10'h2cb, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd391, 32'h534},  // hold
  {ShearSpeed,10'h2cc, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd383, 32'h535},  // hold_cycles
  {ShearSpeed,10'h2cd, 5'd0,  6'd3,  Setting,  AtOnce,   Whole,  1'b0, 12'd380, 32'h53d},  // select
  {ShearSpeed,10'h2ce, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd747, 32'h0},  // channel0_speed
  {ShearSpeed,10'h2ce, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd739, 32'h0},  // channel0_flags
  {ShearSpeed,10'h2cf, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd715, 32'h0},  // channel1_speed
  {ShearSpeed,10'h2cf, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd707, 32'h0},  // channel1_flags
  {ShearSpeed,10'h2d0, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd683, 32'h0},  // channel2_speed
  {ShearSpeed,10'h2d0, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd675, 32'h0},  // channel2_flags
  {ShearSpeed,10'h2d1, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd651, 32'h0},  // channel3_speed
  {ShearSpeed,10'h2d1, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd643, 32'h0},  // channel3_flags
  {ShearSpeed,10'h2d2, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd619, 32'h0},  // channel4_speed
  {ShearSpeed,10'h2d2, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd611, 32'h0},  // channel4_flags
  {ShearSpeed,10'h2d3, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd587, 32'h0},  // channel5_speed
  {ShearSpeed,10'h2d3, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd579, 32'h0},  // channel5_flags
  {ShearSpeed,10'h2d4, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd555, 32'h0},  // channel6_speed
  {ShearSpeed,10'h2d4, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd547, 32'h0},  // channel6_flags
  {ShearSpeed,10'h2d5, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd523, 32'h0},  // channel7_speed
  {ShearSpeed,10'h2d5, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd515, 32'h0},  // channel7_flags
  {ShearSpeed,10'h2d6, 5'd0,  6'd26, Status,   AtOnce,   Whole,  1'b1, 12'd489, 32'h0},  // vi
  {ShearSpeed,10'h2d7, 5'd0,  6'd27, Status,   AtOnce,   Whole,  1'b1, 12'd462, 32'h0},  // rise
  {ShearSpeed,10'h2d8, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd430, 32'h0},  // windows
  {Forest,    10'h300, 5'd0,  6'd9,  Status,   AtOnce,   Whole,  1'b0, 12'd421, 32'h0},  // size_features
  {Forest,    10'h300, 5'd9,  6'd5,  Status,   AtOnce,   Whole,  1'b0, 12'd416, 32'h0},  // size_bits
  {Forest,    10'h300, 5'd14, 6'd7,  Status,   AtOnce,   Whole,  1'b0, 12'd409, 32'h0},  // size_engines
  {Forest,    10'h300, 5'd21, 6'd2,  Status,   AtOnce,   Whole,  1'b0, 12'd407, 32'h0},  // size_banks
  {Forest,    10'h300, 5'd23, 6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd406, 32'h0},  // size_frames
  {Forest,    10'h301, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd390, 32'h0},  // room_trees
  {Forest,    10'h301, 5'd16, 6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd374, 32'h0},  // room_classes
  {Forest,    10'h302, 5'd0,  6'd23, Status,   AtOnce,   Whole,  1'b0, 12'd351, 32'h0},  // nodes
  {Forest,    10'h303, 5'd0,  6'd17, Status,   AtOnce,   Whole,  1'b0, 12'd334, 32'h0},  // leaves
  {Forest,    10'h304, 5'd0,  6'd2,  Setting,  AtOnce,   Whole,  1'b0, 12'd378, 32'h540},  // target_kind
  {Forest,    10'h304, 5'd2,  6'd6,  Setting,  AtOnce,   Whole,  1'b0, 12'd372, 32'h542},  // target_engine
  {Forest,    10'h304, 5'd8,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd356, 32'h548},  // target_label
  {Forest,    10'h305, 5'd0,  6'd22, Setting,  AtOnce,   Whole,  1'b0, 12'd334, 32'h558},  // address
  {Forest,    10'h305, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd333, 32'h0},  // address_written
  {Forest,    10'h306, 5'd0,  6'd32, Setting,  AtOnce,   Whole,  1'b0, 12'd301, 32'h56e},  // high
  {Forest,    10'h307, 5'd0,  6'd32, Setting,  AtOnce,   Whole,  1'b0, 12'd269, 32'h58e},  // data
  {Forest,    10'h307, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd268, 32'h0},  // data_written
  {Forest,    10'h308, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd267, 32'h0},  // clear
  {Forest,    10'h309, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd266, 32'h0},  // swap
  {Forest,    10'h30a, 5'd0,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd333, 32'h0},  // state_loaded
  {Forest,    10'h30a, 5'd1,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd332, 32'h0},  // state_waits
  {Forest,    10'h30a, 5'd2,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd331, 32'h0},  // state_swapping
  {Forest,    10'h30a, 5'd3,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd330, 32'h0},  // state_refused
  {Forest,    10'h30a, 5'd4,  6'd3,  Status,   AtOnce,   Whole,  1'b0, 12'd327, 32'h0},  // state_error
  {Forest,    10'h30b, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd295, 32'h0},  // written
  {Forest,    10'h30c, 5'd0,  6'd22, Setting,  AtOnce,   Whole,  1'b1, 12'd244, 32'h5ae},  // feature
  {Forest,    10'h30c, 5'd22, 6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd236, 32'h5c4},  // feature_index
  {Forest,    10'h30c, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd235, 32'h0},  // feature_written
  {Forest,    10'h30d, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd234, 32'h0},  // start
  {Forest,    10'h30e, 5'd0,  6'd32, Setting,  AtOnce,   Whole,  1'b0, 12'd202, 32'h5cc},  // slip
  {Forest,    10'h30f, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd201, 32'h5ec},  // grip
  {Forest,    10'h310, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd279, 32'h0},  // label
  {Forest,    10'h311, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd247, 32'h0},  // best
  {Forest,    10'h312, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd185, 32'h5ed},  // select
  {Forest,    10'h313, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd215, 32'h0},  // votes
  {Forest,    10'h314, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd183, 32'h0},  // decisions
  {Forest,    10'h315, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd151, 32'h0},  // changes
  {Forest,    10'h316, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd135, 32'h0},  // missed
  {Forest,    10'h317, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd119, 32'h0},  // absent
  {Forest,    10'h318, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd103, 32'h0},  // late
  {Forest,    10'h319, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd87, 32'h0},  // broken
  {Display,   10'h340, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd184, 32'h5fd},  // enable
  {Display,   10'h341, 5'd0,  6'd32, Setting,  AtOnce,   Whole,  1'b0, 12'd152, 32'h5fe},  // increment
  {Display,   10'h342, 5'd0,  6'd12, Setting,  AtOnce,   Whole,  1'b0, 12'd140, 32'h61e},  // burst_period
  {Display,   10'h343, 5'd0,  6'd12, Setting,  AtOnce,   Whole,  1'b0, 12'd128, 32'h62a},  // burst_on
  {Display,   10'h344, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd120, 32'h636},  // top
  {Display,   10'h345, 5'd0,  6'd12, Setting,  AtReset,  Whole,  1'b0, 12'd108, 32'h63e},  // most
  {Display,   10'h346, 5'd0,  6'd16, Setting,  AtReset,  Whole,  1'b0, 12'd92, 32'h64a},  // duty
  {Display,   10'h347, 5'd0,  6'd4,  Setting,  AtReset,  Whole,  1'b0, 12'd88, 32'h65a},  // watchdog
  {Display,   10'h348, 5'd0,  6'd16, Setting,  AtReset,  Whole,  1'b0, 12'd72, 32'h65e},  // stop
  {Display,   10'h349, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd71, 32'h66e},  // source
  {Display,   10'h34a, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd55, 32'h66f},  // floor
  {Display,   10'h34b, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd39, 32'h67f},  // step
  {Display,   10'h34c, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd38, 32'h68f},  // marker
  {Display,   10'h34d, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd30, 32'h690},  // cue
  {Display,   10'h34e, 5'd0,  6'd3,  Setting,  AtOnce,   Whole,  1'b0, 12'd27, 32'h698},  // octant
  {Display,   10'h34f, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd26, 32'h69b},  // health
  {Display,   10'h350, 5'd0,  6'd24, Setting,  AtOnce,   Whole,  1'b0, 12'd2, 32'h69c},  // levels_next
  {Display,   10'h350, 5'd24, 6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1, 32'h6b4},  // levels_last
  {Display,   10'h350, 5'd24, 6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd0, 32'h0},  // levels_written
  {Display,   10'h351, 5'd0,  6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd79, 32'h0},  // size_rows
  {Display,   10'h351, 5'd8,  6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd71, 32'h0},  // size_columns
  {Display,   10'h351, 5'd16, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd63, 32'h0},  // size_bits
  {Display,   10'h352, 5'd0,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd62, 32'h0},  // state_running
  {Display,   10'h352, 5'd1,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd61, 32'h0},  // state_fault
  {Display,   10'h352, 5'd2,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd60, 32'h0},  // state_limited
  {Display,   10'h352, 5'd8,  6'd12, Status,   AtOnce,   Whole,  1'b0, 12'd48, 32'h0},  // state_pins
  {Display,   10'h353, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd32, 32'h0},  // dropped
  {Display,   10'h354, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd0, 32'h0}  // faults
  };

  // Of each group: the bit of cfg_t that is 1 while its block is on, for settings that apply while it is off.
  localparam logic [12*Groups-1:0] Switches = {
    12'd184, 12'd0, 12'd629, 12'd839, 12'd0, 12'd0, 12'd0, 12'd0, 12'd0, 12'd0, 12'd0, 12'd1523, 12'd0,
    12'd1697, 12'd0
  };

  localparam int unsigned ResetBits = 1717;
  localparam logic [ResetBits-1:0] Reset = {
    184'h4000000000040fa069c41ffffe00000000000000,  // display
    189'h0,  // forest
    250'h640000c000001ff000020c80147ae0ccccd019999a9175dd70813d70a,  // shear_speed
    210'h403ffc0000000000000281001d4c00800000002001e8480,  // grip
    6'h3f,  // link
    72'h80,  // cop_slip
    272'hffffdfffeffffffff00010000000000000000000000000000000000000000000ffff,  // cop4
    32'h1,  // cop
    78'h0,  // calibrate
    73'h4020040,  // tare
    94'h37fff8000000000002,  // health
    50'h2,  // scan
    149'h1ffffe0000000000010000000000ffffffffff,  // slip
    25'h0,  // adc
    33'h0  // core
  };

endpackage
// verilator lint_on UNUSEDPARAM
