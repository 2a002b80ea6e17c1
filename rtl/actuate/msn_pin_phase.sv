// SPDX-License-Identifier: Apache-2.0
//
// The drive of a pin display in time: a phase, its slots and periods, bursts, and when all is off (docs/pin_display.md).
//
//   phase = phase + increment mod 2^40 at each clock      a period ends where it wraps, and has 2^SlotBits slots
//
// step_o: a slot begins, slot_o. begin_o: a period begins, for which silent_o and burst_o are valid from the next
// clock on, and length_o, ticks of the period before, in that clock. A new increment is taken at a wrap; above MaxHz it counts as MaxHz.
// off_o stops all in the same clock: no enable, a fault, no frame for cfg_stop_i ticks, at a wrap an increment below
// MinHz, and a period of 6144 ticks, longer than any at MinHz: an upset increment could end none. Then the phase rests
// at 0 until idle_i. turn_o: a seventh of the window of the duty has ended.
// Error: the mean frequency differs by less than clock / 2^41, a period by less than a clock.
// Model: model/meissner/twins/actuate/pin_display.py

module msn_pin_phase #(
  parameter  int unsigned ClkKhz     = 25_000,
  parameter  int unsigned MinHz      = 1,
  parameter  int unsigned MaxHz      = 400,
  parameter  int unsigned SlotBits   = 5,
  parameter  int unsigned TickClocks = (ClkKhz + 3) / 4,  // a quarter ms
  parameter  int unsigned Ticks      = 5715,              // of a seventh of 10 s
  localparam int unsigned TickBits   = msn_pkg::index_width(TickClocks)
) (
  input  logic                clk_i,
  input  logic                rst_i,

  input  logic                cfg_enable_i,
  input  logic [31:0]         cfg_increment_i,
  input  logic [11:0]         cfg_burst_period_i,  // periods; 0: no bursts
  input  logic [11:0]         cfg_burst_on_i,      // periods of these with pins on
  input  logic [15:0]         cfg_stop_i,          // ticks

  input  logic                fault_i,
  input  logic                frame_valid_i,       // a frame waits to be taken at a wrap
  input  logic                idle_i,              // the display may start

  output logic                running_o,
  output logic                off_o,
  output logic                begin_o,
  output logic                step_o,
  output logic [SlotBits-1:0] slot_o,
  output logic                silent_o,
  output logic                burst_o,             // the burst is on
  output logic [12:0]         length_o,            // in the clock of begin_o, and after off_o
  output logic                turn_o
);

  localparam int unsigned     PhaseBits = 40;
  localparam longint unsigned Wrap      = 64'd1 << PhaseBits;
  localparam longint unsigned ClkHz     = 64'(ClkKhz) * 1000;
  localparam logic [31:0]     Least     = 32'(64'(MinHz) * Wrap / ClkHz);
  localparam logic [31:0]     Largest   = 32'(64'(MaxHz) * Wrap / ClkHz);
  localparam int unsigned     RateBits  = $clog2(64'(Largest) + 1);  // below 32: MaxHz is at most ClkHz / 513
  localparam int unsigned     LeastBits = $clog2(64'(Least) + 1);

  if (ClkKhz < 1 || ClkKhz > 1_000_000) begin : gen_check_clk_khz
    $fatal(1, "msn_pin_phase: ClkKhz = %0d must lie in 1 .. 1000000", ClkKhz);
  end
  if (MinHz < 1 || MinHz > MaxHz || 64'(MaxHz) * 513 > ClkHz) begin : gen_check_hz
    $fatal(1, "msn_pin_phase: MinHz = %0d must be 1 or more, MaxHz = %0d must lie from it to ClkHz / 513",
           MinHz, MaxHz);
  end
  if (SlotBits < 2 || SlotBits > 7) begin : gen_check_slot_bits
    $fatal(1, "msn_pin_phase: SlotBits = %0d must lie in 2 .. 7", SlotBits);
  end
  if (TickClocks < 1 || 64'(TickClocks) * 4 * 64'(MaxHz) > ClkHz) begin : gen_check_tick_clocks
    $fatal(1, "msn_pin_phase: TickClocks = %0d must be 1 or more, at most a quarter of a period at MaxHz",
           TickClocks);
  end
  if (Ticks < 2 || Ticks > 5715 || 64'(Ticks) * 64'(TickClocks) * 64'(MinHz) < ClkHz) begin : gen_check_ticks
    $fatal(1, "msn_pin_phase: Ticks = %0d must lie in 2 .. 5715 and last a period at MinHz or longer", Ticks);
  end

  logic [TickBits-1:0]  tick_clocks;
  logic [12:0]          ticks, elapsed;  // of the seventh; of the period so far
  logic [15:0]          quiet_n;         // ticks since a frame was taken, inverted: see msn_pin_limits
  logic                 tick;
  logic [PhaseBits-1:0] phase;
  logic [PhaseBits:0]   sum;
  logic [RateBits-1:0]  increment, wanted;
  logic                 wrap, fast, start, fresh, stopped, stuck, changed, lit, more;
  logic [11:0]          burst_n;         // the burst's period, from 1 on, inverted
  logic [15:0]          unused_quiet;
  logic [12:0]          unused_on;
  logic [11:0]          unused_period;
  assign tick       = tick_clocks == TickBits'(TickClocks - 1);
  assign turn_o     = tick && ticks == 13'(Ticks - 1);
  assign sum        = {1'b0, phase} + (PhaseBits + 1)'(increment);
  assign {fresh, unused_quiet} = {1'b0, cfg_stop_i} + {1'b0, quiet_n};  // quiet < stop
  assign stopped    = !frame_valid_i && !fresh;
  assign stuck      = elapsed[12:11] == '1;  // Ticks is less
  assign off_o      = running_o && (!cfg_enable_i || fault_i || stopped || stuck || (wrap && !fast));
  assign start      = !running_o && cfg_enable_i && !fault_i && !stopped && fast && idle_i && !turn_o;
  assign begin_o    = wrap && !off_o;
  assign slot_o     = phase[PhaseBits-1-:SlotBits];
  assign changed    = wanted != increment;
  assign {lit, unused_on} = {1'b0, cfg_burst_on_i, 1'b1} + {1'b0, burst_n, 1'b1};  // burst <= burst_on
  assign {more, unused_period} = {1'b0, cfg_burst_period_i} + {1'b0, burst_n};  // burst < burst_period
  assign length_o   = elapsed + 13'(tick && running_o);

  always_ff @(posedge clk_i) begin
    tick_clocks <= tick ? '0 : tick_clocks + 1'b1;
    if (tick) ticks <= turn_o ? '0 : ticks + 1'b1;
    if (tick && quiet_n != '0) quiet_n <= quiet_n - 1'b1;
    fast   <= cfg_increment_i[31:LeastBits] != '0 || cfg_increment_i[LeastBits-1:0] >= LeastBits'(Least);
    wanted <= (cfg_increment_i[31:RateBits] != '0 || cfg_increment_i[RateBits-1:0] > RateBits'(Largest)) ?
              RateBits'(Largest) : cfg_increment_i[RateBits-1:0];

    phase   <= sum[PhaseBits-1:0];
    wrap    <= sum[PhaseBits];
    step_o  <= sum[PhaseBits-SlotBits] != phase[PhaseBits-SlotBits];
    elapsed <= (begin_o || start) ? '0 : length_o;
    if (begin_o) begin
      increment <= wanted;
      silent_o  <= changed;
      burst_o   <= cfg_burst_period_i == '0 || lit;
      burst_n   <= (changed || !more) ? ~12'd1 : burst_n - 1'b1;
      if (frame_valid_i) quiet_n <= '1;
    end
    if (start) running_o <= 1'b1;
    if (off_o) running_o <= 1'b0;
    if (!running_o || off_o) begin  // the first period begins in the clock after `start`, at phase 0
      wrap      <= start;
      step_o    <= start;
      phase     <= '0;
      increment <= '0;
      burst_n   <= ~12'd1;
    end
    if (rst_i) begin
      tick_clocks <= '0;
      ticks       <= '0;
      quiet_n     <= '0;
      fast        <= 1'b0;
      running_o   <= 1'b0;
      wrap        <= 1'b0;
      step_o      <= 1'b0;
      phase       <= '0;
      increment   <= '0;
    end
  end

  logic unused;
  assign unused = ^{unused_quiet, unused_on, unused_period};

endmodule
