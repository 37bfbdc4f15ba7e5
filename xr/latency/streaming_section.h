// What the page says of streaming: was what the wearer saw as fine as wanted, how long did it take to be, what did it
// cost, and what went wrong on the way.
#pragma once

#include <string>

#include "xr/latency/ledger.h"
#include "xr/latency/run.h"

namespace probewalk {

struct CoarseRun {
  std::size_t frames = 0;  // in a row, shown below the level wanted or not at all
  std::size_t first = 0;   // its first frame, as an index in the ledger
  std::int64_t length_ns = 0;
};
// The longest; warm-up frames are left out.
CoarseRun longest_coarse_run(const Ledger& ledger);

// Empty when the run has no levels to speak of: nothing was streamed.
std::string streaming_section(const Run& run, const Summary& summary);

}  // namespace probewalk
