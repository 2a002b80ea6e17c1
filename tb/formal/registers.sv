// SPDX-License-Identifier: Apache-2.0
//
// Every access is answered once, two clocks later. These are errors and change nothing: an address that is not a
// multiple of four, an address without a register in this build, a write to a read-only register, or while its block is
// on to one that applies while off. Every setting is the
// value written to it, byte by byte, immediately or after a commit, which is none while core.hold is 1; a read gives all fields of its word in
// their places, with the core's counters as of the clock before the answer; a pulse follows its write by a clock, once.
// Where the build has fewer bits than the map, the core and a read get the nearest number that fits into them.
// registers_map.svh, made by tools/make/registers.py, has a line for each field.

module formal_registers #(
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
  parameter bit Forest = 1'b1,
  parameter bit Display = 1'b1,
  parameter logic [msn_registers_pkg::ResetBits-1:0] Resets = msn_registers_pkg::Reset,
  parameter int unsigned DetailBits = 18,  // fewer than the map's, as in most builds
  parameter int unsigned TimerBits = 11,
  parameter int unsigned LoadBits = 22,
  parameter int unsigned OffsetBits = 16
) (
  input logic        clk_i,
  input logic        rst_i,
  input logic        bus_valid_i,
  input logic        bus_write_i,
  input logic [11:0] bus_address_i,
  input logic [31:0] bus_wdata_i,
  input logic [3:0]  bus_strobe_i,
  input logic        commit_i,
  input msn_registers_pkg::status_t status_i
);

  msn_registers_pkg::cfg_t cfg_o;
  logic        bus_done_o, bus_error_o, pending_o;
  logic [31:0] bus_rdata_o;

  logic        started = 1'b0;
  logic        write, odd;
  logic [31:0] mask;
  assign odd   = bus_address_i[1:0] != 2'd0;
  assign write = bus_valid_i && bus_write_i && !odd;
  logic        commit;
  assign commit = commit_i && !cfg_o.core.hold;
  assign mask  = {{8{bus_strobe_i[3]}}, {8{bus_strobe_i[2]}}, {8{bus_strobe_i[1]}}, {8{bus_strobe_i[0]}}};

  // An access, one clock and two clocks after its request.
  logic        asked, wrote, uneven, done, error, empty;
  logic [9:0]  word;

  // A field in the answer: its bits are the field's value in the clock before.
`define READS(n, on, at, low, width, value) \
  logic             asked_``n; \
  logic [width-1:0] was_``n; \
  assign there[n] = on && word == at; \
  assign bits[32*n+:32] = there[n] ? {width{1'b1}} << low : '0; \
  always_ff @(posedge clk_i) {asked_``n, was_``n} <= {there[n], (width)'(value)}; \
  always_comb if (started && done && !empty && asked_``n) assert (bus_rdata_o[low+:width] == was_``n);

`define SETTING(n, on, at, low, width, place, name, member, waits, ends, sign, able) \
  logic [width-1:0] name``_fit; \
  owed_field #( \
    .On(on), .Word(at), .Low(low), .Width(width), .Reset(Resets[place+:width]), .Waits(waits), .Bits(ends), \
    .Signed(sign) \
  ) owed_``name ( \
    .clk_i, .rst_i, .write_i(write && (able)), .word_i(bus_address_i[11:2]), .data_i(bus_wdata_i), .mask_i(mask), \
    .commit_i(commit), .member_i(cfg_o.member), .held_i(dut.written[place+:width]), .fit_o(name``_fit), \
    .written_o(written[n]) \
  ); \
  `READS(n, on, at, low, width, name``_fit) \
  logic able_``n; \
  always_ff @(posedge clk_i) able_``n <= able; \
  assign writable[n] = there[n] && able_``n;

`define STATUS(n, on, at, low, width, name, member) \
  assign {written[n], writable[n]} = '0; \
  `READS(n, on, at, low, width, status_i.member)

`define CONSTANT(n, on, at, low, width, value) \
  assign {written[n], writable[n]} = '0; \
  `READS(n, on, at, low, width, value)

`define COMMAND(n, on, at, low, name, member) \
  logic due_``name; \
  assign {written[n], writable[n]} = {1'b0, there[n]}; \
  always_ff @(posedge clk_i) due_``name <= !rst_i && on && write && bus_address_i[11:2] == at && mask[low] && bus_wdata_i[low]; \
  always_comb if (started) assert (cfg_o.member == due_``name); \
  `READS(n, on, at, low, 1, 0)

`define WRITTEN(on, at, low, name, member) \
  logic wrote_``name; \
  always_ff @(posedge clk_i) wrote_``name <= !rst_i && on && write && bus_address_i[11:2] == at && mask[low]; \
  always_comb if (started) assert (cfg_o.member == wrote_``name);

`include "registers_map.svh"

  // A write of any setting that waits is pending until a commit, unless the host holds it.
  logic waits;
  always_ff @(posedge clk_i) begin
    if (commit) waits <= 1'b0;
    if ((written & Waiting) != '0) waits <= 1'b1;
    if (rst_i) waits <= 1'b0;
  end
  always_comb if (started) assert (dut.pending == waits && pending_o == (waits && !cfg_o.core.hold));

  msn_registers #(
    .Adc(Adc), .Slip(Slip), .Scan(Scan), .Health(Health), .Tare(Tare), .Calibrate(Calibrate), .Cop(Cop),
    .Cop4(Cop4), .CopSlip(CopSlip), .Link(Link), .Grip(Grip), .ShearSpeed(ShearSpeed), .Forest(Forest), .Display(Display),
    .Resets(Resets),
    .DetailBits(DetailBits), .TimerBits(TimerBits), .LoadBits(LoadBits), .OffsetBits(OffsetBits)
  ) dut (.*);

  logic [31:0] used, mask_q;  // bits of the word that some field has
  always_comb begin
    used = '0;
    for (int unsigned n = 0; n < Fields; n++) used |= bits[32*n+:32];
  end
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    asked   <= bus_valid_i && !rst_i;
    wrote   <= bus_write_i;
    uneven  <= odd;
    word    <= bus_address_i[11:2];
    done    <= asked && !rst_i;
    error   <= there == '0 || uneven || (wrote && writable == '0);
    empty   <= wrote || uneven;
    mask_q  <= used;
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert (bus_done_o == done);
      if (done) assert (bus_error_o == error);
      if (done) assert ((bus_rdata_o & (empty ? '1 : ~mask_q)) == '0);
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (done && !error && bus_rdata_o == 32'hCAFE_0001 && !wrote);
      cover (done && error && asked && writable != '0 && wrote);
      cover (done && !error && bus_rdata_o == 32'h4d534e52);
    end
  end

endmodule
