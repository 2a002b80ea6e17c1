// Batch driver of the Verilated msn_calibrate, one lane: codes in, forces out.
#include "Vmsn_calibrate.h"
#include "Vmsn_calibrate___024root.h"
#include "driver.hpp"

// Load `taxels` offsets and gains, then send `frames` frames of codes, one taxel per clock unless the core stalls;
// `mask`: taxels to leave out. Returns the clocks taken, or -1 unless there was exactly one force per code.
extern "C" int64_t calibrate_run(const int32_t *codes, int64_t frames, int32_t taxels, int32_t columns,
                                 const int64_t *offset, const int64_t *gain, const uint8_t *mask, uint16_t *forces) {
  meissner::Driver<Vmsn_calibrate> driver;
  auto &top = driver.top;
  auto results = driver.results(frames * taxels, [&](int64_t k) { forces[k] = top.out_data_o; });
  // msn_registers_pkg::calibrate_cfg_t without its highest member, the preset.
  const auto set = [&](uint64_t word, uint64_t offset, uint64_t gain, uint64_t write, uint64_t swap) {
    const uint64_t bits = word << 44 | offset << 27 | gain << 11 | write << 3 | write << 1 | swap;
    top.cfg_i[0] = static_cast<uint32_t>(bits);
    top.cfg_i[1] = static_cast<uint32_t>(bits >> 32);
    top.cfg_i[2] = 0;
  };
  set(0, 0, 0, 0, 0);
  driver.start();
  meissner::Settings settings;
  for (int32_t k = 0; k < taxels; k++) {
    uint64_t o, g;
    settings.put_signed(o, offset[k], 17);
    settings.put(g, gain[k], 16);
    set(k, o, g, 1, 0);
    driver.clock(results);
  }
  if (!settings.ok) return meissner::kNoRoom;
  set(0, 0, 0, 0, 1);
  driver.clock(results);
  set(0, 0, 0, 0, 0);
  for (int i = 0; i < 100 && top.status_o; i++) driver.clock(results);
  top.in_fits_i = 1;
  const auto put = [&](int64_t k) {
    const int64_t taxel = k % taxels;
    top.in_data_i = meissner::low_bits(codes[k], 17);
    top.in_mask_i = mask[taxel];
    top.in_row_last_i = taxel % columns == columns - 1;
    top.in_last_i = taxel == taxels - 1;
  };
  return driver.run(results.room, {}, put, results);
}
