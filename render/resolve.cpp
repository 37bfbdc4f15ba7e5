#include "render/resolve.h"

#include "render/spirv.h"

namespace probewalk {

Resolve::Resolve(const Device& device, const Image& source, VkFormat format, Shown shown)
    : pass_(device, source, shown == Shown::kPicture ? spirv::k_resolve_frag : spirv::k_lookups_frag, format) {}

void Resolve::record(VkCommandBuffer commands, VkDeviceAddress frame, const FrameTarget& target,
                     std::span<const VkImageView> layer_views) const {
  // Waits for nothing but the semaphore's wait at the same stage: every texel is written.
  VkImageMemoryBarrier2 barrier = colour_barrier(target.image, VK_IMAGE_LAYOUT_UNDEFINED, pass_.layout());
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  pipeline_barrier(commands, barrier);
  pass_.record(commands, frame, target.extent, layer_views);

  // Also makes the picture available to copies of later submits (screenshot, mirror).
  barrier = colour_barrier(target.image, pass_.layout(), target.final_layout);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_BLIT_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT;
  pipeline_barrier(commands, barrier);
}

}  // namespace probewalk
