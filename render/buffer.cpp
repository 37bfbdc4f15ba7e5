#include "render/buffer.h"

#include <array>

#include "render/check.h"
#include "render/vma.h"

namespace probewalk {
namespace {

VmaAllocationCreateInfo allocation_info(BufferMemory memory) {
  VmaAllocationCreateInfo info{};
  info.usage = VMA_MEMORY_USAGE_AUTO_PREFER_DEVICE;
  switch (memory) {
    case BufferMemory::kDevice:
      info.flags = VMA_ALLOCATION_CREATE_HOST_ACCESS_SEQUENTIAL_WRITE_BIT |
                   VMA_ALLOCATION_CREATE_HOST_ACCESS_ALLOW_TRANSFER_INSTEAD_BIT | VMA_ALLOCATION_CREATE_MAPPED_BIT;
      break;
    case BufferMemory::kStaging:
      info.usage = VMA_MEMORY_USAGE_AUTO_PREFER_HOST;
      info.flags = VMA_ALLOCATION_CREATE_HOST_ACCESS_SEQUENTIAL_WRITE_BIT | VMA_ALLOCATION_CREATE_MAPPED_BIT;
      break;
    case BufferMemory::kShared:
      info.flags = VMA_ALLOCATION_CREATE_HOST_ACCESS_SEQUENTIAL_WRITE_BIT | VMA_ALLOCATION_CREATE_MAPPED_BIT;
      break;
    case BufferMemory::kReadback:
      info.usage = VMA_MEMORY_USAGE_AUTO_PREFER_HOST;
      info.flags = VMA_ALLOCATION_CREATE_HOST_ACCESS_RANDOM_BIT | VMA_ALLOCATION_CREATE_MAPPED_BIT;
      break;
  }
  return info;
}

}  // namespace

Buffer::Buffer(const Device& device, VkDeviceSize size_bytes, BufferMemory memory, VkBufferUsageFlags extra_usage)
    : device_(&device), size_bytes_(size_bytes) {
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = size_bytes;
  info.usage = VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | extra_usage;
  // Copied to on one queue and read on another, without handing over from family to family.
  const std::array families{device.queue_family(), device.copy_queue_family()};
  const bool is_copied = memory == BufferMemory::kDevice || memory == BufferMemory::kStaging;
  if (is_copied && families[0] != families[1]) {
    info.sharingMode = VK_SHARING_MODE_CONCURRENT;
    info.queueFamilyIndexCount = static_cast<std::uint32_t>(families.size());
    info.pQueueFamilyIndices = families.data();
  }
  const VmaAllocationCreateInfo wanted = allocation_info(memory);
  VmaAllocationInfo allocated{};
  check(vmaCreateBuffer(device.allocator(), &info, &wanted, &handle_, &allocation_, &allocated), "vmaCreateBuffer");
  mapped_ = static_cast<std::byte*>(allocated.pMappedData);
  VkBufferDeviceAddressInfo address_info{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO};
  address_info.buffer = handle_;
  address_ = vkGetBufferDeviceAddress(device.handle(), &address_info);
}

Buffer::~Buffer() {
  if (handle_ != VK_NULL_HANDLE) vmaDestroyBuffer(device_->allocator(), handle_, allocation_);
}

void Buffer::flush(VkDeviceSize offset_bytes, VkDeviceSize size_bytes) const {
  check(vmaFlushAllocation(device_->allocator(), allocation_, offset_bytes, size_bytes), "vmaFlushAllocation");
}

void Buffer::invalidate() const {
  check(vmaInvalidateAllocation(device_->allocator(), allocation_, 0, VK_WHOLE_SIZE), "vmaInvalidateAllocation");
}

void Buffer::swap(Buffer& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(handle_, other.handle_);
  std::swap(allocation_, other.allocation_);
  std::swap(size_bytes_, other.size_bytes_);
  std::swap(address_, other.address_);
  std::swap(mapped_, other.mapped_);
}

}  // namespace probewalk
