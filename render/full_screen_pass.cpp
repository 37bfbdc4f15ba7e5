#include "render/full_screen_pass.h"

#include "render/spirv.h"

namespace probewalk {

FullScreenPass::FullScreenPass(const Device& device, const Image& source,
                               std::span<const std::uint32_t> fragment_spirv, VkFormat format)
    : layers_(source.options().layers),
      layout_(aspect_of(format) == VK_IMAGE_ASPECT_DEPTH_BIT ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                                                             : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL),
      images_(device, VK_SHADER_STAGE_FRAGMENT_BIT, {source.view()}),
      pipeline_(Pipeline::full_screen(device, images_, spirv::k_resolve_vert, fragment_spirv, format)) {}

void FullScreenPass::record(VkCommandBuffer commands, VkDeviceAddress frame, VkExtent2D extent,
                            std::span<const VkImageView> layer_views) const {
  VkRenderingAttachmentInfo attachment{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  attachment.imageLayout = layout_;
  attachment.loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
  rendering.renderArea = {{0, 0}, extent};
  rendering.layerCount = 1;
  if (layout_ == VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL) {
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachments = &attachment;
  } else {
    rendering.pDepthAttachment = &attachment;
  }
  const VkViewport viewport{
      0.0f, 0.0f, static_cast<float>(extent.width), static_cast<float>(extent.height), 0.0f, 1.0f};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &rendering.renderArea);
  for (std::uint32_t layer = 0; layer < layers_; ++layer) {
    attachment.imageView = layer_views[layer];
    vkCmdBeginRendering(commands, &rendering);
    pipeline_.bind(commands, &images_, {frame, layer});
    vkCmdDraw(commands, 3, 1, 0, 0);
    vkCmdEndRendering(commands);
  }
}

}  // namespace probewalk
