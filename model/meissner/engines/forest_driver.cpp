// Batch driver of the Verilated msn_forest: a forest in, then rows of features in, votes of all classes out.
#include "Vmsn_forest.h"
#include "Vmsn_forest___024root.h"
#include "driver.hpp"

extern "C" {

// One write of a load.
struct ForestLoad {
  uint32_t kind, engine, address;
  uint64_t data;
};

// Loads `loads`, swaps, and sends `count` rows of `features` values of `bits` bits. votes [count][classes]; index and
// error [count]; `steps`: nodes compared from the first beat of a row on. `timeout`: clocks that a decision may take.
// `alone` [count], if given: a row is sent when the one before has its result, and this is the clocks of each. The clocks from the last `trace_rows` rows on go to `trace_path`, if given and if the core was built for it. Returns
// the clocks from the first beat on, or -1 unless there was exactly one result per row.
int64_t forest_run(const ForestLoad *loads, int64_t load_count, const int32_t *rows, int64_t count, int64_t features,
                   int64_t classes, uint32_t bits, int64_t timeout, uint32_t *votes, int32_t *index, uint8_t *error,
                   int64_t *steps, int64_t *alone, const char *trace_path, int64_t trace_rows, int64_t clk_khz) {
  meissner::Driver<Vmsn_forest> driver;
  auto &top = driver.top;
  top.swap_i = 0;
  top.load_valid_i = 0;
  driver.start();
  top.load_valid_i = 1;
  for (int64_t k = 0; k < load_count; k++) {
    top.load_kind_i = loads[k].kind;
    top.load_engine_i = loads[k].engine;
    top.load_address_i = loads[k].address;
    top.load_data_i = loads[k].data;
    if (!top.load_ready_o) return meissner::kFailed;  // two banks, and no swap is due
    driver.clock();
  }
  top.load_valid_i = 0;
  top.swap_i = 1;
  driver.clock();
  top.swap_i = 0;
  while (top.swapping_o) driver.clock();

  auto results = driver.results(count * classes, [&](int64_t k) {
    votes[k] = top.out_votes_o;
    index[k / classes] = top.out_class_o;
    error[k / classes] = top.out_error_o;
  });
  int64_t compared = 0;
  struct Steps {
    Vmsn_forest &top;
    int64_t &compared;
    void look() { compared += __builtin_popcountll(top.step_o); }
  } nodes{top, compared};
  const int64_t begun = driver.clocks;
  int64_t row = 0;
  const auto put = [&](int64_t k) {
    top.in_data_i = meissner::low_bits(rows[row * features + k], static_cast<int>(bits));
    top.in_last_i = k % features == features - 1;
  };
  const int64_t together = alone ? 1 : count;
  for (; row < count; row += together) {
    const int64_t sent = driver.clocks, last = count - row;
    const bool traced = !alone || last == trace_rows;
    const meissner::Trace trace{traced ? trace_path : nullptr, std::min(together, trace_rows) * features, clk_khz};
    if (!driver.send(together * features, static_cast<int>(timeout), trace, put, results, nodes)) return meissner::kFailed;
    const int64_t due = (row + together) * classes;
    for (int64_t left = timeout; left > 0 && results.ok && results.count < due; left--) driver.clock(results, nodes);
    if (alone) alone[row] = driver.clocks - sent;
  }
  *steps = compared;
  return results.complete() ? driver.clocks - begun : meissner::kFailed;
}

}  // extern "C"
