// Batch driver of the Verilated msn_am_demod, one lane: samples in, amplitudes out.
#include "Vmsn_am_demod.h"
#include "Vmsn_am_demod___024root.h"
#include "driver.hpp"

// Measure `count` carriers of `length` samples each, including skipped ones. Returns the clocks taken, or -1 unless
// there was exactly one amplitude per carrier.
extern "C" int64_t demod_run(const int32_t *samples, int64_t count, int64_t length, int64_t periods, int64_t skip,
                             int64_t shift, int32_t period_bits, int32_t skip_bits, int64_t *amplitudes) {
  meissner::Driver<Vmsn_am_demod> driver;
  auto &top = driver.top;
  meissner::Settings settings;
  settings.put(top.cfg_periods_i, periods, period_bits);
  settings.put(top.cfg_skip_i, skip, skip_bits);
  settings.put(top.cfg_shift_i, shift, 5);
  if (!settings.ok) return meissner::kNoRoom;
  top.in_id_i = 0;
  top.in_last_i = 0;
  top.in_user_i = 0;
  const auto put = [&](int64_t k) {
    top.in_start_i = k % length == 0;
    top.in_data_i = meissner::low_bits(samples[k], 17);
  };
  auto results = driver.results(count, [&](int64_t k) { amplitudes[k] = top.out_data_o; });
  driver.start();
  return driver.run(count * length, {}, put, results);
}
