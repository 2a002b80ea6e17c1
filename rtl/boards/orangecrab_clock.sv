// SPDX-License-Identifier: Apache-2.0
//
// Clock of the OrangeCrab r0.2: its 48 MHz oscillator.

`include "msn_build.svh"  // the configuration, written by tools/make/synth.py

module orangecrab_clock (
  input  logic clk_48m_i,
  output logic clk_o,
  output logic good_o     // the clock runs
);

  if (`MSN_CLK_KHZ != 48_000) begin : gen_check_clk
    $fatal(1, "orangecrab_clock: the clock of %0d kHz must be 48000", `MSN_CLK_KHZ);
  end
  assign clk_o  = clk_48m_i;
  assign good_o = 1'b1;

endmodule
