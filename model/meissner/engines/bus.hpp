// The parallel bus of a Verilated core (Uart = 0).
#pragma once
#include <cstdint>

#include "driver.hpp"

namespace meissner {

// Ask for an access: bus_valid_i is to be high for one clock.
template <typename Top>
void ask(Top &top, bool write, int32_t address, uint32_t data) {
  top.bus_valid_i = 1;
  top.bus_write_i = write;
  top.bus_address_i = address;
  top.bus_wdata_i = data;
  top.bus_strobe_i = 15;
}

// One access: the word read, 0 for a write; kFailed for an error or no answer.
template <typename Top>
int64_t access(Driver<Top> &core, bool write, int32_t address, uint32_t data) {
  auto &top = core.top;
  ask(top, write, address, data);
  for (int i = 0; i < 8; ++i) {
    core.clock();
    top.bus_valid_i = 0;
    if (top.bus_done_o) return top.bus_error_o ? kFailed : top.bus_rdata_o;
  }
  return kFailed;
}

}  // namespace meissner
