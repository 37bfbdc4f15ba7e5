// The two eyes of a head where no headset says how they lie: window and offscreen.
#pragma once

#include <cstdint>
#include <vector>

#include "content/scene/space.h"
#include "xr/frame_source.h"

namespace probewalk {

struct EyeGeometry {
  double ipd_m = 0.063;
  double vertical_fov_rad = 1.2217304763960306;  // 70 degrees
};

// What the views of a display are; eyes_of gives them in this order. Mono: one, between the eyes. The last is that of
// OpenXR's configurations with foveated insets: left and right, wide; left and right again, narrow around the axis and
// so much denser.
enum class ViewLayout { kMono, kStereo, kStereoWithInsets };

inline constexpr float kInsetShare = 1.0f / 3.0f;  // of the wide view's plane, both ways

constexpr std::uint32_t view_count_of(ViewLayout layout) {
  return layout == ViewLayout::kMono ? 1 : layout == ViewLayout::kStereo ? 2 : 4;
}

// The views of a head, with symmetric fields of view and square pixels. `head` receives the head's pose.
std::vector<ViewPose> eyes_of(const Pose& head_pose, const EyeGeometry& eyes, VkExtent2D extent, ViewPose* head,
                              ViewLayout layout = ViewLayout::kStereo);

}  // namespace probewalk
