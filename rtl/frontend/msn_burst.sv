// SPDX-License-Identifier: Apache-2.0
//
// Turns one conversion request into a burst of cfg_count_i conversions, exactly cfg_period_i clocks apart, for
// measurements over several samples (msn_am_demod). trigger_o follows start_i by a clock, then every period; first_o
// is high until the burst's first sample is taken. A lost conversion spoils the burst: lost_o reports it once,
// spoiled_o stays high until the next burst starts.
// A start during a burst begins a new burst.
//
// Error: none.
// Model: model/meissner/twins/frontend/timing.py

module msn_burst #(
  parameter int unsigned CountBits  = 10,
  parameter int unsigned PeriodBits = 12
) (
  input  logic                  clk_i,
  input  logic                  rst_i,

  input  logic [CountBits-1:0]  cfg_count_i,   // 0: 2^CountBits
  input  logic [PeriodBits-1:0] cfg_period_i,  // clocks, 0: 2^PeriodBits

  input  logic                  start_i,
  output logic                  trigger_o,

  input  logic                  taken_i,       // a sample from the converter is taken
  output logic                  first_o,
  input  logic                  lost_i,
  output logic                  lost_o,
  output logic                  spoiled_o
);

  if (CountBits < 1 || CountBits > 24) begin : gen_check_count_bits
    $fatal(1, "msn_burst: CountBits = %0d must lie in 1 .. 24", CountBits);
  end
  if (PeriodBits < 1 || PeriodBits > 24) begin : gen_check_period_bits
    $fatal(1, "msn_burst: PeriodBits = %0d must lie in 1 .. 24", PeriodBits);
  end

  logic                  running;
  logic [CountBits-1:0]  left;   // triggers after this one
  logic [PeriodBits-1:0] clock;  // clocks until the next one
  assign lost_o = lost_i && !spoiled_o;

  always_ff @(posedge clk_i) begin
    trigger_o <= start_i || (running && clock == '0);
    clock     <= (start_i || clock == '0) ? cfg_period_i - 1'b1 : clock - 1'b1;
    if (start_i) begin
      running <= cfg_count_i != CountBits'(1);
      left    <= cfg_count_i - 1'b1;
    end else if (running && clock == '0) begin
      running <= left != CountBits'(1);
      left    <= left - 1'b1;
    end
    first_o   <= start_i || (first_o && !taken_i);
    spoiled_o <= !start_i && (spoiled_o || lost_i);
    if (rst_i) begin
      trigger_o <= 1'b0;
      running   <= 1'b0;
      first_o   <= 1'b0;
      spoiled_o <= 1'b0;
    end
  end

endmodule
