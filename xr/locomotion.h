// How a person moves through the pack, in a headset and in a window alike: pure maths on the walkable floor, no device,
// no clock of its own. The person's head moves inside a rig; locomotion moves the rig.
#pragma once

#include <glm/glm.hpp>
#include <numbers>
#include <optional>

#include "content/scene/space.h"
#include "xr/fades.h"
#include "xr/rig.h"
#include "xr/vignette.h"
#include "xr/walkable.h"

namespace probewalk {

// The wearer's metres: --world-scale takes them to the scene's.
inline constexpr double kWalkSpeed_m_s = 1.4;
inline constexpr double kRunSpeed_m_s = 3.5;
inline constexpr double kThrowSpeed_m_s = 8.0;  // of a teleport: from the hand it reaches about 7 m
inline constexpr double kGravity_m_s2 = 9.81;
inline constexpr double kTeleportReach_m = 14.0;  // along the arc or ray
inline constexpr double kTurnSpeed_rad_s = std::numbers::pi / 2;

enum class TurnStyle {
  kSnap,    // by steps of snap_rad, at once
  kSmooth,  // at kTurnSpeed_rad_s
  kOff,     // the wearer's own body alone
};

struct LocomotionOptions {
  TurnStyle turn = TurnStyle::kSnap;
  double snap_rad = std::numbers::pi / 6;
  bool through_walls = false;  // walls hold nobody; floors still carry
  double world_scale = 1.0;    // metres of the scene to one of the wearer's; 0.01 to 100
  // Over the floor, of a resting head, in the wearer's metres. Counts where the rig's floor is not known.
  double eye_height_m = kEyeHeight_m;
  double vignette_clear_rad = 0.0;  // see VignetteLevel
};

// Where a teleport is thrown from, in the rig. The direction has any length but 0.
struct AimRay {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};
  bool straight = false;  // a ray (the mouse), not an arc (a hand)
};

// What the person wants, once a frame.
struct MoveInput {
  glm::dvec2 wish{0.0};               // x to the right, y forward, as the head looks; a length up to 1 counts
  double speed_m_s = kWalkSpeed_m_s;  // of a wish of length 1
  double turn = 0.0;                  // -1 left, 1 right
  std::optional<AimRay> aim;          // while the person aims
  bool teleport = false;              // let go: go where `aim` lands
  bool recentre = false;
};

// A head in its rig.
struct HeadPose {
  glm::dvec3 position_m{0.0};
  double yaw_rad = 0.0;
};

// Where the rig's own floor is. One that is not known is guessed again at every recentring: from a head that rests at
// the options' eye height.
struct RigFloor {
  double y_m = 0.0;  // in the rig
  bool is_known = true;
};

// Walls block (a body of kBodyRadius_m slides along them), steps are climbed smoothly, turns go about the head, a
// teleport lands on walkable floor and on no other. Where the pack has no floor at all the person floats. What a head
// does inside its rig nobody holds back.
class Locomotion {
 public:
  // `floor` must outlive this.
  Locomotion(const FloorMap& floor, const LocomotionOptions& options);

  // Places the rig so that the head stands over the floor under `anchor` (an eye pose in the world), looking along its
  // yaw.
  void place(const Pose& anchor, const HeadPose& head, const RigFloor& rig_floor);
  bool is_placed() const { return placed_; }

  void advance(const HeadPose& head, const MoveInput& input, double dt_s);

  const Rig& rig() const { return rig_; }
  // Where the head is, at the height of an ordinary eye over its floor: an anchor that gives the same rig.
  Pose anchor(const HeadPose& head) const;
  float fade() const { return blink_.darkness(); }  // 0 = picture, 1 = black
  // While sticks or keys move or turn the view, and a moment longer; nothing where walls hold it, at a snap, at a blink.
  std::optional<VignetteShape> vignette() const { return vignette_.shape(); }
  // While the person aims: the way of the throw in the world. Its landing is where a teleport would lead. Else null.
  const FloorArc* aim() const { return aim_ ? &*aim_ : nullptr; }

 private:
  // What they move the view by: 1 = kTurnSpeed_rad_s, kWalkSpeed_m_s.
  double turn(const HeadPose& head, double input, double dt_s);
  double walk(const HeadPose& head, const MoveInput& input, double dt_s);
  void step(glm::dvec2 move);
  void take_aim(const HeadPose& head, const MoveInput& input);
  void recentre();
  void stand_over(const HeadPose& head, glm::dvec3 foot_m);
  void set_height();

  const FloorMap& floor_;
  LocomotionOptions options_;
  Rig rig_;
  bool placed_ = false;
  glm::dvec3 foot_m_{0.0};       // in the world, under the head; y is the floor's
  double smooth_floor_m_ = 0.0;  // what the rig's floor lies on
  RigFloor rig_floor_;
  glm::dvec3 home_m_{0.0};  // the floor where the person last stood by choice
  Blink blink_;
  Vignette vignette_;
  bool recentres_ = false;  // the blink under way
  bool snapped_ = false;    // and the stick has not come back since
  std::optional<FloorArc> aim_;
};

}  // namespace probewalk
