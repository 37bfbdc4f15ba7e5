// How long contenders take for the same rays, measured side by side.
#pragma once

#include <span>
#include <vector>

#include "content/progress.h"
#include "tools/probewalk/bench/contender.h"

namespace probewalk::bench {

struct Timing {
  std::vector<double> ns_per_ray;  // a repetition each
  std::vector<double> ratio;       // to the first contender in the same repetition
};

// Every repetition runs each contender once, starting with another one each time, so that what else the machine does falls
// on all alike and the first runs of the device's clock on none alone. The contenders have been run before (warm-up).
// Throws Interrupted.
std::vector<Timing> time_side_by_side(std::span<Contender* const> contenders, const ViewRays& rays, int repeats,
                                      Progress& progress);

}  // namespace probewalk::bench
