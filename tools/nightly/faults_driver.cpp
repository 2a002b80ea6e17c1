// Injects faults into a Verilated block inside a wrapper: one run of a recording without a fault, then one run per
// fault, compared with it. It knows a block only by its port names and by Verilator's list of variables.
//
//   faults RECORDING FAULTS SEED SETTLE [KEY=VALUE ...]    prints a line for each fault: kind, where, clock, outcome, what
//
//   frame=PORT[:VALUE]  for a block without streams: a frame begins where this input is 1, or has this value
//   when=PORT    only while this input is 1, too
//   idle=PORT:N  for a block that receives a line: a frame begins after N rows in which this input is 1
//   join=1       use all pieces of the recording in sequence, if the longest one has too few frames
//   repeat=N     use the recording N times, if it has too few frames
//   slow=N       add N rows without anything valid after each row
//   end=VALUE    for an output stream without `last`: the value that ends a frame
//   packets=1    the output stream carries packets: compare what a receiver decodes, without numbers and times; packets
//                with a wrong checksum are left out, and they and missing numbers are reported
//   bus=1        answer a bus that leaves the block two clocks after a request, with data derived from the address
//   inputs=NAMES inputs that their names do not identify as inputs
//   write=A:D,.. for a free-running block with a bus: registers (hexadecimal) that are written at a given clock;
//                before=A:D,.. those written long before. Each frame must use either the old or the new values
//   strobe=PORT  the other outputs count only while this one is 1
//   error=PORT   in an output stream: a beat in which it is not 0 says itself that it may be wrong
//   only=NAME    upset only state bits whose names contain this
//   phases=N     windows of up to N frames, which after a fault may begin at another frame
//   kept=NAMES   state that is written and then kept by design: an upset of it stays until it is written again
//   late=NAMES   in a free-running block: state that counts the clocks to its next frame
//   skip=KIND    no faults of this kind
//   free=CLOCKS  the block runs by itself, each input at its most frequent value in the recording; with part=N (of
//                msn_pkg::adc_part_e), lanes=N a converter at its pins, whose codes depend on row, group and channel.
//                Frames may then shift in time: each must be a frame of the run without a fault
//   carrier=N    the codes are those of a carrier; a quarter period lasts N words
//   lead=ROWS    for a free-running block: first play this many rows of the recording, which write tables
//   set=PORT:VALUE,..  hexadecimal values that replace those of the recording at these inputs; for a struct
//                      PORT[HIGH:LOW]:VALUE, for which a test writes GROUP.SETTING:VALUE
//   quiet=NAMES  output streams that may have only a few frames
//   ready=NAMES  output streams that are never stalled at random, since a stall would move data to another frame
//
// An input stream is NAME_valid_i with NAME_ready_o, an output stream NAME_valid_o with NAME_ready_i. A beat is offered
// until the block takes it, so the recording waits for the block; output streams are stalled at random.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "verilated.h"
#include "verilated_sym_props.h"
#include "verilated_syms.h"

#include "adc_parts.hpp"  // of model/meissner/engines

// The block in its wrapper (see faults.py), declared so that this file is compiled only once for all blocks.
struct Block;
Block *block_new(VerilatedContext *context);
void block_delete(Block *block);
void block_eval(Block *block);
uint8_t &block_clock(Block *block);

namespace {

using Words = std::vector<uint32_t>;

struct Port {
  std::string name;
  int bits = 1;
  bool in = false;
};

std::map<std::string, std::string> options;
long option(const std::string &key, long otherwise) {
  const auto found = options.find(key);
  return found == options.end() ? otherwise : std::atol(found->second.c_str());
}

std::vector<Port> ports;
std::vector<Words> rows;  // each has the values of all ports in sequence
std::vector<int> offset;  // of each port in a row
std::map<std::string, int> number;

// A bit of a variable, which may be state.
struct Cell {
  std::string name;
  uint8_t *byte;
  uint8_t mask;
  int variable;
  bool memory;
};

struct Model {
  VerilatedContext context;
  Block *top;
  std::vector<uint8_t *> data;  // of the ports

  Model() {
    Verilated::threadContextp(&context);
    context.randReset(1);
    top = block_new(&context);
    block_clock(top) = 0;
    block_eval(top);
    const VerilatedScope *scope = context.scopeFind("TOP.TOP");
    if (!scope) std::cerr << "no scope of the top\n", std::exit(2);
    for (const auto &port : ports) {
      const auto found = scope->varsp()->find(port.name.c_str());
      if (found == scope->varsp()->end()) std::cerr << "no port " << port.name << "\n", std::exit(2);
      data.push_back(static_cast<uint8_t *>(found->second.datap()));
    }
  }
  ~Model() {
    Verilated::threadContextp(&context);  // the scopes' destructors use the current thread's context
    block_delete(top);
  }

  uint32_t word(int port, int index) const {
    uint32_t value = 0;
    const int bits = std::min(32, ports[port].bits - 32 * index);
    std::memcpy(&value, data[port] + 4 * index, bits > 16 || ports[port].bits > 32 ? 4 : bits > 8 ? 2 : 1);
    return bits < 32 ? value & ((1u << bits) - 1) : value;
  }
  bool bit(int port) const { return port >= 0 && (data[port][0] & 1); }
  void set(int port, const uint32_t *words) {
    const int bits = ports[port].bits;
    if (bits <= 8) data[port][0] = static_cast<uint8_t>(words[0]);
    else if (bits <= 16) std::memcpy(data[port], words, 2);
    else std::memcpy(data[port], words, 4 * ((bits + 31) / 32));
  }
  void set(int port, bool level) { data[port][0] = level; }

  std::vector<Cell> cells() {
    std::vector<Cell> all;
    int variable = 0;
    for (const auto &[path, scope] : *context.scopeNameMap()) {
      const std::string where = path;
      if (where.rfind("TOP.faults_top.u_block", 0) != 0 || !scope->varsp()) continue;
      for (auto &[key, var] : *scope->varsp()) {
        const std::string name = key;
        if (var.isParam() || name == "clk_i" || name == "rst_i") continue;
        const int width = var.entBits();
        const size_t stride = var.entSize();
        size_t entries = 1;
        for (int d = 0; d < var.udims(); ++d) entries *= var.elements(d + 1);
        const std::string shown = where.size() > 23 ? where.substr(23) + "." + name : name;
        for (size_t e = 0; e < entries; ++e) {
          for (int b = 0; b < width; ++b) {
            const std::string label = shown + (entries > 1 ? "[" + std::to_string(e) + "]" : "") +
                                      (width > 1 ? "." + std::to_string(b) : "");
            all.push_back({label, static_cast<uint8_t *>(var.datap()) + e * stride + b / 8,
                           static_cast<uint8_t>(1 << b % 8), variable, entries > 1});
          }
        }
        ++variable;
      }
    }
    return all;
  }

  void low() {
    block_clock(top) = 0;
    block_eval(top);
  }
  void high() {
    block_clock(top) = 1;
    block_eval(top);
    context.timeInc(1);
  }
};

struct Stream {
  std::string name;
  int valid = -1, ready = -1, last = -1;
  int restart = -1;  // a flag: the data do not continue the earlier ones
  std::vector<int> payload;
};
std::vector<Stream> sources, sinks;
std::vector<int> levels, flags;  // outputs outside streams; the flags report damage
int reset_port = -1;
int strobe = -1;

bool ends(const std::string &text, const std::string &end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

bool tells(const std::string &name) {
  for (const char *word : {"damaged", "dropped", "overrun", "timeout", "mistagged", "lost", "broken", "spoiled", "refused",
                           "swallowed", "over_range", "held_", "blanked", "error", "fault", "restart", "missed", "rejected"})
    if (name.find(word) != std::string::npos) return true;
  return false;
}

// The names that an option lists.
std::vector<std::string> names(const std::string &key) {
  std::vector<std::string> found;
  std::istringstream text(options[key]);
  for (std::string name; std::getline(text, name, ',');) found.push_back(name);
  return found;
}
// Whether the text contains one of the parts; "A&B" needs both A and B.
bool holds(const std::string &text, const std::vector<std::string> &parts) {
  for (const auto &part : parts) {
    bool all = true;
    std::istringstream both(part);
    for (std::string one; std::getline(both, one, '&');) all &= text.find(one) != std::string::npos;
    if (all) return true;
  }
  return false;
}

int find(const std::string &name) {
  const auto found = number.find(name);
  return found == number.end() ? -1 : found->second;
}

void sort_ports() {
  std::vector<bool> used(ports.size());
  for (const auto &port : ports) {
    if (ends(port.name, "valid")) {  // AXI
      const std::string stem = port.name.substr(0, port.name.size() - 5);
      Stream stream{stem, find(port.name), find(stem + "ready"), -1, -1, {}};
      used[stream.valid] = used[stream.ready] = true;
      for (const auto &other : ports) {
        const int n = find(other.name);
        if (other.name.rfind(stem, 0) != 0 || n == stream.valid || n == stream.ready) continue;
        stream.payload.push_back(n);
        used[n] = true;
      }
      (port.in ? sources : sinks).push_back(stream);
      continue;
    }
    for (const bool in : {true, false}) {
      const std::string valid = in ? "valid_i" : "valid_o", ready = in ? "ready_o" : "ready_i", side = in ? "_i" : "_o";
      if (!ends(port.name, valid)) continue;
      const std::string stem = port.name.substr(0, port.name.size() - 7);
      if (find(stem + ready) < 0) continue;
      Stream stream{stem, find(port.name), find(stem + ready), find(stem + "last" + side), -1, {}};
      used[stream.valid] = used[stream.ready] = true;
      for (const auto &other : ports) {
        const int n = find(other.name);
        if (!in && (other.name == stem + "frame_o" || other.name == stem + "time_o")) {
          used[n] = true;  // frame numbers and times, not samples
          continue;
        }
        if (!in && other.name == stem + "restart_o") {
          used[n] = true;
          stream.restart = n;
          continue;
        }
        if (!in && other.bits == 32 && tells(other.name)) continue;  // a counter with the stream's name
        if (!in && options.count("packets") && other.name != stem + "data_o") continue;  // only the bytes
        if (other.in == in && n != stream.valid && stem.size() > 1 && other.name.rfind(stem, 0) == 0) {
          stream.payload.push_back(n);
          used[n] = true;
        }
      }
      (in ? sources : sinks).push_back(stream);
    }
  }
  reset_port = find("rst_i");
  for (size_t n = 0; n < ports.size(); ++n) {
    if (ports[n].in || used[n]) continue;
    (tells(ports[n].name) ? flags : levels).push_back(static_cast<int>(n));
  }
}

void read(const char *path) {
  std::ifstream file(path);
  std::string line;
  int words = 0;
  while (std::getline(file, line) && !line.empty()) {
    std::istringstream text(line);
    Port port;
    text >> port.name >> port.bits;
    port.in = ends(port.name, "_i") || ("," + options["inputs"] + ",").find("," + port.name + ",") != std::string::npos;
    number[port.name] = static_cast<int>(ports.size());
    offset.push_back(words);
    words += (port.bits + 31) / 32;
    ports.push_back(port);
  }
  sort_ports();
  std::vector<std::vector<Words>> parts;
  while (std::getline(file, line)) {
    if (line == "=") {
      parts.emplace_back();
      continue;
    }
    std::istringstream text(line);
    Words row(words);
    std::string value;
    for (size_t n = 0; n < ports.size(); ++n) {
      text >> value;
      for (size_t at = 0; at < static_cast<size_t>((ports[n].bits + 31) / 32); ++at) {
        if (value.size() <= 8 * at) break;
        const size_t end = value.size() - 8 * at, begin = end > 8 ? end - 8 : 0;
        row[offset[n] + at] = static_cast<uint32_t>(std::stoul(value.substr(begin, end - begin), nullptr, 16));
      }
    }
    // Each reset begins a new piece.
    if (reset_port >= 0 && row[offset[reset_port]] && !parts.back().empty() &&
        !parts.back().back()[offset[reset_port]])
      parts.emplace_back();
    parts.back().push_back(row);
  }
  // Choose the piece with the most activity: beats taken, or inputs that change.
  size_t best = 0, most = 0;
  for (size_t p = 0; p < parts.size(); ++p) {
    size_t score = 0;
    for (size_t r = 1; r < parts[p].size(); ++r) {
      if (sources.empty() || options.count("free")) {
        score += parts[p][r] != parts[p][r - 1];
      } else {
        for (const auto &s : sources) score += parts[p][r][offset[s.valid]] & parts[p][r][offset[s.ready]];
      }
    }
    // Prefer a piece in which no flag reports an error.
    bool quiet = true;
    for (const int flag : flags)
      for (int w = 0; w < (ports[flag].bits + 31) / 32; ++w)
        quiet &= !parts[p].empty() && parts[p].back()[offset[flag] + w] == parts[p].front()[offset[flag] + w];
    if (quiet) score *= 100;
    if (score > most) best = p, most = score;
  }
  if (parts.empty()) std::cerr << "an empty recording\n", std::exit(2);
  if (options.count("free")) {
    Words usual(words);
    for (size_t n = 0; n < ports.size(); ++n) {
      std::map<Words, size_t> seen;
      for (const auto &row : parts[best])
        ++seen[Words(row.begin() + offset[n], row.begin() + offset[n] + (ports[n].bits + 31) / 32)];
      const auto most_often = std::max_element(seen.begin(), seen.end(), [](auto &a, auto &b) { return a.second < b.second; });
      std::copy(most_often->first.begin(), most_often->first.end(), usual.begin() + offset[n]);
    }
    if (reset_port >= 0) usual[offset[reset_port]] = 0;
    for (const auto &s : sources) usual[offset[s.valid]] = 0;
    for (const auto &row : parts[best]) {
      if (static_cast<long>(rows.size()) >= option("lead", 0)) break;
      if (reset_port < 0 || !row[offset[reset_port]]) rows.push_back(row);
    }
    rows.resize(option("free", 1), usual);
    for (const auto &one : names("set")) {
      const size_t colon = one.rfind(':'), bracket = std::min(one.find('['), colon);
      const auto value = static_cast<uint32_t>(std::stoul(one.substr(colon + 1), nullptr, 16));
      const size_t port = find(one.substr(0, bracket));
      if (bracket == colon) {
        for (auto &row : rows) row[offset[port]] = value;
        continue;
      }
      const size_t high = std::stoul(one.substr(bracket + 1));
      const size_t low = std::stoul(one.substr(one.find(':', bracket) + 1));
      for (auto &row : rows)
        for (size_t bit = low; bit <= high; ++bit) {
          auto &word = row[offset[port] + bit / 32];
          word = (word & ~(1u << bit % 32)) | (value >> (bit - low) & 1) << bit % 32;
        }
    }
    return;
  }
  // A short piece is continued with the other ones, each with its reset.
  for (size_t p = 0; (parts[best].size() < 400 || options.count("join")) && p < parts.size(); ++p)
    if (p != best) parts[best].insert(parts[best].end(), parts[p].begin(), parts[p].end());
  size_t longest = static_cast<size_t>(option("rows", 3000));
  if (const char *given = std::getenv("FAULTS_ROWS")) longest = std::strtoul(given, nullptr, 10);
  for (auto &row : parts[best]) {
    bool offered = false, taken = false;
    for (const auto &s : sources) {
      const bool valid = row[offset[s.valid]], ready = row[offset[s.ready]];
      offered |= valid;
      taken |= valid && ready;
      if (valid && !ready) row[offset[s.valid]] = 0;  // the beat is repeated in the row that takes it
    }
    bool other = rows.empty();
    if (!other) {
      for (size_t n = 0; n < ports.size(); ++n) {
        bool streamed = !ports[n].in;
        for (const auto &s : sources)
          streamed |= static_cast<int>(n) == s.valid ||
                      std::find(s.payload.begin(), s.payload.end(), static_cast<int>(n)) != s.payload.end();
        for (const auto &s : sinks) streamed |= static_cast<int>(n) == s.ready;
        if (!streamed && rows.back()[offset[n]] != row[offset[n]]) other = true;
      }
    }
    if (offered && !taken && !other) continue;  // only a stall, which the block itself reproduces
    rows.push_back(row);
    if (rows.size() >= longest) break;
  }
  if (options.count("slow")) {
    const auto fast = rows;
    rows.clear();
    for (auto row : fast) {
      rows.push_back(row);
      for (const auto &port : ports)
        if (port.in && ends(port.name, "valid_i")) row[offset[find(port.name)]] = 0;
      rows.insert(rows.end(), option("slow", 0), row);
    }
  }
  const auto once = rows;
  for (long n = 1; n < option("repeat", 1); ++n) rows.insert(rows.end(), once.begin(), once.end());
}

uint32_t chance(uint64_t x) {  // a good enough hash
  x ^= x >> 33, x *= 0xff51afd7ed558ccdull, x ^= x >> 33, x *= 0xc4ceb9fe1a85ec53ull, x ^= x >> 33;
  return static_cast<uint32_t>(x);
}

struct Pins {
  std::vector<std::unique_ptr<meissner::Converter>> converters;  // of each lane
  int cs = find("adc_cs_n_o"), sclk = find("adc_sclk_o"), mosi = find("adc_mosi_o"), miso = find("adc_miso_i");
  int convst = find("adc_convst_o"), busy = find("adc_busy_i"), row = find("row_o"), group = find("group_o");
  long part = option("part", 0), lanes = option("lanes", 1), carrier = option("carrier", 0);
  uint64_t row_now = 0, place_before = 0;
  long words = 0;  // since the place changed
  bool selected = false;

  Pins() {
    const int busy_clocks = part == 6 ? 10 : 60;
    for (int lane = 0; part && cs >= 0 && lane < ports[cs].bits; ++lane)
      converters.push_back(meissner::converter(static_cast<int32_t>(part), busy_clocks));
  }
  static bool at(const Model &model, int port, size_t bit) { return port >= 0 && model.word(port, bit / 32) >> bit % 32 & 1; }

  // Advance the converters by one clock and drive their pins. Faults: BUSY held, noisy data line, over-range codes.
  void step(Model &model, bool hold, bool noise, bool over, long clock) {
    if (row >= 0 && model.word(row, 0)) row_now = model.word(row, 0);
    const uint64_t place = row_now * 64 + (group >= 0 ? model.word(group, 0) : 0);
    const bool selects = !at(model, cs, 0);
    if (place != place_before) words = 0;
    words += selects && !selected;
    place_before = place, selected = selects;
    uint32_t data = 0, held = 0;
    for (size_t lane = 0; lane < converters.size(); ++lane) {
      int32_t codes[8];
      // Codes away from the ends of the range, since those count as over-range.
      for (int c = 0; c < 8; ++c) codes[c] = over ? 0xffff : 0x20 + static_cast<int32_t>(chance(place * 1000 + lane * 8 + c) % 0x90);
      if (carrier) {
        const int quarter = static_cast<int>(words / carrier % 4);
        for (auto &code : codes) code = over ? code : 0x800 + 8 * code * (quarter == 0) - 8 * code * (quarter == 2);
      }
      converters[lane]->step(at(model, cs, lane), at(model, sclk, lane), at(model, mosi, lane), at(model, convst, lane),
                            codes);
      uint32_t bits = converters[lane]->miso & ((1u << lanes) - 1);
      if (noise) bits = chance(clock * 131 + lane) & ((1u << lanes) - 1);
      data |= bits << lane * lanes;
      held |= static_cast<uint32_t>(converters[lane]->busy || hold) << lane;
    }
    if (miso >= 0) model.set(miso, &data);
    if (busy >= 0) model.set(busy, &held);
  }
};

enum Kind { kNone, kBit, kLost, kTwice, kLate, kLast, kGone, kStuck, kStop, kReset, kBusy, kNoise, kOver, kWrite };
const char *kinds[] = {"none", "bit", "lost", "twice", "late", "last", "gone", "stuck", "stop", "reset", "busy", "noise",
                       "over", "write"};
constexpr long kStopped = 2500;  // clocks for which a data source stops
// Clocks that a fault lasts.
long lasts(Kind kind) {
  return kind == kStuck ? 300 : kind == kStop ? kStopped : kind == kBusy || kind == kNoise || kind == kOver ? 900 : 1;
}

struct Fault {
  Kind kind = kNone;
  long clock = 0;   // of an upset or a reset
  size_t row = 0;   // of a beat
  size_t count = 1;  // of rows whose beats are removed
  int source = 0;
  size_t cell = 0;
};

struct Beat {
  size_t row;
  long clock;
  bool last;
  Words words;
};
struct Trace {
  std::vector<std::vector<Beat>> out;           // per sink
  std::vector<std::pair<size_t, Words>> level;  // per row, if there is no sink
  Words flag;                                   // each flag's last value, and the clocks in which it was 1 or the changes of a counter
  std::vector<size_t> row_of_clock;
  std::vector<size_t> restarts;                 // rows in which a follower was told to restart
  bool hung = false;
};

// Writes to registers through a bus, "ADDRESS:DATA,..." in hexadecimal.
struct Access {
  uint32_t address, data;
};
std::vector<Access> accesses(const std::string &key) {
  std::vector<Access> found;
  const auto given = options.find(key);
  std::istringstream text(given == options.end() ? "" : given->second);
  for (std::string one; std::getline(text, one, ',');)
    found.push_back({static_cast<uint32_t>(std::stoul(one, nullptr, 16)),
                     static_cast<uint32_t>(std::stoul(one.substr(one.find(':') + 1), nullptr, 16))});
  return found;
}
void access(Model &model, const std::vector<Access> &all, long since) {
  static const int valid = find("bus_valid_i"), write = find("bus_write_i"), address = find("bus_address_i"),
                   data = find("bus_wdata_i"), strobe = find("bus_strobe_i");
  if (since < 0 || since % 4 || static_cast<size_t>(since / 4) >= all.size()) return;
  const auto &one = all[since / 4];
  model.set(valid, true), model.set(write, true), model.set(address, &one.address), model.set(data, &one.data);
  const uint32_t every = 15;
  model.set(strobe, &every);
}

uint32_t checksum(const Words &bytes, size_t count) {
  uint32_t crc = ~0u;
  for (size_t n = 0; n < count; ++n) {
    crc ^= bytes[n];
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

// An output frame of a sink, up to its last beat; for packets, the data that a receiver keeps.
struct Frame {
  size_t row;
  long clock;
  std::vector<Words> words;
};
std::vector<Frame> frames_of(const std::vector<Beat> &beats, long *damaged = nullptr) {
  std::vector<Frame> frames;
  Frame frame{};
  uint32_t expected = 0;
  for (const auto &beat : beats) {
    if (frame.words.empty()) frame.clock = beat.clock, frame.row = beat.row;
    frame.words.push_back(beat.words);
    if (!beat.last) continue;
    if (options.count("packets")) {
      Words bytes;
      for (const auto &words : frame.words) bytes.push_back(words[0]);
      uint32_t sent = 0;
      for (size_t n = 0; bytes.size() > 12 && n < 4; ++n) sent |= bytes[bytes.size() - 4 + n] << 8 * n;
      if (bytes.size() <= 12 || checksum(bytes, bytes.size() - 4) != sent) {
        if (damaged) ++*damaged;
        frame.words.clear();
        continue;
      }
      if (damaged && bytes[1] != expected) ++*damaged;
      expected = (bytes[1] + 1) & 255;
      if (bytes[0] == 3) bytes[8] = 0;  // an image's own number
      std::fill(bytes.begin() + 1, bytes.begin() + 8, 0);
      bytes.resize(bytes.size() - 4);
      frame.words = {bytes};
    }
    frames.push_back(frame);
    frame.words.clear();
  }
  return frames;
}

void play(Model &model, Trace &trace, const std::vector<Cell> *cells, const Fault &fault, uint64_t seed, bool reset) {
  trace.out.resize(sinks.size());
  std::vector<uint32_t> up(flags.size()), before(flags.size());
  long clock = 0;
  if (reset && reset_port >= 0) {
    model.low();
    model.set(reset_port, true);
    model.low();
    model.high();
    model.low();
    model.set(reset_port, false);
  }
  const auto early = accesses("before"), sudden = accesses("write");
  Pins pins;
  static const bool bus = options.count("bus");
  static const int asks = bus ? find("bus_valid_o") : -1, asked_at = find("bus_address_o"), writes = find("bus_write_o"),
                   done = find("bus_done_i"), error = find("bus_error_i"), answer = find("bus_rdata_i");
  bool asked = false, answers = false;  // one clock ago, two clocks ago
  uint32_t word = 0, next_word = 0;
  const bool free = options.count("free");
  const size_t drain = free ? 0 : 3000;
  size_t quiet = 0, late = 0;
  static const auto ready = names("ready");
  const auto chanced = [&](const Stream &sink) { return std::find(ready.begin(), ready.end(), sink.name) == ready.end(); };
  for (size_t r = 0; r < rows.size() + drain; ++r) {
    const bool draining = r >= rows.size();
    Words row = draining ? rows.back() : rows[r];
    std::vector<int> left(sources.size());  // beats of this row still to offer
    for (size_t s = 0; s < sources.size(); ++s) {
      left[s] = !draining && row[offset[sources[s].valid]];
      if (left[s] && fault.row == r && static_cast<int>(s) == fault.source) {
        if (fault.kind == kLost) left[s] = 0;
        if (fault.kind == kTwice) left[s] = 2;
        if (fault.kind == kLate) late = 37;
        if (fault.kind == kLast && sources[s].last >= 0) row[offset[sources[s].last]] ^= 1;
      }
    }
    if (fault.kind == kGone && r >= fault.row && r < fault.row + fault.count) left.assign(left.size(), 0);
    size_t waited = 0;
    bool again = true;
    while (again) {
      if (fault.kind == kBit && clock == fault.clock) *(*cells)[fault.cell].byte ^= (*cells)[fault.cell].mask;
      for (size_t n = 0; n < ports.size(); ++n) {
        const bool pin = !pins.converters.empty() && (static_cast<int>(n) == pins.miso || static_cast<int>(n) == pins.busy);
        if (ports[n].in && !pin) model.set(static_cast<int>(n), &row[offset[n]]);
      }
      const bool now = fault.clock <= clock && clock < fault.clock + lasts(fault.kind);
      const bool stopped = fault.kind == kStop && now, stuck = fault.kind == kStuck && now;
      for (size_t s = 0; s < sources.size(); ++s) model.set(sources[s].valid, left[s] > 0 && !late && !stopped);
      if (bus) {
        model.set(done, answers), model.set(error, static_cast<bool>(word & 1)), model.set(answer, &word);
        answers = asked, word = next_word;
      }
      access(model, early, clock - 40);
      if (fault.kind == kWrite) access(model, sudden, clock - fault.clock);
      for (size_t s = 0; s < sinks.size(); ++s)
        model.set(sinks[s].ready, !stuck && (draining || !chanced(sinks[s]) || chance(seed * 7919 + s * 31 + clock) % 4 != 0));
      const bool reset_now = fault.kind == kReset && clock == fault.clock;
      if (reset_port >= 0 && reset_now) model.set(reset_port, true);
      model.low();
      trace.row_of_clock.push_back(r);
      again = late > 0;
      if (late) --late;
      if (!pins.converters.empty() && !stopped) {
        pins.step(model, now && fault.kind == kBusy, now && fault.kind == kNoise, now && fault.kind == kOver, clock);
      }
      asked = bus && model.bit(asks);
      if (asked) next_word = chance(2 * model.word(asked_at, 0) + model.bit(writes));
      bool moved = false;
      for (size_t s = 0; s < sources.size(); ++s) {
        if (left[s] && model.bit(sources[s].valid) && model.bit(sources[s].ready)) --left[s], moved = true;
        again |= left[s] > 0;
      }
      for (size_t s = 0; s < sinks.size(); ++s) {
        if (!model.bit(sinks[s].valid) || !model.bit(sinks[s].ready)) continue;
        moved = true;
        Beat beat{r, clock, sinks[s].last < 0 || model.bit(sinks[s].last), {}};
        for (const int port : sinks[s].payload)
          for (int w = 0; w < (ports[port].bits + 31) / 32; ++w) beat.words.push_back(model.word(port, w));
        if (options.count("end")) beat.last = beat.words[0] == static_cast<uint32_t>(option("end", 0));
        trace.out[s].push_back(beat);
        if (sinks[s].restart >= 0 && model.bit(sinks[s].restart)) trace.restarts.push_back(r);
      }
      for (size_t f = 0; f < flags.size(); ++f) {
        const bool counts = ports[flags[f]].bits > 1;
        up[f] += counts ? model.word(flags[f], 0) != before[f] : model.bit(flags[f]);
        before[f] = model.word(flags[f], 0);
      }
      if (sinks.empty() && !again && (strobe < 0 || model.bit(strobe))) {
        Words words;
        for (const int port : levels)
          for (int w = 0; w < (ports[port].bits + 31) / 32; ++w) words.push_back(model.word(port, w));
        trace.level.push_back({r, words});
      }
      model.high();
      ++clock;
      waited = moved ? 0 : waited + 1;
      if (reset_now) return;
      if (waited > 20000) {
        trace.hung = true;
        again = false;
        r = rows.size() + drain;
      }
      quiet = moved ? 0 : quiet + 1;
    }
    if (draining && quiet > 400) break;
  }
  if (options.count("packets")) {  // a receiver's count of damaged packets
    long damaged = 0;
    for (const auto &out : trace.out) frames_of(out, &damaged);
    trace.flag.push_back(static_cast<uint32_t>(damaged));
  }
  for (size_t f = 0; f < flags.size(); ++f) {
    trace.flag.push_back(up[f]);
    for (int w = 0; w < (ports[flags[f]].bits + 31) / 32; ++w) trace.flag.push_back(model.word(flags[f], w));
  }
}

constexpr size_t kFew = 3;  // the fewest frames that allow a comparison
// The least number of frames of any output stream from this row on; without streams, the changes of the outputs.
size_t fewest(const Trace &trace, size_t from) {
  const auto quiet = names("quiet");
  size_t least = SIZE_MAX;
  for (size_t s = 0; s < sinks.size(); ++s) {
    if (std::find(quiet.begin(), quiet.end(), sinks[s].name) != quiet.end()) continue;
    const auto frames = frames_of(trace.out[s]);
    least = std::min<size_t>(least, std::count_if(frames.begin(), frames.end(), [&](auto &f) { return f.row >= from; }));
  }
  if (sinks.empty()) {
    least = 0;
    for (size_t n = 1; n < trace.level.size(); ++n)
      least += trace.level[n].first >= from && trace.level[n].second != trace.level[n - 1].second;
  }
  return least;
}

// Whether ``bad`` has frames that begin at ``from`` or later, and each of them occurs in ``good``.
bool among(const std::vector<Beat> &bad, const std::vector<Beat> &good, long from, bool *none = nullptr) {
  const auto known = frames_of(good);
  bool any = none != nullptr;
  if (none) *none = true;
  for (const auto &frame : frames_of(bad)) {
    if (frame.clock < from) continue;
    any = true;
    if (none) *none = false;
    if (std::none_of(known.begin(), known.end(), [&](const auto &other) { return other.words == frame.words; })) return false;
  }
  return any || known.empty();
}

// Compares the second half only: before that, state that a reset does not clear may show in outputs not yet valid.
bool late_same(const Trace &a, const Trace &b) {
  for (size_t s = 0; s < a.out.size(); ++s) {
    const auto &x = a.out[s], &y = b.out[s];
    if (options.count("free")) {
      if (!among(x, y, static_cast<long>(rows.size() / 2))) return false;
      continue;
    }
    for (size_t k = 1; k <= y.size() / 2; ++k)
      if (k > x.size() || x[x.size() - k].words != y[y.size() - k].words) return false;
  }
  for (size_t k = 1; k <= b.level.size() / 2; ++k)
    if (k > a.level.size() || a.level[a.level.size() - k].second != b.level[b.level.size() - k].second) return false;
  return true;
}

bool same(const Trace &a, const Trace &b) {
  if (a.out.size() != b.out.size() || a.level.size() != b.level.size()) return false;
  for (size_t s = 0; s < a.out.size(); ++s) {
    if (a.out[s].size() != b.out[s].size()) return false;
    for (size_t i = 0; i < a.out[s].size(); ++i)
      if (a.out[s][i].words != b.out[s][i].words) return false;
  }
  for (size_t i = 0; i < a.level.size(); ++i)
    if (a.level[i].second != b.level[i].second) return false;
  return true;
}

bool excused = false;  // whether `differs` found beats that say themselves that they may be wrong
bool says_so(const Stream &sink, const Beat &beat) {
  static const int error = options.count("error") ? find(options["error"]) : -1;
  size_t word = 0;
  for (const int port : sink.payload) {
    if (port == error) return beat.words[word];
    word += (ports[port].bits + 31) / 32;
  }
  return false;
}

// A description of the first difference from ``golden`` in the output of the rows from ``from`` on; empty if none.
std::string differs(const Trace &trace, const Trace &golden, size_t from) {
  if (options.count("packets")) {  // each one is expected and none is missing; their order is free
    for (size_t s = 0; s < sinks.size(); ++s) {
      const auto good = frames_of(golden.out[s]), bad = frames_of(trace.out[s]);
      const auto in = [](const Frame &one, const std::vector<Frame> &all) {
        return std::any_of(all.begin(), all.end(), [&](const auto &other) { return other.words == one.words; });
      };
      for (const auto &frame : bad)
        if (frame.row >= from && !in(frame, good)) return "a packet that was not to come, row " + std::to_string(frame.row);
      for (const auto &frame : good)
        if (frame.row >= from && !in(frame, bad)) return "a packet did not come, row " + std::to_string(frame.row);
    }
    return "";
  }
  for (size_t s = 0; s < sinks.size(); ++s) {
    const auto &good = golden.out[s], &bad = trace.out[s];
    size_t first = 0;
    while (first < good.size() && (good[first].row < from || (first && !good[first - 1].last))) ++first;
    for (size_t k = 1; k <= good.size() - first; ++k)
      if (k <= bad.size() && bad[bad.size() - k].words != good[good.size() - k].words && says_so(sinks[s], bad[bad.size() - k]))
        excused = true;
      else if (k > bad.size() || bad[bad.size() - k].words != good[good.size() - k].words)
        return sinks[s].name + " " + std::to_string(k) + " of " + std::to_string(good.size() - first) + " before the end";
  }
  const auto &good = golden.level, &bad = trace.level;
  for (size_t k = 1; sinks.empty() && k <= good.size() && good[good.size() - k].first >= from; ++k)
    if (k > bad.size() || bad[bad.size() - k].second != good[good.size() - k].second)
      return "row " + std::to_string(good[good.size() - k].first);
  return "";
}

}  // namespace

int main(int argc, char **argv) {
  if (argc < 5) return 2;
  for (int n = 5; n < argc; ++n) {
    const std::string text = argv[n];
    options[text.substr(0, text.find('='))] = text.substr(text.find('=') + 1);
  }
  read(argv[1]);
  if (options.count("strobe")) strobe = find(options["strobe"]);
  const long count = std::atol(argv[2]);
  const uint64_t seed = std::strtoull(argv[3], nullptr, 10);
  size_t settle = std::strtoul(argv[4], nullptr, 10);
  std::mt19937_64 draw(seed);

  Trace golden;
  std::vector<size_t> state;
  {
    Model model;
    play(model, golden, nullptr, Fault{}, seed, true);
    // State bits are those that keep a changed value until the next clock.
    auto cells = model.cells();
    model.low();
    for (size_t c = 0; c < cells.size(); ++c) {
      const uint8_t before = *cells[c].byte;
      *cells[c].byte ^= cells[c].mask;
      model.low();
      if ((*cells[c].byte ^ before) & cells[c].mask) state.push_back(c);
      *cells[c].byte = (*cells[c].byte & ~cells[c].mask) | (before & cells[c].mask);
      model.low();
    }
    std::map<int, long> per;
    for (const size_t c : state) ++per[cells[c].variable];
    size_t beats = 0;
    for (const auto &sink : golden.out) beats += sink.size();
    std::printf("# rows %zu clocks %zu sources %zu sinks %zu beats %zu cells %zu state %zu variables %zu flags %zu hung %d\n",
                rows.size(), golden.row_of_clock.size(), sources.size(), sinks.size(), beats, cells.size(), state.size(),
                per.size(), flags.size(), golden.hung);
    for (size_t s = 0; s < sinks.size(); ++s) {
      const auto frames = frames_of(golden.out[s]);
      std::set<std::vector<Words>> kinds_of;
      for (const auto &frame : frames) kinds_of.insert(frame.words);
      std::printf("# %s gives %zu beats, %zu frames, %zu of them different\n", sinks[s].name.c_str(), golden.out[s].size(),
                  frames.size(), kinds_of.size());
    }
    if (golden.hung) std::cerr << "it stands still without a fault\n", std::exit(3);
    if (fewest(golden, 0) < kFew) {
      std::cerr << "too few frames to compare:";
      for (size_t s = 0; s < sinks.size(); ++s) std::cerr << " " << sinks[s].name << " " << frames_of(golden.out[s]).size();
      std::cerr << "\n";
      std::exit(3);
    }
  }

  // Frames begin at the row after one with a last beat of the first source.
  std::vector<size_t> begins;
  const std::string framed = options.count("frame") ? options["frame"] : "";
  if (!settle) settle = sources.empty() || sources[0].last < 0 ? 8 : 1;
  bool fresh = true;
  long resting = 0;
  for (size_t r = 0; r < rows.size(); ++r) {
    if (options.count("idle")) {
      const bool rests = rows[r][offset[find(options["idle"].substr(0, options["idle"].find(':')))]] & 1;
      resting = rests ? resting + 1 : 0;
      if (resting == std::stol(options["idle"].substr(options["idle"].find(':') + 1))) begins.push_back(r);
    } else if (!framed.empty() && options.count("when") && !(rows[r][offset[find(options["when"])]] & 1)) {
      continue;
    } else if (!framed.empty() && !options.count("when") && !(sources.empty() || (rows[r][offset[sources[0].valid]] & 1))) {
      continue;
    } else if (!framed.empty()) {
      const size_t colon = framed.find(':');
      const uint32_t value = rows[r][offset[find(framed.substr(0, colon))]];
      if (colon == std::string::npos ? value & 1 : value == std::stoul(framed.substr(colon + 1))) begins.push_back(r);
    } else if (sources.empty()) {
      begins.push_back(r);
    } else if (reset_port >= 0 && rows[r][offset[reset_port]]) {
      fresh = true;
    } else if (rows[r][offset[sources[0].valid]]) {
      if (fresh) begins.push_back(r);
      fresh = sources[0].last < 0 || rows[r][offset[sources[0].last]];
    }
  }

  // The faults: all registers' bits in turn and random bits of memories; then those of streams.
  std::vector<Fault> faults;
  Model shape;
  const auto cells = shape.cells();
  std::vector<size_t> registers, memory;
  for (const size_t c : state)
    if (cells[c].name.find(options["only"]) != std::string::npos) (cells[c].memory ? memory : registers).push_back(c);
  const long clocks = static_cast<long>(golden.row_of_clock.size());
  long last_clock = 0;  // the latest clock after which enough frames follow
  size_t last_frame = begins.size() > settle + 3 ? begins.size() - settle - 3 : 0;
  // Recovery must be observable, so enough frames must follow.
  while (!options.count("free") && !sinks.empty() && last_frame && fewest(golden, begins[last_frame + settle]) < kFew) --last_frame;
  const size_t after = last_frame ? begins[last_frame] : 0;
  while (last_clock < clocks && golden.row_of_clock[last_clock] < after) ++last_clock;
  long interval = 1;  // clocks of the longest frame in a free-running block
  if (options.count("free")) {
    last_clock = clocks / 2;
    for (const auto &out : golden.out) {
      const auto frames = frames_of(out);
      for (size_t i = 2; i < frames.size(); ++i) interval = std::max(interval, frames[i].clock - frames[i - 1].clock);
    }
    // Frames must still follow after the longest fault and the recovery from it.
    const auto quiet = names("quiet");
    for (size_t s = 0; s < sinks.size(); ++s) {
      const auto frames = frames_of(golden.out[s]);
      if (frames.size() < kFew || std::find(quiet.begin(), quiet.end(), sinks[s].name) != quiet.end()) continue;
      const long needed = kStopped + static_cast<long>(settle) * interval;
      last_clock = std::min(last_clock, frames[frames.size() - kFew].clock - needed);
    }
  }
  if (last_clock < 2) std::cerr << "too short a recording: " << begins.size() << " frames\n", std::exit(3);
  const auto any_clock = [&] { return static_cast<long>(draw() % last_clock); };
  std::shuffle(registers.begin(), registers.end(), draw);
  std::shuffle(memory.begin(), memory.end(), draw);
  for (long n = 0; n < count && !(registers.empty() && memory.empty()); ++n) {
    const bool word = registers.empty() || (!memory.empty() && n % 4 == 3);
    const auto &from = word ? memory : registers;
    const size_t index = static_cast<size_t>(word && !registers.empty() ? n / 4 : memory.empty() ? n : n - n / 4);
    faults.push_back({kBit, any_clock(), 0, 1, 0, from[index % from.size()]});
  }
  bool checks = sources.empty();  // lost and doubled beats: only for blocks that check
  for (const auto &port : ports) checks |= port.name.find("damaged") != std::string::npos;
  {
    std::vector<std::pair<size_t, int>> beats;
    for (size_t r = 0; r < after; ++r)
      for (size_t s = 0; s < sources.size(); ++s)
        if (rows[r][offset[sources[s].valid]]) beats.push_back({r, static_cast<int>(s)});
    const long each = std::max(4L, count / 20);
    for (const Kind kind : {kLost, kTwice, kLate, kLast, kGone}) {
      if (options["skip"].find(kinds[kind]) != std::string::npos || (kind != kLate && !checks)) continue;
      for (long n = 0; n < each && !beats.empty(); ++n) {
        const auto [r, s] = beats[draw() % beats.size()];
        if (kind == kLast && sources[s].last < 0) continue;
        size_t gone = 1;
        if (kind == kGone) gone = std::min(static_cast<size_t>(2 + draw() % 30), after - r);
        faults.push_back({kind, 0, r, gone, s, 0});
      }
    }
    const auto wanted = [](const char *kind) { return options["skip"].find(kind) == std::string::npos; };
    if (option("part", 0)) {
      for (const Kind kind : {kBusy, kNoise, kOver})
        for (long n = 0; n < each; ++n) faults.push_back({kind, any_clock(), 0, 1, 0, 0});
    }
    for (long n = 0; n < each && (option("part", 0) || !sources.empty()) && wanted("stop"); ++n)
      faults.push_back({kStop, any_clock(), 0, 1, 0, 0});
    for (long n = 0; n < each && !sinks.empty() && wanted("stuck"); ++n) faults.push_back({kStuck, any_clock(), 0, 1, 0, 0});
    for (long n = 0; n < 2 * each && reset_port >= 0; ++n) faults.push_back({kReset, n, 0, 1, 0, 0});
  }
  // Writes at clocks spread over a frame, and a reference run with the write before the first frame.
  Trace written;
  if (options.count("write")) {
    const long writes = option("writes", 100);
    if (options.count("alone")) faults.clear();
    for (long n = 0; n < writes; ++n) faults.push_back({kWrite, last_clock / 2 + n * interval / writes, 0, 1, 0, 0});
    Model model;
    Fault soon;
    soon.kind = kWrite;
    soon.clock = 400;
    play(model, written, nullptr, soon, seed, true);
    size_t changed = 0;
    for (size_t s = 0; s < sinks.size(); ++s)
      for (const auto &frame : frames_of(written.out[s]))
        changed += std::none_of(golden.out.begin(), golden.out.end(), [&](const auto &out) {
          const auto known = frames_of(out);
          return std::any_of(known.begin(), known.end(), [&](const auto &other) { return other.words == frame.words; });
        });
    std::printf("# writing changes %zu frames, one every %ld clocks\n", changed, interval);
    if (!changed && !options.count("same")) std::cerr << "what is written changes nothing\n", std::exit(3);
  }

  std::vector<Trace> shifted;
  std::vector<size_t> removed;
  for (long k = 1; k < option("phases", 1) && begins.size() > static_cast<size_t>(k) + 1; ++k) {
    const auto whole = rows;
    removed.push_back(begins[1 + k] - begins[1]);
    rows.erase(rows.begin() + static_cast<long>(begins[1]), rows.begin() + static_cast<long>(begins[1 + k]));
    Model model;
    shifted.emplace_back();
    play(model, shifted.back(), nullptr, Fault{}, seed, true);
    rows = whole;
  }

  auto kept = names("kept");  // state kept by design
  if (options["kept"] == "all") kept = {""};
  const auto late = names("late");

  for (const auto &fault : faults) {
    Model model;
    const auto here = model.cells();
    Trace trace;
    const auto &cell = here[fault.cell];
    const bool level = fault.kind == kBit && (*cell.byte & cell.mask);  // before the run
    play(model, trace, &here, fault, seed, true);
    std::string outcome = "silent", what;
    if (fault.kind == kReset) {  // then the whole recording again in the same block
      Trace again;
      play(model, again, &here, Fault{}, seed, false);
      outcome = late_same(again, golden) ? "recovered" : "silent";
    } else {
      size_t row = fault.row;
      if (fault.kind == kGone) row += fault.count - 1;
      if (fault.kind == kBit || fault.kind >= kStuck) row = golden.row_of_clock[fault.clock];
      // A fault in a frame's last beat or in the pause after it counts for the next frame.
      const auto next = std::upper_bound(begins.begin(), begins.end(), row + 1);
      const size_t from = next + settle - 1 < begins.end() ? *(next + settle - 1) : rows.size();
      const bool flagged = trace.flag != golden.flag || trace.restarts != golden.restarts;
      bool right = !trace.hung;
      const bool free = options.count("free");
      if (free) {
        for (size_t s = 0; s < sinks.size() && right; ++s) {
          const long clear = fault.clock + lasts(fault.kind) + static_cast<long>(settle) * interval;
          if (fault.kind == kWrite) {  // from this clock on the old or the new values, at the end only the new
            auto either = golden.out[s];
            while (!either.empty() && !either.back().last) either.pop_back();
            either.insert(either.end(), written.out[s].begin(), written.out[s].end());
            right = among(trace.out[s], either, fault.clock) && among(trace.out[s], written.out[s], clear + 2 * interval);
          } else {
            right = among(trace.out[s], golden.out[s], clear);
          }
          if (!right) what = sinks[s].name;
        }
      } else if (right) {
        excused = false;
        what = differs(trace, golden, from);
        right = what.empty();
        // Windows that begin at another frame are right, too.
        for (size_t k = 0; k < shifted.size() && !right; ++k) right = differs(trace, shifted[k], from - removed[k]).empty();
      }
      if (right) outcome = same(trace, golden) ? (flagged ? "detected" : "masked") : flagged ? "detected" : "recovered";
      else if (flagged && !trace.hung && fault.kind != kWrite) outcome = "told";
      if (right && excused) outcome = "told";
      // The count of clocks to the next frame was made longer: no frame arrives, or only correct ones.
      if (!right && free && fault.kind == kBit && outcome == "silent" && holds(cell.name, late)) {
        bool all = true;  // in all streams
        for (size_t s = 0; s < sinks.size(); ++s) {
          bool none = false;
          all &= among(trace.out[s], golden.out[s], fault.clock + static_cast<long>(settle) * interval, &none);
        }
        if (all) outcome = "late";
      }
      if (!right && outcome != "late") {  // check whether a reset and all writes again repair it
        Trace again;
        if (reset_port >= 0) model.set(reset_port, true);
        play(model, again, &here, Fault{}, seed, true);
        outcome = outcome == "told" ? "told" : "silent";
        const bool healed = late_same(again, golden);
        // A bit that neither a reset nor anything after it changes is a constant that this build keeps in a variable.
        if (!healed && fault.kind == kBit && !cell.memory && ((*cell.byte & cell.mask) != 0) != level) outcome = "constant";
        if (!healed) what += ", and not after a reset";
        if (healed && outcome == "silent" && fault.kind == kBit && holds(cell.name, kept)) outcome = "kept";
      }
    }
    std::printf("%s %s %ld %s %s\n", kinds[fault.kind], fault.kind == kBit ? here[fault.cell].name.c_str() : "-",
                fault.kind == kBit || fault.kind >= kStuck ? fault.clock : static_cast<long>(fault.row), outcome.c_str(),
                what.c_str());
  }
  return 0;
}
