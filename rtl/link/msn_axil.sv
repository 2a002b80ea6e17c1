// SPDX-License-Identifier: Apache-2.0
//
// AXI4-Lite to the register bus (msn_registers): one access at a time, answered once; if a write and a read both
// wait, they take turns. An access that the bus reports as an error answers SLVERR, all others OKAY. The low two
// bits of an address are ignored: WSTRB selects the bytes of the word.
// No READY depends on a VALID of the same clock, and all are low in reset: address and data are taken together, a clock
// after both are there.
//
//   clock  0                   1                3           4
//          address (and data)  READY, the bus   bus_done_i  BVALID or RVALID, until taken
//
// Model: model/meissner/twins/link/axil.py

module msn_axil (
  input  logic        clk_i,
  input  logic        rst_i,

  input  logic        s_axil_awvalid,
  output logic        s_axil_awready,
  input  logic [11:0] s_axil_awaddr,
  input  logic [2:0]  s_axil_awprot,
  input  logic        s_axil_wvalid,
  output logic        s_axil_wready,
  input  logic [31:0] s_axil_wdata,
  input  logic [3:0]  s_axil_wstrb,
  output logic        s_axil_bvalid,
  input  logic        s_axil_bready,
  output logic [1:0]  s_axil_bresp,
  input  logic        s_axil_arvalid,
  output logic        s_axil_arready,
  input  logic [11:0] s_axil_araddr,
  input  logic [2:0]  s_axil_arprot,
  output logic        s_axil_rvalid,
  input  logic        s_axil_rready,
  output logic [31:0] s_axil_rdata,
  output logic [1:0]  s_axil_rresp,

  output logic        bus_valid_o,
  output logic        bus_write_o,
  output logic [11:0] bus_address_o,
  output logic [31:0] bus_wdata_o,
  output logic [3:0]  bus_strobe_o,
  input  logic        bus_done_i,
  input  logic        bus_error_i,
  input  logic [31:0] bus_rdata_i
);

  // No access is accepted before the answer to the last is taken: the bus holds at most one. `free` is derived from
  // the access under way; a separate flag would stay wrong after an upset.
  logic       accept, writes;  // an access in this clock; it, or the last one, is a write
  logic [1:0] asked;
  logic       free, taken, write_waits, some_waits;
  assign taken       = (s_axil_bvalid && s_axil_bready) || (s_axil_rvalid && s_axil_rready);
  assign free        = !accept && asked == '0 && (taken || !(s_axil_bvalid || s_axil_rvalid));
  assign write_waits = s_axil_awvalid && s_axil_wvalid;
  assign some_waits  = write_waits || s_axil_arvalid;

  assign s_axil_awready = accept && writes && !rst_i;
  assign s_axil_wready  = s_axil_awready;
  assign s_axil_arready = accept && !writes && !rst_i;

  // A request that is withdrawn, which AXI forbids, is no access.
  assign bus_valid_o   = (s_axil_awready && write_waits) || (s_axil_arready && s_axil_arvalid);
  assign bus_write_o   = writes;
  assign bus_address_o = {writes ? s_axil_awaddr[11:2] : s_axil_araddr[11:2], 2'b00};
  assign bus_wdata_o   = s_axil_wdata;
  assign bus_strobe_o  = s_axil_wstrb;

  logic [1:0] response;
  assign s_axil_bresp = response;
  assign s_axil_rresp = response;

  always_ff @(posedge clk_i) begin
    accept <= free && some_waits;
    if (free && some_waits) writes <= write_waits && !(s_axil_arvalid && writes);
    asked <= {asked[0], bus_valid_o};
    if (taken) begin
      s_axil_bvalid <= 1'b0;
      s_axil_rvalid <= 1'b0;
    end
    if (bus_done_i) begin
      s_axil_bvalid <= writes;
      s_axil_rvalid <= !writes;
      response      <= {bus_error_i, 1'b0};
      s_axil_rdata  <= bus_rdata_i;
    end
    if (rst_i) begin
      accept        <= 1'b0;
      asked         <= '0;
      writes        <= 1'b0;
      s_axil_bvalid <= 1'b0;
      s_axil_rvalid <= 1'b0;
    end
  end

  logic unused_bits;
  assign unused_bits = ^{s_axil_awprot, s_axil_arprot, s_axil_awaddr[1:0], s_axil_araddr[1:0]};

endmodule
