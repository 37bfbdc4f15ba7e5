#include "xr/eyes.h"

#include <cmath>
#include <cstddef>

#include "render/view.h"
#include "xr/path.h"

namespace probewalk {

std::vector<ViewPose> eyes_of(const Pose& head_pose, const EyeGeometry& eyes, VkExtent2D extent, ViewPose* head,
                              ViewLayout layout) {
  const ViewFov fov =
      symmetric_fov(eyes.vertical_fov_rad, static_cast<int>(extent.width), static_cast<int>(extent.height));
  ViewPose centre;
  centre.position_m = head_pose.position_m;
  centre.orientation = orientation_of(head_pose.yaw_rad, head_pose.pitch_rad);
  centre.fov_left_rad = fov.left_rad;
  centre.fov_right_rad = fov.right_rad;
  centre.fov_up_rad = fov.up_rad;
  centre.fov_down_rad = fov.down_rad;
  if (head != nullptr) *head = centre;
  if (layout == ViewLayout::kMono) return {centre};
  const glm::dvec3 half_m = centre.orientation * glm::dvec3(eyes.ipd_m / 2, 0, 0);
  std::vector<ViewPose> views{centre, centre};
  views[0].position_m -= half_m;
  views[1].position_m += half_m;
  if (layout == ViewLayout::kStereoWithInsets) {
    const auto narrowed = [](float angle_rad) { return std::atan(std::tan(angle_rad) * kInsetShare); };
    for (std::size_t eye = 0; eye < 2; ++eye) {
      ViewPose inset = views[eye];
      for (float* side : {&inset.fov_left_rad, &inset.fov_right_rad, &inset.fov_up_rad, &inset.fov_down_rad}) {
        *side = narrowed(*side);
      }
      views.push_back(inset);
    }
  }
  return views;
}

}  // namespace probewalk
