// SPDX-License-Identifier: Apache-2.0
//
// Scans a matrix: drives one row at a time, selects a group of columns, starts Lanes converters and sends their samples
// on row-major, Lanes in parallel.
//
//   column = (group*Channels + channel)*Lanes + lane      id = row*Beats + column/Lanes, Beats = ceil(Columns/Lanes)
//
// row_o is one-hot or all low; between two conversions it is low for a clock. A conversion starts (trigger_o, a clock
// later at the pins) exactly settle clocks after row_o and group_o changed. Before Overlap clocks have passed since the
// next trigger, and not before they have since its own, every converter must give Channels samples, or a lost strobe at
// least Channels + 3 clocks before; then its samples are 0 and marked in user.
// Frames leave complete or not at all. First sample in to out 5 clocks.   Model: model/meissner/twins/frontend/scan.py

module msn_scan #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned Hold       = 2,    // see msn_scan_plan
  parameter  int unsigned Cycle      = 268,
  parameter  int unsigned Overlap    = 0,    // clocks from a trigger in which the one before still sends
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned SettleBits = 16,
  parameter  int unsigned PeriodBits = 32,
  localparam int unsigned RowBits    = msn_pkg::index_width(Rows),
  localparam int unsigned Beats      = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned IdBits     = msn_pkg::index_width(Rows * Beats),
  parameter  int unsigned Depth      = Rows * Beats,  // beats of buffer, see msn_scan_buffer
  localparam int unsigned GroupBits  = msn_pkg::index_width((Beats + Channels - 1) / Channels)
) (
  input  logic                        clk_i,
  input  logic                        rst_i,

  input  msn_registers_pkg::scan_cfg_t    cfg_i,
  output msn_registers_pkg::scan_status_t status_o,
  input  logic [47:0]                 now_i,         // clock ticks

  output logic [Rows-1:0]             row_o,
  output logic [GroupBits-1:0]        group_o,
  output logic                        trigger_o,

  input  logic [Lanes-1:0]            in_valid_i,    // lane by lane
  output logic [Lanes-1:0]            in_ready_o,
  input  logic [Lanes*SampleBits-1:0] in_data_i,
  input  logic [Lanes-1:0]            in_user_i,
  input  logic [Lanes-1:0]            in_lost_i,

  output logic                        out_valid_o,
  input  logic                        out_ready_i,
  output logic [Lanes*SampleBits-1:0] out_data_o,    // the leftmost column in the low bits
  output logic [IdBits-1:0]           out_id_o,
  output logic                        out_last_o,
  output logic [Lanes-1:0]            out_user_o,    // over-range or lost
  output logic [31:0]                 out_frame_o,   // frames converted before this one
  output logic [47:0]                 out_time_o     // now_i when its first conversion started
);

  if (SampleBits < 2) begin : gen_check_sample_bits
    $fatal(1, "msn_scan: SampleBits = %0d must be at least 2", SampleBits);
  end

  if (Overlap == 1 || Overlap >= Cycle) begin : gen_check_overlap
    $fatal(1, "msn_scan: Overlap = %0d must be 0 or lie in 2 .. Cycle - 1", Overlap);
  end

  localparam int unsigned Width    = Lanes * (SampleBits + 1);
  localparam int unsigned ChanBits = msn_pkg::index_width(Channels);

  logic                 idle, switch_now, done_first, done_interleave, room;
  logic [31:0]          dropped;  // frames: the frame before was not taken yet
  logic [31:0]          overrun;  // frame ticks: the frame before was not done
  logic [31:0]          held;     // clocks the scan waited for room in the buffer
  logic [31:0]          lost;     // conversions in which a converter did not answer
  assign status_o = {dropped, overrun, held, lost};
  logic [RowBits-1:0]   switch_row;
  logic [GroupBits-1:0] switch_group, done_group;
  // Of the conversion whose samples come. `turn`: the one triggered last becomes this one.
  logic                 turn, sent_first, sent_interleave, begins;
  logic [GroupBits-1:0] sent_group;
  logic [47:0]          begun;  // convert start, with `begins`: of a frame whose samples come next
  msn_scan_plan #(
    .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .Channels(Channels), .Hold(Hold), .Cycle(Cycle),
    .SettleBits(SettleBits), .PeriodBits(PeriodBits)
  ) u_plan (
    .clk_i, .rst_i,
    .cfg_enable_i(cfg_i.enable), .cfg_settle_i(SettleBits'(cfg_i.settle)),
    .cfg_period_i(PeriodBits'(cfg_i.period)), .cfg_interleave_i(cfg_i.interleave),
    .room_i(room), .idle_o(idle),
    .switch_o(switch_now), .switch_row_o(switch_row), .switch_group_o(switch_group),
    .trigger_o,
    .done_first_o(done_first), .done_group_o(done_group), .done_interleave_o(done_interleave),
    .overrun_o(overrun), .held_o(held)
  );

  // The rows are off for a clock before each conversion, even if the row stays the same, so that all are alike.
  logic [RowBits-1:0]   row_q;
  logic [GroupBits-1:0] group_q;
  logic                 change_q;
  always_ff @(posedge clk_i) begin
    change_q <= switch_now;
    row_q    <= switch_row;  // used only a clock after a switch
    group_q  <= switch_group;
    if (idle || switch_now) row_o <= '0;
    if (change_q) begin
      group_o <= group_q;
      for (int unsigned r = 0; r < Rows; r++) row_o[r] <= row_q == RowBits'(r);
    end
    if (rst_i) begin
      change_q <= 1'b0;
      row_o    <= '0;
    end
  end

  // One beat of all converters. A converter that lost a conversion has no samples until its next one.
  logic [Lanes-1:0]            lost_q;
  logic [Lanes*SampleBits-1:0] data;
  logic                        beat, beat_end, beat_q, missed;
  logic [ChanBits-1:0]         channel_q, channel_q2;
  logic [Width-1:0]            beat_data_q;
  assign beat       = &(in_valid_i | lost_q);
  assign beat_end   = channel_q == ChanBits'(Channels - 1);
  assign in_ready_o = {Lanes{beat}};
  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_lane
    assign data[lane*SampleBits+:SampleBits] = lost_q[lane] ? '0 : in_data_i[lane*SampleBits+:SampleBits];
  end
  always_ff @(posedge clk_i) begin
    lost_q <= ((beat && beat_end) ? '0 : lost_q) | in_lost_i;
    if (turn) channel_q <= '0;  // it is 0 already, unless an upset changed it
    else if (beat) channel_q <= beat_end ? '0 : channel_q + 1'b1;
    beat_q      <= beat;
    channel_q2  <= channel_q;
    beat_data_q <= {in_user_i | lost_q, data};
    missed      <= beat && beat_end && |lost_q;
    lost        <= lost + 32'(missed);
    if (rst_i) begin
      lost_q    <= '0;
      missed    <= 1'b0;
      channel_q <= '0;
      beat_q    <= 1'b0;
      lost      <= '0;
    end
  end

  // The beat's place in its row, group*Channels + channel, by shifts and adds.
  localparam int unsigned PlaceBits = GroupBits + ChanBits;
  logic [PlaceBits-1:0] place;
  logic                 wanted, frame_first;
  if (Channels == 1) begin : gen_one
    assign place = PlaceBits'(sent_group);
    logic unused_channel;
    assign unused_channel = ^channel_q2;
  end else if (msn_pkg::is_power(Channels)) begin : gen_power
    assign place = {sent_group, channel_q2};
  end else if (Beats > Channels) begin : gen_groups
    logic [GroupBits+msn_pkg::index_width(Channels+1)-1:0] first;  // of the group
    msn_constant_multiplier #(.Constant(Channels), .InBits(GroupBits))
      u_first (.in_data_i(sent_group), .out_data_o(first));
    assign place = PlaceBits'(first) + PlaceBits'(channel_q2);
  end else begin : gen_alone
    assign place = PlaceBits'(channel_q2);
    logic unused_group;
    assign unused_group = ^sent_group;
  end
  assign wanted      = beat_q && 32'(place) < Beats;  // not of columns beyond the array
  assign frame_first = sent_first && place == '0;

  logic             wanted_q, frame_first_q;
  logic [Width-1:0] beat_data_q2;
  always_ff @(posedge clk_i) begin
    wanted_q      <= wanted;
    frame_first_q <= frame_first;
    beat_data_q2  <= beat_data_q;
    if (rst_i) wanted_q <= 1'b0;
  end

  // Number and time of the frame being scanned, and of the one that leaves.
  logic        trigger_q;
  logic [31:0] frame_q;
  logic [47:0] time_q;
  logic        taken;
  if (Overlap == 0) begin : gen_apart
    assign turn        = trigger_o;
    assign begins      = trigger_q && done_first;
    assign begun       = now_i;
    assign sent_first  = done_first;
    assign sent_group  = done_group;
    assign sent_interleave = done_interleave;
  end else begin : gen_overlap
    logic [msn_pkg::index_width(Overlap + 1)-1:0] left_q;  // clocks to the turn
    logic                                         none_q;
    assign turn   = !none_q && left_q == '0;
    assign begins = turn && done_first;
    always_ff @(posedge clk_i) begin
      none_q <= !trigger_o && (none_q || left_q == '0);
      left_q <= trigger_o ? $bits(left_q)'(Overlap - 1) : left_q - 1'b1;
      if (trigger_q && done_first) begun <= now_i;
      if (turn) {sent_first, sent_group, sent_interleave} <= {done_first, done_group, done_interleave};
      if (rst_i) none_q <= 1'b1;
    end
  end
  always_ff @(posedge clk_i) begin
    trigger_q <= trigger_o;
    if (begins) {frame_q, time_q} <= {frame_q + 1'b1, begun};
    if (taken) {out_frame_o, out_time_o} <= {frame_q, time_q};
    if (rst_i) begin
      trigger_q <= 1'b0;
      frame_q   <= '1;
    end
  end

  msn_scan_buffer #(
    .Rows(Rows), .Beats(Beats), .Burst(Channels), .Width(Width), .Depth(Depth), .Ahead(Overlap == 0 ? 2 : 3)
  ) u_buffer (
    .clk_i, .rst_i,
    .in_valid_i(wanted_q), .in_first_i(frame_first_q), .in_interleave_i(sent_interleave),
    .in_data_i(beat_data_q2),
    .room_o(room),
    .out_valid_o, .out_ready_i, .out_data_o({out_user_o, out_data_o}), .out_id_o, .out_last_o,
    .taken_o(taken), .dropped_o(dropped)
  );

endmodule
