// SPDX-License-Identifier: Apache-2.0
//
// Words follow from Start on, wrapping around, one with every advance, the first two advances after a restart; each is
// the value last written before it was read, for any word (`watch_i`, constant), or is marked: a word is marked if and
// only if it was written in the clock in which it was read.

module formal_frame_table #(
  parameter  int unsigned Words    = 5,
  parameter  int unsigned Parts    = 2,
  parameter  int unsigned PartBits = 20,
  parameter  int unsigned Banks    = 2,
  parameter  int unsigned Start    = 2,
  localparam int unsigned WordBits = msn_pkg::index_width(Words)
) (
  input logic                      clk_i,
  input logic                      restart_i,
  input logic                      bank_i,
  input logic                      advance_i,
  input logic [WordBits-1:0]       watch_i,
  input logic                      watch_bank_i,
  input logic [Parts-1:0]          write_i,
  input logic                      write_bank_i,
  input logic [WordBits-1:0]       write_word_i,
  input logic [Parts*PartBits-1:0] write_data_i
);

  logic                      out_valid_o, out_spoilt_o, at_end_o;
  logic [Parts*PartBits-1:0] out_data_o;
  msn_frame_table #(.Words(Words), .Parts(Parts), .PartBits(PartBits), .Banks(Banks), .Start(Start)) dut (.*);

  localparam int unsigned AddressBits = msn_pkg::index_width(Words * Banks);
  logic                      started = 1'b0;
  logic                      taken, watched, written, watch_bank_q, ours_read, ours_out;
  logic                      spoilt_read, spoilt_out;
  logic [WordBits-1:0]       watch_q;
  logic [31:0]               place;        // of the word to be read next
  logic [1:0]                advances;     // since the restart, at most 2
  logic [Parts*PartBits-1:0] value, value_read, value_out;  // of the watched word: now, as read, at the output
  logic [AddressBits-1:0]    at;
  assign watched = place == 32'(watch_i) && (Banks == 1 || taken == watch_bank_i);
  assign written = write_word_i == watch_i && (Banks == 1 || write_bank_i == watch_bank_i);
  assign at      = AddressBits'(32'(watch_i) + ((Banks == 2 && watch_bank_i) ? Words : 0));
  always_ff @(posedge clk_i) begin
    started      <= 1'b1;
    watch_q      <= watch_i;
    watch_bank_q <= watch_bank_i;
    for (int unsigned p = 0; p < Parts; p++) begin
      if (write_i[p] && written) value[p*PartBits+:PartBits] <= write_data_i[p*PartBits+:PartBits];
    end
    if (advance_i) begin
      ours_read  <= watched;
      value_read <= value;
      ours_out   <= ours_read;
      spoilt_read <= write_i != '0 && 32'(write_word_i) == place && (Banks == 1 || write_bank_i == taken);
      spoilt_out  <= spoilt_read;
      value_out  <= value_read;
      place      <= (place == Words - 1) ? 0 : place + 1;
      advances   <= (advances == 2'd2) ? 2'd2 : advances + 1'b1;
    end
    if (restart_i) begin
      place    <= Start;
      advances <= 2'd0;
      taken    <= Banks == 2 && bank_i;
    end
  end

  always_comb begin
    if (!started) assume (restart_i);
    assume (32'(watch_i) < Words && 32'(write_word_i) < Words);
    if (started) begin
      assume (watch_i == watch_q && watch_bank_i == watch_bank_q);
      assert (out_valid_o == (advances == 2'd2));
      if (out_valid_o) assert (out_spoilt_o == spoilt_out);
      if (out_valid_o && ours_out && !out_spoilt_o) assert (out_data_o == value_out);
      // Invariant.
      assert (place < Words && dut.taken == taken && 32'(dut.address) == place + (taken ? Words : 0));
      assert (dut.read_valid == (advances != 2'd0) && advances <= 2'd2);
      if (Banks == 1) assert (!taken);
      if (advances != 2'd0) assert (dut.spoilt == spoilt_read);
    end
  end
  for (genvar p = 0; p < Parts; p++) begin : gen_part
    always_comb begin
      if (!started) assume (dut.gen_part[p].u_words.memory[at] == value[p*PartBits+:PartBits]);
      if (started) begin
        assert (dut.gen_part[p].u_words.memory[at] == value[p*PartBits+:PartBits]);
        if (ours_read && !spoilt_read && advances != 2'd0) begin
          assert (dut.gen_part[p].u_words.fetched == value_read[p*PartBits+:PartBits]);
        end
      end
    end
  end

  // A word written after the reset reaches the output, and one is written while another is read.
  logic fresh;
  always_ff @(posedge clk_i) begin
    if (started && write_i[0] && written && write_data_i[0]) fresh <= 1'b1;
    if (!started) fresh <= 1'b0;
  end
  always_comb begin
    if (started && Words < 16) cover (out_valid_o && ours_out && fresh && value_out != '0 && !restart_i);
    if (started) cover (write_i != '0 && advance_i && out_valid_o && out_spoilt_o);
  end

endmodule
