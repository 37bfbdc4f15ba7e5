// What the resolve and the depth pass share: an image's layers drawn to those of an attachment, one draw a layer.
// Multiview gains nothing for one triangle, and llvmpipe of Mesa 25.0 crashes on it where the device is otherwise
// sound.
#pragma once

#include <volk.h>

#include <cstdint>
#include <span>

#include "render/device.h"
#include "render/image.h"
#include "render/pipeline.h"

namespace probewalk {

class FullScreenPass {
 public:
  // The fragment shader reads `source`, which outlives this, as storage image 0. `format` is the attachment's: of
  // colour, or of depth without stencil.
  FullScreenPass(const Device& device, const Image& source, std::span<const std::uint32_t> fragment_spirv,
                 VkFormat format);

  // The layout that the attachment is drawn in.
  VkImageLayout layout() const { return layout_; }

  // Draws over every texel of `extent` of each layer. `layer_views`: one view (VK_IMAGE_VIEW_TYPE_2D) of each layer, in
  // layout(). `frame` is the device address of the FrameConstants. Barriers are the caller's.
  void record(VkCommandBuffer commands, VkDeviceAddress frame, VkExtent2D extent,
              std::span<const VkImageView> layer_views) const;

 private:
  std::uint32_t layers_;
  VkImageLayout layout_;
  StorageImageSet images_;
  Pipeline pipeline_;
};

}  // namespace probewalk
