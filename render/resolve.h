// Linear radiance to what the display shows: exposure, tone curve, fade, dither; one layer a view, in one draw.
#pragma once

#include <volk.h>

#include <cstdint>

#include "render/device.h"
#include "render/frame_target.h"
#include "render/image.h"

namespace probewalk {

class Resolve {
 public:
  // `radiance` outlives this; `format` is an sRGB format, whose attachment encodes what is written.
  Resolve(const Device& device, const Image& radiance, VkFormat format);
  ~Resolve();
  Resolve(const Resolve&) = delete;
  Resolve& operator=(const Resolve&) = delete;

  // Draws into a view (2D array, one layer a view) of `target.image`, moving the image from its initial to its final
  // layout. `frame` is the device address of the FrameConstants.
  void record(VkCommandBuffer commands, VkDeviceAddress frame, const FrameTarget& target, VkImageView target_view) const;

 private:
  const Device& device_;
  std::uint32_t views_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace probewalk
