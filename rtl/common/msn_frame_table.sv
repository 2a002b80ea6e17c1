// SPDX-License-Identifier: Apache-2.0
//
// One word per beat of a frame, in block RAM, read ahead: the word of the next beat already waits in a register.
//
//   out_data_o after a restart = word Start, then the next word with each advance, wrapping around
//
// Beats arrive in order, so the address does not depend on a sample: both registers of the memory (msn_ram) cost no
// latency. The user advances when it takes a word and while out_valid_o is
// low. A restart (for a clock or more) selects bank_i; the first word is valid two advances later. With two
// banks the bank not read can be written at any time, each part of a word by itself. A word read while it is
// written is undefined: out_spoilt_o marks it, for a msn_check by the user that no result depends on it.
// at_end_o: the word before Start waits, as it must at a frame's last beat; otherwise the user restarts.
// Model: model/meissner/twins/common/frames.py

module msn_frame_table #(
  parameter  int unsigned Words       = 4096,
  parameter  int unsigned Parts       = 1,
  parameter  int unsigned PartBits    = 33,
  parameter  int unsigned Banks       = 2,
  parameter  int unsigned Start       = 0,
  localparam int unsigned WordBits    = msn_pkg::index_width(Words)
) (
  input  logic                      clk_i,

  input  logic                      restart_i,
  input  logic                      bank_i,
  input  logic                      advance_i,
  output logic                      out_valid_o,
  output logic [Parts*PartBits-1:0] out_data_o,
  output logic                      out_spoilt_o,
  output logic                      at_end_o,

  input  logic [Parts-1:0]          write_i,
  input  logic                      write_bank_i,
  input  logic [WordBits-1:0]       write_word_i,
  input  logic [Parts*PartBits-1:0] write_data_i
);

  if (Words < 1) begin : gen_check_words
    $fatal(1, "msn_frame_table: Words = %0d must be at least 1", Words);
  end
  if (Parts < 1 || PartBits < 1) begin : gen_check_parts
    $fatal(1, "msn_frame_table: Parts = %0d and PartBits = %0d must be at least 1", Parts, PartBits);
  end
  if (Banks != 1 && Banks != 2) begin : gen_check_banks
    $fatal(1, "msn_frame_table: Banks = %0d must be 1 or 2", Banks);
  end
  if (Start >= Words) begin : gen_check_start
    $fatal(1, "msn_frame_table: Start = %0d must be below Words = %0d", Start, Words);
  end

  localparam int unsigned AddressBits = msn_pkg::index_width(Words * Banks);

  logic [AddressBits-1:0] first, final_word, address, write_address;
  logic                   bank, taken, write_bank, read_valid;
  assign bank          = Banks == 2 && bank_i;
  assign write_bank    = Banks == 2 && write_bank_i;
  assign write_address = AddressBits'(write_word_i) + (write_bank ? AddressBits'(Words) : '0);

  // Computed from the bank in use: after an upset, separate limit registers could keep a shorter range.
  assign first         = taken ? AddressBits'(Words) : '0;
  assign final_word    = first + AddressBits'(Words - 1);

  // Two words are in flight when one waits. Compared a clock ahead, and not with `first`, which an upset may change.
  logic [AddressBits-1:0] start, next;
  assign start = AddressBits'(Start) + (bank ? AddressBits'(Words) : '0);
  assign next  = AddressBits'((Start + 1) % Words) + (bank ? AddressBits'(Words) : '0);
  always_ff @(posedge clk_i) at_end_o <= address == (advance_i && !restart_i ? start : next);

  always_ff @(posedge clk_i) begin
    if (restart_i) begin
      address <= start;
      taken   <= bank;
    end else if (advance_i) begin
      address <= address == final_word ? first : address + 1'b1;
    end
    if (advance_i) {out_valid_o, read_valid} <= {read_valid, 1'b1};
    if (restart_i) {out_valid_o, read_valid} <= '0;
  end

  logic spoilt;  // the word that was read last
  always_ff @(posedge clk_i) begin
    if (advance_i) {out_spoilt_o, spoilt} <= {spoilt, write_i != '0 && address == write_address};
  end

  for (genvar p = 0; p < Parts; p++) begin : gen_part
    msn_ram #(.Words(Words * Banks), .Width(PartBits)) u_words (
      .clk_i,
      .write_i(write_i[p]), .write_address_i(write_address),
      .write_data_i(write_data_i[p*PartBits+:PartBits]),
      .read_i(advance_i), .read_address_i(address), .out_data_o(out_data_o[p*PartBits+:PartBits])
    );
  end

endmodule
