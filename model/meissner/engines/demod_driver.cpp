// Batch driver of the Verilated msn_am_demod, one lane, behind a C ABI: samples in, amplitudes out.
#include <cstdint>

#include "Vmsn_am_demod.h"
#include "Vmsn_am_demod___024root.h"
#include "core.hpp"
#include "verilated.h"

namespace {

struct Core {  // without traces
  VerilatedContext context;
  Vmsn_am_demod top{&context};

  Core() { top.clk_i = 1; }

  // One rising edge; see channels_driver.cpp.
  void clock() {
    top.rootp->__Vtrigprevexpr___TOP__clk_i__0 = 0;
    top.eval();
  }
};

}  // namespace

extern "C" {

// Measure `count` carriers of `length` samples each, skipped ones included. Returns the clocks it took, or -1
// if not one amplitude per carrier came out.
int64_t demod_run(const int32_t *samples, int64_t count, int64_t length, int64_t periods, int64_t skip,
                  int64_t shift, int32_t period_bits, int32_t skip_bits, int64_t *amplitudes) {
  Core core;
  auto &top = core.top;
  int64_t clocks = 0, done = 0;
  bool room = true;

  const auto clock = [&] {
    core.clock();
    clocks++;
    if (top.out_valid_o && (room = room && done < count)) amplitudes[done++] = top.out_data_o;
  };

  top.out_ready_i = 1;
  top.in_valid_i = 0;
  top.in_id_i = 0;
  top.in_last_i = 0;
  top.in_user_i = 0;
  meissner::Settings settings;
  settings.put(top.cfg_periods_i, periods, period_bits);
  settings.put(top.cfg_skip_i, skip, skip_bits);
  settings.put(top.cfg_shift_i, shift, 5);
  if (!settings.ok) return meissner::kNoRoom;
  top.rst_i = 1;
  for (int i = 0; i < 4; i++) core.clock();
  top.rst_i = 0;
  top.in_valid_i = 1;
  for (int64_t k = 0; k < count * length; k++) {
    top.in_start_i = k % length == 0;
    top.in_data_i = static_cast<uint32_t>(samples[k]) & 0x1ffff;
    bool taken;
    int waited = 0;
    do {
      taken = top.in_ready_o;
      clock();
    } while (!taken && ++waited < 1000);
    if (!taken) return -1;
  }
  top.in_valid_i = 0;
  for (int i = 0; i < 1000 && done < count; i++) clock();
  return room && done == count ? clocks : -1;
}

}  // extern "C"
