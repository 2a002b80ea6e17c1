// SPDX-License-Identifier: Apache-2.0
//
// Every access causes one access on the bus and one answer: B for a write, R for a read, SLVERR if the bus reports an
// error, with its data. Answers hold until they are taken. A request waits for at most one other access, if answers
// are taken immediately; no READY depends on an input of its clock but the reset, in which all are low. Assumed: the master holds a request (AXI), the bus answers after two clocks (`registers`).

module formal_axil (
  input logic        clk_i,
  input logic        rst_i,
  input logic        s_axil_awvalid,
  input logic [11:0] s_axil_awaddr,
  input logic [2:0]  s_axil_awprot,
  input logic        s_axil_wvalid,
  input logic [31:0] s_axil_wdata,
  input logic [3:0]  s_axil_wstrb,
  input logic        s_axil_bready,
  input logic        s_axil_arvalid,
  input logic [11:0] s_axil_araddr,
  input logic [2:0]  s_axil_arprot,
  input logic        s_axil_rready,
  input logic        bus_error_i,
  input logic [31:0] bus_rdata_i
);

  logic        s_axil_awready, s_axil_wready, s_axil_bvalid, s_axil_arready, s_axil_rvalid;
  logic [1:0]  s_axil_bresp, s_axil_rresp;
  logic [31:0] s_axil_rdata, bus_wdata_o;
  logic        bus_valid_o, bus_write_o, bus_asked, bus_done_i;
  logic [11:0] bus_address_o;
  logic [3:0]  bus_strobe_o;
  msn_axil dut (.*);

  logic        started = 1'b0;
  logic        wrote, read, b, r, aw_waits, w_waits, ar_waits, b_waits, r_waits;
  logic [51:0] asked_w;
  logic [15:0] asked_aw, asked_ar;
  logic        write_open, read_open, answered, error;  // an access is under way; the bus has answered it
  logic [31:0] word;
  logic [3:0]  write_wait, read_wait;
  logic        due_write, due_read;      // READY of this clock, from what waited in the clock before
  assign wrote = s_axil_awvalid && s_axil_awready;
  assign read  = s_axil_arvalid && s_axil_arready;
  assign b     = s_axil_bvalid && s_axil_bready;
  assign r     = s_axil_rvalid && s_axil_rready;
  // Where nothing is under way, what waits is taken in the next clock; of two the one that was not served last.
  logic open, both, last_write, next_write, next_read;
  assign open = due_write || due_read || ((write_open || read_open) && !(b || r));
  assign both = s_axil_awvalid && s_axil_wvalid && s_axil_arvalid;
  assign next_write = !open && s_axil_awvalid && s_axil_wvalid && !(both && last_write);
  assign next_read  = !open && s_axil_arvalid && !(s_axil_awvalid && s_axil_wvalid && !(both && last_write));
  always_ff @(posedge clk_i) begin
    started    <= 1'b1;
    bus_asked  <= bus_valid_o && !rst_i;
    bus_done_i <= bus_asked && !rst_i;
    aw_waits   <= s_axil_awvalid && !s_axil_awready && !rst_i;
    w_waits    <= s_axil_wvalid && !s_axil_wready && !rst_i;
    ar_waits   <= s_axil_arvalid && !s_axil_arready && !rst_i;
    b_waits    <= s_axil_bvalid && !s_axil_bready && !rst_i;
    r_waits    <= s_axil_rvalid && !s_axil_rready && !rst_i;
    asked_aw   <= {s_axil_awaddr, s_axil_awprot, 1'b0};
    asked_w    <= {s_axil_wdata, s_axil_wstrb, 16'b0};
    asked_ar   <= {s_axil_araddr, s_axil_arprot, 1'b0};
    due_write <= !rst_i && next_write;
    due_read  <= !rst_i && next_read;
    if (wrote || read) last_write <= wrote;
    if (b) write_open <= 1'b0;
    if (r) read_open <= 1'b0;
    if (bus_done_i) {answered, error, word} <= {1'b1, bus_error_i, bus_rdata_i};
    if (b || r) answered <= 1'b0;
    if (wrote) write_open <= 1'b1;
    if (read) read_open <= 1'b1;
    if (!(s_axil_awvalid && s_axil_wvalid) || wrote || b_waits || r_waits || !s_axil_bready || !s_axil_rready) begin
      write_wait <= '0;
    end else write_wait <= write_wait + 1'b1;
    if (!s_axil_arvalid || read || b_waits || r_waits || !s_axil_bready || !s_axil_rready) read_wait <= '0;
    else read_wait <= read_wait + 1'b1;
    if (rst_i) begin
      {write_open, read_open, answered, last_write} <= '0;
      write_wait <= '0;
      read_wait  <= '0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      if (aw_waits) assume (s_axil_awvalid && asked_aw == {s_axil_awaddr, s_axil_awprot, 1'b0});
      if (w_waits) assume (s_axil_wvalid && asked_w == {s_axil_wdata, s_axil_wstrb, 16'b0});
      if (ar_waits) assume (s_axil_arvalid && asked_ar == {s_axil_araddr, s_axil_arprot, 1'b0});
    end
    if (started && !rst_i) begin
      // one access at a time, address and data together, each once to the bus
      assert (s_axil_awready == s_axil_wready);
      assert (s_axil_awready == due_write && s_axil_arready == due_read);
      assert (bus_valid_o == (wrote || read) && !(wrote && read));
      if (wrote || read) assert (!write_open && !read_open && bus_write_o == wrote);
      if (wrote) assert (bus_address_o == {s_axil_awaddr[11:2], 2'b00});
      if (wrote) assert (bus_wdata_o == s_axil_wdata && bus_strobe_o == s_axil_wstrb);
      if (read) assert (bus_address_o == {s_axil_araddr[11:2], 2'b00});
      // its answer
      assert (s_axil_bvalid == (write_open && answered) && s_axil_rvalid == (read_open && answered));
      if (s_axil_bvalid) assert (s_axil_bresp == {error, 1'b0});
      if (s_axil_rvalid) assert (s_axil_rresp == {error, 1'b0} && s_axil_rdata == word);
      if (b_waits) assert (s_axil_bvalid);
      if (r_waits) assert (s_axil_rvalid);
    end
    if (rst_i) assert (!s_axil_awready && !s_axil_wready && !s_axil_arready);
    if (started) assert (write_wait <= 4'd7 && read_wait <= 4'd7);
  end

  // Invariant.
  always_comb begin
    if (started) begin
      assert (dut.asked == {bus_done_i, bus_asked});
      assert (!(write_open && read_open) && dut.accept == (due_write || due_read) && !(due_write && due_read));
      if (dut.accept) assert (dut.writes == due_write && !write_open && !read_open);
      else assert (dut.writes == last_write);
      if (due_write) assert (aw_waits && w_waits);
      if (due_read) assert (ar_waits);
      if (write_open || read_open) assert (last_write == write_open);
      assert (!answered || write_open || read_open);
      assert ((bus_asked || bus_done_i) == ((write_open || read_open) && !answered) && !(bus_asked && bus_done_i));
      assert (s_axil_bvalid == (write_open && answered) && s_axil_rvalid == (read_open && answered));
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (b && s_axil_bresp == 2'b10 && s_axil_arvalid);
      cover (r && s_axil_rresp == 2'b00 && b_waits == 1'b0 && s_axil_awvalid && s_axil_wvalid);
      cover (r_waits && r);
    end
  end

endmodule
