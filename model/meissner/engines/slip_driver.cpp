// Slip of a complete core behind a C ABI: samples on its stream or at its converter's pins, registers on its bus, every
// decision out. Packets are dropped.
#include "Vmsn_core.h"
#include "Vmsn_core___024root.h"
#include <ctime>

#include "adc_parts.hpp"
#include "bus.hpp"
#include "driver.hpp"

namespace {

using Core = meissner::Driver<Vmsn_core>;

// A packet of slip keeps the decisions behind it waiting for less than this: its 20 bytes leave one every 4 clocks, and
// msn_packet_slip stalls the path for at most 191.
constexpr int kQuiet = 256;

// What core_pins reports in addition to the decisions.
struct PinFacts {
  int64_t clocks, frames;
  meissner::Span period;    // clocks from convert start to convert start
  meissner::Span decision;  // clocks from convert start to the decision
};

// The core's verdict_o and decision_o: msn_pkg.
bool decided(const Core &core) { return core.top.verdict_o >> 18 & 1; }

auto decisions_of(const Core &core, uint32_t *p2p, uint8_t *flags, int64_t room) {
  return meissner::Results(
      room, [&core] { return decided(core); },
      [=, &top = core.top](int64_t k) {
        const uint64_t verdict = top.verdict_o, decision = top.decision_o;
        p2p[k] = decision >> 16 & 0xFFFFFF;
        flags[k] = static_cast<uint8_t>((decision >> 40 & 7) | (verdict >> 17 & 1) << 3 | (verdict >> 16 & 1) << 4 |
                                        (decision >> 44 & 1) << 5);
      });
}

}  // namespace

extern "C" {

Core *core_new() {
  auto *core = new Core;
  auto &top = core->top;
  top.actuator_moving_i = 0;
  top.bus_valid_i = 0;
  top.rx_i = 1;
  core->start();
  return core;
}

void core_delete(Core *core) { delete core; }

int64_t core_write(Core *core, int32_t address, uint32_t data) { return meissner::access(*core, true, address, data); }

int64_t core_read(Core *core, int32_t address) { return meissner::access(*core, false, address, 0); }

// Processor seconds of a loop that only sends samples of one channel and evaluates the model, for comparison with
// core_slip (tools/published/speed.py); `clocks`: how many they took.
double core_bare(Core *core, const int32_t *samples, int64_t count, uint32_t sample_bits, int64_t *clocks) {
  auto &top = core->top;
  const std::clock_t began = std::clock();
  top.in_valid_i = 1;
  top.in_id_i = 0;
  top.in_last_i = 1;
  *clocks = 0;
  for (int64_t k = 0; k < count; ++k) {
    top.in_data_i = meissner::low_bits(samples[k], sample_bits);
    bool taken;
    do {
      taken = top.in_ready_o;
      top.rootp->__Vtrigprevexpr___TOP__clk_i__0 = 0;  // as Driver::clock
      top.eval();
      ++*clocks;
    } while (!taken);
  }
  return static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
}

// Send `frames` frames of `channels` samples, each as soon as the core takes it, and collect every decision:
// p2p, and flags = state | over << 3 | end << 4 | raised << 5. `moving` has one byte per frame, or is null.
// Returns the number of decisions, or -1 if the core stalled or gave more than `room`.
int64_t core_slip(Core *core, const int32_t *samples, int64_t frames, int32_t channels,
                  uint32_t sample_bits, const uint8_t *moving, uint32_t *p2p, uint8_t *flags,
                  int64_t room) {
  auto &top = core->top;
  auto decisions = decisions_of(*core, p2p, flags, room);
  int32_t channel = 0;
  const auto put = [&](int64_t) {
    top.in_data_i = meissner::low_bits(*samples++, sample_bits);
    top.in_id_i = channel;
    top.in_last_i = channel == channels - 1;
    channel = channel == channels - 1 ? 0 : channel + 1;
  };
  // The motion input is not delayed with the samples, so samples in flight pass before it changes.
  for (int64_t first = 0, end; first < frames; first = end) {
    for (end = first + 1; end < frames && (!moving || moving[end] == moving[first]);) ++end;
    if (moving) top.actuator_moving_i = moving[first];
    if (!core->send((end - first) * channels, meissner::kTimeout, {}, put, decisions)) return meissner::kFailed;
    for (int quiet = 0; quiet < kQuiet; quiet = decided(*core) ? 0 : quiet + 1) core->clock(decisions);
  }
  return decisions.ok ? decisions.count : meissner::kFailed;
}

// The same through the pins of a converter, channel 0 only, from its first convert start on: `part` of
// msn_pkg::adc_part_e; one with BUSY is busy for `busy_clocks`; `enable`: the address of its register. Frames
// trace_from .. trace_to-1 go to trace_path if the core was built for it.
int64_t core_pins(Core *core, int32_t part, int32_t busy_clocks, int32_t enable, const int32_t *codes, int64_t frames,
                  const uint8_t *moving, uint32_t *p2p, uint8_t *flags, int64_t room, int64_t trace_from,
                  int64_t trace_to, const char *trace_path, int64_t clk_khz, PinFacts *facts) {
  const auto adc = meissner::converter(part, busy_clocks);
  auto decisions = decisions_of(*core, p2p, flags, room);
  auto &top = core->top;
  int32_t channels[8] = {};
  int64_t frame = -1, started = 0, first = 0;
  *facts = {0, frames, {}, {}};
  meissner::ask(top, true, enable, 1);
  while (decisions.ok) {
    core->clock();
    top.bus_valid_i = 0;
    if (top.rootp->msn_core__DOT__convert) {
      if (frame >= 0) facts->period.add(core->clocks - started);
      started = core->clocks;
      if (++frame == 0) first = started;
      if (frame == frames) break;
      channels[0] = codes[frame];
      top.actuator_moving_i = moving[frame];
      if (trace_path && frame == trace_from) core->start_trace(trace_path, clk_khz);
      if (frame == trace_to) core->stop_trace();
    }
    if (decided(*core)) facts->decision.add(core->clocks - started);
    decisions.look();
    adc->step(top.adc_cs_n_o, top.adc_sclk_o, top.adc_mosi_o, top.adc_convst_o, channels);
    top.adc_miso_i = adc->miso & 1;
    top.adc_busy_i = adc->busy;
  }
  core->stop_trace();
  facts->clocks = core->clocks - first;
  return decisions.ok ? decisions.count : meissner::kFailed;
}

}  // extern "C"
