// Pictures of a pack from fixed eyes, drawn by the device.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "content/baseline/baseline_maps.h"
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
  std::vector<std::vector<float>> distance_m;   // along each pixel's ray; infinity = miss
  std::vector<std::vector<float>> depth_m;      // along the view's axis; infinity = miss
  std::vector<std::vector<glm::uvec4>> counts;  // as StereoTracer::aov
  FrameGpuTimes times;
};

// Keeps the pack's rooms on the device from one picture to the next.
class StillDrawer {
 public:
  // All must outlive the drawer. view_count eyes a picture; `samples`, `foveation` and `second_from_first` as in
  // TracerOptions. `maps`: of a choice that needs some; copied to the device at once.
  StillDrawer(const Pack& pack, const Device& device, VkExtent2D extent_px, std::uint32_t view_count,
              std::uint32_t samples, Progress& progress, const TracerChoice& choice = {},
              const BaselineMaps* maps = nullptr, const std::optional<Foveation>& foveation = std::nullopt,
              bool second_from_first = false);
  ~StillDrawer();
  StillDrawer(const StillDrawer&) = delete;
  StillDrawer& operator=(const StillDrawer&) = delete;

  // Waits for the rooms that a walker at `head_m` wants, then draws. Notes chunks that cannot be read. Throws BadInput
  // when the rooms do not arrive.
  Still draw(glm::dvec3 head_m, const std::vector<ViewConstants>& views, const FrameSettings& settings);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace probewalk
