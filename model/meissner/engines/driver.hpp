// Common part of the drivers of Verilated blocks: clock and reset, settings and words in, results out, the number of
// clocks taken and, in a build with traces, a VCD of chosen clocks. A block's own .cpp only maps words to input pins
// and output pins to results.
#pragma once
#include <algorithm>
#include <cstdint>

#include "verilated.h"
#if VM_TRACE
#include "verilated_vcd_c.h"
#endif

namespace meissner {

constexpr int64_t kFailed = -1;  // a driver's return value: a word was not taken, or the number of results was wrong
constexpr int64_t kNoRoom = -2;  // a setting does not fit its port
constexpr int kTimeout = 1000;  // clocks for a word to be taken, or for all results after the last word

// The lowest bits of a number, for a port: Verilator does not truncate a value.
constexpr uint32_t low_bits(int64_t value, int bits) {
  return static_cast<uint32_t>(value & ((int64_t{1} << bits) - 1));
}

// Settings on ports, without truncation: `ok` is false once a setting does not fit its port's bits.
struct Settings {
  bool ok = true;

  template <typename Port>
  void put(Port &port, int64_t value, int bits) {
    ok = ok && value >= 0 && (bits > 62 || value >> bits == 0);
    port = static_cast<Port>(value);
  }

  // Two's complement.
  template <typename Port>
  void put_signed(Port &port, int64_t value, int bits) {
    const int64_t half = int64_t{1} << (bits - 1);
    ok = ok && value >= -half && value < half;
    port = static_cast<Port>(value & (2 * half - 1));
  }
};

// The smallest and the largest number of clocks between two events.
struct Span {
  int64_t least = INT64_MAX, most = 0;

  void add(int64_t clocks) {
    least = std::min(least, clocks);
    most = std::max(most, clocks);
  }
};

// Up to `room` results: in each clock with `valid()`, `take(k)` stores number k.
template <typename Valid, typename Take>
struct Results {
  const int64_t room;
  Valid valid;
  Take take;
  int64_t count = 0;
  bool ok = true;  // false after a result beyond `room`

  Results(int64_t room, Valid valid, Take take) : room(room), valid(valid), take(take) {}

  void look() {
    if (!valid()) return;
    if (count < room) {
      take(count++);
    } else {
      ok = false;
    }
  }

  bool complete() const { return ok && count == room; }
};

// The clocks from the last `words` words on go to a VCD file at `path`; nullptr: none.
struct Trace {
  const char *path = nullptr;
  int64_t words = 0, clk_khz = 0;
};

template <typename Top>
struct Driver {
  VerilatedContext context;
  Top top{&context};
  int64_t clocks = 0;  // since reset

#if VM_TRACE
  VerilatedVcdC vcd;
  bool tracing = false;
  uint64_t half_clock_ps = 500;
#endif

  Driver() {
    top.clk_i = 1;
#if VM_TRACE
    context.traceEverOn(true);
    top.trace(&vcd, 99);
#endif
  }

  // Scopes are removed from the thread's context, that of the newest driver, which may no longer exist.
  ~Driver() {
    stop_trace();
    Verilated::threadContextp(&context);
  }

  // One rising edge, then a check for results. Nothing in the core acts on the falling edge, so it is not evaluated,
  // which saves a third of the time: it is enough to set Verilator's record of the clock to low. If a release renames
  // this member, the build fails.
  template <typename... Out>
  void clock(Out &...results) {
    ++clocks;
#if VM_TRACE
    if (tracing) {
      for (const int level : {0, 1}) {
        top.clk_i = level;
        top.eval();
        vcd.dump(context.time());
        context.timeInc(half_clock_ps);
      }
    } else
#endif
    {
      top.rootp->__Vtrigprevexpr___TOP__clk_i__0 = 0;
      top.eval();
    }
    (results.look(), ...);
  }

  void reset() {
    top.rst_i = 1;
    for (int i = 0; i < 4; ++i) clock();
    top.rst_i = 0;
    clocks = 0;
  }

  // reset() of a block with one input and one output stream; its results are always taken.
  void start() {
    top.in_valid_i = 0;
    top.out_ready_i = 1;
    reset();
  }

  template <typename Take>
  auto results(int64_t room, Take take) const {
    return Results(room, [this] { return top.out_valid_o != 0; }, take);
  }

  // Sends words 0 .. count-1, each as soon as the block takes it: `put(k)` sets the pins of number k. False if a word
  // is not taken within `timeout` clocks.
  template <typename Put, typename... Out>
  bool send(int64_t count, int timeout, const Trace &trace, const Put &put, Out &...results) {
    top.in_valid_i = 1;
    for (int64_t k = 0; k < count; ++k) {
      put(k);
      if (trace.path && count - k == trace.words) start_trace(trace.path, trace.clk_khz);
      bool taken;
      int left = timeout;
      do {
        taken = top.in_ready_o;
        clock(results...);
      } while (!taken && --left > 0);
      if (!taken) return false;
    }
    top.in_valid_i = 0;
    return true;
  }

  // Sends all words and waits for all results. Returns the clocks since reset, or kFailed.
  template <typename Put, typename... Out>
  int64_t run(int64_t count, const Trace &trace, const Put &put, Out &...results) {
    if (!send(count, kTimeout, trace, put, results...)) return kFailed;
    for (int i = 0; i < kTimeout && !(results.complete() && ...); ++i) clock(results...);
    return (results.complete() && ...) ? clocks : kFailed;
  }

  // The clocks from here to stop_trace() go to a VCD file; a build without traces writes none.
  void start_trace(const char *path, int64_t clk_khz) {
#if VM_TRACE
    vcd.open(path);
    tracing = true;
    half_clock_ps = 500'000'000 / clk_khz;
#else
    (void)path, (void)clk_khz;
#endif
  }

  void stop_trace() {
#if VM_TRACE
    if (!tracing) return;
    tracing = false;
    vcd.close();
    top.clk_i = 1;
#endif
  }
};

}  // namespace meissner
