// The colour images that displays without a swapchain of their own hand out: a small ring, one layer a view.
#pragma once

#include <cstdint>
#include <vector>

#include "render/device.h"
#include "render/frame_target.h"
#include "render/image.h"

namespace probewalk {

class EyeImages {
 public:
  static constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;
  // One more than the frames that the renderer keeps in flight, so that an image handed out is never being drawn into.
  static constexpr std::uint32_t kCount = 3;

  EyeImages(const Device& device, VkExtent2D extent, std::uint32_t views);

  // The next image of the ring, of which `drawn` is drawn. It is to be left ready to be copied from.
  FrameTarget next(VkExtent2D drawn);
  // Index in the ring of the image handed out last.
  std::uint32_t current() const { return current_; }

 private:
  std::vector<Image> images_;
  std::uint32_t current_ = kCount - 1;
};

}  // namespace probewalk
