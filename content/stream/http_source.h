// A pack's folder on a web server: URL/pack.json, URL/chunks/HASH. Chunks are kept in a cache.
#pragma once

#include <cstdint>
#include <filesystem>
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

 private:
  std::string url_;
  ChunkCache cache_;
  HttpFetcher fetcher_;
};

}  // namespace probewalk
