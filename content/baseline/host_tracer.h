// Any method on the host, in float: what the device answers, for tools and tests.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "content/baseline/baseline_maps.h"
#include "content/baseline/method.h"
#include "content/probe/probe_set.h"
#include "shaders/shared/ray_batch.h"

namespace probewalk {

class HostTracer {
 public:
  // Probes and maps must outlive the tracer; `maps` may be null where the choice needs none, and has an entry for every
  // probe. Throws std::logic_error otherwise. What the choice says of the dials goes over `dials`.
  HostTracer(const ProbeSet& probes, const TraceConstants& dials, const TracerChoice& choice, const BaselineMaps* maps);

  // One ray; the direction need not be unit length, must not be 0. `spread_rad` is its angular width, for filtering.
  // Thread-safe.
  BatchAnswer trace(glm::dvec3 origin_m, glm::dvec3 direction, float spread_rad) const;

 private:
  const ProbeSet& probes_;
  TraceConstants dials_;
  TracerChoice choice_;
  std::vector<BaselineRecord> records_;  // with addresses in this process's memory
  BaselineContext context_{};
};

// What the walks are told of a choice, constants included but for the records' address.
BaselineContext baseline_context(const TracerChoice& choice, const BaselineMaps* maps);

}  // namespace probewalk
