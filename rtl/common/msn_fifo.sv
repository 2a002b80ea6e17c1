// SPDX-License-Identifier: Apache-2.0
//
// First in, first out: Depth entries in memory and two registers after it. Latency 3 clocks, one entry a clock.
// half_o: Depth / 2 entries or more are in memory, so only Depth / 2 or fewer places are left.
// Model: model/meissner/twins/common/handshake.py

module msn_fifo #(
  parameter int unsigned Depth = 16,  // a power of two
  parameter int unsigned Width = 8
) (
  input  logic             clk_i,
  input  logic             rst_i,

  input  logic             in_valid_i,
  output logic             in_ready_o,
  input  logic [Width-1:0] in_data_i,

  output logic             out_valid_o,
  input  logic             out_ready_i,
  output logic [Width-1:0] out_data_o,
  output logic             half_o
);

  if (Depth < 2 || !msn_pkg::is_power(Depth)) begin : gen_check_depth
    $fatal(1, "msn_fifo: Depth = %0d must be a power of two, 2 or more", Depth);
  end
  if (Width < 1) begin : gen_check_width
    $fatal(1, "msn_fifo: Width = %0d must be at least 1", Width);
  end

  localparam int unsigned PlaceBits = $clog2(Depth);

  (* no_rw_check *) logic [Width-1:0] memory [Depth];
  logic [Width-1:0]   fetched;
  logic [PlaceBits:0] written, read;  // one bit wider than an address, to distinguish full from empty
  logic               put, get, fetched_valid, free, fetch;
  logic               full;          // derived from both pointers in each clock, so that no upset persists
  (* keep *) logic    stays, fills;  // nets of their own: in_valid_i, which comes late, then passes one LUT
  logic               keeps_half, makes_half;
  logic [PlaceBits:0] stored;           // more than Depth after an upset
  assign stored     = written - read;
  assign stays      = stored[PlaceBits] && (!get || stored[PlaceBits-1:0] != '0);
  assign fills      = !stored[PlaceBits] && stored[PlaceBits-1:0] == '1 && !get;  // with a put
  assign keeps_half = stored > (PlaceBits + 1)'(Depth / 2) || (stored == (PlaceBits + 1)'(Depth / 2) && !get);
  assign makes_half = (stored == (PlaceBits + 1)'(Depth / 2 - 1) && !get)
                      || (stored == (PlaceBits + 1)'(Depth / 2) && get);
  assign in_ready_o = !full;
  assign put        = in_valid_i && in_ready_o;
  assign free       = out_ready_i || !out_valid_o;
  assign fetch      = free || !fetched_valid;  // also if empty: its many bits do not wait for the pointers
  assign get        = fetch && written != read;

  always_ff @(posedge clk_i) begin
    if (put) begin
      memory[written[PlaceBits-1:0]] <= in_data_i;
      written <= written + 1'b1;
    end
    if (get)   read    <= read + 1'b1;
    if (fetch) fetched <= memory[read[PlaceBits-1:0]];
    full          <= stays || (fills && in_valid_i && !full);
    half_o        <= keeps_half || (makes_half && put);
    fetched_valid <= get || (fetched_valid && !free);
    if (free) begin
      out_data_o  <= fetched;
      out_valid_o <= fetched_valid;
    end
    if (rst_i) begin
      written       <= '0;
      read          <= '0;
      full          <= 1'b0;
      half_o        <= 1'b0;
      fetched_valid <= 1'b0;
      out_valid_o   <= 1'b0;
    end
  end

  // Reading an entry for use in the clock in which it is written is undefined.
  msn_check u_read_is_not_written (
    .clk_i, .rst_i, .wrong_i(!rst_i && put && get && written[PlaceBits-1:0] == read[PlaceBits-1:0])
  );

endmodule
