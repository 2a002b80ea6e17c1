// Batch driver of the Verilated msn_cop: complete frames in, one result per frame out.
#include <cstring>

#include "Vmsn_cop.h"
#include "Vmsn_cop___024root.h"
#include "driver.hpp"

extern "C" {

// The arrays for the results; mx and my are as wide as their ports and not sign-extended.
struct CopResults {
  uint64_t *sum, *mx, *my;
  int16_t *x, *y;
  uint8_t *valid;
};

// Send `frames` frames of `rows` x `columns` forces, one beat per clock unless the core stalls, each row padded
// to full beats. The clocks from the last `trace_beats` beats on go to `trace_path`, if given and if the core was
// built for it. Returns the clocks taken, or -1 unless there was exactly one result per frame.
int64_t cop_run(const uint16_t *forces, int64_t frames, int32_t rows, int32_t columns, int64_t min_load, int32_t sum_bits,
                const CopResults *results, const char *trace_path, int64_t trace_beats, int64_t clk_khz) {
  meissner::Driver<Vmsn_cop> driver;
  auto &top = driver.top;
  const auto &inner = *top.rootp;
  constexpr int32_t kLanes = sizeof(top.in_data_i) / sizeof(uint16_t);
  const int64_t row_beats = (columns + kLanes - 1) / kLanes;
  meissner::Settings settings;
  settings.put(top.cfg_min_load_i, min_load, sum_bits);
  if (!settings.ok) return meissner::kNoRoom;
  top.in_fits_i = 1;
  const auto put = [&](int64_t k) {
    const int64_t row = k / row_beats, column = k % row_beats * kLanes;
    uint16_t beat[kLanes] = {};
    std::memcpy(beat, forces + row * columns + column, std::min<int64_t>(columns - column, kLanes) * sizeof(uint16_t));
    std::memcpy(&top.in_data_i, beat, sizeof(beat));  // both little-endian, the leftmost column lowest
    top.in_row_last_i = column + kLanes >= columns;
    top.in_last_i = top.in_row_last_i && (row + 1) % rows == 0;
  };
  const auto handed_on = [&] { return inner.msn_cop__DOT__sums_valid && inner.msn_cop__DOT__sums_ready; };
  meissner::Results moments(frames, handed_on, [&](int64_t k) {
    results->mx[k] = inner.msn_cop__DOT__mx;
    results->my[k] = inner.msn_cop__DOT__my;
  });
  auto centres = driver.results(frames, [&](int64_t k) {
    results->sum[k] = top.out_load_o;
    results->x[k] = static_cast<int16_t>(top.out_x_o);
    results->y[k] = static_cast<int16_t>(top.out_y_o);
    results->valid[k] = top.out_pressed_o;
  });
  driver.start();
  return driver.run(frames * rows * row_beats, {trace_path, trace_beats, clk_khz}, put, moments, centres);
}

}  // extern "C"
