// SPDX-License-Identifier: Apache-2.0
//
// Decides on rows of features by a forest: class and votes, with Engines that each walk their own trees.
//
//   V_c = sum over trees of the votes of the leaf that the row reaches        class = the first c with the largest V_c
//
// A row is a frame of Features beats with `last` on the final one. Any other is dropped up to its `last`, and counted.
// The result is Classes beats, V_0 first; out_class_o is valid with `last`. While a decision is under way the next row is
// taken and begun. A load goes to the bank not in use, swap_i puts it in use between two decisions; with one bank
// the first write waits for the decisions under way, and until swap_i every row gets error 1.
// Load kinds: 0 node (engine, address), 1 root (engine, tree), 2 vote (row, class << 16), 3 number of trees (engine).
// Error bits: 1 no forest, 2 the memory did not answer in time, or an upset left a leaf too many, 4 a node or leaf that
// cannot be (its tree has no vote).
// Outside: nodes are read at req_*, rsp_*, of each engine, and not loaded here; else block RAM (msn_forest_memory). No
// answer may come later than 16 * Timeout clocks after the last one.
//
// Latency: reading and walking, then Classes + Engines + 4 clocks.   Model: model/meissner/twins/forest/forest.py

module msn_forest #(
  parameter  int unsigned Features    = 9,
  parameter  int unsigned FeatureBits = 22,
  parameter  int unsigned Classes     = 2,
  parameter  int unsigned Trees       = 256,   // of each engine
  parameter  int unsigned Nodes       = 1024,  // of each engine
  parameter  int unsigned Leaves      = 256,
  parameter  int unsigned Engines     = 1,
  parameter  int unsigned Banks       = 2,
  parameter  int unsigned Walkers     = 16,
  parameter  int unsigned Lanes       = 4,
  parameter  int unsigned Contexts    = 4,     // decisions under way, a power of two
  parameter  int unsigned Timeout     = 4096,
  parameter  bit          Outside     = 1'b0,
  localparam int unsigned ClassBits   = msn_pkg::index_width(Classes),
  localparam int unsigned EngineBits  = msn_pkg::index_width(Engines),
  localparam int unsigned AddressBits = msn_pkg::index_width(Nodes),
  localparam int unsigned TagBits     = msn_pkg::index_width(Walkers),
  localparam int unsigned ContextBits = $clog2(Contexts)
) (
  input  logic                           clk_i,
  input  logic                           rst_i,

  input  logic                           in_valid_i,
  output logic                           in_ready_o,
  input  logic [FeatureBits-1:0]         in_data_i,   // signed
  input  logic                           in_last_i,
  output logic [31:0]                    damaged_o,   // frames
  output logic [ContextBits-1:0]         in_context_o,   // of the row that comes in, not in use for another

  output logic                           out_valid_o,
  input  logic                           out_ready_i,
  output logic [ClassBits-1:0]           out_id_o,
  output logic [31:0]                    out_votes_o,
  output logic                           out_last_o,
  output logic [ClassBits-1:0]           out_class_o,
  output logic [2:0]                     out_error_o,
  output logic [ContextBits-1:0]         out_context_o,  // of the row that this is the result of
  output logic [Engines-1:0]             step_o,      // nodes compared in this clock

  input  logic                           load_valid_i,
  output logic                           load_ready_o,
  input  logic [1:0]                     load_kind_i,
  input  logic [EngineBits-1:0]          load_engine_i,
  input  logic [31:0]                    load_address_i,
  input  logic [63:0]                    load_data_i,
  input  logic                           swap_i,
  output logic                           swapping_o,  // requested, not done yet

  output logic [Engines-1:0]             req_valid_o,
  input  logic [Engines-1:0]             req_ready_i,
  output logic                           req_bank_o,
  output logic [Engines*AddressBits-1:0] req_address_o,
  output logic [Engines*TagBits-1:0]     req_tag_o,

  input  logic [Engines-1:0]             rsp_valid_i,
  input  logic [Engines*TagBits-1:0]     rsp_tag_i,
  input  logic [Engines*64-1:0]          rsp_data_i
);

  if (Engines < 1 || Engines > 64) begin : gen_check_engines
    $fatal(1, "msn_forest: Engines = %0d must lie in 1 .. 64", Engines);
  end

  localparam int unsigned IndexBits   = msn_pkg::index_width(Features);

  // The row that comes in goes to the context `fill`, while decisions on others are under way. All pointers move in turn.
  logic [Contexts-1:0]    filled, going, failed, using_, free;
  logic [ContextBits-1:0] fill, next, oldest, row_context;
  logic                   accept, fits, dropping, damage;
  logic [IndexBits-1:0]   place;
  logic                   row_write;
  logic [IndexBits-1:0]   row_index;
  logic [FeatureBits-1:0] row_data;
  assign in_ready_o    = !filled[fill];
  assign in_context_o  = fill;
  assign out_context_o = oldest;
  assign accept     = in_valid_i && in_ready_o;
  assign fits       = !dropping && in_last_i == (place == IndexBits'(Features - 1));
  assign using_     = going & ~failed;

  // The bank in use, and whether it has a forest.
  logic               bank, swapping, settling, loading, absent, load;
  logic [1:0]         load_kind;
  logic [EngineBits-1:0] load_engine;
  logic [31:0]        load_address;
  logic [63:0]        load_data;
  logic [Engines-1:0] empty, stuck, late;
  logic               any_stuck, flush, begin_next;
  logic [Contexts-1:0] all_done, any_broken;
  logic [Engines*Contexts-1:0] done, broken;
  assign swapping_o   = swapping;
  assign load_ready_o = !swapping && (Banks == 2 || (loading && using_ == '0));
  assign begin_next   = filled[next] && !going[next] && !swapping && !settling;

  // Results in the order of rows. Classes pass the engines one after another, a class a clock, and each engine adds
  // its votes: a sum over all of them in one clock would be the slowest path with eight.
  logic                 reads, asks, advance, better, leaves_last;
  logic [ClassBits-1:0] asked;
  logic [Engines:0]     valid_at;
  logic [Engines:0][ClassBits-1:0] class_at;  // these two in one piece, so that netlists keep their names
  logic [Engines:0][31:0] sum_at;
  logic [31:0]          total, best;
  logic [2:0]           errors [Contexts];
  assign sum_at[0]   = '0;
  assign advance     = !out_valid_o || out_ready_i;
  assign total       = failed[oldest] ? '0 : sum_at[Engines];
  assign better      = total > best || class_at[Engines] == '0;
  assign leaves_last = out_valid_o && out_ready_i && out_last_o;

  always_comb begin
    any_broken = '0;
    for (int unsigned e = 0; e < Engines; e++) any_broken |= broken[Contexts*e+:Contexts];
  end

  always_ff @(posedge clk_i) begin
    // Rows.
    if (accept) begin
      place    <= in_last_i ? '0 : place + 1'b1;
      dropping <= !in_last_i && !fits;
      if (in_last_i && fits) fill <= fill + 1'b1;
    end
    row_write   <= accept && !dropping;
    row_context <= fill;
    row_index   <= place;
    row_data    <= in_data_i;
    damage      <= accept && !fits && !dropping;
    if (damage) damaged_o <= damaged_o + 1'b1;

    // Decisions begin in their order. One that cannot be made has its error at once.
    if (begin_next) next <= next + 1'b1;
    for (int unsigned k = 0; k < Contexts; k++) begin
      if (accept && in_last_i && fits && fill == ContextBits'(k)) filled[k] <= 1'b1;
      if (begin_next && next == ContextBits'(k)) begin
        going[k]  <= 1'b1;
        failed[k] <= absent || loading || any_stuck;
        errors[k] <= {1'b0, any_stuck && !absent && !loading, absent || loading};
      end
      if (flush && using_[k] && !all_done[k]) begin
        failed[k]    <= 1'b1;
        errors[k][1] <= 1'b1;
      end
      if (any_broken[k]) errors[k][2] <= 1'b1;
      all_done[k] <= !free[k];
      for (int unsigned e = 0; e < Engines; e++) if (!done[Contexts*e+k]) all_done[k] <= 1'b0;
      if (leaves_last && oldest == ContextBits'(k)) {filled[k], going[k], failed[k]} <= '0;
      free[k] <= leaves_last && oldest == ContextBits'(k);
    end
    any_stuck <= |stuck;
    flush     <= |late && !flush;

    // Loads and swaps.
    absent       <= &empty;
    load         <= load_valid_i && load_ready_o;
    load_kind    <= load_kind_i;
    load_engine  <= load_engine_i;
    load_address <= load_address_i;
    load_data    <= load_data_i;
    settling     <= swapping;  // `absent` follows the bank a clock later
    swapping     <= swap_i || (swapping && (using_ != '0 || load));
    if (swapping && using_ == '0 && !load) begin
      bank    <= !bank;
      loading <= 1'b0;
    end
    if (Banks == 1 && load_valid_i && !swapping && !swap_i) loading <= 1'b1;

    // Sums over the engines, compared in the order of classes.
    if (!reads && going[oldest] && (failed[oldest] || all_done[oldest])) {reads, asks} <= '1;
    if (advance) begin
      if (asks) asked <= (asked == ClassBits'(Classes - 1)) ? '0 : asked + 1'b1;
      if (asks && asked == ClassBits'(Classes - 1)) asks <= 1'b0;
      valid_at    <= {valid_at[Engines-1:0], asks};
      class_at[0] <= asked;
      for (int unsigned e = 0; e < Engines; e++) class_at[e+1] <= class_at[e];
      out_valid_o <= valid_at[Engines];
      out_id_o    <= class_at[Engines];
      out_votes_o <= total;
      out_last_o  <= class_at[Engines] == ClassBits'(Classes - 1);
      out_error_o <= errors[oldest];
      if (valid_at[Engines] && better) begin
        best        <= total;
        out_class_o <= class_at[Engines];
      end
    end
    if (leaves_last) begin
      reads  <= 1'b0;
      oldest <= oldest + 1'b1;
    end

    if (rst_i) begin
      place     <= '0;
      dropping  <= 1'b0;
      fill      <= '0;
      row_write <= 1'b0;
      damage    <= 1'b0;
      damaged_o <= '0;
      next      <= '0;
      oldest    <= '0;
      filled    <= '0;
      going     <= '0;
      failed    <= '0;
      all_done  <= '0;
      free      <= '0;
      any_stuck <= 1'b0;
      flush     <= 1'b0;
      absent    <= 1'b1;
      load      <= 1'b0;
      swapping  <= 1'b0;
      settling  <= 1'b0;
      bank      <= 1'b0;
      loading   <= 1'b0;
      reads     <= 1'b0;
      asks      <= 1'b0;
      asked     <= '0;
      valid_at  <= '0;
      out_valid_o <= 1'b0;
    end
  end

  assign req_bank_o = Banks == 2 && bank;
  for (genvar e = 0; e < Engines; e++) begin : gen_engine
    logic                   mine, req_valid, req_ready, req_bank, rsp_valid;
    logic [AddressBits-1:0] req_address;
    logic [TagBits-1:0]     req_tag, rsp_tag;
    logic [63:0]            rsp_data;
    assign mine = load && load_engine == EngineBits'(e);
    msn_forest_engine #(
      .Features(Features), .FeatureBits(FeatureBits), .Classes(Classes), .Trees(Trees), .Nodes(Nodes),
      .Leaves(Leaves), .Banks(Banks), .Walkers(Walkers), .Lanes(Lanes), .Contexts(Contexts),
      .Timeout(Timeout), .Patience(Outside ? 16 * Timeout : Timeout)
    ) u_engine (
      .clk_i, .rst_i,
      .go_i(using_), .oldest_i(oldest), .free_i(free), .flush_i(flush),
      .done_o(done[Contexts*e+:Contexts]), .damaged_o(broken[Contexts*e+:Contexts]),
      .late_o(late[e]), .stuck_o(stuck[e]), .step_o(step_o[e]),
      .row_write_i(row_write), .row_context_i(row_context), .row_index_i(row_index), .row_data_i(row_data),
      .bank_i(bank),
      .load_root_i(mine && load_kind == 2'd1), .load_leaf_i(load && load_kind == 2'd2),
      .load_count_i(mine && load_kind == 2'd3), .load_address_i(load_address), .load_data_i(load_data[31:0]),
      .empty_o(empty[e]),
      .read_context_i(oldest), .read_i(advance), .read_class_i(16'(class_at[e])), .read_sum_i(sum_at[e]),
      .read_votes_o(sum_at[e+1]),
      .req_valid_o(req_valid), .req_ready_i(req_ready), .req_bank_o(req_bank), .req_address_o(req_address),
      .req_tag_o(req_tag),
      .rsp_valid_i(rsp_valid), .rsp_tag_i(rsp_tag), .rsp_data_i(rsp_data)
    );
    if (Outside) begin : gen_port
      assign req_valid_o[e] = req_valid;
      assign req_ready      = req_ready_i[e];
      assign req_address_o[AddressBits*e+:AddressBits] = req_address;
      assign req_tag_o[TagBits*e+:TagBits]             = req_tag;
      assign rsp_valid = rsp_valid_i[e];
      assign rsp_tag   = rsp_tag_i[TagBits*e+:TagBits];
      assign rsp_data  = rsp_data_i[64*e+:64];
      logic unused_bank;
      assign unused_bank = ^{req_bank, load_data};
    end else begin : gen_memory
      msn_forest_memory #(
        .Features(Features), .FeatureBits(FeatureBits), .Nodes(Nodes), .Banks(Banks), .Walkers(Walkers)
      ) u_memory (
        .clk_i, .rst_i,
        .req_valid_i(req_valid), .req_ready_o(req_ready), .req_bank_i(req_bank), .req_address_i(req_address),
        .req_tag_i(req_tag),
        .rsp_valid_o(rsp_valid), .rsp_tag_o(rsp_tag), .rsp_data_o(rsp_data),
        .write_i(mine && load_kind == 2'd0 && load_address < Nodes), .write_bank_i(!bank),
        .write_address_i(AddressBits'(load_address)), .write_data_i(load_data)
      );
      assign req_valid_o[e] = 1'b0;
      assign req_address_o[AddressBits*e+:AddressBits] = '0;
      assign req_tag_o[TagBits*e+:TagBits]             = '0;
      logic unused_port;
      assign unused_port = ^{req_ready_i[e], rsp_valid_i[e], rsp_tag_i[TagBits*e+:TagBits],
                             rsp_data_i[64*e+:64]};
    end
  end

endmodule
