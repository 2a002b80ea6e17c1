// SPDX-License-Identifier: Apache-2.0
//
// Sums of the leaves' votes of one engine, for several decisions under way.
//
//   V_c = sum of p_c over the leaves that came in        two classes: leaf = p_1, p_0 = 65535 - p_1
//                                                        else leaf = row of the table of p_c, in two banks
//
// Lanes classes a clock, so a leaf takes Groups = ceil(Classes / Lanes) clocks. A leaf with `none` adds nothing.
// counted_o: a leaf of this decision is in the sums. free_i: the next leaf of this decision is the first one again.
//
// Latency 4 clocks (two classes 2), of read_votes_o 1 clock.   Model: model/meissner/twins/forest/forest.py
// Error: none.

module msn_forest_votes #(
  parameter int unsigned Classes   = 2,
  parameter int unsigned Leaves    = 256,  // rows of the table, unless there are two classes
  parameter int unsigned Banks     = 2,
  parameter int unsigned Lanes     = 4,    // a power of two
  parameter int unsigned Contexts  = 4,    // decisions under way, a power of two
  localparam int unsigned ContextBits = $clog2(Contexts)
) (
  input  logic        clk_i,
  input  logic        rst_i,

  input  logic        flush_i,       // discards leaves that are not in the sums yet

  input  logic        in_valid_i,
  output logic        in_ready_o,
  input  logic [15:0] in_leaf_i,
  input  logic        in_none_i,
  input  logic [ContextBits-1:0] in_context_i,  // which decision
  input  logic        in_bank_i,

  output logic [Contexts-1:0] counted_o,
  input  logic [Contexts-1:0] free_i,

  input  logic [ContextBits-1:0] read_context_i,
  input  logic        read_i,        // read_votes_o = read_sum_i + V_c
  input  logic [15:0] read_class_i,
  input  logic [31:0] read_sum_i,
  output logic [31:0] read_votes_o,

  input  logic        write_i,
  input  logic        write_bank_i,
  input  logic [15:0] write_row_i,
  input  logic [15:0] write_class_i,
  input  logic [15:0] write_data_i
);

  if (Classes < 1 || Classes > 65536) begin : gen_check_classes
    $fatal(1, "msn_forest_votes: Classes = %0d must lie in 1 .. 65536", Classes);
  end
  if (Leaves < 1 || Leaves > 65536) begin : gen_check_leaves
    $fatal(1, "msn_forest_votes: Leaves = %0d must lie in 1 .. 65536", Leaves);
  end
  if (Banks != 1 && Banks != 2) begin : gen_check_banks
    $fatal(1, "msn_forest_votes: Banks = %0d must be 1 or 2", Banks);
  end
  if (Lanes < 1 || Lanes > 64 || !msn_pkg::is_power(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_forest_votes: Lanes = %0d must be a power of two, 1 .. 64", Lanes);
  end

  if (Contexts < 2 || Contexts > 16 || !msn_pkg::is_power(Contexts)) begin : gen_check_contexts
    $fatal(1, "msn_forest_votes: Contexts = %0d must be a power of two, 2 .. 16", Contexts);
  end

  localparam int unsigned Used      = (Classes < Lanes) ? Classes : Lanes;
  localparam int unsigned Groups    = (Classes + Lanes - 1) / Lanes;
  localparam int unsigned GroupBits = msn_pkg::index_width(Groups);
  localparam int unsigned LaneBits  = $clog2(Lanes);
  localparam int unsigned SumBits   = msn_pkg::index_width(Contexts * Groups);
  localparam int unsigned Stages    = (Classes == 2) ? 1 : 3;  // until the votes of a group are there

  logic [GroupBits-1:0] group;
  logic        group_last;
  assign group_last = group == GroupBits'(Groups - 1);
  assign in_ready_o = group_last;

  // The votes of one group of classes.
  logic [Used*16-1:0] votes;
  if (Classes == 2) begin : gen_two
    always_ff @(posedge clk_i) votes <= (Used*16)'({in_leaf_i, ~in_leaf_i} >> (16 * Lanes * 32'(group)));
    logic unused_table;
    assign unused_table = ^{in_bank_i, write_i, write_bank_i, write_row_i, write_class_i, write_data_i};

  end else begin : gen_table
    localparam int unsigned Words     = Leaves * Groups;
    localparam int unsigned PlaceBits = msn_pkg::index_width(Words * Banks);
    logic [PlaceBits-1:0] place, write_place;
    logic        there;
    assign there       = 32'(write_row_i) < Leaves && 32'(write_class_i) < Classes;
    assign write_place = PlaceBits'(32'(write_row_i) * Groups + 32'(write_class_i >> LaneBits))
                         + ((Banks == 2 && write_bank_i) ? PlaceBits'(Words) : '0);
    always_ff @(posedge clk_i) begin
      place <= PlaceBits'(32'(in_leaf_i) * Groups + 32'(group))
               + ((Banks == 2 && in_bank_i) ? PlaceBits'(Words) : '0);
    end
    for (genvar k = 0; k < Used; k++) begin : gen_lane
      msn_ram #(.Words(Words * Banks), .Width(16)) u_leaves (
        .clk_i,
        .write_i(write_i && there && 32'(write_class_i) % Lanes == k), .write_address_i(write_place),
        .write_data_i,
        .read_i(1'b1), .read_address_i(place), .out_data_o(votes[16*k+:16])
      );
    end
    logic read, unused_read;
    always_ff @(posedge clk_i) read <= in_valid_i;
    assign unused_read = ^{read, write_row_i, write_class_i};
    msn_check u_read_is_not_written (
      .clk_i, .rst_i, .wrong_i(!rst_i && read && write_i && there && place == write_place)
    );
  end

  // What goes with them.
  localparam int unsigned MarkBits = 2 + ContextBits + GroupBits;
  logic [Stages-1:0]          valid;
  logic [Stages*MarkBits-1:0] marks;
  logic [GroupBits-1:0]       of_group;
  logic              none, final_group, sum_valid;
  logic [ContextBits-1:0]     of_context;
  assign sum_valid                               = valid[Stages-1];
  assign {of_group, none, of_context, final_group} = marks[Stages*MarkBits-1-:MarkBits];

  logic [Contexts-1:0] begun;  // the sums of this decision have a leaf
  logic [SumBits-1:0] place_sum, place_read;
  assign place_sum  = SumBits'(32'(of_context) * Groups + 32'(of_group));
  assign place_read = SumBits'(32'(read_context_i) * Groups + 32'(read_class_i >> LaneBits));

  logic [Used*32-1:0] read_sums;
  for (genvar k = 0; k < Used; k++) begin : gen_sum
    (* no_rw_check *) logic [31:0] sums [Contexts*Groups];
    logic [31:0] kept, sum;
    assign kept = begun[of_context] ? sums[place_sum] : '0;
    assign sum    = kept + (none ? '0 : 32'(votes[16*k+:16]));
    always_ff @(posedge clk_i) if (sum_valid) sums[place_sum] <= sum;
    assign read_sums[32*k+:32] = sums[place_read];
  end

  logic [31:0] read_one;
  assign read_one = begun[read_context_i] ? read_sums[32*(32'(read_class_i) % Lanes)+:32] : '0;

  always_ff @(posedge clk_i) begin
    valid        <= Stages'({valid, in_valid_i});
    marks        <= (Stages*MarkBits)'({marks, group, in_none_i, in_context_i, group_last});
    if (in_valid_i) group <= group_last ? '0 : group + 1'b1;
    counted_o    <= '0;
    if (sum_valid && final_group) begin
      counted_o[of_context] <= 1'b1;
      begun[of_context]     <= 1'b1;
    end
    for (int unsigned k = 0; k < Contexts; k++) if (free_i[k]) begun[k] <= 1'b0;
    if (read_i) read_votes_o <= read_sum_i + read_one;
    if (rst_i || flush_i) begin
      valid     <= '0;
      group     <= '0;
      counted_o <= '0;
    end
    if (rst_i) begun <= '0;
  end

endmodule
