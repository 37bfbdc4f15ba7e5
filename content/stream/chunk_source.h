// Where chunks come from.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "content/pack/manifest.h"

namespace probewalk {

class ChunkSource {
 public:
  virtual ~ChunkSource() = default;
  // The chunk's bytes, hash checked. Blocks; called by loader threads, several at once. Throws BadInput when the source
  // has not got them or they are damaged, Unavailable when it does not deliver now. Gives up soon after `cancelled`
  // turns true, where that is worth the while: returns or throws anything.
  virtual std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const = 0;
  // Reads that may wait for the source at a time, to make the best of it.
  virtual unsigned parallel_reads() const { return 1; }
};

// A pack's folder on a disk.
class FolderSource final : public ChunkSource {
 public:
  explicit FolderSource(std::filesystem::path pack) : pack_(std::move(pack)) {}
  std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const override;

 private:
  std::filesystem::path pack_;
};

}  // namespace probewalk
