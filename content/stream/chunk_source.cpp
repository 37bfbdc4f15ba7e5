#include "content/stream/chunk_source.h"

#include "content/pack/pack_io.h"

namespace probewalk {

std::vector<std::byte> FolderSource::read(const LevelEntry& level, const std::atomic<bool>& /*cancelled*/) const {
  return read_chunk_file(pack_, level.chunk, level.bytes_disk);
}

}  // namespace probewalk
