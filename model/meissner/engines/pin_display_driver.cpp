// Batch driver of the Verilated msn_pin_display with models of its HV507: frames in, the levels at the pins out.
#include <vector>

#include "Vmsn_pin_display.h"
#include "Vmsn_pin_display___024root.h"
#include "driver.hpp"

namespace {

using Top = Vmsn_pin_display;

// Chains of HV507 at the display's lines: what is shifted in first ends at the highest output of its chain.
struct Drivers {
  std::vector<std::vector<uint8_t>> shifted, latched;
  bool clk = false, le = false;

  Drivers(int chains, int bits) : shifted(chains, std::vector<uint8_t>(bits)), latched(shifted) {}

  // True if the outputs may have changed: the latches opened.
  bool look(const Top &top) {
    if (top.hv_clk_o && !clk) {
      for (size_t k = 0; k < shifted.size(); ++k) {
        shifted[k].insert(shifted[k].begin(), top.hv_data_o >> k & 1);
        shifted[k].pop_back();
      }
    }
    const bool opened = top.hv_le_o && !le;
    clk = top.hv_clk_o;
    le = top.hv_le_o;
    if (opened) latched = shifted;
    return opened;
  }
};

}  // namespace

extern "C" {

// Show `frames` frames of `pins` levels, each sent as soon as the period before has begun at the pins. For each period:
// the level of each pin, by the slots in which it is high; the clock in which it begins; whether a limit keeps a pin
// off. `settings`: increment, burst_period, burst_on, top, most, duty, watchdog, stop. `wait`: clocks for a period.
int64_t pin_display(const uint8_t *frames, int64_t periods, int32_t pins, int32_t chains, int32_t chain_pins,
                    int32_t chain_bits, const int64_t *settings, int64_t wait, int32_t *levels, int64_t *starts,
                    int32_t *limited) {
  meissner::Driver<Top> driver;
  auto &top = driver.top;
  meissner::Settings given;
  given.put(top.cfg_increment_i, settings[0], 32);
  given.put(top.cfg_burst_period_i, settings[1], 16);
  given.put(top.cfg_burst_on_i, settings[2], 16);
  given.put(top.cfg_top_i, settings[3], 8);
  given.put(top.cfg_most_i, settings[4], 12);
  given.put(top.cfg_duty_i, settings[5], 16);
  given.put(top.cfg_watchdog_i, settings[6], 4);
  given.put(top.cfg_stop_i, settings[7], 16);
  if (!given.ok) return meissner::kNoRoom;
  top.cfg_enable_i = 1;
  top.fault_i = 0;
  top.in_valid_i = 0;
  driver.reset();
  Drivers parts(chains, chain_bits);
  int64_t period = -1, sent = 0;
  int32_t place = 0;  // of the next level of frame `sent`
  std::vector<int32_t> high(pins);
  for (int64_t left = wait; left > 0; --left) {
    top.in_valid_i = sent < periods && sent <= period + 1;
    if (top.in_valid_i) {
      top.in_data_i = frames[sent * pins + place];
      top.in_last_i = place == pins - 1;
      place = top.in_last_i ? 0 : place + 1;
      sent += top.in_last_i;
    }
    driver.clock();
    if (top.wrap_o) {
      if (period >= 0) {
        for (int32_t p = 0; p < pins; ++p) levels[period * pins + p] = high[p] ? high[p] - 1 : 0;
      }
      if (++period == periods) return driver.clocks;
      starts[period] = driver.clocks;
      limited[period] = top.limited_o;
      high.assign(pins, 0);
      left = wait;
    }
    if (parts.look(top) && period >= 0) {
      for (int32_t p = 0; p < pins; ++p) high[p] += parts.latched[p / chain_pins][p % chain_pins];
    }
  }
  return meissner::kFailed;
}

}  // extern "C"
