// SPDX-License-Identifier: Apache-2.0
//
// Never are two rows on; a row goes on only after all were off for a clock; the lines are as the plan switched them,
// and off while it has nothing to do (proof `scan_plan` shows when a converter starts). A beat is taken when each
// converter has a sample or is lost, with lost lanes 0 and marked; it goes to the frame if it has columns of the array
// and is discarded otherwise; a frame's number and time are those of its first conversion. Overlap clocks after a trigger
// beats become those of its conversion; until then they are of the one before.

module formal_scan #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Hold       = 2,
  parameter  int unsigned Cycle      = 268,
  parameter  int unsigned Overlap    = 0,
  parameter  int unsigned Depth      = 256,
  parameter  int unsigned SettleBits = 16,
  parameter  int unsigned PeriodBits = 32,
  localparam int unsigned Beats      = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned GroupBits  = msn_pkg::index_width((Beats + Channels - 1) / Channels),
  localparam int unsigned Width      = Lanes * (SampleBits + 1)
) (
  input logic                        clk_i,
  input logic                        rst_i,
  input logic                        cfg_enable_i,
  input logic [SettleBits-1:0]       cfg_settle_i,
  input logic [PeriodBits-1:0]       cfg_period_i,
  input logic                        cfg_interleave_i,
  input logic [47:0]                 now_i,
  input logic [Lanes-1:0]            in_valid_i,
  input logic [Lanes*SampleBits-1:0] in_data_i,
  input logic [Lanes-1:0]            in_user_i,
  input logic [Lanes-1:0]            in_lost_i
);

  logic [Rows-1:0]      row_o, row;
  logic [GroupBits-1:0] group_o;
  logic                 trigger_o;
  logic [Lanes-1:0]     in_ready_o;
  msn_registers_pkg::scan_cfg_t    cfg;
  msn_registers_pkg::scan_status_t status;
  always_comb begin
    cfg        = '0;
    cfg.enable = cfg_enable_i;
    cfg.settle = 16'(cfg_settle_i);
    cfg.period = 32'(cfg_period_i);
    cfg.interleave = cfg_interleave_i;
  end
  msn_scan #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Channels(Channels), .SampleBits(SampleBits), .Hold(Hold),
    .Cycle(Cycle), .Overlap(Overlap), .Depth(Depth), .SettleBits(SettleBits), .PeriodBits(PeriodBits)
  ) dut (
    .clk_i, .rst_i, .cfg_i(cfg), .status_o(status), .now_i, .row_o, .group_o, .trigger_o,
    .in_valid_i, .in_ready_o, .in_data_i, .in_user_i, .in_lost_i
  );

  // The lines.
  logic                 started = 1'b0;
  logic                 change, grouped;
  logic [31:0]          to_row;
  logic [GroupBits-1:0] to_group, group;
  logic [Rows-1:0]      lines;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    row     <= row_o;
    change  <= dut.switch_now && !rst_i;
    if (dut.switch_now) begin
      to_row   <= 32'(dut.switch_row);
      to_group <= dut.switch_group;
    end
    if (dut.idle || dut.switch_now) lines <= '0;
    if (change) begin
      lines   <= (to_row < Rows) ? Rows'(1) << to_row : '0;
      group   <= to_group;
      grouped <= 1'b1;
    end
    if (rst_i) begin
      lines   <= '0;
      grouped <= 1'b0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert ((row_o & (row_o - 1'b1)) == '0);
      if (row_o != row) assert (row_o == '0 || row == '0);
      assert (row_o == lines);
      if (grouped) assert (group_o == group);
    end
  end

  // Invariant: a switch blanks the lines in the clock before they change.
  always_comb if (started) begin
    assert (dut.change_q == change && (!change || row_o == '0));
    if (change) assert (32'(dut.row_q) == to_row && dut.group_q == to_group);
  end

  // Beats, up to the clock in which the buffer gets them.
  logic [Lanes-1:0]            lost;
  logic [Lanes*SampleBits-1:0] data;
  logic                        beat, last, missed, come, wanted, opens, triggered, turn, of_first;
  logic [31:0]                 after;     // clocks since the last trigger, at most all ones
  logic [GroupBits-1:0]        of_group;  // of the conversion whose beats come
  logic [47:0]                 begun;
  logic [7:0]                  channel, come_channel;
  logic [Width-1:0]            come_data, wanted_data;
  logic [31:0]                 losses, frames, place;
  logic [47:0]                 moment;
  logic                        timed;
  assign beat = (in_valid_i | lost) == '1;
  assign last = 32'(channel) == Channels - 1;
  for (genvar l = 0; l < Lanes; l++) begin : gen_lane
    assign data[l*SampleBits+:SampleBits] = in_data_i[l*SampleBits+:SampleBits] & {SampleBits{!lost[l]}};
  end
  if (Overlap == 0) begin : gen_apart
    assign {turn, of_first, of_group} = {trigger_o, dut.done_first, dut.done_group};
  end else begin : gen_overlap
    assign turn = after == Overlap - 1;
    always_ff @(posedge clk_i) begin
      after <= rst_i ? '1 : trigger_o ? '0 : (after == '1) ? after : after + 1'b1;
      if (triggered && dut.done_first) begun <= now_i;
      if (turn) {of_first, of_group} <= {dut.done_first, dut.done_group};
    end
    always_comb begin  // invariant; both begin in the same state, which is arbitrary
      if (!started) begin
        assume (dut.sent_first == of_first && dut.sent_group == of_group && dut.begun == begun);
        assume (dut.turn == turn && dut.trigger_q == triggered);
      end
      if (started) begin
        assert (dut.gen_overlap.none_q == (after >= Overlap));
        if (after < Overlap) assert (32'(dut.gen_overlap.left_q) == Overlap - 1 - after);
        assert (dut.sent_first == of_first && dut.sent_group == of_group && dut.begun == begun);
      end
    end
  end
  // A group's number that cannot occur is ignored where there is one group of another number than 2^n of channels.
  localparam bit Counts = Beats > Channels || (Channels & (Channels - 1)) == 0;
  assign place = (Counts ? 32'(of_group) * Channels : 32'd0) + 32'(come_channel);
  always_ff @(posedge clk_i) begin
    lost    <= in_lost_i | ((beat && last) ? '0 : lost);
    channel <= turn ? '0 : !beat ? channel : last ? '0 : channel + 1'b1;
    missed  <= beat && last && lost != '0;
    losses  <= losses + 32'(missed);

    come         <= beat;
    come_channel <= channel;
    come_data    <= {in_user_i | lost, data};

    wanted      <= come && place < Beats;
    opens       <= of_first && place == 32'd0;
    wanted_data <= come_data;

    triggered <= trigger_o;
    if ((Overlap == 0 ? triggered : turn) && dut.done_first) begin
      moment <= (Overlap == 0) ? now_i : begun;
      timed  <= 1'b1;
      frames <= frames + 1'b1;
    end
    if (rst_i) begin
      lost      <= '0;
      channel   <= '0;
      missed    <= 1'b0;
      losses    <= '0;
      come      <= 1'b0;
      wanted    <= 1'b0;
      triggered <= 1'b0;
      timed     <= 1'b0;
      frames    <= '1;
    end
  end

  always_comb begin
    if (started) begin
      assert (status.lost == losses);
      if (!rst_i) assert (in_ready_o == {Lanes{beat}});
      assert (dut.u_buffer.in_valid_i == wanted);
      if (wanted) assert (dut.u_buffer.in_first_i == opens && dut.u_buffer.in_data_i == wanted_data);
      assert (dut.frame_q == frames);
      if (timed) assert (dut.time_q == moment);
      // Invariant.
      assert (dut.lost_q == lost && 8'(dut.channel_q) == channel && 32'(channel) < Channels && dut.missed == missed);
      assert (dut.beat_q == come && dut.trigger_q == triggered);
      if (come) assert (8'(dut.channel_q2) == come_channel && dut.beat_data_q == come_data && 32'(come_channel) < Channels);
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (row_o != '0 && row != '0);
      cover (trigger_o && row_o != '0);
      cover (wanted && opens);
      cover (missed && losses == 32'd1);
    end
  end

endmodule
