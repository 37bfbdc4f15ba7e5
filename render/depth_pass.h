// The trace's distances to a depth attachment that a display's compositor can reproject with. A pass of its own, drawn
// only for displays that ask for depth.
#pragma once

#include <volk.h>

#include <span>

#include "render/device.h"
#include "render/frame_target.h"
#include "render/full_screen_pass.h"
#include "render/image.h"

namespace probewalk {

class DepthPass {
 public:
  // `distance` outlives this: metres along each pixel's ray. `format` is a depth format without stencil.
  DepthPass(const Device& device, const Image& distance, VkFormat format);

  // Draws over every texel of `target.depth_image`, whatever its layout, and leaves it in
  // VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL. `layer_views`: one view (VK_IMAGE_VIEW_TYPE_2D) of each layer.
  // `frame` is the device address of the FrameConstants.
  void record(VkCommandBuffer commands, VkDeviceAddress frame, const FrameTarget& target,
              std::span<const VkImageView> layer_views) const;

 private:
  FullScreenPass pass_;
};

}  // namespace probewalk
