// Batch driver of the Verilated msn_forest_features: complete frames in, all features out.
#include "Vmsn_forest_features.h"
#include "Vmsn_forest_features___024root.h"
#include "driver.hpp"

extern "C" {

// Send `frames` frames of `channels` samples of 17 bits, of which the first begins a recording; `count` features are
// to come, of 18 bits. Returns the clocks taken, or -1 unless as many came.
int64_t forest_features(const int32_t *samples, int64_t frames, int32_t channels, int32_t *features, int64_t count) {
  constexpr int kBits = 17;
  meissner::Driver<Vmsn_forest_features> driver;
  auto &top = driver.top;
  const auto put = [&](int64_t k) {
    const int64_t channel = k % channels;
    top.in_data_i = meissner::low_bits(samples[k], kBits);
    top.in_id_i = channel;
    top.in_last_i = channel == channels - 1;
    top.in_restart_i = k < channels;
  };
  auto found = driver.results(count, [&](int64_t k) {
    constexpr int kSpare = 32 - (kBits + 1);
    features[k] = static_cast<int32_t>(static_cast<uint32_t>(top.out_data_o) << kSpare) >> kSpare;
  });
  driver.start();
  // As many clocks as a window of the largest size takes may pass before a sample is taken.
  if (!driver.send(frames * channels, 1 << 21, {}, put, found)) return meissner::kFailed;
  for (int64_t k = 0; k < (int64_t{1} << 21) && !found.complete(); ++k) driver.clock(found);
  for (int k = 0; k < 8; ++k) driver.clock(found);
  return found.complete() ? driver.clocks : meissner::kFailed;
}

}  // extern "C"
