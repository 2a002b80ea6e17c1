// SPDX-License-Identifier: Apache-2.0
//
// Buffers a frame of beats and sends it on row-major, completely or not at all.
//
// A frame arrives row by row, or (in_interleave_i) rows 0, 2, 4 .., then 1, 3, 5 ..; each beat leaves as soon as it
// and all before it are present. If a beat of a frame is still here a clock before the next frame's first beat, the
// next frame is dropped entirely (dropped_o). Depth below Rows*Beats: natural order only, and the sender must stop
// when room_o is low: Ahead conversions of Burst beats still fit then.
// A frame with a missing beat would never end: the next frame replaces it, and it leaves without its last beat.
// Extra beats are dropped.
//
// Latency 3 clocks from in_valid_i to out_valid_o, a beat a clock.   Model: model/meissner/twins/frontend/scan_buffer.py

module msn_scan_buffer #(
  parameter  int unsigned Rows   = 16,
  parameter  int unsigned Beats  = 16,  // of a row
  parameter  int unsigned Burst  = 8,
  parameter  int unsigned Width  = 18,
  parameter  int unsigned Depth  = Rows * Beats,
  parameter  int unsigned Ahead  = 2,
  localparam int unsigned IdBits = msn_pkg::index_width(Rows * Beats)
) (
  input  logic              clk_i,
  input  logic              rst_i,

  input  logic              in_valid_i,
  input  logic              in_first_i,       // a frame's first beat
  input  logic              in_interleave_i,  // with it: the frame's order
  input  logic [Width-1:0]  in_data_i,
  output logic              room_o,

  output logic              out_valid_o,
  input  logic              out_ready_i,
  output logic [Width-1:0]  out_data_o,
  output logic [IdBits-1:0] out_id_o,
  output logic              out_last_o,

  output logic              taken_o,          // the frame whose first beat arrives in this clock will be sent
  output logic [31:0]       dropped_o
);

  localparam int unsigned RowBits     = msn_pkg::index_width(Rows);
  localparam int unsigned BeatBits    = msn_pkg::index_width(Beats);
  localparam int unsigned AddressBits = msn_pkg::index_width(Depth);
  localparam bit          Sorts       = Depth >= Rows * Beats;
  localparam int unsigned EvenRows    = (Rows + 1) / 2;  // they arrive first in an interleaved frame

  if (Rows < 1 || Beats < 1) begin : gen_check_size
    $fatal(1, "msn_scan_buffer: Rows = %0d and Beats must be at least 1", Rows);
  end
  if (Width < 1) begin : gen_check_width
    $fatal(1, "msn_scan_buffer: Width = %0d must be at least 1", Width);
  end
  if (!Sorts && (Depth < 4 * Burst || !msn_pkg::is_power(Depth))) begin : gen_check_depth
    $fatal(1, "msn_scan_buffer: Depth = %0d must hold a frame, or be 2^n of 4 bursts or more", Depth);
  end

  // The writer: beats stored of the present row, and rows stored.
  logic                   busy;  // a clock ago the frame was here and a beat had not left; for timing
  logic                   whole, whole_q;  // the complete frame has come
  logic                   store, row_full, interleave, interleave_q, drop_q, turned_away;
  logic [BeatBits-1:0]    in_beat_q, in_beat;
  logic [RowBits:0]       in_rows_q, in_rows;
  logic [AddressBits-1:0] in_address_q, in_address;
  assign taken_o    = in_valid_i && in_first_i && !busy;
  assign store      = in_valid_i && (in_first_i ? !busy : !drop_q);
  assign in_beat    = in_first_i ? '0 : in_beat_q;
  assign in_rows    = in_first_i ? '0 : in_rows_q;
  assign in_address = in_first_i ? '0 : in_address_q;
  assign interleave = Sorts && (in_first_i ? in_interleave_i : interleave_q);
  assign row_full   = in_beat == BeatBits'(Beats - 1);
  assign whole      = store ? row_full && in_rows == (RowBits+1)'(Rows - 1) : whole_q;

  always_ff @(posedge clk_i) begin
    whole_q <= whole;
    if (store) begin
      in_beat_q <= row_full ? '0 : in_beat + 1'b1;
      in_rows_q <= in_rows + (RowBits+1)'(row_full);
      // Registered a beat ahead (timing: the memory's blocks are placed far apart).
      if (!row_full || !interleave)                   in_address_q <= in_address + 1'b1;
      else if (in_rows == (RowBits+1)'(EvenRows - 1)) in_address_q <= AddressBits'(Beats);
      else                                            in_address_q <= in_address + AddressBits'(Beats + 1);
    end
    drop_q <= whole || (in_valid_i && in_first_i ? busy : drop_q);
    if (taken_o) interleave_q <= interleave;
    turned_away <= in_valid_i && in_first_i && busy;
    dropped_o   <= dropped_o + 32'(turned_away);
    if (rst_i) begin
      drop_q      <= 1'b1;
      turned_away <= 1'b0;
      dropped_o   <= '0;
    end
  end

  // The reader. place_q: how many rows arrive before the row being read; follower_q: before the row after it.
  logic                open_q, step, row_read, all_read;
  logic                ahead_q;  // the beat to be read is present; computed a clock ahead
  logic [RowBits:0]    place_q, follower_q;
  logic [BeatBits-1:0] beat_q;
  logic [IdBits-1:0]   id_q;
  logic                move, read_valid_q, read_last_q;
  logic [IdBits-1:0]   read_id_q;
  assign move     = out_ready_i || !out_valid_o;
  assign step     = open_q && ahead_q && move;
  assign row_read = beat_q == BeatBits'(Beats - 1);
  assign all_read = id_q == IdBits'(Rows * Beats - 1);

  // In the writer's row the reader never passes the writer: a beat is present unless it is the next to be stored.
  logic stay_there, next_there, row_there;
  assign stay_there = place_q < in_rows_q || (place_q == in_rows_q && (store || beat_q != in_beat_q));
  assign next_there = place_q < in_rows_q || (place_q == in_rows_q && (store || beat_q + 1'b1 != in_beat_q));
  assign row_there  = follower_q < in_rows_q || (follower_q == in_rows_q && (store || in_beat_q != '0));

  always_ff @(posedge clk_i) begin
    busy    <= !rst_i && whole && (taken_o || open_q || read_valid_q || (out_valid_o && !out_ready_i));
    // In a complete frame each beat is present, so that a reader whose place was upset still reaches the end.
    ahead_q <= taken_o || whole_q || (!step ? stay_there : row_read ? row_there : next_there);
    if (step) begin
      beat_q <= row_read ? '0 : beat_q + 1'b1;
      id_q   <= id_q + 1'b1;
      open_q <= !all_read;
      if (row_read) begin
        place_q    <= follower_q;
        follower_q <= (interleave_q ? place_q : follower_q) + 1'b1;
      end
    end
    if (taken_o) begin
      open_q     <= 1'b1;
      place_q    <= '0;
      follower_q <= interleave ? (RowBits+1)'(EvenRows) : (RowBits+1)'(1);
      beat_q     <= '0;
      id_q       <= '0;
    end
    if (move) begin
      read_id_q    <= id_q;
      read_last_q  <= all_read;
      read_valid_q <= step;
      out_id_o     <= read_id_q;
      out_last_o   <= read_last_q;
      out_valid_o  <= read_valid_q;
    end
    if (rst_i) begin
      open_q       <= 1'b0;
      read_valid_q <= 1'b0;
      out_valid_o  <= 1'b0;
    end
  end

  msn_ram #(.Words(Depth), .Width(Width)) u_frame (
    .clk_i,
    .write_i(store), .write_address_i(in_address), .write_data_i(in_data_i),
    .read_i(move), .read_address_i(AddressBits'(id_q)), .out_data_o
  );

  // Reading a place in the clock in which it is written is undefined. Exempt: a frame with a missing beat, replaced
  // by the next one, is damaged anyway.
  msn_check u_read_is_not_written (
    .clk_i, .rst_i,
    .wrong_i(!rst_i && store && step && !(in_first_i && !whole_q) && in_address == AddressBits'(id_q))
  );

  if (Sorts) begin : gen_all
    assign room_o = 1'b1;
  end else begin : gen_part
    // Set to 0 when the reader waits for the writer: after an upset it could hold the scan, and so itself, for ever.
    logic [AddressBits:0] used_q;
    logic                 empty;
    assign empty = !store && !(open_q && stay_there);
    always_ff @(posedge clk_i) begin
      used_q <= taken_o ? (AddressBits+1)'(1) :
                empty ? '0 : used_q + (AddressBits+1)'(store) - (AddressBits+1)'(step);
      room_o <= 32'(used_q) + Ahead * Burst < Depth;
      if (rst_i) begin
        used_q <= '0;
        room_o <= 1'b0;
      end
    end
  end

endmodule
