#include "tools/probewalk/bench/timing.h"

#include "content/error.h"

namespace probewalk::bench {

std::vector<Timing> time_side_by_side(std::span<Contender* const> contenders, const ViewRays& rays, int repeats,
                                      Progress& progress) {
  std::vector<Timing> timings(contenders.size());
  std::vector<double> round(contenders.size());
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (std::size_t step = 0; step < contenders.size(); ++step) {
      if (progress.cancelled()) throw Interrupted("interrupted while measuring times; nothing was written");
      const std::size_t k = (step + static_cast<std::size_t>(repeat)) % contenders.size();
      round[k] = static_cast<double>(contenders[k]->trace(rays).device_ns) / static_cast<double>(rays.rays.size());
      progress.advance(rays.rays.size());
    }
    for (std::size_t k = 0; k < contenders.size(); ++k) {
      timings[k].ns_per_ray.push_back(round[k]);
      if (round[0] > 0.0) timings[k].ratio.push_back(round[k] / round[0]);
    }
  }
  return timings;
}

}  // namespace probewalk::bench
