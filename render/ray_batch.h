// Traces a list of rays on the device: for tools and tests.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/device.h"
#include "render/pipeline.h"
#include "render/probe_store.h"
#include "shaders/shared/ray_batch.h"

namespace probewalk {

struct WorldRay {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};  // need not be unit length; must not be 0
};

class RayBatch {
 public:
  explicit RayBatch(const Device& device);

  // Blocks until all rays are answered, in their order, against what slot 0 of the store shows (see settle). `spread_rad` is each ray's angular width, for filtering.
  std::vector<BatchAnswer> trace(const ProbeStore& store, const TraceConstants& dials, std::span<const WorldRay> rays,
                                 float spread_rad) const;
  // The same, and how long the dispatches took in ns, from submission to fence: copying in and out is not in it.
  std::vector<BatchAnswer> trace(const ProbeStore& store, const TraceConstants& dials, std::span<const WorldRay> rays,
                                 float spread_rad, std::int64_t& dispatches_ns) const;

 private:
  const Device& device_;
  Pipeline pipeline_;
};

}  // namespace probewalk
