// A complete core with its converters and its serial line, behind a C ABI: a sensor's codes at the pins, bytes on the
// line in both directions. The top is msn_core, or msn_board, which resets itself and has converters with shared lines.
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#if __has_include("Vmsn_board.h")
#include "Vmsn_board.h"
#include "Vmsn_board___024root.h"
using Top = Vmsn_board;
#else
#include "Vmsn_core.h"
#include "Vmsn_core___024root.h"
using Top = Vmsn_core;
#endif
#include "adc_parts.hpp"
#include "driver.hpp"
#include "serial.hpp"

namespace {

// One bit of a port of any width.
template <typename Port>
bool bit_of(const Port &port, int place) {
  if constexpr (std::is_integral_v<Port>) {
    return port >> place & 1;
  } else {
    return port[place / 32] >> place % 32 & 1;
  }
}

// The number of the set bit of a one-hot port.
template <typename Port>
int one_of(const Port &port, int bits) {
  int place = 0;
  while (place + 1 < bits && !bit_of(port, place)) ++place;
  return place;
}

struct Size {
  int32_t part, converters, adc_lanes, rows, columns, channels;  // channels of each converter
};

#if !__has_include("Vmsn_board.h")
// An SDRAM at sdram_o, without its times: rows open, bursts of four are read four clocks later, or written.
struct Sdram {
  std::vector<uint16_t> cells;
  uint32_t row[4] = {}, place = 0;
  int left = 0;  // of a burst that is written
  uint16_t beats[8] = {};
  uint32_t now = 0;

  // The data that the core takes next, for the lines of msn_pkg::sdram_t.
  uint16_t step(uint64_t lines) {
    if (!(lines >> 37 & 1)) {
      const uint32_t command = lines >> 34 & 7, bank = lines >> 32 & 3, a = lines >> 19 & 0x1FFF;
      const uint32_t at = bank << 22 | row[bank] << 9 | (a & 511);
      if (cells.empty()) cells.resize(1 << 24);
      if (command == 3) row[bank] = a;
      if (command == 4) place = at, left = 4;
      for (int k = 0; command == 5 && k < 4; ++k) beats[(now + 3 + k) & 7] = cells[at + k];
    }
    if (left > 0) cells[place++] = lines >> 1, --left;
    return beats[now++ & 7];
  }
};
#endif

struct Sensor {
  meissner::Driver<Top> core;
  const Size size;
  const int64_t frame_codes;
  const std::vector<int32_t> codes;
  const int64_t frames, places, shown;
  meissner::Receiver from_core;
  meissner::Sender to_core;
  std::vector<std::unique_ptr<meissner::Converter>> converters;
  std::vector<int32_t> held;  // eight codes of each converter
  int64_t converted = 0;

  Sensor(const Size &size, int32_t busy_clocks, int64_t places, int64_t shown, const int32_t *given, int64_t frames,
         int64_t sixteenths)
      : size(size),
        frame_codes(int64_t{size.rows} * size.columns),
        codes(given, given + frames * frame_codes),
        frames(frames),
        places(places),
        shown(shown),
        from_core(sixteenths),
        to_core(sixteenths),
        held(8 * size.converters) {
    for (int lane = 0; lane < size.converters; ++lane) {
      converters.push_back(meissner::converter(size.part, busy_clocks));
    }
  }

#if __has_include("Vmsn_board.h")
  void start() {
    core.top.good_i = 1;
    core.top.moving_i = 0;
  }
  // Up to eight rows have a line each; more are driven as a number, with a line above it that is low while driving.
  int number_bits() const {
    int bits = 1;
    while (1 << bits < size.rows) ++bits;
    return bits;
  }
  int row() const {
    return size.rows > 8 ? core.top.row_o & ((1 << number_bits()) - 1) : one_of(core.top.row_o, size.rows);
  }
  bool dark() const { return size.rows > 8 && bit_of(core.top.row_o, number_bits()); }
  bool converts() const { return true; }  // the board's converters see the inputs at any time
  void remember() {}
  int line(int) const { return 0; }
#else
  void start() {
    core.top.actuator_moving_i = 0;
    core.top.bus_valid_i = 0;
    core.start();
  }
  int row() const { return one_of(core.top.row_o, size.rows); }
  bool dark() const { return false; }
  Sdram sdram;
  void remember() { core.top.sdram_dq_i = sdram.step(core.top.sdram_o); }
  bool converts() const { return core.top.rootp->msn_core__DOT__convert; }
  int line(int lane) const { return lane; }
#endif

  // Number of frames begun.
  int64_t frame() const { return shown ? core.clocks / shown : converted / places; }

  // Update the inputs of every converter from this clock on.
  void show() {
    const int32_t *first = &codes[frame() % frames * frame_codes + row() * size.columns];
    const int lanes = size.converters;
    for (int lane = 0; lane < lanes; ++lane) {
      for (int channel = 0; channel < size.channels; ++channel) {
        const int column = (core.top.group_o * size.channels + channel) * lanes + lane;
        held[8 * lane + channel] = column < size.columns && !dark() ? first[column] : 0;
      }
    }
  }

  void clock() {
    core.clock();
    if (converts()) {
      show();
      ++converted;
    }
    uint64_t miso = 0, busy = 0;
    for (int lane = 0; lane < size.converters; ++lane) {
      auto &part = *converters[lane];
      const int wire = line(lane);
      part.step(bit_of(core.top.adc_cs_n_o, wire), bit_of(core.top.adc_sclk_o, wire),
                bit_of(core.top.adc_mosi_o, wire), bit_of(core.top.adc_convst_o, wire), &held[8 * lane]);
      miso |= static_cast<uint64_t>(part.miso & ((1 << size.adc_lanes) - 1)) << lane * size.adc_lanes;
      busy |= static_cast<uint64_t>(part.busy) << lane;
    }
    core.top.adc_miso_i = miso;
    core.top.adc_busy_i = busy;
    core.top.rx_i = to_core.step();
    remember();
  }
};

}  // namespace

extern "C" {

// `codes`: frames of rows x columns, repeated; each lasts `shown` clocks, or `places` conversions if `shown` is 0.
// `sixteenths`: length of a bit on the line in sixteenths of a clock.
Sensor *sensor_new(const Size *size, int32_t busy_clocks, int64_t places, int64_t shown, const int32_t *codes,
                   int64_t frames, int64_t sixteenths) {
  auto *sensor = new Sensor(*size, busy_clocks, places, shown, codes, frames, sixteenths);
  sensor->core.top.rx_i = 1;
  sensor->start();
  return sensor;
}

void sensor_delete(Sensor *sensor) { delete sensor; }

void sensor_write(Sensor *sensor, const uint8_t *data, int64_t count) { sensor->to_core.send(data, count); }

// Run for `clocks` clocks or until `room` bytes were received; returns the number of bytes.
int64_t sensor_run(Sensor *sensor, int64_t clocks, uint8_t *out, int64_t room) {
  int64_t count = 0;
  for (; clocks > 0 && count < room; --clocks) {
    sensor->clock();
    if (sensor->from_core.step(sensor->core.top.tx_o)) out[count++] = sensor->from_core.byte;
  }
  return count;
}

int64_t sensor_now(const Sensor *sensor) { return sensor->core.clocks; }

int64_t sensor_frames(const Sensor *sensor) { return sensor->frame(); }

}  // extern "C"
