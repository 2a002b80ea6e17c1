// SPDX-License-Identifier: Apache-2.0

module formal_fifo #(
  parameter  int unsigned Depth     = 16,
  parameter  int unsigned Width     = 8,
  localparam int unsigned CountBits = $clog2(Depth + 3) + 1,
  localparam int unsigned PlaceBits = $clog2(Depth)
) (
  input logic                 clk_i,
  input logic                 rst_i,
  input logic [CountBits-1:0] watch_i,
  input logic                 in_valid_i,
  input logic [Width-1:0]     in_data_i,
  input logic                 out_ready_i
);

  logic             in_ready_o, out_valid_o, half_o;
  logic [Width-1:0] out_data_o;
  msn_fifo #(.Depth(Depth), .Width(Width)) dut (.*);

  logic                 started, held;
  logic [CountBits-1:0] level, ahead;
  logic [Width-1:0]     kept;
  owed_stream #(.Width(Width), .Capacity(Depth + 2), .Timeout(2)) u_stream (
    .clk_i, .rst_i, .watch_i,
    .in_valid_i, .in_ready_i(in_ready_o), .in_data_i,
    .out_valid_i(out_valid_o), .out_ready_i, .out_data_i(out_data_o),
    .started_o(started), .level_o(level), .inside_o(held), .ahead_o(ahead), .kept_o(kept)
  );

  // It takes at least Depth words, whatever the consumer does.
  always_comb if (started && !rst_i && level < CountBits'(Depth)) assert (in_ready_o);

  // Invariant: where the words are.
  logic [PlaceBits:0]   stored;
  logic [CountBits-1:0] behind;
  logic [PlaceBits-1:0] place;
  assign stored = dut.written - dut.read;
  assign behind = ahead - CountBits'(dut.out_valid_o) - CountBits'(dut.fetched_valid);
  assign place  = dut.read[PlaceBits-1:0] + behind[PlaceBits-1:0];
  always_comb begin
    if (started) begin
      assert (stored <= (PlaceBits + 1)'(Depth) && dut.full == (stored == (PlaceBits + 1)'(Depth)));
      assert (half_o == (stored >= (PlaceBits + 1)'(Depth / 2)));
      // Reading a place in the clock in which it is written is undefined.
      if (dut.put && dut.get) assert (dut.written[PlaceBits-1:0] != dut.read[PlaceBits-1:0]);
      assert (level == CountBits'(stored) + CountBits'(dut.fetched_valid) + CountBits'(dut.out_valid_o));
      if (held) begin
        if (dut.out_valid_o && ahead == '0) assert (dut.out_data_o == kept);
        else if (dut.fetched_valid && ahead == CountBits'(dut.out_valid_o)) assert (dut.fetched == kept);
        else assert (dut.memory[place] == kept);
      end
    end
  end

endmodule
