// SPDX-License-Identifier: Apache-2.0
//
// The converter's minima on CS and SCLK: the master starts a word only at rest or when CS has been high for a bit's
// time, for which proof `spi_shift` shows what the pins do; and that many clocks of half a bit are long enough, by the
// figures of the data sheets. No conversion starts during a read, none is read during a conversion.

module formal_adc_spi #(
  parameter  int unsigned Part       = msn_pkg::AdcMcp3208,
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned ClkKhz     = 25_000,
  parameter  int unsigned SclkKhz    = 2_000,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned PeriodBits = 24,
  parameter  bit          Trigger    = 1'b0,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input logic                  clk_i,
  input logic                  rst_i,
  input logic                  cfg_enable_i,
  input logic [PeriodBits-1:0] cfg_period_i,
  input logic                  trigger_i,
  input logic [Lanes-1:0]      adc_miso_i,
  input logic                  adc_busy_i,
  input logic                  out_ready_i
);

  logic                         adc_cs_n_o, adc_sclk_o, adc_mosi_o, adc_convst_o, adc_reset_o, ready_o, convert_o, lost_o;
  logic                         out_valid_o, out_last_o, out_user_o;
  logic signed [SampleBits-1:0] out_data_o;
  logic [IdBits-1:0]            out_id_o;
  logic [31:0]                  dropped_o, overrun_o, timeout_o, mistagged_o, over_range_o;
  msn_adc_spi #(
    .Part(Part), .Channels(Channels), .Lanes(Lanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz),
    .SampleBits(SampleBits), .PeriodBits(PeriodBits), .Trigger(Trigger)
  ) dut (.*);

  // ps, at the voltages of docs/adc.md: SCLK low and high, its period, CS to the first edge, CS high.
  localparam bit              Mcp3208 = Part == msn_pkg::AdcMcp3208;
  localparam longint unsigned Period  = Mcp3208 ? 500_000 : 68_966;
  localparam longint unsigned Level   = Mcp3208 ? 250_000 : 27_587;
  localparam longint unsigned Lead    = Mcp3208 ? 100_000 : 0;
  localparam longint unsigned Rest    = Mcp3208 ? 500_000 : 22_000;
  localparam int unsigned     Half    = msn_adc_pkg::half_clocks(Part, ClkKhz, SclkKhz);
  localparam longint unsigned Clock   = 64'd1_000_000_000 / ClkKhz;  // ps
  if (Part != msn_pkg::AdcMcp3208 && Part != msn_pkg::AdcAd7606) begin : gen_check_part
    $fatal(1, "formal_adc_spi: no figures of part %0d", Part);
  end

  logic started = 1'b0;
  logic was_low, convst;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    was_low <= !adc_cs_n_o && !rst_i;
    convst  <= adc_convst_o;
  end

  // For proof `spi_shift`: its parameters, and when a word starts.
  logic reading;
  assign reading = dut.u_shift.run_q;
  always_comb begin
    if (!started) assume (rst_i);
    assert (Clock * Half >= Level && Clock * Half >= Lead);
    assert (Clock * 2 * Half >= Period && Clock * 2 * Half >= Rest);
    if (started && !rst_i) begin
      if (dut.u_shift.start_i) assert (!reading || dut.u_shift.done_o);
      if (adc_convst_o && !convst) assert (adc_cs_n_o && !was_low);
      if (!adc_cs_n_o) assert (!adc_convst_o);
    end
  end

  // Invariant: it reads in the states that read.
  always_comb begin
    if (started) begin
      assert (reading == (dut.state_q == 3'd5 || dut.state_q == 3'd1));
      assert (dut.state_q <= 3'd5);
      assert (reading || adc_cs_n_o);
      if (reading && adc_cs_n_o && !dut.CsPerChannel) assert (dut.word_q == '0);  // the rest after the last word
      if (dut.u_shift.word_o) assert (reading && !adc_cs_n_o && dut.u_shift.bit_end);
      if (reading) assert (!adc_convst_o);
      if (!dut.HasBusy) assert (!adc_convst_o && dut.state_q != 3'd3 && dut.state_q != 3'd4);
      if (dut.SetupWords == 0) assert (dut.state_q != 3'd1);
      if (!started) assert (!convst);
    end
  end

  always_comb begin
    if (started && !rst_i) cover (dut.u_shift.start_i || dut.state_q == 3'd0);
    if (started && !rst_i && Mcp3208) cover (!adc_cs_n_o && adc_sclk_o);
  end

endmodule
