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
  } status_t;

  typedef enum logic [3:0] {
    Core, Adc, Slip, Scan, Health, Tare, Calibrate, Cop, Cop4, CopSlip, Link, Grip, ShearSpeed, Forest
  } group_e;
  localparam int unsigned Groups = 14;

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

  localparam int unsigned Rows       = 217;
  localparam int unsigned CfgBits    = 1546;
  localparam int unsigned StatusBits = 1558;
  // The first row highest.
  localparam logic [Rows*RowBits-1:0] Table = {
  {Core,      10'h000, 5'd0,  6'd32, Constant, AtOnce,   Whole,  1'b0, 12'd0, 32'h4d534e52},  // id
  {Core,      10'h001, 5'd0,  6'd8,  Constant, AtOnce,   Whole,  1'b0, 12'd0, 32'h0},  // version_patch
  {Core,      10'h001, 5'd8,  6'd8,  Constant, AtOnce,   Whole,  1'b0, 12'd0, 32'h6},  // version_minor
  {Core,      10'h001, 5'd16, 6'd16, Constant, AtOnce,   Whole,  1'b0, 12'd0, 32'h0},  // version_major
  {Core,      10'h002, 5'd0,  6'd32, Features, AtOnce,   Whole,  1'b0, 12'd0, 32'h0},  // features
  {Core,      10'h003, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd1542, 32'h0},  // size_rows
  {Core,      10'h003, 5'd16, 6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd1526, 32'h0},  // size_columns
  {Core,      10'h004, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1494, 32'h0},  // clk_khz
  {Core,      10'h005, 5'd0,  6'd32, Setting,  AtOnce,   Whole,  1'b0, 12'd1514, 32'h0},  // scratch
  {Core,      10'h006, 5'd0,  6'd8,  Widths,   AtOnce,   Detail, 1'b0, 12'd0, 32'h0},  // widths_detail
  {Core,      10'h006, 5'd8,  6'd8,  Widths,   AtOnce,   Timer,  1'b0, 12'd0, 32'h0},  // widths_timer
  {Core,      10'h006, 5'd16, 6'd8,  Widths,   AtOnce,   Load,   1'b0, 12'd0, 32'h0},  // widths_load
  {Core,      10'h006, 5'd24, 6'd8,  Widths,   AtOnce,   Offset, 1'b0, 12'd0, 32'h0},  // widths_offset
  {Core,      10'h007, 5'd0,  6'd21, Status,   AtOnce,   Whole,  1'b0, 12'd1473, 32'h0},  // beats
  {Core,      10'h008, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1513, 32'h20},  // hold
  {Core,      10'h009, 5'd0,  6'd4,  Status,   AtOnce,   Whole,  1'b0, 12'd1469, 32'h0},  // lanes
  {Adc,       10'h040, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1512, 32'h21},  // enable
  {Adc,       10'h041, 5'd0,  6'd24, Setting,  AtOnce,   Whole,  1'b0, 12'd1488, 32'h22},  // period
  {Adc,       10'h042, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1437, 32'h0},  // dropped
  {Adc,       10'h043, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1405, 32'h0},  // overrun
  {Adc,       10'h044, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1373, 32'h0},  // timeout
  {Adc,       10'h045, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1341, 32'h0},  // mistagged
  {Adc,       10'h046, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1309, 32'h0},  // over_range
  {Slip,      10'h080, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b0, 12'd1468, 32'h3a},  // threshold
  {Slip,      10'h081, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b0, 12'd1448, 32'h4e},  // gross_threshold
  {Slip,      10'h082, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b1, 12'd1428, 32'h62},  // contact_level
  {Slip,      10'h083, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b1, 12'd1408, 32'h76},  // release_level
  {Slip,      10'h084, 5'd0,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd1407, 32'h8a},  // contact_rises
  {Slip,      10'h085, 5'd0,  6'd16, Setting,  AtFrame,  Timer,  1'b0, 12'd1391, 32'h8b},  // hold
  {Slip,      10'h086, 5'd0,  6'd16, Setting,  AtFrame,  Timer,  1'b0, 12'd1375, 32'h9b},  // refractory
  {Slip,      10'h087, 5'd0,  6'd16, Setting,  AtFrame,  Timer,  1'b0, 12'd1359, 32'hab},  // blank
  {Slip,      10'h088, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1277, 32'h0},  // damaged
  {Slip,      10'h089, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1245, 32'h0},  // blanked
  {Slip,      10'h08a, 5'd0,  6'd20, Setting,  AtFrame,  Detail, 1'b0, 12'd1339, 32'hbb},  // keep_threshold
  {Scan,      10'h0c0, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1338, 32'hcf},  // enable
  {Scan,      10'h0c1, 5'd0,  6'd16, Setting,  AtScan,   Whole,  1'b0, 12'd1322, 32'hd0},  // settle
  {Scan,      10'h0c2, 5'd0,  6'd32, Setting,  AtScan,   Whole,  1'b0, 12'd1290, 32'he0},  // period
  {Scan,      10'h0c3, 5'd0,  6'd1,  Setting,  AtScan,   Whole,  1'b0, 12'd1289, 32'h100},  // interleave
  {Scan,      10'h0c4, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1213, 32'h0},  // dropped
  {Scan,      10'h0c5, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1181, 32'h0},  // overrun
  {Scan,      10'h0c6, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1149, 32'h0},  // held
  {Scan,      10'h0c7, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd1117, 32'h0},  // lost
  {Health,    10'h100, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1272, 32'h101},  // band
  {Health,    10'h101, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1255, 32'h112},  // jump
  {Health,    10'h102, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b1, 12'd1238, 32'h123},  // low
  {Health,    10'h103, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b1, 12'd1221, 32'h134},  // high
  {Health,    10'h104, 5'd0,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd1220, 32'h145},  // use_user
  {Health,    10'h104, 5'd1,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd1219, 32'h146},  // use_edges
  {Health,    10'h105, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd1211, 32'h147},  // still
  {Health,    10'h106, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd1203, 32'h14f},  // rail
  {Health,    10'h107, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd1195, 32'h157},  // blink
  {Health,    10'h108, 5'd0,  6'd1,  Command,  AtFrame,  Whole,  1'b0, 12'd1194, 32'h0},  // clear
  {Health,    10'h109, 5'd0,  6'd1,  Command,  AtFrame,  Whole,  1'b0, 12'd1193, 32'h0},  // report
  {Health,    10'h10a, 5'd0,  6'd21, Status,   AtOnce,   Whole,  1'b0, 12'd1096, 32'h0},  // dead
  {Health,    10'h10b, 5'd0,  6'd21, Status,   AtOnce,   Whole,  1'b0, 12'd1075, 32'h0},  // railed
  {Health,    10'h10c, 5'd0,  6'd21, Status,   AtOnce,   Whole,  1'b0, 12'd1054, 32'h0},  // blinking
  {Tare,      10'h120, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd1176, 32'h15f},  // contact
  {Tare,      10'h121, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd1168, 32'h170},  // step
  {Tare,      10'h122, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1167, 32'h178},  // force_
  {Tare,      10'h123, 5'd0,  6'd1,  Setting,  AtReset,  Whole,  1'b0, 12'd1166, 32'h179},  // at_start
  {Tare,      10'h124, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd1165, 32'h0},  // average
  {Tare,      10'h125, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1164, 32'h17a},  // load
  {Tare,      10'h126, 5'd0,  6'd20, Setting,  AtOnce,   Whole,  1'b0, 12'd1144, 32'h17b},  // word
  {Tare,      10'h127, 5'd0,  6'd17, Setting,  AtOnce,   Whole,  1'b1, 12'd1127, 32'h18f},  // zero
  {Tare,      10'h128, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd1119, 32'h1a0},  // write
  {Tare,      10'h128, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd1118, 32'h0},  // write_written
  {Tare,      10'h129, 5'd0,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd1053, 32'h0},  // state_loading
  {Tare,      10'h129, 5'd1,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd1052, 32'h0},  // state_taring
  {Tare,      10'h129, 5'd2,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd1051, 32'h0},  // state_pressed
  {Tare,      10'h12a, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd1035, 32'h0},  // tared
  {Tare,      10'h12b, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd1019, 32'h0},  // refused
  {Tare,      10'h12c, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd987, 32'h0},  // swallowed
  {Calibrate, 10'h140, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd1102, 32'h1a8},  // preset
  {Calibrate, 10'h141, 5'd0,  6'd20, Setting,  AtOnce,   Whole,  1'b0, 12'd1082, 32'h1b8},  // word
  {Calibrate, 10'h142, 5'd0,  6'd17, Setting,  AtOnce,   Offset, 1'b1, 12'd1065, 32'h1cc},  // offset
  {Calibrate, 10'h143, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd1049, 32'h1dd},  // gain
  {Calibrate, 10'h144, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd1041, 32'h1ed},  // write_lanes
  {Calibrate, 10'h144, 5'd8,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd1040, 32'h1f5},  // write_row
  {Calibrate, 10'h144, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd1039, 32'h0},  // write_written
  {Calibrate, 10'h145, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd1038, 32'h0},  // swap
  {Calibrate, 10'h146, 5'd0,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd986, 32'h0},  // swapping
  {Cop,       10'h180, 5'd0,  6'd32, Setting,  AtFrame,  Load,   1'b0, 12'd1006, 32'h1f6},  // min_load
  {Cop,       10'h181, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd954, 32'h0},  // damaged
  {Cop4,      10'h1c0, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd989, 32'h216},  // rail
  {Cop4,      10'h1c1, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd972, 32'h227},  // kx
  {Cop4,      10'h1c2, 5'd0,  6'd4,  Setting,  AtFrame,  Whole,  1'b0, 12'd968, 32'h238},  // shift_x
  {Cop4,      10'h1c3, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd951, 32'h23c},  // ky
  {Cop4,      10'h1c4, 5'd0,  6'd4,  Setting,  AtFrame,  Whole,  1'b0, 12'd947, 32'h24d},  // shift_y
  {Cop4,      10'h1c5, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b0, 12'd930, 32'h251},  // kf
  {Cop4,      10'h1c6, 5'd0,  6'd4,  Setting,  AtFrame,  Whole,  1'b0, 12'd926, 32'h262},  // shift_load
  {Cop4,      10'h1c7, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd908, 32'h266},  // p0
  {Cop4,      10'h1c8, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd890, 32'h278},  // p1
  {Cop4,      10'h1c9, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd872, 32'h28a},  // p2
  {Cop4,      10'h1ca, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd854, 32'h29c},  // p3
  {Cop4,      10'h1cb, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd836, 32'h2ae},  // p4
  {Cop4,      10'h1cc, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b1, 12'd818, 32'h2c0},  // p5
  {Cop4,      10'h1cd, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd802, 32'h2d2},  // min_load
  {Cop4,      10'h1ce, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd786, 32'h2e2},  // top
  {Cop4,      10'h1cf, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b1, 12'd769, 32'h2f2},  // idle
  {Cop4,      10'h1d0, 5'd0,  6'd17, Setting,  AtFrame,  Whole,  1'b1, 12'd752, 32'h303},  // busy
  {Cop4,      10'h1d1, 5'd0,  6'd18, Setting,  AtFrame,  Whole,  1'b0, 12'd734, 32'h314},  // imbalance
  {CopSlip,   10'h200, 5'd0,  6'd8,  Setting,  AtFrame,  Whole,  1'b0, 12'd726, 32'h326},  // drop
  {CopSlip,   10'h201, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd710, 32'h32e},  // move
  {CopSlip,   10'h202, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd694, 32'h33e},  // min_load
  {CopSlip,   10'h203, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd678, 32'h34e},  // hold
  {CopSlip,   10'h204, 5'd0,  6'd16, Setting,  AtFrame,  Whole,  1'b0, 12'd662, 32'h35e},  // refractory
  {Link,      10'h240, 5'd0,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd661, 32'h36e},  // images
  {Link,      10'h241, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd922, 32'h0},  // packets
  {Link,      10'h242, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd890, 32'h0},  // cop_dropped
  {Link,      10'h243, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd858, 32'h0},  // image_dropped
  {Link,      10'h244, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd826, 32'h0},  // rejected
  {Link,      10'h245, 5'd0,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd660, 32'h36f},  // events_none
  {Link,      10'h245, 5'd1,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd659, 32'h370},  // events_contact
  {Link,      10'h245, 5'd2,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd658, 32'h371},  // events_incipient
  {Link,      10'h245, 5'd3,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd657, 32'h372},  // events_gross
  {Link,      10'h245, 5'd4,  6'd1,  Setting,  AtFrame,  Whole,  1'b0, 12'd656, 32'h373},  // events_release
  {Link,      10'h246, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd655, 32'h0},  // states
  {Link,      10'h247, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd794, 32'h0},  // changes_lost
  {Grip,      10'h280, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd654, 32'h374},  // enable
  {Grip,      10'h281, 5'd0,  6'd24, Setting,  AtOnce,   Whole,  1'b0, 12'd630, 32'h375},  // period
  {Grip,      10'h282, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd614, 32'h38d},  // step
  {Grip,      10'h283, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd598, 32'h39d},  // decay
  {Grip,      10'h284, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd582, 32'h3ad},  // minimum
  {Grip,      10'h285, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd566, 32'h3bd},  // maximum
  {Grip,      10'h286, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd550, 32'h3cd},  // rate
  {Grip,      10'h287, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd534, 32'h3dd},  // watchdog
  {Grip,      10'h288, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd533, 32'h3ed},  // rule
  {Grip,      10'h289, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd532, 32'h3ee},  // mode
  {Grip,      10'h28a, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd531, 32'h3ef},  // immediate
  {Grip,      10'h28b, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd530, 32'h3f0},  // override_
  {Grip,      10'h28c, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd514, 32'h3f1},  // override_value
  {Grip,      10'h28d, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd506, 32'h401},  // divide
  {Grip,      10'h28e, 5'd0,  6'd17, Setting,  AtOnce,   Whole,  1'b1, 12'd489, 32'h409},  // low
  {Grip,      10'h28f, 5'd0,  6'd17, Setting,  AtOnce,   Whole,  1'b1, 12'd472, 32'h41a},  // high
  {Grip,      10'h290, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd464, 32'h42b},  // rail
  {Grip,      10'h291, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd778, 32'h0},  // command
  {Grip,      10'h292, 5'd0,  6'd17, Status,   AtOnce,   Whole,  1'b1, 12'd761, 32'h0},  // increment
  {Grip,      10'h293, 5'd0,  6'd5,  Status,   AtOnce,   Whole,  1'b0, 12'd756, 32'h0},  // fault
  {Grip,      10'h294, 5'd0,  6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd748, 32'h0},  // faulty
  {Grip,      10'h295, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd716, 32'h0},  // commands
  {Grip,      10'h296, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd684, 32'h0},  // tightenings
  {Grip,      10'h297, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd448, 32'h433},  // speed_gain
  {Grip,      10'h298, 5'd0,  6'd3,  Setting,  AtOnce,   Whole,  1'b0, 12'd445, 32'h443},  // boost
  {ShearSpeed,10'h2c0, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd444, 32'h446},  // enable
  {ShearSpeed,10'h2c1, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b0, 12'd418, 32'h447},  // k0
  {ShearSpeed,10'h2c2, 5'd0,  6'd18, Setting,  WhileOff, Whole,  1'b1, 12'd400, 32'h461},  // k1
  {ShearSpeed,10'h2c3, 5'd0,  6'd16, Setting,  WhileOff, Whole,  1'b0, 12'd384, 32'h473},  // exponent
  {ShearSpeed,10'h2c4, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b1, 12'd358, 32'h483},  // vi_min
  {ShearSpeed,10'h2c5, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b1, 12'd332, 32'h49d},  // vi_max
  {ShearSpeed,10'h2c6, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b0, 12'd306, 32'h4b7},  // noise
  {ShearSpeed,10'h2c7, 5'd0,  6'd26, Setting,  WhileOff, Whole,  1'b0, 12'd280, 32'h4d1},  // still
  {ShearSpeed,10'h2c8, 5'd0,  6'd17, Setting,  WhileOff, Whole,  1'b1, 12'd263, 32'h4eb},  // full
  {ShearSpeed,10'h2c9, 5'd0,  6'd24, Setting,  WhileOff, Whole,  1'b0, 12'd239, 32'h4fc},  // limit
  {ShearSpeed,10'h2ca, 5'd0,  6'd32, Setting,  WhileOff, Whole,  1'b0, 12'd207, 32'h514},  // travel
  {ShearSpeed,10'h2cb, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd206, 32'h534},  // hold
  {ShearSpeed,10'h2cc, 5'd0,  6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd198, 32'h535},  // hold_cycles
  {ShearSpeed,10'h2cd, 5'd0,  6'd3,  Setting,  AtOnce,   Whole,  1'b0, 12'd195, 32'h53d},  // select
  {ShearSpeed,10'h2ce, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd660, 32'h0},  // channel0_speed
  {ShearSpeed,10'h2ce, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd652, 32'h0},  // channel0_flags
  {ShearSpeed,10'h2cf, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd628, 32'h0},  // channel1_speed
  {ShearSpeed,10'h2cf, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd620, 32'h0},  // channel1_flags
  {ShearSpeed,10'h2d0, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd596, 32'h0},  // channel2_speed
  {ShearSpeed,10'h2d0, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd588, 32'h0},  // channel2_flags
  {ShearSpeed,10'h2d1, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd564, 32'h0},  // channel3_speed
  {ShearSpeed,10'h2d1, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd556, 32'h0},  // channel3_flags
  {ShearSpeed,10'h2d2, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd532, 32'h0},  // channel4_speed
  {ShearSpeed,10'h2d2, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd524, 32'h0},  // channel4_flags
  {ShearSpeed,10'h2d3, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd500, 32'h0},  // channel5_speed
  {ShearSpeed,10'h2d3, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd492, 32'h0},  // channel5_flags
  {ShearSpeed,10'h2d4, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd468, 32'h0},  // channel6_speed
  {ShearSpeed,10'h2d4, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd460, 32'h0},  // channel6_flags
  {ShearSpeed,10'h2d5, 5'd0,  6'd24, Status,   AtOnce,   Whole,  1'b0, 12'd436, 32'h0},  // channel7_speed
  {ShearSpeed,10'h2d5, 5'd24, 6'd8,  Status,   AtOnce,   Whole,  1'b0, 12'd428, 32'h0},  // channel7_flags
  {ShearSpeed,10'h2d6, 5'd0,  6'd26, Status,   AtOnce,   Whole,  1'b1, 12'd402, 32'h0},  // vi
  {ShearSpeed,10'h2d7, 5'd0,  6'd27, Status,   AtOnce,   Whole,  1'b1, 12'd375, 32'h0},  // rise
  {ShearSpeed,10'h2d8, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd343, 32'h0},  // windows
  {Forest,    10'h300, 5'd0,  6'd9,  Status,   AtOnce,   Whole,  1'b0, 12'd334, 32'h0},  // size_features
  {Forest,    10'h300, 5'd9,  6'd5,  Status,   AtOnce,   Whole,  1'b0, 12'd329, 32'h0},  // size_bits
  {Forest,    10'h300, 5'd14, 6'd7,  Status,   AtOnce,   Whole,  1'b0, 12'd322, 32'h0},  // size_engines
  {Forest,    10'h300, 5'd21, 6'd2,  Status,   AtOnce,   Whole,  1'b0, 12'd320, 32'h0},  // size_banks
  {Forest,    10'h300, 5'd23, 6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd319, 32'h0},  // size_frames
  {Forest,    10'h301, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd303, 32'h0},  // room_trees
  {Forest,    10'h301, 5'd16, 6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd287, 32'h0},  // room_classes
  {Forest,    10'h302, 5'd0,  6'd23, Status,   AtOnce,   Whole,  1'b0, 12'd264, 32'h0},  // nodes
  {Forest,    10'h303, 5'd0,  6'd17, Status,   AtOnce,   Whole,  1'b0, 12'd247, 32'h0},  // leaves
  {Forest,    10'h304, 5'd0,  6'd2,  Setting,  AtOnce,   Whole,  1'b0, 12'd193, 32'h540},  // target_kind
  {Forest,    10'h304, 5'd8,  6'd6,  Setting,  AtOnce,   Whole,  1'b0, 12'd187, 32'h542},  // target_engine
  {Forest,    10'h304, 5'd16, 6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd171, 32'h548},  // target_label
  {Forest,    10'h305, 5'd0,  6'd22, Setting,  AtOnce,   Whole,  1'b0, 12'd149, 32'h558},  // address
  {Forest,    10'h305, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd148, 32'h0},  // address_written
  {Forest,    10'h306, 5'd0,  6'd32, Setting,  AtOnce,   Whole,  1'b0, 12'd116, 32'h56e},  // high
  {Forest,    10'h307, 5'd0,  6'd32, Setting,  AtOnce,   Whole,  1'b0, 12'd84, 32'h58e},  // data
  {Forest,    10'h307, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd83, 32'h0},  // data_written
  {Forest,    10'h308, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd82, 32'h0},  // clear
  {Forest,    10'h309, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd81, 32'h0},  // swap
  {Forest,    10'h30a, 5'd0,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd246, 32'h0},  // state_loaded
  {Forest,    10'h30a, 5'd1,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd245, 32'h0},  // state_waits
  {Forest,    10'h30a, 5'd2,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd244, 32'h0},  // state_swapping
  {Forest,    10'h30a, 5'd3,  6'd1,  Status,   AtOnce,   Whole,  1'b0, 12'd243, 32'h0},  // state_refused
  {Forest,    10'h30a, 5'd4,  6'd3,  Status,   AtOnce,   Whole,  1'b0, 12'd240, 32'h0},  // state_error
  {Forest,    10'h30b, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd208, 32'h0},  // written
  {Forest,    10'h30c, 5'd0,  6'd22, Setting,  AtOnce,   Whole,  1'b1, 12'd59, 32'h5ae},  // feature
  {Forest,    10'h30c, 5'd24, 6'd8,  Setting,  AtOnce,   Whole,  1'b0, 12'd51, 32'h5c4},  // feature_index
  {Forest,    10'h30c, 5'd0,  6'd1,  Strobe,   AtOnce,   Whole,  1'b0, 12'd50, 32'h0},  // feature_written
  {Forest,    10'h30d, 5'd0,  6'd1,  Command,  AtOnce,   Whole,  1'b0, 12'd49, 32'h0},  // start
  {Forest,    10'h30e, 5'd0,  6'd32, Setting,  AtOnce,   Whole,  1'b0, 12'd17, 32'h5cc},  // slip
  {Forest,    10'h30f, 5'd0,  6'd1,  Setting,  AtOnce,   Whole,  1'b0, 12'd16, 32'h5ec},  // grip
  {Forest,    10'h310, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd192, 32'h0},  // label
  {Forest,    10'h311, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd160, 32'h0},  // best
  {Forest,    10'h312, 5'd0,  6'd16, Setting,  AtOnce,   Whole,  1'b0, 12'd0, 32'h5ed},  // select
  {Forest,    10'h313, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd128, 32'h0},  // votes
  {Forest,    10'h314, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd96, 32'h0},  // decisions
  {Forest,    10'h315, 5'd0,  6'd32, Status,   AtOnce,   Whole,  1'b0, 12'd64, 32'h0},  // changes
  {Forest,    10'h316, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd48, 32'h0},  // missed
  {Forest,    10'h317, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd32, 32'h0},  // absent
  {Forest,    10'h318, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd16, 32'h0},  // late
  {Forest,    10'h319, 5'd0,  6'd16, Status,   AtOnce,   Whole,  1'b0, 12'd0, 32'h0}  // broken
  };

  // Of each group: the bit of cfg_t that is 1 while its block is on, for settings that apply while it is off.
  localparam logic [12*Groups-1:0] Switches = {
    12'd0, 12'd444, 12'd654, 12'd0, 12'd0, 12'd0, 12'd0, 12'd0, 12'd0, 12'd0, 12'd1338, 12'd0, 12'd1512, 12'd0
  };

  localparam int unsigned ResetBits = 1533;
  localparam logic [ResetBits-1:0] Reset = {
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
