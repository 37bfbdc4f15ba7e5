// Conditions that a run must meet, as in `--gate p99=11.1ms,missed=0`: a build server's yes or no.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "xr/latency/run.h"

namespace probewalk {

struct GateKey;

struct GateCondition {
  const GateKey* key = nullptr;  // never null; of a table that lives as long as the program
  double limit = 0.0;            // in the key's unit
};

struct GateResult {
  std::string key;              // "frame.p99", "missed", ...
  std::string unit;             // of value and limit: "ns", "mm", "deg", "count", "fraction", "bytes"
  std::optional<double> value;  // empty = there is none
  double limit = 0.0;
  bool at_least = false;  // else at most
  bool holds = false;
  std::string value_text, limit_text;  // as people read them
  std::string note;                    // why there is no value; or what to know about one that is there
};

// Comma-separated NAME=LIMIT. The limit is the worst that is allowed: the most of a time, a count or an error, the
// least of what there should be much of. Times end in ns, us, ms or s, shares may end in %, bytes in KiB, MiB or GiB.
// Throws BadUsage naming the part that is no condition, and the names that are known.
std::vector<GateCondition> parse_gate(std::string_view text);

// One for each condition, in order. What n cannot carry, or was not measured, does not hold.
std::vector<GateResult> judge_gate(const std::vector<GateCondition>& gate, const Run& run, const Summary& summary);

// "frame.p99 = 12.3 ms, more than 11.1 ms".
std::string failure_text(const GateResult& result);

// All names with what they are, a line each, for --help.
std::string gate_names_help();

}  // namespace probewalk
