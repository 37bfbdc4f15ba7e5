// world_from_rig: where the headset's space lies in the world, and how large it is there.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace probewalk {

// Nothing but locomotion moves it.
struct Rig {
  glm::dvec3 position_m{0.0};
  double yaw_rad = 0.0;
  double scale = 1.0;  // metres of the scene to one of the wearer's

  glm::dvec3 world_from_rig(glm::dvec3 point_m) const;
  glm::dquat world_from_rig(const glm::dquat& orientation) const;
  // Of a direction; its length is kept.
  glm::dvec3 world_from_rig_direction(glm::dvec3 direction) const;
  // The same rig moved so that a head at `head_m` (rig space) comes to lie at (x, z); height and direction stay.
  Rig with_head_over(glm::dvec2 at, glm::dvec3 head_m) const;
  // The same rig turned about the head, which stays where it is in the world. Positive to the left.
  Rig turned_about(glm::dvec3 head_m, double angle_rad) const;
};

}  // namespace probewalk
