#include "xr/openxr_instance.h"

#include <fmt/format.h>
#include <openxr/openxr_reflection.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include "content/error.h"
#include "xr/openxr_extensions.h"

namespace probewalk {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::vector<std::string> available_extensions() {
  std::uint32_t count = 0;
  const XrResult result = xrEnumerateInstanceExtensionProperties(nullptr, 0, &count, nullptr);
  if (XR_FAILED(result)) {
    throw NoDevice(fmt::format("no OpenXR runtime answers ({}); start one, or name its manifest in XR_RUNTIME_JSON",
                               xr_result_name(result)));
  }
  std::vector<XrExtensionProperties> properties(count, {XR_TYPE_EXTENSION_PROPERTIES, nullptr, {}, 0});
  check_xr(xrEnumerateInstanceExtensionProperties(nullptr, count, &count, properties.data()),
           "xrEnumerateInstanceExtensionProperties");
  std::vector<std::string> names;
  for (const auto& property : properties) names.emplace_back(property.extensionName);
  return names;
}

}  // namespace

std::string xr_result_name(XrResult result) {
  switch (result) {
#define PROBEWALK_XR_NAME(name, value) \
  case name:                           \
    return #name;
    XR_LIST_ENUM_XrResult(PROBEWALK_XR_NAME)
#undef PROBEWALK_XR_NAME
        default : return fmt::format("XrResult {}", static_cast<int>(result));
  }
}

void check_xr(XrResult result, const char* call) {
  if (XR_FAILED(result)) throw NoDevice(fmt::format("OpenXR: {} failed with {}", call, xr_result_name(result)));
}

OpenXrInstance::OpenXrInstance() {
  // Without a runtime the loader writes lines of its own; ours says the same once. Who sets the variable gets them.
  setenv("XR_LOADER_DEBUG", "none", 0);
  const std::vector<std::string> available = available_extensions();
  std::vector<const char*> names;
  for (const OpenXrExtension& extension : wanted_openxr_extensions()) {
    if (std::ranges::find(available, extension.name) != available.end()) {
      names.push_back(extension.name);
      enabled_.emplace_back(extension.name);
    } else if (extension.required) {
      throw NoDevice(fmt::format("the OpenXR runtime lacks {} ({})", extension.name, extension.without_it));
    } else {
      spdlog::info("the OpenXR runtime lacks {}: {}", extension.name, extension.without_it);
    }
  }

  XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO};
  std::strncpy(info.applicationInfo.applicationName, "Probewalk", XR_MAX_APPLICATION_NAME_SIZE - 1);
  std::strncpy(info.applicationInfo.engineName, "Probewalk", XR_MAX_ENGINE_NAME_SIZE - 1);
  info.applicationInfo.apiVersion = XR_API_VERSION_1_0;
  info.enabledExtensionCount = static_cast<std::uint32_t>(names.size());
  info.enabledExtensionNames = names.data();
  if (const XrResult result = xrCreateInstance(&info, instance_.out()); XR_FAILED(result)) {
    throw NoDevice(fmt::format("no OpenXR runtime answers (xrCreateInstance: {}); is its service running?",
                               xr_result_name(result)));
  }

  XrSystemGetInfo wanted{XR_TYPE_SYSTEM_GET_INFO};
  wanted.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  if (const XrResult result = xrGetSystem(handle(), &wanted, &system_); XR_FAILED(result)) {
    throw NoDevice(fmt::format("the OpenXR runtime has no headset ({}); is it plugged in and switched on?",
                               xr_result_name(result)));
  }
  XrInstanceProperties runtime{XR_TYPE_INSTANCE_PROPERTIES};
  check_xr(xrGetInstanceProperties(handle(), &runtime), "xrGetInstanceProperties");
  XrSystemProperties headset{XR_TYPE_SYSTEM_PROPERTIES};
  check_xr(xrGetSystemProperties(handle(), system_, &headset), "xrGetSystemProperties");
  description_ = fmt::format("{} {}.{}.{}, {}", runtime.runtimeName, XR_VERSION_MAJOR(runtime.runtimeVersion),
                             XR_VERSION_MINOR(runtime.runtimeVersion), XR_VERSION_PATCH(runtime.runtimeVersion),
                             headset.systemName);
  to_xr_time_ = function<PFN_xrConvertTimespecTimeToTimeKHR>("xrConvertTimespecTimeToTimeKHR");
  from_xr_time_ = function<PFN_xrConvertTimeToTimespecTimeKHR>("xrConvertTimeToTimespecTimeKHR");
}

template <typename Function>
Function OpenXrInstance::function(const char* name) const {
  PFN_xrVoidFunction pointer = nullptr;
  check_xr(xrGetInstanceProcAddr(handle(), name, &pointer), name);
  return reinterpret_cast<Function>(pointer);
}

bool OpenXrInstance::has(const char* extension) const {
  return std::ranges::find(enabled_, extension) != enabled_.end();
}

DeviceHooks OpenXrInstance::device_hooks() const {
  // The specification wants the requirements asked for before an instance or device is made.
  XrGraphicsRequirementsVulkanKHR requirements{XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN2_KHR};
  check_xr(function<PFN_xrGetVulkanGraphicsRequirements2KHR>("xrGetVulkanGraphicsRequirements2KHR")(handle(), system_,
                                                                                                    &requirements),
           "xrGetVulkanGraphicsRequirements2KHR");
  DeviceHooks hooks;
  hooks.create_instance = [this](PFN_vkGetInstanceProcAddr loader, const VkInstanceCreateInfo& create,
                                 VkInstance* out) {
    XrVulkanInstanceCreateInfoKHR info{XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR};
    info.systemId = system_;
    info.pfnGetInstanceProcAddr = loader;
    info.vulkanCreateInfo = &create;
    VkResult result = VK_ERROR_INITIALIZATION_FAILED;
    check_xr(function<PFN_xrCreateVulkanInstanceKHR>("xrCreateVulkanInstanceKHR")(handle(), &info, out, &result),
             "xrCreateVulkanInstanceKHR");
    return result;
  };
  hooks.choose_physical_device = [this](VkInstance vulkan) {
    XrVulkanGraphicsDeviceGetInfoKHR info{XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR};
    info.systemId = system_;
    info.vulkanInstance = vulkan;
    VkPhysicalDevice device = VK_NULL_HANDLE;
    check_xr(function<PFN_xrGetVulkanGraphicsDevice2KHR>("xrGetVulkanGraphicsDevice2KHR")(handle(), &info, &device),
             "xrGetVulkanGraphicsDevice2KHR");
    return device;
  };
  hooks.create_device = [this](PFN_vkGetInstanceProcAddr loader, VkPhysicalDevice physical,
                               const VkDeviceCreateInfo& create, VkDevice* out) {
    XrVulkanDeviceCreateInfoKHR info{XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR};
    info.systemId = system_;
    info.pfnGetInstanceProcAddr = loader;
    info.vulkanPhysicalDevice = physical;
    info.vulkanCreateInfo = &create;
    VkResult result = VK_ERROR_INITIALIZATION_FAILED;
    check_xr(function<PFN_xrCreateVulkanDeviceKHR>("xrCreateVulkanDeviceKHR")(handle(), &info, out, &result),
             "xrCreateVulkanDeviceKHR");
    return result;
  };
  return hooks;
}

std::int64_t OpenXrInstance::monotonic_ns(XrTime time) const {
  timespec spec{};
  if (XR_FAILED(from_xr_time_(handle(), time, &spec))) return 0;
  return static_cast<std::int64_t>(spec.tv_sec) * kSecond_ns + spec.tv_nsec;
}

XrTime OpenXrInstance::xr_time(std::int64_t monotonic_ns) const {
  timespec spec{};
  spec.tv_sec = static_cast<time_t>(monotonic_ns / kSecond_ns);
  spec.tv_nsec = static_cast<long>(monotonic_ns % kSecond_ns);
  XrTime time = 0;
  if (XR_FAILED(to_xr_time_(handle(), &spec, &time))) return 0;
  return time;
}

}  // namespace probewalk
