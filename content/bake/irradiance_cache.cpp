#include "content/bake/irradiance_cache.h"

#include <algorithm>
#include <utility>

namespace probewalk {
namespace {

// The first bounce carries the windows and lamps, and is gathered with more rays than the later, smoother ones.
constexpr int kLater = 3;
int rays_of_bounce(int samples, int bounce) {
  return bounce == 1 ? IrradianceCache::kFirstGather * samples : bounce == 2 ? samples : std::max(samples / 2, 1);
}

using Values = LightGather::Values;

void add(Values& to, const Values& values) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += values[k];
}

}  // namespace

IrradianceCache::IrradianceCache(const CachePoints& points, LightGather& gather, const LightOptions& options,
                                 const LightRefinement& refinement, Progress& progress, std::vector<CachedLight> kept)
    : points_(points) {
  if (!kept.empty() && kept.size() == points_.size()) {
    indirect_ = std::move(kept);
    return;
  }
  const int bounces = std::max(options.bounces, 0);
  progress.begin("light cache", points_.size() * static_cast<std::uint64_t>(bounces == 0 ? 1 : 2 + bounces), "points");

  // The series of bounces: each gathers what the one before has added.
  Values emitted, last;
  gather.reflected(refinement.direct, rays_of_bounce(options.samples, 1), 1, last, &emitted, &refinement.rays);
  indirect_ = emitted;
  if (bounces > 0) {
    add(indirect_, last);
    add(last, emitted);
    for (int bounce = 2; bounce <= bounces; ++bounce) {
      Values next;
      gather.reflected(last, rays_of_bounce(options.samples, bounce), bounce, next);
      last = std::move(next);
      add(indirect_, last);
    }
    // All that the bounces beyond add is one gathering more: of the last one and of what becomes of it.
    const std::vector<glm::vec3> beyond = gather.reflected_for_ever(last, rays_of_bounce(options.samples, kLater));
    for (std::size_t k = 0; k < last.size(); ++k) last[k].lux += beyond[k];
    Values rest;
    gather.reflected(last, rays_of_bounce(options.samples, bounces + 1), bounces + 1, rest);
    add(indirect_, rest);
  }
  indirect_ = gather.smooth(indirect_);
}

}  // namespace probewalk
