// SPDX-License-Identifier: Apache-2.0
//
// The places of a frame, one after the other: the rows and groups of a region, cut to the array, row by row or with
// cfg_interleave_i the rows 0, 2, 4 .. and then 1, 3, 5 .. of it.
//
// row_o, group_o: the place to convert next; without a frame, the next one's first. step_i takes it, and the one after it is
// there three clocks later. begin_i with no frame active: the region and order of two clocks before are this frame's;
// it may come without step_i, then nothing has begun. After the last place active_o falls.
// Model: model/meissner/twins/frontend/scan_walk.py

module msn_scan_walk #(
  parameter  int unsigned Rows       = 16,
  parameter  int unsigned Columns    = 16,
  parameter  int unsigned Lanes      = 1,    // columns in a beat
  parameter  int unsigned Channels   = 8,    // beats in a group
  localparam int unsigned RowBits    = msn_pkg::index_width(Rows),
  localparam int unsigned ColumnBits = msn_pkg::index_width(Columns),
  localparam int unsigned Beats      = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned BeatBits   = msn_pkg::index_width(Beats),
  localparam int unsigned Groups     = (Beats + Channels - 1) / Channels,
  parameter  int unsigned GroupBits  = msn_pkg::index_width(Groups)
) (
  input  logic                  clk_i,
  input  logic                  rst_i,

  input  logic                  cfg_interleave_i,
  input  logic [RowBits-1:0]    cfg_first_row_i,
  input  logic [RowBits-1:0]    cfg_last_row_i,
  input  logic [ColumnBits-1:0] cfg_first_column_i,
  input  logic [ColumnBits-1:0] cfg_last_column_i,

  input  logic                  begin_i,
  input  logic                  step_i,
  output logic                  active_o,      // the frame has conversions left
  output logic [RowBits-1:0]    row_o,
  output logic [GroupBits-1:0]  group_o,

  output logic [RowBits-1:0]    first_row_o,   // the region of the frame
  output logic [RowBits-1:0]    last_row_o,
  output logic [BeatBits-1:0]   first_beat_o,
  output logic [BeatBits-1:0]   last_beat_o,
  output logic                  interleave_o
);

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_scan_walk: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_scan_walk: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_scan_walk: Lanes = %0d must be 1, 2, 4 or 8", Lanes);
  end
  if (Channels < 1 || Channels > 8 || (Groups > 1 && !msn_pkg::is_power(Channels))) begin : gen_check_channels
    $fatal(1, "msn_scan_walk: Channels = %0d must be 1 .. 8, of several groups 1, 2, 4 or 8", Channels);
  end

  localparam int unsigned LaneShift = $clog2(Lanes);
  localparam int unsigned ChanShift = $clog2(Channels);

  // The region, cut to the array, in beats and groups.
  logic [RowBits-1:0]    last_row, region_first_row_q, region_last_row_q;
  logic [ColumnBits-1:0] last_column, first_column;
  logic [BeatBits-1:0]   region_first_beat_q, region_last_beat_q;
  logic                  region_interleave_q;
  assign last_row     = (32'(cfg_last_row_i) < Rows) ? cfg_last_row_i : RowBits'(Rows - 1);
  assign last_column  = (32'(cfg_last_column_i) < Columns) ? cfg_last_column_i : ColumnBits'(Columns - 1);
  assign first_column = (cfg_first_column_i < last_column) ? cfg_first_column_i : last_column;
  always_ff @(posedge clk_i) begin
    region_first_row_q  <= (cfg_first_row_i < last_row) ? cfg_first_row_i : last_row;
    region_last_row_q   <= last_row;
    region_first_beat_q <= BeatBits'(first_column >> LaneShift);
    region_last_beat_q  <= BeatBits'(last_column >> LaneShift);
    region_interleave_q <= cfg_interleave_i;
  end

  // A frame's region is that of its first switch, whose place is in its registers a clock ahead.
  logic [RowBits-1:0]    next_first_row_q, next_last_row_q;
  logic [BeatBits-1:0]   next_first_beat_q, next_last_beat_q;
  logic                  next_interleave_q;
  always_ff @(posedge clk_i) begin
    next_first_row_q  <= region_first_row_q;
    next_last_row_q   <= region_last_row_q;
    next_first_beat_q <= region_first_beat_q;
    next_last_beat_q  <= region_last_beat_q;
    next_interleave_q <= region_interleave_q;
    if (begin_i && !active_o) begin
      first_row_o  <= next_first_row_q;
      last_row_o   <= next_last_row_q;
      first_beat_o <= next_first_beat_q;
      last_beat_o  <= next_last_beat_q;
      interleave_o <= next_interleave_q;
    end
  end

  // The place after the one taken is found in the two clocks that follow.
  logic [RowBits:0]     row_next_q;
  logic [GroupBits-1:0] first_group, last_group;
  logic                 odd_q;  // the second half of an interleaved frame
  logic                 find_q, found_q, row_ends_q;
  assign first_group = (Groups > 1) ? GroupBits'(first_beat_o >> ChanShift) : '0;
  assign last_group  = (Groups > 1) ? GroupBits'(last_beat_o >> ChanShift) : '0;
  always_ff @(posedge clk_i) begin
    find_q     <= step_i;
    found_q    <= find_q;
    row_next_q <= {1'b0, row_o} + (interleave_o ? (RowBits+1)'(2) : (RowBits+1)'(1));
    row_ends_q <= group_o == last_group;
    if (!active_o && !begin_i) begin  // the first place
      row_o   <= region_first_row_q;
      group_o <= (Groups > 1) ? GroupBits'(region_first_beat_q >> ChanShift) : '0;
      odd_q   <= 1'b0;
    end
    if (step_i) active_o <= 1'b1;
    if (found_q) begin
      group_o <= row_ends_q ? first_group : group_o + 1'b1;
      if (row_ends_q) begin
        if (row_next_q <= {1'b0, last_row_o}) begin
          row_o <= row_next_q[RowBits-1:0];
        end else if (interleave_o && !odd_q && first_row_o != last_row_o) begin
          row_o <= first_row_o + 1'b1;
          odd_q <= 1'b1;
        end else begin
          active_o <= 1'b0;
        end
      end
    end
    if (rst_i) begin
      find_q   <= 1'b0;
      found_q  <= 1'b0;
      active_o <= 1'b0;
    end
  end

endmodule
