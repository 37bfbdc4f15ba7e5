// Indirect light: irradiance gathered on the cache points, interpolated anywhere on a surface.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "content/bake/cache_points.h"
#include "content/bake/light_field.h"
#include "content/bake/light_gather.h"
#include "content/bake/point_refinement.h"
#include "content/progress.h"

namespace probewalk {

class IrradianceCache {
 public:
  static constexpr int kFirstGather = 2;  // times the samples are the rays of the first bounce

  // The points must outlive the cache; gather and refinement are theirs. kept: values() of an earlier, equal cache;
  // used when they are as many as there are points. Throws Interrupted when progress is cancelled.
  IrradianceCache(const CachePoints& points, LightGather& gather, const LightOptions& options,
                  const LightRefinement& refinement, Progress& progress, std::vector<CachedLight> kept);

  // Irradiance (lux) from everything that DirectLight does not count: sky, large emitters, reflected light.
  glm::vec3 indirect(glm::vec3 position_m, glm::vec3 normal) const {
    return points_.interpolate(indirect_, position_m, normal);
  }
  const std::vector<CachedLight>& values() const { return indirect_; }

 private:
  const CachePoints& points_;
  std::vector<CachedLight> indirect_;
};

}  // namespace probewalk
