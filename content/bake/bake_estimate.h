// How long a bake will take and how much it will write, before it begins.
#pragma once

#include <cstdint>
#include <vector>

#include "content/bake/light_field.h"
#include "content/scene/ray_scene.h"

namespace probewalk {

struct LevelSize {
  int geometry = 0;  // cells per side
  int radiance = 0;  // texels per side
};

struct BakeEstimate {
  std::uint64_t texels = 0;
  double seconds = 0.0;
  std::uint64_t bytes_disk = 0;
};

// Times a few thousand rays from `position_m`, on all threads; the rest is arithmetic on measured averages.
BakeEstimate estimate_bake(const Scene& scene, const RayScene& rays, const LightOptions& light,
                           const std::vector<LevelSize>& levels, std::uint64_t probes, glm::dvec3 position_m);

}  // namespace probewalk
