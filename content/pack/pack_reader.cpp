#include <fmt/format.h>

#include <cmath>

#include "content/error.h"
#include "content/pack/chunk_layout.h"
#include "content/pack/file_io.h"
#include "content/pack/manifest_check.h"
#include "content/pack/pack_format.h"
#include "content/pack/pack_io.h"
#include "content/probe/device_probe.h"

namespace probewalk {

namespace fs = std::filesystem;

namespace {

constexpr const char* kRemedy = "bake the pack again or copy it anew";

// Before anything is decompressed: no more than the manifest says, which budgets are kept by.
void check_size(const ChunkHeader& header, const RoomEntry& room, const LevelEntry& level, const std::string& source) {
  const ChunkCounts& counts = header.counts;
  const auto require = [&](bool holds, const char* what) {
    if (!holds) throw BadInput(fmt::format("{}: {} differ from the manifest's; {}", source, what, kRemedy));
  };
  require(counts.probes == room.probe_count, "number of probes");
  require(counts.geometry_n == level.geometry_size && counts.radiance_r == level.radiance_size, "map sizes");
  const std::uint64_t without_cuts =
      device_probe_bytes(static_cast<int>(counts.geometry_n), static_cast<int>(counts.radiance_r));
  require(level.bytes_device / counts.probes >= without_cuts, "bytes on the device");
  require(has_quantised_samples(header) == level.quantised, "kinds of samples");
}

// The chunk is sound by itself; is it the one that the manifest means?
void check_belongs(const RoomLevel& found, const Manifest& manifest, const RoomEntry& room, const std::string& source) {
  const auto require = [&](bool holds, const char* what) {
    if (!holds) throw BadInput(fmt::format("{}: {} differ from the manifest's; {}", source, what, kRemedy));
  };
  require(found.origin_m == room.origin_m, "room origin");
  for (std::size_t p = 0; p < found.probes.size(); ++p) {
    const ProbeMap& probe = found.probes[p];
    // Chunks hold positions as float offsets from the origin.
    const glm::dvec3 true_position_m = manifest.probe_positions_m[room.first_probe + p];
    const double reach_m = glm::length(true_position_m - room.origin_m);
    require(glm::length(probe.geometry.position_m - true_position_m) <= 1e-6 + 1e-6 * reach_m, "probe positions");
  }
}

}  // namespace

Pack Pack::open(const fs::path& pack) {
  std::error_code error;
  if (!fs::exists(pack, error)) {
    throw BadInput(fmt::format("no pack at {}; make one with: probewalk bake SCENE.glb -o {}", pack.string(),
                               pack.string()));
  }
  const fs::path file = pack / "pack.json";
  if (!fs::is_directory(pack, error) || !fs::exists(file, error)) {
    throw BadInput(fmt::format("{} is not a pack (a folder with a pack.json); if a bake was interrupted, give its "
                               "command again to go on", pack.string()));
  }
  const std::vector<std::byte> bytes = read_file(file, PackLimits::kManifestBytes);
  return Pack(pack, parse_manifest(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), file.string()));
}

std::vector<std::byte> Pack::read_chunk(const LevelEntry& level) const {
  return read_chunk_file(path_, level.chunk, level.bytes_disk);
}

std::vector<std::byte> read_chunk_file(const fs::path& pack, const std::string& hash, std::uint64_t bytes_disk) {
  if (!is_chunk_name(hash)) throw BadInput(fmt::format("{}: \"{}\" is no chunk name", pack.string(), hash));
  const fs::path file = pack / "chunks" / hash;
  std::vector<std::byte> bytes = read_file(file, bytes_disk);
  if (bytes.size() != bytes_disk) {
    throw BadInput(fmt::format("{}: has {} of {} bytes; {}", file.string(), bytes.size(), bytes_disk, kRemedy));
  }
  if (content_hash(bytes) != hash) {
    throw BadInput(fmt::format("{}: damaged, its bytes do not match its name; {}", file.string(), kRemedy));
  }
  return bytes;
}

RoomLevel decode_level(const Manifest& manifest, std::size_t room, std::size_t level,
                       std::span<const std::byte> bytes) {
  const RoomEntry& room_entry = manifest.rooms.at(room);
  const LevelEntry& level_entry = room_entry.levels.at(level);
  const std::string source = fmt::format("chunk {} (room {}, level {})", level_entry.chunk, room_entry.id, level);
  check_size(read_chunk_header(bytes, source), room_entry, level_entry, source);
  RoomLevel found = decode_chunk(bytes, source);
  check_belongs(found, manifest, room_entry, source);
  return found;
}

RoomLevel Pack::read_level(std::size_t room, std::size_t level) const {
  return decode_level(manifest_, room, level, read_chunk(manifest_.rooms.at(room).levels.at(level)));
}

std::vector<std::string> Pack::verify(Progress& progress) const {
  std::vector<std::string> damage;
  std::uint64_t total = 0;
  for (const RoomEntry& room : manifest_.rooms) {
    for (const LevelEntry& level : room.levels) total += level.bytes_disk;
  }
  progress.begin("verify", total, "bytes");
  for (std::size_t room = 0; room < manifest_.rooms.size(); ++room) {
    const RoomEntry& entry = manifest_.rooms[room];
    for (std::size_t level = 0; level < entry.levels.size(); ++level) {
      if (progress.cancelled()) throw Interrupted("verify was interrupted");
      try {
        read_level(room, level);
      } catch (const BadInput& error) {
        damage.push_back(fmt::format("room {}, level {}, chunks/{}: {}", entry.id, level, entry.levels[level].chunk,
                                     error.what()));
      }
      progress.advance(entry.levels[level].bytes_disk);
    }
  }
  return damage;
}

}  // namespace probewalk
