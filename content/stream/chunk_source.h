// Where chunks come from.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "content/pack/manifest.h"

namespace probewalk {

// What a source elsewhere was asked for, and how often in vain.
struct SourceStatistics {
  std::string address;
  std::uint64_t chunks = 0;           // that have come, and were what they should be
  std::uint64_t from_cache = 0;       // chunks that were on this machine already
  std::uint64_t requests = 0;
  std::uint64_t failed_requests = 0;  // refused, broken off, stalled; most were asked again
  std::uint64_t damaged = 0;          // answers whose bytes were not the chunk's
  std::uint64_t bytes = 0;            // that came, useful or not
  std::string last_failure;           // empty = none

  // Of two stretches of one walk.
  SourceStatistics& operator+=(const SourceStatistics& later);
};

class ChunkSource {
 public:
  virtual ~ChunkSource() = default;
  // The chunk's bytes, hash checked. Blocks; called by loader threads, several at once. Throws BadInput when the source
  // has not got them or they are damaged, Unavailable when it does not deliver now. Gives up soon after `cancelled`
  // turns true, where that is worth the while: returns or throws anything.
  virtual std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const = 0;
  // Reads that may wait for the source at a time, to make the best of it.
  virtual unsigned parallel_reads() const { return 1; }
  // Empty for a folder.
  virtual std::optional<SourceStatistics> statistics() const { return std::nullopt; }
  // Lines for people that have come up since the last call, such as that nothing can be kept. Any thread.
  virtual std::vector<std::string> take_notes() { return {}; }
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
