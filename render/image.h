// A 2D image array with its memory and one view of all its layers.
#pragma once

#include <volk.h>

#include <cstdint>

#include "render/device.h"

struct VmaAllocation_T;

namespace probewalk {

struct ImageOptions {
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkExtent2D extent_px{};
  std::uint32_t layers = 1;
  VkImageUsageFlags usage = 0;
};

// Move-only; frees at destruction, so the GPU must be done with it.
class Image {
 public:
  Image() = default;
  Image(const Device& device, const ImageOptions& options);
  ~Image();
  Image(Image&& other) noexcept { swap(other); }
  Image& operator=(Image&& other) noexcept {
    swap(other);
    return *this;
  }

  VkImage handle() const { return handle_; }
  VkImageView view() const { return view_; }  // VK_IMAGE_VIEW_TYPE_2D_ARRAY
  const ImageOptions& options() const { return options_; }

 private:
  void swap(Image& other) noexcept;

  const Device* device_ = nullptr;
  VkImage handle_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  VmaAllocation_T* allocation_ = nullptr;
  ImageOptions options_;
};

// A view of one layer (VK_IMAGE_VIEW_TYPE_2D). The caller destroys it.
VkImageView make_layer_view(const Device& device, VkImage image, VkFormat format, std::uint32_t layer);

// VK_IMAGE_ASPECT_DEPTH_BIT of the depth formats that are drawn into, VK_IMAGE_ASPECT_COLOR_BIT of the others.
VkImageAspectFlags aspect_of(VkFormat format);

// A barrier on all layers of a colour or depth image, stages and accesses still to be filled in; and its recording.
VkImageMemoryBarrier2 colour_barrier(VkImage image, VkImageLayout from, VkImageLayout to);
VkImageMemoryBarrier2 depth_barrier(VkImage image, VkImageLayout from, VkImageLayout to);
void pipeline_barrier(VkCommandBuffer commands, const VkImageMemoryBarrier2& barrier);

// Layout transition that waits for, and is waited for by, everything: for set-up and read-back, not for frames.
void transition(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
                VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT);

}  // namespace probewalk
