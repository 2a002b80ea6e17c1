// Batch driver of the Verilated shear speed estimators behind a C ABI: complete arrays in, complete arrays out.
#include <cstring>

#include "Vmsn_shear_speeds.h"
#include "Vmsn_shear_speeds___024root.h"
#include "driver.hpp"

namespace {

constexpr int64_t kWindow = 64;
constexpr int kWork = 80;  // clocks from a window's last sample until all channels are in the registers

// The word of `channel` in the status: channel 0 highest, below all channels two levels and a count; speed above flags.
template <typename Status>
uint32_t word_of(const Status &status, int channel) {
  constexpr int kBelow = 26 + 27 + 32;
  const int low = kBelow + 32 * (7 - channel);
  const uint64_t both = status[low / 32] | static_cast<uint64_t>(status[low / 32 + 1]) << 32;
  const auto word = static_cast<uint32_t>(both >> low % 32);
  return word >> 8 | word << 24;  // as in its register: flags above speed
}

}  // namespace

extern "C" {

// Reset with the settings, msn_registers_pkg::shear_speed_cfg_t, lowest byte first; send `frames` frames of `channels`
// samples; `moving` has one byte per frame, or is null. `words`: the registers of all channels after each window.
// Returns the number of windows, kNoRoom if the number of bytes of the settings is not that of the port, or kFailed.
int64_t shear_speeds(const char *settings, int64_t bytes, const int32_t *samples, int64_t frames, int32_t channels,
                     const uint8_t *moving, uint32_t *words, int64_t room) {
  meissner::Driver<Vmsn_shear_speeds> core;
  auto &top = core.top;
  if (bytes != sizeof(top.cfg_i)) return meissner::kNoRoom;
  std::memcpy(&top.cfg_i, settings, sizeof(top.cfg_i));
  top.actuator_moving_i = 0;
  top.grip_valid_i = 0;
  std::memset(&top.grip_i, 0, sizeof(top.grip_i));
  core.start();
  int32_t channel = 0;
  const auto put = [&](int64_t) {
    top.in_data_i = meissner::low_bits(*samples++, 17);
    top.in_id_i = channel;
    top.in_last_i = channel == channels - 1;
    channel = channel == channels - 1 ? 0 : channel + 1;
  };
  int64_t count = 0;
  for (int64_t frame = 0; frame < frames; ++frame) {
    if (moving && moving[frame] != top.actuator_moving_i) {
      for (int i = 0; i < 4; ++i) core.clock();  // samples in flight pass
      top.actuator_moving_i = moving[frame];
      for (int i = 0; i < 4; ++i) core.clock();
    }
    if (!core.send(channels, kWork, {}, put)) return meissner::kFailed;
    if ((frame + 1) % kWindow == 0) {
      for (int i = 0; i < kWork; ++i) core.clock();
      if (count++ >= room) return meissner::kFailed;
      for (int32_t c = 0; c < channels; ++c) *words++ = word_of(top.status_o, c);
    }
  }
  return count;
}

}  // extern "C"
