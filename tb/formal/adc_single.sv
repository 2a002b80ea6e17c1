// SPDX-License-Identifier: Apache-2.0
//
// CS and SCLK of an MCP3208, in clocks at the pins and against the data sheet's figures at 5 V: duration of SCLK's
// levels, CS to the first edge, CS high between conversions. Conversions start every Period clocks while enabled; the
// command is sent bit by bit; the last bits received are the sample, which holds until it is taken and is dropped if
// the one before still waits; the counters.

module formal_adc_single #(
  parameter int unsigned Channel    = 0,
  parameter int unsigned ClkKhz     = 12_000,
  parameter int unsigned SclkKhz    = 2_000,
  parameter int unsigned Period     = 1_200,
  parameter int unsigned SampleBits = 13
) (
  input logic clk_i,
  input logic rst_i,
  input logic cfg_enable_i,
  input logic adc_miso_i,
  input logic out_ready_i
);

  logic                         adc_cs_n_o, adc_sclk_o, adc_mosi_o, convert_o, out_valid_o, out_user_o;
  logic signed [SampleBits-1:0] out_data_o;
  logic [31:0]                  dropped_o, over_range_o;
  msn_adc_single #(
    .Channel(Channel), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz), .Period(Period), .SampleBits(SampleBits)
  ) dut (.*);

  localparam longint unsigned Clock = 64'd1_000_000_000 / ClkKhz;                            // ps
  localparam int unsigned     Level = 32'((64'd250_000 + Clock - 1) / Clock);                // clocks
  localparam int unsigned     Lead  = 32'((64'd100_000 + Clock - 1) / Clock);
  localparam int unsigned     Rest  = 32'((64'd500_000 + Clock - 1) / Clock);
  localparam int unsigned     Bit   = 1 << $clog2(2 * msn_adc_pkg::half_clocks(msn_pkg::AdcMcp3208, ClkKhz, SclkKhz));
  localparam int unsigned     End   = 19 * Bit;

  logic started = 1'b0, warm;

  // The period, from reset on; a conversion takes its first 19 bits.
  localparam int unsigned Turn = $clog2(Bit);
  localparam logic [31:0] Command = {27'b0, Channel[0], Channel[1], Channel[2], 2'b11};
  logic [$clog2(Period)-1:0] grid;
  logic                      low, drop, valid, mosi;
  logic [11:0]               code;
  logic [31:0]               dropped, over_range;
  logic                      ends, edged;
  assign ends  = low && 32'(grid) == End;
  assign edged = code == '0 || code == '1;
  always_ff @(posedge clk_i) begin
    warm  <= started;
    grid  <= (32'(grid) == Period - 1) ? '0 : grid + 1'b1;
    low   <= (32'(grid) == Period - 1) ? cfg_enable_i : low && !ends;
    mosi  <= Command[5'(32'(grid) >> Turn & ((1 << $clog2(20)) - 1))];
    if (32'(grid) == Period - 1) drop <= valid && !out_ready_i;
    if (low && !drop && (32'(grid) & (Bit - 1)) == Bit - 1) code <= {code[10:0], adc_miso_i};
    valid      <= (ends && !drop) || (valid && !out_ready_i);
    dropped    <= dropped + 32'(ends && drop);
    over_range <= over_range + 32'(valid && out_ready_i && edged);
    if (rst_i) begin
      grid       <= '0;
      low        <= 1'b0;
      valid      <= 1'b0;
      dropped    <= '0;
      over_range <= '0;
    end
  end
  always_comb begin
    if (started) begin
      assert (adc_cs_n_o == !low && convert_o == (low && grid == '0) && (!warm || adc_mosi_o == mosi));
      assert (out_valid_o == valid && (!valid || (out_user_o == edged && out_data_o == SampleBits'({1'b0, code}))));
      assert (dropped_o == dropped && over_range_o == over_range);
    end
  end

  // Invariant: all bits of the sample received so far are known.
  logic [31:0] came;
  logic [11:0] known;
  assign came  = 32'(grid) >> Turn;
  assign known = (came >= 32'd12) ? '1 : 12'((32'd1 << came) - 32'd1);
  always_comb begin
    if (started) begin
      assert (dut.clock == grid);
      if (low) assert (32'(grid) <= End && dut.drop == drop && (drop || !valid));
      if (low && !drop) assert (((dut.code ^ code) & known) == '0);
      if (valid) assert (dut.code == code);
    end
  end

  logic        cs_n, sclk, risen;
  logic [15:0] sclk_for, cs_for;
  logic [7:0]  rises;  // of SCLK in this CS frame
  always_ff @(posedge clk_i) begin
    started  <= 1'b1;
    cs_n     <= adc_cs_n_o;
    sclk     <= adc_sclk_o;
    sclk_for <= (adc_sclk_o != sclk) ? 16'd1 : (sclk_for == '1) ? '1 : sclk_for + 1'b1;
    cs_for   <= (adc_cs_n_o != cs_n) ? 16'd1 : (cs_for == '1) ? '1 : cs_for + 1'b1;
    if (!adc_cs_n_o) risen <= 1'b1;
    if (adc_cs_n_o) rises <= '0;
    else if (adc_sclk_o && !sclk) rises <= rises + 1'b1;
    if (rst_i) risen <= 1'b0;
    if (rst_i) sclk_for <= '1;
    if (rst_i) cs_for <= '1;
  end

  logic reset_q;  // the pins may be cut short by reset
  always_ff @(posedge clk_i) reset_q <= rst_i;
  always_comb begin
    if (!started) assume (rst_i);
    if (started && !rst_i && !reset_q) begin
      if (adc_sclk_o != sclk && !(adc_cs_n_o && cs_n)) assert (sclk_for >= 16'(Level));
      if (adc_sclk_o && !sclk) assert (!adc_cs_n_o && !cs_n && cs_for >= 16'(Lead));
      if (!adc_cs_n_o && cs_n && risen) assert (cs_for >= 16'(Rest));
      if (adc_cs_n_o && !cs_n) assert (rises == 8'd19 && cs_for == 16'(End + 1));
      if (!adc_cs_n_o) assert (rises <= 8'd19);
    end
  end

  // Invariant: the position in the period. The pins follow the counter by a clock.
  logic [15:0] at, phase, turn;
  assign at    = 16'(dut.clock);
  assign phase = (at == '0) ? '0 : (at - 16'd1) & 16'(Bit - 1);
  assign turn  = (at - 16'd1) / 16'(Bit);
  always_comb begin
    if (started) begin
      assert (at < 16'(Period));
      if (!adc_cs_n_o) begin
        assert (at <= 16'(End) && risen == (at != '0 || risen));
        if (at != '0) begin
          assert (adc_sclk_o == (phase >= 16'(Bit / 2)));
          assert (rises == 8'(turn) + 8'(phase > 16'(Bit / 2)));
          assert (cs_for == at && !cs_n && risen);
          if (phase == 16'(Bit / 2)) assert (!sclk && (sclk_for >= 16'(Bit / 2)));
          else if (phase == '0) assert (at == 16'd1 ? !sclk && sclk_for >= 16'(Bit / 2) : sclk && sclk_for >= 16'(Bit / 2));
          else assert (sclk == adc_sclk_o && sclk_for >= 16'((phase - 16'd1) & 16'(Bit / 2 - 1)) + 16'd1);
        end else begin
          assert (cs_n && !adc_sclk_o && !sclk && sclk_for >= 16'(Bit / 2) && (!risen || cs_for >= 16'(Rest)));
        end
      end else begin
        if (at > 16'(End + 1)) assert (!adc_sclk_o && !sclk);
        if (at > 16'(End + 1) && risen && !reset_q) assert (cs_n && cs_for >= at - 16'(End + 1));
        if (at > 16'(End + 1)) assert (sclk_for >= at - 16'(End + 1) || sclk_for >= 16'(Bit / 2));
        if (at == 16'(End + 1) && !cs_n) assert (rises == 8'd19 && cs_for == 16'(End + 1) && (sclk && sclk_for >= 16'(Bit / 2) && !adc_sclk_o));
        if (at == 16'(End + 1) && cs_n) assert (!adc_sclk_o && !sclk && sclk_for >= 16'(Bit / 2) && (!risen || cs_for >= 16'(End)));
        if (at >= 16'd2 && at <= 16'(End)) assert (!adc_sclk_o && !sclk && cs_n && (sclk_for >= 16'(Bit / 2) || sclk_for >= at - 16'd1));
        if (at <= 16'(End) && risen) assert (cs_for >= 16'(Period - End - 1) + at);
      end
    end
  end

  // A conversion is a period away from reset: only short periods reach a complete one.
  always_comb begin
    if (started && !rst_i && Period < 100) begin
      cover (adc_cs_n_o && !cs_n);
      cover (!adc_cs_n_o && cs_n && risen);
    end
    cover (started && !rst_i && risen == 1'b0 && at == 16'd5 && cfg_enable_i);
  end

endmodule
