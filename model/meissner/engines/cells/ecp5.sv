// SPDX-License-Identifier: Apache-2.0
//
// The cells of an ECP5 that Yosys has only as black boxes, for simulating netlists: one clock, as synthesis uses them.

// verilator lint_off DECLFILENAME
// verilator coverage_off
module DP16KD #(
  parameter int    DATA_WIDTH_A = 18, DATA_WIDTH_B = 18,
  parameter string WRITEMODE_A = "NORMAL", WRITEMODE_B = "NORMAL", REGMODE_A = "NOREG", REGMODE_B = "NOREG",
  parameter string RESETMODE = "SYNC", ASYNC_RESET_RELEASE = "SYNC", GSR = "AUTO",
  parameter string CSDECODE_A = "0b000", CSDECODE_B = "0b000", CLKAMUX = "CLKA", CLKBMUX = "CLKB",
  parameter logic [319:0] INITVAL_00 = 0, INITVAL_01 = 0, INITVAL_02 = 0, INITVAL_03 = 0, INITVAL_04 = 0,
  parameter logic [319:0] INITVAL_05 = 0, INITVAL_06 = 0, INITVAL_07 = 0, INITVAL_08 = 0, INITVAL_09 = 0,
  parameter logic [319:0] INITVAL_0A = 0, INITVAL_0B = 0, INITVAL_0C = 0, INITVAL_0D = 0, INITVAL_0E = 0,
  parameter logic [319:0] INITVAL_0F = 0, INITVAL_10 = 0, INITVAL_11 = 0, INITVAL_12 = 0, INITVAL_13 = 0,
  parameter logic [319:0] INITVAL_14 = 0, INITVAL_15 = 0, INITVAL_16 = 0, INITVAL_17 = 0, INITVAL_18 = 0,
  parameter logic [319:0] INITVAL_19 = 0, INITVAL_1A = 0, INITVAL_1B = 0, INITVAL_1C = 0, INITVAL_1D = 0,
  parameter logic [319:0] INITVAL_1E = 0, INITVAL_1F = 0, INITVAL_20 = 0, INITVAL_21 = 0, INITVAL_22 = 0,
  parameter logic [319:0] INITVAL_23 = 0, INITVAL_24 = 0, INITVAL_25 = 0, INITVAL_26 = 0, INITVAL_27 = 0,
  parameter logic [319:0] INITVAL_28 = 0, INITVAL_29 = 0, INITVAL_2A = 0, INITVAL_2B = 0, INITVAL_2C = 0,
  parameter logic [319:0] INITVAL_2D = 0, INITVAL_2E = 0, INITVAL_2F = 0, INITVAL_30 = 0, INITVAL_31 = 0,
  parameter logic [319:0] INITVAL_32 = 0, INITVAL_33 = 0, INITVAL_34 = 0, INITVAL_35 = 0, INITVAL_36 = 0,
  parameter logic [319:0] INITVAL_37 = 0, INITVAL_38 = 0, INITVAL_39 = 0, INITVAL_3A = 0, INITVAL_3B = 0,
  parameter logic [319:0] INITVAL_3C = 0, INITVAL_3D = 0, INITVAL_3E = 0, INITVAL_3F = 0
) (
  input DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3,
    DIA2, DIA1, DIA0,
  input ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0,
  input CEA, OCEA, CLKA, WEA, RSTA, CSA2, CSA1, CSA0,
  output DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3,
    DOA2, DOA1, DOA0,
  input DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3,
    DIB2, DIB1, DIB0,
  input ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0,
  input CEB, OCEB, CLKB, WEB, RSTB, CSB2, CSB1, CSB0,
  output DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3,
    DOB2, DOB1, DOB0
);

  // With 36 bits the data pins of both ports form one: written at A, read at B.
  localparam bit WideIn  = DATA_WIDTH_A == 36;
  localparam bit WideOut = DATA_WIDTH_B == 36;
  logic [17:0] dia, dib;
  logic [35:0] doa, dob, doa_q, dob_q, out_a, out_b;
  assign dia = {DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3,
      DIA2, DIA1, DIA0};
  assign dib = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3,
      DIB2, DIB1, DIB0};
  assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3,
      DOA2, DOA1, DOA0} =
      WideOut ? out_b[17:0] : out_a[17:0];
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3,
      DOB2, DOB1, DOB0} =
      WideOut ? out_b[35:18] : out_b[17:0];

  // The output register, a clock later.
  always_ff @(posedge CLKA) begin
    if (OCEA) doa_q <= RSTA ? '0 : doa;
    if (OCEB) dob_q <= RSTB ? '0 : dob;
  end
  assign out_a = (REGMODE_A == "OUTREG") ? doa_q : doa;
  assign out_b = (REGMODE_B == "OUTREG") ? dob_q : dob;

  function automatic int mode(string name);
    mode = (name == "WRITETHROUGH") ? 1 : (name == "READBEFOREWRITE") ? 2 : 0;
  endfunction

  msn_gate_ram #(
    .ByteBits(9),
    .WidthA  (DATA_WIDTH_A),
    .WidthB  (DATA_WIDTH_B),
    .ModeA   (mode(WRITEMODE_A)),
    .ModeB   (mode(WRITEMODE_B))
  ) u_ram (
    .clk_i      (CLKA),
    .a_enable_i (CEA),
    .a_write_i  (WEA),
    .a_reset_i  (RSTA),
    .a_address_i({ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0}),
    .a_data_i   (WideIn ? {dib, dia} : 36'(dia)),
    .a_data_o   (doa),
    .b_enable_i (CEB),
    .b_write_i  (WEB && !WideIn),
    .b_reset_i  (RSTB),
    .b_address_i({ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0}),
    .b_data_i   (36'(dib)),
    .b_data_o   (dob)
  );

endmodule
