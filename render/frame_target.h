// What a frame's picture is drawn into.
#pragma once

#include <volk.h>

#include <cstdint>

namespace probewalk {

// A colour attachment with one layer a view, in `initial_layout` when handed out, to be left in `final_layout`.
struct FrameTarget {
  VkImage image = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;  // an sRGB format: the attachment encodes
  VkExtent2D extent{};
  std::uint32_t layers = 0;
  VkImageLayout initial_layout = VK_IMAGE_LAYOUT_UNDEFINED;
  VkImageLayout final_layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  VkSemaphore wait_before = VK_NULL_HANDLE;   // image available (window), or none
  VkSemaphore signal_after = VK_NULL_HANDLE;  // rendering done (window), or none
};

}  // namespace probewalk
