// SPDX-License-Identifier: Apache-2.0
//
// Samples leave in channel order, wrapping around, once for each code written: offered a clock after the code and all
// before it are present, held until taken. Its value is the code last written, sign-extended or zero-extended;
// out_user_o marks only the lowest and highest code. Whole: a frame is offered after its last word, none after a bad
// one. A word arrives only for channels whose samples have left, or leave in this clock (assumed: `overwrites`; proof
// adc_spi shows it for frames). Samples held but not offered when a frame begins are discarded, and channel 0 is next;
// no word arrives in that clock (assumed).

module formal_adc_store #(
  parameter  int unsigned Channels     = 8,
  parameter  int unsigned Lanes        = 1,
  parameter  int unsigned LaneChannels = 8,
  parameter  int unsigned DataBits     = 12,
  parameter  int unsigned SampleBits   = 17,
  parameter  bit          Signed       = 1'b0,
  parameter  bit          Whole        = 1'b0,
  localparam int unsigned IdBits       = msn_pkg::index_width(Channels)
) (
  input logic                      clk_i,
  input logic                      rst_i,
  input logic                      begin_i,
  input logic                      in_valid_i,
  input logic [IdBits-1:0]         in_word_i,
  input logic [Lanes*DataBits-1:0] in_data_i,
  input logic                      in_bad_i,
  input logic                      out_ready_i
);

  logic                         pending_o, out_valid_o, out_last_o, out_user_o;
  logic signed [SampleBits-1:0] out_data_o;
  logic [IdBits-1:0]            out_id_o;
  msn_adc_store #(
    .Channels(Channels), .Lanes(Lanes), .LaneChannels(LaneChannels), .DataBits(DataBits), .SampleBits(SampleBits),
    .Signed(Signed), .Whole(Whole)
  ) dut (.*);

  // From the words: the channels whose codes arrive now, and all whose samples have not left yet.
  localparam int unsigned Words = (Lanes > 1) ? LaneChannels : Channels;
  logic                         started = 1'b0;
  logic [Channels-1:0]          there, comes, fills, leaves;
  logic [Channels-1:0]          known = '0;  // has ever been written
  logic [Channels*DataBits-1:0] codes, new_codes;
  logic [31:0]                  next;  // the channel to be sent next
  logic                         give, frame_ends, overwrites, forgets;
  assign give       = out_valid_o && out_ready_i;
  assign frame_ends = in_valid_i && !in_bad_i && 32'(in_word_i) == Channels - 1;
  assign fills      = !Whole ? comes : frame_ends ? '1 : '0;
  assign overwrites = |(there & ~leaves & (comes | fills));
  assign forgets    = begin_i && !out_valid_o;
  always_comb begin
    comes     = '0;
    new_codes = codes;
    leaves    = '0;
    for (int unsigned w = 0; w < Words; w++) begin
      for (int unsigned l = 0; l < Lanes; l++) begin
        if (in_valid_i && 32'(in_word_i) == w && w + l * LaneChannels < Channels) begin
          comes[w+l*LaneChannels]                        = 1'b1;
          new_codes[(w+l*LaneChannels)*DataBits+:DataBits] = in_data_i[l*DataBits+:DataBits];
        end
      end
    end
    for (int unsigned c = 0; c < Channels; c++) leaves[c] = give && next == c;
  end

  // What is offered, and what was offered and not taken; whole: between a frame's last word and its last sample.
  logic                         whole, stalled, held_last, held_user;
  logic signed [SampleBits-1:0] held_data;
  logic [IdBits-1:0]            held_id;
  logic                         there_now, known_now;
  logic [DataBits-1:0]          code;
  logic [63:0]                  lowest, highest, value;
  always_comb begin
    there_now = 1'b0;
    known_now = 1'b0;
    code      = '0;
    for (int unsigned c = 0; c < Channels; c++) begin
      if (next == c) begin
        there_now = there[c];
        known_now = known[c];
        code      = codes[c*DataBits+:DataBits];
      end
    end
  end
  assign lowest  = Signed ? -(64'd1 << (DataBits - 1)) : 64'd0;
  assign highest = Signed ? (64'd1 << (DataBits - 1)) - 64'd1 : (64'd1 << DataBits) - 64'd1;
  assign value   = 64'(code) - ((Signed && code[DataBits-1]) ? 64'd1 << DataBits : 64'd0);

  always_ff @(posedge clk_i) begin
    started   <= 1'b1;
    there     <= (there & ~leaves) | fills;
    codes     <= new_codes;
    known     <= known | comes;
    stalled   <= out_valid_o && !out_ready_i && !rst_i;
    held_data <= out_data_o;
    held_id   <= out_id_o;
    held_last <= out_last_o;
    held_user <= out_user_o;
    if (give) next <= (next == Channels - 1) ? '0 : next + 1;
    if (give && out_last_o) whole <= 1'b0;
    if (frame_ends) whole <= 1'b1;
    if (rst_i || forgets) begin
      there <= '0;
      next  <= '0;
      whole <= 1'b0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (!rst_i) assume (!overwrites && !(begin_i && in_valid_i));
    if (started) begin
      assert (out_valid_o == there_now && pending_o == |there);
      if (Whole) assert (out_valid_o == whole && pending_o == whole);
      if (out_valid_o) begin
        assert (32'(out_id_o) == next && out_last_o == (next == Channels - 1));
        if (!Whole) assert (known_now);
        if (known_now) assert (64'(out_data_o) == value && out_user_o == (value == lowest || value == highest));
      end
      if (stalled) assert (out_valid_o && {out_data_o, out_id_o, out_last_o, out_user_o}
                                          == {held_data, held_id, held_last, held_user});
    end
  end

  // Invariant.
  always_comb begin
    if (started) begin
      assert (dut.full_q == there && 32'(dut.out_id_o) == next && next < Channels);
      if (Whole) assert (there == (whole ? {Channels{1'b1}} << next : '0) && (whole || next == '0));
      for (int unsigned c = 0; c < Channels; c++) begin
        if (known[c]) assert (dut.code_q[c] == codes[c*DataBits+:DataBits]);
        if (there[c] && !Whole) assert (known[c]);
      end
    end
  end

  logic bad_before;  // a complete frame with a bad word has come
  always_ff @(posedge clk_i) begin
    if (in_valid_i && in_bad_i && 32'(in_word_i) == Channels - 1) bad_before <= 1'b1;
    if (rst_i) bad_before <= 1'b0;
  end
  always_comb begin
    if (started && !rst_i) begin
      cover (&there && stalled);
      cover (stalled && give && out_last_o && value == lowest && (!Whole || bad_before));
      cover (give && out_last_o && value == highest);
      if (!Whole) cover (give && |(leaves & fills));
      if (!Whole && Channels > 1) cover (there[Channels-1] && !there[0] && next == 0);
      if (!Whole && Channels > 2) cover (forgets && there[Channels-1] && next == 1);  // of 2, it is offered
    end
  end

endmodule
