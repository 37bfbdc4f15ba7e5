#include "content/bake/irradiance_cache.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <utility>

#include "content/bake/patterns.h"
#include "content/bake/surface_point.h"
#include "content/error.h"

namespace probewalk {
namespace {

// The first bounce carries the windows and lamps, and is gathered with more rays than the later, smoother ones.
constexpr int kFirstGather = 2;
int rays_of_bounce(int samples, int bounce) {
  return bounce == 1 ? kFirstGather * samples : bounce == 2 ? samples : std::max(samples / 2, 1);
}
constexpr float kMaxTailRatio = 0.95f;

using Values = std::vector<CachedLight>;

// Points that light passes between, by the least of each set, whatever the order in which threads join them.
class PointSets {
 public:
  explicit PointSets(std::size_t count) : parents_(count) {
    for (std::size_t k = 0; k < count; ++k) parents_[k].store(std::uint32_t(k), std::memory_order_relaxed);
  }
  std::uint32_t first_of(std::uint32_t point) {
    for (;;) {
      std::uint32_t parent = parents_[point].load(std::memory_order_relaxed);
      if (parent == point) return point;
      const std::uint32_t above = parents_[parent].load(std::memory_order_relaxed);
      parents_[point].compare_exchange_weak(parent, above, std::memory_order_relaxed);  // halves the way
      point = above;
    }
  }
  void join(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = first_of(a);
      b = first_of(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      std::uint32_t expected = a;
      if (parents_[a].compare_exchange_weak(expected, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::vector<std::atomic<std::uint32_t>> parents_;
};

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

// Light that one set of values, reflected once, and optionally the emitters that are not sampled directly, send to
// every cache point.
struct IrradianceCache::Gather {
  const Scene& scene;
  const RayScene& rays;
  const DirectLight& direct;
  const CachePoints& points;
  std::uint32_t seed;
  Progress& progress;
  std::atomic<std::uint64_t> done{0};

  Values direct_light(std::uint64_t& cast) {
    Values values(points.size());
    std::atomic<std::uint64_t> all_cast{0};
    for_each_point([&](std::size_t k) {
      std::uint64_t own = 0;
      const CachePoints::Point& p = points[k];
      values[k].lux = direct.irradiance(p.position_m, p.geometric_normal, p.normal, own);
      all_cast += own;
    });
    cast += all_cast;
    return values;
  }

  // emitted receives what surfaces send by themselves; in sets points are joined that light passes between. Both may be
  // null.
  Values gather(const Values& source, int samples, std::uint32_t pass, Values* emitted, PointSets* sets,
                std::uint64_t& cast) {
    Values values(points.size());
    if (emitted) emitted->assign(points.size(), CachedLight());
    for_each_point([&](std::size_t k) {
      gather_point(k, source, samples, pass, values[k], emitted ? &(*emitted)[k] : nullptr, sets);
    });
    cast += points.size() * static_cast<std::uint64_t>(samples);
    return values;
  }

  // Each point the mean of its open neighbourhood: what few rays found (a patch of sun) must not show as a blotch.
  Values smooth(const Values& values) const {
    Values smoothed(points.size());
    tbb::parallel_for(std::size_t(0), points.size(),
                      [&](std::size_t k) { smoothed[k] = points.mean_around(values, k); });
    return smoothed;
  }

 private:
  template <typename Work>
  void for_each_point(Work&& work) {
    tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t k) {
      if (progress.cancelled()) return;
      work(k);
      if (++done % 1024 == 0) progress.advance(1024);
    });
    if (progress.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
  }

  void gather_point(std::size_t k, const Values& source, int samples, std::uint32_t pass, CachedLight& reflected,
                    CachedLight* emitted, PointSets* sets) const {
    const CachePoints::Point& point = points[k];
    glm::vec3 tangent, bitangent;
    tangent_frame(point.normal, tangent, bitangent);
    const glm::vec3 origin = point.position_m + point.geometric_normal * ray_offset_m(point.position_m);
    const std::uint32_t turn = mix_place(point.position_m, seed + pass);
    const float spread_rad = std::sqrt(std::numbers::pi_v<float> / static_cast<float>(samples));
    CachedLight sum, own;
    for (int s = 0; s < samples; ++s) {
      const glm::vec3 local = cosine_direction(rotate_pattern(hammersley(s, samples), turn));
      const glm::vec3 direction = tangent * local.x + bitangent * local.y + point.normal * local.z;
      if (glm::dot(direction, point.geometric_normal) <= 0.0f) continue;
      const SurfaceHit hit = rays.closest(origin, direction);
      if (!hit.hit) {
        if (emitted) own.add(scene.sky.radiance(direction), direction, point.normal);
        continue;
      }
      const SurfacePoint surface = surface_at(scene, hit, direction, hit.t * spread_rad);
      if (surface.unlit) continue;
      if (emitted && !direct.emitters().is_patch[hit.triangle]) {
        own.add(surface.emission_cd_m2, direction, point.normal);
      }
      sum.add(surface.albedo * points.interpolate_seen(source, surface.position_m, surface.normal), direction,
              point.normal);
      if (!sets) continue;
      points.for_each_seen(surface.position_m, surface.normal,
                           [&](std::uint32_t p) { sets->join(std::uint32_t(k), p); });
    }
    // Cosine-distributed: irradiance = pi * mean radiance; reflected radiance = albedo / pi * irradiance.
    reflected = sum * (1.0f / static_cast<float>(samples));
    if (emitted) *emitted = own * (std::numbers::pi_v<float> / static_cast<float>(samples));
  }
};

IrradianceCache::IrradianceCache(const Scene& scene, const RayScene& rays, const CachePoints& points,
                                 const DirectLight& direct, const LightOptions& options, Progress& progress,
                                 std::vector<CachedLight> kept)
    : points_(points) {
  if (!kept.empty() && kept.size() == points_.size()) {
    indirect_ = std::move(kept);
    return;
  }
  Gather gather{scene, rays, direct, points_, options.seed, progress};
  const int bounces = std::max(options.bounces, 0);
  progress.begin("light cache", points_.size() * static_cast<std::uint64_t>(2 + std::max(bounces, 1)), "points");

  const Values direct_values = gather.direct_light(rays_cast_);
  // The series of bounces: each gathers what the one before has added.
  Values emitted;
  Values last = gather.gather(direct_values, rays_of_bounce(options.samples, 1), 1, &emitted, nullptr, rays_cast_);
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
    last = gather.gather(last, rays_of_bounce(options.samples, bounce), bounce, nullptr, is_last ? &sets : nullptr,
                         rays_cast_);
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
