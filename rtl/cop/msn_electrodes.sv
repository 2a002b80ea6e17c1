// SPDX-License-Identifier: Apache-2.0
//
// Gathers the four electrodes' samples of a frame, which arrive one after the other, into one parallel word.
//
// A frame is samples 0 .. 3 with `last` on the final one. Any other is dropped up to its `last`, and counted.
// Latency 1 clock after the fourth sample; a sample a clock.   Model: model/meissner/twins/cop/cop4.py

module msn_electrodes #(
  parameter int unsigned SampleBits = 17
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic        [1:0]            in_id_i,
  input  logic                         in_last_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [SampleBits-1:0] out_e1_o,
  output logic signed [SampleBits-1:0] out_e2_o,
  output logic signed [SampleBits-1:0] out_e3_o,
  output logic signed [SampleBits-1:0] out_e4_o,

  output logic        [31:0]           damaged_o
);

  if (SampleBits < 2) begin : gen_check_sample_bits
    $fatal(1, "msn_electrodes: SampleBits = %0d must be at least 2", SampleBits);
  end

  logic [1:0] place;
  logic       damaged, fits, accept;
  assign in_ready_o = out_ready_i || !out_valid_o;
  assign accept     = in_valid_i && in_ready_o;
  assign fits       = !damaged && in_id_i == place && in_last_i == (place == 2'd3);

  always_ff @(posedge clk_i) begin
    if (in_ready_o) out_valid_o <= in_valid_i && in_last_i && fits;
    if (accept) begin
      {out_e4_o, out_e3_o, out_e2_o, out_e1_o} <= {in_data_i, out_e4_o, out_e3_o, out_e2_o};
      place                                    <= in_last_i ? '0 : place + 1'b1;
      damaged                                  <= !in_last_i && !fits;
      if (!fits && !damaged) damaged_o <= damaged_o + 1'b1;
    end
    if (rst_i) begin
      out_valid_o <= 1'b0;
      place       <= '0;
      damaged     <= 1'b0;
      damaged_o   <= '0;
    end
  end

endmodule
