// SPDX-License-Identifier: Apache-2.0
//
// The changes of each channel's state, from the decisions about it: for the host, which gets only these.
//
//   wanted = (state != told or raised) and events[state]        told: the state that the host has of this channel
//   a start (raised) waits for its place; any other change goes with the first detail at which room_i is 1
//   late = state != told and it is not new in this detail
//
// So a change without room holds nothing up and is not forgotten: the channel's next detail offers it again. It is
// lost, and counted, only if the channel changes again before. A state that is not wanted counts as told.
// read_state_o: state of channel read_id_i, one clock later. For a channel per decision in order nothing waits: the
// states of the next two channels are read ahead, since a memory's output comes too late for what depends on them.
// After a frame that was cut the first decision waits for two clocks, or one if its channel is the second of these.
//
// Combinational from input to output; one decision per clock, after Channels clocks from reset.
// Error: none.
// Model: model/meissner/twins/slip/slip_changes.py

module msn_slip_changes #(
  parameter  int unsigned Channels = 8,  // 1: the decisions' id does not matter
  localparam int unsigned IdBits   = msn_pkg::index_width(Channels)
) (
  input  logic                 clk_i,
  input  logic                 rst_i,

  input  logic [4:0]           cfg_events_i,  // [k]: changes to state k are sent

  input  logic                 in_valid_i,
  output logic                 in_ready_o,
  input  msn_pkg::decision_t   in_i,

  input  logic                 room_i,        // while 1 an offered change is taken soon
  output logic                 out_valid_o,
  input  logic                 out_ready_i,
  output msn_pkg::change_t     out_o,

  input  logic [IdBits-1:0]    read_id_i,
  output msn_pkg::slip_state_e read_state_o,

  output logic [31:0]          lost_o
);

  if (Channels < 1 || Channels > 4096) begin : gen_check_channels
    $fatal(1, "msn_slip_changes: Channels = %0d must lie in 1 .. 4096", Channels);
  end

  logic                 found, accept;  // `told` and `now` are this channel's; the decision is taken
  msn_pkg::slip_state_e told, now, state, next_told;

  logic       waiting, changed, differs, listed, wanted, sends;
  logic [7:0] events;
  assign state     = in_i.state;
  assign waiting   = told != now;
  assign changed   = state != now;
  assign differs   = state != told || in_i.raised;
  assign events    = 8'(cfg_events_i);
  assign listed    = events[state];
  assign wanted    = differs && listed;
  assign sends     = wanted && (in_i.raised || room_i);
  assign next_told = (wanted && !sends) ? told : state;

  assign out_valid_o = in_valid_i && found && sends;
  assign in_ready_o  = found && (out_ready_i || !sends);
  assign accept      = in_valid_i && in_ready_o;
  assign out_o       = {in_i.raised, waiting && !changed, told, state, in_i.p2p, in_i.id};

  // What was waiting is lost with another change, and so is a change back to the state that the host has.
  logic [1:0] lost;
  always_ff @(posedge clk_i) begin
    lost   <= (accept && waiting && changed) ? 2'd1 + 2'(listed && !differs) : 2'd0;
    lost_o <= lost_o + 32'(lost);  // a clock later: 32 clock enables are slow
    if (rst_i) {lost, lost_o} <= '0;
  end

  if (Channels == 1) begin : gen_one
    assign found        = 1'b1;
    assign read_state_o = now;
    always_ff @(posedge clk_i) begin
      if (accept) {told, now} <= {next_told, state};
      if (rst_i) {told, now} <= {msn_pkg::None, msn_pkg::None};
    end
    logic unused_id;
    assign unused_id = ^read_id_i;

  end else begin : gen_many
    (* no_rw_check *) logic [2:0] told_memory [Channels];
    (* no_rw_check *) logic [2:0] now_memory [Channels];
    // Channels of the states at hand, and of those that the memories read.
    logic [IdBits-1:0] ahead, behind;
    logic              clearing, advance, missing;
    logic [IdBits-1:0] sweep, id, after, read_at, write_at;
    assign id       = in_i.id[IdBits-1:0];
    assign found    = !clearing && ahead == id;
    assign missing  = in_valid_i && !clearing && ahead != id;
    assign advance  = accept || (missing && behind == id);
    assign after    = (behind == IdBits'(Channels - 1)) ? '0 : behind + 1'b1;
    assign read_at  = advance ? after : missing ? id : behind;
    assign write_at = clearing ? sweep : id;

    logic       write, passes;  // what the host reads is written in this clock
    logic [2:0] fetched, told_fetched, now_fetched, told_next, now_next, written;
    assign write        = clearing || accept;
    assign read_state_o = msn_pkg::slip_state_e'(passes ? written : fetched);
    always_ff @(posedge clk_i) begin
      if (write) begin
        told_memory[write_at] <= clearing ? '0 : next_told;
        now_memory[write_at]  <= clearing ? '0 : state;
      end
      told_fetched <= told_memory[read_at];
      now_fetched  <= now_memory[read_at];
      behind       <= read_at;
      if (advance) begin
        told  <= msn_pkg::slip_state_e'(told_next);
        now   <= msn_pkg::slip_state_e'(now_next);
        ahead <= behind;
      end
      fetched      <= now_memory[read_id_i];
      written      <= clearing ? '0 : state;
      passes       <= write && write_at == read_id_i;
      if (clearing) sweep <= sweep + 1'b1;
      if (sweep == IdBits'(Channels - 1)) clearing <= 1'b0;
      if (rst_i) begin
        {told, now} <= {msn_pkg::None, msn_pkg::None};
        clearing    <= 1'b1;
        sweep       <= '0;
        ahead       <= '0;
        behind      <= IdBits'(1);
      end
    end

    if (Channels == 2) begin : gen_pair
      // The second channel ahead is the one that is written.
      logic       same;
      logic [2:0] told_written;
      always_ff @(posedge clk_i) begin
        same         <= write && write_at == read_at;
        told_written <= clearing ? '0 : next_told;
      end
      assign told_next = same ? told_written : told_fetched;
      assign now_next  = same ? written : now_fetched;
    end else begin : gen_next
      assign {told_next, now_next} = {told_fetched, now_fetched};
      // Reading a word in the clock in which it is written is undefined.
      msn_check u_read_is_not_written (.clk_i, .rst_i, .wrong_i(!rst_i && accept && read_at == id));
    end
  end

  logic unused_in;
  assign unused_in = ^in_i;

endmodule
