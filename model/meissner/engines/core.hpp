// A Verilated top with its clock and, in a build with traces, a VCD of the clocks that someone wants to see.
#pragma once
#include <cstdint>

#include "verilated.h"
#if VM_TRACE
#include "verilated_vcd_c.h"
#endif

namespace meissner {

// Settings on ports, none of them cut: `ok` is false once one had no room in the bits that its port has.
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

constexpr int64_t kNoRoom = -2;  // what a driver returns then

template <typename Top>
struct Core {
  VerilatedContext context;
  Top top{&context};

#if VM_TRACE
  VerilatedVcdC trace;
  bool tracing = false;
  uint64_t half_clock_ps = 500;
#endif

  Core() {
    top.clk_i = 1;
#if VM_TRACE
    context.traceEverOn(true);
    top.trace(&trace, 99);
#endif
  }

  ~Core() { stop_trace(); }

  // One rising edge. Nothing in the core acts on the falling one, so it is not evaluated, which is a third
  // of the time: telling Verilator that the clock was low is enough. Should a release rename this member,
  // the build fails.
  void clock() {
#if VM_TRACE
    if (tracing) {
      for (const int level : {0, 1}) {
        top.clk_i = level;
        top.eval();
        trace.dump(context.time());
        context.timeInc(half_clock_ps);
      }
      return;
    }
#endif
    top.rootp->__Vtrigprevexpr___TOP__clk_i__0 = 0;
    top.eval();
  }

  // The clocks from here to stop_trace() go to a VCD file; a build without traces writes none.
  void start_trace(const char *path, int64_t clk_khz) {
#if VM_TRACE
    trace.open(path);
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
    trace.close();
    top.clk_i = 1;
#endif
  }
};

}  // namespace meissner
