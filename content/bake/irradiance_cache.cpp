#include "content/bake/irradiance_cache.h"

#include <algorithm>
#include <utility>

#include "content/bake/point_sets.h"

namespace probewalk {
namespace {

// The first bounce carries the windows and lamps, and is gathered with more rays than the later, smoother ones.
int rays_of_bounce(int samples, int bounce) {
  return bounce == 1 ? IrradianceCache::kFirstGather * samples : bounce == 2 ? samples : std::max(samples / 2, 1);
}
constexpr float kMaxTailRatio = 0.95f;

using Values = LightGather::Values;

// Of each set, at its first point.
std::vector<glm::dvec3> totals(const Values& values, PointSets& sets) {
  std::vector<glm::dvec3> sums(values.size(), glm::dvec3(0.0));
  for (std::size_t k = 0; k < values.size(); ++k) sums[sets.first_of(std::uint32_t(k))] += glm::dvec3(values[k].lux);
  return sums;
}

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
  progress.begin("light cache", points_.size() * static_cast<std::uint64_t>(1 + bounces), "points");

  // The series of bounces: each gathers what the one before has added.
  Values emitted, last;
  gather.reflected(refinement.direct, rays_of_bounce(options.samples, 1), 1, last, &emitted, nullptr,
                   &refinement.times_rays);
  indirect_ = emitted;
  if (bounces == 0) {
    indirect_ = gather.smooth(indirect_);
    return;
  }
  add(indirect_, last);
  add(last, emitted);
  Values before = last;
  PointSets sets(points_.size());
  for (int bounce = 2; bounce <= bounces + 1; ++bounce) {
    const bool is_last = bounce == bounces + 1;
    if (is_last) before = last;
    Values next;
    gather.reflected(last, rays_of_bounce(options.samples, bounce), bounce, next, nullptr, is_last ? &sets : nullptr);
    last = std::move(next);
    if (!is_last) add(indirect_, last);
  }
  // What the bounces beyond would add, each a constant share of the one before: of its own in every part of the scene
  // that no light leaves. A white room is not darker for a black one beside it, and stays as it is when that is
  // painted.
  const std::vector<glm::dvec3> totals_before = totals(before, sets), totals_now = totals(last, sets);
  for (std::size_t k = 0; k < indirect_.size(); ++k) {
    const std::uint32_t part = sets.first_of(std::uint32_t(k));
    for (int c = 0; c < 3; ++c) {
      const double was = totals_before[part][c], is = totals_now[part][c];
      const float ratio = was > 0.0 ? std::min(static_cast<float>(is / was), kMaxTailRatio) : 0.0f;
      indirect_[k].lux[c] += last[k].lux[c] * (1.0f / (1.0f - ratio));
      indirect_[k].turn[c] += last[k].turn[c] * (1.0f / (1.0f - ratio));
    }
  }
  indirect_ = gather.smooth(indirect_);
}

}  // namespace probewalk
