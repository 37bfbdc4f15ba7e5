#include "content/stream/chunk_cache.h"

#include <fmt/format.h>

#include <algorithm>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/pack/pack_io.h"

namespace probewalk {

namespace fs = std::filesystem;

ChunkCache::ChunkCache(fs::path folder, std::uint64_t limit_bytes)
    : folder_(std::move(folder)), limit_bytes_(limit_bytes), since_swept_bytes_(limit_bytes) {}

std::optional<std::vector<std::byte>> ChunkCache::find(const std::string& hash, std::uint64_t bytes_disk) const {
  const fs::path file = folder_ / hash;
  std::error_code error;
  if (!fs::exists(file, error)) return std::nullopt;
  try {
    std::vector<std::byte> bytes = read_file(file, bytes_disk);
    if (bytes.size() == bytes_disk && content_hash(bytes) == hash) {
      fs::last_write_time(file, fs::file_time_type::clock::now(), error);  // used just now; a disk may refuse
      return bytes;
    }
  } catch (const BadInput&) {
    // No regular file, or it cannot be read: as good as not there.
  }
  fs::remove(file, error);
  return std::nullopt;
}

std::optional<std::string> ChunkCache::keep(const std::string& hash, std::span<const std::byte> bytes) const {
  if (bytes.size() > limit_bytes_) {
    return fmt::format("{}: its limit of {} bytes is less than a chunk of {}", folder_.string(), limit_bytes_, bytes.size());
  }
  const std::lock_guard lock(mutex_);
  try {
    std::error_code error;
    fs::create_directories(folder_, error);
    write_file_whole(folder_ / hash, bytes);
    since_swept_bytes_ += bytes.size();
    make_room();
    return std::nullopt;
  } catch (const BadInput& error) {
    return error.what();
  }
}

void ChunkCache::make_room() const {
  // Looking through the folder costs: only now and then, and at the first time.
  if (since_swept_bytes_ < limit_bytes_ / 8) return;
  struct Entry {
    fs::file_time_type used;
    std::uint64_t bytes;
    fs::path file;
  };
  std::vector<Entry> entries;
  std::uint64_t sum = 0;
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    std::error_code entry_error;
    if (!at->is_regular_file(entry_error) || at->path().filename().string().size() != 32) continue;
    entries.push_back({at->last_write_time(entry_error), at->file_size(entry_error), at->path()});
    sum += entries.back().bytes;
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
  // Some room to spare, so that not every chunk has to look for it.
  const std::uint64_t aim = limit_bytes_ - limit_bytes_ / 8;
  for (const Entry& entry : entries) {
    if (sum <= aim) break;
    fs::remove(entry.file, error);
    sum -= entry.bytes;
  }
  since_swept_bytes_ = 0;
}

}  // namespace probewalk
