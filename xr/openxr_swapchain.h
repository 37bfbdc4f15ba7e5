// A swapchain of the runtime: array images with one layer a view, of which one at a time is ours to draw into.
#pragma once

#include <cstdint>
#include <vector>

#include "render/device.h"
#include "xr/openxr_api.h"

namespace probewalk {

struct OpenXrSwapchainOptions {
  VkFormat format = VK_FORMAT_UNDEFINED;
  XrSwapchainUsageFlags usage = 0;
  VkExtent2D extent{};
  std::uint32_t layers = 0;
};

class OpenXrSwapchain {
 public:
  // Throws NoDevice when the runtime refuses. The device is the session's and outlives the swapchain.
  OpenXrSwapchain(const Device& device, XrSession session, const OpenXrSwapchainOptions& options);
  // Without the device's queue locked: runtimes wait for it before they let go of the images, and others may present
  // meanwhile.
  ~OpenXrSwapchain();
  OpenXrSwapchain(const OpenXrSwapchain&) = delete;
  OpenXrSwapchain& operator=(const OpenXrSwapchain&) = delete;

  // Takes the next image and waits until the compositor has let go of it, at most two seconds: then
  // XR_TIMEOUT_EXPIRED. The image is held only after XR_SUCCESS.
  OpenXrOutcome acquire();
  // Gives the image back, if one is held. With the device's queue locked.
  OpenXrOutcome release();
  // The image held; VK_NULL_HANDLE when none is.
  VkImage image() const { return held_; }

  // What is drawn of a layer, from its upper left corner, as the layers of a frame state it.
  XrSwapchainSubImage layer(std::uint32_t view, VkExtent2D drawn) const;

 private:
  const Device& device_;
  XrOwned<XrSwapchain, xrDestroySwapchain> handle_;
  std::vector<VkImage> images_;
  VkImage held_ = VK_NULL_HANDLE;
};

}  // namespace probewalk
