// What the renderer needs of a Vulkan device, and what a given device lacks of it.
#pragma once

#include <volk.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "render/device.h"

namespace probewalk {

// The features that are switched on, chained from `head`. Not movable: the chain holds addresses. One structure a
// feature: an OpenXR runtime appends what it needs, finds what is there by structure type, and knows these.
struct RequiredFeatures {
  RequiredFeatures();
  RequiredFeatures(const RequiredFeatures&) = delete;
  RequiredFeatures& operator=(const RequiredFeatures&) = delete;

  VkPhysicalDeviceDynamicRenderingFeatures dynamic_rendering{};
  VkPhysicalDeviceSynchronization2Features synchronization2{};
  VkPhysicalDeviceBufferDeviceAddressFeatures buffer_addresses{};  // the tracer follows addresses
  VkPhysicalDeviceScalarBlockLayoutFeatures scalar_layout{};       // structs shared with C++
  VkPhysicalDeviceTimelineSemaphoreFeatures timeline{};            // frames in flight
  VkPhysicalDeviceHostQueryResetFeatures query_reset{};            // time stamps
  VkPhysicalDeviceFeatures2 head{};
};

// Whether a queue family can present to the caller's surface; empty = no matter.
using CanPresent = std::function<bool(std::uint32_t family)>;

// A family with graphics and compute (and presentation), if any.
std::optional<std::uint32_t> find_queue_family(VkPhysicalDevice device, const CanPresent& can_present);

// A family that only copies, and copies any bytes, if there is one.
std::optional<std::uint32_t> find_copy_queue_family(VkPhysicalDevice device);

std::uint32_t queue_count(VkPhysicalDevice device, std::uint32_t family);

bool has_extension(VkPhysicalDevice device, const char* name);

// Describes the device; `suitable` and `missing` are judged with these extensions and presentation in addition.
DeviceInfo describe_device(VkPhysicalDevice device, const std::vector<std::string>& extensions,
                           const CanPresent& can_present);

// Orders devices: discrete first, then integrated, virtual, others, software last.
int device_rank(VkPhysicalDevice device);

}  // namespace probewalk
