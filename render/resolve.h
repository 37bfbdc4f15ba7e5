// Linear radiance to what the display shows: exposure, tone curve, fade, dither. One draw a view: multiview
// gains nothing for one triangle, and llvmpipe of Mesa 25.0 crashes on it where the device is otherwise sound.
#pragma once

#include <volk.h>

#include <cstdint>
#include <span>

#include "render/device.h"
#include "render/frame_target.h"
#include "render/image.h"
#include "render/pipeline.h"

namespace probewalk {

class Resolve {
 public:
  // `radiance` outlives this; `format` is an sRGB format, whose attachment encodes what is written.
  Resolve(const Device& device, const Image& radiance, VkFormat format);

  // Draws over every texel of `target.image`, whatever its layout, and leaves it in its final layout. `layer_views`:
  // one view (VK_IMAGE_VIEW_TYPE_2D) of each layer. `frame` is the device address of the FrameConstants.
  void record(VkCommandBuffer commands, VkDeviceAddress frame, const FrameTarget& target,
              std::span<const VkImageView> layer_views) const;

 private:
  std::uint32_t views_;
  StorageImageSet images_;
  Pipeline pipeline_;
};

}  // namespace probewalk
