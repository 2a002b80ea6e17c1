// SPDX-License-Identifier: Apache-2.0
//
// A serial line, 8N1, for a Verilated core: a bit lasts a number of sixteenths of a clock, as in msn_uart_tx.
#pragma once
#include <cstdint>
#include <deque>

namespace meissner {

// Receives bytes from a line that is given once per clock; each bit is sampled in its middle.
class Receiver {
 public:
  explicit Receiver(int64_t sixteenths) : bit_(sixteenths) {}

  // The level of this clock; true if it completes a byte, which is then in `byte`.
  bool step(bool level) {
    idle_ = idle_ || level;  // until the line has been idle its level means nothing
    if (place_ < 0) {
      if (idle_ && !level) place_ = 0, read_ = 0, left_ = bit_ * 3 / 2;  // the middle of the lowest bit
      return false;
    }
    left_ -= 16;
    if (left_ > 0) return false;
    left_ += bit_;
    if (place_ < 8) {
      read_ |= level << place_++;
      return false;
    }
    place_ = -1;  // in the middle of the stop bit
    byte = static_cast<uint8_t>(read_);
    return true;
  }

  uint8_t byte = 0;

 private:
  int64_t bit_, left_ = 0;
  int place_ = -1, read_ = 0;
  bool idle_ = false;
};

// Levels of the line for back-to-back bytes.
class Sender {
 public:
  explicit Sender(int64_t sixteenths) : bit_(sixteenths) {}

  void send(const uint8_t *data, int64_t count) { bytes_.insert(bytes_.end(), data, data + count); }

  // The level of the next clock.
  bool step() {
    if (gone_ >= 10 * bit_) {
      bytes_.pop_front();
      gone_ -= 10 * bit_;  // the next byte begins a fraction of a clock late
      if (bytes_.empty()) gone_ = 0;
    }
    if (bytes_.empty()) return true;
    const int64_t place = gone_ / bit_;
    gone_ += 16;
    return place == 0 ? false : place == 9 || (bytes_.front() >> (place - 1) & 1);
  }

 private:
  int64_t bit_, gone_ = 0;
  std::deque<uint8_t> bytes_;
};

}  // namespace meissner
