#include "render/view.h"

#include <cmath>

#include "content/probe/device_probe.h"

namespace probewalk {

ViewConstants view_constants(glm::dvec3 position_m, glm::dquat orientation, const ViewFov& fov, int width_px) {
  const glm::dmat3 world_from_eye = glm::mat3_cast(glm::normalize(orientation));
  ViewConstants view{};
  split_position(position_m, view.origin_hi_m, view.origin_lo_m);
  view.world_from_eye_x = glm::vec4(world_from_eye[0], 0.0f);
  view.world_from_eye_y = glm::vec4(world_from_eye[1], 0.0f);
  view.world_from_eye_z = glm::vec4(world_from_eye[2], 0.0f);
  view.tan_angles = {std::tan(fov.left_rad), std::tan(fov.right_rad), std::tan(fov.up_rad), std::tan(fov.down_rad)};
  view.pixel_angle_rad = std::atan((view.tan_angles.y - view.tan_angles.x) / static_cast<float>(width_px));
  return view;
}

ViewFov symmetric_fov(double vertical_rad, int width_px, int height_px) {
  const float up = static_cast<float>(vertical_rad / 2);
  const float right = std::atan(std::tan(up) * static_cast<float>(width_px) / static_cast<float>(height_px));
  return {-right, right, up, -up};
}

void share_choice(std::span<ViewConstants> views) {
  if (views.size() == 4) {
    share_choice(views.first(2));
    share_choice(views.last(2));
  }
  if (views.size() != 2) return;
  const glm::vec3 across = (views[1].origin_hi_m - views[0].origin_hi_m) + (views[1].origin_lo_m - views[0].origin_lo_m);
  for (int eye = 0; eye < 2; ++eye) {
    const float along_m = glm::dot(across, glm::vec3(views[eye].world_from_eye_x));
    views[eye].choice_shift_m = eye == 0 ? 0.5f * along_m : -0.5f * along_m;
  }
}

}  // namespace probewalk
