// What a frame's picture, and its depth where the display takes it, are drawn into.
#pragma once

#include <volk.h>

#include <cstdint>

namespace probewalk {

// A colour attachment with one layer a view, in `initial_layout` when handed out, to be left in `final_layout`.
struct FrameTarget {
  VkImage image = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;  // an sRGB format: the attachment encodes
  VkExtent2D extent{};  // that is drawn, from the upper left corner: the image may be larger
  std::uint32_t layers = 0;
  VkImageLayout initial_layout = VK_IMAGE_LAYOUT_UNDEFINED;
  VkImageLayout final_layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  VkSemaphore wait_before = VK_NULL_HANDLE;   // image available (window), or none
  VkSemaphore signal_after = VK_NULL_HANDLE;  // rendering done (window), or none
  // Depth attachment of the same size and layers (view_depth.h says what is written), in any layout when handed out,
  // left in VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL; or none.
  VkImage depth_image = VK_NULL_HANDLE;
  VkFormat depth_format = VK_FORMAT_UNDEFINED;  // D32_SFLOAT or D16_UNORM
};

}  // namespace probewalk
