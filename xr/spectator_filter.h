// A head's pose without its jitter, for those who watch: follows as a critically damped spring does, as fast as it can
// without ever swinging past. Pure numbers.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

namespace probewalk {

class SpectatorFilter {
 public:
  static constexpr double kFollow_s = 0.18;  // time constant: turns lag by twice that
  static constexpr double kJump_m = 0.5;     // further between two poses is a teleport: followed at once

  struct Pose {
    glm::dvec3 position_m{0.0};
    glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
  };

  explicit SpectatorFilter(double follow_s = kFollow_s) : rate_(1.0 / follow_s) {}

  // The smoothed pose `dt_s` (>= 0) after the last one, the head being at `head` since.
  Pose next(const Pose& head, double dt_s);

 private:
  double rate_;  // 1/s
  std::optional<Pose> pose_;
  Pose head_;
  glm::dvec3 velocity_m_s_{0.0}, spin_rad_s_{0.0};  // world space
};

}  // namespace probewalk
