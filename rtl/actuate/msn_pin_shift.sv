// SPDX-License-Identifier: Apache-2.0
//
// Shifts the pins of each slot into chains of high-voltage drivers and latches them all at once (HV507: docs/pin_display.md).
//
//   pin i                       chain i / ChainPins, output i mod ChainPins, counted from where the data go in
//   high                        level > 0 and slot <= level
//
//   clocks after step_i   1 ..   waits while busy_i, then the chains shift side by side, 8 bits and a pause a word
//                         Lead   the latch opens for 100 ns or more: in every slot as long after its beginning
//
// After the first latch the blanking ends. off_i blanks all outputs in the next clock. Polarity is never low, where
// blanking would turn all outputs on, and direction is a constant. Levels come in order before a period's first load.
// Error: none.
// Model: model/meissner/twins/actuate/pin_display.py

module msn_pin_shift #(
  parameter  int unsigned Pins          = 100,
  parameter  int unsigned Chains        = 1,
  parameter  int unsigned AmplitudeBits = 4,
  parameter  int unsigned ClkKhz        = 25_000,
  parameter  int unsigned SclkKhz       = 8_000,  // at most
  parameter  bit          Direction     = 1'b0,   // low: in at DIOA (docs)
  localparam int unsigned SlotBits      = AmplitudeBits + 1
) (
  input  logic                     clk_i,
  input  logic                     rst_i,

  input  logic                     in_valid_i,  // a level
  input  logic [AmplitudeBits-1:0] in_level_i,
  input  logic                     in_last_i,

  input  logic                     running_i,   // msn_pin_phase
  input  logic                     off_i,
  input  logic                     begin_i,
  input  logic                     step_i,
  input  logic [SlotBits-1:0]      slot_i,
  input  logic                     busy_i,      // levels are still to come
  output logic                     busy_o,

  output logic [Chains-1:0]        hv_data_o,
  output logic                     hv_clk_o,
  output logic                     hv_le_o,
  output logic                     hv_bl_o,     // low: blanked
  output logic                     hv_pol_o,
  output logic                     hv_dir_o,
  output logic                     wrap_o       // hv_le_o begins a period
);

  if (Chains < 1 || Chains > 8) begin : gen_check_chains
    $fatal(1, "msn_pin_shift: Chains = %0d must lie in 1 .. 8", Chains);
  end
  if (Pins < 2 || Pins > 4095 || (Chains - 1) * ((Pins + Chains - 1) / Chains) >= Pins) begin : gen_check_pins
    $fatal(1, "msn_pin_shift: Pins = %0d must lie in 2 .. 4095, with some for each of the chains", Pins);
  end
  if (AmplitudeBits < 1 || AmplitudeBits > 6) begin : gen_check_amplitude_bits
    $fatal(1, "msn_pin_shift: AmplitudeBits = %0d must lie in 1 .. 6", AmplitudeBits);
  end
  if (ClkKhz < 1 || SclkKhz < 1) begin : gen_check_khz
    $fatal(1, "msn_pin_shift: SclkKhz = %0d and ClkKhz = %0d must be at least 1", SclkKhz, ClkKhz);
  end

  localparam int unsigned Word      = 8;
  localparam int unsigned ChainPins = (Pins + Chains - 1) / Chains;
  localparam int unsigned ChainBits = (ChainPins + 63) / 64 * 64;  // of whole drivers
  localparam int unsigned Half      = (ClkKhz + 2 * SclkKhz - 1) / (2 * SclkKhz);
  localparam int unsigned Lead      = Pins + ChainBits / Word * (Word + 1) * 2 * Half + 48;
  localparam int unsigned LeClocks  = msn_pkg::clocks_of_ns(100, ClkKhz);

  localparam int unsigned LaneBits     = msn_pkg::index_width(ChainPins);
  localparam int unsigned IndexBits    = msn_pkg::index_width(Chains);
  localparam int unsigned PositionBits = $clog2(ChainBits);
  localparam int unsigned WordBits     = PositionBits - 3;
  localparam int unsigned LeadBits     = $clog2(Lead);
  localparam int unsigned LeBits       = msn_pkg::index_width(LeClocks);

  logic [LaneBits-1:0]     lane_place;            // of the level that comes
  logic [IndexBits-1:0]    lane;
  logic                    loading, loaded, full, final_word, timing, latch, begins;
  logic                    gather, gather_1, gather_2, word_start, word_run, word_done;
  logic [PositionBits-1:0] position;              // from the farthest output on
  logic [3:0]              gathered;              // bits of a word
  logic [WordBits-1:0]     words_left;
  logic [SlotBits-1:0]     slot;
  logic [LeadBits-1:0]     lead;
  logic [LeBits-1:0]       le_clocks;
  assign busy_o     = loading || word_run;
  assign gather     = loading && !busy_i && !gathered[3];
  assign word_start = full && (!word_run || word_done);
  assign latch      = timing && lead == '0 && loaded;

  always_ff @(posedge clk_i) begin
    if (in_valid_i) begin
      lane_place <= (in_last_i || lane_place == LaneBits'(ChainPins - 1)) ? '0 : lane_place + 1'b1;
      lane       <= in_last_i ? '0 : lane + IndexBits'(lane_place == LaneBits'(ChainPins - 1));
    end

    gather_1 <= gather;
    gather_2 <= gather_1;
    if (gather) begin
      gathered <= gathered + 1'b1;
      position <= position - 1'b1;
    end
    if (gather_2 && !gather_1) full <= 1'b1;
    if (word_start) begin
      full       <= 1'b0;
      final_word <= words_left == '0;
      words_left <= words_left - 1'b1;
      if (words_left != '0) gathered <= '0;
    end
    if (word_done && final_word) begin
      loading <= 1'b0;
      loaded  <= 1'b1;
    end
    if (timing) lead <= lead - 1'b1;
    if (step_i) begin
      loading    <= 1'b1;
      loaded     <= 1'b0;
      final_word <= 1'b0;
      slot       <= slot_i;
      position   <= PositionBits'(ChainBits - 1);
      gathered   <= '0;
      words_left <= WordBits'(ChainBits / Word - 1);
      timing     <= 1'b1;
      lead       <= LeadBits'(Lead - 2);
      begins     <= begin_i;
    end else if (lead == '0) begin
      timing <= 1'b0;
    end

    wrap_o <= latch && begins;
    if (latch) begin
      hv_le_o   <= 1'b1;
      le_clocks <= LeBits'(LeClocks - 1);
    end else if (hv_le_o) begin
      le_clocks <= le_clocks - 1'b1;
      if (le_clocks == '0) {hv_le_o, hv_bl_o} <= 2'b01;
    end

    if (off_i || !running_i) begin
      {loading, full, gather_1, gather_2, timing} <= '0;
      {wrap_o, hv_le_o, hv_bl_o}                  <= '0;
    end
    if (rst_i) begin
      lane_place <= '0;
      lane       <= '0;
      {loading, full, gather_1, gather_2, timing} <= '0;
      {wrap_o, hv_le_o, hv_bl_o}                  <= '0;
    end
  end

  assign hv_pol_o = 1'b1;
  assign hv_dir_o = Direction;

  logic [Chains-1:0] runs, dones, clocks_of, unused_word, unused_cs_n;
  assign word_run  = runs[0];
  assign word_done = dones[0];
  assign hv_clk_o  = clocks_of[0];
  for (genvar k = 0; k < Chains; k++) begin : gen_chain
    localparam int unsigned Own = (k == Chains - 1) ? Pins - k * ChainPins : ChainPins;
    logic [AmplitudeBits-1:0] level_n;       // inverted: see msn_pin_limits
    logic                     inside_1, inside_2, above;
    logic [SlotBits-1:0]      unused_above;
    logic [Word-1:0]          word, unused_data;
    msn_ram #(.Words(ChainPins), .Width(AmplitudeBits)) u_levels (
      .clk_i, .write_i(in_valid_i && lane == IndexBits'(k)), .write_address_i(lane_place),
      .write_data_i(~in_level_i),
      .read_i(gather || gather_1), .read_address_i(LaneBits'(position)), .out_data_o(level_n)
    );
    assign {above, unused_above} = {1'b0, slot} + {2'b01, level_n};  // slot > level
    always_ff @(posedge clk_i) begin
      inside_1 <= 32'(position) < Own;
      inside_2 <= inside_1;
      if (gather_2) word <= {word[Word-2:0], inside_2 && level_n != '1 && !above};
    end
    msn_spi_shift #(.Bits(Word), .DataBits(Word), .Half(Half)) u_spi (
      .clk_i, .rst_i, .start_i(word_start), .again_i(1'b0), .command_i(word), .word_o(unused_word[k]),
      .data_o(unused_data), .run_o(runs[k]), .done_o(dones[k]), .spi_cs_n_o(unused_cs_n[k]),
      .spi_sclk_o(clocks_of[k]), .spi_mosi_o(hv_data_o[k]), .spi_miso_i(1'b0)
    );
    logic unused;
    assign unused = ^{unused_data, unused_above, unused_word[k], unused_cs_n[k], runs[k], dones[k],
                      clocks_of[k]};
  end

  msn_check u_polarity (
    .clk_i, .rst_i, .wrong_i(!hv_bl_o && !hv_pol_o)
  );

endmodule
