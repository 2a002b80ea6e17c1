// SPDX-License-Identifier: Apache-2.0
//
// msn_ram (rtl/common) as DP16KD cells that use the cell's own output register. Yosys does not infer it; with it the
// slow output has no route to a register in logic. A word is cut into slices as wide as one cell is at this depth, so
// no multiplexer follows the output. Small memories are LUT RAM, and one deeper than a cell is left to Yosys.
//
// In a port 9 or more wide the low bits of the address enable bytes, when writing. With 36 bits the data pins of both
// ports form one word, as in Yosys's own map; A writes, B reads.

module msn_ram #(
  parameter  int unsigned Words       = 1024,
  parameter  int unsigned Width       = 18,
  localparam int unsigned AddressBits = msn_pkg::index_width(Words)
) (
  input  logic                   clk_i,

  input  logic                   write_i,
  input  logic [AddressBits-1:0] write_address_i,
  input  logic [Width-1:0]       write_data_i,

  input  logic                   read_i,
  input  logic [AddressBits-1:0] read_address_i,
  output logic [Width-1:0]       out_data_o
);

  if (Words < 1) begin : gen_check_words
    $fatal(1, "msn_ram: Words = %0d must be at least 1", Words);
  end
  if (Width < 1) begin : gen_check_width
    $fatal(1, "msn_ram: Width = %0d must be at least 1", Width);
  end

  // A LUT RAM has 16 words of 4 bits.
  localparam int unsigned LutRams = ((Words + 15) / 16) * ((Width + 3) / 4);

  if (LutRams <= 16 || Words > 16384) begin : gen_inferred
    (* no_rw_check *) logic [Width-1:0] memory [Words];
    logic [Width-1:0] fetched;
    always_ff @(posedge clk_i) begin
      if (write_i) memory[write_address_i] <= write_data_i;
      if (read_i) begin
        fetched    <= memory[read_address_i];
        out_data_o <= fetched;
      end
    end

  end else begin : gen_cells
    localparam int unsigned CellBits = (Words <= 512 && Width > 18) ? 36 : (Words <= 1024) ? 18 :
                                       (Words <= 2048) ? 9 : (Words <= 4096) ? 4 : (Words <= 8192) ? 2 : 1;
    localparam int unsigned Low      = (CellBits == 36) ? 5 : (CellBits == 18) ? 4 : (CellBits == 9) ? 3 :
                                       (CellBits == 4) ? 2 : (CellBits == 2) ? 1 : 0;
    localparam logic [3:0]  Bytes    = (CellBits == 36) ? 4'd15 : (CellBits == 18) ? 4'd3 : 4'd0;
    logic [13:0] a, b;
    assign a = (14'(write_address_i) << Low) | 14'(Bytes);
    assign b = 14'(read_address_i) << Low;

    for (genvar low = 0; low < Width; low += CellBits) begin : gen_cell
      localparam int unsigned Bits = (Width - low < CellBits) ? Width - low : CellBits;
      logic [35:0] d, q, word;
      assign d = 36'(write_data_i[low+:Bits]);
      assign word = (CellBits == 36) ? q : 36'(q[35:18]);
      assign out_data_o[low+:Bits] = word[Bits-1:0];
      logic unused_word;
      assign unused_word = ^{q, word};
      DP16KD #(
        .DATA_WIDTH_A(CellBits), .DATA_WIDTH_B(CellBits), .REGMODE_A("OUTREG"), .REGMODE_B("OUTREG"),
        .RESETMODE("SYNC"), .ASYNC_RESET_RELEASE("SYNC"), .CSDECODE_A("0b000"), .CSDECODE_B("0b000"),
        .CLKAMUX("CLKA"), .CLKBMUX("CLKB"), .WRITEMODE_A("NORMAL"), .WRITEMODE_B("NORMAL"), .GSR("AUTO")
      ) u_cell (
        .CLKA(clk_i), .CEA(write_i), .OCEA(read_i), .WEA(1'b1), .RSTA(1'b0),
        .CSA0(1'b0), .CSA1(1'b0), .CSA2(1'b0),
        .CLKB(clk_i), .CEB(read_i), .OCEB(read_i), .WEB(1'b0), .RSTB(1'b0),
        .CSB0(1'b0), .CSB1(1'b0), .CSB2(1'b0),
        .ADA0(a[0]), .ADA1(a[1]), .ADA2(a[2]), .ADA3(a[3]), .ADA4(a[4]), .ADA5(a[5]), .ADA6(a[6]),
        .ADA7(a[7]), .ADA8(a[8]), .ADA9(a[9]), .ADA10(a[10]), .ADA11(a[11]), .ADA12(a[12]), .ADA13(a[13]),
        .ADB0(b[0]), .ADB1(b[1]), .ADB2(b[2]), .ADB3(b[3]), .ADB4(b[4]), .ADB5(b[5]), .ADB6(b[6]),
        .ADB7(b[7]), .ADB8(b[8]), .ADB9(b[9]), .ADB10(b[10]), .ADB11(b[11]), .ADB12(b[12]), .ADB13(b[13]),
        .DIA0(d[0]), .DIA1(d[1]), .DIA2(d[2]), .DIA3(d[3]), .DIA4(d[4]), .DIA5(d[5]), .DIA6(d[6]),
        .DIA7(d[7]), .DIA8(d[8]), .DIA9(d[9]), .DIA10(d[10]), .DIA11(d[11]), .DIA12(d[12]), .DIA13(d[13]),
        .DIA14(d[14]), .DIA15(d[15]), .DIA16(d[16]), .DIA17(d[17]),
        .DIB0(d[18]), .DIB1(d[19]), .DIB2(d[20]), .DIB3(d[21]), .DIB4(d[22]), .DIB5(d[23]), .DIB6(d[24]),
        .DIB7(d[25]), .DIB8(d[26]), .DIB9(d[27]), .DIB10(d[28]), .DIB11(d[29]), .DIB12(d[30]),
        .DIB13(d[31]), .DIB14(d[32]), .DIB15(d[33]), .DIB16(d[34]), .DIB17(d[35]),
        .DOA0(q[0]), .DOA1(q[1]), .DOA2(q[2]), .DOA3(q[3]), .DOA4(q[4]), .DOA5(q[5]), .DOA6(q[6]),
        .DOA7(q[7]), .DOA8(q[8]), .DOA9(q[9]), .DOA10(q[10]), .DOA11(q[11]), .DOA12(q[12]), .DOA13(q[13]),
        .DOA14(q[14]), .DOA15(q[15]), .DOA16(q[16]), .DOA17(q[17]),
        .DOB0(q[18]), .DOB1(q[19]), .DOB2(q[20]), .DOB3(q[21]), .DOB4(q[22]), .DOB5(q[23]), .DOB6(q[24]),
        .DOB7(q[25]), .DOB8(q[26]), .DOB9(q[27]), .DOB10(q[28]), .DOB11(q[29]), .DOB12(q[30]),
        .DOB13(q[31]), .DOB14(q[32]), .DOB15(q[33]), .DOB16(q[34]), .DOB17(q[35])
      );
    end
  end

endmodule
