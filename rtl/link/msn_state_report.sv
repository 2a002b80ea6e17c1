// SPDX-License-Identifier: Apache-2.0
//
// On request the states of all channels, in packets of up to 128 channels, four to a word of 16 bits:
//
//   state of channel first + 4 n + k in bits 4 k .. 4 k + 2 of word n, 0 beyond the last channel
//   first = 0, 128, ..    left = Channels - first: the channels of this packet and of those after it
//
// report_i asks; asked again while packets are left, it starts over. chunk_valid_o: a packet waits. take_i, for a
// clock, begins it; step_i goes on to the next word, and with end_o completes the packet. States are read as they are
// when their word is sent. read_state_i: the state of channel read_id_o in the clock before (msn_slip_changes).
//
// Latency: 2 clocks from step_i to the lower half of the next word, 4 to all of it.
// Error: none.
// Model: model/meissner/twins/link/states.py

module msn_state_report #(
  parameter  int unsigned Channels = 8,
  parameter  int unsigned First    = 0,  // number of channel 0; above 0 for a single channel only
  localparam int unsigned IdBits   = msn_pkg::index_width(Channels)
) (
  input  logic                 clk_i,
  input  logic                 rst_i,

  input  logic                 report_i,
  output logic [IdBits-1:0]    read_id_o,
  input  msn_pkg::slip_state_e read_state_i,

  output logic                 chunk_valid_o,
  output logic [15:0]          chunk_first_o,
  output logic [15:0]          chunk_left_o,
  input  logic                 take_i,

  output logic [15:0]          word_o,
  output logic                 end_o,
  input  logic                 step_i
);

  if (Channels < 1 || Channels > 4096) begin : gen_check_channels
    $fatal(1, "msn_state_report: Channels = %0d must lie in 1 .. 4096", Channels);
  end
  if (First > 65535 || (First > 0 && Channels != 1)) begin : gen_check_first
    $fatal(1, "msn_state_report: First = %0d must be 0, or at most 65535 with Channels = 1", First);
  end

  // Which word: place is its first channel.
  logic [12:0] place;
  logic        asked, sending, begin_over, final_word;
  assign begin_over    = asked && !sending && !take_i;
  assign final_word    = place + 13'd4 >= 13'(Channels);
  assign end_o         = final_word || (&place[6:2]);
  assign chunk_first_o = 16'(place) + 16'(First);
  assign chunk_left_o  = 16'(Channels) - 16'(place);
  always_ff @(posedge clk_i) begin
    asked   <= report_i || (asked && !begin_over);
    // Nothing is sent of what does not wait: after an upset, asked would wait for ever.
    sending <= take_i || (sending && chunk_valid_o && !(step_i && end_o));
    if (step_i) begin
      place <= final_word ? '0 : place + 13'd4;
      if (final_word) chunk_valid_o <= 1'b0;
    end
    if (begin_over) begin
      place         <= '0;
      chunk_valid_o <= 1'b1;
    end
    if (rst_i) begin
      asked         <= 1'b0;
      sending       <= 1'b0;
      chunk_valid_o <= 1'b0;
      place         <= '0;
    end
  end

  // Its four states, one after the other. The memory answers a clock later.
  logic [2:0]  which;  // 4: all four were asked for
  logic [1:0]  which_q;
  logic [12:0] id;
  logic        fits_q, asks_q;
  assign id        = place + 13'(which[1:0]);
  assign read_id_o = IdBits'(id);
  always_ff @(posedge clk_i) begin
    if (take_i || step_i) which <= '0;
    else if (!which[2]) which <= which + 1'b1;
    asks_q  <= !which[2];
    which_q <= which[1:0];
    fits_q  <= id < 13'(Channels);
    if (asks_q) word_o[4*which_q+:4] <= fits_q ? {1'b0, read_state_i} : '0;
    if (rst_i) which <= 3'd4;
  end

endmodule
