// SPDX-License-Identifier: Apache-2.0
//
// Runs msn_adc_spi on a part of engines/adc_parts.hpp and prints every sample: id, data, over-range, last.
// Arguments: frames, period in clocks. The codes come from code() below; test_adc_parts.py has the same.

#include <cstdio>
#include <cstdlib>

#include "Vtop.h"
#include "adc_parts.hpp"

static int32_t code(uint32_t frame, uint32_t channel) {
  if (frame < 2) return frame ? 0xffff : 0;
  return static_cast<int32_t>(((frame * 8 + channel) * 2654435761u) >> 13 & 0xffff);
}

int main(int, char **argv) {
  const uint32_t frames = static_cast<uint32_t>(std::atoi(argv[1]));
  Vtop top;
  PART part;
  int32_t codes[8] = {};
  uint32_t converts = 0;

  top.cfg_period_i = static_cast<uint32_t>(std::atoi(argv[2]));
  top.out_ready_i = 1;
  for (uint32_t clock = 0; converts <= frames; ++clock) {
    top.rst_i = clock < 4;
    top.cfg_enable_i = clock > 100;  // the first tick waits until the part is set up
    top.clk_i = 0;
    top.eval();
    if (top.out_valid_o) {
      std::printf("%d %d %d %d\n", top.out_id_o, static_cast<int32_t>(top.out_data_o << 15) >> 15, top.out_user_o,
                  top.out_last_o);
    }
    if (top.convert_o) {
      for (uint32_t channel = 0; channel < 8; ++channel) codes[channel] = code(converts, channel);
      ++converts;
    }
    part.step(top.adc_cs_n_o, top.adc_sclk_o, top.adc_mosi_o, top.adc_convst_o, codes);
    top.adc_miso_i = part.miso & ((1 << LANES) - 1);
    top.adc_busy_i = part.busy;
    top.clk_i = 1;
    top.eval();
  }
  return top.dropped_o || top.overrun_o || top.timeout_o || top.mistagged_o;
}
