#include "render/probe_blocks.h"

#include <algorithm>
#include <optional>
#include <ranges>
#include <span>

namespace probewalk {

std::uint64_t ProbeBlocks::bytes_of(const std::vector<DeviceProbe>& probes) {
  std::uint64_t bytes = 0;
  for (const DeviceProbe& probe : probes) bytes += device_bytes(probe);
  return bytes;
}

void ProbeBlocks::send(const Device& device, std::span<const std::uint32_t> words, std::uint64_t offset_bytes,
                       bool stage) {
  const ProbeArena::Piece& piece = pieces_.back();
  const auto bytes = std::as_bytes(words);
  if (bytes.empty()) return;
  // To the next multiple: what one read of aligned bytes takes in with the last word.
  const std::uint64_t end = (offset_bytes + bytes.size() + kDeviceBlockAlignment - 1) / kDeviceBlockAlignment;
  const std::uint64_t size_bytes = end * kDeviceBlockAlignment - offset_bytes;
  sent_bytes_ += size_bytes;
  if (stage || piece.mapped() == nullptr) {
    Staged& staged =
        staged_.emplace_back(pieces_.size() - 1, offset_bytes, Buffer(device, size_bytes, BufferMemory::kStaging));
    std::ranges::copy(bytes, staged.words.mapped());
    staged.words.flush();
  } else {
    std::ranges::copy(bytes, piece.mapped() + offset_bytes);
  }
}

VkDeviceAddress ProbeBlocks::place(const Device& device, ProbeArena& arena, const std::vector<std::uint32_t>& words,
                                   WordRange gap, bool stage) {
  if (words.empty()) return 0;
  const ProbeArena::Piece& piece = pieces_.emplace_back(arena.allocate(device_block_bytes(words)));
  const std::span all(words);
  if (gap.count > 0) {
    send(device, all.first(gap.first), 0, stage);
    const std::size_t after = gap.first + gap.count;
    send(device, all.subspan(after), after * sizeof(std::uint32_t), stage);
  } else {
    send(device, all, 0, stage);
  }
  if (piece.mapped() != nullptr && !stage) piece.flush();
  return piece.address();
}

ProbeBlocks::ProbeBlocks(const Device& device, ProbeArena& arena, const std::vector<DeviceProbe>& probes, bool stage) {
  for (const DeviceProbe& probe : probes) {
    const WordRange gap = probe.pyramid_is_open ? pyramid_range(probe.record) : WordRange{};
    const VkDeviceAddress geometry = place(device, arena, probe.geometry, gap, stage);
    addresses_.push_back({geometry, place(device, arena, probe.radiance, {}, stage)});
    if (probe.pyramid_is_open)
      open_pyramids_.push_back({geometry, probe.record.n_log2, (probe.record.flags & kFlagTiledSamples) != 0});
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
    const VkBufferCopy region{next_byte_, to.offset_bytes() + from.offset_bytes + next_byte_, bytes};
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

std::uint64_t ProbeBlocks::move_down(VkCommandBuffer commands, ProbeArena& arena, std::uint64_t budget_bytes,
                                     std::size_t most_pieces, std::size_t& next_piece,
                                     std::vector<ProbeArena::Piece>& left) {
  std::uint64_t moved = 0;
  const std::size_t end = std::min(pieces_.size(), next_piece + most_pieces);
  for (; next_piece < end && moved < budget_bytes; ++next_piece) {
    ProbeArena::Piece& piece = pieces_[next_piece];
    std::optional<ProbeArena::Piece> place = arena.allocate_before(piece);
    if (!place) continue;
    const VkBufferCopy region{piece.offset_bytes(), place->offset_bytes(), piece.size_bytes()};
    vkCmdCopyBuffer(commands, piece.buffer(), place->buffer(), 1, &region);
    for (Addresses& each : addresses_) {
      if (each.geometry == piece.address()) each.geometry = place->address();
      if (each.radiance == piece.address()) each.radiance = place->address();
    }
    moved += piece.size_bytes();
    left.push_back(std::exchange(piece, std::move(*place)));
  }
  return moved;
}

std::vector<Buffer> ProbeBlocks::take_staging() {
  for (Staged& staged : staged_) copied_.push_back(std::move(staged.words));
  staged_.clear();
  return std::exchange(copied_, {});
}

}  // namespace probewalk
