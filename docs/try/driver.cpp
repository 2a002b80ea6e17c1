// The core of the site's front page: one sample of one channel at a time into msn_core, registers on its bus.
#include "Vmsn_core.h"
#include "Vmsn_core___024root.h"

#include "bus.hpp"
#include "driver.hpp"

namespace {

meissner::Driver<Vmsn_core> *core;
// What `next` found: whether the core decided, its peak to peak, state, whether it raised the flag, the clocks from the
// one that took the sample to the decision, whether a Haar detail left, and the detail.
int32_t found[7];

constexpr int kClocks = 48;  // a sample: more than any sample's decision takes

}  // namespace

extern "C" {

void start() {
  delete core;
  core = new meissner::Driver<Vmsn_core>;
  core->top.actuator_moving_i = 0;
  core->top.bus_valid_i = 0;
  core->top.rx_i = 1;
  core->start();
}

int32_t put(int32_t address, uint32_t data) { return meissner::access(*core, true, address, data); }

int32_t get(int32_t address) { return meissner::access(*core, false, address, 0); }

int32_t *next(int32_t code, int32_t bits) {
  auto &top = core->top;
  for (auto &each : found) each = 0;
  top.in_data_i = meissner::low_bits(code, bits);
  top.in_id_i = 0;
  top.in_last_i = 1;
  top.in_valid_i = 1;
  int since = -1;
  for (int clock = 0; clock < kClocks; ++clock) {
    const bool taken = top.in_valid_i && top.in_ready_o;
    core->clock();
    if (taken) {
      since = 0;
      top.in_valid_i = 0;
    } else if (since >= 0) {
      ++since;
    }
    if (top.verdict_o >> 18 & 1) {
      const uint64_t verdict = top.verdict_o, decision = top.decision_o;
      found[0] = 1;
      found[1] = decision >> 16 & 0xFFFFFF;
      found[2] = decision >> 40 & 7;
      found[3] = decision >> 44 & 1;
      found[4] = since + 1;  // as docs/core.md counts: until a register behind the core has it
    }
    if (top.rootp->DETAIL_VALID) {
      const int width = bits + LEVEL;
      found[5] = 1;
      found[6] = static_cast<int32_t>(static_cast<uint32_t>(top.rootp->DETAIL) << (32 - width)) >> (32 - width);
    }
  }
  return found;
}

}  // extern "C"
