// SPDX-License-Identifier: Apache-2.0
//
// Any word that enters with a step is at the output Depth steps later; between steps the contents hold.

module formal_delay #(
  parameter int unsigned Depth = 8,
  parameter int unsigned Width = 16
) (
  input logic             clk_i,
  input logic             rst_i,
  input logic             catch_i,  // watch the word of this step
  input logic             step_i,
  input logic [Width-1:0] in_data_i
);

  logic [Width-1:0] out_data_o;
  msn_delay #(.Depth(Depth), .Width(Width)) dut (.*);

  localparam int unsigned AgeBits = $clog2(Depth + 2);
  logic [AgeBits-1:0] age;
  logic [Width-1:0]   kept;
  if (Depth <= 4) begin : gen_line
    logic unused_slot;
    owed_delay #(.Depth(Depth), .Width(Width)) u_owed (
      .clk_i, .rst_i, .step_i, .catch_i, .in_data_i, .out_data_i(out_data_o),
      .line_i(dut.gen_registers.line), .slot_i('0), .newest_i('0), .oldest_i('0), .oldest_q_i('0),
      .word_i('0), .slot_o(unused_slot), .age_o(age), .kept_o(kept)
    );
  end else begin : gen_ring
    logic [$clog2(Depth-3)-1:0] slot;
    owed_delay #(.Depth(Depth), .Width(Width)) u_owed (
      .clk_i, .rst_i, .step_i, .catch_i, .in_data_i, .out_data_i(out_data_o),
      .line_i('0), .slot_i(dut.gen_ring.slot), .newest_i(dut.gen_ring.newest),
      .oldest_i(dut.gen_ring.u_ring.fetched), .oldest_q_i(dut.gen_ring.oldest),
      .word_i(dut.gen_ring.u_ring.memory[slot]), .slot_o(slot), .age_o(age), .kept_o(kept)
    );
    // Reading a place in the clock in which it is written is undefined: this never happens.
    logic ran = 1'b0;
    always_ff @(posedge clk_i) ran <= 1'b1;
    always_comb if (ran && step_i) assert (dut.gen_ring.slot != dut.gen_ring.slot_next);
  end

  logic             started = 1'b0;
  logic             stepped;
  logic [Width-1:0] out_data;
  always_ff @(posedge clk_i) begin
    started  <= 1'b1;
    stepped  <= step_i;
    out_data <= out_data_o;
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started && !stepped) assert (out_data_o == out_data);
  end

  // In a deep delay line the output is far from reset: it is only covered that a word begins its way.
  localparam int unsigned Seen = (Depth < 24) ? Depth : 5;
  always_comb if (started) cover (!rst_i && age == AgeBits'(Seen) && kept != '0);

endmodule
