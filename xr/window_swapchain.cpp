#include "xr/window_swapchain.h"

#include <algorithm>

#include "content/error.h"
#include "render/check.h"
#include "render/commands.h"
#include "render/image.h"
#include "xr/latency/clock.h"

namespace probewalk {
namespace {

// A window that is dragged or covered may hold its images back: a frame is skipped rather than waited for.
constexpr std::uint64_t kAcquireTimeout_ns = 100'000'000;

void barrier(VkCommandBuffer commands, VkImage image, std::uint32_t layers, VkImageLayout from, VkImageLayout to,
             VkPipelineStageFlags2 before, VkAccessFlags2 written, VkPipelineStageFlags2 after, VkAccessFlags2 used) {
  VkImageMemoryBarrier2 change{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  change.srcStageMask = before;
  change.srcAccessMask = written;
  change.dstStageMask = after;
  change.dstAccessMask = used;
  change.oldLayout = from;
  change.newLayout = to;
  change.srcQueueFamilyIndex = change.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  change.image = image;
  change.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, layers};
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &change;
  vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace

WindowSwapchain::WindowSwapchain(const Device& device, VkSurfaceKHR surface, std::uint32_t slots, Sharing sharing,
                                 const OverlayBoard* overlay)
    : device_(device), surface_(surface), sharing_(sharing), views_(device), overlay_(device, overlay, slots) {
  choose_format_and_mode();
  pool_ = make_command_pool(device, device.queue_family(), VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT);
  slots_.resize(slots);
  for (Slot& slot : slots_) {
    allocate_commands(device, pool_, {&slot.commands, 1});
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    check(vkCreateSemaphore(device.handle(), &semaphore, nullptr, &slot.available), "vkCreateSemaphore");
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, VK_FENCE_CREATE_SIGNALED_BIT};
    check(vkCreateFence(device.handle(), &fence, nullptr, &slot.done), "vkCreateFence");
  }
}

WindowSwapchain::~WindowSwapchain() {
  device_.wait_idle();
  release_images();
  release_images();  // those retired, too
  if (swapchain_ != VK_NULL_HANDLE) vkDestroySwapchainKHR(device_.handle(), swapchain_, nullptr);
  for (const Slot& slot : slots_) {
    vkDestroySemaphore(device_.handle(), slot.available, nullptr);
    vkDestroyFence(device_.handle(), slot.done, nullptr);
  }
  vkDestroyCommandPool(device_.handle(), pool_, nullptr);
  vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
}

void WindowSwapchain::choose_format_and_mode() {
  std::uint32_t count = 0;
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, nullptr),
        "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, formats.data()),
        "vkGetPhysicalDeviceSurfaceFormatsKHR");
  const auto found = std::ranges::find_if(formats, [](const VkSurfaceFormatKHR& offered) {
    return offered.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR &&
           (offered.format == VK_FORMAT_B8G8R8A8_SRGB || offered.format == VK_FORMAT_R8G8B8A8_SRGB);
  });
  if (found == formats.end()) throw NoDevice("no window: the display offers no 8-bit sRGB format");
  format_ = *found;

  check(vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical(), surface_, &count, nullptr),
        "vkGetPhysicalDeviceSurfacePresentModesKHR");
  std::vector<VkPresentModeKHR> modes(count);
  check(vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical(), surface_, &count, modes.data()),
        "vkGetPhysicalDeviceSurfacePresentModesKHR");
  // The newest picture at each refresh, without waiting; FIFO is what every display has. Beside a headset a picture may
  // rather tear than make its driver wait for the refresh.
  const auto offers = [&](VkPresentModeKHR mode) { return std::ranges::find(modes, mode) != modes.end(); };
  if (offers(VK_PRESENT_MODE_MAILBOX_KHR)) {
    mode_ = VK_PRESENT_MODE_MAILBOX_KHR;
  } else if (sharing_ == Sharing::kBesideHeadset && offers(VK_PRESENT_MODE_IMMEDIATE_KHR)) {
    mode_ = VK_PRESENT_MODE_IMMEDIATE_KHR;
  }
}

// Our own copies, not the device: other threads go on using its queue.
void WindowSwapchain::wait_for_all() {
  for (std::uint32_t slot = 0; slot < slots_.size(); ++slot) wait_for(slot);
}

void WindowSwapchain::release_images() {
  for (VkSemaphore semaphore : retired_) vkDestroySemaphore(device_.handle(), semaphore, nullptr);
  retired_ = std::move(copied_);
  copied_.clear();
  views_.forget();
  images_.clear();
}

bool WindowSwapchain::recreate(VkExtent2D window) {
  wait_for_all();
  release_images();
  VkSurfaceCapabilitiesKHR can{};
  const VkResult asked = vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &can);
  if (asked == VK_ERROR_SURFACE_LOST_KHR) return false;
  check(asked, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  if ((can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT) == 0) {
    throw NoDevice("no window: the display's images cannot be copied to");
  }
  // The surface's own size where it has one; the window's size may be newer or older by an event.
  extent_ = can.currentExtent.width != ~0u
                ? can.currentExtent
                : VkExtent2D{std::clamp(window.width, can.minImageExtent.width, can.maxImageExtent.width),
                             std::clamp(window.height, can.minImageExtent.height, can.maxImageExtent.height)};
  if (extent_.width == 0 || extent_.height == 0) return true;

  VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  info.surface = surface_;
  info.minImageCount = can.minImageCount + 1;
  if (can.maxImageCount != 0) info.minImageCount = std::min(info.minImageCount, can.maxImageCount);
  info.imageFormat = format_.format;
  info.imageColorSpace = format_.colorSpace;
  info.imageExtent = extent_;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
  info.preTransform = can.currentTransform;
  info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  info.presentMode = mode_;
  info.clipped = VK_TRUE;
  info.oldSwapchain = swapchain_;
  VkSwapchainKHR next = VK_NULL_HANDLE;
  const VkResult made = vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &next);
  if (swapchain_ != VK_NULL_HANDLE) vkDestroySwapchainKHR(device_.handle(), swapchain_, nullptr);
  swapchain_ = next;
  if (made == VK_ERROR_SURFACE_LOST_KHR || made == VK_ERROR_NATIVE_WINDOW_IN_USE_KHR) return false;
  check(made, "vkCreateSwapchainKHR");

  std::uint32_t count = 0;
  check(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, nullptr), "vkGetSwapchainImagesKHR");
  images_.resize(count);
  check(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, images_.data()), "vkGetSwapchainImagesKHR");
  copied_.resize(count, VK_NULL_HANDLE);
  for (VkSemaphore& semaphore : copied_) {
    const VkSemaphoreCreateInfo create{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    check(vkCreateSemaphore(device_.handle(), &create, nullptr, &semaphore), "vkCreateSemaphore");
  }
  return true;
}

void WindowSwapchain::wait_for(std::uint32_t slot) {
  check(vkWaitForFences(device_.handle(), 1, &slots_[slot].done, VK_TRUE, UINT64_MAX), "vkWaitForFences");
}

bool WindowSwapchain::present(std::uint32_t index, const FrameTarget& eyes, const std::vector<ShownView>& layout,
                              VkExtent2D window) {
  if (window.width == 0 || window.height == 0) return true;
  if (images_.empty() || window.width != extent_.width || window.height != extent_.height) {
    if (!recreate(window)) return false;
    if (images_.empty() || window.width != extent_.width || window.height != extent_.height) return true;
  }
  const Slot& slot = slots_[index];
  wait_for(index);
  std::uint32_t image = 0;
  const std::uint64_t patience_ns = sharing_ == Sharing::kBesideHeadset ? 0 : kAcquireTimeout_ns;
  const VkResult acquired =
      vkAcquireNextImageKHR(device_.handle(), swapchain_, patience_ns, slot.available, VK_NULL_HANDLE, &image);
  if (acquired == VK_ERROR_SURFACE_LOST_KHR) return false;
  if (acquired == VK_ERROR_OUT_OF_DATE_KHR) return recreate(window);
  if (check(acquired, "vkAcquireNextImageKHR") == VK_TIMEOUT || acquired == VK_NOT_READY) return true;

  record(index, images_[image], eyes, layout);
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = slot.commands;
  VkSemaphoreSubmitInfo before{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  before.semaphore = slot.available;
  before.stageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  VkSemaphoreSubmitInfo after{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  after.semaphore = copied_[image];
  after.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.waitSemaphoreInfoCount = 1;
  submit.pWaitSemaphoreInfos = &before;
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &commands;
  submit.signalSemaphoreInfoCount = 1;
  submit.pSignalSemaphoreInfos = &after;
  check(vkResetFences(device_.handle(), 1, &slot.done), "vkResetFences");
  device_.submit(submit, slot.done);
  if (sharing_ == Sharing::kBesideHeadset) wait_for(index);

  VkPresentInfoKHR show{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  show.waitSemaphoreCount = 1;
  show.pWaitSemaphores = &copied_[image];
  show.swapchainCount = 1;
  show.pSwapchains = &swapchain_;
  show.pImageIndices = &image;
  const std::int64_t begin_ns = now_ns();
  const VkResult shown = device_.present(show);
  longest_present_ns_ = std::max(longest_present_ns_, now_ns() - begin_ns);
  if (shown == VK_ERROR_SURFACE_LOST_KHR) return false;
  if (shown == VK_ERROR_OUT_OF_DATE_KHR || shown == VK_SUBOPTIMAL_KHR) return recreate(window);
  check(shown, "vkQueuePresentKHR");
  ++presented_;
  return true;
}

void WindowSwapchain::record(std::uint32_t index, VkImage screen, const FrameTarget& eyes,
                             const std::vector<ShownView>& layout) {
  const Slot& slot = slots_[index];
  begin_commands(slot.commands);
  constexpr VkPipelineStageFlags2 kCopy = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  barrier(slot.commands, eyes.image, eyes.layers, eyes.final_layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
          VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT, kCopy, VK_ACCESS_2_TRANSFER_READ_BIT);
  barrier(slot.commands, screen, 1, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, kCopy, 0, kCopy,
          VK_ACCESS_2_TRANSFER_WRITE_BIT);
  const VkClearColorValue black{};
  const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdClearColorImage(slot.commands, screen, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &black, 1, &all);
  barrier(slot.commands, screen, 1, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, kCopy,
          VK_ACCESS_2_TRANSFER_WRITE_BIT, kCopy, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  for (const ShownView& shown : layout) {
    VkImageBlit copy{};
    copy.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, shown.view, 1};
    copy.srcOffsets[1] = {static_cast<std::int32_t>(eyes.extent.width), static_cast<std::int32_t>(eyes.extent.height),
                          1};
    copy.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.dstOffsets[0] = {shown.offset.x, shown.offset.y, 0};
    copy.dstOffsets[1] = {shown.offset.x + static_cast<std::int32_t>(shown.extent.width),
                          shown.offset.y + static_cast<std::int32_t>(shown.extent.height), 1};
    vkCmdBlitImage(slot.commands, eyes.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, screen,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy, VK_FILTER_LINEAR);
  }
  if (overlay_.prepare(format_.format)) {
    paint_overlay(index, screen);
  } else {
    barrier(slot.commands, screen, 1, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, kCopy,
            VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0);
  }
  check(vkEndCommandBuffer(slot.commands), "vkEndCommandBuffer");
}

// Over the eyes' pictures, and on to the display.
void WindowSwapchain::paint_overlay(std::uint32_t index, VkImage screen) {
  Slot& slot = slots_[index];
  constexpr VkPipelineStageFlags2 kDraw = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  constexpr VkAccessFlags2 kDrawn = VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  barrier(slot.commands, screen, 1, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
          VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, kDraw, kDrawn);
  overlay_.paint(slot.commands, index, views_.of(screen, format_.format, 1).front(), extent_);
  barrier(slot.commands, screen, 1, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, kDraw,
          VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0);
}

}  // namespace probewalk
