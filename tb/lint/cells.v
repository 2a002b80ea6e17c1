// The vendors' cells that the boards use, as their ports alone, for Verilator's lint of rtl/boards.
module EHXPLLL #(
  parameter CLKI_DIV = 1, CLKFB_DIV = 1, CLKOP_DIV = 8, CLKOP_CPHASE = 0, CLKOP_ENABLE = "", FEEDBK_PATH = ""
) (
  input CLKI, CLKFB, RST, STDBY, PHASESEL0, PHASESEL1, PHASEDIR, PHASESTEP, PHASELOADREG, PLLWAKESYNC, ENCLKOP,
  output CLKOP, LOCK
);
endmodule

module SB_PLL40_PAD #(
  parameter FEEDBACK_PATH = "", DIVR = 4'd0, DIVF = 7'd0, DIVQ = 3'd0, FILTER_RANGE = 3'd0
) (
  input PACKAGEPIN, RESETB, BYPASS, output PLLOUTGLOBAL, LOCK
);
endmodule

module IBUF (input I, output O);
endmodule

module BUFG (input I, output O);
endmodule

module MMCME2_BASE #(
  parameter CLKIN1_PERIOD = 0.0, CLKFBOUT_MULT_F = 5.0, CLKOUT0_DIVIDE_F = 1.0
) (
  input CLKIN1, CLKFBIN, PWRDWN, RST, output CLKFBOUT, CLKOUT0, LOCKED
);
endmodule
