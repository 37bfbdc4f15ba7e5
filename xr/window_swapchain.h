// The window's images: takes finished eye pictures to the screen by a copy on the queue.
#pragma once

#include <cstdint>
#include <vector>

#include "render/device.h"
#include "render/frame_target.h"
#include "render/target_views.h"
#include "xr/overlay/overlay_painter.h"
#include "xr/window_layout.h"

namespace probewalk {

class WindowSwapchain {
 public:
  // Who else uses the queue. kAlone: presenting may wait for the display. kBesideHeadset: the queue's lock is never
  // held while waiting: pictures replace one another or tear rather than queue up, where the display offers that; one
  // is given up when no image is free; and the copy is waited for before vkQueuePresentKHR, inside which some drivers
  // (lavapipe) would wait for it.
  enum class Sharing { kAlone, kBesideHeadset };

  // Takes the surface over. `slots` copies may be in flight. `overlay` outlives this; null = none is ever shown. Throws
  // NoDevice when the surface cannot take sRGB pictures.
  WindowSwapchain(const Device& device, VkSurfaceKHR surface, std::uint32_t slots, Sharing sharing,
                  const OverlayBoard* overlay);
  ~WindowSwapchain();
  WindowSwapchain(const WindowSwapchain&) = delete;
  WindowSwapchain& operator=(const WindowSwapchain&) = delete;

  // Blocks until the copy that last used `slot` has finished.
  void wait_for(std::uint32_t slot);
  // Shows the views of `eyes` (whose drawing has been submitted, in their final layout). Follows the window's size.
  // False when the surface is gone.
  bool present(std::uint32_t slot, const FrameTarget& eyes, const std::vector<ShownView>& layout, VkExtent2D window);

  // Pictures that reached the display, and the longest that one of them took in vkQueuePresentKHR.
  std::uint64_t presented() const { return presented_; }
  std::int64_t longest_present_ns() const { return longest_present_ns_; }
  VkPresentModeKHR mode() const { return mode_; }

 private:
  struct Slot {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkSemaphore available = VK_NULL_HANDLE;
    VkFence done = VK_NULL_HANDLE;
  };
  void choose_format_and_mode();
  bool recreate(VkExtent2D window);
  void wait_for_all();
  void release_images();
  void record(std::uint32_t slot, VkImage screen, const FrameTarget& eyes, const std::vector<ShownView>& layout);
  void paint_overlay(std::uint32_t slot, VkImage screen);

  const Device& device_;
  VkSurfaceKHR surface_;
  const Sharing sharing_;
  VkSurfaceFormatKHR format_{};
  VkPresentModeKHR mode_ = VK_PRESENT_MODE_FIFO_KHR;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkExtent2D extent_{};
  std::vector<VkImage> images_;
  std::vector<VkSemaphore> copied_;   // one an image: the presentation engine waits for it
  std::vector<VkSemaphore> retired_;  // of the swapchain before, whose last picture may still be waited for
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::vector<Slot> slots_;
  TargetViews views_;  // with the overlay only
  OverlayPainter overlay_;
  std::uint64_t presented_ = 0;
  std::int64_t longest_present_ns_ = 0;
};

}  // namespace probewalk
