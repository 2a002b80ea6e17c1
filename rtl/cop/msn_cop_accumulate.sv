// SPDX-License-Identifier: Apache-2.0
//
// Load and first moments of a frame of forces F[i][j], m Rows by n Columns, exact and without multipliers.
//
//   S = sum F     Mx = sum (2j - (n-1)) F     My = sum ((m-1) - 2i) F
//
// Row-major, Lanes columns a beat, N = n rounded up to full beats; the extra lanes of a row's last beat
// are ignored. With A = sum (N-1-j) F and B = sum (m-1-i) F, which are sums of prefix sums:
//   Mx = (2N - n - 1) S - 2 A     My = 2 B - (m-1) S
//
//   clock  1 .. log2(Lanes)    next          next
//          beat total, moment  S, A, B, row  Mx, My
//
// Latency 2 + log2(Lanes) clocks, log2 rounded up; a beat a clock, frames without a gap. Beats as msn_frame_marker
// gives them; a frame with a beat that does not fit gives no result.   Model: model/meissner/twins/cop/cop.py
// Error: none.

module msn_cop_accumulate #(
  parameter  int unsigned Rows    = 64,
  parameter  int unsigned Columns = 64,
  parameter  int unsigned Lanes   = 1,
  localparam int unsigned SumBits = 16 + $clog2(Rows * Columns),
  localparam int unsigned MxBits  = SumBits + msn_pkg::index_width(Columns),
  localparam int unsigned MyBits  = SumBits + msn_pkg::index_width(Rows)
) (
  input  logic                       clk_i,
  input  logic                       rst_i,

  input  logic                       in_valid_i,
  output logic                       in_ready_o,
  input  logic        [Lanes*16-1:0] in_data_i,  // the leftmost column in the low bits
  input  logic                       in_fits_i,
  input  logic                       in_row_last_i,
  input  logic                       in_last_i,

  output logic                       out_valid_o,
  input  logic                       out_ready_i,
  output logic        [SumBits-1:0]  out_sum_o,
  output logic signed [MxBits-1:0]   out_mx_o,
  output logic signed [MyBits-1:0]   out_my_o,

  output logic        [31:0]         damaged_o   // frames, since reset
);

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_cop_accumulate: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_cop_accumulate: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes) && Lanes != 16) begin : gen_check_lanes
    $fatal(1, "msn_cop_accumulate: Lanes = %0d must lie in 1 .. 8, or be 16", Lanes);
  end

  localparam int unsigned Levels    = $clog2(Lanes);
  localparam int unsigned Leaves    = 1 << Levels;
  localparam int unsigned Shift     = $clog2(Lanes & (~Lanes + 1));  // Lanes = Odd 2^Shift
  localparam int unsigned Odd       = Lanes >> Shift;
  localparam int unsigned Beats     = (Columns + Lanes - 1) / Lanes;
  localparam int unsigned TotalBits = 16 + Levels;
  localparam int unsigned InnerBits = 16 + 2 * Levels;

  // The pipeline stalls only while a finished frame waits for the result before it to be taken, and still in
  // the clock in which that is taken: so out_ready_i has no path to registers upstream of the results, which
  // makes the clock 10 % faster. Frames of one beat cannot afford that stall.
  localparam bit OneBeat = Rows == 1 && Columns <= Lanes;
  logic done, free, step;
  assign free       = out_ready_i || !out_valid_o;
  assign step       = !done || !out_valid_o || (OneBeat && out_ready_i);
  assign in_ready_o = step;

  logic dropping, damage, row_first, first, whole;
  assign whole = in_last_i && in_fits_i && !dropping;

  always_ff @(posedge clk_i) begin
    if (in_valid_i && in_ready_o) begin
      row_first <= in_last_i || in_row_last_i;
      first     <= in_last_i;
      dropping  <= !in_last_i && (dropping || !in_fits_i);
    end
    damage <= in_valid_i && in_ready_o && !in_fits_i && !dropping;
    if (damage) damaged_o <= damaged_o + 1'b1;  // a clock later: 32 clock enables are slow
    if (rst_i) begin
      row_first <= 1'b1;
      first     <= 1'b1;
      dropping  <= 1'b0;
      damage    <= 1'b0;
      damaged_o <= '0;
    end
  end

  // A beat's total, and its moment about the last lane, sum (Lanes-1-k) F, in a tree of registers: node 1
  // is the root, nodes 2i and 2i+1 are the halves of node i. Of its Leaves the last Lanes are the lanes, those left of
  // them 0: they add nothing to a moment about the last one.
  logic [2*Leaves-1:1][TotalBits-1:0] total;
  logic [2*Leaves-1:1][InnerBits-1:0] inner;
  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    logic surplus;
    assign surplus                   = in_row_last_i && (Beats - 1) * Lanes + k >= Columns;
    assign total[2*Leaves-Lanes+k] = surplus ? '0 : TotalBits'(in_data_i[16*k+:16]);
  end
  assign inner[2*Leaves-1:Leaves] = '0;
  if (Leaves > Lanes) begin : gen_fill
    assign total[2*Leaves-Lanes-1:Leaves] = '0;
  end
  for (genvar i = 1; i < Leaves; i++) begin : gen_node
    localparam int unsigned Half = Levels - $clog2(i + 1);  // log2 of node 2i+1's lanes, right of 2i's
    always_ff @(posedge clk_i) begin
      if (step) begin
        total[i] <= total[2*i] + total[2*i+1];
        inner[i] <= inner[2*i] + inner[2*i+1] + (InnerBits'(total[2*i]) << Half);
      end
    end
  end

  // The beat's marks, delayed as its sums are.
  logic [Levels:0] beat_valid, beat_row_first, beat_first, beat_whole;
  assign beat_valid[0]     = in_valid_i;
  assign beat_row_first[0] = row_first;
  assign beat_first[0]     = first;
  assign beat_whole[0]     = whole;
  for (genvar l = 0; l < Levels; l++) begin : gen_marks
    always_ff @(posedge clk_i) begin
      if (step) begin
        beat_valid[l+1]     <= beat_valid[l];
        beat_row_first[l+1] <= beat_row_first[l];
        beat_first[l+1]     <= beat_first[l];
        beat_whole[l+1]     <= beat_whole[l];
      end
      if (rst_i) beat_valid[l+1] <= 1'b0;
    end
  end

  // Odd times the total, in the root's clock: so the sum left of a beat needs only a shift to count Lanes times.
  localparam int unsigned OddBits = TotalBits + ((Odd > 1) ? $clog2(Odd + 1) : 0);
  logic [OddBits-1:0] odd_total;
  if (Odd > 1) begin : gen_odd
    logic [TotalBits-1:0] halves;
    logic [OddBits-1:0]   product;
    assign halves = total[2] + total[3];
    msn_constant_multiplier #(.Constant(Odd), .InBits(TotalBits))
      u_odd (.in_data_i(halves), .out_data_o(product));
    always_ff @(posedge clk_i) if (step) odd_total <= product;
  end else begin : gen_even
    assign odd_total = total[1];
  end

  // Sums of prefix sums: each beat adds the row's sum left of it Lanes times, each row the sum above it. All
  // arithmetic is modulo 2^width, so intermediate values may wrap around: only Mx and My must fit, and they
  // do.
  localparam int unsigned PrefixBits = 16 + $clog2(Beats * Lanes * Odd);
  logic [PrefixBits-1:0] row_total, left;  // Odd times the sums
  logic [SumBits-1:0]    sum, above;
  logic [MxBits-2:0]     moment_a;
  logic [MyBits-2:0]     moment_b;
  assign left  = beat_row_first[Levels] ? '0 : row_total;
  assign above = beat_first[Levels] || !beat_row_first[Levels] ? '0 : sum;

  always_ff @(posedge clk_i) begin
    if (step) begin
      if (beat_valid[Levels]) begin
        row_total <= left + PrefixBits'(odd_total);
        sum       <= (beat_first[Levels] ? '0 : sum) + SumBits'(total[1]);
        moment_a  <= (beat_first[Levels] ? '0 : moment_a) + ((MxBits-1)'(left) << Shift)
                     + (MxBits-1)'(inner[1]);
        moment_b  <= (beat_first[Levels] ? '0 : moment_b) + (MyBits-1)'(above);
      end
    end
    if (step) done <= beat_valid[Levels] && beat_whole[Levels];
    else if (free) done <= 1'b0;
    if (rst_i) done <= 1'b0;
  end

  localparam int unsigned ScaleX = 2 * Beats * Lanes - Columns - 1;
  localparam int unsigned ScaleY = Rows - 1;
  logic [SumBits+msn_pkg::index_width(ScaleX+1)-1:0] sum_x;
  logic [SumBits+msn_pkg::index_width(ScaleY+1)-1:0] sum_y;
  msn_constant_multiplier #(.Constant(ScaleX), .InBits(SumBits))
    u_scale_x (.in_data_i(sum), .out_data_o(sum_x));
  msn_constant_multiplier #(.Constant(ScaleY), .InBits(SumBits))
    u_scale_y (.in_data_i(sum), .out_data_o(sum_y));
  logic unused_scaled;  // above the results' bits
  assign unused_scaled = ^{sum_x, sum_y};

  always_ff @(posedge clk_i) begin
    if (free) begin
      out_valid_o <= done;
      out_sum_o   <= sum;
      out_mx_o    <= signed'(MxBits'(sum_x) - {moment_a, 1'b0});
      out_my_o    <= signed'({moment_b, 1'b0} - MyBits'(sum_y));
    end
    if (rst_i) out_valid_o <= 1'b0;
  end

endmodule
