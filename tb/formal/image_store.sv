// SPDX-License-Identifier: Apache-2.0
//
// A taxel read from an image, two clocks after its address, is the value written there, for any taxel (`watch_i`,
// constant), while read_valid_o offers the image, with the time of its first taxel. Only images whose `last` is at
// their end are read, and of these the newest one complete when reading begins; an image being read stays. The others,
// damaged or not read, are counted.

module formal_image_store #(
  parameter  int unsigned Taxels      = 4096,
  localparam int unsigned AddressBits = msn_pkg::index_width(Taxels)
) (
  input logic                   clk_i,
  input logic                   rst_i,
  input logic [AddressBits-1:0] watch_i,
  input logic                   in_valid_i,
  input logic [15:0]            in_data_i,
  input logic                   in_last_i,
  input logic [47:0]            in_time_i,
  input logic                   read_begun_i,
  input logic                   read_done_i,
  input logic [AddressBits-1:0] read_address_i
);

  logic        read_valid_o;
  logic [47:0] read_time_o;
  logic [15:0] read_data_o;
  logic [31:0] dropped_o;
  msn_image_store #(.Taxels(Taxels)) dut (.*);

  // The incoming image: the place reached; complete, and no taxel of the next has come; or too long.
  logic        started = 1'b0;
  logic [16:0] place, watch;
  logic        whole, long, ends, take, fresh;
  logic [15:0] taxel, shown, fetched, due;  // the watched taxel: as written, in the image to read, on its way out
  logic [47:0] moment, shown_moment;
  logic        valid, fetched_known, due_known, moves;
  logic [31:0] losses, lost;
  assign watch = 17'(watch_i);
  assign ends  = 32'(place) == Taxels - 1;
  assign take  = in_valid_i && !long;
  assign fresh = take && place == '0;
  assign moves = whole && !read_begun_i && !read_done_i;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    if (take) begin
      place <= (in_last_i || ends) ? '0 : place + 1'b1;
      long  <= ends && !in_last_i;
      if (place == watch) taxel <= in_data_i;
      if (fresh) moment <= in_time_i;
    end
    if (in_valid_i && in_last_i) long <= 1'b0;
    if (moves || fresh) whole <= 1'b0;
    if (take && in_last_i && ends) whole <= 1'b1;
    if (read_done_i) valid <= 1'b0;
    if (moves) begin
      valid        <= 1'b1;
      shown        <= taxel;
      shown_moment <= moment;
    end
    losses        <= 32'(take && in_last_i != ends) + 32'(fresh && whole && !moves) + 32'(moves && valid);
    lost          <= lost + losses;
    fetched       <= shown;
    // Until a reader begins, an image may be replaced in the clock in which a taxel is read.
    fetched_known <= valid && !moves && 17'(read_address_i) == watch;
    due           <= fetched;
    due_known     <= fetched_known;
    if (rst_i) begin
      place         <= '0;
      long          <= 1'b0;
      whole         <= 1'b0;
      valid         <= 1'b0;
      losses        <= '0;
      lost          <= '0;
      fetched_known <= 1'b0;
      due_known     <= 1'b0;
    end
  end

  logic [AddressBits-1:0] watch_q;
  always_ff @(posedge clk_i) watch_q <= watch_i;
  always_comb begin
    if (!started) assume (rst_i);
    assume (32'(watch_i) < Taxels);
    if (started) begin
      assume (watch_i == watch_q);
      assert (read_valid_o == valid && dropped_o == lost);
      if (valid) assert (read_time_o == shown_moment);
      // Reading a place in the clock in which it is written is undefined.
      if (valid && (read_begun_i || read_done_i) && in_valid_i) assert (dut.dropping || (dut.bank ^ dut.move) == dut.bank);
      if (due_known) assert (read_data_o == due);
    end
  end

  // Invariant.
  always_comb begin
    if (started) begin
      assert ((long || 17'(dut.place) == place) && 32'(place) < Taxels && dut.dropping == long && dut.held == whole);
      assert (32'(dut.drops) == losses);
      if (long) assert (place == '0 && !whole);
      if (whole) assert (place == '0);
      if (place != '0 || whole) assert (dut.written_time == moment);
    end
  end
  always_comb begin
    if (started) begin
      if (place > watch || whole) assert (dut.u_taxels.memory[{dut.bank, watch_i}] == taxel);
      if (valid) assert (dut.u_taxels.memory[{!dut.bank, watch_i}] == shown);
      if (fetched_known) assert (dut.u_taxels.fetched == fetched);
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      if (Taxels < 16) cover (due_known && due == 16'h1234 && lost != '0);
      if (Taxels < 16) cover (moves && valid);
      cover (long || place == 17'd5 || Taxels < 6);
    end
  end

endmodule
