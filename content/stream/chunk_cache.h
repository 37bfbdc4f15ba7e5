// Chunks of packs elsewhere, kept in a folder of this machine: by content hash, so that packs share what they have in
// common and nothing is ever out of date. What was used longest ago goes when the folder grows beyond its limit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace probewalk {

class ChunkCache {
 public:
  static constexpr std::uint64_t kDefaultLimit_bytes = std::uint64_t{8} << 30;

  // Makes the folder when something is kept for the first time.
  ChunkCache(std::filesystem::path folder, std::uint64_t limit_bytes = kDefaultLimit_bytes);
  // The chunk's bytes, hash checked; nothing when it is not there or damaged (it is removed then). Thread-safe.
  std::optional<std::vector<std::byte>> find(const std::string& hash, std::uint64_t bytes_disk) const;
  // Keeps it, if the disk lets us: a full or read-only one costs speed, never the walk. Else says why not, naming the folder.
  // Thread-safe.
  std::optional<std::string> keep(const std::string& hash, std::span<const std::byte> bytes) const;

 private:
  void make_room() const;

  std::filesystem::path folder_;
  std::uint64_t limit_bytes_;
  mutable std::mutex mutex_;
  mutable std::uint64_t since_swept_bytes_;  // kept since the folder was last looked through
};

}  // namespace probewalk
