// The memory of one room at one level: a piece of the arena for each block of each probe.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "content/probe/device_probe.h"
#include "render/buffer.h"
#include "render/probe_arena.h"

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

  // Records copies of at most `budget_bytes` from staging memory; returns how many.
  std::uint64_t copy(VkCommandBuffer commands, std::uint64_t budget_bytes);
  bool is_complete() const { return staged_.empty(); }
  // What copies have read from or would have, to be kept until the GPU is done with it; and the words themselves.
  std::vector<Buffer> take_staging();
  std::vector<ProbeArena::Piece> take_pieces() { return std::move(pieces_); }

 private:
  struct Staged {
    std::size_t piece;  // index in pieces_
    Buffer words;
  };
  VkDeviceAddress place(const Device& device, ProbeArena& arena, const std::vector<std::uint32_t>& words, bool stage);

  std::vector<ProbeArena::Piece> pieces_;
  std::deque<Staged> staged_;   // still to be copied
  std::vector<Buffer> copied_;  // staging memory that recorded copies read
  std::vector<Addresses> addresses_;
  std::uint64_t next_byte_ = 0;  // of the first staged piece
};

}  // namespace probewalk
