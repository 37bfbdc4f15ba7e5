// What the ledger itself costs a walk: frames with it against frames without, turn by turn.
#pragma once

#include <cstdint>

#include "content/progress.h"
#include "xr/walk.h"

namespace probewalk {

// A fraction of what is spent without the ledger: 0.01 = the ledger adds a hundredth.
struct CostFraction {
  double median = 0.0;           // over the pairs
  double low = 0.0, high = 0.0;  // the quartiles
};

struct LedgerCost {
  std::uint64_t pairs = 0;
  CostFraction frame_time;  // wall clock, from frame to frame
  CostFraction cpu_time;    // of the process, a software device's threads included
};

// Stands offscreen at the start of the pack, with the method and the size of eyes of `walk`: `pairs` times a block of
// frames with the ledger and one without, in alternating order. Off, the walk takes no stamps, the device no time
// stamps, and nobody asks for either. Throws as walk() does.
LedgerCost measure_ledger_cost(const WalkOptions& walk, std::uint64_t pairs, Progress& progress);

}  // namespace probewalk
