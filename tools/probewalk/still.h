// One picture of a pack from fixed eyes, drawn by the device.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "content/image/image.h"
#include "content/pack/pack_io.h"
#include "content/progress.h"
#include "render/device.h"
#include "render/frame_renderer.h"

namespace probewalk {

// One of each per view.
struct Still {
  std::vector<ImageRgb8> shown;                 // as the display gets it
  std::vector<ImageRgbF> radiance_cd_m2;        // linear, not exposed
  std::vector<std::vector<float>> distance_m;   // kMissDistance_m = miss
  std::vector<std::vector<glm::uvec4>> counts;  // as StereoTracer::aov
  FrameGpuTimes times;
};

// Waits for the rooms that a walker at `head_m` wants, then draws. Notes chunks that cannot be read. Throws BadInput
// when the rooms do not arrive.
Still draw_still(const Pack& pack, const Device& device, glm::dvec3 head_m, const std::vector<ViewConstants>& views,
                 VkExtent2D extent_px, const FrameSettings& settings, Progress& progress);

}  // namespace probewalk
