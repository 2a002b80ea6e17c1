// Batch driver of the Verilated msn_cop_slip behind a C ABI: positions and loads in, one decision each out.
#include <cstdint>

#include "Vmsn_cop_slip.h"
#include "Vmsn_cop_slip___024root.h"
#include "core.hpp"

extern "C" {

struct CopSlipRegisters {
  int64_t drop, move, min_load, hold, refractory;
};

// Send `count` samples, one whenever the core takes it. moves: dx, dy [count][2]; flags: slip, raised << 1,
// over << 2, octant << 3. The trace is cop4_driver.cpp's. Returns the clocks it took, or -1 if not one
// decision per sample came out.
int64_t cop_slip_run(const int16_t *x, const int16_t *y, const uint16_t *load, const uint8_t *pressed,
                     int64_t count, const CopSlipRegisters *registers, int32_t *moves, uint8_t *flags,
                     const char *trace_path, int64_t trace_samples, int64_t clk_khz) {
  meissner::Core<Vmsn_cop_slip> core;
  auto &top = core.top;
  int64_t clocks = 0, done = 0;
  bool room = true;
  const auto extended = [](uint32_t value) { return static_cast<int32_t>(value << 15) >> 15; };  // 17 bits

  const auto clock = [&] {
    core.clock();
    clocks++;
    if (!top.out_valid_o || !(room = room && done < count)) return;
    moves[2 * done] = extended(top.out_dx_o);
    moves[2 * done + 1] = extended(top.out_dy_o);
    flags[done] = static_cast<uint8_t>(top.out_slip_o | top.out_raised_o << 1 | top.out_over_o << 2 |
                                       top.out_octant_o << 3);
    done++;
  };

  meissner::Settings settings;
  settings.put(top.cfg_drop_i, registers->drop, 8);
  settings.put(top.cfg_move_i, registers->move, 16);
  settings.put(top.cfg_min_load_i, registers->min_load, 16);
  settings.put(top.cfg_hold_i, registers->hold, 16);
  settings.put(top.cfg_refractory_i, registers->refractory, 16);
  if (!settings.ok) return meissner::kNoRoom;
  top.out_ready_i = 1;
  top.in_valid_i = 0;
  top.rst_i = 1;
  for (int i = 0; i < 4; i++) core.clock();
  top.rst_i = 0;
  top.in_valid_i = 1;
  for (int64_t sample = 0; sample < count; sample++) {
    top.in_x_i = static_cast<uint16_t>(x[sample]);
    top.in_y_i = static_cast<uint16_t>(y[sample]);
    top.in_load_i = load[sample];
    top.in_pressed_i = pressed[sample];
    bool taken;
    int waited = 0;
    if (trace_path && count - sample == trace_samples) core.start_trace(trace_path, clk_khz);
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
