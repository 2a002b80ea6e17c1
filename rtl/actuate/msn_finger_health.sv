// SPDX-License-Identifier: Apache-2.0
//
// Which fingers can be trusted, judged by their samples: a dead converter repeats one end of its range.
//
//   a sample is at the rail              sample <= low, or sample >= high
//   finger f is unhealthy                its last `rail` samples or more are all at the rail; rail = 0: never
//   all fingers are unhealthy            for a clock after lost_i: the converter did not deliver a frame
//
// healthy_o follows the sample by 3 clocks and lost_i by 1 clock. A sample a clock; an id beyond the last finger is
// ignored. After a reset all fingers are healthy.
// Error: none.
// Model: model/meissner/twins/actuate/actuate.py

module msn_finger_health #(
  parameter  int unsigned Fingers    = 2,
  parameter  int unsigned SampleBits = 17,
  localparam int unsigned IdBits     = msn_pkg::index_width(Fingers)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic signed [16:0]           cfg_low_i,
  input  logic signed [16:0]           cfg_high_i,
  input  logic        [7:0]            cfg_rail_i,

  input  logic                         in_valid_i,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic        [IdBits-1:0]     in_id_i,
  input  logic                         lost_i,

  output logic        [Fingers-1:0]    healthy_o
);

  if (Fingers < 1 || Fingers > 8) begin : gen_check_fingers
    $fatal(1, "msn_finger_health: Fingers = %0d must lie in 1 .. 8", Fingers);
  end
  if (SampleBits < 2 || SampleBits > 17) begin : gen_check_sample_bits
    $fatal(1, "msn_finger_health: SampleBits = %0d must lie in 2 .. 17", SampleBits);
  end

  logic                    valid, at_rail;
  logic [IdBits-1:0]       id;
  logic [Fingers-1:0][7:0] run;  // consecutive samples at the rail, saturates at 255
  always_ff @(posedge clk_i) begin
    valid   <= in_valid_i;
    id      <= in_id_i;
    at_rail <= 17'(in_data_i) <= cfg_low_i || 17'(in_data_i) >= cfg_high_i;
    for (int unsigned f = 0; f < Fingers; f++) begin
      if (valid && id == IdBits'(f)) run[f] <= at_rail ? run[f] + 8'(run[f] != '1) : '0;
      healthy_o[f] <= !lost_i && (cfg_rail_i == '0 || run[f] < cfg_rail_i);
    end
    if (rst_i) begin
      valid     <= 1'b0;
      run       <= '0;
      healthy_o <= '1;
    end
  end

endmodule
