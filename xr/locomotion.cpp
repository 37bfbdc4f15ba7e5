#include "xr/locomotion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace probewalk {
namespace {

constexpr double kPitchLimit_rad = 85.0 * std::numbers::pi / 180.0;
constexpr double kHeightSmoothing_s = 0.1;

// The node of the column at (x, z) whose air holds height y, or null.
const FloorNode* air_at(const FloorMap& floor, glm::dvec3 point_m) {
  // A head under a ceiling is at most one headroom above its floor; `find` looks up to one step above its argument.
  const std::int32_t index = floor.find({point_m.x, point_m.y - kStep_m, point_m.z});
  if (index < 0) return nullptr;
  const FloorNode& node = floor.nodes[static_cast<std::size_t>(index)];
  return point_m.y <= static_cast<double>(node.floor_m + node.headroom_m) ? &node : nullptr;
}

}  // namespace

std::optional<double> floor_height_m(const FloorMap& floor, glm::dvec3 foot_m) {
  const std::int32_t index = floor.find(foot_m);
  if (index < 0) return std::nullopt;
  const double height_m = floor.nodes[static_cast<std::size_t>(index)].floor_m;
  if (height_m < foot_m.y - kStep_m) return std::nullopt;
  return height_m;
}

std::optional<glm::dvec3> floor_under_ray(const FloorMap& floor, glm::dvec3 origin_m, glm::dvec3 direction,
                                          double reach_m) {
  const double length = glm::length(direction);
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  const glm::dvec3 step = direction / length * (floor.cell_m * 0.5);
  const int steps = static_cast<int>(reach_m / (floor.cell_m * 0.5));
  glm::dvec3 point = origin_m;
  for (int i = 0; i < steps; ++i) {
    const glm::dvec3 next = point + step;
    if (air_at(floor, next) == nullptr) {
      // Left the air: through the floor of this column, which is the answer, or into something solid.
      const std::int32_t index = floor.find({next.x, next.y, next.z});
      if (index < 0) return std::nullopt;
      const double height_m = floor.nodes[static_cast<std::size_t>(index)].floor_m;
      if (direction.y >= 0.0 || height_m < next.y || height_m > point.y + kStep_m) return std::nullopt;
      return glm::dvec3(next.x, height_m, next.z);
    }
    point = next;
  }
  return std::nullopt;
}

bool is_clear_way(const FloorMap& floor, glm::dvec3 from_m, glm::dvec3 to_m) {
  if (floor.nodes.empty()) return true;
  const int steps = std::max(1, static_cast<int>(std::ceil(glm::length(to_m - from_m) / (floor.cell_m * 0.5))));
  for (int i = 0; i <= steps; ++i) {
    if (air_at(floor, from_m + (to_m - from_m) * (static_cast<double>(i) / steps)) == nullptr) return false;
  }
  return true;
}

void Blink::start(glm::dvec3 target_m) {
  if (phase_ != Phase::kNone) return;
  phase_ = Phase::kDown;
  elapsed_s_ = 0.0;
  target_m_ = target_m;
}

std::optional<glm::dvec3> Blink::advance(double dt_s) {
  if (phase_ == Phase::kNone) return std::nullopt;
  elapsed_s_ += dt_s;
  if (phase_ == Phase::kDown && elapsed_s_ >= kDown_s) {
    phase_ = Phase::kUp;
    elapsed_s_ = 0.0;
    return target_m_;
  }
  if (phase_ == Phase::kUp && elapsed_s_ >= kUp_s) phase_ = Phase::kNone;
  return std::nullopt;
}

float Blink::darkness() const {
  switch (phase_) {
    case Phase::kDown:
      return static_cast<float>(std::min(1.0, elapsed_s_ / kDown_s));
    case Phase::kUp:
      return static_cast<float>(std::max(0.0, 1.0 - elapsed_s_ / kUp_s));
    case Phase::kNone:
      break;
  }
  return 0.0f;
}

FloorWalker::FloorWalker(const FloorMap& floor, const Pose& start)
    : floor_(floor),
      foot_m_(start.position_m - glm::dvec3(0, kEyeHeight_m, 0)),
      eye_height_m_(kEyeHeight_m),
      smooth_floor_m_(foot_m_.y),
      yaw_rad_(start.yaw_rad),
      pitch_rad_(start.pitch_rad) {
  if (const auto height_m = floor_height_m(floor_, foot_m_)) {
    foot_m_.y = *height_m;
    eye_height_m_ = start.position_m.y - *height_m;
    smooth_floor_m_ = *height_m;
  }
}

void FloorWalker::look(double yaw_rad, double pitch_rad) {
  yaw_rad_ = std::remainder(yaw_rad_ + yaw_rad, 2.0 * std::numbers::pi);
  pitch_rad_ = std::clamp(pitch_rad_ + pitch_rad, -kPitchLimit_rad, kPitchLimit_rad);
}

bool FloorWalker::can_stand(glm::dvec2 at, double foot_m, double radius_m) const {
  const auto centre = floor_height_m(floor_, {at.x, foot_m, at.y});
  if (!centre) return false;
  if (radius_m <= 0.0) return true;
  for (int i = 0; i < 8; ++i) {
    const double angle = i * std::numbers::pi / 4;
    const glm::dvec3 rim(at.x + radius_m * std::cos(angle), *centre, at.y + radius_m * std::sin(angle));
    if (!floor_height_m(floor_, rim)) return false;
  }
  return true;
}

void FloorWalker::step(glm::dvec2 move) {
  if (floor_.nodes.empty()) {
    foot_m_ += glm::dvec3(move.x, 0, move.y);
    return;
  }
  const glm::dvec2 here(foot_m_.x, foot_m_.z);
  // A body that already overlaps a wall (a teleport into a corner) is only held by its centre, so that it can leave.
  const double radius_m = can_stand(here, foot_m_.y, kBodyRadius_m) ? kBodyRadius_m : 0.0;
  // The whole move, else what slides along a wall.
  for (const glm::dvec2 part : {move, glm::dvec2(move.x, 0), glm::dvec2(0, move.y)}) {
    if (part == glm::dvec2(0) || !can_stand(here + part, foot_m_.y, radius_m)) continue;
    foot_m_ = {here.x + part.x, foot_m_.y, here.y + part.y};
    foot_m_.y = *floor_height_m(floor_, foot_m_);
    return;
  }
}

void FloorWalker::advance(glm::dvec2 wish, double speed_m_s, double dt_s) {
  if (const auto target_m = blink_.advance(dt_s)) {
    foot_m_ = *target_m;
    smooth_floor_m_ = foot_m_.y;
  }
  const double length = glm::length(wish);
  if (length > 1.0) wish /= length;
  const glm::dvec2 forward(-std::sin(yaw_rad_), -std::cos(yaw_rad_));
  const glm::dvec2 right(std::cos(yaw_rad_), -std::sin(yaw_rad_));
  const glm::dvec2 move = (right * wish.x + forward * wish.y) * (speed_m_s * dt_s);
  // Half a column at a time, so that no wall is stepped over; a long pause does not become a long march.
  const int steps = std::clamp(static_cast<int>(std::ceil(glm::length(move) / (floor_.cell_m * 0.5))), 0, 200);
  for (int i = 0; i < steps; ++i) step(move / static_cast<double>(steps));
  smooth_floor_m_ += (foot_m_.y - smooth_floor_m_) * (1.0 - std::exp(-dt_s / kHeightSmoothing_s));
}

Pose FloorWalker::head() const {
  Pose pose;
  pose.position_m = {foot_m_.x, smooth_floor_m_ + eye_height_m_, foot_m_.z};
  pose.yaw_rad = yaw_rad_;
  pose.pitch_rad = pitch_rad_;
  return pose;
}

glm::dvec3 Rig::world_from_rig(glm::dvec3 point_m) const {
  return position_m + glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0)) * point_m;
}

glm::dquat Rig::world_from_rig(const glm::dquat& orientation) const {
  return glm::normalize(glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0)) * orientation);
}

Rig Rig::with_head_at(glm::dvec3 floor_m, double world_yaw_rad, glm::dvec3 head_m, double head_yaw_rad) {
  Rig rig;
  rig.yaw_rad = world_yaw_rad - head_yaw_rad;
  return rig.teleported(floor_m, head_m);
}

Rig Rig::teleported(glm::dvec3 floor_m, glm::dvec3 head_m) const {
  Rig rig = *this;
  rig.position_m = glm::dvec3(0);
  rig.position_m = floor_m - rig.world_from_rig(glm::dvec3(head_m.x, 0, head_m.z));
  return rig;
}

void WallFade::advance(bool head_free, double dt_s) {
  darkness_ = std::clamp(darkness_ + (head_free ? -dt_s : dt_s) / kFade_s, 0.0, 1.0);
}

}  // namespace probewalk
