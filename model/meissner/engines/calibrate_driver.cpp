// Batch driver of the Verilated msn_calibrate_taxels, one lane: codes in, forces out.
#include "Vmsn_calibrate_taxels.h"
#include "Vmsn_calibrate_taxels___024root.h"
#include "driver.hpp"

// Load `taxels` offsets and gains, then send `frames` frames of codes, one taxel per clock unless the core stalls;
// `mask`: taxels to leave out. Returns the clocks taken, or -1 unless there was exactly one force per code.
extern "C" int64_t calibrate_run(const int32_t *codes, int64_t frames, int32_t taxels, int32_t columns,
                                 const int64_t *offset, const int64_t *gain, const uint8_t *mask, uint16_t *forces) {
  meissner::Driver<Vmsn_calibrate_taxels> driver;
  auto &top = driver.top;
  auto results = driver.results(frames * taxels, [&](int64_t k) { forces[k] = top.out_data_o; });
  top.cfg_write_i = 0;
  top.cfg_write_row_i = 0;
  top.cfg_swap_i = 0;
  driver.start();
  meissner::Settings settings;
  top.cfg_write_i = 1;
  for (int32_t k = 0; k < taxels; k++) {
    top.cfg_word_i = k;
    settings.put_signed(top.cfg_offset_i, offset[k], 17);
    settings.put(top.cfg_gain_i, gain[k], 16);
    driver.clock(results);
  }
  if (!settings.ok) return meissner::kNoRoom;
  top.cfg_write_i = 0;
  top.cfg_swap_i = 1;
  driver.clock(results);
  top.cfg_swap_i = 0;
  for (int i = 0; i < 100 && top.cfg_swapping_o; i++) driver.clock(results);
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
