// SPDX-License-Identifier: Apache-2.0
//
// Of two classes: the votes that are read, of either class and any decision (`watch_i`, constant), are the sum of its
// leaves since the decision was freed, a leaf two clocks after it came in; counted_o says so. Leaves that are flushed
// or have no vote add nothing.

module formal_forest_votes #(
  parameter  int unsigned Contexts    = 4,
  localparam int unsigned ContextBits = $clog2(Contexts)
) (
  input logic                   clk_i,
  input logic                   rst_i,
  input logic                   flush_i,
  input logic                   in_valid_i,
  input logic [15:0]            in_leaf_i,
  input logic                   in_none_i,
  input logic [ContextBits-1:0] in_context_i,
  input logic [Contexts-1:0]    free_i,
  input logic [ContextBits-1:0] read_context_i,
  input logic                   read_i,
  input logic                   read_second_i,
  input logic [31:0]            read_sum_i,
  input logic [ContextBits-1:0] watch_i,
  input logic                   watch_second_i
);

  logic                in_ready_o;
  logic [Contexts-1:0] counted_o;
  logic [31:0]         read_votes_o;
  msn_forest_votes #(.Classes(2), .Contexts(Contexts)) dut (
    .*, .in_bank_i(1'b0), .write_i(1'b0), .write_bank_i(1'b0), .write_row_i('0), .write_class_i('0),
    .write_data_i('0), .read_class_i(16'(read_second_i))
  );

  logic                   started = 1'b0;
  logic                   coming, none, begun, counted, read_ours, watch_second_q;
  logic [ContextBits-1:0] context_of, watch_q;
  logic [15:0]            leaf, votes;
  logic [31:0]            total, expected;
  assign votes = none ? 16'd0 : watch_second_i ? leaf : 16'd65535 - leaf;
  always_ff @(posedge clk_i) begin
    started        <= 1'b1;
    watch_q        <= watch_i;
    watch_second_q <= watch_second_i;
    coming         <= in_valid_i && !flush_i && !rst_i;
    leaf           <= in_leaf_i;
    none           <= in_none_i;
    context_of     <= in_context_i;
    counted        <= coming && context_of == watch_i && !flush_i;
    if (coming && context_of == watch_i) begin
      total <= (begun ? total : 32'd0) + 32'(votes);
      begun <= 1'b1;
    end
    if (free_i[watch_i]) begun <= 1'b0;
    read_ours <= started && read_i && read_context_i == watch_i && read_second_i == watch_second_i;
    expected  <= read_sum_i + (begun ? total : 32'd0);
    if (rst_i) {begun, counted} <= '0;
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assume (watch_i == watch_q && watch_second_i == watch_second_q);
      assert (in_ready_o && counted_o[watch_i] == counted);
      if (read_ours) assert (read_votes_o == expected);
      // Invariant.
      assert (dut.valid == coming && dut.begun[watch_i] == begun && dut.group == '0);
      if (coming) begin
        assert (dut.none == none && dut.of_context == context_of && dut.of_group == '0 && dut.final_group);
        assert (dut.votes == {leaf, ~leaf});
      end
    end
  end
  for (genvar k = 0; k < 2; k++) begin : gen_class
    always_comb begin
      if (started && begun && watch_second_i == 1'(k)) assert (dut.gen_sum[k].sums[watch_i] == total);
    end
  end

  always_comb begin
    if (started) begin
      cover (read_ours && !watch_second_i && expected == 32'd131069 && counted);
      cover (read_ours && watch_second_i && total > 32'd65535 && free_i[watch_i]);
    end
  end

endmodule
