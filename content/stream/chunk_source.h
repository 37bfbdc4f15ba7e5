// Where chunks come from.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "content/pack/manifest.h"
#include "content/stream/chunk_cache.h"
#include "content/stream/http_fetch.h"

namespace probewalk {

class ChunkSource {
 public:
  virtual ~ChunkSource() = default;
  // The chunk's bytes, hash checked. Blocks; called by loader threads, several at once. Throws Error: the source does not
  // deliver, which may be otherwise later. Gives up soon after `cancelled` turns true, where that is worth the while:
  // returns or throws anything.
  virtual std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const = 0;
  // What people call it: a path or an address.
  virtual std::string name() const = 0;
  // Reads that may wait for the source at a time, to make the best of it.
  virtual unsigned parallel_reads() const { return 1; }
};

// A pack's folder on a disk.
class FolderSource final : public ChunkSource {
 public:
  explicit FolderSource(std::filesystem::path pack) : pack_(std::move(pack)) {}
  std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const override;
  std::string name() const override { return pack_.string(); }

 private:
  std::filesystem::path pack_;
};

// A pack's folder on a web server: URL/pack.json, URL/chunks/HASH. Chunks are kept in the cache.
class HttpSource final : public ChunkSource {
 public:
  HttpSource(std::string url, std::filesystem::path cache_folder, std::uint64_t cache_limit_bytes,
             const FetchLimits& limits = {});
  std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const override;
  std::string name() const override { return url_; }
  unsigned parallel_reads() const override { return 8; }

 private:
  std::string url_;
  ChunkCache cache_;
  HttpFetcher fetcher_;
};

struct CacheOptions {
  std::filesystem::path folder;  // empty: the user's cache folder
  std::uint64_t limit_bytes = ChunkCache::kDefaultLimit_bytes;
};

// By what the pack's name is: a folder, or an address that begins with http:// or https://.
std::unique_ptr<ChunkSource> open_source(const std::string& pack, const CacheOptions& cache);

}  // namespace probewalk
