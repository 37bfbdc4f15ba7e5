#include "content/stream/chunk_source.h"

#include <fmt/format.h>

#include "content/cache_folder.h"
#include "content/error.h"
#include "content/pack/pack_io.h"

namespace probewalk {

std::vector<std::byte> FolderSource::read(const LevelEntry& level, const std::atomic<bool>& /*cancelled*/) const {
  return read_chunk_file(pack_, level.chunk, level.bytes_disk);
}

HttpSource::HttpSource(std::string url, std::filesystem::path cache_folder, std::uint64_t cache_limit_bytes,
                       const FetchLimits& limits)
    : url_(std::move(url)), cache_(std::move(cache_folder), cache_limit_bytes), fetcher_(limits) {
  while (url_.ends_with('/')) url_.pop_back();
}

std::vector<std::byte> HttpSource::read(const LevelEntry& level, const std::atomic<bool>& cancelled) const {
  if (std::optional<std::vector<std::byte>> kept = cache_.find(level.chunk, level.bytes_disk)) return std::move(*kept);
  const std::string address = url_ + "/chunks/" + level.chunk;
  // Bytes may be spoilt on the way once; twice the same is the server's.
  constexpr int kTries = 2;
  std::size_t length = 0;
  for (int k = 0; k < kTries; ++k) {
    std::vector<std::byte> bytes = fetcher_.get(address, level.bytes_disk, cancelled);
    if (bytes.size() == level.bytes_disk && content_hash(bytes) == level.chunk) {
      cache_.keep(level.chunk, bytes);
      return bytes;
    }
    length = bytes.size();
  }
  throw BadInput(length != level.bytes_disk
                     ? fmt::format("{}: the server sends {} of {} bytes; upload the pack again", address, length,
                                   level.bytes_disk)
                     : fmt::format("{}: damaged, its bytes do not match its name; upload the pack again", address));
}

std::unique_ptr<ChunkSource> open_source(const std::string& pack, const CacheOptions& cache) {
  if (!is_http_url(pack)) return std::make_unique<FolderSource>(pack);
  return std::make_unique<HttpSource>(pack, cache.folder.empty() ? default_cache_folder() / "chunks" : cache.folder,
                                      cache.limit_bytes);
}

}  // namespace probewalk
