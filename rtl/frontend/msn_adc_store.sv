// SPDX-License-Identifier: Apache-2.0
//
// Holds one frame of codes and sends it on, channel by channel, as signed samples.
//
// A word has one code per lane: word w of lane l is channel w + l*LaneChannels. A sample leaves as soon as it
// and all channels before it are present. out_user_o marks a code at either end of the part's range.
// Whole: no sample leaves before the last word, and none at all if in_bad_i came with that word.
// A word may arrive only for channels whose samples have left, or leave in that clock: codes are registered, so the
// old code is still offered in that clock.
// Samples held but not offered when a frame begins would wait for ever: they are discarded. Only an upset causes this.
//
// Latency 1 cycle from in_valid_i to out_valid_o.   Model: model/meissner/twins/frontend/adc_store.py
// Error: none.

module msn_adc_store #(
  parameter  int unsigned Channels     = 8,
  parameter  int unsigned Lanes        = 1,
  parameter  int unsigned LaneChannels = 8,
  parameter  int unsigned DataBits     = 12,
  parameter  int unsigned SampleBits   = 17,
  parameter  bit          Signed       = 1'b0,
  parameter  bit          Whole        = 1'b0,
  localparam int unsigned IdBits       = msn_pkg::index_width(Channels)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         begin_i,    // a frame begins, its words come later

  input  logic                         in_valid_i,
  input  logic [IdBits-1:0]            in_word_i,
  input  logic [Lanes*DataBits-1:0]    in_data_i,
  input  logic                         in_bad_i,
  output logic                         pending_o,  // a sample has not left yet

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [SampleBits-1:0] out_data_o,
  output logic [IdBits-1:0]            out_id_o,
  output logic                         out_last_o,
  output logic                         out_user_o
);

  if (SampleBits < DataBits + 32'(!Signed)) begin : gen_check_sample_bits
    $fatal(1, "msn_adc_store: SampleBits = %0d must hold a code of %0d bits", SampleBits, DataBits);
  end
  if (Whole && Lanes > 1) begin : gen_check_whole
    $fatal(1, "msn_adc_store: Lanes = %0d must be 1: Whole waits for one lane's last word", Lanes);
  end

  logic [Channels-1:0]               full_q;
  logic [Channels-1:0][DataBits-1:0] code_q;
  logic [Channels-1:0]               taken, written, filled;
  logic                              complete, leaves;
  assign leaves   = out_valid_o && out_ready_i;
  assign complete = in_valid_i && in_word_i == IdBits'(Channels - 1) && !in_bad_i;

  for (genvar c = 0; c < Channels; c++) begin : gen_channel
    localparam int unsigned Lane = (Lanes > 1) ? c / LaneChannels : 0;
    // Kept as a net: without it ABC shares logic between the channels, which puts another LUT between out_ready_i,
    // which waits for all converters of a scan, and full_q. One net a channel: Yosys drives a kept vector of which a
    // bit is a register's output, as with two channels, a second time, by x.
    (* keep *) logic offered;
    assign offered    = out_id_o == IdBits'(c);
    assign taken[c]   = leaves && offered;
    assign written[c] = in_valid_i && in_word_i == IdBits'(c - Lane * LaneChannels);
    assign filled[c]  = Whole ? complete : written[c];
    always_ff @(posedge clk_i) if (written[c]) code_q[c] <= in_data_i[Lane*DataBits +: DataBits];
  end

  logic [DataBits-1:0] code, from_bottom;
  assign code        = code_q[out_id_o];
  assign from_bottom = code ^ {Signed, (DataBits-1)'(0)};  // 0 and all ones are the ends of the range

  assign pending_o   = |full_q;
  assign out_last_o  = out_id_o == IdBits'(Channels - 1);
  assign out_data_o  = {{(SampleBits - DataBits){Signed && code[DataBits-1]}}, code};
  assign out_user_o  = &from_bottom || ~|from_bottom;

  // Is the next sample present: looked up for the case that this one is taken and for the case that it is not.
  logic [IdBits-1:0] id_next;
  logic              next_there, same_there;
  assign id_next    = out_last_o ? '0 : out_id_o + 1'b1;
  assign next_there = (Channels > 1 && full_q[id_next]) || filled[id_next];
  assign same_there = full_q[out_id_o] || filled[out_id_o];

  always_ff @(posedge clk_i) begin
    full_q <= (full_q & ~taken) | filled;
    out_valid_o <= leaves ? next_there : same_there;
    if (leaves) out_id_o <= id_next;
    if (begin_i && !out_valid_o) begin
      full_q   <= '0;
      out_id_o <= '0;
    end
    if (rst_i) begin
      full_q      <= '0;
      out_valid_o <= 1'b0;
      out_id_o    <= '0;
    end
  end

  // A code written over before its sample has left would be lost without a report.
  msn_check u_each_code_leaves (.clk_i, .rst_i, .wrong_i(!rst_i && (written & full_q & ~taken) != '0));

endmodule
