#include "tools/probewalk/bench/errors.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "content/probe/tracer_f64.h"
#include "tools/probewalk/bench/statistics.h"

namespace probewalk::bench {
namespace {

// How far a ray may be moved to call a jump of the answer a tie: what the rounding of its origin and of its direction
// comes to, relative to the distance.
constexpr double kTie = 2e-6;
constexpr int kTieRays = 24;

bool is_number(const BatchAnswer& answer) {
  return std::isfinite(answer.t_m) && std::isfinite(answer.radiance.x + answer.radiance.y + answer.radiance.z);
}

bool same(const ExactAnswer& exact, int cls, double t_m) {
  return exact.cls == cls && (cls == kClassMiss || std::abs(t_m - exact.t_m) <= kSameDistance * std::max(exact.t_m, 1e-3));
}

// Directions spread over the sphere (Fibonacci's lattice).
glm::dvec3 spread_direction(int k, int n) {
  const double y = 1.0 - 2.0 * (k + 0.5) / n, r = std::sqrt(1.0 - y * y), angle = 2.399963229728653 * k;
  return {r * std::cos(angle), y, r * std::sin(angle)};
}

}  // namespace

void fill_counts(BenchRow& row, std::span<const BatchAnswer> answers) {
  std::vector<float> lookups;
  lookups.reserve(answers.size());
  double sum = 0.0, reads = 0.0, tries = 0.0;
  std::uint64_t holes = 0;
  for (const BatchAnswer& answer : answers) {
    lookups.push_back(static_cast<float>(answer.lookups));
    sum += answer.lookups;
    reads += answer.attribute_reads;
    tries += answer.tries;
    holes += answer.answer == kClassUnknown;
    row.nan_count += !is_number(answer);
  }
  std::sort(lookups.begin(), lookups.end());
  const double n = static_cast<double>(answers.size());
  row.rays = answers.size();
  row.lookups_mean = sum / n;
  row.lookups_p99 = percentile_of_sorted(lookups, 0.99);
  row.attribute_reads_mean = reads / n;
  row.probes_mean = tries / n;
  row.hole_fraction = static_cast<double>(holes) / n;
}

void fill_hit_errors(BenchRow& row, std::span<const BatchAnswer> answers, std::span<const float> truth_m) {
  std::vector<float> errors;
  std::uint64_t wrong = 0;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const BatchAnswer& answer = answers[k];
    if (answer.answer == kClassUnknown) continue;
    const bool is_hit = answer.answer == kClassHit, should_hit = std::isfinite(truth_m[k]);
    if (is_hit && should_hit) {
      const float error = std::abs(answer.t_m - truth_m[k]) / std::max(truth_m[k], 1e-6f);
      if (std::isfinite(error)) errors.push_back(error);
      wrong += !(error <= static_cast<float>(kWrongDistance));
    } else {
      wrong += is_hit != should_hit;
    }
  }
  row.wrong_surface_fraction = static_cast<double>(wrong) / static_cast<double>(answers.size());
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  row.hit_error_p50 = percentile_of_sorted(errors, 0.50);
  row.hit_error_p95 = percentile_of_sorted(errors, 0.95);
  row.hit_error_p99 = percentile_of_sorted(errors, 0.99);
}

ExactAnswer DoubleWalker::trace(glm::dvec3 origin_m, glm::dvec3 direction) const {
  const f64::RayAnswer answer =
      f64::trace_ray(probes_.grid(), dials_, rules_, origin_m, glm::dvec3(0.0), direction, /*start_level=*/0);
  return {answer.cls, answer.t};
}

ExactAnswer DoubleWalker::trace(const WorldRay& ray) const { return trace(ray.origin_m, glm::dvec3(device_direction(ray))); }

std::vector<ExactAnswer> DoubleWalker::trace(std::span<const WorldRay> rays) const {
  std::vector<ExactAnswer> answers(rays.size());
  tbb::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t k) { answers[k] = trace(rays[k]); });
  return answers;
}

bool DoubleWalker::is_tie(const WorldRay& ray, const BatchAnswer& answer) const {
  const glm::dvec3 direction(device_direction(ray));
  const double t_m = static_cast<double>(answer.t_m);
  const double reach_m = answer.answer == kClassMiss ? 1.0 : std::max(1.0, t_m);
  for (int k = 0; k < kTieRays; ++k) {
    const glm::dvec3 beside = kTie * reach_m * spread_direction(k, kTieRays);
    const glm::dvec3 turned = kTie * spread_direction(k * 7 % kTieRays, kTieRays);
    if (same(trace(ray.origin_m + beside, direction + turned), answer.answer, t_m)) return true;
  }
  return false;
}

void fill_tracer_errors(BenchRow& row, std::span<const BatchAnswer> answers, std::span<const ExactAnswer> exact,
                        const DoubleWalker& walker, std::span<const WorldRay> rays) {
  std::vector<float> errors(answers.size(), -1.0f);  // negative: not a hit in both
  std::atomic<std::uint64_t> ties{0}, disagreements{0};
  tbb::parallel_for(std::size_t{0}, answers.size(), [&](std::size_t k) {
    const BatchAnswer& answer = answers[k];
    const double t_m = static_cast<double>(answer.t_m);
    if (!same(exact[k], answer.answer, t_m)) {
      if (walker.is_tie(rays[k], answer)) {
        ++ties;
        return;
      }
      ++disagreements;
    }
    if (answer.answer == kClassHit && exact[k].cls == kClassHit) {
      errors[k] = static_cast<float>(std::abs(t_m - exact[k].t_m) / std::max(exact[k].t_m, 1e-6));
    }
  });
  std::erase_if(errors, [](float e) { return e < 0.0f; });
  std::sort(errors.begin(), errors.end());
  row.tracer_ties = ties.load();
  row.tracer_disagreements = disagreements.load();
  row.tracer_reference = DoubleWalker::kName;
  if (errors.empty()) return;
  row.tracer_error_max = static_cast<double>(errors.back());
  row.tracer_error_p99 = percentile_of_sorted(errors, 0.99);
}

double PictureError::flip_mean() const {
  double sum = 0.0;
  for (const float value : flip) sum += static_cast<double>(value);
  return sum / static_cast<double>(flip.size());
}

PictureError picture_error(std::span<const BatchAnswer> answers, const ViewRays& rays,
                           const std::vector<ImageRgb8>& reference, float exposure_ev) {
  PictureError error;
  const std::size_t views = rays.views.size(), pixels = rays.per_view();
  error.shown.resize(views);
  error.flip.resize(views);
  error.maps.resize(views);
  const float density = static_cast<float>(density_of(rays.size));
  tbb::parallel_for(std::size_t{0}, views, [&](std::size_t view) {
    ImageRgbF picture{rays.size.width_px, rays.size.height_px, {}};
    for (const BatchAnswer& answer : answers.subspan(view * pixels, pixels)) {
      picture.rgb.push_back(is_number(answer) ? answer.radiance : glm::vec3(0.0f));
    }
    error.shown[view] = display_transform(picture, exposure_ev);
    error.flip[view] = flip_mean(reference[view], error.shown[view], density, &error.maps[view]);
  });
  error.psnr_db = psnr_db(side_by_side(reference), side_by_side(error.shown));
  error.worst = static_cast<std::size_t>(std::max_element(error.flip.begin(), error.flip.end()) - error.flip.begin());
  return error;
}

Identity identity_of(std::span<const BatchAnswer> a, std::span<const BatchAnswer> b) {
  Identity identity;
  std::uint64_t identical = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k].answer != b[k].answer) {
      ++identity.class_changes;
      continue;
    }
    identical += a[k].probe == b[k].probe && std::bit_cast<std::uint32_t>(a[k].t_m) == std::bit_cast<std::uint32_t>(b[k].t_m);
    if (a[k].answer != kClassHit) continue;
    const double change = std::abs(static_cast<double>(a[k].t_m) - static_cast<double>(b[k].t_m)) /
                          std::max(static_cast<double>(a[k].t_m), 1e-6);
    identity.worst_distance_change = std::max(identity.worst_distance_change, change);
    identity.distance_changes += change > 1e-5;
  }
  identity.identical_fraction = static_cast<double>(identical) / static_cast<double>(std::max<std::size_t>(a.size(), 1));
  return identity;
}

}  // namespace probewalk::bench
