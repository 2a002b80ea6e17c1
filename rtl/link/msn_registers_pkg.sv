// SPDX-License-Identifier: Apache-2.0
//
// Made by tools/make/registers.py from rtl/registers.rdl: change that, then `make registers`.
//
// A struct per group of registers: what the core gets of it, what it gives. Members have no sign: `signed'()`
// where docs/registers.md has one. And the settings' reset values as one number, the first setting lowest.

// verilog_lint: waive-start line-length

package msn_registers_pkg;

  typedef struct packed {
    logic [31:0] scratch;
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
  } cfg_t;

  typedef struct packed {
    logic [15:0] size_rows;
    logic [15:0] size_columns;
    logic [31:0] clk_khz;
    logic [20:0] beats;
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
  } status_t;

  localparam int unsigned ResetBits = 1338;
  // A default: builds that give their own values do not use it.
  // verilator lint_off UNUSEDPARAM
  localparam logic [ResetBits-1:0] Reset = 1338'h640000c000001ff000020c80147ae0ccccd019999a9175dd70813d70a00000100fff00000000000000a0400753002000000008007a1202000000000000000101ffffbfffdfffffffe00020000000000000000000000000000000000000000001fffe00000002000000000000000000000000000000100801000000037fff8000000000002000000000000bffffc0000000000020000000001fffffffffe00000000000000;
  // verilator lint_on UNUSEDPARAM

endpackage
