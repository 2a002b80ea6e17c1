// Batch driver of the Verilated msn_cop_slip: positions and loads in, one decision each out.
#include "Vmsn_cop_slip.h"
#include "Vmsn_cop_slip___024root.h"
#include "driver.hpp"

extern "C" {

struct CopSlipRegisters {
  int64_t drop, move, min_load, hold, refractory;
};

// moves: dx, dy [count][2]; flags: slip, raised << 1, over << 2, octant << 3. The rest is as in cop4_driver.cpp.
int64_t cop_slip_run(const int16_t *x, const int16_t *y, const uint16_t *load, const uint8_t *pressed, int64_t count,
                     const CopSlipRegisters *registers, int32_t *moves, uint8_t *flags, const char *trace_path,
                     int64_t trace_samples, int64_t clk_khz) {
  meissner::Driver<Vmsn_cop_slip> driver;
  auto &top = driver.top;
  meissner::Settings settings;
  settings.put(top.cfg_drop_i, registers->drop, 8);
  settings.put(top.cfg_move_i, registers->move, 16);
  settings.put(top.cfg_min_load_i, registers->min_load, 16);
  settings.put(top.cfg_hold_i, registers->hold, 16);
  settings.put(top.cfg_refractory_i, registers->refractory, 16);
  if (!settings.ok) return meissner::kNoRoom;
  const auto put = [&](int64_t k) {
    top.in_x_i = static_cast<uint16_t>(x[k]);
    top.in_y_i = static_cast<uint16_t>(y[k]);
    top.in_load_i = load[k];
    top.in_pressed_i = pressed[k];
  };
  const auto extended = [](uint32_t value) { return static_cast<int32_t>(value << 15) >> 15; };  // 17 bits
  auto decisions = driver.results(count, [&](int64_t k) {
    moves[2 * k] = extended(top.out_dx_o);
    moves[2 * k + 1] = extended(top.out_dy_o);
    flags[k] = static_cast<uint8_t>(top.out_slip_o | top.out_raised_o << 1 | top.out_over_o << 2 |
                                    top.out_octant_o << 3);
  });
  driver.start();
  return driver.run(count, {trace_path, trace_samples, clk_khz}, put, decisions);
}

}  // extern "C"
