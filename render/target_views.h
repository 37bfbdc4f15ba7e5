// Views of the images that frames are drawn into, one a layer: made when an image is first drawn into, and kept. A
// driver may make whoever makes or destroys a view wait for the device (lavapipe does), so no frame should.
#pragma once

#include <volk.h>

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "render/device.h"

namespace probewalk {

class TargetViews {
 public:
  explicit TargetViews(const Device& device) : device_(device) {}
  ~TargetViews();
  TargetViews(const TargetViews&) = delete;
  TargetViews& operator=(const TargetViews&) = delete;

  // `layers` views of the image, which outlives its views here and has had the same format every time.
  std::span<const VkImageView> of(VkImage image, VkFormat format, std::uint32_t layers);
  // Of images that go. The device must be done with them.
  void forget();

 private:
  const Device& device_;
  std::map<VkImage, std::vector<VkImageView>> views_;
};

}  // namespace probewalk
