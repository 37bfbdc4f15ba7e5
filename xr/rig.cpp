#include "xr/rig.h"

#include <cmath>
#include <numbers>

namespace probewalk {
namespace {

const glm::dvec3 kUp(0, 1, 0);

}  // namespace

glm::dvec3 Rig::world_from_rig(glm::dvec3 point_m) const {
  return position_m + glm::angleAxis(yaw_rad, kUp) * (point_m * scale);
}

glm::dquat Rig::world_from_rig(const glm::dquat& orientation) const {
  return glm::normalize(glm::angleAxis(yaw_rad, kUp) * orientation);
}

glm::dvec3 Rig::world_from_rig_direction(glm::dvec3 direction) const {
  return glm::angleAxis(yaw_rad, kUp) * direction;
}

Rig Rig::with_head_over(glm::dvec2 at, glm::dvec3 head_m) const {
  Rig rig = *this;
  const glm::dvec3 now = world_from_rig(head_m);
  rig.position_m += glm::dvec3(at.x - now.x, 0, at.y - now.z);
  return rig;
}

Rig Rig::turned_about(glm::dvec3 head_m, double angle_rad) const {
  Rig rig = *this;
  rig.yaw_rad = std::remainder(yaw_rad + angle_rad, 2.0 * std::numbers::pi);
  const glm::dvec3 head = world_from_rig(head_m);
  rig.position_m += head - rig.world_from_rig(head_m);
  return rig;
}

}  // namespace probewalk
