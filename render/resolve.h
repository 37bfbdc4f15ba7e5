// Linear radiance to what the display shows: exposure, tone curve, fade, dither. Or, to look at the tracer's work, its
// look-ups as colours.
#pragma once

#include <volk.h>

#include <span>

#include "render/device.h"
#include "render/frame_target.h"
#include "render/full_screen_pass.h"
#include "render/image.h"

namespace probewalk {

class Resolve {
 public:
  // What is shown of the trace.
  enum class Shown { kPicture, kLookups };
  // `source` outlives this: the tracer's radiance, or its counts; `format` is an sRGB format, whose attachment encodes
  // what is written.
  Resolve(const Device& device, const Image& source, VkFormat format, Shown shown = Shown::kPicture);

  // Draws over every texel of `target.image`, whatever its layout, and leaves it in its final layout. `layer_views`:
  // one view (VK_IMAGE_VIEW_TYPE_2D) of each layer. `frame` is the device address of the FrameConstants.
  void record(VkCommandBuffer commands, VkDeviceAddress frame, const FrameTarget& target,
              std::span<const VkImageView> layer_views) const;

 private:
  FullScreenPass pass_;
};

}  // namespace probewalk
