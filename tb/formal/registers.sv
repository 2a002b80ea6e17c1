// SPDX-License-Identifier: Apache-2.0
//
// Every access is answered once, two clocks later. An error: an address that is no multiple of four, one outside
// every group, one of a group that is not built, a write to what is only read. An access in error, or to another
// address, changes neither the scratch word nor `adc.enable`; a write changes the bytes its strobes name. Reads give
// the identity and the counters' inputs.

module formal_registers #(
  parameter bit Adc = 1'b1,
  parameter bit Slip = 1'b1,
  parameter bit Scan = 1'b1,
  parameter bit Health = 1'b1,
  parameter bit Tare = 1'b1,
  parameter bit Calibrate = 1'b1,
  parameter bit Cop = 1'b1,
  parameter bit Cop4 = 1'b1,
  parameter bit CopSlip = 1'b1,
  parameter bit Link = 1'b1,
  parameter logic [msn_registers_pkg::ResetBits-1:0] Resets = msn_registers_pkg::Reset
) (
  input logic        clk_i,
  input logic        rst_i,
  input logic        bus_valid_i,
  input logic        bus_write_i,
  input logic [11:0] bus_address_i,
  input logic [31:0] bus_data_i,
  input logic [3:0]  bus_strobe_i,
  input logic [31:0] features_i,
  input logic [31:0] dropped_i
);

  logic        bus_done_o, bus_error_o, adc_enable;
  logic [31:0] bus_data_o, scratch;
  msn_registers #(
    .Adc(Adc), .Slip(Slip), .Scan(Scan), .Health(Health), .Tare(Tare), .Calibrate(Calibrate), .Cop(Cop),
    .Cop4(Cop4), .CopSlip(CopSlip), .Link(Link), .Resets(Resets)
  ) dut (
    .clk_i, .rst_i, .bus_valid_i, .bus_write_i, .bus_address_i, .bus_data_i, .bus_strobe_i, .bus_done_o,
    .bus_error_o, .bus_data_o, .core_features_i(features_i), .core_scratch_o(scratch),
    .adc_enable_o(adc_enable), .adc_dropped_i(dropped_i)
  );

  localparam logic [9:0] Id = 10'h000, Features = 10'h002, Scratch = 10'h005, Enable = 10'h040, Dropped = 10'h042;
  logic        started = 1'b0;
  logic        asked, asked_q, write, write_q;
  logic [11:0] address, address_q;
  logic [31:0] features, dropped, word, word_was;
  logic        enabled, enabled_was, aligned;
  assign aligned = bus_address_i[1:0] == 2'd0;
  always_ff @(posedge clk_i) begin
    started     <= 1'b1;
    asked_q     <= bus_valid_i && !rst_i;
    write_q     <= bus_write_i;
    address_q   <= bus_address_i;
    asked       <= asked_q && !rst_i;
    write       <= write_q;
    address     <= address_q;
    features    <= features_i;
    dropped     <= dropped_i;
    word_was    <= word;
    enabled_was <= enabled;
    if (bus_valid_i && bus_write_i && aligned && bus_address_i[11:2] == Scratch) begin
      for (int unsigned b = 0; b < 4; b++) if (bus_strobe_i[b]) word[8*b+:8] <= bus_data_i[8*b+:8];
    end
    if (Adc && bus_valid_i && bus_write_i && aligned && bus_address_i[11:2] == Enable && bus_strobe_i[0]) begin
      enabled <= bus_data_i[0];
    end
    if (rst_i) begin
      word    <= Resets[31:0];
      enabled <= Resets[32];
    end
  end

  // The words that there are, as docs/registers.md has them.
  logic there;
  assign there = address[11:2] inside {[10'h000:10'h005]}
                 || (Adc && address[11:2] inside {[10'h040:10'h046]})
                 || (Slip && address[11:2] inside {[10'h080:10'h089]})
                 || (Scan && address[11:2] inside {[10'h0c0:10'h0c7]})
                 || (Health && address[11:2] inside {[10'h100:10'h10c]})
                 || (Tare && address[11:2] inside {[10'h120:10'h12c]})
                 || (Calibrate && address[11:2] inside {[10'h140:10'h146]})
                 || (Cop && address[11:2] inside {[10'h180:10'h181]})
                 || (Cop4 && address[11:2] inside {[10'h1c0:10'h1d1]})
                 || (CopSlip && address[11:2] inside {[10'h200:10'h204]})
                 || (Link && address[11:2] inside {[10'h240:10'h244]});

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert (bus_done_o == asked);
      assert (scratch == word && adc_enable == enabled);
      if (bus_done_o) begin
        if (address[1:0] != 2'd0 || !there) assert (bus_error_o);
        else if (!write) assert (!bus_error_o);
        if (bus_error_o && address[1:0] != 2'd0) assert (bus_data_o == '0);
        if (!there) assert (bus_data_o == '0);
        if (write) assert (bus_data_o == '0);
        if (address[1:0] == 2'd0 && !write) begin
          if (address[11:2] == Id) assert (bus_data_o == 32'h4d534e52);
          if (address[11:2] == Features) assert (bus_data_o == features);
          if (address[11:2] == Scratch) assert (bus_data_o == word_was);
          if (Adc && address[11:2] == Enable) assert (bus_data_o == {31'd0, enabled_was});
          if (Adc && address[11:2] == Dropped) assert (bus_data_o == dropped);
        end
        if (write && address[11:2] inside {Id, Features, Dropped}) assert (bus_error_o);
        if (write && address[1:0] == 2'd0 && address[11:2] == Scratch) assert (!bus_error_o);
        if (Adc && write && address[1:0] == 2'd0 && address[11:2] == Enable) assert (!bus_error_o);
      end
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (bus_done_o && !bus_error_o && !write && address[11:2] == Scratch && bus_data_o == 32'hCAFE_0001);
      cover (bus_done_o && bus_error_o && write && address[1:0] == 2'd0);
      cover (bus_done_o && asked && !bus_error_o && address[11:2] == Features && bus_data_o == 32'h1234_5678);
    end
  end

endmodule
