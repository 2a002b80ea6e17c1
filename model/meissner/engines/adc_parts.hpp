// SPDX-License-Identifier: Apache-2.0
//
// The converters at pin level for the batch driver: the right bits at the right edges, without timing checks (those
// are in tb/parts). Call step() once per clock with the pins that the master drives; the master samples `miso` and
// `busy` at its next clock.
//
// codes: the raw codes of channels 0 .. 7 in this clock; bits above the part's width are ignored. With one lane
// wired, mask `miso` to its lowest bit: a Verilated port does not truncate its value.

#pragma once

#include <cstdint>
#include <memory>

namespace meissner {

// Microchip MCP3208: CLK idles low; it takes start, single-ended and three channel bits on rising edges, and sends a
// null bit and twelve code bits on falling ones.
struct Mcp3208 {
  bool miso = false;
  bool busy = false;

  void step(bool cs_n, bool sclk, bool mosi, bool /*convst*/, const int32_t *codes) {
    if (cs_n) {
      command_bits = falls = command = 0;
    } else if (sclk && !sclk_before) {
      if (command_bits < 5 && (command_bits || mosi)) {
        command = command << 1 | (mosi ? 1 : 0);
        ++command_bits;
      }
    } else if (!sclk && sclk_before && command_bits) {
      ++falls;
      if (falls == 6) {  // the sample ends here
        value = codes[command & 7] & 0xfff;
        miso = false;
      } else if (falls > 6) {
        miso = falls <= 18 && (value >> (18 - falls) & 1);
      }
    }
    sclk_before = sclk;
  }

 private:
  int command_bits = 0;
  int command = 0;
  int falls = 0;
  int value = 0;
  bool sclk_before = false;
};

// Analog Devices AD7606, serial: SCLK idles high; CS falling and every rising SCLK output the next bit, V1 first on
// DOUTA (bit 0 of miso), V5 first on DOUTB (bit 1). BUSY lasts busy_clocks from the clock in which CONVST rises.
struct Ad7606 {
  uint8_t miso = 0;
  bool busy = false;
  int busy_clocks = 100;

  explicit Ad7606(int clocks = 100) : busy_clocks(clocks) {}

  void step(bool cs_n, bool sclk, bool /*mosi*/, bool convst, const int32_t *codes) {
    if (busy && --left == 0) {
      busy = false;
      for (int channel = 0; channel < 8; ++channel) results[channel] = sampled[channel];
    }
    if (convst && !convst_before && !busy) {
      for (int channel = 0; channel < 8; ++channel) sampled[channel] = codes[channel];
      busy = true;
      left = busy_clocks;
    }
    if (!cs_n && cs_before) {
      bit = 0;
      show();
    } else if (!cs_n && sclk && !sclk_before) {
      ++bit;
      show();
    }
    cs_before = cs_n;
    sclk_before = sclk;
    convst_before = convst;
  }

 protected:
  int32_t results[8] = {};
  bool cs_before = true;
  bool sclk_before = true;

 private:
  void show() {
    const int channel = bit / 16;
    const int place = 15 - bit % 16;
    const int a = channel < 8 ? results[channel] >> place & 1 : 0;
    const int b = channel < 8 ? results[(channel + 4) % 8] >> place & 1 : 0;
    miso = static_cast<uint8_t>(a | b << 1);
  }

  int32_t sampled[8] = {};
  int left = 0;
  int bit = 0;
  bool convst_before = false;
};

// Analog Devices AD7606C-16, software mode: a CS frame for each word, on as many lanes as register 2 says. SDI is taken on
// falling SCLK. A word that reads a register (bit 14) leaves the conversions; then each word writes one, and 0 ends this.
struct Ad7606c : Ad7606 {
  explicit Ad7606c(int clocks = 10) : Ad7606(clocks) {}

  void step(bool cs_n, bool sclk, bool mosi, bool convst, const int32_t *codes) {
    const bool was_busy = busy, begins = !cs_n && cs_before, falls = !cs_n && !sclk && sclk_before;
    const bool rises = !cs_n && sclk && !sclk_before, ends = cs_n && !cs_before;
    Ad7606::step(cs_n, sclk, mosi, convst, codes);
    if (was_busy && !busy) word = 0;
    if (begins) received = bits = 0;
    if (falls) received = received << 1 | (mosi ? 1 : 0), ++bits;
    if (ends && bits == 16) {
      if (!writes) {
        ++word;
        writes = received >> 14 == 1;
      } else {
        if (received >> 8 == 2) lanes = 1 << (received >> 3 & 3);
        writes = received != 0;
      }
    }
    if (!begins && !rises) return;
    miso = 0;
    for (int lane = 0; lane < lanes && word < 8 / lanes && !writes; ++lane) {
      const int value = results[word + 8 / lanes * lane];
      miso = static_cast<uint8_t>(miso | (value >> (15 - bits) & 1) << lane);
    }
  }

 private:
  int lanes = 2;
  int word = 0;
  int received = 0;
  int bits = 0;
  bool writes = false;
};

// Maxim MAX11123, MAX11124, MAX11125, MAX11131, manual scan: CLK idles high; command bits are taken on rising edges, answer bits
// sent on falling ones. CS falling samples the channel that the previous word requested; this word carries its answer.
template <int Bits>
struct Max1112x {
  bool miso = false;
  bool busy = false;

  void step(bool cs_n, bool sclk, bool mosi, bool /*convst*/, const int32_t *codes) {
    if (!cs_n && cs_before) {
      received = bits = 0;
      answer = channel << 12 | (codes[channel & 7] & ((1 << Bits) - 1)) << (12 - Bits);
    } else if (!cs_n && !sclk && sclk_before) {
      miso = answer >> 15 & 1;
      answer = answer << 1 & 0xffff;
    } else if (!cs_n && sclk && !sclk_before) {
      received = received << 1 | (mosi ? 1 : 0);
      if (++bits == 16 && received >> 11 == 1) channel = received >> 7 & 15;
    }
    cs_before = cs_n;
    sclk_before = sclk;
  }

 private:
  int channel = 15;
  int answer = 0;
  int received = 0;
  int bits = 0;
  bool cs_before = true;
  bool sclk_before = true;
};
using Max11123 = Max1112x<8>;
using Max11124 = Max1112x<10>;
using Max11125 = Max1112x<12>;
using Max11131 = Max11125;

// Common interface of these converters.
struct Converter {
  uint8_t miso = 0;
  bool busy = false;
  virtual ~Converter() = default;
  virtual void step(bool cs_n, bool sclk, bool mosi, bool convst, const int32_t *codes) = 0;
};

template <typename Part>
struct ConverterOf final : Converter {
  Part part;
  explicit ConverterOf(Part given = {}) : part(given) {}
  void step(bool cs_n, bool sclk, bool mosi, bool convst, const int32_t *codes) override {
    part.step(cs_n, sclk, mosi, convst, codes);
    miso = part.miso;
    busy = part.busy;
  }
};

// The converter with this msn_pkg::adc_part_e; one with BUSY is busy for `busy_clocks`.
inline std::unique_ptr<Converter> converter(int32_t number, int busy_clocks) {
  switch (number) {
    case 1: return std::make_unique<ConverterOf<Mcp3208>>();
    case 2: return std::make_unique<ConverterOf<Ad7606>>(Ad7606{busy_clocks});
    case 3: return std::make_unique<ConverterOf<Max11123>>();
    case 4: return std::make_unique<ConverterOf<Max11124>>();
    case 5: return std::make_unique<ConverterOf<Max11125>>();
    case 6: return std::make_unique<ConverterOf<Ad7606c>>(Ad7606c{busy_clocks});
    case 7: return std::make_unique<ConverterOf<Max11131>>();
    default: return nullptr;
  }
}

}  // namespace meissner
