// SPDX-License-Identifier: Apache-2.0
//
// SPI master for the converters of msn_pkg::adc_part_e; msn_adc_pkg describes them, docs/adc.md has the sources.
//
// Conversions start every cfg_period_i clocks (0: 2^PeriodBits) while cfg_enable_i, or a clock after each trigger_i,
// whatever the consumer and the transfer do. Each tick gives one of: a frame sent completely; a frame dropped
// entirely, as a sample of the frame before still waited at its start (dropped_o); a frame given up, as BUSY did not
// answer (timeout_o) or an answer had another channel's number (mistagged_o: the part is then set up again); no
// conversion, as the frame before was still under way (overrun_o). All but the first raise lost_o.
// A frame that an upset ends counts as dropped; its first samples may have left.
// ReadDuring: the next frame may be converted while one is read. A frame is then dropped if a sample waited as its
// read began; a tick whose BUSY could fall in a read, or too soon after it, is an overrun; a frame whose BUSY does is
// given up. wait_i: a read waits for the BUSY of converters that share CS, but no longer than a conversion can last.
// After reset the part is first reset or set up; then ticks begin.
//
// The twin, model/meissner/twins/frontend/adc_spi.py, gives all latencies as functions.
// Error: none.

module msn_adc_spi #(
  parameter  int unsigned Part       = msn_pkg::AdcMcp3208,  // msn_pkg::adc_part_e
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned ClkKhz     = 25_000,
  parameter  int unsigned SclkKhz    = msn_adc_pkg::sclk_default_khz(Part),  // upper bound
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned PeriodBits = 24,
  parameter  bit          Trigger    = 1'b0,  // 1: trigger_i starts each conversion, cfg_period_i is not used
  parameter  bit          ReadDuring = 1'b0,  // 1: a frame is read while the next one is converted
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic                         cfg_enable_i,
  input  logic [PeriodBits-1:0]        cfg_period_i,  // clocks from convert start to convert start
  input  logic                         trigger_i,

  output logic                         adc_cs_n_o,
  output logic                         adc_sclk_o,
  output logic                         adc_mosi_o,
  input  logic [Lanes-1:0]             adc_miso_i,
  output logic                         adc_convst_o,
  input  logic                         adc_busy_i,
  output logic                         adc_reset_o,
  output logic                         busy_o,        // BUSY, after its synchroniser
  input  logic                         wait_i,        // that of others

  output logic                         ready_o,       // the part has been reset or set up
  output logic                         convert_o,     // strobe: CONVST rises (without CONVST: CS falls)
  output logic                         read_o,        // strobe: CS of a frame's first word falls
  output logic                         lost_o,        // strobe: a tick gives no samples (one for two at once)

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [SampleBits-1:0] out_data_o,
  output logic [IdBits-1:0]            out_id_o,
  output logic                         out_last_o,
  output logic                         out_user_o,    // over-range

  output logic [31:0]                  dropped_o,
  output logic [31:0]                  overrun_o,
  output logic [31:0]                  timeout_o,
  output logic [31:0]                  mistagged_o,
  output logic [31:0]                  over_range_o   // samples sent with out_user_o
);

  localparam int unsigned DataBits     = msn_adc_pkg::data_bits(Part);
  localparam int unsigned Half         = msn_adc_pkg::half_clocks(Part, ClkKhz, SclkKhz);
  localparam int unsigned LaneChannels = msn_adc_pkg::lane_channels(Lanes);
  localparam int unsigned Words        = msn_adc_pkg::frame_words(Part, Channels, Lanes);
  localparam int unsigned SetupWords   = msn_adc_pkg::setup_words(Part);
  localparam int unsigned WordBits     = msn_pkg::index_width((Words > SetupWords) ? Words : SetupWords);
  localparam int unsigned KeptBits     = msn_adc_pkg::kept_bits(Part);
  localparam bit          Tagged       = msn_adc_pkg::has_tag(Part);
  localparam bit          Signed       = msn_adc_pkg::is_signed(Part);
  localparam bit          HasBusy      = msn_adc_pkg::has_busy(Part);
  localparam bit          CsPerChannel = msn_adc_pkg::cs_per_channel(Part);
  localparam int unsigned WatchBits    = msn_adc_pkg::watch_bits(Part, ClkKhz, ReadDuring);
  localparam int unsigned BusyClocks   = msn_adc_pkg::busy_clocks(Part, ClkKhz);
  localparam int unsigned WatchEnd     = ReadDuring ? BusyClocks + 3 : (1 << WatchBits) - 1;
  localparam int unsigned LowBits      = ReadDuring ? 2 : 1;  // of watch_q: CONVST is high while these are 0
  localparam int unsigned During       = msn_adc_pkg::guard_clocks(Part, ClkKhz, Half, Words);
  localparam int unsigned Guard        = ReadDuring ? During : 1;
  localparam int unsigned GuardBits    = msn_pkg::index_width(Guard);
  localparam bit          HasReset     = msn_adc_pkg::has_reset(Part);
  localparam bit          NeedsStart   = HasReset || SetupWords > 0;
  // A part without RESET is idle before its setup as long as the reset of a part with RESET takes.
  localparam int unsigned RestClocks   = msn_pkg::clocks_of_ns(msn_adc_pkg::start_ns(Part), ClkKhz);
  localparam int unsigned ResetClocks  = msn_pkg::clocks_of_ns(msn_adc_pkg::reset_ns(Part), ClkKhz);
  localparam int unsigned StartClocks  = ResetClocks + RestClocks;
  localparam int unsigned StartBits    = msn_pkg::index_width(StartClocks);

  if (!msn_adc_pkg::known(Part)) begin : gen_check_part
    $fatal(1, "msn_adc_spi: Part = %0d must be one of msn_pkg::adc_part_e", Part);
  end
  if (Channels < 1 || Channels > 8) begin : gen_check_channels
    $fatal(1, "msn_adc_spi: Channels = %0d must lie in 1 .. 8", Channels);
  end
  if (Lanes < 1 || !msn_pkg::is_power(Lanes) || Lanes > msn_adc_pkg::max_lanes(Part)) begin : gen_check_lanes
    $fatal(1, "msn_adc_spi: Lanes = %0d must be a power of two, at most %0d", Lanes,
           msn_adc_pkg::max_lanes(Part));
  end
  if (Lanes > 1 && Channels <= msn_adc_pkg::lane_channels(Lanes)) begin : gen_check_lane_use
    $fatal(1, "msn_adc_spi: Lanes = %0d must be 1: one lane has all %0d Channels", Lanes, Channels);
  end
  if (ClkKhz < 1 || ClkKhz > 400_000) begin : gen_check_clk
    $fatal(1, "msn_adc_spi: ClkKhz = %0d must lie in 1 .. 400000", ClkKhz);
  end
  // By the time that an answer is through the synchroniser, a shorter watchdog has ended.
  if (HasBusy && ClkKhz * msn_adc_pkg::conversion_max_ns(Part) <= 2_000_000) begin : gen_check_busy
    $fatal(1, "msn_adc_spi: ClkKhz = %0d must be more than 2 clocks in a conversion", ClkKhz);
  end
  if (SclkKhz < 1 || SclkKhz > msn_adc_pkg::sclk_max_khz(Part)) begin : gen_check_sclk
    $fatal(1, "msn_adc_spi: SclkKhz = %0d must lie in 1 .. %0d", SclkKhz, msn_adc_pkg::sclk_max_khz(Part));
  end
  if (ClkKhz < 2 * Half * msn_adc_pkg::sclk_min_khz(Part)) begin : gen_check_droop
    $fatal(1, "msn_adc_spi: SclkKhz = %0d is too slow: the sample droops before it is out", SclkKhz);
  end
  if (SampleBits < DataBits + 32'(!Signed)) begin : gen_check_sample_bits
    $fatal(1, "msn_adc_spi: SampleBits = %0d must hold a code of %0d bits", SampleBits, DataBits);
  end
  if (PeriodBits < 1 || PeriodBits > 32) begin : gen_check_period_bits
    $fatal(1, "msn_adc_spi: PeriodBits = %0d must lie in 1 .. 32", PeriodBits);
  end
  if (ReadDuring && !HasBusy) begin : gen_check_read_during
    $fatal(1, "msn_adc_spi: ReadDuring = 1 must go with a part that has BUSY");
  end

  typedef enum logic [2:0] {
    Reset,     // RESET is high, then low for the same time; CS is high
    Setup,     // sends the words that set the part up
    Idle,      // ReadDuring: in this and the next two a frame may be read
    BusyRise,  // CONVST is high, BUSY has not risen yet
    BusyFall,  // converting
    Read
  } state_e;

  state_e                state_q, state_d;
  logic [PeriodBits-1:0] left_q;   // clocks to the next tick
  logic [WatchBits-1:0]  watch_q;  // clocks spent waiting for BUSY
  logic [WordBits-1:0]   word_q;   // back at 0 after the last word of a frame or of the setup
  logic [GuardBits-1:0]  guard_q;  // clocks in which no conversion may start, as BUSY could fall in the read
  logic                  await_q;  // wait_i counts: a conversion may still run
  logic                  begun_q;  // ReadDuring: a frame is converted
  logic                  open_q;   // a frame is under way (ReadDuring: read), not stored completely
  logic                  drop_q;   // this frame is dropped
  logic                  over_q;   // a sample was sent with out_user_o
  logic                  ready_q;  // the part has been reset or set up
  logic                  bad_q;    // an answer of this frame had another channel's number
  logic                  busy, busy_q, fallen;
  logic                  enable, tick, frame, waits, give_up, read, running, done, word, word_last, frame_end;
  logic                  pending, bad, setup, reads, rests, early, astray, over, stored, failed, missed;
  logic                  overrun, cut;
  logic [StartBits-1:0]  start_q;
  logic [Lanes*KeptBits-1:0] kept;
  logic [Lanes*DataBits-1:0] data;

  assign ready_o   = ready_q;
  assign enable    = cfg_enable_i && ready_q;
  assign tick      = Trigger ? (cfg_enable_i && trigger_i) : (enable && left_q == '0);
  assign frame     = tick && state_q == Idle && (ReadDuring ? guard_q == '0 : !running);
  assign overrun   = tick && !frame;
  assign word_last = word_q == (setup ? WordBits'(SetupWords - 1) : WordBits'(Words - 1));
  assign reads     = ReadDuring ? !setup : state_q == Read;
  assign frame_end = done && word_q == '0 && reads;
  assign waits     = HasBusy && (state_q == BusyRise || state_q == BusyFall) &&
                     (ReadDuring ? begun_q : open_q && !running);
  assign fallen    = state_q == BusyFall && !busy && !(await_q && wait_i);
  assign early     = ReadDuring && fallen && running;
  assign give_up   = waits && (watch_q == WatchBits'(WatchEnd) || early);

  // The states in which the shifter runs and rests; after an upset of either, the state follows the shifter.
  assign setup  = SetupWords > 0 && state_q == Setup;
  assign rests  = state_q == Reset || state_q == Idle || waits;
  assign astray = !running ? !rests : !setup && (ReadDuring ? state_q == Reset || !rests : state_q != Read);

  // A frame that is over and still open gave no samples, or an upset ended it.
  assign over   = frame_end || setup || (ReadDuring ? !running : give_up || !(running || waits));
  assign failed = begun_q && (give_up || !waits);
  assign missed = over && open_q;
  assign cut    = (missed && (ReadDuring || !give_up) && (drop_q || !bad_q)) || (failed && !give_up);

  // Wait for BUSY to rise first: if it is stuck high, or still high from the frame before, its fall means nothing.
  always_comb begin
    state_d = state_q;
    case (state_q)
      Reset:    if (start_q == '0) state_d = (SetupWords > 0) ? Setup : Idle;
      Setup:    if (done && word_q == '0) state_d = Idle;
      Idle:     if (ReadDuring ? frame : tick) state_d = HasBusy ? BusyRise : Read;
      BusyRise: if (busy && !busy_q) state_d = BusyFall;
      BusyFall: if (fallen) state_d = ReadDuring ? Idle : Read;
      default:  if (frame_end) state_d = (Tagged && bad_q) ? Setup : Idle;
    endcase
    if (give_up) state_d = Idle;
    if (astray)  state_d = (running && !ReadDuring) ? Read : Idle;
  end

  // True where state_d becomes Read or Setup, BusyRise or BusyFall, but written without state_d for timing: the
  // trigger, a word's end and the pins' registers are far apart.
  logic resumed, set_up, converting;
  assign resumed = HasBusy ? waits && fallen && !give_up : frame;
  assign set_up  = SetupWords > 0 &&
                   ((state_q == Reset && start_q == '0 && !running) || (frame_end && Tagged && bad_q));
  // The watchdog's first half outlasts any conversion; CONVST is low in the second, to rise at the next tick.
  // ReadDuring: it is low from half of the longest conversion on, or earlier.
  assign converting = (HasBusy && frame) || (waits && !give_up && !fallen &&
                                             watch_q[WatchBits-1-:LowBits] == '0);
  assign read    = resumed || set_up || (CsPerChannel && done && word_q != '0);

  always_ff @(posedge clk_i) begin
    state_q   <= state_d;
    busy_q    <= busy;
    left_q    <= !enable ? '0 : tick ? cfg_period_i - 1'b1 : left_q - 1'b1;
    watch_q   <= waits ? watch_q + 1'b1 : '0;
    convert_o <= frame;
    read_o    <= resumed;
    lost_o    <= failed || missed || overrun;
    await_q   <= frame || (await_q && watch_q != WatchBits'(BusyClocks + 1));
    begun_q   <= ReadDuring && (frame || (begun_q && !failed && !resumed));
    open_q    <= (ReadDuring ? resumed : frame) || (open_q && !over && !stored);
    if (resumed)            guard_q <= GuardBits'(Guard - 1);
    else if (guard_q != '0) guard_q <= guard_q - 1'b1;
    ready_q   <= ready_q || state_q == Idle;
    // Full outside Reset, so that an upset into this state resets the part for as long.
    start_q   <= (state_q == Reset) ? start_q - 1'b1 : StartBits'(StartClocks - 1);

    adc_reset_o <= HasReset && state_q == Reset && !running && start_q >= StartBits'(RestClocks);

    // Samples left at the tick or the read's start; the first word arrives later. BUSY that falls in a read tears it.
    if (ReadDuring ? read_o : convert_o) drop_q <= pending;
    if (ReadDuring && running && busy_q && !busy) drop_q <= 1'b1;
    if (frame || word) bad_q <= !frame && (bad_q || bad);
    if (!running)  word_q <= '0;  // it is 0 already, unless an upset stopped the shifter
    else if (word) word_q <= word_last ? '0 : word_q + 1'b1;

    adc_convst_o <= converting;

    dropped_o   <= dropped_o + 32'(cut);
    overrun_o   <= overrun_o + 32'(overrun);
    timeout_o   <= timeout_o + 32'((ReadDuring ? failed : missed) && give_up);
    mistagged_o <= mistagged_o + 32'(missed && bad_q && !drop_q);

    // A clock later, as the path from the samples to the sum is long.
    over_q       <= out_valid_o && out_ready_i && out_user_o;
    over_range_o <= over_range_o + 32'(over_q);

    if (rst_i) begin
      state_q      <= NeedsStart ? Reset : Idle;
      ready_q      <= !NeedsStart;
      start_q      <= StartBits'(StartClocks - 1);
      adc_reset_o  <= HasReset;
      left_q       <= '0;
      word_q       <= '0;
      convert_o    <= 1'b0;
      read_o       <= 1'b0;
      guard_q      <= '0;
      begun_q      <= 1'b0;
      open_q       <= 1'b0;
      lost_o       <= 1'b0;
      adc_convst_o <= 1'b0;
      dropped_o    <= '0;
      overrun_o    <= '0;
      timeout_o    <= '0;
      mistagged_o  <= '0;
      over_q       <= 1'b0;
      over_range_o <= '0;
    end
  end

  msn_sync u_busy (
    .clk_i, .in_data_i(adc_busy_i), .out_data_o(busy)
  );
  assign busy_o = busy;

  // The AD7606 has no DIN.
  logic mosi;
  logic [15:0] command;
  assign command    = (state_d == Setup) ? msn_adc_pkg::setup_word(Part, Lanes, 3'(word_q))
                                         : msn_adc_pkg::command(Part, 3'(word_q));
  assign adc_mosi_o = CsPerChannel && mosi;
  logic unused_command;
  assign unused_command = ^command;

  // A tagged answer belongs to the command in the word before.
  logic [IdBits-1:0] store_word;
  logic              store_valid;
  assign stored = store_valid && word_last && !drop_q && !bad_q && !bad;
  if (Tagged) begin : gen_tagged
    logic [WordBits-1:0] answer;
    assign answer      = word_q - 1'b1;
    assign store_word  = IdBits'(answer);
    assign store_valid = word && state_q == Read && word_q != '0;
    assign bad         = store_valid && kept[15:12] != 4'(answer);
    assign data        = kept[11-:DataBits];
    logic unused_kept;
    assign unused_kept = ^kept;
  end else begin : gen_plain
    assign store_word  = IdBits'(word_q);
    assign store_valid = word && (SetupWords == 0 || reads);
    assign bad         = 1'b0;
    assign data        = kept;
  end

  msn_spi_shift #(
    .Bits(msn_adc_pkg::word_bits(Part)), .DataBits(KeptBits), .Lanes(Lanes), .Half(Half),
    .IdleHigh(msn_adc_pkg::idles_high(Part)), .Lead(msn_adc_pkg::leads(Part))
  ) u_shift (
    .clk_i, .rst_i,
    .start_i(read), .again_i(!CsPerChannel && !word_last), .command_i(command[15-:KeptBits]), .word_o(word),
    .data_o(kept), .run_o(running), .done_o(done),
    .spi_cs_n_o(adc_cs_n_o), .spi_sclk_o(adc_sclk_o), .spi_mosi_o(mosi), .spi_miso_i(adc_miso_i)
  );

  msn_adc_store #(
    .Channels(Channels), .Lanes(Lanes), .LaneChannels(LaneChannels), .DataBits(DataBits),
    .SampleBits(SampleBits), .Signed(Signed), .Whole(Tagged)
  ) u_store (
    .clk_i, .rst_i,
    // Not convert_o or read_o: an upset of it would begin a frame within a frame.
    .begin_i    (ReadDuring ? resumed : frame),
    .in_valid_i(store_valid && !drop_q), .in_word_i(store_word), .in_data_i(data), .in_bad_i(bad_q || bad),
    .pending_o(pending),
    .out_valid_o, .out_ready_i, .out_data_o, .out_id_o, .out_last_o, .out_user_o
  );

endmodule
