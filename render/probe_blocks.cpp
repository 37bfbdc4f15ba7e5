#include "render/probe_blocks.h"

#include <algorithm>
#include <cstddef>
#include <ranges>
#include <span>
#include <utility>

#include "render/check.h"

namespace probewalk {
namespace {

std::uint64_t largest_buffer_bytes(const Device& device) {
  VkPhysicalDeviceMaintenance4Properties sizes{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
  VkPhysicalDeviceMaintenance3Properties allocations{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES, &sizes};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &allocations};
  vkGetPhysicalDeviceProperties2(device.physical(), &properties);
  return std::min({sizes.maxBufferSize, allocations.maxMemoryAllocationSize, VkDeviceSize{1} << 31});
}

// Half-open ranges of probes, each of which fits one buffer (a single probe is at most 1.2 GiB).
std::vector<std::pair<std::size_t, std::size_t>> split(const std::vector<DeviceProbe>& probes, std::uint64_t limit) {
  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const std::uint64_t more = device_bytes(probes[i]);
    if (ranges.empty() || bytes + more > limit) {
      ranges.emplace_back(i, i);
      bytes = 0;
    }
    ranges.back().second = i + 1;
    bytes += more;
  }
  return ranges;
}

}  // namespace

std::uint64_t ProbeBlocks::bytes_of(const std::vector<DeviceProbe>& probes) {
  std::uint64_t bytes = 0;
  for (const DeviceProbe& probe : probes) bytes += device_bytes(probe);
  return bytes;
}

ProbeBlocks::ProbeBlocks(const Device& device, const std::vector<DeviceProbe>& probes, bool stage) {
  for (const auto& [first, end] : split(probes, largest_buffer_bytes(device))) {
    std::uint64_t bytes = 0;
    for (std::size_t i = first; i < end; ++i) bytes += device_bytes(probes[i]);
    blocks_.emplace_back(device, bytes, BufferMemory::kDevice);
    const bool is_staged = stage || blocks_.back().mapped() == nullptr;
    if (is_staged) staged_.push_back({blocks_.size() - 1, Buffer(device, bytes, BufferMemory::kStaging)});
    const Buffer& written = is_staged ? staged_.back().words : blocks_.back();
    std::uint64_t offset = 0;
    const auto append = [&](const std::vector<std::uint32_t>& words) {
      std::ranges::copy(std::as_bytes(std::span(words)), written.mapped() + offset);  // of none, too
      return blocks_.back().address() + std::exchange(offset, offset + device_block_bytes(words));
    };
    for (std::size_t i = first; i < end; ++i) {
      const VkDeviceAddress geometry = append(probes[i].geometry);
      addresses_.push_back({geometry, append(probes[i].radiance)});
    }
    written.flush();
  }
}

std::uint64_t ProbeBlocks::size_bytes() const {
  std::uint64_t bytes = 0;
  for (const Buffer& block : blocks_) bytes += block.size_bytes();
  return bytes;
}

std::uint64_t ProbeBlocks::copy(VkCommandBuffer commands, std::uint64_t budget_bytes) {
  std::uint64_t copied = 0;
  while (!is_complete() && copied < budget_bytes) {
    Staged& from = staged_.front();
    const std::uint64_t bytes = std::min(budget_bytes - copied, from.words.size_bytes() - next_byte_);
    const VkBufferCopy region{next_byte_, next_byte_, bytes};
    vkCmdCopyBuffer(commands, from.words.handle(), blocks_[from.block].handle(), 1, &region);
    copied += bytes;
    next_byte_ += bytes;
    if (next_byte_ < from.words.size_bytes()) break;
    copied_.push_back(std::move(from.words));
    staged_.pop_front();
    next_byte_ = 0;
  }
  return copied;
}

std::vector<Buffer> ProbeBlocks::take_staging() {
  for (Staged& staged : staged_) copied_.push_back(std::move(staged.words));
  staged_.clear();
  return std::exchange(copied_, {});
}

}  // namespace probewalk
