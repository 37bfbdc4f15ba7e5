#include <fmt/format.h>

#include <set>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/pack/manifest_check.h"
#include "content/pack/pack_io.h"

namespace probewalk {

namespace fs = std::filesystem;

namespace {

bool holds_already(const fs::path& file, std::span<const std::byte> bytes, const std::string& hash) {
  std::error_code error;
  if (fs::file_size(file, error) != bytes.size() || error) return false;
  try {
    return content_hash(read_file(file, bytes.size())) == hash;
  } catch (const BadInput&) {
    return false;  // unreadable: written anew
  }
}

// Files that we made ourselves: chunks, and what a stopped write left. Nothing else in the folder is ours to remove.
bool is_ours(const std::string& name) { return is_chunk_name(name) || name.starts_with(kPartialFilePrefix); }

}  // namespace

PackWriter::PackWriter(fs::path pack) : pack_(std::move(pack)) {
  std::error_code error;
  fs::create_directories(pack_ / "chunks", error);
  if (error) {
    throw BadInput(fmt::format("cannot make the pack folder {}: {}; check the path, free space and permissions",
                               pack_.string(), error.message()));
  }
}

std::string PackWriter::add_chunk(std::span<const std::byte> bytes) {
  const std::string hash = content_hash(bytes);
  const fs::path file = pack_ / "chunks" / hash;
  if (!holds_already(file, bytes, hash)) write_file_whole(file, bytes);
  return hash;
}

void PackWriter::finish(const Manifest& manifest) {
  const std::string text = serialise_manifest(manifest);
  std::set<std::string> named;
  for (const RoomEntry& room : manifest.rooms) {
    for (const LevelEntry& level : room.levels) {
      std::error_code error;
      const auto size = fs::file_size(pack_ / "chunks" / level.chunk, error);
      if (error || size != level.bytes_disk) {
        throw BadInput(fmt::format("cannot finish {}: chunk {} of room {} is not there with {} bytes; bake again",
                                   pack_.string(), level.chunk, room.id, level.bytes_disk));
      }
      named.insert(level.chunk);
    }
  }
  write_file_whole(pack_ / "pack.json", std::as_bytes(std::span(text)));

  std::vector<fs::path> surplus;
  for (const fs::path& folder : {pack_ / "chunks", pack_}) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename().string();
      if (is_ours(name) && !named.contains(name)) surplus.push_back(entry.path());
    }
  }
  for (const fs::path& file : surplus) {
    std::error_code ignored;  // what cannot be removed is only space
    fs::remove(file, ignored);
  }
}

}  // namespace probewalk
