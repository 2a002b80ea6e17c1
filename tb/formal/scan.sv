// SPDX-License-Identifier: Apache-2.0
//
// Never two rows at once; a row comes on only where all were off for a clock; a converter starts only while the lines
// stand as they were switched (when they have had their time is proof `scan_plan`).

module formal_scan #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Hold       = 2,
  parameter  int unsigned Cycle      = 268,
  parameter  int unsigned Depth      = 256,
  parameter  int unsigned SlipSlots  = 1,
  parameter  int unsigned SettleBits = 16,
  parameter  int unsigned PeriodBits = 32,
  parameter  int unsigned GroupBits  = 1
) (
  input logic                  clk_i,
  input logic                  rst_i,
  input logic                  cfg_enable_i,
  input logic [SettleBits-1:0] cfg_settle_i,
  input logic [PeriodBits-1:0] cfg_period_i
);

  logic [Rows-1:0] row_o, row;
  logic            trigger_o;
  msn_scan #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Channels(Channels), .SampleBits(SampleBits), .Hold(Hold),
    .Cycle(Cycle), .Depth(Depth), .SlipSlots(SlipSlots), .SettleBits(SettleBits), .PeriodBits(PeriodBits),
    .GroupBits(GroupBits)
  ) dut (.clk_i, .rst_i, .cfg_enable_i, .cfg_settle_i, .cfg_period_i, .row_o, .trigger_o);

  logic started = 1'b0;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    row     <= row_o;
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert ((row_o & (row_o - 1'b1)) == '0);
      if (row_o != row) assert (row_o == '0 || row == '0);
    end
  end

  // Invariant: a switch blanks the lines in the clock before they change.
  always_comb if (started && dut.change_q) assert (row_o == '0);

  always_comb begin
    if (started && !rst_i) begin
      cover (row_o != '0 && row != '0);
      cover (trigger_o && row_o != '0);
    end
  end

endmodule
