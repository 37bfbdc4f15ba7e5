// Whoever answers rays in a measurement.
#pragma once

#include <cstdint>
#include <vector>

#include "shaders/shared/ray_batch.h"
#include "tools/probewalk/bench/bench_views.h"

namespace probewalk::bench {

struct TraceRun {
  std::vector<BatchAnswer> answers;  // in the rays' order
  std::int64_t device_ns = 0;        // the dispatches' own time, without copying in and out
};

class Contender {
 public:
  virtual ~Contender() = default;
  virtual TraceRun trace(const ViewRays& rays) = 0;
  // All that its answers are made from.
  virtual std::uint64_t bytes_device() const = 0;
};

}  // namespace probewalk::bench
