// Indirect light: irradiance on the cache points, gathered bounce after bounce, interpolated anywhere on a surface.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/bake/cache_points.h"
#include "content/bake/direct_light.h"
#include "content/bake/light_field.h"
#include "content/progress.h"

namespace probewalk {

class IrradianceCache {
 public:
  // kept: values() of an earlier, equal cache; used when they are as many as there are points. Throws Interrupted when
  // progress is cancelled.
  IrradianceCache(const Scene& scene, const RayScene& rays, const DirectLight& direct, const LightOptions& options,
                  Progress& progress, std::vector<glm::vec3> kept);

  // Irradiance (lux) from everything that DirectLight does not count: sky, large emitters, reflected light.
  glm::vec3 indirect(glm::vec3 position_m, glm::vec3 normal) const {
    return points_.interpolate(indirect_, position_m, normal);
  }
  const std::vector<glm::vec3>& values() const { return indirect_; }
  std::size_t size() const { return points_.size(); }
  float spacing_m() const { return points_.spacing_m(); }
  std::uint64_t rays_cast() const { return rays_cast_; }

 private:
  struct Gather;
  CachePoints points_;
  std::vector<glm::vec3> indirect_;
  std::uint64_t rays_cast_ = 0;
};

}  // namespace probewalk
