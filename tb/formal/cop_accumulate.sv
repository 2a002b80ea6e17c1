// SPDX-License-Identifier: Apache-2.0
//
// For a frame with `last` in its place, and for no other, S, Mx = (2N - n - 1) S - 2 A and My = 2 B - (m-1) S leave two
// clocks after the tree, with A and B as sums of prefix sums (that these equal the header's sums is algebra); they hold
// until taken. No sum wraps around in a frame of full size with all forces 65535: S and a row's total equal the sums of
// the beats in registers one bit wider. Damaged frames are counted. Beats arrive as msn_frame_marker gives them: a
// damaged frame ends early with a beat that does not fit, or has beats that do not fit from its final place on.

module formal_cop_accumulate #(
  parameter  int unsigned Rows    = 64,
  parameter  int unsigned Columns = 64,
  parameter  int unsigned Lanes   = 1,
  localparam int unsigned SumBits = 16 + $clog2(Rows * Columns),
  localparam int unsigned MxBits  = SumBits + msn_pkg::index_width(Columns),
  localparam int unsigned MyBits  = SumBits + msn_pkg::index_width(Rows)
) (
  input logic                clk_i,
  input logic                rst_i,
  input logic                in_valid_i,
  input logic [Lanes*16-1:0] in_data_i,
  input logic                in_fits_i,
  input logic                in_row_last_i,
  input logic                in_last_i,
  input logic                out_ready_i
);

  logic                     in_ready_o, out_valid_o;
  logic        [SumBits-1:0] out_sum_o;
  logic signed [MxBits-1:0]  out_mx_o;
  logic signed [MyBits-1:0]  out_my_o;
  logic        [31:0]        damaged_o;
  msn_cop_accumulate #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes)) dut (.*);

  localparam int unsigned Levels  = $clog2(Lanes);
  localparam int unsigned Leaves  = 1 << Levels;
  localparam int unsigned Beats   = (Columns + Lanes - 1) / Lanes;
  localparam int unsigned Kept    = Columns - (Beats - 1) * Lanes;  // lanes of a row's last beat
  localparam int unsigned Wide    = SumBits + 1;
  localparam bit          OneBeat = Rows == 1 && Beats == 1;

  // A beat's position in its frame, `place`, and its forces follow it through the tree of Levels registers.
  logic                started = 1'b0;
  logic                take, stalled, step, final_here, row_ends;
  logic                drops;                            // the frame is too long: further beats are dropped
  logic [20:0]         place, column;                    // of the next beat, in its frame and row
  logic [20:0]         reached, along, above;            // beats in S, of them in the present row; rows above it
  logic [31:0]         damaged;
  logic                damage;
  logic [Levels:0]     valid, whole, gone;               // the frame is complete; dropped
  logic [20:0]         places  [Levels+1];
  logic [20:0]         columns [Levels+1];
  logic [Lanes*16-1:0] lanes   [Levels+1];
  assign step       = in_ready_o;
  assign take       = in_valid_i && in_ready_o;
  assign final_here = place == 21'(Rows * Beats - 1);
  assign row_ends   = column == 21'(Beats - 1);
  assign valid[0]   = in_valid_i;
  assign whole[0]   = in_last_i && final_here && !drops;
  assign gone[0]    = drops;
  assign places[0]  = place;
  assign columns[0] = column;
  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    assign lanes[0][16*k+:16] = (in_row_last_i && (Beats - 1) * Lanes + k >= Columns) ? '0 : in_data_i[16*k+:16];
  end
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    stalled <= out_valid_o && !out_ready_i && !rst_i;
    damage  <= take && in_last_i != final_here && !drops;
    damaged <= damaged + 32'(damage);
    if (take) begin
      place  <= (in_last_i || final_here) ? '0 : place + 1'b1;
      column <= (in_last_i || in_row_last_i) ? '0 : drops ? 21'd1 : column + 1'b1;
      drops  <= !in_last_i && (drops || final_here);
      if (drops) place <= '0;
    end
    if (rst_i) begin
      place   <= '0;
      column  <= '0;
      drops   <= 1'b0;
      damage  <= 1'b0;
      damaged <= '0;
    end
  end
  for (genvar l = 0; l < Levels; l++) begin : gen_level
    always_ff @(posedge clk_i) begin
      if (step) begin
        valid[l+1]  <= valid[l];
        whole[l+1]  <= whole[l];
        gone[l+1]   <= gone[l];
        places[l+1] <= places[l];
        columns[l+1] <= columns[l];
        lanes[l+1]  <= lanes[l];
      end
      if (rst_i) valid[l+1] <= 1'b0;
    end
  end

  // The sums, in wider registers, and the results.
  localparam int unsigned Long = MxBits + MyBits;
  logic [Wide-1:0] total, sum, carried;                  // of the beat, of the frame
  logic [Long-1:0] inner, row_sum, left, a, b, mx, my;
  logic            opens, known, due, valid_due;
  logic [Wide-1:0] sum_due;
  logic [Long-1:0] mx_due, my_due;
  assign opens   = places[Levels] == '0 && !gone[Levels];
  assign left    = (columns[Levels] == '0) ? '0 : row_sum;
  assign carried = opens ? '0 : sum;
  assign mx      = Long'(sum) * Long'(2 * Beats * Lanes - Columns - 1) - 2 * a;
  assign my      = 2 * b - Long'(sum) * Long'(Rows - 1);
  owed_sum #(.Count(Leaves), .Width(Wide), .Long(Long)) u_total (
    .data_i((Leaves*16)'(lanes[Levels]) << (16 * (Leaves - Lanes))), .sum_o(total), .moment_o(inner)
  );
  always_ff @(posedge clk_i) begin
    if (step && valid[Levels]) begin
      known   <= !gone[Levels];
      reached <= places[Levels] + 21'd1;
      along   <= columns[Levels] + 21'd1;
      above   <= opens ? '0 : above + 21'(columns[Levels] == '0);
      sum     <= carried + total;
      row_sum <= left + Long'(total);
      a       <= (opens ? '0 : a) + left * Long'(Lanes) + inner;
      b       <= (opens ? '0 : b) + (((columns[Levels] == '0) && !opens) ? Long'(sum) : '0);
    end
    if (step) due <= valid[Levels] && whole[Levels];
    else if (out_ready_i || !valid_due) due <= 1'b0;
    if (out_ready_i || !valid_due) begin
      valid_due <= due;
      sum_due   <= sum;
      mx_due    <= mx;
      my_due    <= my;
    end
    if (rst_i) begin
      known     <= 1'b0;
      due       <= 1'b0;
      valid_due <= 1'b0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    assume (in_fits_i == (in_last_i == final_here && !drops));
    if (!drops) assume (in_row_last_i == row_ends);
    if (started) begin
      if (valid[Levels] && !gone[Levels]) assert (carried + total < Wide'(1) << SumBits);  // no carry out of S
      if (stalled) assert (out_valid_o);
      assert (out_valid_o == valid_due);
      if (valid_due) begin
        assert (Wide'(out_sum_o) == sum_due);
        assert (out_mx_o == MxBits'(mx_due) && out_my_o == MyBits'(my_due));
      end
      assert (damaged_o == damaged);
      if (!rst_i) assert (in_ready_o == (!due || !valid_due || (OneBeat && out_ready_i)));
    end
  end

  // Invariant: beats follow each other, and the taxels of those in S, without surplus lanes, have a sum of at most 65535
  // each. With a surplus lane in each row, the beats of a whole frame could carry out of S.
  logic [20:0]     expected [Levels+1], follows [Levels+1], taxels;
  logic [Wide-1:0] most;
  assign taxels = above * 21'(Columns) + ((along == 21'(Beats)) ? 21'(Columns) : along * 21'(Lanes));
  assign most   = (Wide'(taxels) << 16) - Wide'(taxels);
  assign expected[Levels] = known ? reached : '0;
  assign follows[Levels]  = known ? along : '0;
  for (genvar l = 1; l <= Levels; l++) begin : gen_chain
    assign expected[l-1] = valid[l] ? (gone[l] ? '0 : places[l] + 21'd1) : expected[l];
    assign follows[l-1]  = valid[l] ? (gone[l] ? '0 : columns[l] + 21'd1) : follows[l];
    always_comb begin
      if (started && valid[l]) begin
        if (!gone[l]) assert (places[l] == '0 || places[l] == expected[l]);
        assert (places[l] < 21'(Rows * Beats) && (!gone[l] || places[l] == '0));
        assert (dut.beat_first[l] == (places[l] == '0 && !gone[l]) && dut.beat_row_first[l] == (columns[l] == '0));
        assert (dut.beat_whole[l] == whole[l] && (!whole[l] || !gone[l]));
        if (places[l] == '0 && !gone[l]) assert (columns[l] == '0);
        if (!gone[l]) assert (columns[l] < 21'(Beats) && (columns[l] == '0 || columns[l] == follows[l]));
        if (!gone[l] && places[l] != '0 && columns[l] == '0) assert (follows[l] == 21'(Beats));
        if (!gone[l] && columns[l] == 21'(Beats - 1)) assert (lanes[l] >> (16 * Kept) == '0);
      end
    end
    always_comb if (started) assert (dut.beat_valid[l] == valid[l]);
  end
  always_comb begin
    if (started) begin
      assert (dut.dropping == drops && dut.damage == damage && dut.done == due);
      if (drops) assert (place == '0 && !dut.first);
      else begin
        assert (place == '0 || place == expected[0]);
        assert (column == '0 || column == follows[0]);
        if (place == '0) assert (column == '0);
        else if (column == '0) assert (follows[0] == 21'(Beats));
        assert (place < 21'(Rows * Beats) && 32'(column) < Beats && dut.first == (place == '0));
      end
      assert (dut.row_first == (column == '0));
      if (due) assert (known);
      if (known) begin
        assert (reached != '0 && reached <= 21'(Rows * Beats) && sum <= most && sum == Wide'(dut.sum));
        assert (MxBits'(a) << 1 == {dut.moment_a, 1'b0} && MyBits'(b) << 1 == {dut.moment_b, 1'b0});
        assert (along != '0 && along <= 21'(Beats) && above < 21'(Rows) && reached == above * 21'(Beats) + along);
        assert (row_sum * Long'(dut.Odd) == Long'(dut.row_total) && row_sum <= ((Long'(along) * Long'(Lanes)) << 16) - Long'(along) * Long'(Lanes));
      end
    end
  end

  // The tree: every node has the sum and the moment of its lanes, delayed by its level; lanes that fill it up are 0.
  always_comb if (started && valid[Levels]) assert (Long'(dut.odd_total) == Long'(dut.Odd) * Long'(total));
  for (genvar l = 0; l < Levels; l++) begin : gen_lanes
    logic [Leaves*16-1:0] filled;
    assign filled = (Leaves*16)'(lanes[l+1]) << (16 * (Leaves - Lanes));
    for (genvar i = 0; i < Leaves >> (l + 1); i++) begin : gen_node
      logic [Wide-1:0] part;
      logic [Long-1:0] moment;
      owed_sum #(.Count(2 << l), .Width(Wide), .Long(Long)) u_part (
        .data_i(filled[16*(2<<l)*i+:16*(2<<l)]), .sum_o(part), .moment_o(moment)
      );
      always_comb begin
        if (started && valid[l+1]) begin
          assert (Wide'(dut.total[(Leaves>>(l+1))+i]) == part);
          assert (Long'(dut.inner[(Leaves>>(l+1))+i]) == moment);
        end
      end
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (known && reached == 21'd3 && sum == most);
      cover (known && reached == 21'd3 && take && in_last_i);
      if (Rows * Beats < 16) cover (stalled && out_sum_o == '0);
    end
  end

endmodule
