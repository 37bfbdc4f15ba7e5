// A pack's folder on a web server: URL/pack.json, URL/chunks/HASH. Chunks are kept in a cache.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "content/stream/chunk_cache.h"
#include "content/stream/chunk_source.h"
#include "content/stream/http_fetch.h"

namespace probewalk {

class HttpSource final : public ChunkSource {
 public:
  HttpSource(const std::string& url, std::filesystem::path cache_folder, std::uint64_t cache_limit_bytes,
             const FetchLimits& limits = {});
  std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const override;
  unsigned parallel_reads() const override { return 8; }
  std::optional<SourceStatistics> statistics() const override;
  // That the cache takes nothing: once. That the server is silent, and that it delivers again.
  std::vector<std::string> take_notes() override;

 private:
  void keep(const LevelEntry& level, std::span<const std::byte> bytes) const;
  std::optional<std::string> note_of_silence();

  std::string url_;
  ChunkCache cache_;
  HttpFetcher fetcher_;
  mutable std::atomic<std::uint64_t> chunks_{0}, from_cache_{0}, damaged_{0};
  mutable std::atomic<bool> has_said_uncached_{false};
  mutable std::mutex notes_mutex_;
  mutable std::vector<std::string> notes_;
  // Of the last call of take_notes.
  std::uint64_t quiet_known_ = 0;
  std::optional<std::uint64_t> silent_since_chunk_;  // how many had come when it was told to be silent
};

}  // namespace probewalk
