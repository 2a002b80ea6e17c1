// Batch driver of the Verilated msn_render: what a sensor felt in, frames of pin levels out.
#include "Vmsn_render.h"
#include "Vmsn_render___024root.h"
#include "driver.hpp"

extern "C" {

// Render `frames` frames: `image` of `taxels` codes each (taxels 0: none); `felt`: slip, octant, valid, x and y of each.
// `settings`: floor, step, marker, cue. `pins` levels of each frame come. `wait`: clocks for a frame.
int64_t render(const uint16_t *image, int64_t frames, int32_t taxels, const int32_t *felt, const int64_t *settings,
               int32_t pins, int64_t wait, uint8_t *levels) {
  meissner::Driver<Vmsn_render> driver;
  auto &top = driver.top;
  meissner::Settings given;
  given.put(top.cfg_floor_i, settings[0], 16);
  given.put(top.cfg_step_i, settings[1], 16);
  given.put(top.cfg_marker_i, settings[2], 1);
  given.put(top.cfg_cue_i, settings[3], 8);
  if (!given.ok) return meissner::kNoRoom;
  top.in_valid_i = 0;
  top.cop_valid_i = 0;
  driver.reset();
  for (int64_t frame = 0; frame < frames; ++frame) {
    const int32_t *one = felt + 5 * frame;
    top.slip_i = one[0];
    top.octant_i = one[1];
    top.cop_pressed_i = one[2];
    top.cop_x_i = meissner::low_bits(one[3], 16);
    top.cop_y_i = meissner::low_bits(one[4], 16);
    top.cop_valid_i = 1;
    int32_t sent = 0, got = 0;
    for (int64_t left = wait; got < pins || top.busy_o || top.out_valid_o; --left) {
      if (left == 0) return meissner::kFailed;
      top.in_valid_i = sent < taxels;
      if (top.in_valid_i) {
        top.in_data_i = image[frame * taxels + sent++];
        top.in_last_i = sent == taxels;
      }
      driver.clock();
      top.cop_valid_i = 0;
      if (!top.out_valid_o) continue;
      if (got == pins || top.out_last_o != (got == pins - 1)) return meissner::kFailed;
      levels[frame * pins + got++] = top.out_data_o;
    }
  }
  return driver.clocks;
}

}  // extern "C"
