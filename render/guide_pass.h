// What locomotion shows over the finished picture, in the same attachment: the way of a teleport with a marker at its
// end, where nothing that the trace met is in front of it, and the comfort vignette.
#pragma once

#include <volk.h>

#include <deque>
#include <span>

#include "render/buffer.h"
#include "render/device.h"
#include "render/frame_target.h"
#include "render/guides.h"
#include "render/image.h"
#include "render/pipeline.h"

namespace probewalk {

class GuidePass {
 public:
  // `format` is the picture's; `distance` is like the images that will be given to record. Of `slots` frames each may
  // be on the device at once.
  GuidePass(const Device& device, const Image& distance, VkFormat format, std::uint32_t slots);

  // Draws over `target.image`, which is in its final layout and stays in it. `distance`: metres along each pixel's ray,
  // in VK_IMAGE_LAYOUT_GENERAL. `layer_views`: one view of each layer. `frame` is the device address of the
  // FrameConstants, which are read when the commands run; the guides are those of now. The device must be done with
  // what was recorded last for the slot.
  void record(VkCommandBuffer commands, std::uint32_t slot, VkDeviceAddress frame, const Image& distance,
              const FrameTarget& target, std::span<const VkImageView> layer_views, const Guides& guides);

 private:
  struct Slot {
    Slot(const Device& device, const Image& distance);
    StorageImageSet images;
    Buffer constants;  // GuideConstants
  };
  std::deque<Slot> slots_;
  Pipeline pipeline_;
};

}  // namespace probewalk
