// A buffer with its memory.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>

#include "render/device.h"

struct VmaAllocation_T;

namespace probewalk {

enum class BufferMemory {
  kDevice,    // read by the GPU; mapped only where the device's own memory can be (integrated, software, large BAR)
  kStaging,   // written by the CPU once, in order, copied from by the GPU; mapped
  kShared,    // written by the CPU every frame, read by the GPU in place; mapped
  kReadback,  // written by the GPU, read by the CPU; mapped and cached
};

// Move-only; frees at destruction, so the GPU must be done with it (see RetirementQueue). Every buffer can be addressed
// from shaders and copied from and to.
class Buffer {
 public:
  Buffer() = default;
  // Throws VulkanError (VK_ERROR_OUT_OF_DEVICE_MEMORY) when there is no room.
  Buffer(const Device& device, VkDeviceSize size_bytes, BufferMemory memory, VkBufferUsageFlags extra_usage = 0);
  ~Buffer();
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }

  VkBuffer handle() const { return handle_; }
  VkDeviceSize size_bytes() const { return size_bytes_; }
  VkDeviceAddress address() const { return address_; }
  // Null when the memory cannot be mapped (kDevice on many GPUs).
  std::byte* mapped() const { return mapped_; }
  template <typename T>
  std::span<T> mapped_as() const {
    return {reinterpret_cast<T*>(mapped_), static_cast<std::size_t>(size_bytes_ / sizeof(T))};
  }
  // After the CPU has written, before the submit that reads; and before the CPU reads what the GPU wrote. No-ops on
  // coherent memory.
  void flush() const { flush(0, size_bytes_); }
  void flush(VkDeviceSize offset_bytes, VkDeviceSize size_bytes) const;
  void invalidate() const;

 private:
  void swap(Buffer& other) noexcept;

  const Device* device_ = nullptr;
  VkBuffer handle_ = VK_NULL_HANDLE;
  VmaAllocation_T* allocation_ = nullptr;
  VkDeviceSize size_bytes_ = 0;
  VkDeviceAddress address_ = 0;
  std::byte* mapped_ = nullptr;
};

// An address as shaders take it: low word, high word.
inline glm::uvec2 address_words(VkDeviceAddress address) {
  return {static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(address >> 32)};
}

}  // namespace probewalk
