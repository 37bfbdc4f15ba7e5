#include "content/bake/plan/view_error.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/image/image.h"
#include "content/probe/tracer_f32.h"

namespace probewalk {
namespace {

enum class Judgement : std::uint8_t { kRight, kWrong, kHole };

Judgement judge(const f32::RayAnswer& answer, float truth_m) {
  if (answer.cls == kClassUnknown) return Judgement::kHole;
  const bool should_hit = std::isfinite(truth_m);
  if ((answer.cls == kClassHit) != should_hit) return Judgement::kWrong;
  return !should_hit || std::abs(answer.t - truth_m) <= kWrongDistance * truth_m ? Judgement::kRight
                                                                                 : Judgement::kWrong;
}

bool is_seen_by_any(const ProbeView& probes, const RayScene& triangles, const EyeRay& ray) {
  // Nearly at the surface; of the sky, whether a probe near the eye sees out the same way says little: taken as seen.
  if (!std::isfinite(ray.truth_m)) return true;
  const glm::vec3 point = glm::vec3(ray.origin_m) + ray.direction * (ray.truth_m * 0.999f - 1e-3f);
  for (int k = 0; k < int(probes.grid.probe_count); ++k) {
    const glm::vec3 place = f32::pw_probe(probes.grid, k).position_hi_m;
    if (!triangles.occluded(place, point - place, 0.0f, 1.0f)) return true;
  }
  return false;
}

struct PatchError {
  double flip = 0.0, places = 0.0;
};

PatchError patch_error(const EyePatch& patch, const ProbeView& probes, float exposure_ev) {
  ImageRgbF should{kPatchSide_px, kPatchSide_px, patch.radiance}, is = should, places = should;
  const float spread_rad = float(std::numbers::pi / 180.0 / kPlanPixelsPerDegree);
  glm::vec3 hi, lo;
  split_position(patch.middle.origin_m, hi, lo);
  int misplaced = 0;
  for (int k = 0; k < kPatchSide_px * kPatchSide_px; ++k) {
    const glm::vec3 d = patch.direction(k % kPatchSide_px, k / kPatchSide_px);
    const f32::RayAnswer answer = f32::trace_ray(probes.grid, probes.dials, hi, lo, d, kStartLevel);
    unsigned reads = 0;
    is.rgb[k] = f32::ray_radiance(probes.grid, probes.dials, answer, hi, lo, d, spread_rad, reads);
    if (judge(answer, patch.truth_m[k]) == Judgement::kRight) continue;
    places.rgb[k] = is.rgb[k];
    ++misplaced;
  }
  const ImageRgb8 reference = display_transform(should, exposure_ev);
  constexpr float kDensity = float(kPlanPixelsPerDegree);
  const double flip = flip_mean(reference, display_transform(is, exposure_ev), kDensity);
  if (misplaced == 0) return {flip, 0.0};
  return {flip, flip_mean(reference, display_transform(places, exposure_ev), kDensity)};
}

}  // namespace

std::vector<RoomError> measure_error(const WalkerViews& views, const ProbeView& probes, const RayScene& triangles,
                                     float exposure_ev, std::size_t rooms, int only_room) {
  const auto wanted = [&](const EyeRay& ray) { return only_room < 0 || ray.room == std::uint32_t(only_room); };
  struct RayError {
    Judgement judgement = Judgement::kRight;
    bool unseen = false;
  };
  std::vector<RayError> rays(views.rays.size());
  tbb::parallel_for(std::size_t(0), rays.size(), [&](std::size_t k) {
    const EyeRay& ray = views.rays[k];
    if (!wanted(ray)) return;
    glm::vec3 hi, lo;
    split_position(ray.origin_m, hi, lo);
    rays[k].judgement =
        judge(f32::trace_ray(probes.grid, probes.dials, hi, lo, ray.direction, kStartLevel), ray.truth_m);
    rays[k].unseen = rays[k].judgement != Judgement::kRight && !is_seen_by_any(probes, triangles, ray);
  });
  std::vector<PatchError> patches(views.patches.size());
  tbb::parallel_for(std::size_t(0), patches.size(), [&](std::size_t k) {
    if (wanted(views.patches[k].middle)) patches[k] = patch_error(views.patches[k], probes, exposure_ev);
  });

  std::vector<RoomError> errors(rooms);
  std::vector<double> ray_count(rooms, 0.0), patch_count(rooms, 0.0);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    RoomError& error = errors[views.rays[k].room];
    if (!wanted(views.rays[k])) continue;
    ray_count[views.rays[k].room] += 1.0;
    error.wrong += rays[k].judgement == Judgement::kWrong;
    error.hole += rays[k].judgement == Judgement::kHole;
    error.unseen += rays[k].unseen;
  }
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const EyeRay& middle = views.patches[k].middle;
    if (!wanted(middle)) continue;
    patch_count[middle.room] += 1.0;
    errors[middle.room].flip += patches[k].flip;
    errors[middle.room].flip_deviation += patches[k].flip * patches[k].flip;
    errors[middle.room].flip_places += patches[k].places;
  }
  for (std::size_t room = 0; room < rooms; ++room) {
    RoomError& error = errors[room];
    error.measured = ray_count[room] > 0.0 && patch_count[room] > 0.0;
    if (!error.measured) continue;
    for (double* share : {&error.wrong, &error.hole, &error.unseen}) *share /= ray_count[room];
    for (double* mean : {&error.flip, &error.flip_places, &error.flip_deviation}) *mean /= patch_count[room];
    error.flip_deviation = std::sqrt(std::max(0.0, error.flip_deviation - error.flip * error.flip) / patch_count[room]);
    error.lost_deviation = std::sqrt(error.lost() * (1.0 - error.lost()) / ray_count[room]);
  }
  return errors;
}

RoomError mean_error(const std::vector<RoomError>& rooms, const std::vector<double>& share) {
  RoomError mean;
  double sum = 0.0;
  for (std::size_t room = 0; room < rooms.size(); ++room) {
    if (!rooms[room].measured) continue;
    sum += share[room];
    mean.flip += share[room] * rooms[room].flip;
    mean.flip_places += share[room] * rooms[room].flip_places;
    mean.wrong += share[room] * rooms[room].wrong;
    mean.hole += share[room] * rooms[room].hole;
    mean.unseen += share[room] * rooms[room].unseen;
    mean.flip_deviation += std::pow(share[room] * rooms[room].flip_deviation, 2.0);
    mean.lost_deviation += std::pow(share[room] * rooms[room].lost_deviation, 2.0);
  }
  if (!(sum > 0.0)) return mean;
  for (double* value : {&mean.flip, &mean.flip_places, &mean.wrong, &mean.hole, &mean.unseen}) *value /= sum;
  mean.flip_deviation = std::sqrt(mean.flip_deviation) / sum;
  mean.lost_deviation = std::sqrt(mean.lost_deviation) / sum;
  mean.measured = true;
  return mean;
}

}  // namespace probewalk
