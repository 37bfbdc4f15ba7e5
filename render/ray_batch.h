// Traces a list of rays on the device: for tools and tests.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/device.h"
#include "render/pipeline.h"
#include "render/probe_store.h"
#include "render/tracer_choice.h"
#include "shaders/shared/ray_batch.h"

namespace probewalk {

struct WorldRay {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};  // need not be unit length; must not be 0
};

struct TracedRays {
  std::vector<BatchAnswer> answers;  // in the rays' order
  std::int64_t device_ns = 0;        // from the dispatches' begin to their end, summed: without copies and set-up
};

class RayBatch {
 public:
  // What `setup` names must outlive this.
  explicit RayBatch(const Device& device, const TracerSetup& setup = {});

  // Blocks until all rays are answered, in their order, against what slot 0 of the store shows (see settle).
  // `spread_rad` is each ray's angular width, for filtering. What the choice says of the dials goes over `dials`.
  std::vector<BatchAnswer> trace(const ProbeStore& store, const TraceConstants& dials, std::span<const WorldRay> rays,
                                 float spread_rad) const;
  // The same, timed by the device.
  TracedRays trace_timed(const ProbeStore& store, const TraceConstants& dials, std::span<const WorldRay> rays,
                         float spread_rad) const;

 private:
  const Device& device_;
  TracerSetup setup_;
  std::uint32_t interleave_;  // see kInterleave in trace_stereo.glsl
  Pipeline pipeline_;
};

}  // namespace probewalk
