// Batch driver of the Verilated core behind a C ABI: whole arrays in, whole arrays out.
#include <cstdint>

#include "Vmsn_core.h"
#include "Vmsn_core___024root.h"
#include "verilated.h"

namespace {

struct Core {
  VerilatedContext context;
  Vmsn_core top{&context};

  Core() { top.clk_i = 1; }

  // One rising edge. Nothing in the core acts on the falling one, so it is not evaluated, which is a third
  // of the time: telling Verilator that the clock was low is enough. Should a release rename this member,
  // the build fails.
  void clock() {
    top.rootp->__Vtrigprevexpr___TOP__clk_i__0 = 0;
    top.eval();
  }
};

}  // namespace

extern "C" {

// The registers of the slip path, in the units of their ports.
struct SlipRegisters {
  uint32_t threshold, gross_threshold;
  int32_t contact_level, release_level;
  uint32_t contact_rises, hold, refractory, blank;
};

Core *core_new() { return new Core; }

void core_delete(Core *core) { delete core; }

// Reset the core and set its registers.
void core_start(Core *core, const SlipRegisters *registers, uint32_t detail_bits) {
  auto &top = core->top;
  const uint32_t mask = detail_bits >= 32 ? ~0u : (1u << detail_bits) - 1;
  top.cfg_threshold_i = registers->threshold & mask;
  top.cfg_gross_threshold_i = registers->gross_threshold & mask;
  top.cfg_contact_level_i = static_cast<uint32_t>(registers->contact_level) & mask;
  top.cfg_release_level_i = static_cast<uint32_t>(registers->release_level) & mask;
  top.cfg_contact_rises_i = registers->contact_rises;
  top.cfg_hold_i = registers->hold;
  top.cfg_refractory_i = registers->refractory;
  top.cfg_blank_i = registers->blank;
  top.actuator_moving_i = 0;
  top.in_valid_i = 0;
  top.out_ready_i = 1;
  top.rst_i = 1;
  for (int i = 0; i < 4; i++) core->clock();
  top.rst_i = 0;
}

// Send `frames` frames of `channels` samples, one sample per clock, and collect every decision:
// p2p, and flags = state | over << 3 | end << 4 | raised << 5. `moving` has one byte per frame, or is null.
// Returns the number of decisions, or -1 if the core stalled or more than `room` came out.
int64_t core_slip(Core *core, const int32_t *samples, int64_t frames, int32_t channels,
                  uint32_t sample_bits, const uint8_t *moving, uint32_t *p2p, uint8_t *flags,
                  int64_t room) {
  auto &top = core->top;
  const uint32_t mask = (1u << sample_bits) - 1;
  int64_t count = 0;
  const auto collect = [&] {
    if (!top.out_valid_o) return true;
    if (count == room) return false;
    p2p[count] = top.out_p2p_o;
    flags[count] = static_cast<uint8_t>(top.out_state_o | top.out_over_o << 3 | top.out_end_o << 4 |
                                        top.out_raised_o << 5);
    count++;
    return true;
  };
  const auto drain = [&] {
    for (int i = 0; i < 32; i++) {
      core->clock();
      if (!collect()) return false;
    }
    return true;
  };
  top.in_valid_i = 1;
  for (int64_t frame = 0; frame < frames; frame++) {
    if (moving && moving[frame] != top.actuator_moving_i) {
      // The input is not delayed with the samples: let those of the frames before pass first.
      top.in_valid_i = 0;
      if (!drain()) return -1;
      top.actuator_moving_i = moving[frame];
      top.in_valid_i = 1;
    }
    for (int32_t channel = 0; channel < channels; channel++) {
      top.in_data_i = static_cast<uint32_t>(*samples++) & mask;
      top.in_id_i = channel;
      top.in_last_i = channel == channels - 1;
      core->clock();
      if (!top.in_ready_o || !collect()) return -1;
    }
  }
  top.in_valid_i = 0;
  return drain() ? count : -1;
}

uint32_t core_blanked(const Core *core) { return core->top.blanked_o; }
uint32_t core_damaged(const Core *core) { return core->top.damaged_o; }

}  // extern "C"
