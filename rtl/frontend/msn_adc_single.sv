// SPDX-License-Identifier: Apache-2.0
//
// One channel of an MCP3208 at one rate, for the smallest builds: a single counter of the clocks in a period gives
// all timing, so a bit lasts a power of two of clocks and the period is a parameter. docs/adc.md has the sources.
//
//   clocks after convert_o   0                  CS falls
//                            BitClocks*k + 1    bit k is launched; SCLK rises half a bit later
//                            BitClocks*19 + 1   out_valid_o, and CS rises
//
// Conversions start every Period clocks while cfg_enable_i, whatever the consumer does; if the sample before still
// waits at the start, the new one is read from the part and dropped (dropped_o). msn_adc_spi supports more channels,
// other parts and a period in a register.
// Error: none.
// Model: model/meissner/twins/frontend/adc_single.py

module msn_adc_single #(
  parameter int unsigned Channel    = 0,
  parameter int unsigned ClkKhz     = 12_000,
  parameter int unsigned SclkKhz    = 2_000,  // upper bound
  parameter int unsigned Period     = 1_200,  // clocks from convert start to convert start
  parameter int unsigned SampleBits = 13
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         cfg_enable_i,

  output logic                         adc_cs_n_o,
  output logic                         adc_sclk_o,
  output logic                         adc_mosi_o,
  input  logic                         adc_miso_i,

  output logic                         convert_o,     // CS falls with this strobe

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [SampleBits-1:0] out_data_o,
  output logic                         out_user_o,    // over-range

  output logic [31:0]                  dropped_o,
  output logic [31:0]                  over_range_o   // samples sent with out_user_o
);

  localparam int unsigned Part       = msn_pkg::AdcMcp3208;
  localparam int unsigned DataBits   = msn_adc_pkg::data_bits(Part);
  localparam int unsigned WordBits   = msn_adc_pkg::word_bits(Part);
  localparam int unsigned PhaseBits  = $clog2(2 * msn_adc_pkg::half_clocks(Part, ClkKhz, SclkKhz));
  localparam int unsigned BitClocks  = 1 << PhaseBits;
  localparam int unsigned FrameBits  = PhaseBits + $clog2(WordBits + 1);
  localparam int unsigned PeriodBits = $clog2(Period);

  if (Channel > 7) begin : gen_check_channel
    $fatal(1, "msn_adc_single: Channel = %0d must lie in 0 .. 7", Channel);
  end
  if (ClkKhz < 1 || ClkKhz > 400_000) begin : gen_check_clk
    $fatal(1, "msn_adc_single: ClkKhz = %0d must lie in 1 .. 400000", ClkKhz);
  end
  if (SclkKhz < 1 || SclkKhz > msn_adc_pkg::sclk_max_khz(Part)) begin : gen_check_sclk
    $fatal(1, "msn_adc_single: SclkKhz = %0d must lie in 1 .. %0d", SclkKhz, msn_adc_pkg::sclk_max_khz(Part));
  end
  if (ClkKhz < BitClocks * msn_adc_pkg::sclk_min_khz(Part)) begin : gen_check_droop
    $fatal(1, "msn_adc_single: SclkKhz = %0d is too slow: the sample droops before it is out", SclkKhz);
  end
  if (Period < (WordBits + 1) * BitClocks + 1) begin : gen_check_period
    $fatal(1, "msn_adc_single: Period = %0d must be at least %0d", Period, (WordBits + 1) * BitClocks + 1);
  end
  if (SampleBits < DataBits + 1) begin : gen_check_sample_bits
    $fatal(1, "msn_adc_single: SampleBits = %0d must hold a code of %0d bits", SampleBits, DataBits);
  end

  // When a counter from 0 up first has all the ones of a number set, it has reached the number: compare only these.
  localparam logic [PeriodBits-1:0]          Last = PeriodBits'(Period - 1);
  localparam logic [FrameBits-PhaseBits-1:0] Over = (FrameBits - PhaseBits)'(WordBits);

  logic [PeriodBits-1:0]          clock;
  logic [FrameBits-PhaseBits-1:0] place;  // the bit of the word
  logic                           wrap, over, bit_end;
  assign wrap    = (clock & Last) == Last;
  assign place   = clock[FrameBits-1:PhaseBits];
  assign over    = (place & Over) == Over;
  assign bit_end = &clock[PhaseBits-1:0];

  // Start bit, single-ended, channel; the part ignores the rest.
  logic [31:0] command;
  assign command = {27'b0, Channel[0], Channel[1], Channel[2], 2'b11};

  logic                drop;
  logic [DataBits-1:0] code;
  always_ff @(posedge clk_i) begin
    clock      <= wrap ? '0 : clock + 1'b1;
    convert_o  <= wrap && cfg_enable_i;
    adc_cs_n_o <= !(wrap && cfg_enable_i) && (adc_cs_n_o || over);
    adc_sclk_o <= clock[PhaseBits-1] && !adc_cs_n_o;
    adc_mosi_o <= command[5'(place)];

    if (wrap) drop <= out_valid_o && !out_ready_i;
    if (bit_end && !adc_cs_n_o && !drop) code <= {code[DataBits-2:0], adc_miso_i};
    out_valid_o <= (over && !adc_cs_n_o && !drop) || (out_valid_o && !out_ready_i);

    dropped_o    <= dropped_o + 32'(over && !adc_cs_n_o && drop);
    over_range_o <= over_range_o + 32'(out_valid_o && out_ready_i && out_user_o);

    if (rst_i) begin
      clock        <= '0;
      convert_o    <= 1'b0;
      adc_cs_n_o   <= 1'b1;
      out_valid_o  <= 1'b0;
      dropped_o    <= '0;
      over_range_o <= '0;
    end
  end

  assign out_data_o = SampleBits'({1'b0, code});
  assign out_user_o = &code || ~|code;

endmodule
