// A pack's rays against the triangles that it was baked from, on the host: from eyes along the tour, in all directions.
#pragma once

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "content/probe/probe_set.h"
#include "content/probe/tracer_f32.h"
#include "content/scene/ray_scene.h"
#include "support/low_discrepancy.h"
#include "xr/path.h"

namespace probewalk::bench {

inline constexpr float kWrong = 0.02f;
inline constexpr double kSway_m = 0.25;  // how far heads are off the tour

enum class Outcome : std::uint8_t { kRight, kWrongDistance, kHitForMiss, kMissForHit, kHole };

struct Ray {
  Outcome outcome = Outcome::kRight;
  float error = -1.0f;  // relative; negative = not a hit in both
  std::uint32_t lookups = 0, tries = 0;
  bool is_nan = false;
};

inline void judge(const f32::RayAnswer& answer, const SurfaceHit& expected, Ray& ray) {
  if (answer.cls == kClassUnknown) {
    ray.outcome = Outcome::kHole;
  } else if (expected.hit != (answer.cls == kClassHit)) {
    ray.outcome = expected.hit ? Outcome::kMissForHit : Outcome::kHitForMiss;
  } else if (expected.hit) {
    ray.error = std::abs(answer.t - expected.t) / expected.t;
    if (ray.error > kWrong) ray.outcome = Outcome::kWrongDistance;
  }
}

inline Ray cast(const ProbeSet& probes, const TraceConstants& dials, const RayScene& triangles, const Path& tour, int k,
                int n) {
  test::Random random(static_cast<std::uint64_t>(k) + 1);
  const double at_s = tour.duration_s() * test::radical_inverse(static_cast<std::uint32_t>(k));
  const glm::dvec3 eye_m = tour.at(at_s).position_m +
                           glm::dvec3(random(-kSway_m, kSway_m), random(-kSway_m, kSway_m), random(-kSway_m, kSway_m));
  // Directions in an order that has nothing to do with the places.
  const glm::vec3 direction(test::hammersley_direction(static_cast<int>(std::int64_t{k} * 7919 % n), n));
  const glm::vec3 origin_m(eye_m);
  const SurfaceHit expected = triangles.closest(origin_m, direction);
  const f32::RayAnswer answer = f32::trace_ray(probes.grid(), dials, origin_m, glm::vec3(0.0f), direction, kStartLevel);
  Ray ray;
  ray.lookups = answer.lookups;
  ray.tries = answer.tries;
  ray.is_nan = std::isnan(answer.t);
  judge(answer, expected, ray);
  return ray;
}

// Of all rays, shares in per cent.
struct RaySummary {
  std::size_t rays = 0, nan = 0;
  double distance = 0.0, hit_for_miss = 0.0, miss_for_hit = 0.0, hole = 0.0;
  float p50 = 0.0f, p95 = 0.0f, p99 = 0.0f;  // of the distance's relative error, of rays that hit in both
  double lookups = 0.0, answered_lookups = 0.0, tries = 0.0;  // a ray
  double wrong() const { return distance + hit_for_miss + miss_for_hit; }
};

inline RaySummary summarise(const std::vector<Ray>& rays) {
  std::size_t counts[5] = {};
  RaySummary sum;
  std::vector<float> errors;
  for (const Ray& ray : rays) {
    ++counts[static_cast<int>(ray.outcome)];
    sum.nan += ray.is_nan;
    sum.lookups += ray.lookups;
    sum.answered_lookups += ray.outcome == Outcome::kHole ? 0 : ray.lookups;
    sum.tries += ray.tries;
    if (ray.error >= 0.0f) errors.push_back(ray.error);
  }
  sum.rays = rays.size();
  const double n = static_cast<double>(rays.size());
  const auto share = [&](Outcome outcome) {
    return 100.0 * static_cast<double>(counts[static_cast<int>(outcome)]) / n;
  };
  sum.distance = share(Outcome::kWrongDistance);
  sum.hit_for_miss = share(Outcome::kHitForMiss);
  sum.miss_for_hit = share(Outcome::kMissForHit);
  sum.hole = share(Outcome::kHole);
  std::sort(errors.begin(), errors.end());
  const auto rank = [&](double p) {
    return errors.empty() ? 0.0f : errors[static_cast<std::size_t>(p * static_cast<double>(errors.size() - 1))];
  };
  sum.p50 = rank(0.5);
  sum.p95 = rank(0.95);
  sum.p99 = rank(0.99);
  sum.lookups /= n;
  sum.answered_lookups /= std::max(1.0, n - static_cast<double>(counts[static_cast<int>(Outcome::kHole)]));
  sum.tries /= n;
  return sum;
}

inline RaySummary cast_all(const ProbeSet& probes, const TraceConstants& dials, const RayScene& triangles,
                           const Path& tour, int count) {
  std::vector<Ray> rays(static_cast<std::size_t>(count));
  tbb::parallel_for(0, count,
                    [&](int k) { rays[static_cast<std::size_t>(k)] = cast(probes, dials, triangles, tour, k, count); });
  return summarise(rays);
}

}  // namespace probewalk::bench
