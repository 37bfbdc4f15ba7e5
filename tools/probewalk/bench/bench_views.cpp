#include "tools/probewalk/bench/bench_views.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "render/view.h"
#include "shaders/shared/view_ray.h"
#include "xr/path.h"

namespace probewalk::bench {
namespace {

constexpr double kStandingStill_m = 1.0;  // a shorter tour has no views of its own to offer

}  // namespace

std::vector<NamedPose> bench_poses(const Manifest& manifest, const BenchOptions& options) {
  if (!options.poses.empty()) return read_named_poses(options.poses);
  const Path tour = path_of_tour(manifest.tour);
  double length_m = 0.0;
  for (std::size_t k = 1; k < manifest.tour.size(); ++k) {
    length_m += glm::length(manifest.tour[k].position_m - manifest.tour[k - 1].position_m);
  }
  std::vector<NamedPose> poses;
  for (int k = 0; k < options.views; ++k) {
    const PathPose at = tour.at(tour.duration_s() * (k + 0.5) / options.views);
    Pose pose = pose_of(at.position_m, at.orientation);
    if (length_m < kStandingStill_m) pose.yaw_rad += 2.0 * std::numbers::pi * k / options.views;
    poses.push_back({fmt::format("tour-{}", k + 1), pose});
  }
  return poses;
}

double fov_at_density(int height_px, double pixels_per_degree) {
  // A pixel at the centre of a flat picture spans atan(2 tan(fov / 2) / height).
  return 2.0 * std::atan(0.5 * height_px * std::tan(std::numbers::pi / 180.0 / pixels_per_degree));
}

double density_of(const RaySize& size) {
  const double pixel_rad = std::atan(2.0 * std::tan(0.5 * size.vertical_fov_rad) / size.height_px);
  return std::numbers::pi / 180.0 / pixel_rad;
}

ViewRays rays_of(const std::vector<NamedPose>& poses, const RaySize& size) {
  ViewRays result{size, {}, {}, 0.0f};
  const ViewFov fov = symmetric_fov(size.vertical_fov_rad, size.width_px, size.height_px);
  for (const NamedPose& named : poses) {
    const Pose& pose = named.pose;
    const ViewConstants view =
        view_constants(pose.position_m, orientation_of(pose.yaw_rad, pose.pitch_rad), fov, size.width_px);
    result.views.push_back(view);
    result.spread_rad = view.pixel_angle_rad;
    for (int y = 0; y < size.height_px; ++y) {
      for (int x = 0; x < size.width_px; ++x) {
        const glm::vec3 direction = view_ray(view, {x, y}, {size.width_px, size.height_px});
        result.rays.push_back({pose.position_m, glm::dvec3(direction)});
      }
    }
  }
  return result;
}

glm::vec3 device_direction(const WorldRay& ray) { return glm::vec3(glm::normalize(ray.direction)); }

}  // namespace probewalk::bench
