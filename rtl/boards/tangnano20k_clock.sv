// SPDX-License-Identifier: Apache-2.0
//
// Clock of the Tang Nano 20K: its 27 MHz oscillator.

`include "msn_build.svh"  // the configuration, written by tools/make/synth.py

module tangnano20k_clock (
  input  logic clk_27m_i,
  output logic clk_o,
  output logic good_o     // the clock runs
);

  if (`MSN_CLK_KHZ != 27_000) begin : gen_check_clk
    $fatal(1, "tangnano20k_clock: the clock of %0d kHz must be 27000", `MSN_CLK_KHZ);
  end
  assign clk_o  = clk_27m_i;
  assign good_o = 1'b1;

endmodule
