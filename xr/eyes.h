// The two eyes of a head where no headset says how they lie: window and offscreen.
#pragma once

#include <vector>

#include "content/scene/space.h"
#include "xr/frame_source.h"

namespace probewalk {

struct EyeGeometry {
  double ipd_m = 0.063;
  double vertical_fov_rad = 1.2217304763960306;  // 70 degrees
};

// Left and right eye of a head, with symmetric fields of view and square pixels. `head` receives the head's pose.
std::vector<ViewPose> eyes_of(const Pose& head_pose, const EyeGeometry& eyes, VkExtent2D extent, ViewPose* head);

}  // namespace probewalk
