#include "render/probe_blocks.h"

#include <algorithm>
#include <ranges>
#include <span>

namespace probewalk {

std::uint64_t ProbeBlocks::bytes_of(const std::vector<DeviceProbe>& probes) {
  std::uint64_t bytes = 0;
  for (const DeviceProbe& probe : probes) bytes += device_bytes(probe);
  return bytes;
}

VkDeviceAddress ProbeBlocks::place(const Device& device, ProbeArena& arena, const std::vector<std::uint32_t>& words,
                                   bool stage) {
  if (words.empty()) return 0;
  ProbeArena::Piece& piece = pieces_.emplace_back(arena.allocate(device_block_bytes(words)));
  const std::span bytes = std::as_bytes(std::span(words));
  if (stage || piece.mapped() == nullptr) {
    Staged& staged =
        staged_.emplace_back(pieces_.size() - 1, Buffer(device, piece.size_bytes(), BufferMemory::kStaging));
    std::ranges::copy(bytes, staged.words.mapped());
    staged.words.flush();
  } else {
    std::ranges::copy(bytes, piece.mapped());
    piece.flush();
  }
  return piece.address();
}

ProbeBlocks::ProbeBlocks(const Device& device, ProbeArena& arena, const std::vector<DeviceProbe>& probes, bool stage) {
  for (const DeviceProbe& probe : probes) {
    const VkDeviceAddress geometry = place(device, arena, probe.geometry, stage);
    addresses_.push_back({geometry, place(device, arena, probe.radiance, stage)});
  }
}

std::uint64_t ProbeBlocks::size_bytes() const {
  std::uint64_t bytes = 0;
  for (const ProbeArena::Piece& piece : pieces_) bytes += piece.size_bytes();
  return bytes;
}

std::uint64_t ProbeBlocks::copy(VkCommandBuffer commands, std::uint64_t budget_bytes) {
  std::uint64_t copied = 0;
  while (!is_complete() && copied < budget_bytes) {
    Staged& from = staged_.front();
    const ProbeArena::Piece& to = pieces_[from.piece];
    const std::uint64_t bytes = std::min(budget_bytes - copied, from.words.size_bytes() - next_byte_);
    const VkBufferCopy region{next_byte_, to.offset_bytes() + next_byte_, bytes};
    vkCmdCopyBuffer(commands, from.words.handle(), to.buffer(), 1, &region);
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
