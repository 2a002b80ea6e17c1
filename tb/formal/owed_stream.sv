// SPDX-License-Identifier: Apache-2.0
//
// What a lossless stage guarantees: each word taken leaves once, in order, unchanged, and no other word leaves; valid
// and data hold under back-pressure; a word inside is offered after at most Timeout clocks. It is proven for all words
// by watching any one: number `watch_i` modulo 2^CountBits. For a stage that computes, in_data_i is the expected
// result.
//
// inside_o, kept_o: the watched word is inside, and what it is; ahead_o: the words before it.

module owed_stream #(
  parameter  int unsigned Width     = 8,
  parameter  int unsigned Capacity  = 2,     // maximum of words inside
  parameter  int unsigned Timeout   = 3,
  parameter  bit          InHolds   = 1'b0,  // the source keeps what it offers: assumed
  localparam int unsigned CountBits = $clog2(Capacity + 1) + 1
) (
  input  logic                 clk_i,
  input  logic                 rst_i,

  input  logic [CountBits-1:0] watch_i,  // constant

  input  logic                 in_valid_i,
  input  logic                 in_ready_i,
  input  logic [Width-1:0]     in_data_i,

  input  logic                 out_valid_i,
  input  logic                 out_ready_i,
  input  logic [Width-1:0]     out_data_i,

  output logic                 started_o,
  output logic [CountBits-1:0] level_o,   // words inside
  output logic                 inside_o,
  output logic [CountBits-1:0] ahead_o,
  output logic [Width-1:0]     kept_o
);

  logic                 started = 1'b0;
  logic [CountBits-1:0] watch, taken, given;
  logic                 in_stalled, out_stalled, take, give;
  logic [Width-1:0]     in_data, out_data;
  logic [7:0]           waited;
  assign take      = in_valid_i && in_ready_i;
  assign give      = out_valid_i && out_ready_i;
  assign started_o = started;
  assign level_o   = taken - given;
  assign ahead_o   = watch_i - given;
  assign inside_o  = ahead_o < level_o;

  always_ff @(posedge clk_i) begin
    started     <= 1'b1;
    watch       <= watch_i;
    in_stalled  <= in_valid_i && !in_ready_i;
    out_stalled <= out_valid_i && !out_ready_i;
    in_data     <= in_data_i;
    out_data    <= out_data_i;
    waited      <= (level_o == '0 || out_valid_i) ? '0 : waited + 1'b1;
    if (take) taken <= taken + 1'b1;
    if (give) given <= given + 1'b1;
    if (take && taken == watch_i) kept_o <= in_data_i;
    if (rst_i) begin
      taken       <= '0;
      given       <= '0;
      in_stalled  <= 1'b0;
      out_stalled <= 1'b0;
      waited      <= '0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    else begin
      assume (watch_i == watch);
      if (InHolds && in_stalled) assume (in_valid_i && in_data_i == in_data);
    end
  end

  // A stage of latency 0 may give a word in the clock that takes it.
  always_comb begin
    if (started) begin
      assert (level_o <= CountBits'(Capacity));
      assert (waited <= 8'(Timeout));
      if (!rst_i && give) assert (level_o != '0 || take);
      if (!rst_i && give && ahead_o == '0) assert (out_data_i == (inside_o ? kept_o : in_data_i));
      if (!rst_i && out_stalled) assert (out_valid_i && out_data_i == out_data);
    end
  end

  // A deep stage is far from full after reset.
  localparam int unsigned Full = (Capacity <= 20) ? Capacity : 5;
  always_comb begin
    if (started && !rst_i) begin
      cover (give && ahead_o == '0 && watch_i == CountBits'(2));
      cover (level_o == CountBits'(Full));
      cover (out_stalled && give);
    end
  end

endmodule
