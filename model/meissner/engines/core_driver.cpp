// The whole core with its converters and its serial line, behind a C ABI: codes of a sensor at the pins, bytes on
// the line both ways.
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "Vmsn_core.h"
#include "Vmsn_core___024root.h"
#include "adc_parts.hpp"
#include "core.hpp"

namespace {

// A port of any width, bit by bit.
template <typename Port>
bool bit_of(const Port &port, int place) {
  if constexpr (std::is_integral_v<Port>) {
    return port >> place & 1;
  } else {
    return port[place / 32] >> place % 32 & 1;
  }
}

struct Size {
  int32_t part, converters, adc_lanes, rows, columns, channels;  // rows 0: no array
};

struct Converter {
  virtual ~Converter() = default;
  virtual void step(bool cs_n, bool sclk, bool mosi, bool convst, const int32_t *codes) = 0;
  uint8_t miso = 0;
  bool busy = false;
};

template <typename Part>
struct Of final : Converter {
  Part part;
  template <typename... Given>
  explicit Of(Given... given) : part(given...) {}
  void step(bool cs_n, bool sclk, bool mosi, bool convst, const int32_t *codes) override {
    part.step(cs_n, sclk, mosi, convst, codes);
    miso = part.miso;
    busy = part.busy;
  }
};

std::unique_ptr<Converter> converter(int32_t part, int32_t busy_clocks) {
  switch (part) {
    case 1: return std::make_unique<Of<meissner::Mcp3208>>();
    case 2: return std::make_unique<Of<meissner::Ad7606>>(busy_clocks);
    case 3: return std::make_unique<Of<meissner::Max1112x<8>>>();
    case 4: return std::make_unique<Of<meissner::Max1112x<10>>>();
    default: return std::make_unique<Of<meissner::Max1112x<12>>>();
  }
}

struct Sensor {
  meissner::Core<Vmsn_core> core;
  Size size{};
  std::vector<std::unique_ptr<Converter>> converters;
  std::vector<int32_t> held;  // eight codes of each converter
  std::vector<int32_t> codes;
  int64_t frame_codes = 1, frames = 0, converted = 0, places = 1;
  double bit = 1;
  // The line from the core, and to it.
  int64_t now = 0, began = -1;
  int taken = 0, byte = 0;
  std::deque<uint8_t> to_core;
  int64_t sending = -1;

  int place_code(int row, int column) const {
    const int64_t frame = (converted / places) % frames;
    return column < size.columns ? codes[frame * frame_codes + row * size.columns + column] : 0;
  }

  // What stands at the inputs of every converter from this convert start on.
  void convert() {
    const int lanes = size.converters;
    int row = 0;
    if (size.rows) {
      while (row + 1 < size.rows && !bit_of(core.top.row_o, row)) ++row;
    }
    const int group = size.rows ? static_cast<int>(core.top.group_o) : 0;
    for (int lane = 0; lane < lanes; ++lane) {
      for (int channel = 0; channel < 8; ++channel) {
        const int column = size.rows ? (group * size.channels + channel) * lanes + lane : channel;
        held[8 * lane + channel] = channel < size.channels ? place_code(row, column) : 0;
      }
    }
    ++converted;
  }

  bool receive(uint8_t *out) {
    const bool level = core.top.tx_o;
    if (began < 0) {
      if (!level) began = now, taken = byte = 0;
      return false;
    }
    if (now - began < static_cast<int64_t>((taken + 1.5) * bit)) return false;
    if (taken < 8) {
      byte |= (level ? 1 : 0) << taken++;
      return false;
    }
    began = -1;  // in the middle of the stop bit
    *out = static_cast<uint8_t>(byte);
    return true;
  }

  void send() {
    core.top.rx_i = 1;
    if (to_core.empty()) return;
    if (sending < 0) sending = now;
    const int place = static_cast<int>((now - sending) / bit);
    if (place >= 10) {
      to_core.pop_front();
      sending = to_core.empty() ? -1 : now;
      core.top.rx_i = to_core.empty();
      return;
    }
    core.top.rx_i = place == 0 ? 0 : place == 9 ? 1 : to_core.front() >> (place - 1) & 1;
  }

  void clock() {
    core.clock();
    ++now;
    if (core.top.rootp->msn_core__DOT__convert) convert();
    uint64_t miso = 0, busy = 0;
    for (int lane = 0; lane < size.converters; ++lane) {
      auto &part = *converters[lane];
      part.step(bit_of(core.top.adc_cs_n_o, lane), bit_of(core.top.adc_sclk_o, lane),
                bit_of(core.top.adc_mosi_o, lane), bit_of(core.top.adc_convst_o, lane), &held[8 * lane]);
      miso |= static_cast<uint64_t>(part.miso & ((1 << size.adc_lanes) - 1)) << lane * size.adc_lanes;
      busy |= static_cast<uint64_t>(part.busy) << lane;
    }
    core.top.adc_miso_i = miso;
    core.top.adc_busy_i = busy;
    send();
  }
};

}  // namespace

extern "C" {

// `codes`: frames of rows x columns, or of channels, over and over. `bit`: clocks of a bit on the line.
Sensor *sensor_new(const Size *size, int32_t busy_clocks, int64_t places, const int32_t *codes, int64_t frames,
                   double bit) {
  auto *sensor = new Sensor;
  sensor->size = *size;
  if (!size->rows) sensor->size.columns = size->channels;
  sensor->frame_codes = size->rows ? int64_t{size->rows} * size->columns : size->channels;
  sensor->frames = frames;
  sensor->places = places;
  sensor->codes.assign(codes, codes + frames * sensor->frame_codes);
  sensor->held.assign(8 * size->converters, 0);
  sensor->bit = bit;
  for (int lane = 0; lane < size->converters; ++lane) sensor->converters.push_back(converter(size->part, busy_clocks));
  auto &top = sensor->core.top;
  top.rx_i = 1;
  top.actuator_moving_i = 0;
  top.in_valid_i = 0;
  top.bus_valid_i = 0;
  top.out_ready_i = 1;
  top.rst_i = 1;
  for (int i = 0; i < 4; ++i) sensor->core.clock();
  top.rst_i = 0;
  return sensor;
}

void sensor_delete(Sensor *sensor) { delete sensor; }

void sensor_write(Sensor *sensor, const uint8_t *data, int64_t count) {
  sensor->to_core.insert(sensor->to_core.end(), data, data + count);
}

// Runs `clocks` clocks, or until `room` bytes came; returns how many came.
int64_t sensor_run(Sensor *sensor, int64_t clocks, uint8_t *out, int64_t room) {
  int64_t count = 0;
  for (; clocks > 0 && count < room; --clocks) {
    sensor->clock();
    count += sensor->receive(out + count);
  }
  return count;
}

int64_t sensor_now(const Sensor *sensor) { return sensor->now; }

int64_t sensor_frames(const Sensor *sensor) { return sensor->converted / sensor->places; }

}  // extern "C"
