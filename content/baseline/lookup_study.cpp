#include "content/baseline/lookup_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "content/bake/bake_probe.h"
#include "content/baseline/baseline_f32.h"
#include "content/baseline/host_tracer.h"
#include "content/baseline/probe_ordering.h"
#include "content/error.h"
#include "content/probe/host_address.h"
#include "content/probe/tracer_f32.h"

namespace probewalk {
namespace {

constexpr int kRadianceSide = 8;
// Of a ray's filter, which nothing here looks at.
constexpr float kSpread_rad = 1e-3f;

std::vector<BaselineRecord> records_in_memory(const BaselineMaps& maps) {
  std::vector<BaselineRecord> records;
  for (const BaselineMap& map : maps.probes) {
    records.push_back(map.record);
    records.back().distance_address = host_address(map.distance_m.data());
    records.back().minimum_address = host_address(map.minimum_m.data());
    records.back().normal_address = host_address(map.normal.data());
  }
  return records;
}

// Geometry with black light: only look-ups are counted.
DeviceProbe geometry_probe(const RayScene& rays, glm::dvec3 position_m, int side) {
  ProbeMap map{bake_geometry(rays, position_m, side), {}};
  map.radiance.r = kRadianceSide;
  map.radiance.rgb9e5.assign(mip_chain_texels(kRadianceSide), 0);
  map.radiance.texel_w.assign(static_cast<std::size_t>(kRadianceSide) * kRadianceSide, 0);
  return build_device_probe(map);
}

double radical_inverse(unsigned k, unsigned base) {
  double value = 0.0, digit = 1.0 / base;
  for (; k > 0; k /= base, digit /= base) value += digit * (k % base);
  return value;
}

// Most of what a point in a solid sees is the back of its surface.
bool in_solid(const RayScene& rays, glm::dvec3 point_m) {
  constexpr int kDirections = 26;
  int backs = 0;
  for (int k = 0; k < kDirections; ++k) {
    const glm::vec3 d(spread_direction(k, kDirections));
    const SurfaceHit hit = rays.closest(glm::vec3(point_m), d);
    backs += hit.hit && glm::dot(hit.geometric_normal, d) > 0.0f ? 1 : 0;
  }
  return 2 * backs > kDirections;
}

bool sees(const RayScene& rays, glm::dvec3 a, glm::dvec3 b) {
  return !rays.occluded(glm::vec3(a), glm::vec3(b - a), 0.0f, 1.0f);
}

struct WalkResult {
  int cls;
  unsigned lookups;
  float t, t_safe;
};

// One walk by any method; id: of the probe among the records of the context.
WalkResult walk_once(const TracerChoice& choice, const BaselineContext& context, const ProbeRecord& probe, int id,
                     glm::vec3 x, glm::vec3 d, float t_start, int failures, int start_level) {
  if (choice.is_baseline()) {
    const auto state = baseline_f32::walk_baseline(context, probe, id, x, d, t_start, failures);
    return {state.status, state.lookups, state.t, state.t_safe};
  }
  const auto state = f32::walk_probe(probe, x, d, t_start, start_level);
  const bool answered = state.status == kClassHit || state.status == kClassMiss;
  return {answered ? state.status : kClassUnknown, state.lookups, state.t, state.t_safe};
}

glm::vec3 relative_to(const ProbeRecord& probe, glm::dvec3 point_m) {
  return glm::vec3(point_m - (glm::dvec3(probe.position_hi_m) + glm::dvec3(probe.position_lo_m)));
}

void stop_if_asked(const Progress& progress) {
  if (progress.cancelled()) throw Interrupted("interrupted while counting look-ups; no figure was written");
}

}  // namespace

StudyScene::StudyScene(Scene scene) : scene_(std::move(scene)), rays_(std::make_unique<RayScene>(scene_)) {}

std::vector<StudyRay> rays_seen_by(const StudyScene& scene, std::span<const glm::dvec3> probes_m, int count) {
  const glm::dvec3 low = scene.bounds().lower_m, size = scene.bounds().upper_m - low;
  std::vector<StudyRay> rays;
  const unsigned most = 1000u * static_cast<unsigned>(count);
  for (unsigned k = 1; static_cast<int>(rays.size()) < count; ++k) {
    if (k > most) throw BadInput("no point of the scene is seen by its probes; their places are wrong");
    const glm::dvec3 part(radical_inverse(k, 2), radical_inverse(k, 3), radical_inverse(k, 5));
    const glm::dvec3 origin_m = low + size * part;
    if (std::none_of(probes_m.begin(), probes_m.end(), [&](glm::dvec3 p) { return sees(scene.rays(), p, origin_m); }))
      continue;
    const double z = 1.0 - 2.0 * radical_inverse(k, 7), angle = 2.0 * std::numbers::pi * radical_inverse(k, 11);
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    rays.push_back({origin_m, {r * std::cos(angle), r * std::sin(angle), z}});
  }
  return rays;
}

double displacement_angle_rad(const StudyRay& ray, glm::dvec3 probe_m) {
  const glm::dvec3 away = ray.origin_m - probe_m;
  return std::atan2(glm::length(glm::cross(away, ray.direction)), glm::dot(away, ray.direction));
}

OneProbe::OneProbe(const StudyScene& scene, glm::dvec3 position_m, int side, Progress& progress)
    : position_m_(position_m), probe_(geometry_probe(scene.rays(), position_m, side)) {
  stop_if_asked(progress);
  maps_ = make_baseline_maps(scene.rays(), std::span(&position_m_, 1), side, progress);
}

Walk OneProbe::walk(const TracerChoice& choice, const StudyRay& ray, std::optional<int> start_level) const {
  const std::vector<BaselineRecord> records = records_in_memory(maps_);
  BaselineContext context = baseline_context(choice, &maps_);
  context.constants.records_address = host_address(records.data());
  const ProbeRecord probe = record_in_memory(probe_);
  const WalkResult result = walk_once(choice, context, probe, 0, relative_to(probe, ray.origin_m),
                                      glm::vec3(ray.direction), 0.0f, 0, start_level.value_or(choice.start_level()));
  return {result.cls, result.lookups, static_cast<double>(result.t)};
}

ProbeLattice lattice_in(const StudyScene& scene, int per_axis) {
  const glm::dvec3 low = scene.bounds().lower_m, size = scene.bounds().upper_m - low;
  ProbeLattice lattice;
  lattice.grid.spacing_m = size / static_cast<double>(per_axis);
  lattice.grid.origin_m = low + 0.5 * lattice.grid.spacing_m;
  lattice.grid.dims = glm::ivec3(per_axis);
  std::vector<glm::dvec3> points_m;
  for (int k = 0; k < per_axis * per_axis * per_axis; ++k) {
    const glm::dvec3 at(k % per_axis, k / per_axis % per_axis, k / per_axis / per_axis);
    points_m.push_back(lattice.grid.origin_m + lattice.grid.spacing_m * at);
    if (!in_solid(scene.rays(), points_m.back())) lattice.positions_m.push_back(points_m.back());
  }
  if (lattice.positions_m.empty()) throw BadInput("the scene is solid at every point of a grid of probes");
  for (const glm::dvec3 point_m : points_m) {
    const auto nearest = std::min_element(lattice.positions_m.begin(), lattice.positions_m.end(), [&](auto a, auto b) {
      return glm::length(a - point_m) < glm::length(b - point_m);
    });
    lattice.grid.probe.push_back(static_cast<std::uint32_t>(nearest - lattice.positions_m.begin()));
  }
  return lattice;
}

namespace {

ProbeSet lattice_probes(const StudyScene& scene, const ProbeLattice& lattice, int side, Progress& progress) {
  progress.begin("probes", lattice.positions_m.size(), "probes");
  std::vector<DeviceProbe> probes;
  for (const glm::dvec3 position_m : lattice.positions_m) {
    stop_if_asked(progress);
    probes.push_back(geometry_probe(scene.rays(), position_m, side));
    progress.advance(1);
  }
  return ProbeSet(std::move(probes), lattice.grid);
}

// Sums, turned into means at the end.
class Tally {
 public:
  void add(const StudyRay& ray, std::span<const glm::dvec3> positions_m, int cls, int probe, unsigned lookups,
           unsigned tries) {
    ++rays_;
    count_.lookups_mean += lookups;
    count_.one_lookup_share += lookups == 1 ? 1 : 0;
    if (cls == kClassUnknown) {
      count_.unknown_share += 1;
    } else {
      ++answered_;
      count_.angle_mean_rad += displacement_angle_rad(ray, positions_m[static_cast<std::size_t>(probe)]);
    }
    const std::size_t bin = std::min<std::size_t>(tries, count_.share_by_tries.size() - 1);
    count_.share_by_tries[bin] += 1;
    count_.lookups_by_tries[bin] += lookups;
  }
  ManyProbes::Count means() const {
    ManyProbes::Count count = count_;
    const double rays = std::max<double>(1, rays_);
    for (std::size_t k = 0; k < count.share_by_tries.size(); ++k) {
      if (count.share_by_tries[k] > 0) count.lookups_by_tries[k] /= count.share_by_tries[k];
      count.share_by_tries[k] /= rays;
    }
    count.lookups_mean /= rays;
    count.one_lookup_share /= rays;
    count.unknown_share /= rays;
    count.angle_mean_rad /= std::max(1, answered_);
    return count;
  }

 private:
  ManyProbes::Count count_;
  int rays_ = 0, answered_ = 0;
};

}  // namespace

ManyProbes::ManyProbes(const StudyScene& scene, const ProbeLattice& lattice, int side, Progress& progress)
    : scene_(scene),
      positions_m_(lattice.positions_m),
      probes_(lattice_probes(scene, lattice, side, progress)),
      maps_(make_baseline_maps(scene.rays(), lattice.positions_m, side, progress)) {}

ManyProbes::Count ManyProbes::by_cell(const TracerChoice& choice, std::span<const StudyRay> rays) const {
  const HostTracer tracer(probes_, default_dials(1.0), choice, &maps_);
  Tally tally;
  for (const StudyRay& ray : rays) {
    const BatchAnswer answer = tracer.trace(ray.origin_m, ray.direction, kSpread_rad);
    tally.add(ray, positions_m_, static_cast<int>(answer.answer), answer.probe, answer.lookups, answer.tries);
  }
  return tally.means();
}

ManyProbes::Count ManyProbes::by_best_of_all(const TracerChoice& choice, std::span<const StudyRay> rays) const {
  constexpr std::size_t kMostTries = 8;
  const std::vector<BaselineRecord> records = records_in_memory(maps_);
  BaselineContext context = baseline_context(choice, &maps_);
  context.constants.records_address = host_address(records.data());
  Tally tally;
  std::vector<std::pair<double, int>> candidates;
  for (const StudyRay& ray : rays) {
    candidates.clear();
    for (std::size_t k = 0; k < positions_m_.size(); ++k) {
      if (!sees(scene_.rays(), positions_m_[k], ray.origin_m)) continue;
      candidates.emplace_back(displacement_angle_rad(ray, positions_m_[k]), static_cast<int>(k));
    }
    const std::size_t tries = std::min(kMostTries, candidates.size());
    std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(tries), candidates.end());
    unsigned lookups = 0, walks = 0;
    float t = 0.0f;
    WalkResult result{kClassUnknown, 0, 0.0f, 0.0f};
    int probe = -1;
    for (std::size_t k = 0; k < tries && result.cls == kClassUnknown; ++k) {
      probe = candidates[k].second;
      const ProbeRecord& record = probes_.records()[static_cast<std::size_t>(probe)];
      result = walk_once(choice, context, record, probe, relative_to(record, ray.origin_m), glm::vec3(ray.direction), t,
                         static_cast<int>(walks), choice.start_level());
      lookups += result.lookups;
      ++walks;
      t = std::max(t, result.t_safe);
    }
    tally.add(ray, positions_m_, result.cls, probe, lookups, walks);
  }
  return tally.means();
}

}  // namespace probewalk
