// A Verilated top with its clock and, in a build with traces, a VCD of the clocks that someone wants to see.
#pragma once
#include <cstdint>

#include "verilated.h"
#if VM_TRACE
#include "verilated_vcd_c.h"
#endif

namespace meissner {

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
