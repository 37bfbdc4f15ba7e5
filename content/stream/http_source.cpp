#include "content/stream/http_source.h"

#include <fmt/format.h>

#include "content/error.h"
#include "content/pack/pack_io.h"

namespace probewalk {

HttpSource::HttpSource(const std::string& url, std::filesystem::path cache_folder, std::uint64_t cache_limit_bytes,
                       const FetchLimits& limits)
    : url_(without_slash(url)), cache_(std::move(cache_folder), cache_limit_bytes), fetcher_(limits) {}

std::vector<std::byte> HttpSource::read(const LevelEntry& level, const std::atomic<bool>& cancelled) const {
  if (std::optional<std::vector<std::byte>> kept = cache_.find(level.chunk, level.bytes_disk)) return std::move(*kept);
  const std::string address = url_ + "/chunks/" + level.chunk;
  // Bytes may be spoilt on the way once; twice the same is the server's.
  constexpr int kTries = 2;
  std::size_t length = 0;
  for (int k = 0; k < kTries; ++k) {
    std::vector<std::byte> bytes =
        fetcher_.get(address, level.bytes_disk, [&] { return cancelled.load(std::memory_order_relaxed); });
    if (bytes.size() == level.bytes_disk && content_hash(bytes) == level.chunk) {
      cache_.keep(level.chunk, bytes);
      return bytes;
    }
    length = bytes.size();
  }
  throw BadInput(
      length != level.bytes_disk
          ? fmt::format("{}: the server sends {} of {} bytes; upload the pack again", address, length, level.bytes_disk)
          : fmt::format("{}: damaged, its bytes do not match its name; upload the pack again", address));
}

}  // namespace probewalk
