// Batch driver of the Verilated msn_cop4: the codes of E1..E4 in, one result per sample out.
#include "Vmsn_cop4.h"
#include "Vmsn_cop4___024root.h"
#include "driver.hpp"

extern "C" {

// Every register as a number; `p`: the six terms of the correction.
struct Cop4Registers {
  int64_t rail, kx, shift_x, ky, shift_y, kf, shift_load, top, idle, busy, imbalance, min_load;
  int64_t p[6];
};

// Send `count` samples [count][4] of `bits` bits, each as soon as the core takes it. flags: pressed, over << 1,
// saturated << 2, imbalance << 3, open << 4. The clocks from the last `trace_samples` samples on go to `trace_path`,
// if given and if the core was built for it. Returns the clocks taken, or -1 unless there was exactly one result per
// sample.
int64_t cop4_run(const int32_t *codes, int64_t count, uint32_t bits, const Cop4Registers *registers, int16_t *x,
                 int16_t *y, uint16_t *load, uint8_t *flags, const char *trace_path, int64_t trace_samples,
                 int64_t clk_khz) {
  meissner::Driver<Vmsn_cop4> driver;
  auto &top = driver.top;
  meissner::Settings settings;
  const int width = static_cast<int>(bits);
  settings.put(top.cfg_rail_i, registers->rail, width);
  settings.put(top.cfg_kx_i, registers->kx, 17);
  settings.put(top.cfg_shift_x_i, registers->shift_x, 4);
  settings.put(top.cfg_ky_i, registers->ky, 17);
  settings.put(top.cfg_shift_y_i, registers->shift_y, 4);
  settings.put(top.cfg_kf_i, registers->kf, 17);
  settings.put(top.cfg_shift_load_i, registers->shift_load, 4);
  settings.put(top.cfg_min_load_i, registers->min_load, 16);
  settings.put(top.cfg_top_i, registers->top, width - 1);
  settings.put_signed(top.cfg_idle_i, registers->idle, width);
  settings.put_signed(top.cfg_busy_i, registers->busy, width);
  settings.put(top.cfg_imbalance_i, registers->imbalance, width + 1);
  for (int word = 0; word < 4; word++) top.cfg_p_i[word] = 0;
  for (int term = 0; term < 6; term++) {
    uint32_t word;
    settings.put_signed(word, registers->p[term], 18);
    for (int bit = 0, place = 18 * term; bit < 18; bit++, place++) {
      top.cfg_p_i[place / 32] |= (word >> bit & 1) << place % 32;
    }
  }
  if (!settings.ok) return meissner::kNoRoom;
  const auto put = [&](int64_t k) {
    top.in_e1_i = meissner::low_bits(codes[4 * k], width);
    top.in_e2_i = meissner::low_bits(codes[4 * k + 1], width);
    top.in_e3_i = meissner::low_bits(codes[4 * k + 2], width);
    top.in_e4_i = meissner::low_bits(codes[4 * k + 3], width);
  };
  auto results = driver.results(count, [&](int64_t k) {
    x[k] = static_cast<int16_t>(top.out_x_o);
    y[k] = static_cast<int16_t>(top.out_y_o);
    load[k] = top.out_load_o;
    flags[k] = static_cast<uint8_t>(top.out_pressed_o | top.out_over_o << 1 | top.out_saturated_o << 2 |
                                    top.out_imbalance_o << 3 | top.out_open_o << 4);
  });
  driver.start();
  return driver.run(count, {trace_path, trace_samples, clk_khz}, put, results);
}

}  // extern "C"
