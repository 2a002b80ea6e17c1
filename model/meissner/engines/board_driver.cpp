// Drives rtl/boards/msn_board.sv from its converters' pins and listens to its serial line.
#include <cstdint>

#include "Vmsn_board.h"
#include "Vmsn_board___024root.h"
#include "adc_parts.hpp"
#include "core.hpp"

namespace {

using Core = meissner::Core<Vmsn_board>;

// Bytes of the line tx, 8N1, a bit of sixteenths / 16 clocks.
struct Line {
  int64_t sixteenths;
  uint8_t *bytes;
  int64_t room, count = 0, left = 0;
  int bit = -1, byte = 0;
  bool idle = false;  // before the reset is over the line may be anything

  void step(bool level) {
    idle = idle || level;
    if (bit < 0) {
      if (idle && !level) bit = 0, byte = 0, left = sixteenths * 3 / 2;  // the middle of the lowest bit
      return;
    }
    left -= 16;
    if (left > 0) return;
    left += sixteenths;
    if (bit < 8) byte |= level << bit;
    if (++bit == 9) {
      if (count < room) bytes[count] = static_cast<uint8_t>(byte);
      count++;
      bit = -1;
    }
  }
};

template <typename Part>
int64_t run(Core *core, Part first, int converters, int lanes, const int32_t *codes, int64_t steps, int64_t clocks,
            Line line) {
  Part parts[8] = {first, first, first, first, first, first, first, first};
  auto &top = core->top;
  top.good_i = 1;
  top.rx_i = 1;
  top.moving_i = 0;
  for (int64_t step = 0; step < steps; step++, codes += 8 * converters) {
    for (int64_t clock = 0; clock < clocks; clock++) {
      core->clock();
      line.step(top.tx_o);
      int miso = 0, busy = 0;
      for (int k = 0; k < converters; k++) {
        // A matrix: every row has codes of its own.
        int32_t seen[8];
        for (int c = 0; c < 8; c++) seen[c] = codes[8 * k + c] + 37 * top.row_o + 11 * top.group_o;
        parts[k].step(top.adc_cs_n_o, top.adc_sclk_o, top.adc_mosi_o, top.adc_convst_o, seen);
        miso |= (parts[k].miso & ((1 << lanes) - 1)) << k * lanes;
        busy |= parts[k].busy << k;
      }
      top.adc_miso_i = miso;
      top.adc_busy_i = busy;
    }
  }
  return line.count;
}

}  // namespace

extern "C" {

Core *board_new() { return new Core; }
void board_delete(Core *core) { delete core; }

// Show codes [steps][converters][8], each for `clocks` clocks, to converters of `part` (msn_pkg::adc_part_e). Returns
// how many bytes came over the line; the first `room` are in `bytes`.
int64_t board_run(Core *core, int32_t part, int32_t converters, int32_t lanes, const int32_t *codes, int64_t steps,
                  int64_t clocks, int64_t sixteenths, uint8_t *bytes, int64_t room) {
  const Line line{sixteenths, bytes, room};
  switch (part) {
    case 1: return run(core, meissner::Mcp3208{}, converters, lanes, codes, steps, clocks, line);
    case 2: return run(core, meissner::Ad7606{100}, converters, lanes, codes, steps, clocks, line);
    case 3: return run(core, meissner::Max11123{}, converters, lanes, codes, steps, clocks, line);
    default: return run(core, meissner::Max11125{}, converters, lanes, codes, steps, clocks, line);
  }
}

}  // extern "C"
