// SPDX-License-Identifier: Apache-2.0
//
// Sum of Count (a power of two) words of 16 bits, and their moment about the last, sum (Count-1-k) w. Added in pairs,
// in the order of the block, as solvers are slow to prove that another order gives the same.

module owed_sum #(
  parameter int unsigned Count = 8,
  parameter int unsigned Width = 32,
  parameter int unsigned Long  = 32
) (
  input  logic [Count*16-1:0] data_i,
  output logic [Width-1:0]    sum_o,
  output logic [Long-1:0]     moment_o
);

  logic [2*Count*Width-1:0] node;  // node n is the sum of nodes 2n and 2n+1; from Count on the words
  logic [2*Count*Long-1:0]  turn;  // its moment about its last word
  for (genvar n = 1; n < 2 * Count; n++) begin : gen_node
    if (n >= Count) begin : gen_word
      assign node[n*Width+:Width] = Width'(data_i[(n-Count)*16+:16]);
      assign turn[n*Long+:Long]   = '0;
    end else begin : gen_pair
      localparam int unsigned Half = $clog2(Count) - $clog2(n + 1);  // words of node 2n+1, as a power of two
      assign node[n*Width+:Width] = node[2*n*Width+:Width] + node[(2*n+1)*Width+:Width];
      assign turn[n*Long+:Long]   = turn[2*n*Long+:Long] + turn[(2*n+1)*Long+:Long] + (Long'(node[2*n*Width+:Width]) << Half);
    end
  end
  assign node[Width-1:0] = '0;
  assign turn[Long-1:0]  = '0;
  assign sum_o    = node[Width+:Width];
  assign moment_o = turn[Long+:Long];

endmodule
