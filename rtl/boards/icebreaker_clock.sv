// SPDX-License-Identifier: Apache-2.0
//
// Clock of the iCEBreaker: its 12 MHz oscillator, or 24 MHz from the PLL (MSN_CLK_KHZ).

`include "msn_build.svh"  // the configuration, written by tools/make/synth.py

module icebreaker_clock (
  input  logic clk_12m_i,
  output logic clk_o,
  output logic good_o     // the clock runs
);

  if (`MSN_CLK_KHZ == 12_000) begin : gen_crystal
    assign clk_o  = clk_12m_i;
    assign good_o = 1'b1;
  end else begin : gen_pll
    if (`MSN_CLK_KHZ != 24_000) begin : gen_check_clk
      $fatal(1, "icebreaker_clock: the clock of %0d kHz must be 12000 or 24000", `MSN_CLK_KHZ);
    end
    // 12 MHz * 64 = 768 MHz, / 32
    SB_PLL40_PAD #(
      .FEEDBACK_PATH("SIMPLE"), .DIVR(4'd0), .DIVF(7'd63), .DIVQ(3'd5), .FILTER_RANGE(3'd1)
    ) u_pll (
      .PACKAGEPIN(clk_12m_i), .PLLOUTGLOBAL(clk_o), .LOCK(good_o), .RESETB(1'b1), .BYPASS(1'b0)
    );
  end

endmodule
