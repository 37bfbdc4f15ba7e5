// A session of the runtime on a Vulkan device, and the views that it will want.
#pragma once

#include "render/device.h"
#include "xr/openxr_instance.h"

namespace probewalk {

// `device` was made with the instance's hooks; both outlive the session.
XrResult create_session(const OpenXrInstance& instance, const Device& device, XrSession* session);

struct OpenXrViews {
  std::uint32_t count = 0;
  // Of one array image for all views: as large as the largest of them, no larger than each may be.
  VkExtent2D recommended{0, 0}, most{~0u, ~0u};
};
// Throws NoDevice.
OpenXrViews read_views(const OpenXrInstance& instance, XrViewConfigurationType configuration);

}  // namespace probewalk
