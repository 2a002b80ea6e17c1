// SPDX-License-Identifier: Apache-2.0
//
// The common part of the families' block RAMs, for simulating netlists: 2048 bytes, two ports, one clock.
//
// In a port ByteBits * 2^n wide, address bits n-1 .. 0 are byte enables; in one narrower than a byte, address bits
// 2 .. 0 select its bits. While the port writes, its output keeps its value (mode 0), shows the new data (1) or the old
// data (2). Reading a byte that the other port writes is undefined in silicon; here the byte is inverted.

// verilator lint_off DECLFILENAME
// verilator coverage_off
module msn_gate_ram #(
  parameter int ByteBits = 9,
  parameter int WidthA   = 18,
  parameter int WidthB   = 18,
  parameter int ModeA    = 0,
  parameter int ModeB    = 0
) (
  input  logic        clk_i,

  input  logic        a_enable_i, a_write_i, a_reset_i,
  input  logic [13:0] a_address_i,
  input  logic [35:0] a_data_i,
  output logic [35:0] a_data_o,

  input  logic        b_enable_i, b_write_i, b_reset_i,
  input  logic [13:0] b_address_i,
  input  logic [35:0] b_data_i,
  output logic [35:0] b_data_o
);

  logic [ByteBits-1:0] bytes [2048];

  // A port of this width accesses bytes first .. first + lanes - 1.
  function automatic int lanes(int width);
    lanes = (width < ByteBits) ? 1 : width / ByteBits;
  endfunction

  function automatic int first(int width, logic [13:0] address);
    first = int'(address[13:3]) / lanes(width) * lanes(width);
  endfunction

  function automatic int shift(int width, logic [13:0] address);
    shift = (width < 8) ? int'(address[2:0]) / width * width : 0;
  endfunction

  function automatic logic [ByteBits-1:0] mask(int width, logic [13:0] address, int lane);
    mask = (width < 8) ? ByteBits'(((1 << width) - 1) << shift(width, address)) : '1;
    if (lanes(width) > 1 && !address[lane]) mask = '0;
  endfunction

  function automatic logic [35:0] look(int width, logic [13:0] address);
    look = '0;
    for (int lane = 0; lane < lanes(width); lane++) begin
      look[lane*ByteBits+:ByteBits] = bytes[first(width, address)+lane] >> shift(width, address);
    end
    if (width < 8) look &= 36'((1 << width) - 1);
  endfunction

  // The same, with the bytes that the other port writes inverted.
  function automatic logic [35:0] see(int width, logic [13:0] address, logic other, int its_width,
                                      logic [13:0] its_address);
    see = look(width, address);
    for (int lane = 0; lane < lanes(width); lane++) begin
      for (int its = 0; its < lanes(its_width); its++) begin
        if (other && first(width, address) + lane == first(its_width, its_address) + its) begin
          see[lane*ByteBits+:ByteBits] = see[lane*ByteBits+:ByteBits] ^
                                         (mask(its_width, its_address, its) >> shift(width, address));
        end
      end
    end
    if (width < 8) see &= 36'((1 << width) - 1);
  endfunction

  logic a_writes, b_writes;
  assign a_writes = a_enable_i && a_write_i;
  assign b_writes = b_enable_i && b_write_i;

  always_ff @(posedge clk_i) begin
    if (a_enable_i && (!a_write_i || ModeA == 2)) begin
      a_data_o <= see(WidthA, a_address_i, b_writes, WidthB, b_address_i);
    end else if (a_writes && ModeA == 1) begin
      a_data_o <= a_data_i;
    end
    if (b_enable_i && (!b_write_i || ModeB == 2)) begin
      b_data_o <= see(WidthB, b_address_i, a_writes, WidthA, a_address_i);
    end else if (b_writes && ModeB == 1) begin
      b_data_o <= b_data_i;
    end
    if (a_reset_i) a_data_o <= '0;
    if (b_reset_i) b_data_o <= '0;

    for (int lane = 0; lane < lanes(WidthA); lane++) begin
      if (a_writes) begin
        bytes[first(WidthA, a_address_i)+lane] <=
            (bytes[first(WidthA, a_address_i)+lane] & ~mask(WidthA, a_address_i, lane)) |
            ((a_data_i[lane*ByteBits+:ByteBits] << shift(WidthA, a_address_i)) & mask(WidthA, a_address_i, lane));
      end
    end
    for (int lane = 0; lane < lanes(WidthB); lane++) begin
      if (b_writes) begin
        bytes[first(WidthB, b_address_i)+lane] <=
            (bytes[first(WidthB, b_address_i)+lane] & ~mask(WidthB, b_address_i, lane)) |
            ((b_data_i[lane*ByteBits+:ByteBits] << shift(WidthB, b_address_i)) & mask(WidthB, b_address_i, lane));
      end
    end
  end

endmodule
