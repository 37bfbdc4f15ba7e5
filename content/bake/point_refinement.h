// Puts cache points closer together where light changes within their spacing: at the edges of shadows and of what
// shines, in lit recesses. The measure is what a point's neighbours say of its light without it, which is more than the
// error of interpolating between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "content/bake/cache_points.h"
#include "content/bake/light_gather.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

struct LightRefinement {
  std::size_t added = 0;
  // By point: rays for its first bounce, first_rays and more where that would be noisy; limited.
  std::vector<std::uint32_t> rays;
  double rays_share = 1.0;     // of those wanted
  LightGather::Values direct;  // light that arrives straight from the emitters, by point
  // How far neighbours are off, beyond what noise explains, as a share of all light at a point: of a twentieth of the
  // points by more than this.
  double error_before = 0.0, error_after = 0.0;
};

// Light takes minutes, however many points a scene has: more rays than kMostRays are halved, and again, until they are
// no more, but for kLeastRays a point. By halves, lest what changes in one room light all of them anew. Returns the
// share.
inline constexpr double kMostRays = 100e6;
inline constexpr std::uint32_t kLeastRays = 32;
double limit_rays(std::vector<std::uint32_t>& rays);

// gather: of the points. Deterministic, whatever the threads. Throws Interrupted.
LightRefinement refine_points(const Scene& scene, const RayScene& rays, LightGather& gather, int first_rays,
                              CachePoints& points, Progress& progress);

}  // namespace probewalk
