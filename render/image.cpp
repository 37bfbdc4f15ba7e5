#include "render/image.h"

#include <utility>

#include "render/check.h"
#include "render/vma.h"

namespace probewalk {
namespace {

VkImageView make_view(const Device& device, VkImage image, VkFormat format, VkImageViewType type,
                      const VkImageSubresourceRange& range) {
  VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  info.image = image;
  info.viewType = type;
  info.format = format;
  info.subresourceRange = range;
  VkImageView view = VK_NULL_HANDLE;
  check(vkCreateImageView(device.handle(), &info, nullptr, &view), "vkCreateImageView");
  return view;
}

VkImageMemoryBarrier2 image_barrier(VkImage image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {aspect, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS};
  return barrier;
}

}  // namespace

Image::Image(const Device& device, const ImageOptions& options) : device_(&device), options_(options) {
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = options.format;
  info.extent = {options.extent_px.width, options.extent_px.height, 1};
  info.mipLevels = 1;
  info.arrayLayers = options.layers;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = options.usage;
  VmaAllocationCreateInfo allocation{};
  allocation.usage = VMA_MEMORY_USAGE_AUTO_PREFER_DEVICE;
  check(vmaCreateImage(device.allocator(), &info, &allocation, &handle_, &allocation_, nullptr), "vmaCreateImage");
  view_ = make_view(device, handle_, options.format, VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                    {aspect_of(options.format), 0, 1, 0, options.layers});
}

Image::~Image() {
  if (handle_ == VK_NULL_HANDLE) return;
  vkDestroyImageView(device_->handle(), view_, nullptr);
  vmaDestroyImage(device_->allocator(), handle_, allocation_);
}

void Image::swap(Image& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(handle_, other.handle_);
  std::swap(view_, other.view_);
  std::swap(allocation_, other.allocation_);
  std::swap(options_, other.options_);
}

VkImageView make_layer_view(const Device& device, VkImage image, VkFormat format, std::uint32_t layer) {
  return make_view(device, image, format, VK_IMAGE_VIEW_TYPE_2D, {aspect_of(format), 0, 1, layer, 1});
}

VkImageAspectFlags aspect_of(VkFormat format) {
  const bool is_depth = format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM;
  return is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

void pipeline_barrier(VkCommandBuffer commands, const VkImageMemoryBarrier2& barrier) {
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &dependency);
}

VkImageMemoryBarrier2 colour_barrier(VkImage image, VkImageLayout from, VkImageLayout to) {
  return image_barrier(image, VK_IMAGE_ASPECT_COLOR_BIT, from, to);
}

VkImageMemoryBarrier2 depth_barrier(VkImage image, VkImageLayout from, VkImageLayout to) {
  return image_barrier(image, VK_IMAGE_ASPECT_DEPTH_BIT, from, to);
}

void transition(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
                VkImageAspectFlags aspect) {
  VkImageMemoryBarrier2 barrier = image_barrier(image, aspect, from, to);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  pipeline_barrier(commands, barrier);
}

}  // namespace probewalk
