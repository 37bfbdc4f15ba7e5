#include "content/bake/plan/coverage.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "content/bake/bake_probe.h"
#include "content/probe/tracer_f32.h"

namespace probewalk {
namespace {

// Maps of candidates are coarse; what is this near is the right surface all the same.
constexpr float kRightDistance = 0.05f;
constexpr double kNear_m = 8.0;
constexpr float kProgress_m = 1e-3f;
constexpr double kWorthOfProgress = 0.3;
constexpr float kFar_m = 20.0f;  // a ray into the sky counts as this long

float length_of(const EyeRay& ray) {
  return std::isfinite(ray.truth_m) ? ray.truth_m : kFar_m;
}

}  // namespace

Coverage::Coverage(const std::vector<EyeRay>& rays, const RayScene& triangles, std::size_t rooms, int map_side)
    : rays_(rays),
      triangles_(triangles),
      map_side_(map_side),
      states_(rays.size()),
      room_rays_(rooms, 0.0),
      unanswered_(rooms, 0.0) {
  for (const EyeRay& ray : rays) room_rays_[ray.room] += 1.0;
  count();
}

std::uint32_t Coverage::add_candidates(const std::vector<glm::dvec3>& places_m,
                                       const std::vector<std::uint32_t>& rooms) {
  const std::size_t first = candidates_.size();
  candidates_.resize(first + places_m.size());
  tbb::parallel_for(std::size_t(0), places_m.size(), [&](std::size_t k) {
    ProbeMap map;
    map.geometry = bake_geometry(triangles_, places_m[k], map_side_);
    candidates_[first + k] = {places_m[k], rooms[k], build_device_probe(map)};
  });
  for (std::size_t k = first; k < candidates_.size(); ++k) records_.push_back(record_in_memory(candidates_[k].map));
  return std::uint32_t(first);
}

bool Coverage::matters(const Candidate& candidate, const EyeRay& ray) const {
  if (candidate.room == ray.room) return true;
  if (glm::distance(candidate.position_m, ray.origin_m) < kNear_m) return true;
  return glm::distance(candidate.position_m, ray.origin_m + glm::dvec3(ray.direction) * double(length_of(ray))) <
         kNear_m;
}

Walk Coverage::walk(std::uint32_t candidate, const EyeRay& ray, float from_m) const {
  const glm::vec3 x(ray.origin_m - candidates_[candidate].position_m);
  const f32::WalkState state = f32::walk_probe(records_[candidate], x, ray.direction, from_m, kStartLevel);
  const bool should_hit = std::isfinite(ray.truth_m);
  Walk walk;
  if (state.status == kClassUnknown) {
    walk.free_m = std::clamp(state.t_safe, from_m, length_of(ray));
    return walk;
  }
  walk.right = (state.status == kClassHit) == should_hit &&
               (!should_hit || std::abs(state.t - ray.truth_m) <= kRightDistance * ray.truth_m);
  walk.wrong = !walk.right;
  walk.free_m = walk.right ? length_of(ray) : from_m;
  return walk;
}

double Coverage::gain(std::uint32_t candidate, const std::vector<double>& room_weight) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < rays_.size(); ++k) {
    const EyeRay& ray = rays_[k];
    const double weight = room_weight[ray.room];
    if (states_[k].done || !(weight > 0.0) || !matters(candidates_[candidate], ray)) continue;
    const Walk walked = walk(candidate, ray, states_[k].reach_m);
    const double rest = double(length_of(ray) - states_[k].reach_m);
    if (walked.right) {
      sum += weight;
    } else if (rest > 0.0) {
      sum += weight * kWorthOfProgress * double(walked.free_m - states_[k].reach_m) / rest;
    }
  }
  return sum;
}

bool Coverage::go_on(const EyeRay& ray, State& state, std::uint32_t candidate) const {
  if (state.done || !matters(candidates_[candidate], ray)) return false;
  const Walk walked = walk(candidate, ray, state.reach_m);
  state.done = walked.right;
  const bool further = walked.free_m > state.reach_m + kProgress_m;
  state.reach_m = std::max(state.reach_m, walked.free_m);
  return further;
}

void Coverage::go_on_with_all(const EyeRay& ray, State& state) const {
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds && !state.done; ++round) {
    bool further = false;
    for (const std::uint32_t candidate : chosen_) further |= go_on(ray, state, candidate);
    if (!further) return;
  }
}

void Coverage::choose(std::uint32_t candidate) {
  chosen_.push_back(candidate);
  tbb::parallel_for(std::size_t(0), rays_.size(), [&](std::size_t k) {
    if (go_on(rays_[k], states_[k], candidate)) go_on_with_all(rays_[k], states_[k]);
  });
  count();
}

void Coverage::reset(std::vector<std::uint32_t> chosen) {
  chosen_ = std::move(chosen);
  tbb::parallel_for(std::size_t(0), rays_.size(), [&](std::size_t k) {
    states_[k] = {};
    go_on_with_all(rays_[k], states_[k]);
  });
  count();
}

void Coverage::count() {
  std::fill(unanswered_.begin(), unanswered_.end(), 0.0);
  for (std::size_t k = 0; k < rays_.size(); ++k) unanswered_[rays_[k].room] += states_[k].done ? 0.0 : 1.0;
  for (std::size_t room = 0; room < unanswered_.size(); ++room) unanswered_[room] /= std::max(1.0, room_rays_[room]);
}

std::vector<glm::dvec3> Coverage::places_of_need(std::uint32_t room, std::size_t most) const {
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < rays_.size(); ++k) {
    if (rays_[k].room == room && !states_[k].done) open.push_back(k);
  }
  std::vector<glm::dvec3> places;
  const std::size_t count = std::min(most, open.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = open[(2 * i + 1) * open.size() / (2 * count)];
    const double reach = double(states_[k].reach_m), rest = double(length_of(rays_[k])) - reach;
    // Not far in, and in the middle of what is left where that is short.
    places.push_back(rays_[k].origin_m + glm::dvec3(rays_[k].direction) * (reach + std::min(0.5 * rest, 0.6)));
  }
  return places;
}

}  // namespace probewalk
