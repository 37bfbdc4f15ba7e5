// The Vulkan instance, device and queue. How they are created is injected: OpenXR's vulkan_enable2 creates them through
// the runtime, the desktop path plugs in its own surface extensions. Everything else of render takes a Device&.
#pragma once

#include <volk.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

struct VmaAllocator_T;

namespace probewalk {

// What a frame source wants of the device. Empty functions = plain Vulkan calls.
struct DeviceHooks {
  std::vector<std::string> instance_extensions;  // required
  std::vector<std::string> device_extensions;    // required
  std::function<VkResult(PFN_vkGetInstanceProcAddr, const VkInstanceCreateInfo&, VkInstance*)> create_instance;
  std::function<VkPhysicalDevice(VkInstance)> choose_physical_device;
  std::function<VkResult(PFN_vkGetInstanceProcAddr, VkPhysicalDevice, const VkDeviceCreateInfo&, VkDevice*)> create_device;
  // Whether a queue family can present (window); empty = no presentation wanted.
  std::function<bool(VkInstance, VkPhysicalDevice, std::uint32_t family)> can_present;
};

struct DeviceOptions {
  std::string device;       // --device NAME|INDEX: substring of the name or index; "" = best (discrete first, CPU last)
  bool validation = false;  // VK_LAYER_KHRONOS_validation; its messages are counted and logged
};

struct DeviceInfo {
  std::string name;
  std::string driver;  // name and version
  std::string api_version;
  bool is_software = false;  // VK_PHYSICAL_DEVICE_TYPE_CPU
  bool suitable = false;
  std::string missing;  // why not
};

class Device {
 public:
  // Throws NoDevice with the list of devices seen and what each lacks.
  Device(const DeviceHooks& hooks, const DeviceOptions& options);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  static std::vector<DeviceInfo> list();  // --list-devices

  VkInstance instance() const;
  VkPhysicalDevice physical() const;
  VkDevice handle() const;
  VkQueue queue() const;
  std::uint32_t queue_family() const;
  // Of a queue that only copies, beside the other; where the device has none, the other's.
  std::uint32_t copy_queue_family() const;
  bool has_copy_queue() const { return copy_queue_family() != queue_family(); }
  VmaAllocator_T* allocator() const;
  const DeviceInfo& info() const;
  bool has_calibrated_timestamps() const;
  float timestamp_period_ns() const;
  // Errors and warnings that the validation layer has reported so far.
  std::uint32_t validation_messages() const;
  // Bytes of device memory allocated through this device and not freed, as vkAllocateMemory saw them.
  std::uint64_t allocated_bytes() const;
  // What of the device's own memory may still be taken, by the driver's estimate (VK_EXT_memory_budget, where offered, or
  // the greater part of the heap).
  std::uint64_t free_bytes() const;
  // Pipelines made for this device so far: what a frame must not wait for. Whoever makes one counts it.
  std::uint32_t pipelines_built() const;
  void count_pipeline() const;
  // To be held around calls of others that use the queue (xrEndFrame and the like).
  [[nodiscard]] std::unique_lock<std::mutex> lock_queue() const;
  // Serialises vkQueueSubmit and friends between the frame thread, the loader and the mirror.
  void submit(const VkSubmitInfo2& info, VkFence fence) const;
  // The same to the queue of copy_queue_family().
  void submit_copies(const VkSubmitInfo2& info) const;
  // vkQueuePresentKHR, which may wait for the display: on a queue of its own, where the family has a second one, so that
  // no frame waits for it. What signals its semaphores has been submitted before.
  VkResult present(const VkPresentInfoKHR& info) const;
  void wait_idle() const;
  // The same where nothing may be thrown, in destructors: what a lost device was at is at an end too.
  void wait_idle_or_lost() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace probewalk
