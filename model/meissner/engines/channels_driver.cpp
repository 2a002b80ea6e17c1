// Batch driver of the Verilated core behind a C ABI: complete arrays in, complete arrays out.
#include <cstring>

#include "Vmsn_channels.h"
#include "Vmsn_channels___024root.h"
#include "adc_parts.hpp"
#include "driver.hpp"

namespace {

using Core = meissner::Driver<Vmsn_channels>;

// What core_pins reports in addition to the decisions.
struct PinFacts {
  int64_t clocks, frames;
  meissner::Span period;    // clocks from convert start to convert start
  meissner::Span decision;  // clocks from convert start to the decision
};

auto decisions_of(const Core &core, uint32_t *p2p, uint8_t *flags, int64_t room) {
  return core.results(room, [=, &top = core.top](int64_t k) {
    p2p[k] = top.out_p2p_o;
    flags[k] = static_cast<uint8_t>(top.out_state_o | top.out_over_o << 3 | top.out_end_o << 4 |
                                    top.out_raised_o << 5);
  });
}

}  // namespace

extern "C" {

Core *core_new() { return new Core; }

void core_delete(Core *core) { delete core; }

// Reset the core with the settings of the slip path, msn_registers_pkg::slip_cfg_t, lowest byte first; returns 0, or
// kNoRoom if the number of bytes is not that of the port.
int64_t core_start(Core *core, const char *settings, int64_t bytes) {
  auto &top = core->top;
  if (bytes != sizeof(top.cfg_i)) return meissner::kNoRoom;
  std::memcpy(&top.cfg_i, settings, sizeof(top.cfg_i));
  top.actuator_moving_i = 0;
  core->start();
  return 0;
}

// Send `frames` frames of `channels` samples, one sample per clock, and collect every decision:
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
    if (!core->send((end - first) * channels, 1, {}, put, decisions)) return meissner::kFailed;
    for (int i = 0; i < 32; i++) core->clock(decisions);
  }
  return decisions.ok ? decisions.count : meissner::kFailed;
}

// The same through the pins of a converter, channel 0 only: `part` of msn_pkg::adc_part_e; one with BUSY is
// busy for `busy_clocks`. Frames trace_from .. trace_to-1 go to trace_path if the core was built for it.
int64_t core_pins(Core *core, int32_t part, int32_t busy_clocks, const int32_t *codes, int64_t frames,
                  int64_t period, const uint8_t *moving, uint32_t *p2p, uint8_t *flags, int64_t room,
                  int64_t trace_from, int64_t trace_to, const char *trace_path, int64_t clk_khz,
                  PinFacts *facts) {
  const auto adc = meissner::converter(part, busy_clocks);
  auto decisions = decisions_of(*core, p2p, flags, room);
  auto &top = core->top;
  meissner::Settings settings;
  settings.put(top.cfg_adc_period_i, period, 24);
  if (!settings.ok) return meissner::kNoRoom;
  top.cfg_adc_enable_i = 1;
  int32_t channels[8] = {};
  int64_t frame = -1, started = 0;
  const int64_t first = core->clocks + 1;
  *facts = {0, frames, {}, {}};
  while (decisions.ok) {
    core->clock();
    if (top.convert_o) {
      if (frame >= 0) facts->period.add(core->clocks - started);
      started = core->clocks;
      if (++frame == frames) break;
      channels[0] = codes[frame];
      top.actuator_moving_i = moving[frame];
      if (trace_path && frame == trace_from) core->start_trace(trace_path, clk_khz);
      if (frame == trace_to) core->stop_trace();
    }
    if (top.out_valid_o) facts->decision.add(core->clocks - started);
    decisions.look();
    adc->step(top.adc_cs_n_o, top.adc_sclk_o, top.adc_mosi_o, top.adc_convst_o, channels);
    top.adc_miso_i = adc->miso & 1;
    top.adc_busy_i = adc->busy;
  }
  core->stop_trace();
  facts->clocks = core->clocks - first;
  return decisions.ok ? decisions.count : meissner::kFailed;
}

uint32_t core_blanked(const Core *core) { return core->top.blanked_o; }
uint32_t core_damaged(const Core *core) { return core->top.damaged_o; }

}  // extern "C"
