#include "xr/desktop_head.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace probewalk {
namespace {

constexpr double kPitchLimit_rad = 85.0 * std::numbers::pi / 180.0;

}  // namespace

void DesktopHead::look(double yaw_rad, double pitch_rad) {
  yaw_rad_ = std::remainder(yaw_rad_ + yaw_rad, 2.0 * std::numbers::pi);
  pitch_rad_ = std::clamp(pitch_rad_ + pitch_rad, -kPitchLimit_rad, kPitchLimit_rad);
}

Pose DesktopHead::in_world(const Rig& rig) const {
  return {rig.world_from_rig(in_rig().position_m), rig.yaw_rad + yaw_rad_, pitch_rad_};
}

}  // namespace probewalk
