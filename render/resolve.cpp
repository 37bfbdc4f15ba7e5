#include "render/resolve.h"

#include "render/spirv.h"

namespace probewalk {

Resolve::Resolve(const Device& device, const Image& radiance, VkFormat format)
    : views_(radiance.options().layers),
      images_(device, VK_SHADER_STAGE_FRAGMENT_BIT, {radiance.view()}),
      pipeline_(Pipeline::full_screen(device, images_, spirv::k_resolve_vert, spirv::k_resolve_frag, format)) {}

void Resolve::record(VkCommandBuffer commands, VkDeviceAddress frame, const FrameTarget& target,
                     std::span<const VkImageView> layer_views) const {
  // Waits for nothing but the semaphore's wait at the same stage: every texel is written.
  VkImageMemoryBarrier2 barrier =
      colour_barrier(target.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  pipeline_barrier(commands, barrier);

  VkRenderingAttachmentInfo attachment{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  attachment.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  attachment.loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
  rendering.renderArea = {{0, 0}, target.extent};
  rendering.layerCount = 1;
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachments = &attachment;
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

  // Also makes the picture available to copies of later submits (screenshot, mirror).
  barrier = colour_barrier(target.image, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, target.final_layout);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_BLIT_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT;
  pipeline_barrier(commands, barrier);
}

}  // namespace probewalk
