// SPDX-License-Identifier: Apache-2.0
//
// Clock of the Arty A7: 50 MHz from its 100 MHz oscillator. This project does not build it.

`include "msn_build.svh"  // the configuration, written by tools/make/synth.py

module arty_a7_clock (
  input  logic clk_100m_i,
  output logic clk_o,
  output logic good_o     // the clock runs
);

  if (`MSN_CLK_KHZ != 50_000) begin : gen_check_clk
    $fatal(1, "arty_a7_clock: the clock of %0d kHz must be 50000", `MSN_CLK_KHZ);
  end

  // 100 MHz * 10 = 1 GHz, / 20
  logic clk_100, clk_50, feedback;
  IBUF u_pad (.I(clk_100m_i), .O(clk_100));
  MMCME2_BASE #(
    .CLKIN1_PERIOD(10.0), .CLKFBOUT_MULT_F(10.0), .CLKOUT0_DIVIDE_F(20.0)
  ) u_mmcm (
    .CLKIN1(clk_100), .CLKFBIN(feedback), .CLKFBOUT(feedback), .CLKOUT0(clk_50), .LOCKED(good_o),
    .PWRDWN(1'b0), .RST(1'b0)
  );
  BUFG u_buffer (.I(clk_50), .O(clk_o));

endmodule
