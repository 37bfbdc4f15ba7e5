#include "content/stream/chunk_source.h"

#include "content/pack/pack_io.h"

namespace probewalk {

SourceStatistics& SourceStatistics::operator+=(const SourceStatistics& later) {
  address = later.address;
  chunks += later.chunks;
  from_cache += later.from_cache;
  requests += later.requests;
  failed_requests += later.failed_requests;
  damaged += later.damaged;
  bytes += later.bytes;
  if (!later.last_failure.empty()) last_failure = later.last_failure;
  return *this;
}

std::vector<std::byte> FolderSource::read(const LevelEntry& level, const std::atomic<bool>& /*cancelled*/) const {
  return read_chunk_file(pack_, level.chunk, level.bytes_disk);
}

}  // namespace probewalk
