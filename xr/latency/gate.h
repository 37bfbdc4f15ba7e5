// Conditions that a run must meet, as in `--gate p99=11.1ms,missed=0`: a build server's yes or no.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "xr/latency/ledger.h"

namespace probewalk {

struct GateCondition {
  std::string quantity;  // "frame", "cpu_busy", ...; empty for counts
  std::string what;      // "p50" ... "p999", "max"; or "missed", "discarded", "stale_run"
  double limit = 0.0;    // at most: nanoseconds, mm, degrees, or a count
};

// Comma-separated NAME=LIMIT. NAME is missed, discarded, stale_run, a percentile (of `frame`), or QUANTITY.PERCENTILE;
// a time's limit ends in ns, us, ms or s. Throws BadUsage naming the part that is none of these.
std::vector<GateCondition> parse_gate(std::string_view text);

// One line for each condition that does not hold. A percentile that n cannot carry, or that was not measured, does not.
std::vector<std::string> gate_failures(const std::vector<GateCondition>& gate, const Summary& summary);

}  // namespace probewalk
