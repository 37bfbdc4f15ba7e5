// How a person moves through the pack: pure maths on the walkable floor, no device, no clock of its own.
// Window: a FloorWalker is moved by keys and mouse. Headset: the wearer moves inside a Rig, which only teleports.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "content/scene/space.h"

namespace probewalk {

inline constexpr double kStep_m = 0.45;  // what a foot climbs without a jump
inline constexpr double kWalkSpeed_m_s = 1.4;
inline constexpr double kRunSpeed_m_s = 3.5;

// The floor under a foot: the node of the column whose floor lies within one step, or nothing (wall, furniture, void).
std::optional<double> floor_height_m(const FloorMap& floor, glm::dvec3 foot_m);

// Where a ray first meets the floor, up to `reach_m` away. It ends at the first column without free air at its height,
// so that nobody teleports through a wall.
std::optional<glm::dvec3> floor_under_ray(const FloorMap& floor, glm::dvec3 origin_m, glm::dvec3 direction,
                                          double reach_m = 12.0);

// Free air over walkable floor all the way between two points. Columns know no air over furniture: a way across it counts
// as not clear. Where there is no floor at all nothing is in the way.
bool is_clear_way(const FloorMap& floor, glm::dvec3 from_m, glm::dvec3 to_m);

// A blink: the view darkens, the jump happens in the dark, the view comes back.
class Blink {
 public:
  static constexpr double kDown_s = 0.12;
  static constexpr double kUp_s = 0.20;

  void start(glm::dvec3 target_m);  // ignored while one is on its way
  // Returns the target once, at the darkest moment.
  std::optional<glm::dvec3> advance(double dt_s);
  float darkness() const;  // 0 = picture, 1 = black

 private:
  enum class Phase { kNone, kDown, kUp };
  Phase phase_ = Phase::kNone;
  double elapsed_s_ = 0.0;
  glm::dvec3 target_m_{0.0};
};

// A walker in a window. Walls block (a body of kBodyRadius_m slides along them), steps are climbed, the eye follows the
// floor smoothly. Where the pack has no floor at all the walker floats.
class FloorWalker {
 public:
  // `floor` must outlive the walker. `start` is an eye pose.
  FloorWalker(const FloorMap& floor, const Pose& start);

  void look(double yaw_rad, double pitch_rad);  // relative; pitch stays within 85 degrees
  void teleport(glm::dvec3 floor_m) { blink_.start(floor_m); }
  // `wish.x` to the right, `wish.y` forward, length at most 1 counts.
  void advance(glm::dvec2 wish, double speed_m_s, double dt_s);

  Pose head() const;
  float fade() const { return blink_.darkness(); }
  const FloorMap& floor() const { return floor_; }

 private:
  bool can_stand(glm::dvec2 at, double foot_m, double radius_m) const;
  void step(glm::dvec2 move);

  const FloorMap& floor_;
  glm::dvec3 foot_m_;          // y is the floor's
  double eye_height_m_;
  double smooth_floor_m_;      // what the eye stands on
  double yaw_rad_, pitch_rad_;
  Blink blink_;
};

// world_from_rig: where the headset's floor-level space lies in the world. Nothing but teleport and recentre moves it.
struct Rig {
  glm::dvec3 position_m{0.0};
  double yaw_rad = 0.0;

  glm::dvec3 world_from_rig(glm::dvec3 point_m) const;
  glm::dquat world_from_rig(const glm::dquat& orientation) const;
  // A rig in which a head at `head` (rig space) stands over `floor_m`, looking along `world_yaw_rad`.
  static Rig with_head_at(glm::dvec3 floor_m, double world_yaw_rad, glm::dvec3 head_m, double head_yaw_rad);
  // The same rig moved so that the head stands over `floor_m`; its direction stays.
  Rig teleported(glm::dvec3 floor_m, glm::dvec3 head_m) const;
};

// Darkens a view whose head left the free air, over a short distance of time rather than at once.
class WallFade {
 public:
  static constexpr double kFade_s = 0.15;
  void advance(bool head_free, double dt_s);
  float darkness() const { return static_cast<float>(darkness_); }

 private:
  double darkness_ = 0.0;
};

}  // namespace probewalk
