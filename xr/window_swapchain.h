// The window's images: takes finished eye pictures to the screen by a copy on the queue.
#pragma once

#include <vector>

#include "render/device.h"
#include "render/frame_target.h"
#include "xr/window_layout.h"

namespace probewalk {

class WindowSwapchain {
 public:
  // Some drivers (lavapipe) wait inside vkQueuePresentKHR for the picture: kAfterTheCopy waits before it instead, so
  // that others who need the queue meanwhile are not held up.
  enum class Present { kAtOnce, kAfterTheCopy };

  // Takes the surface over. `slots` copies may be in flight. Throws NoDevice when the surface cannot take sRGB
  // pictures.
  WindowSwapchain(const Device& device, VkSurfaceKHR surface, std::uint32_t slots, Present present = Present::kAtOnce);
  ~WindowSwapchain();
  WindowSwapchain(const WindowSwapchain&) = delete;
  WindowSwapchain& operator=(const WindowSwapchain&) = delete;

  // Blocks until the copy that last used `slot` has finished.
  void wait_for(std::uint32_t slot);
  // Shows the views of `eyes` (whose drawing has been submitted, in their final layout). Follows the window's size.
  // False when the surface is gone.
  bool present(std::uint32_t slot, const FrameTarget& eyes, const std::vector<ShownView>& layout, VkExtent2D window);

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
  void record(const Slot& slot, VkImage screen, const FrameTarget& eyes, const std::vector<ShownView>& layout) const;

  const Device& device_;
  VkSurfaceKHR surface_;
  const Present present_;
  VkSurfaceFormatKHR format_{};
  VkPresentModeKHR mode_ = VK_PRESENT_MODE_FIFO_KHR;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkExtent2D extent_{};
  std::vector<VkImage> images_;
  std::vector<VkSemaphore> copied_;   // one an image: the presentation engine waits for it
  std::vector<VkSemaphore> retired_;  // of the swapchain before, whose last picture may still be waited for
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::vector<Slot> slots_;
};

}  // namespace probewalk
