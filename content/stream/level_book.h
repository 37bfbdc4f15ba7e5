// What is where: the status and the device bytes of every level of every room, with the sums that decisions need kept
// as they change, so that no frame has to count.
#pragma once

#include <cstdint>
#include <vector>

#include "content/pack/manifest.h"
#include "content/probe/tiled_samples.h"

namespace probewalk {

struct LevelKey {
  std::uint32_t room = 0;
  std::uint32_t level = 0;
  auto operator<=>(const LevelKey&) const = default;
};

enum class LevelStatus : std::uint8_t {
  kAbsent,
  kLoading,
  kResident,
  kFailed,  // could not be loaded: not asked for while it is so, the next coarser level stands in
};

// Device bytes to set aside for a level of a room before it has been decoded: what the pack states, kept within what
// maps of its size can take.
std::uint64_t planned_bytes(const RoomEntry& room, const LevelEntry& level, DeviceSamples samples = kDefaultSamples);

class LevelBook {
 public:
  // Every level absent, with its planned bytes. The manifest outlives the book.
  explicit LevelBook(const Manifest& manifest, DeviceSamples samples = kDefaultSamples);

  std::uint32_t rooms() const { return static_cast<std::uint32_t>(first_.size() - 1); }
  std::uint32_t levels(std::uint32_t room) const { return first_[room + 1] - first_[room]; }
  LevelStatus status(LevelKey key) const { return entries_[index(key)].status; }
  std::uint64_t bytes(LevelKey key) const { return entries_[index(key)].bytes; }
  std::uint64_t bytes_disk(LevelKey key) const { return entries_[index(key)].bytes_disk; }
  // Octaves of detail over a map of one cell a side, from the coarsest level 0 to the finest: of the measured errors
  // where all levels of the room have one, else of the maps' sides. Rises with the level.
  double quality(LevelKey key) const { return entries_[index(key)].quality; }
  // Finest resident level; -1 = none.
  int shown(std::uint32_t room) const;

  void set(LevelKey key, LevelStatus status);
  // It has been decoded, and takes this much.
  void learn(LevelKey key, std::uint64_t bytes);

  std::uint64_t held_bytes() const { return held_bytes_; }      // loading and resident
  std::uint32_t loading() const { return static_cast<std::uint32_t>(loading_.size()); }  // levels
  const std::vector<LevelKey>& loading_keys() const { return loading_; }                 // in no order
  std::uint64_t coarse_bytes() const { return coarse_bytes_; }  // of all rooms' coarsest levels, wherever they are
  std::uint32_t coarse_open() const {
    return coarse_open_;
  }  // rooms whose coarsest level is neither resident nor failed

 private:
  struct Entry {
    std::uint64_t bytes = 0;
    std::uint64_t bytes_disk = 0;
    double quality = 0.0;
    LevelStatus status = LevelStatus::kAbsent;
  };
  std::size_t index(LevelKey key) const { return first_[key.room] + key.level; }

  std::vector<std::uint32_t> first_;  // of each room in entries_, and the end
  std::vector<Entry> entries_;
  std::uint64_t held_bytes_ = 0, coarse_bytes_ = 0;
  std::vector<LevelKey> loading_;
  std::uint32_t coarse_open_ = 0;
};

}  // namespace probewalk
