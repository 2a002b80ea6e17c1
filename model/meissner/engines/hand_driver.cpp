// A core with the grip reflex behind a C ABI, in lockstep with a hand: frames of a control cycle in, its command out.
// Samples use the stream, registers the parallel bus; packets are dropped.
#include "Vmsn_core.h"
#include "Vmsn_core___024root.h"
#include "bus.hpp"
#include "driver.hpp"

namespace {

using Core = meissner::Driver<Vmsn_core>;

// The decisions of a cycle: `flags` = over | end << 1 | channel << 2.
struct Decisions {
  uint8_t *flags;
  int64_t room, count = 0;
  const Vmsn_core &top;
  bool word = false, ok = true;

  void look() {
    const uint32_t verdict = top.verdict_o;  // valid, over, last, id: msn_pkg
    if (verdict >> 18 & 1) {
      ok = ok && count < room;
      if (ok) flags[count++] = static_cast<uint8_t>((verdict >> 17 & 1) | (verdict >> 16 & 1) << 1 | (verdict & 7) << 2);
    }
    word = word || top.grip_valid_o;
  }
};

}  // namespace

extern "C" {

Core *hand_new() {
  auto *core = new Core;
  auto &top = core->top;
  top.actuator_moving_i = 0;
  top.bus_valid_i = 0;
  top.rx_i = 1;
  top.in_last_i = 0;
  core->start();
  return core;
}

void hand_delete(Core *core) { delete core; }

int64_t hand_write(Core *core, int32_t address, uint32_t data) { return meissner::access(*core, true, address, data); }

int64_t hand_read(Core *core, int32_t address) { return meissner::access(*core, false, address, 0); }

// Wait for the next word, at most `clocks`; returns the clocks taken, or kFailed.
int64_t hand_wait(Core *core, int64_t clocks) {
  for (int64_t i = 1; i <= clocks; ++i) {
    core->clock();
    if (core->top.grip_valid_o) return i;
  }
  return meissner::kFailed;
}

}  // extern "C"

namespace {

// Send the frames of a cycle, one every `every` clocks, then run to its word. Returns the number of decisions, which
// all came at least four clocks before the word, or kFailed if one was late or a frame was not taken in time.
int64_t one_cycle(Core *core, const int32_t *codes, int64_t frames, int32_t channels, int64_t every, int64_t clocks,
                  uint8_t *flags, int64_t room, int32_t *word) {
  auto &top = core->top;
  Decisions decisions{flags, room, 0, top};
  for (int64_t frame = 0; frame < frames; ++frame) {
    int64_t left = every;
    for (int32_t channel = 0; channel < channels; ++channel) {
      top.in_valid_i = 1;
      top.in_data_i = meissner::low_bits(*codes++, 17);
      top.in_id_i = channel;
      top.in_last_i = channel == channels - 1;
      bool taken;
      do {
        taken = top.in_ready_o;
        core->clock(decisions);
      } while (!taken && --left > 0);
      --left;
    }
    top.in_valid_i = 0;
    if (left < 0) return meissner::kFailed;
    for (; left > 0; --left) core->clock(decisions);
  }
  if (decisions.word) return meissner::kFailed;
  const int64_t count = decisions.count;
  int64_t since = 0;
  while (!decisions.word && since++ < clocks) core->clock(decisions);
  if (!decisions.word || !decisions.ok || decisions.count != count || since < 5) return meissner::kFailed;
  const uint32_t raw = top.grip_word_o;
  *word = static_cast<int32_t>(raw << 15) >> 15;
  return count;
}

}  // namespace

extern "C" {

// The first of `cycles` cycles with these `codes`: until a word is not the `expected` one.
// `answers`, of each cycle: the word, then the registers at four `addresses`. `decisions`: their number, in `flags`.
// Returns the number of cycles, or kFailed.
int64_t hand_next(Core *core, const int32_t *codes, int64_t cycles, int64_t frames, int32_t channels, int64_t every,
                  int64_t clocks, const int32_t *addresses, const int64_t *expected, uint8_t *flags, int64_t room,
                  int64_t *decisions, int64_t *answers) {
  *decisions = 0;
  for (int64_t cycle = 0; cycle < cycles; ++cycle, codes += frames * channels) {
    int32_t word = 0;
    const int64_t count = one_cycle(core, codes, frames, channels, every, clocks, flags + *decisions,
                                    room - *decisions, &word);
    if (count < 0) return meissner::kFailed;
    *decisions += count;
    *answers++ = word;
    for (int i = 0; i < 4; ++i) {
      *answers = meissner::access(*core, false, addresses[i], 0);
      if (*answers++ < 0) return meissner::kFailed;
    }
    if (word != expected[cycle]) return cycle + 1;
  }
  return cycles;
}

}  // extern "C"
