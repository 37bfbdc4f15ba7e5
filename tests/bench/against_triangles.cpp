// A pack's rays against the triangles that it was baked from, on the host: from eyes along the tour, in all directions.
//   against_triangles PACK SCENE [RAYS]
// Prints one line a pack: shares of all rays that are wrong (a distance off by over 2 %, a hit for a miss, a miss for a
// hit) and that are holes (unknown), and the distance error of the rays that hit in both, relative.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "content/pack/pack_io.h"
#include "content/probe/probe_set.h"
#include "content/probe/tracer_f32.h"
#include "content/scene/ray_scene.h"
#include "support/low_discrepancy.h"
#include "xr/path.h"

namespace probewalk::bench {
namespace {

constexpr float kWrong = 0.02f;
constexpr double kSway_m = 0.25;  // how far heads are off the tour

enum class Outcome : std::uint8_t { kRight, kWrongDistance, kHitForMiss, kMissForHit, kHole };

struct Ray {
  Outcome outcome = Outcome::kRight;
  float error = -1.0f;  // relative; negative = not a hit in both
  std::uint32_t lookups = 0, tries = 0;
  bool is_nan = false;
};

Ray cast(const ProbeSet& probes, const TraceConstants& dials, const RayScene& triangles, const Path& tour, int k, int n) {
  test::Random random(static_cast<std::uint64_t>(k) + 1);
  const double at_s = tour.duration_s() * test::radical_inverse(static_cast<std::uint32_t>(k));
  const glm::dvec3 eye_m = tour.at(at_s).position_m + glm::dvec3(random(-kSway_m, kSway_m), random(-kSway_m, kSway_m), random(-kSway_m, kSway_m));
  // Directions in an order that has nothing to do with the places.
  const glm::vec3 direction(test::hammersley_direction(static_cast<int>(std::int64_t{k} * 7919 % n), n));
  const glm::vec3 origin_m(eye_m);
  const SurfaceHit expected = triangles.closest(origin_m, direction);
  const f32::RayAnswer answer = f32::trace_ray(probes.grid(), dials, origin_m, glm::vec3(0.0f), direction, kStartLevel);
  Ray ray;
  ray.lookups = answer.lookups;
  ray.tries = answer.tries;
  ray.is_nan = std::isnan(answer.t);
  if (answer.cls == kClassUnknown) {
    ray.outcome = Outcome::kHole;
  } else if (expected.hit != (answer.cls == kClassHit)) {
    ray.outcome = expected.hit ? Outcome::kMissForHit : Outcome::kHitForMiss;
  } else if (expected.hit) {
    ray.error = std::abs(answer.t - expected.t) / expected.t;
    if (ray.error > kWrong) ray.outcome = Outcome::kWrongDistance;
  }
  return ray;
}

void print(const std::string& name, std::vector<Ray>& rays) {
  std::size_t counts[5] = {}, nan = 0;
  double lookups = 0.0, tries = 0.0, answered_lookups = 0.0;
  std::vector<float> errors;
  for (const Ray& ray : rays) {
    ++counts[static_cast<int>(ray.outcome)];
    nan += ray.is_nan;
    lookups += ray.lookups;
    answered_lookups += ray.outcome == Outcome::kHole ? 0 : ray.lookups;
    tries += ray.tries;
    if (ray.error >= 0.0f) errors.push_back(ray.error);
  }
  const double n = static_cast<double>(rays.size());
  const auto share = [&](Outcome outcome) { return 100.0 * static_cast<double>(counts[static_cast<int>(outcome)]) / n; };
  std::sort(errors.begin(), errors.end());
  const auto rank = [&](double p) {
    return errors.empty() ? 0.0f : errors[static_cast<std::size_t>(p * static_cast<double>(errors.size() - 1))];
  };
  fmt::print("{}: {} rays, wrong {:.2f} % (distance {:.2f}, hit for miss {:.2f}, miss for hit {:.2f}), hole {:.2f} %, error "
             "p50 {:.1e} p95 {:.1e} p99 {:.1e}, look-ups {:.1f} ({:.1f} of rays with an answer), probes {:.2f}, NaN {}\n",
             name, rays.size(),
             share(Outcome::kWrongDistance) + share(Outcome::kHitForMiss) + share(Outcome::kMissForHit),
             share(Outcome::kWrongDistance), share(Outcome::kHitForMiss), share(Outcome::kMissForHit),
             share(Outcome::kHole), rank(0.5), rank(0.95), rank(0.99), lookups / n,
             answered_lookups / std::max(1.0, n - static_cast<double>(counts[static_cast<int>(Outcome::kHole)])), tries / n, nan);
}

void run(const std::filesystem::path& pack_folder, const std::filesystem::path& scene_file, int count) {
  const Pack pack = Pack::open(pack_folder);
  const Manifest& manifest = pack.manifest();
  SceneLoadOptions options;
  options.scale = manifest.scale;
  options.recentre = manifest.light && manifest.light->recentred;
  const Scene scene = load_scene(scene_file, options);
  const RayScene triangles(scene);
  const ProbeSet probes = ProbeSet::read(pack);
  const TraceConstants dials = default_dials(manifest.radiance_scale);
  const Path tour = path_of_tour(manifest.tour);
  std::vector<Ray> rays(static_cast<std::size_t>(count));
  tbb::parallel_for(0, count, [&](int k) { rays[static_cast<std::size_t>(k)] = cast(probes, dials, triangles, tour, k, count); });
  print(pack_folder.filename().string(), rays);
}

}  // namespace
}  // namespace probewalk::bench

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::fputs("against_triangles PACK SCENE [RAYS]\n", stderr);
    return 2;
  }
  try {
    probewalk::bench::run(argv[1], argv[2], argc > 3 ? std::stoi(argv[3]) : 1000000);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "against_triangles: %s\n", error.what());
    return 1;
  }
}
