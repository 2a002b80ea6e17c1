// SPDX-License-Identifier: Apache-2.0
//
// Finds taxels that cannot be trusted and marks them, from the next frame on, in out_mask_o.
//
//   moved = |raw - held| > band, then held = raw      recent = moved in the last 3 frames, up or down
//   dead      no move of its own while both neighbours in its row or column are recent the same way:
//             +4 a frame (+1 with cfg_edges_i beside the one neighbour at a border), from cfg_still on
//   railed    at cfg_low, at cfg_high or (cfg_user_i) over-range, without a break in cfg_rail of frames 0, 16 ..
//   blinking  a step > jump while no neighbour is recent: +16, any other frame -1, from cfg_blink on
//
// A threshold of 0 turns a kind off. Faults stay until cfg_clear_i or reset. Each new one is an event; one that
// nobody takes is offered again in the next frame; cfg_report_i sends them all again. A beat out of place is
// masked: round again in a frame too long, its taxels' states would be those this frame has written.
//
//   clock  1       2           3            4         5       6
//          sample  raw - held  moved, jump  counters  events  write
//
// Latency 1 clock; a beat a clock, 9 clocks between frames.   Model: model/meissner/twins/frontend/health.py

module msn_health #(
  parameter  int unsigned Rows       = 64,
  parameter  int unsigned Columns    = 64,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned SampleBits = 17,
  localparam int unsigned RowBeats   = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned Beats      = Rows * RowBeats,
  localparam int unsigned IdBits     = msn_pkg::index_width(Beats),
  localparam int unsigned CountBits  = msn_pkg::index_width(Rows * Columns + 1)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic [SampleBits-1:0]        cfg_band_i,    // codes, unsigned
  input  logic [SampleBits-1:0]        cfg_jump_i,    // not less than the band
  input  logic signed [SampleBits-1:0] cfg_low_i,
  input  logic signed [SampleBits-1:0] cfg_high_i,
  input  logic                         cfg_user_i,
  input  logic                         cfg_edges_i,
  input  logic [7:0]                   cfg_still_i,
  input  logic [7:0]                   cfg_rail_i,
  input  logic [7:0]                   cfg_blink_i,
  input  logic                         cfg_clear_i,
  input  logic                         cfg_report_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic [Lanes*SampleBits-1:0]  in_data_i,     // signed
  input  logic [Lanes-1:0]             in_user_i,     // over-range
  input  logic [IdBits-1:0]            in_id_i,
  input  logic                         in_last_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic [Lanes*SampleBits-1:0]  out_data_o,
  output logic [Lanes-1:0]             out_mask_o,
  output logic [IdBits-1:0]            out_id_o,
  output logic                         out_last_o,

  output logic                         event_valid_o, // all faults of one beat's taxels
  input  logic                         event_ready_i,
  output logic [IdBits-1:0]            event_id_o,
  output logic [Lanes-1:0]             event_dead_o,
  output logic [Lanes-1:0]             event_railed_o,
  output logic [Lanes-1:0]             event_blinking_o,

  output logic [CountBits-1:0]         dead_o,        // taxels, since reset or clear
  output logic [CountBits-1:0]         railed_o,
  output logic [CountBits-1:0]         blinking_o,
  output logic [31:0]                  damaged_o
);

  localparam int unsigned StateBits = SampleBits + 32;
  localparam int unsigned DiffBits  = SampleBits + 1;
  localparam int unsigned RowBits   = msn_pkg::index_width(Rows);
  localparam int unsigned BeatBits  = msn_pkg::index_width(RowBeats);

  if (Rows < 1 || Rows > 1024) begin : gen_check_rows
    $fatal(1, "msn_health: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (Columns < 1 || Columns > 1024) begin : gen_check_columns
    $fatal(1, "msn_health: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (Lanes != 1 && Lanes != 2 && Lanes != 4 && Lanes != 8) begin : gen_check_lanes
    $fatal(1, "msn_health: Lanes = %0d must be 1, 2, 4 or 8", Lanes);
  end
  if (SampleBits < 2 || SampleBits > 18) begin : gen_check_sample_bits
    $fatal(1, "msn_health: SampleBits = %0d must lie in 2 .. 18", SampleBits);
  end

  // Frames. At each end the next waits until all of this one is written and its first words are read again.
  localparam int unsigned Drain = 6;
  logic accept, keep, last, fits, whole, was_whole, midway, restart, done, due, head_valid;
  logic closed;  // due || drain != '0, found a clock ahead: the memories are far
  logic [2:0]        drain, drain_next;  // clocks until all of a frame is written
  logic [IdBits-1:0] place;
  assign in_ready_o = (out_ready_i || !out_valid_o) && head_valid && !closed;
  assign accept     = in_valid_i && in_ready_o;
  assign restart    = rst_i || drain != '0;  // a clock after the last beat: who takes that is known late
  assign done       = drain == 3'd1;

  msn_frame_place #(.Beats(Beats)) u_place (
    .clk_i, .rst_i,
    .accept_i(accept),
    .in_id_i, .in_last_i,
    .place_o(place), .keep_o(keep), .last_o(last), .fits_o(fits), .whole_o(whole), .damaged_o
  );

  // fresh: this frame only writes first states. again: nothing counts as reported. bank: the last whole
  // frame's moves. tick: every 16th whole frame.
  logic clear_asked, report_asked, clear_next, report_next, midway_next;
  logic fresh, again, bank, bank_next;
  logic [3:0] tick;
  assign bank_next   = bank ^ (done && was_whole);
  assign due         = !midway && (clear_asked || report_asked);
  assign clear_next  = (cfg_clear_i || clear_asked) && !(due && clear_asked);  // held high, it blocks nothing
  assign report_next = (cfg_report_i || report_asked) && !(due && report_asked);
  assign midway_next = accept || (midway && !done);
  assign drain_next  = (accept && in_last_i) ? 3'(Drain) : (drain != '0) ? drain - 1'b1 : '0;
  always_ff @(posedge clk_i) begin
    midway <= midway_next;
    closed <= ((clear_next || report_next) && !midway_next) || drain_next != '0;
    if (accept) was_whole <= whole;
    drain  <= drain_next;
    clear_asked  <= clear_next;
    report_asked <= report_next;
    if (due) begin
      fresh <= fresh || clear_asked;
      again <= again || report_asked;
    end
    bank <= bank_next;
    if (done && was_whole) begin
      {fresh, again} <= '0;
      tick           <= tick + 1'b1;
    end
    if (rst_i) begin
      {midway, closed, clear_asked, report_asked, again, bank} <= '0;
      drain <= '0;
      tick  <= '0;
      fresh <= 1'b1;
    end
  end

  // Read ahead: the taxels' states, and how those around them moved up to the last whole frame.
  logic                       advance, state_valid, mid_valid, unused_up_valid, unused_down_valid;
  logic                       unused_states_end, unused_up_end, unused_row_end, unused_down_end;
  logic [Lanes*StateBits-1:0] state_ahead, state_head, write_state;
  logic [2*Lanes-1:0]         up_ahead, up_head, down_ahead, down_head, ahead, here, write_moves;
  logic [1:0]                  behind;  // of the last lane
  logic                       write;
  logic [IdBits-1:0]          write_place;
  assign advance = accept || !head_valid;

  msn_frame_table #(.Words(Beats), .Parts(1), .PartBits(Lanes * StateBits), .Banks(1)) u_states (
    .clk_i, .restart_i(restart), .bank_i(1'b0), .advance_i(advance),
    .out_valid_o(state_valid), .out_data_o(state_ahead),
    .at_end_o(unused_states_end),
    .write_i(write), .write_bank_i(1'b0), .write_word_i(write_place), .write_data_i(write_state)
  );
  msn_frame_table #(.Words(Beats), .PartBits(2 * Lanes), .Start((Rows - 1) * RowBeats)) u_up (
    .clk_i, .restart_i(restart), .bank_i(bank_next), .advance_i(advance),
    .out_valid_o(unused_up_valid), .out_data_o(up_ahead),
    .at_end_o(unused_up_end),
    .write_i(write), .write_bank_i(!bank), .write_word_i(write_place), .write_data_i(write_moves)
  );
  msn_frame_table #(.Words(Beats), .PartBits(2 * Lanes)) u_row (
    .clk_i, .restart_i(restart), .bank_i(bank_next), .advance_i(advance),
    .out_valid_o(mid_valid), .out_data_o(ahead),
    .at_end_o(unused_row_end),
    .write_i(write), .write_bank_i(!bank), .write_word_i(write_place), .write_data_i(write_moves)
  );
  msn_frame_table #(.Words(Beats), .PartBits(2 * Lanes), .Start(Rows > 1 ? RowBeats : 0)) u_down (
    .clk_i, .restart_i(restart), .bank_i(bank_next), .advance_i(advance),
    .out_valid_o(unused_down_valid), .out_data_o(down_ahead),
    .at_end_o(unused_down_end),
    .write_i(write), .write_bank_i(!bank), .write_word_i(write_place), .write_data_i(write_moves)
  );

  always_ff @(posedge clk_i) begin
    if (advance) begin
      head_valid <= state_valid && mid_valid;
      state_head <= state_ahead;
      up_head    <= up_ahead;
      down_head  <= down_ahead;
      here       <= ahead;
      behind     <= here[2*Lanes-1-:2];
    end
    if (restart) head_valid <= 1'b0;
  end

  // Place in the array.
  logic [BeatBits-1:0] beat;
  logic [RowBits-1:0]  row;
  logic                row_begin, row_end;
  assign row_begin = beat == '0;
  assign row_end   = beat == BeatBits'(RowBeats - 1);

  // What is learnt follows behind the sample's own register, stalled by nothing.
  logic [4:1]              learn;
  logic [4:1][IdBits-1:0]  learn_place;
  logic [Lanes-1:0]        loud, dead, railed, blinking, dead_new, railed_new, blinking_new;
  logic                    send;
  assign send = learn[4] && |loud && (!event_valid_o || event_ready_i);

  always_ff @(posedge clk_i) begin
    if (accept) begin
      beat <= in_last_i || row_end ? '0 : beat + 1'b1;
      row  <= in_last_i ? '0 : row + RowBits'(row_end);
    end
    if (out_ready_i || !out_valid_o) begin
      out_valid_o <= accept && keep;
      out_data_o  <= in_data_i;
      out_id_o    <= in_id_i;
      out_last_o  <= last;
    end
    learn       <= {learn[3:1], accept && fits};
    learn_place <= {learn_place[3:1], place};
    write       <= learn[4];
    write_place <= learn_place[4];

    if (event_ready_i || !event_valid_o) begin
      event_valid_o    <= send;
      event_id_o       <= learn_place[4];
      event_dead_o     <= dead;
      event_railed_o   <= railed;
      event_blinking_o <= blinking;
    end
    if (learn[4]) begin
      dead_o     <= dead_o + CountBits'($countones(dead_new));
      railed_o   <= railed_o + CountBits'($countones(railed_new));
      blinking_o <= blinking_o + CountBits'($countones(blinking_new));
    end
    if (rst_i || (due && clear_asked)) {dead_o, railed_o, blinking_o} <= '0;
    if (rst_i) begin
      beat          <= '0;
      row           <= '0;
      out_valid_o   <= 1'b0;
      event_valid_o <= 1'b0;
      learn         <= '0;
      write         <= 1'b0;
    end
  end

  // Thresholds less what a counter may grow by.
  logic signed [9:0] still_less_1, still_less_4, blink_edge;
  logic [7:0]        rail_edge;
  always_ff @(posedge clk_i) begin
    still_less_1 <= signed'({2'b0, cfg_still_i}) - 10'sd1;
    still_less_4 <= signed'({2'b0, cfg_still_i}) - 10'sd4;
    blink_edge   <= signed'({2'b0, cfg_blink_i}) - 10'sd16;
    rail_edge    <= cfg_rail_i - 8'd1;
  end

  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    // Neighbours: does one exist, has it moved of late, and upwards?
    logic has_left, has_right, has_up, has_down;
    logic [1:0] left, right, up, down;
    assign has_left = k > 0 || !row_begin;
    assign has_up   = row != '0;
    assign has_down = row != RowBits'(Rows - 1);
    if (k > 0) begin : gen_left
      assign left = {2{!fresh}} & here[2*k-1-:2];
    end else begin : gen_left_outside
      assign left = {2{has_left && !fresh}} & behind;
    end
    if (k < Lanes - 1) begin : gen_inside
      assign has_right = (RowBeats - 1) * Lanes + k + 1 < Columns || !row_end;
      assign right     = {2{has_right && !fresh}} & here[2*(k+1)+:2];
    end else begin : gen_outside
      assign has_right = !row_end;
      assign right     = {2{has_right && !fresh}} & ahead[1:0];
    end
    assign up   = {2{has_up && !fresh}} & up_head[2*k+:2];
    assign down = {2{has_down && !fresh}} & down_head[2*k+:2];

    logic pair, border;
    assign pair   = (left[1] && right[1] && left[0] == right[0]) || (up[1] && down[1] && up[0] == down[0]);
    assign border = ((has_left != has_right) && (left[1] || right[1])) ||
                    ((has_up != has_down) && (up[1] || down[1]));

    // State: held sample, three counters, frames since a move, its direction, a jump in the last frame,
    // the faults, and whether they were reported.
    logic [StateBits-1:0]         head;
    logic signed [SampleBits-1:0] held, raw;
    logic [28:0]                  kept_1, kept_2, kept_3;
    logic [2:0]                   faults_head;
    logic                         reported_head;
    assign head          = state_head[k*StateBits+:StateBits];
    assign reported_head = head[0];
    assign faults_head   = head[3:1];
    assign raw           = signed'(out_data_o[k*SampleBits+:SampleBits]);

    logic [2:0]                 fault_1, fault_2, fault_3;
    logic                       surplus, surplus_2, surplus_3, user_1, pair_1, border_1, lonely_1, low, high;
    logic signed [DiffBits-1:0] delta;
    logic [SampleBits-1:0]      raw_2, raw_3, held_2, held_3;
    logic                       over_2, over_3, lonely_2, lonely_3;
    logic [2:0]                 proof_2, proof_3;
    msn_compare #(.Width(SampleBits)) u_low  (.a_i(raw), .b_i(cfg_low_i), .greater_o(low));
    msn_compare #(.Width(SampleBits)) u_high (.a_i(cfg_high_i), .b_i(raw), .greater_o(high));

    logic above, below, far_above, far_below, moved, jump, rises;
    logic signed [DiffBits-1:0] band_minus, jump_minus;
    msn_compare #(.Width(DiffBits)) u_above (
      .a_i(delta), .b_i(signed'({1'b0, cfg_band_i})), .greater_o(above)
    );
    msn_compare #(.Width(DiffBits)) u_below (.a_i(band_minus), .b_i(delta), .greater_o(below));
    msn_compare #(.Width(DiffBits)) u_far_above (
      .a_i(delta), .b_i(signed'({1'b0, cfg_jump_i})), .greater_o(far_above)
    );
    msn_compare #(.Width(DiffBits)) u_far_below (.a_i(jump_minus), .b_i(delta), .greater_o(far_below));

    // 4: the next state.
    logic [7:0] rail, blink, still, rail_next, blink_next, still_next;
    logic [7:0] rail_more;
    logic [8:0] blink_more, still_more;
    logic       more_blinks;
    logic [1:0] since, since_next;
    logic       up_last, jumped, up_next, reported;
    logic [2:0] faults, found, faults_next;
    assign {rail, blink, still, since, up_last, jumped} = {kept_3[28:1]};
    assign faults     = fault_3;
    assign reported   = kept_3[0];
    assign rail_more  = rail + 8'(tick == '0 && rail != '1);
    assign rail_next  = !over_3 ? '0 : rail_more;
    assign blink_more = {1'b0, blink} + 9'd16;
    assign more_blinks = jumped && lonely_3;
    assign blink_next = more_blinks ? blink_more[7:0] | {8{blink_more[8]}} : blink - 8'(blink != '0);
    assign still_more = {1'b0, still} + 9'(proof_3);
    assign still_next = moved || since != '0 ? '0 : still_more[7:0] | {8{still_more[8]}};
    assign since_next = moved ? 2'd3 : since - 2'(since != '0);
    assign up_next    = moved ? rises : up_last;
    // Are still_next, rail_next, blink_next as high? What they grow by is taken off the other side.
    logic signed [9:0] still_edge;
    assign still_edge = proof_3[2] ? still_less_4 : proof_3[0] ? still_less_1 : signed'({2'b0, cfg_still_i});
    assign found      = {signed'({2'b0, still}) >= still_edge && !moved && since == '0 && cfg_still_i != '0,
                         (rail >= cfg_rail_i || (tick == '0 && rail == rail_edge)) && over_3
                         && cfg_rail_i != '0,
                         (more_blinks ? signed'({2'b0, blink}) >= blink_edge : blink > cfg_blink_i)
                         && cfg_blink_i != '0};
    assign faults_next = surplus_3 || fresh ? '0 : faults | found;

    logic [StateBits-1:4] state_4;
    logic [1:0]           moves_4;
    logic [2:0]           faults_4, news_4;
    logic                 known_4, reported_4;
    assign reported_4 = known_4 && news_4 == '0;  // where there are faults; else it does not matter
    assign loud[k]    = |faults_4 && !reported_4;
    assign {dead[k], railed[k], blinking[k]}             = faults_4;
    assign {dead_new[k], railed_new[k], blinking_new[k]} = news_4;

    always_ff @(posedge clk_i) begin
      if (out_ready_i || !out_valid_o) out_mask_o[k] <= (|faults_head && !fresh) || !fits;
      if (accept) begin
        held     <= signed'(head[StateBits-1-:SampleBits]);
        kept_1   <= {head[31:4], reported_head && !again};
        fault_1  <= faults_head;
        surplus  <= row_end && (RowBeats - 1) * Lanes + k >= Columns;
        user_1   <= in_user_i[k];
        pair_1   <= pair;
        border_1 <= border && cfg_edges_i;
        lonely_1 <= !(left[1] || right[1] || up[1] || down[1]);
      end
      band_minus <= '0 - DiffBits'(cfg_band_i);
      jump_minus <= '0 - DiffBits'(cfg_jump_i);

      delta          <= DiffBits'(raw) - DiffBits'(held);
      raw_2          <= raw;
      held_2         <= held;
      over_2         <= !low || !high || (user_1 && cfg_user_i);
      lonely_2 <= lonely_1;
      proof_2        <= pair_1 ? 3'd4 : 3'(border_1);
      {kept_2, fault_2, surplus_2} <= {kept_1, fault_1, surplus};

      moved          <= above || below;
      jump           <= far_above || far_below;
      rises          <= !delta[DiffBits-1];
      raw_3          <= raw_2;
      held_3         <= held_2;
      over_3         <= over_2;
      lonely_3 <= lonely_2;
      proof_3        <= proof_2;
      {kept_3, fault_3, surplus_3} <= {kept_2, fault_2, surplus_2};

      faults_4   <= faults_next;
      news_4     <= faults_next & ~faults;
      known_4    <= reported;
      moves_4    <= {since_next != '0 && !fresh, up_next};
      state_4    <= fresh ? {raw_3, 28'd0} :
                    {moved ? raw_3 : held_3, rail_next, blink_next, still_next, since_next, up_next, jump};

      write_state[k*StateBits+:StateBits] <= {state_4, faults_4, |faults_4 && (reported_4 || send)};
      write_moves[2*k+:2]                 <= moves_4;
    end
  end

endmodule
