#include "xr/spectator_filter.h"

#include <cmath>

namespace probewalk {
namespace {

// What is left of a distance to the target, and its rate of change, after dt. Exact for a target at rest.
void follow(glm::dvec3& offset, glm::dvec3& rate_of_change, double rate, double dt_s) {
  const double decay = std::exp(-rate * dt_s);
  const glm::dvec3 push = (rate_of_change + rate * offset) * dt_s;
  rate_of_change = (rate_of_change - rate * push) * decay;
  offset = (offset + push) * decay;
}

// Axis times angle of a rotation, the short way round.
glm::dvec3 rotation_vector(glm::dquat q) {
  if (q.w < 0.0) q = -q;
  const glm::dvec3 axis(q.x, q.y, q.z);
  const double sine = glm::length(axis);
  return sine < 1e-12 ? 2.0 * axis : axis * (2.0 * std::atan2(sine, q.w) / sine);
}

glm::dquat rotation_by(const glm::dvec3& vector) {
  const double angle = glm::length(vector);
  return angle < 1e-12 ? glm::dquat(1.0, vector.x / 2, vector.y / 2, vector.z / 2)
                       : glm::angleAxis(angle, vector / angle);
}

}  // namespace

SpectatorFilter::Pose SpectatorFilter::next(const Pose& head, double dt_s) {
  if (!pose_ || glm::distance(head.position_m, head_.position_m) > kJump_m) {
    velocity_m_s_ = spin_rad_s_ = glm::dvec3(0.0);
    head_ = head;
    pose_ = head;
    return head;
  }
  head_ = head;
  glm::dvec3 offset_m = pose_->position_m - head.position_m;
  follow(offset_m, velocity_m_s_, rate_, dt_s);
  glm::dvec3 turn_rad = rotation_vector(pose_->orientation * glm::conjugate(head.orientation));
  follow(turn_rad, spin_rad_s_, rate_, dt_s);
  pose_ = Pose{head.position_m + offset_m, glm::normalize(rotation_by(turn_rad) * head.orientation)};
  return *pose_;
}

}  // namespace probewalk
