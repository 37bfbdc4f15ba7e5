#include "render/device_requirements.h"

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "render/check.h"

namespace probewalk {
namespace {

std::string version_text(std::uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

std::vector<VkQueueFamilyProperties> queue_families(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return families;
}

void note_missing(std::string& missing, const std::string& what) {
  missing += missing.empty() ? what : ", " + what;
}

}  // namespace

RequiredFeatures::RequiredFeatures() {
  dynamic_rendering = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES, nullptr, VK_TRUE};
  synchronization2 = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES, &dynamic_rendering, VK_TRUE};
  buffer_addresses = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES, &synchronization2, VK_TRUE,
                      VK_FALSE, VK_FALSE};
  scalar_layout = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SCALAR_BLOCK_LAYOUT_FEATURES, &buffer_addresses, VK_TRUE};
  timeline = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES, &scalar_layout, VK_TRUE};
  query_reset = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_HOST_QUERY_RESET_FEATURES, &timeline, VK_TRUE};
  head.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  head.pNext = &query_reset;
}

std::optional<std::uint32_t> find_queue_family(VkPhysicalDevice device, const CanPresent& can_present) {
  constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  const auto families = queue_families(device);
  for (std::uint32_t family = 0; family < families.size(); ++family) {
    if ((families[family].queueFlags & kNeeded) != kNeeded || families[family].queueCount == 0) continue;
    if (can_present && !can_present(family)) continue;
    return family;
  }
  return std::nullopt;
}

std::optional<std::uint32_t> find_copy_queue_family(VkPhysicalDevice device) {
  const auto families = queue_families(device);
  for (std::uint32_t family = 0; family < families.size(); ++family) {
    const VkQueueFlags flags = families[family].queueFlags;
    const bool only_copies =
        (flags & VK_QUEUE_TRANSFER_BIT) != 0 && (flags & (VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT)) == 0;
    if (only_copies && families[family].queueCount > 0) return family;
  }
  return std::nullopt;
}

std::uint32_t queue_count(VkPhysicalDevice device, std::uint32_t family) {
  return queue_families(device).at(family).queueCount;
}

bool has_extension(VkPhysicalDevice device, const char* name) {
  std::uint32_t count = 0;
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> properties(count);
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, properties.data()),
        "vkEnumerateDeviceExtensionProperties");
  for (const VkExtensionProperties& property : properties) {
    if (std::strcmp(property.extensionName, name) == 0) return true;
  }
  return false;
}

DeviceInfo describe_device(VkPhysicalDevice device, const std::vector<std::string>& extensions,
                           const CanPresent& can_present) {
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  VkPhysicalDeviceProperties first{};
  vkGetPhysicalDeviceProperties(device, &first);
  const bool is_1_2 = first.apiVersion >= VK_API_VERSION_1_2;
  if (is_1_2) {
    properties.pNext = &driver;
    vkGetPhysicalDeviceProperties2(device, &properties);
  }
  DeviceInfo info;
  info.name = first.deviceName;
  info.driver = is_1_2 ? fmt::format("{} {}", driver.driverName, driver.driverInfo) : version_text(first.driverVersion);
  info.api_version = version_text(first.apiVersion);
  info.is_software = first.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;

  if (first.apiVersion < VK_API_VERSION_1_3) {
    note_missing(info.missing, "Vulkan 1.3");
  } else {
    RequiredFeatures has;
    vkGetPhysicalDeviceFeatures2(device, &has.head);
    const std::array<std::pair<VkBool32, const char*>, 6> needed{{
        {has.dynamic_rendering.dynamicRendering, "dynamicRendering"},
        {has.synchronization2.synchronization2, "synchronization2"},
        {has.buffer_addresses.bufferDeviceAddress, "bufferDeviceAddress"},
        {has.scalar_layout.scalarBlockLayout, "scalarBlockLayout"},
        {has.timeline.timelineSemaphore, "timelineSemaphore"},
        {has.query_reset.hostQueryReset, "hostQueryReset"},
    }};
    for (const auto& [present, name] : needed) {
      if (!present) note_missing(info.missing, name);
    }
  }
  for (const std::string& extension : extensions) {
    if (!has_extension(device, extension.c_str())) note_missing(info.missing, extension);
  }
  if (!find_queue_family(device, {})) {
    note_missing(info.missing, "a queue with graphics and compute");
  } else if (can_present && !find_queue_family(device, can_present)) {
    note_missing(info.missing, "presentation to the window");
  }
  info.suitable = info.missing.empty();
  return info;
}

int device_rank(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(device, &properties);
  switch (properties.deviceType) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return 4;
    default: return 3;
  }
}

}  // namespace probewalk
