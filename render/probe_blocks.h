// The memory of one room at one level: a piece of the arena for each block of each probe.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "content/probe/device_probe.h"
#include "render/buffer.h"
#include "render/probe_arena.h"
#include "render/pyramid_builder.h"

namespace probewalk {

class ProbeBlocks {
 public:
  // Allocates and copies. With `stage`, or where the device's memory cannot be mapped, into staging memory, from which
  // copy() must still be called. Throws VulkanError when there is no room. Must end before the arena.
  ProbeBlocks(const Device& device, ProbeArena& arena, const std::vector<DeviceProbe>& probes, bool stage);

  static std::uint64_t bytes_of(const std::vector<DeviceProbe>& probes);

  // Address pairs, in the probes' order.
  struct Addresses {
    VkDeviceAddress geometry = 0;
    VkDeviceAddress radiance = 0;
  };
  const std::vector<Addresses>& addresses() const { return addresses_; }
  std::uint64_t size_bytes() const;
  // Of them what comes from the host.
  std::uint64_t sent_bytes() const { return sent_bytes_; }
  // Where pyramids are to be built once all is there; empties.
  std::vector<PyramidJob::Site> take_open_pyramids() { return std::exchange(open_pyramids_, {}); }

  // Records copies of at most `budget_bytes` from staging memory; returns how many.
  std::uint64_t copy(VkCommandBuffer commands, std::uint64_t budget_bytes);
  bool is_complete() const { return staged_.empty(); }
  // Records copies of pieces that are there to free places before them in the arena, until they come to `budget_bytes`;
  // from the `next_piece`th on, which moves on past those looked at, at most `most_pieces`. Returns how many bytes.
  // What was left goes to `left`, to be kept as long as the GPU reads it; the addresses change.
  std::uint64_t move_down(VkCommandBuffer commands, ProbeArena& arena, std::uint64_t budget_bytes,
                          std::size_t most_pieces, std::size_t& next_piece, std::vector<ProbeArena::Piece>& left);
  std::size_t piece_count() const { return pieces_.size(); }
  // What copies have read from or would have, to be kept until the GPU is done with it; and the words themselves.
  std::vector<Buffer> take_staging();
  std::vector<ProbeArena::Piece> take_pieces() { return std::move(pieces_); }

 private:
  struct Staged {
    std::size_t piece;           // index in pieces_
    std::uint64_t offset_bytes;  // in the piece
    Buffer words;
  };
  // All but `gap` of the words comes from the host.
  VkDeviceAddress place(const Device& device, ProbeArena& arena, const std::vector<std::uint32_t>& words, WordRange gap,
                        bool stage);
  void send(const Device& device, std::span<const std::uint32_t> words, std::uint64_t offset_bytes, bool stage);

  std::vector<ProbeArena::Piece> pieces_;
  std::deque<Staged> staged_;   // still to be copied
  std::vector<Buffer> copied_;  // staging memory that recorded copies read
  std::vector<Addresses> addresses_;
  std::vector<PyramidJob::Site> open_pyramids_;
  std::uint64_t sent_bytes_ = 0;
  std::uint64_t next_byte_ = 0;  // of the first staged piece
};

}  // namespace probewalk
