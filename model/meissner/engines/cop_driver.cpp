// Batch driver of the Verilated msn_cop behind a C ABI: whole frames in, one result per frame out.
#include <cstdint>
#include <cstring>

#include "Vmsn_cop.h"
#include "Vmsn_cop___024root.h"
#include "core.hpp"

extern "C" {

// The arrays that results go to; mx and my as wide as their ports, without their sign extended.
struct CopResults {
  uint64_t *sum, *mx, *my;
  int16_t *x, *y;
  uint8_t *valid;
};

// Send `frames` frames of `rows` x `columns` forces, a beat a clock unless the core waits, each row padded
// to whole beats. The last `trace_beats` beats and what follows go to `trace_path`, if there is one and the
// core was built for it. Returns the clocks it took, or -1 if not one result per frame came out.
int64_t cop_run(const uint16_t *forces, int64_t frames, int32_t rows, int32_t columns, int64_t min_load, int32_t sum_bits,
                const CopResults *results, const char *trace_path, int64_t trace_beats, int64_t clk_khz) {
  meissner::Core<Vmsn_cop> core;
  auto &top = core.top;
  const auto &inner = *top.rootp;
  constexpr int32_t kLanes = sizeof(top.in_data_i) / sizeof(uint16_t);
  const int64_t row_beats = (columns + kLanes - 1) / kLanes;
  int64_t clocks = 0, moments = 0, done = 0, beats_left = frames * rows * row_beats;
  bool room = true;

  const auto clock = [&] {
    core.clock();
    clocks++;
    if (inner.msn_cop__DOT__sums_valid && inner.msn_cop__DOT__sums_ready) {
      if ((room = room && moments < frames)) {
        results->mx[moments] = inner.msn_cop__DOT__mx;
        results->my[moments] = inner.msn_cop__DOT__my;
        moments++;
      }
    }
    if (top.out_valid_o) {
      if ((room = room && done < frames)) {
        results->sum[done] = top.out_load_o;
        results->x[done] = static_cast<int16_t>(top.out_x_o);
        results->y[done] = static_cast<int16_t>(top.out_y_o);
        results->valid[done] = top.out_pressed_o;
        done++;
      }
    }
  };

  meissner::Settings settings;
  settings.put(top.cfg_min_load_i, min_load, sum_bits);
  if (!settings.ok) return meissner::kNoRoom;
  top.out_ready_i = 1;
  top.in_valid_i = 0;
  top.rst_i = 1;
  for (int i = 0; i < 4; i++) core.clock();
  top.rst_i = 0;
  top.in_valid_i = 1;
  for (int64_t row = 0; row < frames * rows; row++, forces += columns) {
    const bool last_row = (row + 1) % rows == 0;
    for (int32_t column = 0; column < columns; column += kLanes) {
      const int32_t count = columns - column < kLanes ? columns - column : kLanes;
      uint16_t beat[kLanes] = {};
      std::memcpy(beat, forces + column, count * sizeof(uint16_t));
      std::memcpy(&top.in_data_i, beat, sizeof(beat));  // both little-endian, the leftmost column lowest
      top.in_fits_i = 1;
      top.in_row_last_i = column + kLanes >= columns;
      top.in_last_i = last_row && column + kLanes >= columns;
      bool taken;
      int waited = 0;
      if (trace_path && beats_left-- == trace_beats) core.start_trace(trace_path, clk_khz);
      do {
        taken = top.in_ready_o;
        clock();
      } while (!taken && ++waited < 1000);
      if (!taken) return -1;
    }
  }
  top.in_valid_i = 0;
  for (int i = 0; i < 100 && done < frames; i++) clock();
  return room && moments == frames && done == frames ? clocks : -1;
}

}  // extern "C"
