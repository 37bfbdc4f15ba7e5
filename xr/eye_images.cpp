#include "xr/eye_images.h"

namespace probewalk {

EyeImages::EyeImages(const Device& device, VkExtent2D extent, std::uint32_t views) {
  ImageOptions options;
  options.format = kFormat;
  options.extent_px = extent;
  options.layers = views;
  options.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  for (std::uint32_t i = 0; i < kCount; ++i) images_.emplace_back(device, options);
}

FrameTarget EyeImages::next(VkExtent2D drawn) {
  current_ = (current_ + 1) % kCount;
  const Image& image = images_[current_];
  FrameTarget target;
  target.image = image.handle();
  target.format = kFormat;
  target.extent = drawn;
  target.layers = image.options().layers;
  target.initial_layout = VK_IMAGE_LAYOUT_UNDEFINED;
  target.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  return target;
}

}  // namespace probewalk
