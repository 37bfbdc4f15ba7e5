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
  static constexpr int kFirstGather = 2;  // times the samples are the rays of the first bounce

  // The points must outlive the cache. kept: values() of an earlier, equal cache; used when they are as many as there
  // are points. times_rays: by point, how many times the rays of the first bounce.
  IrradianceCache(const Scene& scene, const RayScene& rays, const CachePoints& points, const DirectLight& direct,
                  const LightOptions& options, const std::vector<std::uint8_t>& times_rays, Progress& progress,
                  std::vector<CachedLight> kept);

  // Irradiance (lux) from everything that DirectLight does not count: sky, large emitters, reflected light.
  glm::vec3 indirect(glm::vec3 position_m, glm::vec3 normal) const {
    return points_.interpolate(indirect_, position_m, normal);
  }
  const std::vector<CachedLight>& values() const { return indirect_; }
  std::uint64_t rays_cast() const { return rays_cast_; }

 private:
  const CachePoints& points_;
  std::vector<CachedLight> indirect_;
  std::uint64_t rays_cast_ = 0;
};

}  // namespace probewalk
