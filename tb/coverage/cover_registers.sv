// Cover points of msn_registers: reads and writes, back-to-back and apart, of existing and missing words, of writable
// and read-only words, at aligned and unaligned addresses; accesses answered with an error; a reset in an access.
module cover_registers (
  input logic       clk_i,
  input logic       rst_i,
  input logic       bus_valid_i,
  input logic       bus_write_i,
  input logic [1:0] offset,
  input logic       hit,
  input logic       writable,
  input logic       bus_done_o,
  input logic       bus_error_o
);
  for (genvar w = 0; w <= 1; w++) begin : gen_write
    logic now;
    assign now = !rst_i && bus_valid_i && bus_write_i == (w == 1);
    for (genvar o = 0; o < 4; o++) begin : gen_offset
      `BIN(nothing_there, now && offset == 2'(o) && !hit)
      `BIN(to_be_written, now && offset == 2'(o) && hit && writable)
      `BIN(to_be_read, now && offset == 2'(o) && hit && !writable)
    end
    `BIN(after_done, now && bus_done_o && !bus_error_o)
    `BIN(after_error, now && bus_done_o && bus_error_o)
    `BIN(cleared, rst_i && bus_valid_i && bus_write_i == (w == 1))
  end
endmodule

bind msn_registers cover_registers u_cover (.offset(bus_address_i[1:0]), .*);
