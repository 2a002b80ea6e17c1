// SPDX-License-Identifier: Apache-2.0
//
// SPI words, most significant bit first, on one or more DOUT lanes.
//
// A bit lasts 2*Half clocks: SCLK rests for the first half and is active for the second. Both sides launch their
// next bit at its end (SCLK returns to rest; CS falling launches the first bit). With Lead, SCLK is active for the
// first half and rests for the second, and the first bit begins Half clocks after CS falls. After a CS frame, CS
// stays high for the time of one more bit.
//
//   clocks after start_i   1 .. 2*Half*Bits   CS low, SCLK runs                          all Half later with Lead
//                          2*Half*Bits        word_o, data_o (and CS rises unless again_i)
//                          2*Half*(Bits+1)    done_o; start_i may come again in this clock
//
// DOUT is sampled by one register, 2*Half-1 clocks after the edge that launched the bit: this leaves a full SCLK
// period less one clock for the part's delay, instead of the half period that sampling at SCLK's edge would leave.
// Tested in tb/frontend/test_adc_spi.py   Model: model/meissner/twins/frontend/spi_shift.py

module msn_spi_shift #(
  parameter int unsigned Bits     = 19,  // SCLK periods of a word
  parameter int unsigned DataBits = 12,  // this many last bits are kept
  parameter int unsigned Lanes    = 1,
  parameter int unsigned Half     = 13,  // clocks in half an SCLK period
  parameter bit          IdleHigh = 1'b0,
  parameter bit          Lead     = 1'b0
) (
  input  logic                      clk_i,
  input  logic                      rst_i,

  input  logic                      start_i,
  input  logic                      again_i,    // at word_o: the next word follows in the same CS frame
  input  logic [DataBits-1:0]       command_i,  // sent from its top bit on
  output logic                      word_o,
  output logic [Lanes*DataBits-1:0] data_o,     // lane 0 lowest
  output logic                      run_o,      // from the clock after start_i to done_o
  output logic                      done_o,

  output logic                      spi_cs_n_o,
  output logic                      spi_sclk_o,
  output logic                      spi_mosi_o,
  input  logic [Lanes-1:0]          spi_miso_i
);

  if (Half < 1) begin : gen_check_half
    $fatal(1, "msn_spi_shift: Half = %0d must be at least 1", Half);
  end
  if (DataBits < 2 || DataBits > Bits) begin : gen_check_data_bits
    $fatal(1, "msn_spi_shift: DataBits = %0d must lie in 2 .. Bits", DataBits);
  end

  localparam int unsigned HalfBits  = msn_pkg::index_width(Half);
  localparam int unsigned IndexBits = msn_pkg::index_width(Bits);

  logic                      second_q;  // in the second half of a bit
  logic                      lead_q;    // in the half bit before the first one
  logic                      sclk_q;    // SCLK is active; unlike second_q low while CS is high
  logic [HalfBits-1:0]       half_q;
  logic [IndexBits-1:0]      left_q;    // bits of this word after the present one
  logic [Lanes-1:0]          miso_q;
  logic [Lanes*DataBits-1:0] shift_q;

  logic half_end, bit_end;
  assign half_end = run_o && half_q == '0;
  assign bit_end  = half_end && second_q && !lead_q;
  assign done_o   = bit_end && spi_cs_n_o;

  // Used to compute the end of a word's last bit, bit_end && !spi_cs_n_o && left_q == 0, a clock ahead: this block
  // lies near the pins, far from the block that takes the word.
  logic ahead;
  assign ahead = (Half > 1) ? half_q == HalfBits'(1) && second_q && !lead_q : !second_q;

  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_lane
    assign data_o[lane*DataBits +: DataBits] = {shift_q[lane*DataBits +: DataBits-1], miso_q[lane]};
  end

  always_ff @(posedge clk_i) begin
    miso_q <= spi_miso_i;
    word_o <= run_o && ahead && !spi_cs_n_o && left_q == '0;

    half_q <= (start_i || half_end) ? HalfBits'(Half - 1) : half_q - 1'b1;
    if (start_i || word_o) left_q <= IndexBits'(Bits - 1);
    else if (bit_end)      left_q <= left_q - 1'b1;

    if (start_i)      shift_q <= (Lanes*DataBits)'(command_i);
    else if (bit_end) shift_q <= data_o;

    // The lead counts as a second half that belongs to no bit.
    second_q <= start_i ? Lead : (second_q ^ half_end);
    lead_q   <= start_i ? Lead : (lead_q && !half_end);
    // CS is still low at word_o: with Lead, SCLK becomes active there only if another word follows.
    sclk_q   <= run_o && !start_i && (sclk_q ^ (half_end && !spi_cs_n_o && !(Lead && word_o && !again_i)));

    // An upset of run_o ends the word: the pins rest.
    if (start_i)                             spi_cs_n_o <= 1'b0;
    else if (!run_o || (word_o && !again_i)) spi_cs_n_o <= 1'b1;
    if (start_i)                             run_o <= 1'b1;
    else if (done_o)                         run_o <= 1'b0;

    if (rst_i) begin
      run_o      <= 1'b0;
      word_o     <= 1'b0;
      second_q   <= 1'b0;
      lead_q     <= 1'b0;
      sclk_q     <= 1'b0;
      spi_cs_n_o <= 1'b1;
    end
  end

  // One register for both directions: after the command, received bits are sent out again, which all parts ignore.
  assign spi_mosi_o = shift_q[DataBits-1];
  assign spi_sclk_o = sclk_q ^ IdleHigh;

endmodule
