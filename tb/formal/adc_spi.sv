// SPDX-License-Identifier: Apache-2.0
//
// The converter's minimum times on CS and SCLK: the master starts a word only at rest or when CS has been high for the
// time of a bit (what the pins do then is proof `spi_shift`), and half a bit has enough clocks for the figures of the
// data sheets. No conversion starts during a read, and none is read before it ends. The clocks in which the master
// ticks, starts, waits for BUSY, gives up, reads and ends; what it sends and stores of a word; losses and counters; no
// code is overwritten before it has left. For the tagged parts (MAX1112x) the same, with their setup and channel
// numbers, but without figures. ReadDuring: a conversion starts during a read only if that ends 25 ns before the next
// fall of BUSY, at the earliest, and the shifter rests before the next read; BUSY that falls during a read starts none.

module formal_adc_spi #(
  parameter  int unsigned Part       = msn_pkg::AdcMcp3208,
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned Lanes      = 1,
  parameter  int unsigned ClkKhz     = 25_000,
  parameter  int unsigned SclkKhz    = 2_000,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned PeriodBits = 24,
  parameter  bit          Trigger    = 1'b0,
  parameter  bit          ReadDuring = 1'b0,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input logic                  clk_i,
  input logic                  rst_i,
  input logic                  cfg_enable_i,
  input logic [PeriodBits-1:0] cfg_period_i,
  input logic                  trigger_i,
  input logic [Lanes-1:0]      adc_miso_i,
  input logic                  adc_busy_i,
  input logic                  wait_i,
  input logic                  out_ready_i
);

  logic                         adc_cs_n_o, adc_sclk_o, adc_mosi_o, adc_convst_o, adc_reset_o, busy_o, ready_o, convert_o, read_o, lost_o;
  logic                         out_valid_o, out_last_o, out_user_o;
  logic signed [SampleBits-1:0] out_data_o;
  logic [IdBits-1:0]            out_id_o;
  logic [31:0]                  dropped_o, overrun_o, timeout_o, mistagged_o, over_range_o;
  msn_adc_spi #(
    .Part(Part), .Channels(Channels), .Lanes(Lanes), .ClkKhz(ClkKhz), .SclkKhz(SclkKhz),
    .SampleBits(SampleBits), .PeriodBits(PeriodBits), .Trigger(Trigger),
    .ReadDuring(ReadDuring)
  ) dut (.*);

  // ps, at the voltages of docs/adc.md: SCLK low and high, its period, CS to the first edge, CS high.
  localparam bit              Mcp3208 = Part == msn_pkg::AdcMcp3208;
  localparam bit              Ad7606c = Part == msn_pkg::AdcAd7606c;
  localparam bit              Fast    = SclkKhz > 14_500;  // an AD7606 with a VDRIVE of 3.3 V or more
  localparam longint unsigned Period  = Mcp3208 ? 500_000 : Ad7606c ? 16_667 : Fast ? 58_824 : 68_966;
  localparam longint unsigned Level   = Mcp3208 ? 250_000 : Ad7606c ? 6_667 : Fast ? 23_530 : 27_587;
  localparam longint unsigned Lead    = Mcp3208 ? 100_000 : 0;
  localparam longint unsigned Rest    = Mcp3208 ? 500_000 : 22_000;
  localparam int unsigned     Half    = msn_adc_pkg::half_clocks(Part, ClkKhz, SclkKhz);
  localparam longint unsigned Clock   = 64'd1_000_000_000 / ClkKhz;  // ps
  localparam bit              Tagged  = msn_adc_pkg::has_tag(Part);  // no figures are checked for these

  logic started = 1'b0;
  logic was_low, convst;
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    was_low <= !adc_cs_n_o && !rst_i;
    convst  <= adc_convst_o;
  end

  // What proof `spi_shift` assumes: its parameters, and when a word starts.
  logic reading;
  assign reading = dut.running;
  always_comb begin
    if (!started) assume (rst_i);
    assert (Tagged || (Clock * Half >= Level && Clock * Half >= Lead));
    assert (Tagged || (Clock * 2 * Half >= Period && Clock * 2 * Half >= Rest));
    if (started && !rst_i) begin
      if (dut.u_shift.start_i) assert (!reading || dut.u_shift.done_o);
      if (!ReadDuring && adc_convst_o && !convst) assert (adc_cs_n_o && !was_low);
      if (!ReadDuring && !adc_cs_n_o) assert (!adc_convst_o);
    end
  end

  // A model of the master, written from its rules.
  localparam bit          HasBusy    = msn_adc_pkg::has_busy(Part);
  localparam bit          HasReset   = msn_adc_pkg::has_reset(Part);
  localparam bit          Selects    = msn_adc_pkg::cs_per_channel(Part);
  localparam int unsigned Words      = msn_adc_pkg::frame_words(Part, Channels, Lanes);
  localparam int unsigned SetupWords = msn_adc_pkg::setup_words(Part);
  localparam bit          NeedsStart = HasReset || SetupWords != 0;
  localparam int unsigned KeptBits   = msn_adc_pkg::kept_bits(Part);
  localparam int unsigned DataBits   = msn_adc_pkg::data_bits(Part);
  localparam int unsigned WatchBits  = msn_adc_pkg::watch_bits(Part, ClkKhz, ReadDuring);
  localparam int unsigned Last       = msn_adc_pkg::conversion_max_ns(Part) * ClkKhz / 1_000_000;  // BUSY falls, at most
  localparam int unsigned WatchEnd   = ReadDuring ? Last + 3 : (1 << WatchBits) - 1;
  localparam int unsigned Guard      = ReadDuring ? msn_adc_pkg::guard_clocks(Part, ClkKhz, Half, Words) : 1;
  localparam int unsigned Rests      = msn_pkg::clocks_of_ns(msn_adc_pkg::start_ns(Part), ClkKhz);
  localparam int unsigned Start      = msn_pkg::clocks_of_ns(msn_adc_pkg::reset_ns(Part), ClkKhz) + Rests;
  localparam int unsigned StartBits  = msn_pkg::index_width(Start);
  localparam logic [2:0]  Reset = 3'd0, Setup = 3'd1, Idle = 3'd2, Rise = 3'd3, Fall = 3'd4, Read = 3'd5;
  logic [2:0]            state;
  logic [PeriodBits-1:0] left;
  logic [WatchBits-1:0]  watch;
  logic [StartBits-1:0]  start;
  logic [7:0]            word, words, code;  // code: the store's number of this word
  logic [15:0]           command;
  logic                  sets_up, asks_setup, stores, wrong;
  logic                  busy_1, busy_2, busy_3, drop, bad, open, over, ready, tick, waits, gives_up, ends, resumes;
  logic                  starts, early, read_due, begun, awaits;
  logic [15:0]           since;  // clocks since a read started, at most all ones
  logic                  convert_due, lost_due, reset_due, convst_due, rises, falls;
  logic [31:0]           dropped, overrun, timeout, mistagged, over_range;
  assign tick     = cfg_enable_i && (Trigger ? trigger_i : ready && left == '0);
  assign waits    = HasBusy && (state == Rise || state == Fall);
  assign starts   = tick && state == Idle && (!ReadDuring || 32'(since) >= Guard);
  assign early    = ReadDuring && falls && reading;
  assign gives_up = waits && (32'(watch) == WatchEnd || early);
  assign rises    = busy_2 && !busy_3;
  assign falls    = state == Fall && !busy_2 && !(awaits && wait_i);
  assign ends     = (ReadDuring ? state != Setup : state == Read) && dut.done && word == '0;
  assign resumes  = HasBusy ? falls && !gives_up : starts;
  assign sets_up  = SetupWords != 0 && ((state == Reset && start == '0) || (ends && bad));
  assign words    = (state == Setup) ? 8'(SetupWords) : 8'(Words);
  // A tagged answer is for the word before and has its number: the first word of a frame is only a command.
  assign stores   = dut.word && (ReadDuring ? state != Setup : state == Read) && (!Tagged || word != '0);
  assign code     = Tagged ? word - 1'b1 : word;
  assign wrong    = Tagged && stores && 8'(dut.kept[KeptBits-1-:4]) != code;
  assign asks_setup = sets_up || (state == Setup && !(dut.done && word == '0));
  assign command  = asks_setup ? msn_adc_pkg::setup_word(Part, Lanes, 3'(word)) : msn_adc_pkg::command(Part, 3'(word));
  always_ff @(posedge clk_i) begin
    {busy_3, busy_2, busy_1} <= {busy_2, busy_1, adc_busy_i};
    left  <= !(cfg_enable_i && ready) ? '0 : tick ? cfg_period_i - 1'b1 : left - 1'b1;
    watch <= waits ? watch + 1'b1 : '0;
    start <= (state == Reset) ? start - 1'b1 : StartBits'(Start - 1);
    ready <= ready || state == Idle;
    case (state)
      Reset:   if (start == '0) state <= (SetupWords != 0) ? Setup : Idle;
      Setup:   if (dut.done && word == '0) state <= Idle;
      Idle:    if (starts) state <= HasBusy ? Rise : Read;
      Rise:    if (gives_up) state <= Idle; else if (rises) state <= Fall;
      Fall:    if (gives_up) state <= Idle; else if (falls) state <= ReadDuring ? Idle : Read;
      default: if (ends) state <= (Tagged && bad) ? Setup : Idle;
    endcase
    if (dut.word) word <= (word == words - 1'b1) ? '0 : word + 1'b1;
    if (ReadDuring ? read_o : convert_o) drop <= dut.pending;
    if (ReadDuring && reading && busy_3 && !busy_2) drop <= 1'b1;
    since  <= resumes ? 16'd1 : (since == '1) ? since : since + 1'b1;
    awaits <= starts || (awaits && 32'(watch) != Last + 1);
    begun  <= ReadDuring && (starts || (begun && !gives_up && !resumes));
    if (wrong) bad <= 1'b1;
    if (stores && word == words - 1'b1 && !drop && !bad && !wrong) open <= 1'b0;
    if (ends || (gives_up && !ReadDuring)) open <= 1'b0;
    if (ReadDuring ? resumes : starts) open <= 1'b1;
    if (starts) bad <= 1'b0;
    over        <= out_valid_o && out_ready_i && out_user_o;
    convert_due <= starts;
    read_due    <= resumes;
    lost_due    <= (ends && (ReadDuring ? open : drop || bad)) || gives_up || (tick && !starts);
    reset_due   <= HasReset && state == Reset && 32'(start) >= Rests;
    convst_due  <= (starts && HasBusy) || (waits && !gives_up && !falls && !watch[WatchBits-1] &&
                                           !(ReadDuring && watch[WatchBits-2]));
    dropped     <= dropped + 32'(ends && (ReadDuring ? open : drop));
    mistagged   <= mistagged + 32'(ends && bad && !drop);
    overrun     <= overrun + 32'(tick && !starts);
    timeout     <= timeout + 32'(gives_up);
    over_range  <= over_range + 32'(over);
    if (rst_i) begin
      state       <= NeedsStart ? Reset : Idle;
      ready       <= !NeedsStart;
      start       <= StartBits'(Start - 1);
      left        <= '0;
      word        <= '0;
      open        <= 1'b0;
      over        <= 1'b0;
      convert_due <= 1'b0;
      read_due    <= 1'b0;
      begun       <= 1'b0;
      since       <= '1;
      lost_due    <= 1'b0;
      reset_due   <= HasReset;
      convst_due  <= 1'b0;
      {dropped, overrun, timeout, mistagged, over_range} <= '0;
    end
  end
  always_comb begin
    if (!started) begin  // both begin in the same state, which is arbitrary, but one that can occur
      assume (dut.state_q == state && dut.drop_q == drop && dut.bad_q == bad && dut.open_q == open && dut.watch_q == watch);
      assume (dut.u_busy.first_q == busy_1 && dut.busy == busy_2 && dut.busy_q == busy_3 && dut.ready_q == ready);
      assume (dut.left_q == left && 32'(dut.word_q) == 32'(word) && state <= Read && (SetupWords != 0 || state != Setup));
      assume (ReadDuring || (reading == (state == Setup || state == Read) && (open || !waits)));
      assume (dut.begun_q == begun && dut.await_q == awaits && dut.guard_q == '0 && since == '1 &&
              begun == (ReadDuring && waits));
    end
    if (started) begin
      assert (convert_o == convert_due && lost_o == lost_due && adc_reset_o == reset_due && adc_convst_o == convst_due);
      assert (read_o == read_due && busy_o == busy_2);
      assert (ready_o == ready && dropped_o == dropped && overrun_o == overrun && timeout_o == timeout);
      assert (mistagged_o == mistagged && over_range_o == over_range);
      assert (dut.u_shift.start_i == (resumes || sets_up || (Selects && dut.done && word != '0)));
      assert (dut.u_shift.again_i == (!Selects && 32'(word) != Words - 1));
      assert (dut.u_shift.command_i == command[15-:KeptBits]);
      if (dut.u_store.begin_i) assert (!dut.u_store.in_valid_i);
      assert (dut.u_store.in_valid_i == (stores && !drop) && dut.u_store.in_bad_i == (bad || wrong));
      if (stores) assert (8'(dut.u_store.in_word_i) == code);
      assert (dut.u_store.in_data_i == (Tagged ? (Lanes * DataBits)'(dut.kept[11-:DataBits]) : dut.kept));
      // Invariant.
      assert (dut.state_q == state && dut.drop_q == drop && dut.bad_q == bad && dut.open_q == open && dut.watch_q == watch);
      assert (dut.u_busy.first_q == busy_1 && dut.busy == busy_2 && dut.busy_q == busy_3);
      assert (dut.left_q == left && 32'(dut.word_q) == 32'(word) && word < words && dut.over_q == over);
      assert (dut.start_q == start && (ready || (NeedsStart && state <= Idle)));
      if (!NeedsStart) assert (state != Reset);
      if (!ReadDuring && state != Setup && state != Read) assert (word == '0);
      assert (dut.begun_q == begun && dut.await_q == awaits && begun == (ReadDuring && waits));
      assert (32'(dut.guard_q) == ((32'(since) < Guard) ? Guard - 32'(since) : 0));
      // A frame is open until its last word, and until its end if that word is not sent.
      if (!ReadDuring) assert (open == (waits || (state == Read && (word != '0 || !adc_cs_n_o || drop || bad))));
    end
  end

  // ReadDuring. When a conversion starts during a read, the clocks until CS rises for the last time and until the shifter
  // rests, against the shortest conversion, at whose end BUSY passes two registers.
  localparam longint unsigned Least = Ad7606c ? 500_000 : 3_450_000;  // ps
  localparam int unsigned Bits   = msn_adc_pkg::word_bits(Part);
  localparam int unsigned Apart  = 2 * Half * (Bits + 32'(Selects));  // from word to word
  localparam int unsigned Between = Selects ? 2 * Half : 0;            // of it, CS is high
  localparam int unsigned Risen  = Apart * Words - Between + 1;        // since, as CS has risen for the last time
  localparam int unsigned Done   = Apart * Words - Between + 2 * Half;
  if (ReadDuring) begin : gen_during
    always_comb if (started && !rst_i) begin
      if (convert_o && reading && 32'(since) < Risen) assert (Clock * 64'(Risen - 32'(since)) + 25_000 <= Least);
      if (convert_o && reading) assert (Clock * 64'(Done - 32'(since)) < Least + Clock);
      if (dut.u_shift.start_i && state != Setup) assert (adc_cs_n_o && !was_low && (!reading || (Selects && word != '0)));
    end
    // Invariant: since counts the read's clocks, as words, bits, halves and clocks of the shifter do.
    logic [31:0] place, ended;  // ended: words, of those that CS has left high
    assign place = 32'(dut.u_shift.half_q) + 1;
    assign ended = (word == '0) ? Words : 32'(word);
    always_comb if (started) begin
      assert (state != Read && (reading || (word == '0 && state != Setup)) && (!reading || state != Reset));
      assert ((reading && state != Setup) == (32'(since) <= Done) && since != '0);
      if (reading && state != Setup) begin
        assert (32'(dut.u_shift.half_q) < Half && 32'(dut.u_shift.left_q) < Bits && !dut.u_shift.lead_q);
        if (!adc_cs_n_o) assert (32'(since) + place == Half * (32'(dut.u_shift.second_q) + 1) + 1
                                 + Apart * 32'(word) + 2 * Half * (Bits - 1 - 32'(dut.u_shift.left_q)));
        else assert (32'(since) + place == Half * (32'(dut.u_shift.second_q) + 1) + 1 + Apart * ended - Between);
        if (!Selects) assert (adc_cs_n_o == (32'(since) >= Risen));
        assert (dut.u_shift.word_o == (dut.u_shift.bit_end && !adc_cs_n_o && dut.u_shift.left_q == '0));
      end
      // A frame is open until its last word, and until its end if that word is not sent.
      assert (!open || (reading && state != Setup && (!adc_cs_n_o || word != '0 || drop)));
      assert (open || !reading || state == Setup || (adc_cs_n_o && word == '0));
    end
    if (Guard < 16 && SetupWords == 0) begin : gen_cover
      always_comb if (started && !rst_i) cover (convert_o && reading);
    end
  end

  // What proof `adc_store` assumes: a word arrives only for channels whose samples have left. A frame is not dropped
  // only if all samples had left when it began, so that meanwhile only channels of its earlier words hold samples.
  // Frames of tagged parts are sent after their last word: no channel holds a sample meanwhile.
  localparam int unsigned LaneWords = (Lanes > 1) ? msn_adc_pkg::lane_channels(Lanes) : Channels;
  logic [Channels-1:0] held, meant;
  logic                comes;  // words of this frame may still arrive
  assign held  = dut.u_store.full_q;
  assign comes = (ReadDuring ? reading && state != Setup && (!adc_cs_n_o || word != '0) && !read_o :
                  (waits || (state == Read && (word != '0 || !adc_cs_n_o))) && !convert_o) && !drop;
  for (genvar c = 0; c < Channels; c++) begin : gen_channel
    assign meant[c] = dut.u_store.in_valid_i && (32'(dut.u_store.in_word_i) == c % LaneWords || Tagged);
    always_comb if (started && comes && held[c]) assert (!Tagged && c % LaneWords < 32'(word));
  end
  always_comb if (started && !rst_i) assert (!(|(held & meant)));

  // Invariant: the shifter runs only in the states Setup and Read, unless ReadDuring.
  always_comb begin
    if (started) begin
      if (!ReadDuring) assert (reading == (dut.state_q == 3'd5 || dut.state_q == 3'd1));
      assert (dut.state_q <= 3'd5);
      assert (reading || adc_cs_n_o);
      if (reading && adc_cs_n_o && !dut.CsPerChannel) assert (dut.word_q == '0);  // the rest after the last word
      if (dut.u_shift.word_o) assert (reading && !adc_cs_n_o && dut.u_shift.bit_end);
      if (!ReadDuring && reading) assert (!adc_convst_o);
      if (!dut.HasBusy) assert (!adc_convst_o && dut.state_q != 3'd3 && dut.state_q != 3'd4);
      if (dut.SetupWords == 0) assert (dut.state_q != 3'd1);
    end
  end

  always_comb begin
    if (started && !rst_i) cover (dut.u_shift.start_i || dut.state_q == 3'd0);
    if (started && !rst_i && Mcp3208) cover (!adc_cs_n_o && adc_sclk_o);
    if (started && !rst_i && Tagged) cover (!adc_cs_n_o && state == Setup);
  end

endmodule
