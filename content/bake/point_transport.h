// Where light goes that the cache points reflect, from point to point: what is left after the first bounces, which are
// gathered with more rays, is followed here until next to nothing is left. A white room reflects light dozens of times,
// and its slowest part fades last: to go on from the ratio of two early bounces left 9 % of a hotel room's light out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/bake/cache_points.h"
#include "content/bake/cached_light.h"
#include "content/bake/point_sets.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

class PointTransport {
 public:
  // So many rays a point, fewer where the points are very many; each ends at one of the points around its hit, by what
  // these count there. Throws Interrupted.
  PointTransport(const Scene& scene, const RayScene& rays, const CachePoints& points, int rays_per_point,
                 std::uint32_t seed, Progress& progress);

  // What the points get of `light` (one a point; its lux alone) by all reflections together, light itself not among it,
  // in lux: until a reflection adds 0.2 %, and then by a constant ratio, or 400 of them. In every
  // part of the scene that no light leaves it ends by itself: a white room is not darker for a black one beside it, and
  // stays as it is when that is painted.
  std::vector<glm::vec3> reflected(const std::vector<CachedLight>& light) const;

  std::uint64_t rays_cast() const { return std::uint64_t(rays_per_point_) * first_of_.size(); }

 private:
  struct End {
    std::uint32_t point = kNowhere;
    glm::vec3 albedo{0.0f};  // of the surface there
  };
  static constexpr std::uint32_t kNowhere = ~0u;

  int rays_per_point_;
  std::vector<End> ends_;                // rays_per_point_ each
  std::vector<std::uint32_t> first_of_;  // the part of the scene that a point is in, by its first point
};

}  // namespace probewalk
