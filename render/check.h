// Every Vulkan result is checked, in release builds too.
#pragma once

#include <volk.h>

#include <source_location>

#include "content/error.h"

namespace probewalk {

// An error code that a Vulkan call returned. The message holds the call, the result's name, and file and line.
struct VulkanError : Error {
  VulkanError(VkResult code, const std::string& message) : Error(ExitCode::kNoDevice, message), result(code) {}
  VkResult result;
};

// "VK_ERROR_DEVICE_LOST" and so on; the number where the name is not known.
std::string result_name(VkResult result);

// Returns success codes (VK_SUCCESS and those that carry meaning: VK_NOT_READY, VK_SUBOPTIMAL_KHR, ...), throws
// VulkanError on error codes. `call` is the function's name.
VkResult check(VkResult result, const char* call, std::source_location where = std::source_location::current());

}  // namespace probewalk
