// SPDX-License-Identifier: Apache-2.0
//
// Nodes of one engine in block RAM, behind the engine's memory port.
//
//   rsp = the word at {bank, address} of the request, with its tag, in the order of the requests
//
// Of a word's 64 bits (docs/forest.md) only those are stored that differ: kind, index of a feature, threshold of
// FeatureBits, and the low half. The engine never reads the bank that a load writes.
//
// Latency 2 clocks, a word a clock, always ready.   Model: model/meissner/twins/forest/forest.py
// Error: none.

module msn_forest_memory #(
  parameter  int unsigned Features    = 9,
  parameter  int unsigned FeatureBits = 22,
  parameter  int unsigned Nodes       = 1024,  // words of a bank
  parameter  int unsigned Banks       = 2,
  parameter  int unsigned Walkers     = 16,
  localparam int unsigned AddressBits = msn_pkg::index_width(Nodes),
  localparam int unsigned TagBits     = msn_pkg::index_width(Walkers)
) (
  input  logic                   clk_i,
  input  logic                   rst_i,

  input  logic                   req_valid_i,
  output logic                   req_ready_o,
  input  logic                   req_bank_i,
  input  logic [AddressBits-1:0] req_address_i,
  input  logic [TagBits-1:0]     req_tag_i,

  output logic                   rsp_valid_o,
  output logic [TagBits-1:0]     rsp_tag_o,
  output logic [63:0]            rsp_data_o,

  input  logic                   write_i,
  input  logic                   write_bank_i,
  input  logic [AddressBits-1:0] write_address_i,
  input  logic [63:0]            write_data_i
);

  if (Features < 1 || Features > 256) begin : gen_check_features
    $fatal(1, "msn_forest_memory: Features = %0d must lie in 1 .. 256", Features);
  end
  if (FeatureBits < 2 || FeatureBits > 22) begin : gen_check_feature_bits
    $fatal(1, "msn_forest_memory: FeatureBits = %0d must lie in 2 .. 22", FeatureBits);
  end
  if (Nodes < 1) begin : gen_check_nodes
    $fatal(1, "msn_forest_memory: Nodes = %0d must be at least 1", Nodes);
  end
  if (Banks != 1 && Banks != 2) begin : gen_check_banks
    $fatal(1, "msn_forest_memory: Banks = %0d must be 1 or 2", Banks);
  end
  if (Walkers < 1) begin : gen_check_walkers
    $fatal(1, "msn_forest_memory: Walkers = %0d must be at least 1", Walkers);
  end

  localparam int unsigned IndexBits = msn_pkg::index_width(Features);
  localparam int unsigned PlaceBits = msn_pkg::index_width(Nodes * Banks);
  localparam int unsigned WordBits  = 2 + IndexBits + FeatureBits + 32;

  logic [PlaceBits-1:0]   read_place, write_place;
  logic [WordBits-1:0]    stored, found;
  logic [1:0]             kind;
  logic [IndexBits-1:0]   index;
  logic [FeatureBits-1:0] threshold;
  assign read_place  = PlaceBits'(req_address_i) + ((Banks == 2 && req_bank_i) ? PlaceBits'(Nodes) : '0);
  assign write_place = PlaceBits'(write_address_i) + ((Banks == 2 && write_bank_i) ? PlaceBits'(Nodes) : '0);
  assign stored      = {write_data_i[63:62], write_data_i[54+:IndexBits], write_data_i[32+:FeatureBits],
                        write_data_i[31:0]};
  assign {kind, index, threshold} = found[WordBits-1:32];
  assign rsp_data_o  = {kind, 8'(index), 22'(signed'(threshold)), found[31:0]};
  logic unused_data;
  assign unused_data = ^write_data_i;

  msn_ram #(.Words(Nodes * Banks), .Width(WordBits)) u_nodes (
    .clk_i,
    .write_i, .write_address_i(write_place), .write_data_i(stored),
    .read_i(1'b1), .read_address_i(read_place), .out_data_o(found)
  );

  logic               read;
  logic [TagBits-1:0] tag;
  assign req_ready_o = 1'b1;
  always_ff @(posedge clk_i) begin
    {rsp_valid_o, read}    <= {read, req_valid_i};
    {rsp_tag_o, tag}       <= {tag, req_tag_i};
    if (rst_i) {rsp_valid_o, read} <= '0;
  end

  // A word read in the clock in which it is written is undefined.
  msn_check u_read_is_not_written (
    .clk_i, .rst_i, .wrong_i(!rst_i && req_valid_i && write_i && read_place == write_place)
  );

endmodule
