// The serial link under full load: images all the time, CoP frames often, slip events in bursts; every event must
// appear on the line, in order, through the portable decoder.
#include <cstdint>
#include <deque>
#include <random>

#include "../../host/msn_packet.c"
#include "Vmsn_link.h"
#include "Vmsn_link___024root.h"
#include "driver.hpp"
#include "serial.hpp"

namespace {

struct Event {
  uint16_t channel;
  uint32_t p2p;
  uint8_t state;
  uint64_t time;
};

}  // namespace

extern "C" {

struct Soak {
  int64_t events, lost, wrong, images, cops, clocks, held;
};

// Run until `events` events were received or lost. `sixteenths`: sixteenths of a clock in a bit; `mean`: average
// number of clocks between two events; `burst`: largest number of events in a burst.
void soak_run(int64_t events, int64_t sixteenths, int32_t mean, int32_t burst, int32_t taxels, uint32_t seed, Soak *out) {
  meissner::Driver<Vmsn_link> core;
  auto &top = core.top;
  std::mt19937 draw(seed);
  std::deque<Event> offered, sent;
  top.rx_i = 1;
  top.cfg_i = 0b0'11111'0;  // msn_registers_pkg::link_cfg_t: images, events of every state, states
  core.reset();
  *out = {};
  msn_decoder decoder{};
  meissner::Receiver line(sixteenths);
  int64_t next = 0, made = 0, taxel = 0, quiet = 0;
  for (int64_t now = 0; out->events + out->lost < events && quiet < 10'000'000; ++now, ++quiet) {
    out->clocks = now;
    if (now >= next && made < events) {
      const int count = 1 + static_cast<int>(draw() % burst);
      for (int i = 0; i < count && made < events; ++i, ++made) {
        const auto state = static_cast<uint8_t>(2 + draw() % 2);
        offered.push_back({static_cast<uint16_t>(draw()), draw() & 0xffffff, state, static_cast<uint64_t>(made)});
      }
      next = now + static_cast<int64_t>(count) * mean / 2 + draw() % (static_cast<uint32_t>(count) * mean);
    }
    top.decision_valid_i = !offered.empty();
    if (!offered.empty()) {
      const Event &event = offered.front();
      // msn_pkg::decision_t: raised, last, state, p2p, id.
      const uint64_t state = uint64_t{0b10} << 3 | event.state;
      top.decision_i = state << 40 | static_cast<uint64_t>(event.p2p) << 16 | event.channel;
      top.time_i = event.time;
    }
    top.cop_valid_i = draw() % 1000 == 0;
    top.cop_i[0] = draw();
    top.image_valid_i = 1;
    top.image_data_i = static_cast<uint16_t>(taxel * 40503);
    top.image_last_i = taxel == taxels - 1;
    top.eval();
    const bool accepted = top.decision_valid_i && top.decision_ready_o;
    out->held += top.decision_valid_i && !top.decision_ready_o;
    if (accepted) {
      sent.push_back(offered.front());
      offered.pop_front();
    }
    taxel = taxel == taxels - 1 ? 0 : taxel + 1;
    core.clock();
    if (!line.step(top.tx_o)) continue;
    msn_packet packet;
    if (!msn_decode(&decoder, line.byte, &packet)) continue;
    quiet = 0;
    if (packet.type == MSN_IMAGE) ++out->images;
    if (packet.type == MSN_COP) ++out->cops;
    if (packet.type != MSN_SLIP) continue;
    // Events before it in the queue are lost.
    while (!sent.empty() && sent.front().time != packet.time) {
      sent.pop_front();
      ++out->lost;
    }
    if (sent.empty()) {
      ++out->wrong;
      continue;
    }
    const Event &event = sent.front();
    out->wrong += event.channel != packet.is.slip.channel || event.p2p != packet.is.slip.p2p ||
                  event.state != packet.is.slip.state;
    ++out->events;
    sent.pop_front();
  }
  out->lost += static_cast<int64_t>(sent.size());
}

}  // extern "C"
