// The device memory that probes' words live in: taken in one go when its size is known, in blocks as needed when not;
// handed out in pieces without asking the driver again.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <utility>

#include "render/buffer.h"
#include "render/device.h"

struct VmaVirtualBlock_T;
struct VmaVirtualAllocation_T;

namespace probewalk {

class ProbeArena {
  struct Block;

 public:
  // size_bytes: all there will ever be, reserved now; 0: grows, and shrinks when blocks are empty.
  // Throws VulkanError (VK_ERROR_OUT_OF_DEVICE_MEMORY) when there is no room.
  explicit ProbeArena(const Device& device, std::uint64_t size_bytes = 0);
  ~ProbeArena();
  ProbeArena(const ProbeArena&) = delete;
  ProbeArena& operator=(const ProbeArena&) = delete;

  // Move-only; goes back at destruction, so the GPU must be done with it, and the arena must still be there.
  class Piece {
   public:
    Piece() = default;
    ~Piece();
    Piece(Piece&& other) noexcept { swap(other); }
    Piece& operator=(Piece&& other) noexcept {
      swap(other);
      return *this;
    }

    VkBuffer buffer() const;
    std::uint64_t offset_bytes() const { return offset_bytes_; }
    std::uint64_t size_bytes() const { return size_bytes_; }
    VkDeviceAddress address() const;  // a multiple of kDeviceBlockAlignment
    // Null when the device's memory cannot be mapped.
    std::byte* mapped() const;
    // After the CPU has written, before the submit that reads.
    void flush() const;

   private:
    friend class ProbeArena;
    void swap(Piece& other) noexcept {
      std::swap(arena_, other.arena_);
      std::swap(block_, other.block_);
      std::swap(allocation_, other.allocation_);
      std::swap(offset_bytes_, other.offset_bytes_);
      std::swap(size_bytes_, other.size_bytes_);
    }

    ProbeArena* arena_ = nullptr;
    Block* block_ = nullptr;
    VmaVirtualAllocation_T* allocation_ = nullptr;
    std::uint64_t offset_bytes_ = 0;
    std::uint64_t size_bytes_ = 0;
  };

  // Any thread. Throws VulkanError (VK_ERROR_OUT_OF_DEVICE_MEMORY) when no room is left, or none in one piece.
  Piece allocate(std::uint64_t size_bytes);
  // Of an arena of stated size, in pieces of up to `largest_piece_bytes`: what may be held for nearly every level to
  // find room (all but one in a thousand where there is room for 50 pieces). The fewer pieces there is room for, the
  // more is lost between them.
  static double usable_share(std::uint64_t size_bytes, std::uint64_t largest_piece_bytes);
  // Taken from the device, whether handed out or not.
  std::uint64_t reserved_bytes() const;

 private:
  struct Block {
    Block(const Device& device, std::uint64_t size_bytes);
    ~Block();
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;

    Buffer buffer;
    VmaVirtualBlock_T* pieces = nullptr;
  };

  // Small, so that what a few rooms take is close to what is reserved.
  static constexpr std::uint64_t kGrowth_bytes = 32u << 20;

  void add_block(std::uint64_t size_bytes);
  void grow(std::uint64_t least_bytes);
  bool take(Block& block, std::uint64_t size_bytes, Piece& piece);
  void give_back(const Piece& piece);

  const Device& device_;
  const bool grows_;
  const std::uint64_t largest_block_bytes_;
  mutable std::mutex mutex_;
  std::uint64_t growth_bytes_ = kGrowth_bytes;  // less where the device had no room for as much
  std::list<Block> blocks_;
};

}  // namespace probewalk
