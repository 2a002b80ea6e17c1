// SPDX-License-Identifier: Apache-2.0
//
// Walks the trees of one memory, Walkers of them at a time, so that the memory has a read in flight in every clock.
//
//   node: q[feature] <= threshold: left, else right                  leaf: its votes are added
//
// A walker takes the next tree as soon as it is at a leaf, whatever the others do, and the trees of the next decision
// before those of this one have ended. The memory may answer in any order after any number of clocks, by the tag.
//
//   clock  0        any    1         2      3         4        5       6     9         10
//          request  read   response  place  features  compare  select  next  queue (3) request
//
// Children have greater addresses than their parents, so a walk ends; a node that breaks this, or whose feature or leaf does
// not exist, ends its tree without a vote (damaged_o). late_o: more than Timeout clocks without a response, or what only an
// upset of a queue leaves behind: a leaf of a decision that has all of its votes or has left, a tag that waits already.
// Throughput: a node a clock with Walkers >= 14 in block RAM.   Model: model/meissner/twins/forest/forest.py

module msn_forest_engine #(
  parameter  int unsigned Features    = 9,
  parameter  int unsigned FeatureBits = 22,
  parameter  int unsigned Classes     = 2,
  parameter  int unsigned Trees       = 256,
  parameter  int unsigned Nodes       = 1024,
  parameter  int unsigned Leaves      = 256,
  parameter  int unsigned Banks       = 2,
  parameter  int unsigned Walkers     = 16,
  parameter  int unsigned Lanes       = 4,
  parameter  int unsigned Contexts    = 4,     // decisions under way
  parameter  int unsigned Timeout     = 4096,  // clocks
  parameter  int unsigned Patience    = Timeout,  // clocks after a flush in which an answer may still come
  localparam int unsigned IndexBits   = msn_pkg::index_width(Features),
  localparam int unsigned AddressBits = msn_pkg::index_width(Nodes),
  localparam int unsigned TagBits     = msn_pkg::index_width(Walkers),
  localparam int unsigned ContextBits = $clog2(Contexts),
  localparam int unsigned TreeBits    = msn_pkg::index_width(Trees + 1)
) (
  input  logic                   clk_i,
  input  logic                   rst_i,

  input  logic [Contexts-1:0]    go_i,        // the row of this decision is there; until free_i
  input  logic [ContextBits-1:0] oldest_i,    // the decision that began first
  input  logic [Contexts-1:0]    free_i,      // its result has left
  input  logic                   flush_i,     // gives up what is under way
  output logic [Contexts-1:0]    done_o,
  output logic [Contexts-1:0]    damaged_o,
  output logic                   late_o,      // what is under way has to be given up
  output logic                   stuck_o,     // waits for responses since a flush, at most Patience clocks
  output logic                   step_o,      // a node was compared

  input  logic                   row_write_i,
  input  logic [ContextBits-1:0] row_context_i,
  input  logic [IndexBits-1:0]   row_index_i,
  input  logic [FeatureBits-1:0] row_data_i,

  input  logic                   bank_i,      // in use, constant while a decision is under way
  input  logic                   load_root_i,
  input  logic                   load_leaf_i,
  input  logic                   load_count_i,
  input  logic [31:0]            load_address_i,
  input  logic [31:0]            load_data_i,
  output logic                   empty_o,     // no trees in this bank

  input  logic [ContextBits-1:0] read_context_i,
  input  logic                   read_i,      // a class, added to the sum of the engines before
  input  logic [15:0]            read_class_i,
  input  logic [31:0]            read_sum_i,
  output logic [31:0]            read_votes_o,

  output logic                   req_valid_o,
  input  logic                   req_ready_i,
  output logic                   req_bank_o,
  output logic [AddressBits-1:0] req_address_o,
  output logic [TagBits-1:0]     req_tag_o,

  input  logic                   rsp_valid_i,
  input  logic [TagBits-1:0]     rsp_tag_i,
  input  logic [63:0]            rsp_data_i
);

  if (Features < 1 || Features > 256) begin : gen_check_features
    $fatal(1, "msn_forest_engine: Features = %0d must lie in 1 .. 256", Features);
  end
  if (FeatureBits < 2 || FeatureBits > 22) begin : gen_check_feature_bits
    $fatal(1, "msn_forest_engine: FeatureBits = %0d must lie in 2 .. 22", FeatureBits);
  end
  if (Trees < 1 || Trees > 65535) begin : gen_check_trees
    $fatal(1, "msn_forest_engine: Trees = %0d must lie in 1 .. 65535", Trees);
  end
  if (Nodes < 1 || Nodes > 2 ** 30) begin : gen_check_nodes
    $fatal(1, "msn_forest_engine: Nodes = %0d must lie in 1 .. 2^30", Nodes);
  end
  if (Walkers < 1 || Walkers > 64) begin : gen_check_walkers
    $fatal(1, "msn_forest_engine: Walkers = %0d must lie in 1 .. 64", Walkers);
  end
  if (Timeout < 2 * Classes + 64 || Timeout > 2 ** 24) begin : gen_check_timeout
    $fatal(1, "msn_forest_engine: Timeout = %0d must lie in 2 * Classes + 64 .. 2^24", Timeout);
  end
  if (Patience < Timeout || Patience > 2 ** 30) begin : gen_check_patience
    $fatal(1, "msn_forest_engine: Patience = %0d must lie in Timeout .. 2^30", Patience);
  end

  localparam int unsigned Depth    = (Walkers > 1) ? 2 ** TagBits : 2;
  localparam int unsigned RootBits = msn_pkg::index_width(Trees);
  localparam int unsigned FeatureA = 54;  // where a word has its feature
  localparam int unsigned MarkBits = 1 + ContextBits;  // of a decision: its turn, its context

  // The roots of the decision that begins: read ahead, one a clock.
  logic                   trees_bank, issuing, start, take_root;
  logic [ContextBits-1:0] issue_context, start_context, next_context;
  logic                   root_valid, root_spoilt, unused_end;
  logic [Contexts-1:0]    issued, eligible;
  logic [Contexts-1:0]    turn;  // the other value for the next decision of a context
  logic [TreeBits-1:0]    left, trees;
  logic [2*TreeBits-1:0]  counts;
  logic [AddressBits-1:0] root;
  logic                   filling;
  assign trees_bank    = Banks == 2 && bank_i;
  assign trees         = counts[TreeBits*32'(trees_bank)+:TreeBits];
  assign empty_o       = trees == '0;
  assign eligible      = go_i & ~issued;
  always_comb begin
    next_context = oldest_i;
    for (int unsigned k = Contexts - 1; k > 0; k--) begin
      if (eligible[ContextBits'(k)+oldest_i]) next_context = ContextBits'(k) + oldest_i;
    end
    if (eligible[oldest_i]) next_context = oldest_i;
  end
  msn_frame_table #(.Words(Trees), .Parts(1), .PartBits(AddressBits), .Banks(Banks)) u_roots (
    .clk_i,
    .restart_i(start), .bank_i, .advance_i(take_root || !root_valid),
    .out_valid_o(root_valid), .out_data_o(root), .out_spoilt_o(root_spoilt), .at_end_o(unused_end),
    .write_i(load_root_i && load_address_i < Trees), .write_bank_i(!bank_i),
    .write_word_i(RootBits'(load_address_i)), .write_data_i(AddressBits'(load_data_i))
  );
  always_ff @(posedge clk_i) begin
    // Registered: combinational it is the slowest path, from the decisions to the memory of roots.
    start         <= !issuing && !start && eligible != '0 && !filling;
    start_context <= next_context;
    if (take_root) begin
      left    <= left - 1'b1;
      issuing <= left != TreeBits'(1);
    end
    if (start) begin
      left          <= trees;
      issuing       <= !empty_o;
      issue_context <= start_context;
    end
    for (int unsigned k = 0; k < Contexts; k++) begin
      if (start && start_context == ContextBits'(k)) issued[k] <= 1'b1;
      if (free_i[k]) issued[k] <= 1'b0;
      if (free_i[k]) turn[k] <= !turn[k];
    end
    if (load_count_i && load_data_i <= Trees) begin
      counts[TreeBits*32'(Banks == 2 && !bank_i)+:TreeBits] <= TreeBits'(load_data_i);
    end
    if (flush_i || rst_i) {start, issuing} <= '0;
    if (rst_i) begin
      issued  <= '0;
      turn    <= '0;
      counts  <= '0;
    end
  end
  msn_check u_root_is_not_spoilt (.clk_i, .rst_i, .wrong_i(!rst_i && take_root && root_spoilt));

  // Three queues: nodes to read, leaves to count, tags without a tree. None overflows, as there are Walkers tags.
  logic                   clear, walk_in, walk_valid, walk_take, leaf_in, leaf_valid, leaf_take;
  logic                   free_in, free_valid;
  logic                   leaf_bad;
  logic [MarkBits-1:0]    walk_mark, leaf_mark, request_mark;
  logic [ContextBits-1:0] leaf_context;
  logic [AddressBits-1:0] walk_address;
  logic [TagBits-1:0]     walk_tag, leaf_tag, free_tag, given;
  logic [15:0]            leaf;
  logic                   walk_room, leaf_room, free_room;
  logic [2:0]             unused_half;
  assign clear        = rst_i || flush_i;
  assign leaf_context = leaf_mark[ContextBits-1:0];

  // The request. Nodes come before new trees, so a walk does not wait for the forest's last trees.
  logic                   slot;
  logic [AddressBits-1:0] request_address;
  logic [TagBits-1:0]     request_tag;
  logic [Walkers-1:0]     waiting;
  logic                   gives_up;  // what waits for an answer gets none any more
  assign slot            = !req_valid_o || req_ready_i;
  assign walk_take       = slot && walk_valid;
  assign take_root       = slot && !walk_valid && free_valid && issuing && root_valid;
  assign request_address = walk_valid ? walk_address : root;
  assign request_mark    = walk_valid ? walk_mark : {turn[issue_context], issue_context};
  assign request_tag     = walk_valid ? walk_tag : free_tag;
  assign req_bank_o      = trees_bank;

  // Where each walker is: a response has only its tag.
  (* no_rw_check *) logic [MarkBits+AddressBits-1:0] places [Walkers];
  logic [MarkBits+AddressBits-1:0] place;
  logic                 hit;
  assign place = places[rsp_tag_i];
  assign hit   = rsp_valid_i && 32'(rsp_tag_i) < Walkers && waiting[rsp_tag_i];  // twice the same tag: once
  always_ff @(posedge clk_i) begin
    if (hit) waiting[rsp_tag_i] <= 1'b0;
    if (slot) begin
      req_valid_o   <= walk_take || take_root;
      req_address_o <= request_address;
      req_tag_o     <= request_tag;
    end
    if ((walk_take || take_root) && !flush_i) begin
      places[request_tag]  <= {request_mark, request_address};
      waiting[request_tag] <= 1'b1;
    end
    if (flush_i && slot) req_valid_o <= 1'b0;
    if (gives_up) waiting <= '0;
    if (rst_i) begin
      req_valid_o <= 1'b0;
      waiting     <= '0;
    end
  end

  // One node: place, features (2 clocks), compare, select. Only what later clocks need of a word stays in it.
  logic [4:1]             valid;
  logic [TagBits-1:0]     tag_1, tag_2, tag_3, tag_4, tag_5;
  logic [MarkBits-1:0]    mark_1, mark_2, mark_3, mark_4, mark_5;
  logic [AddressBits-1:0] at_1, at_2, next_3, next_4, next_5;
  logic [63:0]            word_1;
  logic [7:0]             index_2;
  logic [FeatureBits-1:0] threshold_2, threshold_3, value;
  logic [1:0]             kind_2, kind_3, kind_4;
  logic [31:0]            low_2, low_3, low_4;
  logic                   fits_3, fits_4, next_fits_3, next_fits_4, far_fits_3, far_fits_4, right_4;
  logic                   ends_4, is_far_4, leaf_fits_4, good_4, bad_5;
  logic [15:0]            leaf_4, leaf_5;
  logic [31:0]            at_wide;
  assign at_wide = 32'(at_2);
  msn_ram #(.Words(2 ** (IndexBits + ContextBits)), .Width(FeatureBits)) u_row (
    .clk_i,
    .write_i(row_write_i), .write_address_i({row_context_i, row_index_i}), .write_data_i(row_data_i),
    .read_i(1'b1), .read_address_i({mark_1[ContextBits-1:0], word_1[FeatureA+:IndexBits]}), .out_data_o(value)
  );
  assign ends_4      = right_4 ? kind_4[1] : kind_4[0];
  assign leaf_4      = right_4 ? low_4[15:0] : low_4[31:16];
  assign is_far_4    = right_4 && kind_4 == 2'd0;
  assign leaf_fits_4 = Classes == 2 || 32'(leaf_4) < Leaves;
  assign good_4      = fits_4 && (ends_4 ? leaf_fits_4 : is_far_4 ? far_fits_4 : next_fits_4);
  always_ff @(posedge clk_i) begin
    {tag_5, tag_4, tag_3, tag_2, tag_1}      <= {tag_4, tag_3, tag_2, tag_1, rsp_tag_i};
    {mark_5, mark_4, mark_3, mark_2, mark_1} <= {mark_4, mark_3, mark_2, mark_1,
                                                 place[AddressBits+:MarkBits]};
    at_1        <= place[AddressBits-1:0];
    word_1      <= rsp_data_i;
    at_2        <= at_1;
    {kind_2, index_2} <= word_1[63:54];
    threshold_2 <= word_1[32+:FeatureBits];
    low_2       <= word_1[31:0];
    kind_3      <= kind_2;
    threshold_3 <= threshold_2;
    low_3       <= low_2;
    next_3      <= at_2 + 1'b1;
    fits_3      <= 32'(index_2) < Features && at_wide < Nodes;
    next_fits_3 <= at_wide + 32'd1 < Nodes;
    far_fits_3  <= low_2 > at_wide && low_2 < Nodes;
    kind_4      <= kind_3;
    low_4       <= low_3;
    next_4      <= next_3;
    {fits_4, next_fits_4, far_fits_4} <= {fits_3, next_fits_3, far_fits_3};
    right_4     <= signed'(value) > signed'(threshold_3);
    next_5      <= is_far_4 ? low_4[AddressBits-1:0] : next_4;
    leaf_5      <= leaf_4;
    bad_5       <= !good_4;
    valid       <= {valid[3:1], hit && !filling};
    walk_in     <= valid[4] && good_4 && !ends_4;
    leaf_in     <= valid[4] && !(good_4 && !ends_4);
    if (clear) begin
      valid   <= '0;
      walk_in <= 1'b0;
      leaf_in <= 1'b0;
    end
  end
  assign step_o = valid[4];
  logic unused_word;
  assign unused_word = ^word_1;

  msn_fifo #(.Depth(Depth), .Width(MarkBits + AddressBits + TagBits)) u_walk (
    .clk_i, .rst_i(clear),
    .in_valid_i(walk_in), .in_ready_o(walk_room), .in_data_i({mark_5, next_5, tag_5}),
    .out_valid_o(walk_valid), .out_ready_i(slot), .out_data_o({walk_mark, walk_address, walk_tag}),
    .half_o(unused_half[0])
  );
  msn_fifo #(.Depth(Depth), .Width(MarkBits + 17 + TagBits)) u_leaf (
    .clk_i, .rst_i(clear),
    .in_valid_i(leaf_in), .in_ready_o(leaf_room), .in_data_i({mark_5, bad_5, leaf_5, tag_5}),
    .out_valid_o(leaf_valid), .out_ready_i(leaf_take), .out_data_o({leaf_mark, leaf_bad, leaf, leaf_tag}),
    .half_o(unused_half[1])
  );
  msn_fifo #(.Depth(Depth), .Width(TagBits)) u_free (
    .clk_i, .rst_i(clear),
    .in_valid_i(free_in), .in_ready_o(free_room), .in_data_i(filling ? given : leaf_tag),
    .out_valid_o(free_valid), .out_ready_i(take_root), .out_data_o(free_tag), .half_o(unused_half[2])
  );
  msn_check u_a_queue_has_room (
    .clk_i, .rst_i,
    .wrong_i(!rst_i && ((walk_in && !walk_room) || (leaf_in && !leaf_room) || (free_in && !free_room)))
  );

  // All tags become free after a reset, and after a flush when no response is outstanding: a late one is not
  // taken for the response to a new request. One to a request whose tag an upset changed never comes.
  logic quiet_tags;
  assign quiet_tags = waiting == '0 && !req_valid_o;
  assign stuck_o    = filling && !quiet_tags;
  assign free_in    = filling ? quiet_tags : leaf_valid && leaf_take;
  always_ff @(posedge clk_i) begin
    if (filling && quiet_tags) begin
      given   <= given + 1'b1;
      filling <= given != TagBits'(Walkers - 1);
    end
    if (clear) begin
      given   <= '0;
      filling <= 1'b1;
    end
  end

  logic [Contexts-1:0] counted;
  msn_forest_votes #(
    .Classes(Classes), .Leaves(Leaves), .Banks(Banks), .Lanes(Lanes), .Contexts(Contexts)
  ) u_votes (
    .clk_i, .rst_i, .flush_i,
    .in_valid_i(leaf_valid), .in_ready_o(leaf_take), .in_leaf_i(leaf), .in_none_i(leaf_bad),
    .in_context_i(leaf_context), .in_bank_i(bank_i),
    .counted_o(counted), .free_i,
    .read_context_i, .read_i, .read_class_i, .read_sum_i, .read_votes_o,
    .write_i(load_leaf_i), .write_bank_i(!bank_i), .write_row_i(load_address_i[15:0]),
    .write_class_i(load_address_i[31:16]), .write_data_i(load_data_i[15:0])
  );

  // A decision is done when each of its trees is in the sums. A leaf on top of them would be taken for one of the next
  // decision, whose last leaf for one of the next, and so on: votes that are wrong for ever.
  localparam int unsigned QuietBits = $clog2(Patience);
  logic [Contexts-1:0][TreeBits-1:0] voted;  // in one piece, so that netlists keep its names
  logic [QuietBits-1:0] quiet;
  logic                 works, waits_too_long, foreign, twice;
  logic [Contexts-1:0]  full;
  assign works          = (go_i & ~done_o) != '0;
  assign waits_too_long = works && !hit && counted == '0 && quiet == QuietBits'(Timeout - 1);
  assign gives_up       = stuck_o && quiet == QuietBits'(Patience - 1);
  assign foreign        = leaf_valid && leaf_take
                          && (leaf_mark[ContextBits] != turn[leaf_context] || done_o[leaf_context]);
  assign twice          = (walk_take || take_root) && waiting[request_tag];
  always_comb for (int unsigned k = 0; k < Contexts; k++) full[k] = voted[k] == trees;
  always_ff @(posedge clk_i) begin
    for (int unsigned k = 0; k < Contexts; k++) begin
      voted[k]  <= free_i[k] ? '0 : voted[k] + TreeBits'(counted[k] && !full[k]);
      done_o[k] <= issued[k] && full[k] && !free_i[k];
      if (leaf_valid && leaf_take && leaf_bad && leaf_context == ContextBits'(k)) damaged_o[k] <= 1'b1;
      if (free_i[k]) damaged_o[k] <= 1'b0;
    end
    quiet  <= (!(works || stuck_o) || hit || counted != '0 || flush_i) ? '0 : quiet + 1'b1;
    late_o <= waits_too_long || foreign || twice || (counted & full) != '0;
    if (rst_i) begin
      for (int unsigned k = 0; k < Contexts; k++) voted[k] <= '0;
      done_o    <= '0;
      damaged_o <= '0;
      quiet     <= '0;
      late_o    <= 1'b0;
    end
  end

endmodule
