// The OpenXR runtime and its headset, before there is a session: extensions, system, and the creation of the Vulkan
// instance and device through the runtime (XR_KHR_vulkan_enable2).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/device.h"
#include "xr/openxr_api.h"

namespace probewalk {

class OpenXrInstance {
 public:
  // Throws NoDevice when no runtime answers, it lacks a required extension, or no headset is there.
  OpenXrInstance();
  OpenXrInstance(const OpenXrInstance&) = delete;
  OpenXrInstance& operator=(const OpenXrInstance&) = delete;

  XrInstance handle() const { return instance_.get(); }
  XrSystemId system() const { return system_; }
  bool has(const char* extension) const;
  // "Monado 25.0.0, Simulated HMD".
  const std::string& description() const { return description_; }

  // Creation of the Vulkan instance and device through the runtime. The hooks refer to this object.
  DeviceHooks device_hooks() const;

  // XrTime and CLOCK_MONOTONIC. 0 when the runtime is gone.
  std::int64_t monotonic_ns(XrTime time) const;
  XrTime xr_time(std::int64_t monotonic_ns) const;

 private:
  template <typename Function>
  Function function(const char* name) const;

  XrOwned<XrInstance, xrDestroyInstance> instance_;
  XrSystemId system_ = XR_NULL_SYSTEM_ID;
  std::vector<std::string> enabled_;
  std::string description_;
  PFN_xrConvertTimespecTimeToTimeKHR to_xr_time_ = nullptr;
  PFN_xrConvertTimeToTimespecTimeKHR from_xr_time_ = nullptr;
};

}  // namespace probewalk
