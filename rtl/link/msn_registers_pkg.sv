// SPDX-License-Identifier: Apache-2.0
//
// Made by tools/registers.py from rtl/registers.rdl: change that, then `make registers`.
//
// The settings' reset values as one number, the first setting of docs/registers.md lowest.

// verilog_lint: waive-start line-length

package msn_registers_pkg;

  localparam int unsigned ResetBits = 878;
  // A default: builds that give their own values do not use it.
  // verilator lint_off UNUSEDPARAM
  localparam logic [ResetBits-1:0] Reset = 878'h2000000000000000101ffffbfffdfffffffe00020000000000000000000000000000000000000000001fffe00000002000000000000000000000000000000100801000000037fff8000000000002000000000000bffffc0000000000020000000001fffffffffe00000000000000;
  // verilator lint_on UNUSEDPARAM

endpackage
