// SPDX-License-Identifier: Apache-2.0
//
// On the pins, with Lead = 0 as in all shipped configurations: SCLK keeps each level for at least Half clocks, rests
// while CS is high and first changes Half clocks after CS fell; CS is high for at least 2 Half clocks. A word has Bits
// periods; its received and sent bits are in their places. start_i comes at rest or with done_o (assumed; proof adc_spi
// shows it).

module formal_spi_shift #(
  parameter int unsigned Bits     = 19,
  parameter int unsigned DataBits = 12,
  parameter int unsigned Lanes    = 1,
  parameter int unsigned Half     = 13,
  parameter bit          IdleHigh = 1'b0,
  parameter bit          Lead     = 1'b0
) (
  input logic                clk_i,
  input logic                rst_i,
  input logic                start_i,
  input logic                again_i,
  input logic [DataBits-1:0] command_i,
  input logic [Lanes-1:0]    spi_miso_i
);

  logic                      word_o, run_o, done_o, spi_cs_n_o, spi_sclk_o, spi_mosi_o;
  logic [Lanes*DataBits-1:0] data_o;
  msn_spi_shift #(
    .Bits(Bits), .DataBits(DataBits), .Lanes(Lanes), .Half(Half), .IdleHigh(IdleHigh), .Lead(Lead)
  ) dut (.*);

  // The pins, counted in clocks.
  logic        started = 1'b0;
  logic        cs_n, driven, driven_q, risen;
  logic [11:0] level_for, high_for;  // clocks of SCLK's level in this CS frame; of CS high
  assign driven = spi_sclk_o != IdleHigh;

  // Progress of a word: clocks in the present bit, bits before it; tail: CS is high for the time of one more bit.
  logic                      busy, tail, bit_end;
  logic [11:0]               at;
  logic [7:0]                index;
  logic [Lanes-1:0]          miso;
  logic [Lanes*DataBits-1:0] shifted, next;
  assign bit_end = busy && at == 12'(2 * Half - 1);
  for (genvar l = 0; l < Lanes; l++) begin : gen_lane
    assign next[l*DataBits+:DataBits] = {shifted[l*DataBits+:DataBits-1], miso[l]};
  end
  always_ff @(posedge clk_i) begin
    started   <= 1'b1;
    miso      <= spi_miso_i;
    cs_n      <= spi_cs_n_o;
    driven_q  <= driven;
    level_for <= (spi_cs_n_o || cs_n || driven != driven_q) ? 12'd1 : level_for + 12'd1;
    high_for  <= !spi_cs_n_o ? '0 : (high_for == '1) ? '1 : high_for + 1'b1;
    if (!spi_cs_n_o) risen <= 1'b1;
    if (busy) at <= bit_end ? '0 : at + 1'b1;
    if (bit_end) begin
      shifted <= next;
      index   <= index + 1'b1;
      if (tail) busy <= 1'b0;
      else if (index == 8'(Bits - 1)) begin
        index <= '0;
        tail  <= !again_i;
      end
    end
    if (start_i) begin
      busy    <= 1'b1;
      tail    <= 1'b0;
      at      <= '0;
      index   <= '0;
      shifted <= (Lanes * DataBits)'(command_i);
    end
    if (rst_i) begin
      busy  <= 1'b0;
      risen <= 1'b0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (start_i) assume (!busy || (tail && bit_end));
    if (started) begin
      assert (spi_cs_n_o == !(busy && !tail));
      assert (driven == (busy && !tail && at >= 12'(Half)));
      assert (word_o == (bit_end && !tail && index == 8'(Bits - 1)) && done_o == (bit_end && tail));
      if (word_o) assert (data_o == next);
      if (busy && !tail) assert (spi_mosi_o == shifted[DataBits-1]);
      // the part's minimum times, in clocks
      if (spi_cs_n_o) assert (!driven);
      if (!spi_cs_n_o && !cs_n && driven != driven_q) assert (level_for >= 12'(Half));
      if (!spi_cs_n_o && cs_n && risen) assert (!driven && high_for >= 12'(2 * Half));
    end
  end

  // Invariant.
  localparam int unsigned HalfBits = msn_pkg::index_width(Half);
  always_comb begin
    if (started) begin
      assert (run_o == busy);
      if (!risen) assert (!busy || at == '0);
      if (busy) begin
        assert (at < 12'(2 * Half) && (tail || index < 8'(Bits)));
        assert (dut.half_q == HalfBits'((at < 12'(Half)) ? 12'(Half - 1) - at : 12'(2 * Half - 1) - at));
        assert (dut.second_q == (at >= 12'(Half)) && !dut.lead_q);
        assert (dut.sclk_q == (at >= 12'(Half) && !tail));
        if (!tail) assert (8'(dut.left_q) == 8'(Bits - 1) - index);
        assert (dut.miso_q == miso && dut.shift_q == shifted);
        if (tail) assert (index == '0 && (cs_n || at == '0) && high_for >= at && risen);
        if (!tail && at != '0) assert (risen);
        if (!tail && !cs_n && at != '0 && at != 12'(Half)) begin
          assert (level_for == ((at < 12'(Half)) ? at : at - 12'(Half)));
        end
        if (!tail && at == 12'(Half)) assert (level_for == 12'(Half));
        if (!tail && !cs_n && at == '0) assert (level_for == 12'(Half) && driven_q);
        if (!tail && at != '0) assert (!cs_n && driven_q == (at > 12'(Half)));
        if (!tail && at == '0 && cs_n) assert (!driven_q && index == '0 && (!risen || high_for >= 12'(2 * Half)));
      end else begin
        assert (!dut.sclk_q && spi_cs_n_o);
        if (risen) assert (high_for >= 12'(2 * Half));
      end
    end
  end

  always_comb begin
    if (started && !rst_i && Half < 4) begin
      cover (word_o && again_i);
      cover (done_o && start_i);
      cover (word_o && data_o[DataBits-1:0] == {DataBits{1'b1}});
    end
    cover (started && !rst_i && driven && index == 8'd1);
    cover (started && rst_i && driven);
  end

endmodule
