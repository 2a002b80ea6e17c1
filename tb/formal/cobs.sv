// SPDX-License-Identifier: Apache-2.0
//
// On the line: 00, the packet's bytes with a code in place of each zero and after the last byte, 00. There is no other
// 00; a code is one more than the number of bytes since the code before it. Every byte is taken once, in order.
// Assumed: packets of at most MaxBytes and a source that holds its byte.

module formal_cobs #(
  parameter int unsigned MaxBytes = 253
) (
  input logic       clk_i,
  input logic       rst_i,
  input logic       in_begin_i,
  input logic       in_valid_i,
  input logic [7:0] in_data_i,
  input logic       in_last_i,
  input logic       out_ready_i
);

  logic       in_ready_o, out_valid_o;
  logic [7:0] out_data_o;
  msn_cobs #(.MaxBytes(MaxBytes)) dut (.*);

  logic       started = 1'b0;
  logic       take, give, in_stalled, out_stalled, last, begun, ended, coded;
  logic [7:0] data, out_data;
  logic [8:0] length, run;  // bytes of the packet so far; those since the last code
  assign take = in_valid_i && in_ready_o;
  assign give = out_valid_o && out_ready_i;
  always_ff @(posedge clk_i) begin
    started     <= 1'b1;
    in_stalled  <= in_valid_i && !in_ready_o && !rst_i;
    out_stalled <= out_valid_o && !out_ready_i && !rst_i;
    data        <= in_data_i;
    last        <= in_last_i;
    out_data    <= out_data_o;
    // begun: the first 00 is out; ended: the last byte is taken; coded: its code is out
    if (give) begin
      begun <= 1'b1;
      if (ended) coded <= 1'b1;
      if (coded) {begun, ended, coded} <= '0;
      if (take && in_last_i) ended <= 1'b1;
      run    <= (!begun || ended || (take && in_data_i == '0)) ? '0 : run + 1'b1;
      length <= !begun ? '0 : take ? length + 1'b1 : length;
    end
    if (rst_i) {begun, ended, coded} <= '0;
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started && in_stalled) assume (in_valid_i && in_data_i == data && in_last_i == last);
    if (started && in_valid_i && begun && !ended && 32'(length) == MaxBytes - 1) assume (in_last_i);
    if (started) assume (!out_stalled || in_begin_i || in_valid_i || begun);
    if (started && !rst_i) begin
      if (out_stalled) assert (out_valid_o && out_data_o == out_data);
      if (take) assert (give && begun && !ended);
      if (give && begun && !ended) assert (take);
      assert (out_valid_o == (!begun ? in_begin_i || in_valid_i : !ended ? in_valid_i : 1'b1));
      if (out_valid_o) begin
        if (!begun || coded) assert (out_data_o == '0);
        else begin
          assert (out_data_o != '0);
          if (ended || in_data_i == '0) assert (9'(out_data_o) == run + 9'd1);
          else assert (out_data_o == in_data_i);
        end
      end
    end
  end

  // Invariant.
  always_comb begin
    if (started) begin
      assert (2'(dut.state) == {ended, begun && (!ended || coded)});
      assert (!ended || begun);
      assert (!coded || ended);
      if (begun) assert (9'(dut.count) == run + 9'd1 || coded);
      if (begun) assert (run <= length && 32'(length) <= MaxBytes);
      if (begun && !ended) assert (32'(length) < MaxBytes);
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (give && coded && length == 9'd3);
      cover (give && ended && !coded && run == 9'd0);
      cover (out_stalled && give && take);
    end
  end

endmodule
