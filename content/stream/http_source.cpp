#include "content/stream/http_source.h"

#include <fmt/format.h>

#include <utility>

#include "content/error.h"
#include "content/pack/pack_io.h"

namespace probewalk {

HttpSource::HttpSource(const std::string& url, std::filesystem::path cache_folder, std::uint64_t cache_limit_bytes,
                       const FetchLimits& limits)
    : url_(without_slash(url)), cache_(std::move(cache_folder), cache_limit_bytes), fetcher_(limits) {}

std::vector<std::byte> HttpSource::read(const LevelEntry& level, const std::atomic<bool>& cancelled) const {
  if (std::optional<std::vector<std::byte>> kept = cache_.find(level.chunk, level.bytes_disk)) {
    ++from_cache_;
    return std::move(*kept);
  }
  const std::string address = url_ + "/chunks/" + level.chunk;
  // Bytes may be spoilt on the way once; twice the same is the server's.
  constexpr int kTries = 2;
  std::size_t length = 0;
  for (int k = 0; k < kTries; ++k) {
    std::vector<std::byte> bytes =
        fetcher_.get(address, level.bytes_disk, [&] { return cancelled.load(std::memory_order_relaxed); });
    if (bytes.size() == level.bytes_disk && content_hash(bytes) == level.chunk) {
      ++chunks_;
      keep(level, bytes);
      return bytes;
    }
    ++damaged_;
    length = bytes.size();
  }
  throw BadInput(
      length != level.bytes_disk
          ? fmt::format("{}: the server sends {} of {} bytes; upload the pack again", address, length, level.bytes_disk)
          : fmt::format("{}: damaged, its bytes do not match its name; upload the pack again", address));
}

void HttpSource::keep(const LevelEntry& level, std::span<const std::byte> bytes) const {
  const std::optional<std::string> reason = cache_.keep(level.chunk, bytes);
  if (!reason || has_said_uncached_.exchange(true)) return;
  const std::lock_guard lock(notes_mutex_);
  notes_.push_back(fmt::format("chunks from the server are not kept: {}; the walk goes on without a cache", *reason));
}

std::optional<SourceStatistics> HttpSource::statistics() const {
  const FetchCounts fetched = fetcher_.counts();
  return SourceStatistics{url_,           chunks_,  from_cache_,   fetched.requests,
                          fetched.failed, damaged_, fetched.bytes, fetched.last_failure};
}

// Long before a silent server's requests have failed, the walker sees that rooms stay coarse, and wants to know why.
std::optional<std::string> HttpSource::note_of_silence() {
  const std::uint64_t chunks = chunks_;
  if (silent_since_chunk_ && chunks > *silent_since_chunk_) {
    silent_since_chunk_.reset();
    quiet_known_ = fetcher_.times_quiet();
    return url_ + ": the server delivers again";
  }
  const std::uint64_t quiet = fetcher_.times_quiet();
  if (quiet == std::exchange(quiet_known_, quiet) || silent_since_chunk_) return std::nullopt;
  silent_since_chunk_ = chunks;
  return fetcher_.counts().last_quiet + ": the server is silent; what is there stays, the rest comes when it answers";
}

std::vector<std::string> HttpSource::take_notes() {
  std::optional<std::string> silence = note_of_silence();
  const std::lock_guard lock(notes_mutex_);
  if (silence) notes_.push_back(std::move(*silence));
  return std::exchange(notes_, {});
}

}  // namespace probewalk
