// Where a panel hangs that its wearer should find but not have before their eyes: beside and below where the head
// looks, in the room and not on the head, and put there anew only when the head has turned or gone away from it.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace probewalk {

class PanelPlace {
 public:
  static constexpr double kDistance_m = 1.1;
  static constexpr double kLeft_rad = 0.38, kDown_rad = 0.20;
  static constexpr double kLost_rad = 0.9;  // from where the head looks, sideways
  static constexpr double kNear_m = 0.5, kFar_m = 1.8;

  // The head in the space that the panel hangs in, y up.
  void follow(glm::dvec3 head_m, const glm::dquat& head) {
    const glm::dvec3 ahead = head * glm::dvec3(0, 0, -1), up = head * glm::dvec3(0, 1, 0);
    // Of a head that looks straight down or up, its forehead or its chin says where forward is.
    const glm::dvec3 level = std::abs(ahead.y) < 0.9 ? ahead : ahead.y < 0.0 ? up : -up;
    const double yaw_rad = std::atan2(-level.x, -level.z);
    if (is_placed_) {
      const glm::dvec3 way = position_m_ - head_m;
      const double away_m = glm::length(way);
      const double aside_rad = std::remainder(std::atan2(-way.x, -way.z) - yaw_rad, 2.0 * std::numbers::pi);
      if (std::abs(aside_rad) < kLost_rad && away_m > kNear_m && away_m < kFar_m) return;
    }
    orientation_ =
        glm::angleAxis(yaw_rad + kLeft_rad, glm::dvec3(0, 1, 0)) * glm::angleAxis(-kDown_rad, glm::dvec3(1, 0, 0));
    position_m_ = head_m + orientation_ * glm::dvec3(0, 0, -kDistance_m);
    is_placed_ = true;
  }
  // It will be placed anew.
  void forget() { is_placed_ = false; }

  glm::dvec3 position_m() const { return position_m_; }
  // Its face looks along its own +z, at the head.
  glm::dquat orientation() const { return orientation_; }

 private:
  bool is_placed_ = false;
  glm::dvec3 position_m_{0.0};
  glm::dquat orientation_{1.0, 0.0, 0.0, 0.0};
};

}  // namespace probewalk
