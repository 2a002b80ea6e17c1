// SPDX-License-Identifier: Apache-2.0

module formal_skid #(
  parameter int unsigned Width = 16
) (
  input logic             clk_i,
  input logic             rst_i,
  input logic [1:0]       watch_i,
  input logic             in_valid_i,
  input logic [Width-1:0] in_data_i,
  input logic             out_ready_i
);

  logic             in_ready_o, out_valid_o;
  logic [Width-1:0] out_data_o;
  msn_skid #(.Width(Width)) dut (.*);

  logic             started, held;
  logic [1:0]       level, ahead;
  logic [Width-1:0] kept;
  owed_stream #(.Width(Width), .Capacity(1), .Timeout(0), .InHolds(1'b1)) u_stream (
    .clk_i, .rst_i, .watch_i,
    .in_valid_i, .in_ready_i(in_ready_o), .in_data_i,
    .out_valid_i(out_valid_o), .out_ready_i, .out_data_i(out_data_o),
    .started_o(started), .level_o(level), .inside_o(held), .ahead_o(ahead), .kept_o(kept)
  );

  // Latency 0, and ready whenever no word is held.
  always_comb begin
    if (started && !rst_i) begin
      assert (in_ready_o == (level == '0));
      assert (out_valid_o == (in_valid_i || level != '0));
    end
  end

  // Invariant.
  always_comb begin
    if (started) assert (dut.held == (level == 2'd1));
    if (started && held) assert (dut.kept == kept);
  end

endmodule
