// Batch driver of the Verilated msn_calibrate, one lane, behind a C ABI: codes in, forces out.
#include <cstdint>

#include "Vmsn_calibrate.h"
#include "Vmsn_calibrate___024root.h"
#include "core.hpp"
#include "verilated.h"

namespace {

struct Core {
  VerilatedContext context;
  Vmsn_calibrate top{&context};

  Core() { top.clk_i = 1; }

  // One rising edge; see channels_driver.cpp.
  void clock() {
    top.rootp->__Vtrigprevexpr___TOP__clk_i__0 = 0;
    top.eval();
  }
};

}  // namespace

extern "C" {

// Load `taxels` offsets and gains, then send `frames` frames of codes, a taxel a clock unless the core waits;
// `mask`: taxels to leave out. Returns the clocks it took, or -1 if not one force per code came out.
int64_t calibrate_run(const int32_t *codes, int64_t frames, int32_t taxels, int32_t columns, const int64_t *offset,
                      const int64_t *gain, const uint8_t *mask, uint16_t *forces) {
  Core core;
  auto &top = core.top;
  const int64_t count = frames * taxels;
  int64_t clocks = 0, done = 0;
  bool room = true;

  const auto clock = [&] {
    core.clock();
    clocks++;
    if (top.out_valid_o && (room = room && done < count)) forces[done++] = top.out_data_o;
  };

  top.out_ready_i = 1;
  top.in_valid_i = 0;
  top.cfg_write_i = 0;
  top.cfg_write_row_i = 0;
  top.cfg_swap_i = 0;
  top.rst_i = 1;
  for (int i = 0; i < 4; i++) core.clock();
  top.rst_i = 0;
  meissner::Settings settings;
  top.cfg_write_i = 1;
  for (int32_t k = 0; k < taxels; k++) {
    top.cfg_word_i = k;
    settings.put_signed(top.cfg_offset_i, offset[k], 17);
    settings.put(top.cfg_gain_i, gain[k], 16);
    if (!settings.ok) return meissner::kNoRoom;
    clock();
  }
  top.cfg_write_i = 0;
  top.cfg_swap_i = 1;
  clock();
  top.cfg_swap_i = 0;
  for (int i = 0; i < 100 && top.cfg_swapping_o; i++) clock();
  top.in_valid_i = 1;
  for (int64_t k = 0; k < count; k++) {
    const int32_t taxel = k % taxels;
    top.in_data_i = static_cast<uint32_t>(codes[k]) & 0x1ffff;
    top.in_mask_i = mask[taxel];
    top.in_fits_i = 1;
    top.in_row_last_i = taxel % columns == columns - 1;
    top.in_last_i = taxel == taxels - 1;
    bool taken;
    int waited = 0;
    do {
      taken = top.in_ready_o;
      clock();
    } while (!taken && ++waited < 1000);
    if (!taken) return -1;
  }
  top.in_valid_i = 0;
  for (int i = 0; i < 100 && done < count; i++) clock();
  return room && done == count ? clocks : -1;
}

}  // extern "C"
