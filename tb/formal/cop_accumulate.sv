// SPDX-License-Identifier: Apache-2.0
//
// No sum wraps at the frame's full size, every force 65535: S counts exactly what the beats bring, in a register one
// bit wider, and so does a row's total; a frame's results appear only if `last` was where it belongs; they hold until
// they are taken. (That Mx and My are what the header says is shown by simulation against the twin, not here.)

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
  input logic                in_last_i,
  input logic                out_ready_i
);

  logic                     in_ready_o, out_valid_o;
  logic        [SumBits-1:0] out_sum_o;
  logic signed [MxBits-1:0]  out_mx_o;
  logic signed [MyBits-1:0]  out_my_o;
  logic        [31:0]        damaged_o;
  msn_cop_accumulate #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes)) dut (.*);

  localparam int unsigned Levels = $clog2(Lanes);
  localparam int unsigned Beats  = (Columns + Lanes - 1) / Lanes;
  localparam int unsigned Wide   = SumBits + 1;
  localparam logic [Wide-1:0] Most = Wide'(Lanes * 65535);  // of a beat

  // Where a beat stands in its frame, `place`, follows it through the tree of Levels registers.
  logic                started = 1'b0;
  logic                take, stalled, step;
  logic [20:0]         place, reached;                   // of the next beat; beats in S
  logic [Levels:0]     valid;
  logic [20:0]         places [Levels+1];
  logic [Wide-1:0]     totals [Levels+1];                // forces of the beat
  logic [Wide-1:0]     total, sum, next;
  logic                final_here;
  assign step = in_ready_o;
  assign take = in_valid_i && in_ready_o;
  owed_sum #(.Count(Lanes), .Width(Wide)) u_total (.data_i(in_data_i), .sum_o(total));
  assign valid[0]  = in_valid_i;
  assign places[0] = place;
  assign totals[0] = total;
  assign next      = (places[Levels] == '0 ? '0 : sum) + totals[Levels];
  assign final_here = place == 21'(Rows * Beats - 1);
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    stalled <= out_valid_o && !out_ready_i && !rst_i;
    if (take) place <= (in_last_i || final_here) ? '0 : place + 1'b1;
    if (step && valid[Levels]) begin
      sum     <= next;
      reached <= places[Levels] + 21'd1;
    end
    if (rst_i) place <= '0;
  end
  for (genvar l = 0; l < Levels; l++) begin : gen_level
    always_ff @(posedge clk_i) begin
      if (step) begin
        valid[l+1]  <= valid[l];
        places[l+1] <= places[l];
        totals[l+1] <= totals[l];
      end
      if (rst_i) valid[l+1] <= 1'b0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (in_valid_i && final_here) assume (in_last_i);  // a longer frame is dropped: its sums may wrap
    if (started) begin
      if (valid[Levels]) assert (!next[Wide-1]);          // no carry out of S
      if (stalled) assert (out_valid_o);
    end
  end

  // Invariant: beats follow each other, and n of them weigh n Most at the most.
  logic [20:0] expected [Levels+1];
  logic        known;  // S has a beat since reset
  always_ff @(posedge clk_i) begin
    if (step && valid[Levels]) known <= 1'b1;
    if (rst_i) known <= 1'b0;
  end
  assign expected[Levels] = known ? reached : '0;
  for (genvar l = 1; l <= Levels; l++) begin : gen_chain
    assign expected[l-1] = valid[l] ? places[l] + 21'd1 : expected[l];
    always_comb begin
      if (started && valid[l]) assert (places[l] == '0 || places[l] == expected[l]);
      if (started && valid[l]) assert (places[l] < 21'(Rows * Beats) && totals[l] <= Most);
      if (started && valid[l]) assert (dut.beat_first[l] == (places[l] == '0));
    end
    always_comb if (started) assert (dut.beat_valid[l] == valid[l]);
  end
  always_comb begin
    if (started) begin
      assert (place == '0 || place == expected[0]);
      assert (place < 21'(Rows * Beats) && place == 21'(dut.row) * 21'(Beats) + 21'(dut.beat));
      assert (32'(dut.beat) < Beats && 32'(dut.row) < Rows);
      assert (dut.first == (place == '0) && dut.row_first == (dut.beat == '0));
      if (known) assert (sum == Wide'(dut.sum) && reached != '0 && reached <= 21'(Rows * Beats));
      if (known) assert (sum <= Wide'(reached) * Most);
    end
  end

  // The tree: every node is the sum of its lanes, as many clocks ago.
  logic [Lanes*16-1:0] lanes [Levels+1];
  assign lanes[0] = in_data_i;
  for (genvar l = 0; l < Levels; l++) begin : gen_lanes
    always_ff @(posedge clk_i) if (step) lanes[l+1] <= lanes[l];
    for (genvar i = 0; i < Lanes >> (l + 1); i++) begin : gen_node
      logic [Wide-1:0] partial;
      owed_sum #(.Count(2 << l), .Width(Wide)) u_partial (
        .data_i(lanes[l+1][16*(2<<l)*i+:16*(2<<l)]), .sum_o(partial)
      );
      always_comb begin
        if (started && valid[l+1]) assert (Wide'(dut.total[(Lanes>>(l+1))+i]) == partial);
      end
      if (i == 0 && Lanes >> (l + 1) == 1) begin : gen_root
        always_comb if (started && valid[l+1]) assert (totals[l+1] == partial);
      end
    end
    if (l < Levels - 1) begin : gen_between
      logic [Wide-1:0] whole;
      owed_sum #(.Count(Lanes), .Width(Wide)) u_whole (.data_i(lanes[l+1]), .sum_o(whole));
      always_comb begin
        if (started && valid[l+1]) assert (totals[l+1] == whole);
      end
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (known && sum > Wide'(3) * Most - Wide'(1));
      cover (known && reached == 21'd3 && take && in_last_i);
      if (Rows * Beats < 16) cover (stalled && out_sum_o == '0);
    end
  end

endmodule
