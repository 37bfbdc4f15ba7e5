#include "render/depth_pass.h"

#include "render/spirv.h"

namespace probewalk {

DepthPass::DepthPass(const Device& device, const Image& distance, VkFormat format)
    : pass_(device, distance, spirv::k_depth_frag, format) {}

void DepthPass::record(VkCommandBuffer commands, VkDeviceAddress frame, const FrameTarget& target,
                       std::span<const VkImageView> layer_views) const {
  constexpr VkPipelineStageFlags2 kTests =
      VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
  constexpr VkAccessFlags2 kAccess =
      VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  VkImageMemoryBarrier2 barrier = depth_barrier(target.depth_image, VK_IMAGE_LAYOUT_UNDEFINED, pass_.layout());
  barrier.srcStageMask = kTests;
  barrier.srcAccessMask = VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  barrier.dstStageMask = kTests;
  barrier.dstAccessMask = kAccess;
  pipeline_barrier(commands, barrier);
  pass_.record(commands, frame, target.extent, layer_views);
}

}  // namespace probewalk
