#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "content/scene/space/parts.h"
#include "content/scene/space/start_and_tour.h"

namespace probewalk {
namespace {

constexpr int kDirections = 72;

glm::dvec3 horizontal(double yaw_rad) { return {-std::sin(yaw_rad), 0.0, -std::cos(yaw_rad)}; }

// The horizontal direction with most to see: a wide view that ends at something, not a slit and not the void.
double widest_view_rad(const RayScene& rays, glm::dvec3 eye_m) {
  constexpr double kFar_m = 12.0;
  constexpr double kVoid_m = 3.0;
  std::vector<double> ahead_m(kDirections);
  for (int k = 0; k < kDirections; ++k) {
    const double yaw = 2.0 * std::numbers::pi * k / kDirections;
    const SurfaceHit hit = rays.closest(glm::vec3(eye_m), glm::vec3(horizontal(yaw)));
    ahead_m[k] = hit.hit ? std::min(kFar_m, double(hit.t)) : kVoid_m;
  }
  int best = 0;
  double most = -1.0;
  for (int k = 0; k < kDirections; ++k) {
    double view = ahead_m[k];
    for (int side = 1; side <= 4; ++side) {
      view += (ahead_m[(k + side) % kDirections] + ahead_m[(k + kDirections - side) % kDirections]) / (1.0 + side);
    }
    if (view > most + 1e-9) {
      most = view;
      best = k;
    }
  }
  return 2.0 * std::numbers::pi * best / kDirections;
}

std::int32_t widest_place_of_largest_room(const WalkGround& ground) {
  std::map<std::int32_t, std::size_t> size;
  for (const std::int32_t i : ground.places) ++size[ground.room[i]];
  const auto largest =
      std::max_element(size.begin(), size.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::int32_t widest = -1;
  for (const std::int32_t i : ground.places) {
    if (ground.room[i] != largest->first) continue;
    if (widest < 0 || ground.graph.places[i].wall_m > ground.graph.places[widest].wall_m) widest = i;
  }
  return widest;
}

struct Surroundings {
  double clearance_m = 0.0;
  double front = 0.0;  // share of what is seen that faces the eye
};

Surroundings look_from(const Scene& scene, const RayScene& rays, glm::dvec3 eye_m, double far_m) {
  Surroundings seen{far_m, 1.0};
  int hits = 0, fronts = 0;
  for (int k = 0; k < 26; ++k) {
    const int code = k < 13 ? k : k + 1;  // all neighbours of a cube but its middle
    const glm::vec3 direction = glm::normalize(glm::vec3(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1));
    const SurfaceHit hit = rays.closest(glm::vec3(eye_m), direction);
    if (!hit.hit) continue;
    ++hits;
    const bool double_sided = scene.materials[scene.triangle_material[hit.triangle]].double_sided;
    fronts += double_sided || glm::dot(hit.geometric_normal, direction) <= 0.0f;
    seen.clearance_m = std::min(seen.clearance_m, double(hit.t));
  }
  if (hits > 0) seen.front = double(fronts) / hits;
  return seen;
}

}  // namespace

double yaw_of(glm::dvec3 direction) { return std::atan2(-direction.x, -direction.z); }

Pose find_start(const RayScene& rays, const WalkGround& ground, const std::optional<glm::dvec3>& start_m) {
  const std::int32_t place =
      start_m ? nearest_place(ground.graph, ground.places, *start_m) : widest_place_of_largest_room(ground);
  Pose pose;
  pose.position_m = ground.graph.eye_m(place);
  if (start_m) {  // exactly there, where the column under it is the one found
    const glm::dvec2 off =
        glm::abs(glm::dvec2(start_m->x, start_m->z) - glm::dvec2(pose.position_m.x, pose.position_m.z));
    if (std::max(off.x, off.y) <= 0.5 * ground.graph.cell_m) {
      pose.position_m.x = start_m->x;
      pose.position_m.z = start_m->z;
    }
  }
  pose.yaw_rad = widest_view_rad(rays, pose.position_m);
  return pose;
}

Pose find_floorless_start(const Scene& scene, const RayScene& rays) {
  Pose pose;
  const Bounds& box = scene.bounds;
  if (!(box.lower_m.x <= box.upper_m.x && box.lower_m.y <= box.upper_m.y && box.lower_m.z <= box.upper_m.z)) {
    pose.position_m = {0.0, kEyeHeight_m, 0.0};
    return pose;
  }
  const glm::dvec3 extent = box.upper_m - box.lower_m;
  const double eye = std::min(kEyeHeight_m, 0.5 * extent.y) / std::max(extent.y, 1e-9);
  // The middle first, then outwards: a later candidate must be clearly better.
  double best = -1.0;
  for (const double fy : {eye, 0.5, 0.75, 0.9}) {
    for (const double fx : {0.5, 0.35, 0.65, 0.2, 0.8, 0.05, 0.95}) {
      for (const double fz : {0.5, 0.35, 0.65, 0.2, 0.8, 0.05, 0.95}) {
        const glm::dvec3 candidate = box.lower_m + extent * glm::dvec3(fx, fy, fz);
        const Surroundings seen = look_from(scene, rays, candidate, 0.5);
        const double worth = seen.clearance_m * seen.front * seen.front;
        if (worth <= best * 1.05 + 1e-6) continue;
        best = worth;
        pose.position_m = candidate;
      }
    }
  }
  pose.yaw_rad = widest_view_rad(rays, pose.position_m);
  return pose;
}

std::vector<Pose> look_around(const Pose& start) {
  constexpr int kPoses = 48;
  std::vector<Pose> tour(kPoses, start);
  for (int k = 0; k < kPoses; ++k) tour[k].yaw_rad += 2.0 * std::numbers::pi * k / kPoses;
  return tour;
}

}  // namespace probewalk
