#include "render/probe_arena.h"

#include <fmt/format.h>

#include <algorithm>

#include "content/probe/device_probe.h"
#include "render/check.h"
#include "render/vma.h"

namespace probewalk {
namespace {

std::uint64_t largest_buffer_bytes(const Device& device) {
  VkPhysicalDeviceMaintenance4Properties sizes{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
  VkPhysicalDeviceMaintenance3Properties allocations{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
                                                     &sizes};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &allocations};
  vkGetPhysicalDeviceProperties2(device.physical(), &properties);
  return std::min({sizes.maxBufferSize, allocations.maxMemoryAllocationSize, VkDeviceSize{1} << 31});
}

}  // namespace

ProbeArena::Block::Block(const Device& device, std::uint64_t size_bytes)
    : buffer(device, size_bytes, BufferMemory::kDevice) {
  VmaVirtualBlockCreateInfo info{};
  info.size = size_bytes;
  check(vmaCreateVirtualBlock(&info, &pieces), "vmaCreateVirtualBlock");
}

ProbeArena::Block::~Block() {
  vmaDestroyVirtualBlock(pieces);
}

ProbeArena::ProbeArena(const Device& device, std::uint64_t size_bytes)
    : device_(device), grows_(size_bytes == 0), largest_block_bytes_(largest_buffer_bytes(device)) {
  while (size_bytes > 0) {
    const std::uint64_t block = std::min(size_bytes, largest_block_bytes_);
    add_block(block);
    size_bytes -= block;
  }
}

ProbeArena::~ProbeArena() = default;

void ProbeArena::add_block(std::uint64_t size_bytes) {
  blocks_.emplace_back(device_, size_bytes);
}

// Where the device has no room for as much, for half of it, at least for what is asked for.
void ProbeArena::grow(std::uint64_t least_bytes) {
  while (true) {
    const std::uint64_t bytes = std::min(std::max(least_bytes, growth_bytes_), largest_block_bytes_);
    try {
      return add_block(bytes);
    } catch (const VulkanError& error) {
      if (error.result != VK_ERROR_OUT_OF_DEVICE_MEMORY || bytes <= least_bytes) throw;
    }
    growth_bytes_ /= 2;
  }
}

bool ProbeArena::take(Block& block, std::uint64_t size_bytes, Piece& piece) {
  VmaVirtualAllocationCreateInfo info{};
  info.size = size_bytes;
  info.alignment = kDeviceBlockAlignment;
  // Levels of a few sizes come and go: the fullest place that fits keeps large ones free.
  info.flags = VMA_VIRTUAL_ALLOCATION_CREATE_STRATEGY_MIN_MEMORY_BIT;
  VmaVirtualAllocation allocation = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;
  if (vmaVirtualAllocate(block.pieces, &info, &allocation, &offset) != VK_SUCCESS) return false;  // no room in it
  piece.arena_ = this;
  piece.block_ = &block;
  piece.allocation_ = allocation;
  piece.offset_bytes_ = offset;
  piece.size_bytes_ = size_bytes;
  return true;
}

ProbeArena::Piece ProbeArena::allocate(std::uint64_t size_bytes) {
  Piece piece;
  const std::lock_guard lock(mutex_);
  for (Block& block : blocks_) {
    if (take(block, size_bytes, piece)) return piece;
  }
  if (grows_ && size_bytes <= largest_block_bytes_) {
    grow(size_bytes);
    if (take(blocks_.back(), size_bytes, piece)) return piece;
  }
  throw VulkanError(VK_ERROR_OUT_OF_DEVICE_MEMORY,
                    fmt::format("the device memory for probes has no room for {} more bytes in one piece", size_bytes));
}

void ProbeArena::give_back(const Piece& piece) {
  const std::lock_guard lock(mutex_);
  vmaVirtualFree(piece.block_->pieces, piece.allocation_);
  if (grows_ && vmaIsVirtualBlockEmpty(piece.block_->pieces)) {
    blocks_.remove_if([&](const Block& block) { return &block == piece.block_; });
    growth_bytes_ = kGrowth_bytes;
  }
}

double ProbeArena::usable_share(std::uint64_t size_bytes, std::uint64_t largest_piece_bytes) {
  // Measured on levels that come and go at random (ProbeArenaTest): 56 largest pieces need a fifth, 500 an eighth.
  // With room for a dozen more is lost, but a reserve of more than a quarter would cost more than what is refused.
  constexpr double kLostPieces = 12.0, kLeastLost = 1.0 / 8.0, kMostLost = 1.0 / 4.0;
  const double lost = kLostPieces * static_cast<double>(largest_piece_bytes) / static_cast<double>(size_bytes);
  return 1.0 - std::clamp(lost, kLeastLost, kMostLost);
}

std::uint64_t ProbeArena::reserved_bytes() const {
  const std::lock_guard lock(mutex_);
  std::uint64_t bytes = 0;
  for (const Block& block : blocks_) bytes += block.buffer.size_bytes();
  return bytes;
}

ProbeArena::Piece::~Piece() {
  if (arena_ != nullptr) arena_->give_back(*this);
}

VkBuffer ProbeArena::Piece::buffer() const {
  return block_->buffer.handle();
}
VkDeviceAddress ProbeArena::Piece::address() const {
  return block_->buffer.address() + offset_bytes_;
}

std::byte* ProbeArena::Piece::mapped() const {
  std::byte* const all = block_->buffer.mapped();
  return all == nullptr ? nullptr : all + offset_bytes_;
}

void ProbeArena::Piece::flush() const {
  block_->buffer.flush(offset_bytes_, size_bytes_);
}

}  // namespace probewalk
