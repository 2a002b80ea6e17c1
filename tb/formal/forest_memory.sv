// SPDX-License-Identifier: Apache-2.0
//
// The answer to a request comes two clocks after it, with its tag. Its word, of any place of either bank (`watch_i`,
// constant), is the one last written there before the request, in the bits that are stored.

module formal_forest_memory #(
  parameter  int unsigned Features    = 3,
  parameter  int unsigned FeatureBits = 5,
  parameter  int unsigned Nodes       = 5,
  parameter  int unsigned Banks       = 2,
  parameter  int unsigned Walkers     = 3,
  localparam int unsigned AddressBits = msn_pkg::index_width(Nodes),
  localparam int unsigned TagBits     = msn_pkg::index_width(Walkers)
) (
  input logic                   clk_i,
  input logic                   rst_i,
  input logic                   req_valid_i,
  input logic                   req_bank_i,
  input logic [AddressBits-1:0] req_address_i,
  input logic [TagBits-1:0]     req_tag_i,
  input logic                   write_i,
  input logic                   write_bank_i,
  input logic [AddressBits-1:0] write_address_i,
  input logic [63:0]            write_data_i,
  input logic                   watch_bank_i,
  input logic [AddressBits-1:0] watch_i
);

  logic               req_ready_o, rsp_valid_o;
  logic [TagBits-1:0] rsp_tag_o;
  logic [63:0]        rsp_data_o;
  msn_forest_memory #(
    .Features(Features), .FeatureBits(FeatureBits), .Nodes(Nodes), .Banks(Banks), .Walkers(Walkers)
  ) dut (.*);

  localparam int unsigned IndexBits = msn_pkg::index_width(Features);
  localparam int unsigned PlaceBits = msn_pkg::index_width(Nodes * Banks);
  localparam int unsigned WordBits  = 34 + IndexBits + FeatureBits;

  logic                   started = 1'b0;
  logic                   known, ours, due, asked, answered, watch_bank_q, to_ours, at_ours;
  logic [AddressBits-1:0] watch_q;
  logic [TagBits-1:0]     tag, tag_2;
  logic [63:0]            value, value_read, value_due;
  assign to_ours = write_i && write_address_i == watch_i && (Banks == 1 || write_bank_i == watch_bank_i);
  assign at_ours = req_address_i == watch_i && (Banks == 1 || req_bank_i == watch_bank_i);
  always_ff @(posedge clk_i) begin
    started      <= 1'b1;
    watch_q      <= watch_i;
    watch_bank_q <= watch_bank_i;
    asked        <= req_valid_i && !rst_i;
    answered     <= asked && !rst_i;
    tag          <= req_tag_i;
    tag_2        <= tag;
    ours         <= known && at_ours && !to_ours;
    value_read   <= value;
    due          <= ours;
    value_due    <= value_read;
    if (to_ours) begin
      known <= 1'b1;
      value <= write_data_i;
    end
    if (!started) {known, ours, due} <= '0;
  end

  // The bits of a word that are stored, by the layout of docs/forest.md.
  logic [WordBits-1:0]  kept, kept_read;
  logic [PlaceBits-1:0] place;
  assign kept      = {value[63:62], value[54+:IndexBits], value[32+:FeatureBits], value[31:0]};
  assign kept_read = {value_read[63:62], value_read[54+:IndexBits], value_read[32+:FeatureBits],
                      value_read[31:0]};
  assign place     = PlaceBits'(32'(watch_i) + ((Banks == 2 && watch_bank_i) ? Nodes : 0));

  always_comb begin
    if (!started) assume (rst_i);
    assume (32'(watch_i) < Nodes && 32'(write_address_i) < Nodes && 32'(req_address_i) < Nodes);
    // The engine reads no bank that a load writes.
    assume (!(req_valid_i && write_i && req_address_i == write_address_i
              && (Banks == 1 || req_bank_i == write_bank_i)));
    if (started) begin
      assume (watch_i == watch_q && watch_bank_i == watch_bank_q);
      assert (req_ready_o && rsp_valid_o == answered);
      if (answered) assert (rsp_tag_o == tag_2);
      if (due) begin
        assert (rsp_data_o[63:62] == value_due[63:62] && rsp_data_o[31:0] == value_due[31:0]);
        assert (rsp_data_o[61:54] == 8'(value_due[54+:IndexBits]));
        assert (signed'(rsp_data_o[53:32]) == 22'(signed'(value_due[32+:FeatureBits])));
      end
      // Invariant.
      assert (dut.read == asked);
      if (asked) assert (dut.tag == tag);
      if (known) assert (dut.u_nodes.memory[place] == kept);
      if (ours) assert (dut.u_nodes.fetched == kept_read);
    end
  end

  always_comb if (started) cover (answered && due && rsp_data_o[53] && rsp_data_o[63] && tag_2 != tag);

endmodule
