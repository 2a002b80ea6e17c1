// SPDX-License-Identifier: Apache-2.0
//
// The states of any channel, against the rules written with "details since" instead of running timers:
//   a slip is never raised within `refractory` details after a slip ended, nor within `blank` after a contact began
//   no state is a dead end: None and Release react to a press, a lifted contact goes to Release, a slip that is no
//   longer seen ends after `hold` details, and so does Release
// The settings do not change meanwhile (assumed: msn_frame_gate lets them change only between drained frames).

`include "owed_ports.svh"

module formal_slip #(
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned DetailBits = 18,
  parameter  int unsigned TimerBits  = 16,
  parameter  bit          Mask       = 1'b0,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels),
  localparam int unsigned CountBits  = TimerBits + 1
) (
  input logic                         clk_i,
  input logic                         rst_i,
  input logic [IdBits-1:0]            watch_i,
  input logic        [DetailBits-1:0] cfg_threshold_i,
  input logic        [DetailBits-1:0] cfg_gross_threshold_i,
  input logic signed [DetailBits-1:0] cfg_contact_level_i,
  input logic signed [DetailBits-1:0] cfg_release_level_i,
  input logic                         cfg_contact_rises_i,
  input logic        [TimerBits-1:0]  cfg_hold_i,
  input logic        [TimerBits-1:0]  cfg_refractory_i,
  input logic        [TimerBits-1:0]  cfg_blank_i,
  input logic        [DetailBits-1:0] cfg_keep_threshold_i,
  input logic                         actuator_moving_i,
  input logic                         in_valid_i,
  input logic        [DetailBits-1:0] in_p2p_i,
  input logic signed [DetailBits-1:0] in_total_i,
  input logic        [IdBits-1:0]     in_id_i,
  input logic                         in_last_i,
  input logic                         in_restart_i,
  input logic                         in_mask_i,
  input logic                         in_end_i,
  input logic                         out_ready_i
);

  logic                  in_ready_o, out_valid_o, out_raised_o, out_over_o, out_last_o, out_end_o, busy_o;
  msn_pkg::slip_state_e  out_state_o;
  logic [DetailBits-1:0] out_p2p_o;
  logic [IdBits-1:0]     out_id_o;
  logic [31:0]           blanked_o;
  msn_slip #(
    .Channels(Channels), .DetailBits(DetailBits), .TimerBits(TimerBits), .Mask(Mask)
  ) dut (.*);

  logic              accept, started, first, again, watched;
  logic [IdBits-1:0] at;
  assign accept = in_valid_i && in_ready_o;
  owed_frames #(.Channels(Channels)) u_frames (
    .clk_i, .rst_i, .watch_i, .accept_i(accept), .in_valid_i, .in_id_i, .in_last_i, .in_restart_i,
    .started_o(started), .at_o(at), .first_o(first), .again_o(again), .watched_o(watched)
  );

  // Settings.
  localparam int unsigned CfgBits = 5 * DetailBits + 1 + 3 * TimerBits;
  logic [CfgBits-1:0] cfg, cfg_q;
  assign cfg = {cfg_threshold_i, cfg_gross_threshold_i, cfg_contact_level_i, cfg_release_level_i,
                cfg_contact_rises_i, cfg_hold_i, cfg_refractory_i, cfg_blank_i, cfg_keep_threshold_i};
  always_ff @(posedge clk_i) cfg_q <= cfg;
  always_comb if (started) assume (cfg == cfg_q);

  // 1: the comparisons of a detail.
  logic                  seen, pressed, lifted, over, gross, keeps, moving, restart, mask, last, end_q, stalled;
  logic [DetailBits-1:0] p2p;
  logic [IdBits-1:0]     id;
  logic                  high_enough, low_enough;
  assign high_enough = cfg_contact_rises_i ? in_total_i >= cfg_contact_level_i : in_total_i <= cfg_contact_level_i;
  assign low_enough  = cfg_contact_rises_i ? in_total_i < cfg_release_level_i : in_total_i > cfg_release_level_i;
  always_ff @(posedge clk_i) begin
    stalled <= out_valid_o && !out_ready_i && !rst_i;
    if (in_ready_o) begin
      seen    <= accept;
      mask    <= Mask && in_mask_i;
      pressed <= high_enough;
      lifted  <= low_enough;
      over    <= in_p2p_i > cfg_threshold_i;
      gross   <= in_p2p_i > cfg_gross_threshold_i;
      keeps   <= in_p2p_i > cfg_keep_threshold_i;
      moving  <= actuator_moving_i;
      restart <= in_restart_i;
      p2p     <= in_p2p_i;
      id      <= at;
      last    <= in_last_i;
      end_q   <= in_end_i;
    end
    if (rst_i) seen <= 1'b0;
  end

  // 2: the watched channel's state, and the details since the event from which its time is counted.
  typedef enum logic [2:0] {
    None, Contact, Incipient, Gross, Release
  } state_e;
  state_e               state, was, next;
  logic [CountBits-1:0] since, since_next;  // saturates
  logic                 fresh, fresh_next;  // no slip has ended in this contact: the time is since its onset
  logic [TimerBits-1:0] limit;
  logic                 waits, step, mine, slipping, act;
  assign step     = seen && in_ready_o;
  assign mine     = step && id == watch_i;
  assign was      = (restart || mask) ? None : state;
  assign slipping = was == Incipient || was == Gross;
  assign limit    = was != Contact ? cfg_hold_i : fresh ? cfg_blank_i : cfg_refractory_i;
  assign waits    = since < CountBits'(limit);
  assign act      = over && !moving && !mask;
  always_comb begin
    next       = was;
    since_next = waits ? since + 1'b1 : since;
    fresh_next = fresh;
    case (was)
      Contact: begin
        if (lifted) begin
          next       = Release;
          since_next = '0;
        end else if (act && !waits) begin
          next       = gross ? Gross : Incipient;
          since_next = '0;
        end
      end
      Incipient, Gross: begin
        if (lifted) begin
          next       = Release;
          since_next = '0;
        end else if (act || (keeps && !moving && !mask)) begin
          since_next = '0;
          if (act && gross) next = Gross;
        end else if (!waits) begin
          next       = Contact;
          since_next = '0;
          fresh_next = 1'b0;
        end
      end
      default: begin
        if (pressed && !mask) begin
          next       = Contact;
          since_next = '0;
          fresh_next = 1'b1;
        end else if (was == None || !waits) begin
          next = None;
        end
      end
    endcase
  end

  logic                  known, due, due_last, due_end, due_mine, due_over, due_raised;
  state_e                due_state;
  logic [DetailBits-1:0] due_p2p;
  logic [IdBits-1:0]     due_id;
  logic [CountBits-1:0]  ended;   // details since the watched channel's last slip ended, in this contact
  logic                  had;     // there was such a slip
  always_ff @(posedge clk_i) begin
    if (mine) begin
      known <= 1'b1;
      state <= next;
      since <= since_next;
      fresh <= fresh_next;
    end
    if (in_ready_o) begin
      due        <= seen;
      due_mine   <= id == watch_i;
      due_state  <= next;
      due_raised <= (next == Incipient || next == Gross) && !slipping;
      due_over   <= over && !mask;
      due_p2p    <= p2p;
      due_id     <= id;
      due_last   <= last;
      due_end    <= end_q;
    end
    if (mine) begin
      if (slipping && next == Contact) begin
        had   <= 1'b1;
        ended <= '0;
      end else if (was == None || was == Release) had <= 1'b0;
      else if (ended != '1) ended <= ended + 1'b1;
    end
    if (rst_i) begin
      known <= 1'b0;
      due   <= 1'b0;
      had   <= 1'b0;
    end
  end

  always_comb begin
    if (started) begin
      assert (out_valid_o == due && busy_o == (seen || due));
      if (!rst_i) assert (in_ready_o == (out_ready_i || !out_valid_o));
      if (stalled) assert (out_valid_o);
      if (out_valid_o) assert (out_id_o == due_id && out_last_o == due_last && out_end_o == due_end);
      if (out_valid_o) assert (out_p2p_o == due_p2p && out_over_o == due_over);
      if (out_valid_o && due_mine) assert (out_state_o == due_state && out_raised_o == due_raised);
      if (out_valid_o && due_mine) assert (out_state_o <= Release);
      // No slip for `refractory` details after a slip.
      if (mine && was == Contact && had && ended < CountBits'(cfg_refractory_i)) assert (next != Incipient && next != Gross);
    end
  end

  // Invariant.
  localparam int unsigned AgeBits = $clog2(Channels + 2);
  logic [msn_pkg::index_width(Channels > 4 ? Channels - 3 : 1)-1:0] slot;
  logic [AgeBits-1:0]            age;
  logic [3+CountBits:0]          kept;
  logic [2:0]                    kept_state;
  logic                          kept_blanking;
  logic [CountBits-1:0]          kept_timer;
  logic [TimerBits-1:0]          kept_limit;
  assign {kept_state, kept_blanking, kept_timer} = kept;
  assign kept_limit = state != Contact ? cfg_hold_i : fresh ? cfg_blank_i : cfg_refractory_i;
  if (Channels > 4) begin : gen_ring
    owed_delay #(.Depth(Channels), .Width(4 + CountBits)) u_owed (
      .clk_i, .rst_i, .step_i(step), .catch_i(id == watch_i),
      .in_data_i({dut.next_state, dut.next_blanking, dut.next_timer}),
      .out_data_i(dut.u_memory.out_data_o), `OWED_RING(dut.u_memory), .slot_o(slot), .age_o(age), .kept_o(kept)
    );
  end else begin : gen_line
    owed_delay #(.Depth(Channels), .Width(4 + CountBits)) u_owed (
      .clk_i, .rst_i, .step_i(step), .catch_i(id == watch_i),
      .in_data_i({dut.next_state, dut.next_blanking, dut.next_timer}),
      .out_data_i(dut.u_memory.out_data_o), `OWED_LINE(dut.u_memory), .slot_o(slot), .age_o(age), .kept_o(kept)
    );
  end
  logic [IdBits-1:0] next_id;  // of the next step
  assign next_id = seen ? id : at;
  logic early, early_first;
  assign early_first = first || (seen && restart && early);
  always_ff @(posedge clk_i) begin
    if (step && last) early <= 1'b0;
    if (rst_i) early <= 1'b1;
  end
  always_comb begin
    if (started) begin
      assert (dut.seen_valid == seen);
      if (seen) begin
        assert (dut.pressed == (pressed && !mask) && dut.lifted == lifted && dut.over == (over && !mask));
        assert (dut.kept == ((over || keeps) && !mask));
        assert (dut.gross == gross && dut.moving == moving && dut.restart == (restart || mask));
        assert (dut.seen_p2p == p2p && dut.seen_id == id && dut.seen_last == last && dut.seen_end == end_q);
        assert (32'(id) < Channels && last == (32'(id) == Channels - 1));
        assert (at == (last ? '0 : id + 1'b1));
        if (!last) assert (again == restart);
        if (early) assert (restart && first == !last);
        else assert (!first);
      end else assert (early == first);
      assert (dut.load_hold == -CountBits'(cfg_hold_i) && dut.load_blank == -CountBits'(cfg_blank_i));
      assert (dut.load_refractory == -CountBits'(cfg_refractory_i));
      assert ((age != '0) == known);
      if (!known) assert (early && next_id <= watch_i);
      if (known && early) assert (next_id > watch_i);
      if (known) begin
        assert (32'(age) == ((next_id > watch_i) ? 32'(next_id) - 32'(watch_i)
                             : Channels + 32'(next_id) - 32'(watch_i)));
        assert (kept_state == state && state <= Release);
        if (state != None) begin
          assert (since <= CountBits'(kept_limit));
          assert (kept_timer == since - CountBits'(kept_limit));
        end
        if (state == Contact) assert (kept_blanking == fresh);
        if (had && state == Contact) assert (!fresh && (since == ended || since == CountBits'(cfg_refractory_i)));
        if (had && state == Contact) assert (ended >= since);
        if (state == Contact && !fresh) assert (had);
      end
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      if (Channels < 16) cover (out_valid_o && due_mine && out_raised_o && out_state_o == Gross);
      if (Channels < 16) cover (out_valid_o && due_mine && out_state_o == Release);
      cover (mine && next == Contact);
    end
  end

endmodule
