#include "render/depth_pass.h"

#include "render/spirv.h"

namespace probewalk {

DepthPass::DepthPass(const Device& device, const Image& distance, VkFormat format)
    : views_(distance.options().layers),
      images_(device, VK_SHADER_STAGE_FRAGMENT_BIT, {distance.view()}),
      pipeline_(Pipeline::full_screen(device, images_, spirv::k_resolve_vert, spirv::k_depth_frag, format)) {}

void DepthPass::record(VkCommandBuffer commands, VkDeviceAddress frame, const FrameTarget& target,
                       std::span<const VkImageView> layer_views) const {
  constexpr VkImageLayout kLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  constexpr VkPipelineStageFlags2 kTests =
      VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
  constexpr VkAccessFlags2 kAccess =
      VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  VkImageMemoryBarrier2 barrier = depth_barrier(target.depth_image, VK_IMAGE_LAYOUT_UNDEFINED, kLayout);
  barrier.srcStageMask = kTests;
  barrier.srcAccessMask = VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  barrier.dstStageMask = kTests;
  barrier.dstAccessMask = kAccess;
  pipeline_barrier(commands, barrier);

  VkRenderingAttachmentInfo attachment{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  attachment.imageLayout = kLayout;
  attachment.loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
  rendering.renderArea = {{0, 0}, target.extent};
  rendering.layerCount = 1;
  rendering.pDepthAttachment = &attachment;
  const VkViewport viewport{
      0.0f, 0.0f, static_cast<float>(target.extent.width), static_cast<float>(target.extent.height), 0.0f, 1.0f};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &rendering.renderArea);
  for (std::uint32_t view = 0; view < views_; ++view) {
    attachment.imageView = layer_views[view];
    vkCmdBeginRendering(commands, &rendering);
    pipeline_.bind(commands, &images_, {frame, view});
    vkCmdDraw(commands, 3, 1, 0, 0);
    vkCmdEndRendering(commands);
  }
}

}  // namespace probewalk
