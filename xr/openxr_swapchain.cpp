#include "xr/openxr_swapchain.h"

#include "xr/openxr_enumerate.h"

namespace probewalk {
namespace {

constexpr XrDuration kImageTimeout_ns = 2'000'000'000;

}  // namespace

OpenXrSwapchain::OpenXrSwapchain(const Device& device, XrSession session, const OpenXrSwapchainOptions& options)
    : device_(device) {
  XrSwapchainCreateInfo info{XR_TYPE_SWAPCHAIN_CREATE_INFO};
  info.usageFlags = options.usage;
  info.format = options.format;
  info.sampleCount = 1;
  info.width = options.extent.width;
  info.height = options.extent.height;
  info.faceCount = 1;
  info.arraySize = options.layers;
  info.mipCount = 1;
  check_xr(xrCreateSwapchain(session, &info, handle_.out()), "xrCreateSwapchain");
  const auto images = enumerate_xr<XrSwapchainImageVulkan2KHR>(
      "xrEnumerateSwapchainImages", {XR_TYPE_SWAPCHAIN_IMAGE_VULKAN2_KHR},
      [&](auto capacity, auto* count, auto* items) {
        return xrEnumerateSwapchainImages(handle_.get(), capacity, count,
                                          reinterpret_cast<XrSwapchainImageBaseHeader*>(items));
      });
  for (const auto& image : images) images_.push_back(image.image);
}

OpenXrSwapchain::~OpenXrSwapchain() {
  const auto queue = device_.lock_queue();
  handle_.reset();
}

OpenXrOutcome OpenXrSwapchain::acquire() {
  XrSwapchainImageAcquireInfo acquire{XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO};
  std::uint32_t index = 0;
  XrResult result = XR_SUCCESS;
  {
    const auto queue = device_.lock_queue();
    result = xrAcquireSwapchainImage(handle_.get(), &acquire, &index);
  }
  if (result != XR_SUCCESS) return {result, "xrAcquireSwapchainImage"};
  XrSwapchainImageWaitInfo wait{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO};
  wait.timeout = kImageTimeout_ns;
  result = xrWaitSwapchainImage(handle_.get(), &wait);
  if (result == XR_SUCCESS) held_ = images_.at(index);
  return {result, "xrWaitSwapchainImage"};
}

OpenXrOutcome OpenXrSwapchain::release() {
  if (held_ == VK_NULL_HANDLE) return {};
  held_ = VK_NULL_HANDLE;
  XrSwapchainImageReleaseInfo release{XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO};
  return {xrReleaseSwapchainImage(handle_.get(), &release), "xrReleaseSwapchainImage"};
}

XrSwapchainSubImage OpenXrSwapchain::layer(std::uint32_t view, VkExtent2D drawn) const {
  XrSwapchainSubImage image{};
  image.swapchain = handle_.get();
  image.imageRect.extent = {static_cast<std::int32_t>(drawn.width), static_cast<std::int32_t>(drawn.height)};
  image.imageArrayIndex = view;
  return image;
}

}  // namespace probewalk
