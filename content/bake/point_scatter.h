// Where the light cache has its points: a spacing apart on all surfaces that can be seen, both sides, and closer, down
// to an eighth, where something is so near that light changes within a spacing: in gaps, behind blinds, at contacts.
// The measure is the free way, the harmonic mean of the distance over the hemisphere, as in irradiance caching (Ward,
// Rubinstein and Clear 1988), where light is known to change about as fast as that is short.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "content/bake/cache_points.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

struct ScatteredPoints {
  std::vector<CachePoints::Point> points;  // the widest spaced first; nearness is not filled in
  float spacing_m = 0.0f;                  // of those; the others have a half, a quarter, an eighth
  std::uint64_t rays_cast = 0;
};

// spacing_m > 0 is raised until at most max_points have it; half as many again, or 20,000, may be closer.
// Deterministic. Throws Interrupted.
ScatteredPoints scatter_points(const Scene& scene, const RayScene& rays, double spacing_m, std::size_t max_points,
                               Progress& progress);

// Points spacing_m apart round some of the points, in the order of `round`, as far as those are apart; at most `most`.
// Their nearness is not filled in. Deterministic. Throws Interrupted.
std::vector<CachePoints::Point> scatter_round(const Scene& scene, const RayScene& rays, const CachePoints& points,
                                              std::span<const std::uint32_t> round, float spacing_m, std::size_t most,
                                              Progress& progress);

}  // namespace probewalk
