// Light that arrives straight from the emitters, by next-event estimation. Few emitters get a ray each, which leaves no
// noise at all. Of many, those get one that the light grid knows to matter, and of the weak rest a stratified choice,
// by what each may send: expected right whatever the grid believes, and always the same at the same point.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/bake/cache_points.h"
#include "content/bake/emitter_light.h"
#include "content/bake/emitters.h"
#include "content/bake/light_grid.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"

namespace probewalk {

inline constexpr int kShadowRays = 8;       // per shading point, where that leaves little noise
inline constexpr int kMostShadowRays = 24;  // expected, elsewhere

class DirectLight {
 public:
  // points: where the visibility of many emitters is learned, when there are many.
  DirectLight(const Scene& scene, const RayScene& rays, const CachePoints& points, Progress& progress);
  DirectLight(const DirectLight&) = delete;
  DirectLight& operator=(const DirectLight&) = delete;

  // Irradiance (lux) on a surface at position with the given unit normals. Adds to rays_cast. Thread-safe.
  glm::vec3 irradiance(glm::vec3 position_m, glm::vec3 geometric_normal, glm::vec3 normal,
                       std::uint64_t& rays_cast) const;

  const Emitters& emitters() const { return emitters_; }
  const LightGrid& grid() const { return grid_; }
  std::uint64_t rays_cast() const { return grid_.rays_cast(); }  // by the construction

 private:
  std::uint32_t pick_by_power(float at) const;

  Emitters emitters_;
  EmitterLight light_;
  LightGrid grid_;
  std::vector<float> power_sums_;  // running, over the emitters
};

}  // namespace probewalk
