// SPDX-License-Identifier: Apache-2.0
//
// Finds taxels that cannot be trusted and masks them in out_mask_o from the next frame on.
//
//   moved = |raw - held| > band, then held = raw      recent = moved in the last 3 frames, up or down
//   dead      not recent itself while both neighbours in its row or column are recent in the same direction: counts
//             +4 a frame (with use_edges +1 at a border whose one neighbour is recent); dead at still
//   railed    at or beyond low, high or (use_user) over-range without a break over rail of frames 0, 16 ..
//   blinking  a step > jump while no neighbour is recent: +16, any other frame -1; blinking at blink
//
// A threshold of 0 turns a kind off. Faults stay until clear or reset. Each new one is an event; if it is not
// taken, it is offered again in the next frame; report sends all again. Beats as msn_frame_marker gives them;
// one that does not fit is masked, because in too long a frame its taxels' states were written by the same frame.
//
//   clock  1       2 .. 4            5       6
//          sample  msn_health_taxel  events  write
//
// This block has the frames, tables and neighbours. Latency 1 clock; a beat a clock, 9 clocks between frames.
// Error: none.
// Model: model/meissner/twins/frontend/health.py

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

  input  msn_registers_pkg::health_cfg_t    cfg_i,
  output msn_registers_pkg::health_status_t status_o,      // taxels, since reset or clear

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic [Lanes*SampleBits-1:0]  in_data_i,     // signed
  input  logic [Lanes-1:0]             in_user_i,     // over-range
  input  logic [IdBits-1:0]            in_id_i,       // its place
  input  logic                         in_fits_i,
  input  logic                         in_row_last_i,
  input  logic                         in_last_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic [Lanes*SampleBits-1:0]  out_data_o,
  output logic [Lanes-1:0]             out_mask_o,
  output logic [IdBits-1:0]            out_id_o,
  output logic                         out_fits_o,
  output logic                         out_row_last_o,
  output logic                         out_last_o,

  output logic                         event_valid_o, // all faults of one beat's taxels
  input  logic                         event_ready_i,
  output logic [IdBits-1:0]            event_id_o,
  output logic [Lanes-1:0]             event_dead_o,
  output logic [Lanes-1:0]             event_railed_o,
  output logic [Lanes-1:0]             event_blinking_o
);

  localparam int unsigned StateBits = SampleBits + 32;

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_health: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_health: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_health: Lanes = %0d must lie in 1 .. 8", Lanes);
  end
  if (SampleBits < 2 || SampleBits > 18) begin : gen_check_sample_bits
    $fatal(1, "msn_health: SampleBits = %0d must lie in 2 .. 18", SampleBits);
  end

  // Frames. After a frame the next one waits until this one's states are all written and the first are read again.
  localparam int unsigned Drain = 6;
  logic accept, was_whole, midway, restart, done, due, head_valid;
  logic closed;  // due || drain != '0, registered a clock ahead, for timing
  logic [2:0] drain, drain_next;  // clocks until all of a frame is written
  assign in_ready_o = (out_ready_i || !out_valid_o) && head_valid && !closed;
  assign accept     = in_valid_i && in_ready_o;
  assign restart    = rst_i || drain != '0;  // a clock after the last beat: accept is known late
  assign done       = drain == 3'd1;

  // fresh: this frame only writes initial states. again: no fault counts as reported. bank: the moves of the
  // last undamaged frame. tick: 0 in every 16th undamaged frame.
  logic clear_asked, report_asked, clear_next, report_next, midway_next;
  logic fresh, again, bank, bank_next;
  logic [3:0] tick;
  assign bank_next   = bank ^ (done && was_whole);
  assign due         = !midway && (clear_asked || report_asked);
  assign clear_next  = (cfg_i.clear || clear_asked) && !(due && clear_asked);  // high for long: frames go on
  assign report_next = (cfg_i.report || report_asked) && !(due && report_asked);
  assign midway_next = accept || (midway && !done);
  assign drain_next  = (accept && in_last_i) ? 3'(Drain) : (drain != '0) ? drain - 1'b1 : '0;
  always_ff @(posedge clk_i) begin
    midway <= midway_next;
    closed <= ((clear_next || report_next) && !midway_next) || drain_next != '0;
    if (accept) was_whole <= in_last_i && in_fits_i;
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

  // Read ahead: the taxels' states, and their neighbours' moves up to the last undamaged frame.
  logic                       advance, state_valid, mid_valid, unused_up_valid, unused_down_valid;
  logic                       unused_states_end, unused_up_end, unused_row_end, unused_down_end;
  logic [Lanes*StateBits-1:0] state_ahead, state_head, write_state;
  logic [2*Lanes-1:0]         up_ahead, up_head, down_ahead, down_head, ahead, here, write_moves;
  logic [1:0]                  behind;  // moves of the last lane of the beat before
  logic                       write;
  logic [IdBits-1:0]          write_place;
  logic [3:0]                 spoilt, spoilt_head;  // row, down, up, states
  assign advance = accept || !head_valid;

  msn_frame_table #(.Words(Beats), .Parts(1), .PartBits(Lanes * StateBits), .Banks(1)) u_states (
    .clk_i, .restart_i(restart), .bank_i(1'b0), .advance_i(advance),
    .out_valid_o(state_valid), .out_data_o(state_ahead), .out_spoilt_o(spoilt[0]),
    .at_end_o(unused_states_end),
    .write_i(write), .write_bank_i(1'b0), .write_word_i(write_place), .write_data_i(write_state)
  );
  msn_frame_table #(.Words(Beats), .PartBits(2 * Lanes), .Start((Rows - 1) * RowBeats)) u_up (
    .clk_i, .restart_i(restart), .bank_i(bank_next), .advance_i(advance),
    .out_valid_o(unused_up_valid), .out_data_o(up_ahead), .out_spoilt_o(spoilt[1]),
    .at_end_o(unused_up_end),
    .write_i(write), .write_bank_i(!bank), .write_word_i(write_place), .write_data_i(write_moves)
  );
  msn_frame_table #(.Words(Beats), .PartBits(2 * Lanes)) u_row (
    .clk_i, .restart_i(restart), .bank_i(bank_next), .advance_i(advance),
    .out_valid_o(mid_valid), .out_data_o(ahead), .out_spoilt_o(spoilt[3]),
    .at_end_o(unused_row_end),
    .write_i(write), .write_bank_i(!bank), .write_word_i(write_place), .write_data_i(write_moves)
  );
  msn_frame_table #(.Words(Beats), .PartBits(2 * Lanes), .Start(Rows > 1 ? RowBeats : 0)) u_down (
    .clk_i, .restart_i(restart), .bank_i(bank_next), .advance_i(advance),
    .out_valid_o(unused_down_valid), .out_data_o(down_ahead), .out_spoilt_o(spoilt[2]),
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
      spoilt_head <= spoilt;
    end
    if (restart) head_valid <= 1'b0;
  end

  // A word that was written as it was read is undefined. A frame that only writes initial states may take one (a reset
  // of one clock changes the bank), and so may a beat that does not fit: they use none. The row's next word is a
  // neighbour, but not of the row's last beat.
  logic used;
  assign used = accept && in_fits_i && !fresh;
  msn_check u_words_are_defined (
    .clk_i, .rst_i, .wrong_i(!rst_i && used && (spoilt_head != '0 || (spoilt[3] && !in_row_last_i)))
  );

  // Which borders of the array the next beat touches.
  logic row_first, top, bottom;

  // The states' update follows the sample's register in a pipeline that never stalls.
  logic [4:1]              learn;
  logic [4:1][IdBits-1:0]  learn_place;
  logic [Lanes-1:0]        event_of, dead, railed, blinking, dead_new, railed_new, blinking_new;
  logic [CountBits-1:0]    dead_count, railed_count, blinking_count;
  logic                    send;
  assign status_o = {21'(dead_count), 21'(railed_count), 21'(blinking_count)};
  assign send = learn[4] && |event_of && (!event_valid_o || event_ready_i);

  always_ff @(posedge clk_i) begin
    if (accept) begin
      row_first <= in_last_i || in_row_last_i;
      top       <= in_last_i || (top && !in_row_last_i);
      bottom    <= Rows == 1 || (!in_last_i && (bottom || in_id_i == IdBits'(Beats - RowBeats - 1)));
    end
    if (out_ready_i || !out_valid_o) begin
      out_valid_o    <= accept;
      out_data_o     <= in_data_i;
      out_id_o       <= in_id_i;
      out_fits_o     <= in_fits_i;
      out_row_last_o <= in_row_last_i;
      out_last_o     <= in_last_i;
    end
    learn       <= {learn[3:1], accept && in_fits_i};
    learn_place <= {learn_place[3:1], in_id_i};
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
      dead_count     <= dead_count + CountBits'($countones(dead_new));
      railed_count   <= railed_count + CountBits'($countones(railed_new));
      blinking_count <= blinking_count + CountBits'($countones(blinking_new));
    end
    if (rst_i || (due && clear_asked)) {dead_count, railed_count, blinking_count} <= '0;
    if (rst_i) begin
      row_first     <= 1'b1;
      top           <= 1'b1;
      bottom        <= Rows == 1;
      out_valid_o   <= 1'b0;
      event_valid_o <= 1'b0;
      learn         <= '0;
      write         <= 1'b0;
    end
  end

  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    // For each neighbour: does it exist, is its move recent, and was that upwards?
    logic has_left, has_right, has_up, has_down;
    logic [1:0] left, right, up, down;
    assign has_left = k > 0 || !row_first;
    assign has_up   = !top;
    assign has_down = !bottom;
    if (k > 0) begin : gen_left
      assign left = {2{!fresh}} & here[2*k-1-:2];
    end else begin : gen_left_outside
      assign left = {2{has_left && !fresh}} & behind;
    end
    if (k < Lanes - 1) begin : gen_inside
      assign has_right = (RowBeats - 1) * Lanes + k + 1 < Columns || !in_row_last_i;
      assign right     = {2{has_right && !fresh}} & here[2*(k+1)+:2];
    end else begin : gen_outside
      assign has_right = !in_row_last_i;
      assign right     = {2{has_right && !fresh}} & ahead[1:0];
    end
    assign up   = {2{has_up && !fresh}} & up_head[2*k+:2];
    assign down = {2{has_down && !fresh}} & down_head[2*k+:2];

    logic pair, border;
    assign pair   = (left[1] && right[1] && left[0] == right[0]) || (up[1] && down[1] && up[0] == down[0]);
    assign border = ((has_left != has_right) && (left[1] || right[1])) ||
                    ((has_up != has_down) && (up[1] || down[1]));

    logic                         surplus;
    logic [StateBits-1:0]         head;
    logic signed [SampleBits-1:0] raw;
    assign raw     = signed'(out_data_o[k*SampleBits+:SampleBits]);
    assign surplus = in_row_last_i && (RowBeats - 1) * Lanes + k >= Columns;
    assign head    = state_head[k*StateBits+:StateBits];
    always_ff @(posedge clk_i) begin
      if (out_ready_i || !out_valid_o) out_mask_o[k] <= (|head[3:1] && !fresh) || !in_fits_i;
    end

    msn_health_taxel #(.SampleBits(SampleBits)) u_taxel (
      .clk_i,
      .cfg_i,
      .take_i(accept), .state_i(head), .pair_i(pair), .border_i(border && cfg_i.use_edges),
      .alone_i(!(left[1] || right[1] || up[1] || down[1])), .user_i(in_user_i[k]),
      .surplus_i(surplus), .again_i(again),
      .raw_i(raw), .tick_i(tick == '0), .fresh_i(fresh),
      .event_o(event_of[k]), .faults_o({dead[k], railed[k], blinking[k]}),
      .news_o({dead_new[k], railed_new[k], blinking_new[k]}),
      .send_i(send), .state_o(write_state[k*StateBits+:StateBits]), .moves_o(write_moves[2*k+:2])
    );
  end

endmodule
