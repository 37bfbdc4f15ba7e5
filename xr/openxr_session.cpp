#include "xr/openxr_session.h"

#include <algorithm>

#include "xr/openxr_enumerate.h"

namespace probewalk {

XrResult create_session(const OpenXrInstance& instance, const Device& device, XrSession* session) {
  XrGraphicsBindingVulkan2KHR binding{XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR};
  binding.instance = device.instance();
  binding.physicalDevice = device.physical();
  binding.device = device.handle();
  binding.queueFamilyIndex = device.queue_family();
  binding.queueIndex = 0;
  XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO};
  info.next = &binding;
  info.systemId = instance.system();
  return xrCreateSession(instance.handle(), &info, session);
}

OpenXrViews read_views(const OpenXrInstance& instance, XrViewConfigurationType configuration) {
  const auto views = enumerate_xr<XrViewConfigurationView>(
      "xrEnumerateViewConfigurationViews", {XR_TYPE_VIEW_CONFIGURATION_VIEW},
      [&](auto capacity, auto* count, auto* items) {
        return xrEnumerateViewConfigurationViews(instance.handle(), instance.system(), configuration, capacity, count,
                                                 items);
      });
  OpenXrViews found;
  found.count = static_cast<std::uint32_t>(views.size());
  for (const auto& view : views) {
    found.recommended.width = std::max(found.recommended.width, view.recommendedImageRectWidth);
    found.recommended.height = std::max(found.recommended.height, view.recommendedImageRectHeight);
    found.most.width = std::min(found.most.width, view.maxImageRectWidth);
    found.most.height = std::min(found.most.height, view.maxImageRectHeight);
  }
  return found;
}

}  // namespace probewalk
