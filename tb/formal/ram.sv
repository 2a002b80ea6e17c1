// SPDX-License-Identifier: Apache-2.0
//
// Any word (`watch_i`, constant) is at the output with the second read after the one that asks for it, as it was last
// written before, unless it was written in the clock in which it was read; between reads the output holds.

module formal_ram #(
  parameter  int unsigned Words       = 5,
  parameter  int unsigned Width       = 3,
  localparam int unsigned AddressBits = msn_pkg::index_width(Words)
) (
  input logic                   clk_i,
  input logic [AddressBits-1:0] watch_i,
  input logic                   write_i,
  input logic [AddressBits-1:0] write_address_i,
  input logic [Width-1:0]       write_data_i,
  input logic                   read_i,
  input logic [AddressBits-1:0] read_address_i
);

  logic [Width-1:0] out_data_o;
  msn_ram #(.Words(Words), .Width(Width)) dut (.*);

  logic                   started = 1'b0;
  logic                   known, ours, due, read_q;  // written since the start; the watched word was read, is due
  logic [AddressBits-1:0] watch_q;
  logic [Width-1:0]       value, value_read, value_due, out_q;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    watch_q <= watch_i;
    read_q  <= read_i;
    out_q   <= out_data_o;
    if (read_i) begin
      ours       <= known && read_address_i == watch_i && !(write_i && write_address_i == watch_i);
      value_read <= value;
      due        <= ours;
      value_due  <= value_read;
    end
    if (write_i && write_address_i == watch_i) begin
      known <= 1'b1;
      value <= write_data_i;
    end
    if (!started) {known, ours, due} <= '0;
  end

  always_comb begin
    assume (32'(watch_i) < Words && 32'(write_address_i) < Words && 32'(read_address_i) < Words);
    if (started) begin
      assume (watch_i == watch_q);
      if (!read_q) assert (out_data_o == out_q);
      if (due) assert (out_data_o == value_due);
      // Invariant.
      if (known) assert (dut.memory[watch_i] == value);
      if (ours) assert (dut.fetched == value_read);
    end
  end

  always_comb if (started) cover (due && ours && value_due != '0 && value_read == '0);

endmodule
