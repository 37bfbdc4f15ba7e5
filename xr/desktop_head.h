// The head of somebody at a desktop: it stands in the middle of its rig and looks where the mouse says.
#pragma once

#include "content/scene/space.h"
#include "xr/locomotion.h"

namespace probewalk {

class DesktopHead {
 public:
  DesktopHead(double eye_height_m, double pitch_rad) : eye_height_m_(eye_height_m), pitch_rad_(pitch_rad) {}

  void look(double yaw_rad, double pitch_rad);  // relative; pitch stays within 85 degrees

  HeadPose pose() const { return {{0.0, eye_height_m_, 0.0}, yaw_rad_}; }
  Pose in_rig() const { return {{0.0, eye_height_m_, 0.0}, yaw_rad_, pitch_rad_}; }
  Pose in_world(const Rig& rig) const;

 private:
  double eye_height_m_;
  double yaw_rad_ = 0.0, pitch_rad_;
};

}  // namespace probewalk
