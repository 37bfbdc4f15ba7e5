#include "content/bake/plan/walker_views.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "content/bake/patterns.h"
#include "content/bake/placement/probe_sites.h"
#include "content/error.h"

namespace probewalk {
namespace {

constexpr double kSteepest_rad = 75.0 * std::numbers::pi / 180.0;  // looked up and down, less often the steeper
constexpr double kLowestEye_m = 0.8, kSittingEye_m = 1.3, kTallestEye_m = 1.75;
constexpr double kStandingShare = 0.6;
constexpr double kHeadRadius_m = 0.1;
constexpr int kAttempts = 12;

double unit_random(std::uint32_t index, std::uint32_t seed) {
  return mix_bits(index, seed) * 0x1p-32;
}

class Sampler {
 public:
  Sampler(const Space& space, const HeadSpace& heads, const RayScene& triangles, std::uint32_t set)
      : space_(space), heads_(heads), triangles_(triangles), set_(set), nodes_(space.rooms.size()) {
    for (std::uint32_t k = 0; k < space.floor.nodes.size(); ++k) nodes_[space.floor.nodes[k].room].push_back(k);
  }

  bool has_eyes(std::size_t room) const { return !nodes_[room].empty() || (space_.floor.nodes.empty() && room == 0); }
  double share(std::size_t room) const {
    if (space_.floor.nodes.empty()) return room == 0 ? 1.0 : 0.0;
    return double(nodes_[room].size()) / double(space_.floor.nodes.size());
  }

  // The k-th of `count` views of a room, or of another stream of its views.
  EyeRay view(std::uint32_t room, std::uint32_t k, std::uint32_t count, std::uint32_t stream) const {
    EyeRay ray;
    ray.room = room;
    ray.origin_m = eye(room, k, count, stream);
    const std::uint32_t turn = mix_bits(room * 2 + stream, set_ * 977 + 5);
    const glm::vec2 uv = rotate_pattern(r2_sequence(k), turn);
    const double yaw = 2.0 * std::numbers::pi * uv.x;
    // Triangular over +- the steepest.
    const double v = uv.y, tent = v < 0.5 ? std::sqrt(2.0 * v) - 1.0 : 1.0 - std::sqrt(2.0 * (1.0 - v));
    const double pitch = kSteepest_rad * tent;
    ray.direction = glm::vec3(glm::normalize(
        glm::dvec3(-std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch))));
    return ray;
  }

 private:
  glm::dvec3 eye(std::uint32_t room, std::uint32_t k, std::uint32_t count, std::uint32_t stream) const {
    const std::uint32_t seed = mix_bits(room * 2 + stream, set_);
    glm::dvec3 at(0.0);
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const std::uint32_t draw = mix_bits(k, seed + std::uint32_t(attempt));
      at = space_.floor.nodes.empty() ? hovering(draw) : standing(room, k, count, attempt, seed, draw);
      if (clearance_m(triangles_, at, kHeadRadius_m) >= kHeadRadius_m) break;
    }
    return at;
  }

  glm::dvec3 standing(std::uint32_t room, std::uint32_t k, std::uint32_t count, int attempt, std::uint32_t seed,
                      std::uint32_t draw) const {
    const std::vector<std::uint32_t>& nodes = nodes_[room];
    // One eye a stretch of the floor's nodes, which run row by row; another place when it does not fit.
    const double part = attempt == 0 ? (k + unit_random(k, seed)) / count : unit_random(draw, 1);
    const FloorNode& node =
        space_.floor.nodes[nodes[std::min(nodes.size() - 1, std::size_t(part * double(nodes.size())))]];
    const double cell_m = space_.floor.cell_m;
    const double low = unit_random(draw, 4) < kStandingShare ? kSittingEye_m : kLowestEye_m;
    const double high = low == kSittingEye_m ? kTallestEye_m : kSittingEye_m;
    const double height = std::min(glm::mix(low, high, unit_random(draw, 5)), double(node.headroom_m) - 0.1);
    return {space_.floor.origin_m.x + (node.ix + unit_random(draw, 2)) * cell_m, double(node.floor_m) + height,
            space_.floor.origin_m.y + (node.iz + unit_random(draw, 3)) * cell_m};
  }

  // Without floor: on the way from the start to the places it sees.
  glm::dvec3 hovering(std::uint32_t draw) const {
    const glm::dvec3 from = heads_.eyes().front();
    const glm::dvec3 to = heads_.eyes()[draw % heads_.eyes().size()];
    return glm::mix(from, to, unit_random(draw, 2));
  }

  const Space& space_;
  const HeadSpace& heads_;
  const RayScene& triangles_;
  const std::uint32_t set_;
  std::vector<std::vector<std::uint32_t>> nodes_;  // by room
};

}  // namespace

glm::vec3 EyePatch::direction(int x, int y) const {
  const double pixel = std::tan(std::numbers::pi / 180.0 / kPlanPixelsPerDegree);
  const glm::dvec3 forward(middle.direction);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0.0, 1.0, 0.0)));
  const glm::dvec3 up = glm::cross(right, forward);
  const double u = (x + 0.5 - 0.5 * kPatchSide_px) * pixel, v = (0.5 * kPatchSide_px - y - 0.5) * pixel;
  return glm::vec3(glm::normalize(forward + right * u + up * v));
}

WalkerViews sample_views(const Space& space, const HeadSpace& heads, const RayScene& triangles, const LightField& light,
                         ViewCounts counts, std::uint32_t set, Progress& progress) {
  const Sampler sampler(space, heads, triangles, set);
  WalkerViews views;
  std::vector<std::uint32_t> rooms;
  for (std::uint32_t room = 0; room < space.rooms.size(); ++room) {
    views.room_share.push_back(sampler.share(room));
    if (sampler.has_eyes(room)) rooms.push_back(room);
  }
  const auto rays = std::size_t(counts.rays), patches = std::size_t(counts.patches);
  views.rays.resize(rooms.size() * rays);
  tbb::parallel_for(std::size_t(0), views.rays.size(), [&](std::size_t i) {
    EyeRay& ray = views.rays[i];
    ray = sampler.view(rooms[i / rays], std::uint32_t(i % rays), std::uint32_t(counts.rays), 0);
    ray.truth_m = triangles.closest(glm::vec3(ray.origin_m), ray.direction).t;
  });
  views.patches.resize(rooms.size() * patches);
  const float spread_rad = float(std::numbers::pi / 180.0 / kPlanPixelsPerDegree);
  tbb::parallel_for(std::size_t(0), views.patches.size(), [&](std::size_t i) {
    if (progress.cancelled()) return;
    EyePatch& patch = views.patches[i];
    patch.middle = sampler.view(rooms[i / patches], std::uint32_t(i % patches), std::uint32_t(counts.patches), 1);
    const glm::vec3 eye(patch.middle.origin_m);
    for (int y = 0; y < kPatchSide_px; ++y) {
      for (int x = 0; x < kPatchSide_px; ++x) {
        SurfaceHit hit;
        patch.radiance.push_back(light.along(eye, patch.direction(x, y), spread_rad, &hit));
        patch.truth_m.push_back(hit.t);
      }
    }
  });
  if (progress.cancelled()) throw Interrupted("interrupted while looking at the scene; what is finished is kept");
  return views;
}

}  // namespace probewalk
