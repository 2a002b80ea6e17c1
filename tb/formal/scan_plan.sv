// SPDX-License-Identifier: Apache-2.0
//
// A converter starts exactly Settle + 1 clocks after each switch of the lines, once, and never else; no switch comes
// from one to its trigger, nor within Hold clocks after that; triggers are Cycle clocks apart at the least. Settle is
// what the register said while the plan was off. Rows that a frame switches to are in the array.

module formal_scan_plan #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned Hold       = 2,
  parameter  int unsigned Cycle      = 268,
  parameter  int unsigned SlipSlots  = 1,
  parameter  int unsigned SettleBits = 16,
  parameter  int unsigned PeriodBits = 32,
  parameter  int unsigned GroupBits  = 1,
  localparam int unsigned RowBits    = msn_pkg::index_width(Rows),
  localparam int unsigned ColumnBits = msn_pkg::index_width(Columns),
  localparam int unsigned Beats      = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned BeatBits   = msn_pkg::index_width(Beats)
) (
  input logic                             clk_i,
  input logic                             rst_i,
  input logic                             cfg_enable_i,
  input logic [SettleBits-1:0]            cfg_settle_i,
  input logic [PeriodBits-1:0]            cfg_period_i,
  input logic                             cfg_interleave_i,
  input logic [RowBits-1:0]               cfg_first_row_i,
  input logic [RowBits-1:0]               cfg_last_row_i,
  input logic [ColumnBits-1:0]            cfg_first_column_i,
  input logic [ColumnBits-1:0]            cfg_last_column_i,
  input logic [PeriodBits-1:0]            cfg_slip_period_i,
  input logic [SlipSlots*(RowBits+1)-1:0] cfg_slip_row_i,
  input logic [SlipSlots*GroupBits-1:0]   cfg_slip_group_i,
  input logic                             room_i
);

  logic                 idle_o, switch_o, trigger_o, done_slip_o, done_first_o, frame_interleave_o;
  logic [RowBits:0]     switch_row_o;
  logic [GroupBits-1:0] switch_group_o, done_group_o;
  logic [RowBits-1:0]   frame_first_row_o, frame_last_row_o;
  logic [BeatBits-1:0]  frame_first_beat_o, frame_last_beat_o;
  logic [31:0]          overrun_o, slip_overrun_o, held_o;
  msn_scan_plan #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Channels(Channels), .Hold(Hold), .Cycle(Cycle),
    .SlipSlots(SlipSlots), .SettleBits(SettleBits), .PeriodBits(PeriodBits), .GroupBits(GroupBits)
  ) dut (.*);

  // The register holds while it is on.
  localparam int unsigned Wide = SettleBits + 2;
  logic                  started = 1'b0;
  logic [SettleBits-1:0] settle;
  logic                  settling, triggered;  // a switch waits for its trigger; there was one since reset
  logic [Wide-1:0]       after;                // clocks since the last switch
  logic [19:0]           since;                // clocks since the last trigger
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    settle  <= cfg_settle_i;
    after   <= after + 1'b1;
    since   <= (since == '1) ? '1 : since + 1'b1;
    if (switch_o) begin
      settling <= 1'b1;
      after    <= Wide'(1);
    end
    if (trigger_o) begin
      settling  <= 1'b0;
      triggered <= 1'b1;
      since     <= 20'd1;
    end
    if (rst_i) begin
      settling  <= 1'b0;
      triggered <= 1'b0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) assume (cfg_settle_i == settle);
    if (started && !rst_i) begin
      assert (trigger_o == (settling && after == Wide'(settle) + Wide'(1)));
      if (settling) assert (!switch_o && after <= Wide'(settle) + Wide'(1));
      if (switch_o && triggered) assert (since >= 20'(Hold));
      if (trigger_o && triggered) assert (since >= 20'(Cycle));
      if (switch_o) assert (!idle_o);
      if (settling) assert (!idle_o);
    end
  end

  // Invariant.
  logic [Wide-1:0] gap;
  assign gap = (Wide'(settle) + Wide'(Hold + 1) >= Wide'(Cycle)) ? Wide'(Hold) : Wide'(Cycle - 1) - Wide'(settle);
  always_comb begin
    if (started) begin
      assert (settling == (dut.state_q == 2'd2));
      if (dut.state_q != 2'd0) assert (dut.settle_q == settle && Wide'(dut.gap_q) == gap);
      if (dut.state_q != 2'd0) assert (Wide'(dut.rest_q) == gap - Wide'(2));
      if (dut.state_q != 2'd0) assert (dut.at_once_q == (settle == '0));
      if (dut.state_q == 2'd0) begin
        assert (Wide'(dut.count_q) <= Wide'(3));
        if (Wide'(dut.count_q) <= Wide'(2)) assert (dut.settle_q == settle);
        if (dut.count_q == '0) assert (Wide'(dut.rest_q) == gap - Wide'(2));
        if (Wide'(dut.count_q) <= Wide'(1)) assert (Wide'(dut.gap_q) == gap && dut.at_once_q == (settle == '0));
      end
      if (settling) assert (after >= Wide'(1) && Wide'(dut.count_q) + after == Wide'(settle) + Wide'(1));
      if (settling && triggered) assert (since >= 20'(gap) + 20'(after) || since == '1);
      if (dut.state_q == 2'd3) assert (triggered && 24'(dut.count_q) + 24'(since) >= 24'(gap) - 24'd1);
      if (dut.state_q == 2'd1 && triggered) assert (since >= 20'(gap));
      if (dut.state_q == 2'd0 && triggered) assert (since >= 20'(gap));
      if (!settling) assert (!trigger_o);
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (trigger_o && settle == SettleBits'(3));
      cover (switch_o && settle == '0 && switch_row_o == (RowBits + 1)'(1));
      cover (trigger_o && idle_o == 1'b0 && switch_row_o == '0);
    end
  end

endmodule
