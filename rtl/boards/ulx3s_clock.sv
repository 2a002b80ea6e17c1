// SPDX-License-Identifier: Apache-2.0
//
// Clock of the ULX3S: 25, 50 or 100 MHz (MSN_CLK_KHZ) from its 25 MHz oscillator.

`include "msn_build.svh"  // the configuration, written by tools/make/synth.py

module ulx3s_clock (
  input  logic clk_25m_i,
  output logic clk_o,
  output logic good_o     // the clock runs
);

  localparam int unsigned VcoKhz  = 600_000;
  localparam int unsigned Divider = VcoKhz / `MSN_CLK_KHZ;
  if (VcoKhz != Divider * `MSN_CLK_KHZ || `MSN_CLK_KHZ % 25_000 != 0) begin : gen_check_clk
    $fatal(1, "ulx3s_clock: the clock of %0d kHz must be 25000, 50000 or 100000", `MSN_CLK_KHZ);
  end

  logic clk;
  (* ICP_CURRENT = "12", LPF_RESISTOR = "8" *)
  EHXPLLL #(
    .CLKI_DIV(1), .CLKFB_DIV(`MSN_CLK_KHZ / 25_000), .CLKOP_DIV(Divider), .CLKOP_CPHASE(Divider - 1),
    .CLKOP_ENABLE("ENABLED"), .FEEDBK_PATH("CLKOP")
  ) u_pll (
    .CLKI(clk_25m_i), .CLKFB(clk), .CLKOP(clk), .LOCK(good_o), .RST(1'b0), .STDBY(1'b0), .PHASESEL0(1'b0),
    .PHASESEL1(1'b0), .PHASEDIR(1'b1), .PHASESTEP(1'b1), .PHASELOADREG(1'b1), .PLLWAKESYNC(1'b0),
    .ENCLKOP(1'b0)
  );
  assign clk_o = clk;

endmodule
