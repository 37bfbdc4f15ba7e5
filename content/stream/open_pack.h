// A pack, wherever it is: a folder, or the address of one on a web server (http:// or https://).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "content/pack/pack_io.h"
#include "content/stream/chunk_cache.h"
#include "content/stream/chunk_source.h"

namespace probewalk {

// Its list of rooms. Throws BadInput, Unavailable, Interrupted (soon after `cancelled` says true).
Pack open_pack(const std::string& pack, const std::function<bool()>& cancelled);

struct CacheOptions {
  std::filesystem::path folder;  // empty: the user's cache folder
  std::uint64_t limit_bytes = ChunkCache::kDefaultLimit_bytes;
};

// Its chunks; those from a web server are kept in the cache.
std::unique_ptr<ChunkSource> open_source(const std::string& pack, const CacheOptions& cache);

}  // namespace probewalk
