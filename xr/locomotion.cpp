#include "xr/locomotion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace probewalk {
namespace {

constexpr double kHeightSmoothing_s = 0.1;
constexpr double kDeadZone = 0.15;  // of a stick that nobody touches
constexpr double kSnapAt = 0.7, kSnapAgainBelow = 0.4;
// A long pause does not become a long march.
constexpr int kMaxSteps = 200;

// What a stick means: nothing in its dead zone, from there on evenly up to 1.
double out_of_dead_zone(double value) {
  const double size = std::min(std::abs(value), 1.0);
  return size <= kDeadZone ? 0.0 : std::copysign((size - kDeadZone) / (1.0 - kDeadZone), value);
}

glm::dvec2 out_of_dead_zone(glm::dvec2 stick) {
  const double length = glm::length(stick);
  return length > kDeadZone ? stick / length * out_of_dead_zone(length) : glm::dvec2(0);
}

}  // namespace

Locomotion::Locomotion(const FloorMap& floor, const LocomotionOptions& options)
    : floor_(floor), options_(options), vignette_(options.vignette_clear_rad) {
  rig_.scale = options.world_scale;
}

void Locomotion::place(const Pose& anchor, const HeadPose& head, const RigFloor& rig_floor) {
  rig_floor_ = rig_floor;
  rig_.yaw_rad = anchor.yaw_rad - head.yaw_rad;
  glm::dvec3 foot_m = anchor.position_m - glm::dvec3(0, kEyeHeight_m, 0);
  // The highest floor below the eyes: a wearer may be tall, or crouch.
  const std::int32_t index = floor_.find(anchor.position_m - glm::dvec3(0, kStep_m + 0.1, 0));
  if (index >= 0) foot_m.y = floor_.nodes[static_cast<std::size_t>(index)].floor_m;
  const glm::dvec3 home_m = home_m_;
  stand_over(head, foot_m);
  // Whose space changes while they lean into a wall belong on the side they came from.
  if (placed_ && !can_stand(floor_, foot_m, 0.0)) home_m_ = home_m;
  placed_ = true;
}

void Locomotion::set_height() {
  rig_.position_m.y = smooth_floor_m_ - rig_floor_.y_m * rig_.scale;
}

void Locomotion::stand_over(const HeadPose& head, glm::dvec3 foot_m) {
  foot_m_ = home_m_ = foot_m;
  smooth_floor_m_ = foot_m.y;
  rig_ = rig_.with_head_over({foot_m.x, foot_m.z}, head.position_m);
  set_height();
}

Pose Locomotion::anchor(const HeadPose& head) const {
  Pose pose;
  const glm::dvec3 head_m = rig_.world_from_rig(head.position_m);
  pose.position_m = {head_m.x, foot_m_.y + kEyeHeight_m, head_m.z};
  pose.yaw_rad = rig_.yaw_rad + head.yaw_rad;
  return pose;
}

void Locomotion::advance(const HeadPose& head, const MoveInput& input, double dt_s) {
  if (const auto target_m = blink_.advance(dt_s)) {
    if (std::exchange(recentres_, false) && !rig_floor_.is_known) {
      rig_floor_.y_m = head.position_m.y - options_.eye_height_m;
    }
    stand_over(head, *target_m);
  }
  const double turned = turn(head, input.turn, dt_s), walked = walk(head, input, dt_s);
  vignette_.advance(std::max(turned, walked), dt_s);
  take_aim(head, input);
  if (input.recentre) recentre();
}

double Locomotion::turn(const HeadPose& head, double input, double dt_s) {
  if (options_.turn == TurnStyle::kSmooth) {
    const double rate = out_of_dead_zone(input);
    if (rate != 0.0) rig_ = rig_.turned_about(head.position_m, -rate * kTurnSpeed_rad_s * dt_s);
    return std::abs(rate);
  }
  if (options_.turn == TurnStyle::kSnap) {
    if (std::abs(input) < kSnapAgainBelow) snapped_ = false;
    if (std::abs(input) >= kSnapAt && !std::exchange(snapped_, true)) {
      rig_ = rig_.turned_about(head.position_m, -std::copysign(options_.snap_rad, input));
    }
  }
  return 0.0;
}

double Locomotion::walk(const HeadPose& head, const MoveInput& input, double dt_s) {
  // The head may have moved in its rig: the foot is under it.
  const glm::dvec3 head_m = rig_.world_from_rig(head.position_m);
  foot_m_.x = head_m.x;
  foot_m_.z = head_m.z;
  const glm::dvec3 before_m = foot_m_;
  const glm::dvec2 wish = out_of_dead_zone(input.wish);
  if (wish != glm::dvec2(0)) {
    const double yaw_rad = rig_.yaw_rad + head.yaw_rad;
    const glm::dvec2 forward(-std::sin(yaw_rad), -std::cos(yaw_rad));
    const glm::dvec2 right(std::cos(yaw_rad), -std::sin(yaw_rad));
    const glm::dvec2 move = (right * wish.x + forward * wish.y) * (input.speed_m_s * rig_.scale * dt_s);
    // Half a column at a time, so that no wall is stepped over.
    const double step_m = floor_.cell_m * 0.5;
    const double wanted = std::ceil(glm::length(move) / step_m);
    const int steps = static_cast<int>(std::min<double>(wanted, kMaxSteps));
    for (int i = 0; i < steps; ++i) step(move / wanted);
    rig_ = rig_.with_head_over({foot_m_.x, foot_m_.z}, head.position_m);
  }
  smooth_floor_m_ += (foot_m_.y - smooth_floor_m_) * (1.0 - std::exp(-dt_s / kHeightSmoothing_s));
  set_height();
  const double way_m = glm::length(glm::dvec2(foot_m_.x - before_m.x, foot_m_.z - before_m.z));
  return way_m > 0.0 && dt_s > 0.0 ? way_m / (kWalkSpeed_m_s * rig_.scale * dt_s) : 0.0;
}

void Locomotion::step(glm::dvec2 move) {
  if (floor_.nodes.empty()) {
    foot_m_ += glm::dvec3(move.x, 0, move.y);
    return;
  }
  const glm::dvec3 wanted = foot_m_ + glm::dvec3(move.x, 0, move.y);
  if (!options_.through_walls && !can_stand(floor_, foot_m_, 0.0) && can_stand(floor_, home_m_, 0.0)) {
    // A person who has leant into something comes back towards where they stood, and gets no further into it.
    const auto away_m = [&](glm::dvec3 at) { return glm::distance(glm::dvec2(at.x, at.z), {home_m_.x, home_m_.z}); };
    if (away_m(wanted) >= away_m(foot_m_)) return;
    foot_m_ = wanted;
    return;
  }
  // A body that already overlaps a wall (a teleport into a corner) is only held by its centre, so that it can leave.
  const double radius_m = can_stand(floor_, foot_m_) ? kBodyRadius_m : 0.0;
  // The whole move, else what slides along a wall.
  for (const glm::dvec2 part : {move, glm::dvec2(move.x, 0), glm::dvec2(0, move.y)}) {
    const glm::dvec3 there = foot_m_ + glm::dvec3(part.x, 0, part.y);
    const bool stands = can_stand(floor_, there, radius_m);
    if (part == glm::dvec2(0) || !(stands || options_.through_walls)) continue;
    foot_m_ = there;
    foot_m_.y = floor_height_m(floor_, there).value_or(there.y);
    if (stands) home_m_ = foot_m_;
    return;
  }
}

void Locomotion::take_aim(const HeadPose& head, const MoveInput& input) {
  aim_.reset();
  if (!input.aim) return;
  const AimRay& ray = *input.aim;
  const double length = glm::length(ray.direction);
  if (!(length > 0.0) || !std::isfinite(length)) return;
  const glm::dvec3 hand_m = rig_.world_from_rig(ray.origin_m);
  const glm::dvec3 velocity = rig_.world_from_rig_direction(ray.direction / length) * (kThrowSpeed_m_s * rig_.scale);
  aim_ = arc_to_floor(floor_, hand_m, velocity, ray.straight ? 0.0 : kGravity_m_s2 * rig_.scale,
                      kTeleportReach_m * rig_.scale);
  // A hand held through a wall aims at nothing.
  if (!is_clear_way(floor_, rig_.world_from_rig(head.position_m), hand_m)) aim_->landing_m.reset();
  if (aim_->landing_m) aim_->landing_m = standing_near(floor_, *aim_->landing_m);
  if (!input.teleport) return;
  if (aim_->landing_m && blink_.start(*aim_->landing_m)) recentres_ = false;
  aim_.reset();
}

// Always obeyed: a person who has got into a wall or over furniture needs it most.
void Locomotion::recentre() {
  if (blink_.start(standing_near(floor_, home_m_))) recentres_ = true;
}

}  // namespace probewalk
