// SPDX-License-Identifier: Apache-2.0
//
// The forest of a core: rows of features from frames or registers, decisions to registers, packets and the reflex.
//
//   samples ─ frame_filter ─ forest_features ─┐                          (Frames)
//   registers ─ features ─────────────────────┴─ forest ─ class, votes ─┬─ registers
//   registers ─ loads, swap ──────────────────────┘                     ├─ changes of class, for packets
//                                                                       └─ decisions, for msn_actuate
//
// Forest = 0: no logic is built, samples pass. Frames = 0: a row is what the registers hold, decided on at `start`.
// A row that finds no room is dropped whole and counted, so no frame waits for a decision. A feature is held at the
// ends of FeatureBits. A decision with an error changes no class. Changes that wait for a packet are merged.
// Sdram: the nodes lie in an SDRAM (msn_forest_sdram), else in block RAM (msn_forest).   Specification: docs/forest.md.
//
// busy_o until a frame's row has been taken, so its time holds.   Model: model/meissner/twins/forest/classify.py

module msn_classify #(
  parameter  bit          Forest      = 1'b1,
  parameter  bit          Suits       = 1'b1,  // the core has registers and, with Frames, samples
  parameter  bit          Frames      = 1'b1,
  parameter  int unsigned Channels    = 9,     // of a frame
  parameter  int unsigned SampleBits  = 17,
  parameter  int unsigned Features    = 54,    // of a row; with Frames, Channels times the frames of a window
  parameter  int unsigned FeatureBits = 18,
  parameter  int unsigned Classes     = 2,
  parameter  int unsigned Trees       = 64,    // of each engine, like the next two
  parameter  int unsigned Nodes       = 1024,  // the SDRAM's are 2^22
  parameter  int unsigned Leaves      = 256,
  parameter  int unsigned Engines     = 1,
  parameter  int unsigned Banks       = 2,
  parameter  int unsigned Lanes       = 4,
  parameter  bit          Sdram       = 1'b0,
  parameter  int unsigned ClkKhz      = 100_000,
  parameter  int unsigned PowerUpUs   = 200,
  localparam int unsigned IdBits      = msn_pkg::index_width(Channels)
) (
  input  logic                              clk_i,
  input  logic                              rst_i,
  input  logic [47:0]                       now_i,
  input  logic [47:0]                       time_i,          // of the frame that samples are from

  input  msn_registers_pkg::forest_cfg_t    cfg_i,
  output msn_registers_pkg::forest_status_t status_o,

  input  logic                              in_valid_i,
  output logic                              in_ready_o,
  input  logic signed [SampleBits-1:0]      in_data_i,
  input  logic        [IdBits-1:0]          in_id_i,
  input  logic                              in_last_i,
  output logic                              out_valid_o,     // the same sample, for the blocks downstream
  input  logic                              out_ready_i,
  output logic                              busy_o,

  output logic                              change_valid_o,
  input  logic                              change_ready_i,
  output msn_pkg::class_t                   change_o,
  output logic                              decided_o,       // for the reflex, one clock
  output logic                              slips_o,

  output msn_pkg::sdram_t                   sdram_o,
  input  logic [15:0]                       sdram_dq_i
);

  if (Forest && !Suits) begin : gen_check_suits
    $fatal(1, "msn_classify: Forest = 1 must go with Registers, with Frames also an array or channels");
  end
  if (Forest && (Features > 256 || (Frames && Features % Channels != 0))) begin : gen_check_features
    $fatal(1, "msn_classify: Features = %0d must be at most 256, and suit Channels if Frames", Features);
  end
  if (Forest && (Classes < 1 || Classes > 65535)) begin : gen_check_classes
    $fatal(1, "msn_classify: Classes = %0d must lie in 1 .. 65535", Classes);
  end
  if (Forest && Sdram && Engines != 1) begin : gen_check_sdram
    $fatal(1, "msn_classify: Sdram = 1 must go with one engine");
  end

  // A value at the nearest end of FeatureBits.
  function automatic logic [FeatureBits-1:0] held(logic signed [21:0] value);
    logic signed [21:0] beyond;
    beyond = value >>> (FeatureBits - 1);
    if (beyond == '0 || beyond == '1) held = value[FeatureBits-1:0];
    else held = {value[21], {(FeatureBits - 1){!value[21]}}};
  endfunction

  if (Forest) begin : gen_forest
    localparam int unsigned ClassBits  = msn_pkg::index_width(Classes);
    localparam int unsigned EngineBits = msn_pkg::index_width(Engines);
    localparam int unsigned IndexBits  = msn_pkg::index_width(Features);
    localparam int unsigned Words      = Sdram ? 1 << 22 : Nodes;
    localparam int unsigned Rows       = (Classes == 2) ? 0 : Leaves;  // of the table of leaves

    // Rows. The forest has room for a whole row, or it takes no beat of it.
    logic                   row_valid, row_last, begun, dropping, room, take, first;
    logic [FeatureBits-1:0] row;
    logic [47:0]            row_time;
    logic                   collides;  // a start while a row is sent
    if (Frames) begin : gen_frames
      logic                         sample_valid, sample_ready, sample_last, sample_restart, filter_ready;
      logic                         sent;
      logic signed [SampleBits-1:0] sample;
      logic        [IdBits-1:0]     sample_id;
      logic        [31:0]           unused_damaged;
      logic signed [SampleBits:0]   difference;
      assign in_ready_o  = out_ready_i && filter_ready;
      assign out_valid_o = in_valid_i && filter_ready;
      msn_frame_filter #(.Channels(Channels), .DataBits(SampleBits)) u_frame_filter (
        .clk_i, .rst_i,
        .in_valid_i(in_valid_i && out_ready_i), .in_ready_o(filter_ready), .in_data_i(in_data_i), .in_id_i,
        .in_last_i,
        .out_valid_o(sample_valid), .out_ready_i(sample_ready), .out_data_o(sample), .out_id_o(sample_id),
        .out_last_o(sample_last), .out_restart_o(sample_restart),
        .damaged_o(unused_damaged)
      );
      msn_forest_features #(
        .Channels(Channels), .SampleBits(SampleBits), .Window(Features / Channels)
      ) u_features (
        .clk_i, .rst_i,
        .in_valid_i(sample_valid), .in_ready_o(sample_ready), .in_data_i(sample), .in_id_i(sample_id),
        .in_last_i(sample_last), .in_restart_i(sample_restart),
        .out_valid_o(row_valid), .out_ready_i(1'b1), .out_data_o(difference), .out_last_o(row_last)
      );
      // A feature that was read from the window follows two clocks later.
      always_ff @(posedge clk_i) sent <= !rst_i && !sample_ready;
      assign row      = held(22'(difference));
      assign row_time = time_i;
      assign busy_o   = sample_valid || !sample_ready || sent || row_valid;
      assign collides = 1'b0;
    end else begin : gen_host
      logic                 sending, fetched, fetched_last;
      logic [IndexBits-1:0] index;
      assign {in_ready_o, out_valid_o} = {out_ready_i, in_valid_i};
      assign row_time = now_i;
      assign busy_o   = 1'b0;
      assign collides = cfg_i.start && (sending || fetched || row_valid);
      msn_ram #(.Words(Features), .Width(FeatureBits)) u_row (
        .clk_i,
        .write_i(cfg_i.feature_written && 32'(cfg_i.feature_index) < Features),
        .write_address_i(IndexBits'(cfg_i.feature_index)), .write_data_i(held(signed'(cfg_i.feature))),
        .read_i(1'b1), .read_address_i(index), .out_data_o(row)
      );
      always_ff @(posedge clk_i) begin
        fetched      <= sending;
        fetched_last <= index == IndexBits'(Features - 1);
        row_valid    <= fetched;
        row_last     <= fetched_last;
        if (sending) begin
          index   <= index + 1'b1;
          sending <= index != IndexBits'(Features - 1);
        end else if (cfg_i.start && !collides) begin
          index   <= '0;
          sending <= 1'b1;
        end
        if (rst_i) {sending, fetched, row_valid} <= '0;
      end
      logic unused_samples;
      assign unused_samples = ^{in_data_i, in_id_i, in_last_i, time_i};
    end
    assign first = !begun;
    assign take  = row_valid && (first ? room : !dropping);
    always_ff @(posedge clk_i) begin
      if (row_valid) begun <= !row_last;
      if (row_valid && first) dropping <= !room;
      if (rst_i) begun <= 1'b0;
    end

    // Loads. Of a write nothing is kept beside the registers: while one waits, the next is refused.
    logic        exists, waits, refused, load_ready, swap, swapping, loaded, partial;
    logic [21:0] place;
    logic [31:0] written;
    always_comb begin
      case (cfg_i.target_kind)
        2'd0:    exists = 32'(place) < Words;
        2'd1:    exists = 32'(place) < Trees;
        2'd2:    exists = Classes != 2 && 32'(place) < Leaves && 32'(cfg_i.target_label) < Classes;
        default: exists = cfg_i.data <= Trees;
      endcase
      if (cfg_i.target_kind != 2'd2 && 32'(cfg_i.target_engine) >= Engines) exists = 1'b0;
    end
    always_ff @(posedge clk_i) begin
      swap <= 1'b0;
      if (waits && load_ready) begin
        waits   <= 1'b0;
        partial <= 1'b1;
        place   <= place + 1'b1;
        written <= written + 1'b1;
      end
      if (cfg_i.address_written) place <= cfg_i.address;
      if (cfg_i.data_written && !waits && exists) waits <= 1'b1;
      if (cfg_i.data_written && (waits || !exists)) refused <= 1'b1;
      if (cfg_i.address_written && waits) refused <= 1'b1;
      if (cfg_i.swap && !waits && !refused && written != '0) begin
        swap    <= 1'b1;
        loaded  <= 1'b1;
        partial <= 1'b0;
        written <= '0;
      end
      if (cfg_i.clear) begin
        refused <= 1'b0;
        written <= '0;
      end
      if (rst_i) {swap, waits, refused, loaded, partial, written} <= '0;
    end

    // The forest.
    logic                 found, found_last;
    logic [ClassBits-1:0] found_id, found_class;
    logic [31:0]          found_votes;
    logic [2:0]           found_error;
    logic [31:0]          load_address, unused_rows;
    localparam int unsigned Contexts    = Sdram ? 4 : 2;
    localparam int unsigned ContextBits = $clog2(Contexts);
    logic [ContextBits-1:0] row_context, found_context;
    assign load_address = (cfg_i.target_kind == 2'd2) ? {cfg_i.target_label, place[15:0]} : 32'(place);
    if (Sdram) begin : gen_sdram
      logic unused_step, unused_up;
      msn_forest_sdram #(
        .Features(Features), .FeatureBits(FeatureBits), .Classes(Classes), .Trees(Trees), .Leaves(Leaves),
        .Banks(Banks), .ClkKhz(ClkKhz), .PowerUpUs(PowerUpUs)
      ) u_forest (
        .clk_i, .rst_i,
        .in_valid_i(take), .in_ready_o(room), .in_data_i(row), .in_last_i(row_last), .damaged_o(unused_rows),
        .in_context_o(row_context),
        .out_valid_o(found), .out_ready_i(1'b1), .out_id_o(found_id), .out_votes_o(found_votes),
        .out_last_o(found_last), .out_class_o(found_class), .out_error_o(found_error),
        .out_context_o(found_context), .step_o(unused_step),
        .load_valid_i(waits), .load_ready_o(load_ready), .load_kind_i(cfg_i.target_kind),
        .load_address_i(load_address), .load_data_i({cfg_i.high, cfg_i.data}),
        .swap_i(swap), .swapping_o(swapping), .up_o(unused_up),
        .sdram_cke_o(sdram_o.cke), .sdram_cs_n_o(sdram_o.cs_n), .sdram_ras_n_o(sdram_o.ras_n),
        .sdram_cas_n_o(sdram_o.cas_n), .sdram_we_n_o(sdram_o.we_n), .sdram_ba_o(sdram_o.ba),
        .sdram_a_o(sdram_o.a), .sdram_dqm_o(sdram_o.dqm), .sdram_dq_o(sdram_o.dq),
        .sdram_dq_enable_o(sdram_o.dq_enable), .sdram_dq_i
      );
    end else begin : gen_block_ram
      localparam int unsigned AddressBits = msn_pkg::index_width(Nodes);
      logic [Engines-1:0]             unused_step, unused_req;
      logic                           unused_bank;
      logic [Engines*AddressBits-1:0] unused_address;
      logic [Engines*4-1:0]           unused_tag;
      msn_forest #(
        .Features(Features), .FeatureBits(FeatureBits), .Classes(Classes), .Trees(Trees), .Nodes(Nodes),
        .Leaves(Leaves), .Engines(Engines), .Banks(Banks), .Walkers(16), .Lanes(Lanes), .Contexts(Contexts)
      ) u_forest (
        .clk_i, .rst_i,
        .in_valid_i(take), .in_ready_o(room), .in_data_i(row), .in_last_i(row_last), .damaged_o(unused_rows),
        .in_context_o(row_context),
        .out_valid_o(found), .out_ready_i(1'b1), .out_id_o(found_id), .out_votes_o(found_votes),
        .out_last_o(found_last), .out_class_o(found_class), .out_error_o(found_error),
        .out_context_o(found_context), .step_o(unused_step),
        .load_valid_i(waits), .load_ready_o(load_ready), .load_kind_i(cfg_i.target_kind),
        .load_engine_i(EngineBits'(cfg_i.target_engine)), .load_address_i(load_address),
        .load_data_i({cfg_i.high, cfg_i.data}),
        .swap_i(swap), .swapping_o(swapping),
        .req_valid_o(unused_req), .req_ready_i('0), .req_bank_o(unused_bank), .req_address_o(unused_address),
        .req_tag_o(unused_tag), .rsp_valid_i('0), .rsp_tag_i('0), .rsp_data_i('0)
      );
      assign sdram_o = '0;
      logic unused_sdram;
      assign unused_sdram = ^sdram_dq_i;
    end

    // Times of the rows under way, by the forest's contexts: a queue of their own would be out of step after an upset.
    (* no_rw_check *) logic [47:0] times [Contexts];
    logic [47:0] found_time;
    assign found_time = times[found_context];
    always_ff @(posedge clk_i) if (take && first) times[row_context] <= row_time;

    // Decisions. `told`: the class that the host has.
    logic [15:0] label, told, missed, absent, late, broken;
    logic [31:0] best, most, most_before, votes, decisions, changes;
    logic [47:0] label_time;
    logic [2:0]  error;
    assign most = (found_id == '0 || found_votes > most_before) ? found_votes : most_before;
    assign change_valid_o = label != told;
    assign change_o       = {label_time, best, told, label};
    msn_ram #(.Words(Classes), .Width(32)) u_votes (
      .clk_i,
      .write_i(found), .write_address_i(found_id), .write_data_i(found_votes),
      .read_i(1'b1), .read_address_i(ClassBits'(cfg_i.select)), .out_data_o(votes)
    );
    always_ff @(posedge clk_i) begin
      decided_o <= 1'b0;
      if (change_valid_o && change_ready_i) told <= label;
      if (found) most_before <= most;
      if (found && found_last) begin
        decisions <= decisions + 1'b1;
        error     <= found_error;
        absent    <= absent + 16'(found_error[0]);
        late      <= late + 16'(found_error[1]);
        broken    <= broken + 16'(found_error[2]);
        if (found_error == '0) begin
          decided_o <= cfg_i.grip;
          slips_o   <= 16'(found_class) < 16'd32 && cfg_i.slip[5'(found_class)];
          label     <= 16'(found_class);
          best      <= most;
          if (label != 16'(found_class)) begin
            label_time <= found_time;
            changes    <= changes + 1'b1;
          end
        end
      end
      missed <= missed + 16'(collides || (row_valid && first && !room));
      if (rst_i) begin
        {decided_o, slips_o, best, decisions, changes, error} <= '0;
        {missed, absent, late, broken}                        <= '0;
        {label, told}                                         <= '1;
      end
    end

    always_comb begin
      {status_o.size_features, status_o.size_bits} = {9'(Features), 5'(FeatureBits)};
      {status_o.size_engines, status_o.size_banks} = {7'(Engines), 2'(Banks)};
      status_o.size_frames    = Frames;
      status_o.room_trees     = 16'(Trees);
      status_o.room_classes   = 16'(Classes);
      status_o.nodes          = 23'(Words);
      status_o.leaves         = 17'(Rows);
      status_o.state_loaded   = loaded && !(Banks == 1 && partial);
      status_o.state_waits    = waits;
      status_o.state_swapping = swap || swapping;
      status_o.state_refused  = refused;
      status_o.state_error    = error;
      status_o.written        = written;
      status_o.label          = label;
      status_o.best           = best;
      status_o.votes          = votes;
      {status_o.decisions, status_o.changes} = {decisions, changes};
      {status_o.missed, status_o.absent, status_o.late, status_o.broken} = {missed, absent, late, broken};
    end

    // Signals that some builds do not use.
    logic unused;
    assign unused = ^{cfg_i, now_i, time_i};
  end else begin : gen_none
    assign {in_ready_o, out_valid_o} = {out_ready_i, in_valid_i};
    assign {status_o, busy_o, change_valid_o, change_o, decided_o, slips_o, sdram_o} = '0;
    logic unused;
    assign unused = ^{clk_i, rst_i, now_i, time_i, cfg_i, in_data_i, in_id_i, in_last_i, change_ready_i,
                      sdram_dq_i};
  end

endmodule
