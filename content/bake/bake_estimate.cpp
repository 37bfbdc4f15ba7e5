#include "content/bake/bake_estimate.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>

#include "content/bake/patterns.h"
#include "content/bake/point_refinement.h"

namespace probewalk {
namespace {

constexpr int kTimedRays = 20000;
// Averages over furnished rooms: what a texel and a cache point cost, in incoherent rays, shading included.
constexpr double kRaysPerTexel = 12.0;
constexpr double kRaysPerVertex = 1.5;
constexpr double kRaysPerGather = 1.6;
// Guesses and bounces: garage 6.5, living-room 6.7, hotel-room 7.4. All but the first bounce are 2.2.
constexpr double kFirstGathersPerSample = 4.6, kOtherGathersPerSample = 2.2;
constexpr double kPointsPerSquare = 1.3;  // of the spacing, both sides
constexpr double kMostPoints = 300000.0;
// Times as many points with those that are closer: 1.65 in the house, 2.7 in living-room, 3.0 in hotel-room.
constexpr double kWithCloser = 2.4;
constexpr double kBytesPerTexel = 2.2;
constexpr double kBytesPerVertex = 1.1;

double seconds_per_ray(const RayScene& rays, glm::dvec3 position_m) {
  std::atomic<std::uint32_t> hits{0};
  const auto start = std::chrono::steady_clock::now();
  tbb::parallel_for(0, kTimedRays, [&](int k) {
    hits += rays.closest(glm::vec3(position_m), sphere_direction(hammersley(k, kTimedRays))).hit;
  });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / kTimedRays;
}

}  // namespace

BakeEstimate estimate_bake(const Scene& scene, const RayScene& rays, const LightOptions& light,
                           const std::vector<LevelSize>& levels, std::uint64_t probes, glm::dvec3 position_m) {
  BakeEstimate estimate;
  double rays_needed = 0.0, bytes = 0.0;
  for (const LevelSize& size : levels) {
    const double texels = double(probes) * size.radiance * size.radiance;
    const double vertices = double(probes) * size.geometry * size.geometry;
    estimate.texels += static_cast<std::uint64_t>(texels);
    rays_needed += kRaysPerTexel * texels + kRaysPerVertex * vertices;
    bytes += kBytesPerTexel * texels + kBytesPerVertex * vertices;
  }
  double area_m2 = 0.0;
  for (const glm::uvec3& t : scene.triangles) {
    const glm::vec3 a = scene.positions_m[t.x];
    area_m2 += 0.5 * glm::length(glm::cross(scene.positions_m[t.y] - a, scene.positions_m[t.z] - a));
  }
  const double points =
      kWithCloser * std::min(kPointsPerSquare * area_m2 / (light.cache_spacing_m * light.cache_spacing_m), kMostPoints);
  const double gathers = std::min(points * light.samples * kFirstGathersPerSample, kMostRays) +
                         points * light.samples * kOtherGathersPerSample;
  rays_needed += gathers * kRaysPerGather;
  estimate.seconds = rays_needed * seconds_per_ray(rays, position_m);
  estimate.bytes_disk = static_cast<std::uint64_t>(bytes);
  return estimate;
}

}  // namespace probewalk
