#include "tools/probewalk/bench/pack_levels.h"

#include <algorithm>

namespace probewalk::bench {

std::vector<int> level_sizes(const Manifest& manifest) {
  std::size_t levels = 0;
  for (const RoomEntry& room : manifest.rooms) levels = std::max(levels, room.levels.size());
  std::vector<int> sizes(levels, 0);
  for (std::size_t level = 0; level < levels; ++level) {
    for (const RoomEntry& room : manifest.rooms) {
      if (room.levels.empty()) continue;  // it has no probes
      const LevelEntry& entry = room.levels[std::min(level, room.levels.size() - 1)];
      sizes[level] = std::max(sizes[level], static_cast<int>(entry.geometry_size));
    }
  }
  return sizes;
}

PackLevel::PackLevel(const Device& device, const Pack& pack, std::size_t level, DeviceSamples samples)
    : samples_(samples),
      probes_(ProbeSet::read(pack, level, samples)),
      store_(device, pack.manifest().grid, static_cast<std::uint32_t>(pack.manifest().probe_positions_m.size())) {
  const std::vector<RoomEntry>& rooms = pack.manifest().rooms;
  for (std::uint32_t room = 0; room < rooms.size(); ++room) {
    if (rooms[room].levels.empty()) continue;
    RoomUpload upload;
    upload.room = room;
    upload.level = static_cast<std::uint32_t>(std::min(level, rooms[room].levels.size() - 1));
    upload.first_probe = rooms[room].first_probe;
    const auto first = probes_.probes().begin() + static_cast<std::ptrdiff_t>(rooms[room].first_probe);
    upload.probes.assign(first, first + static_cast<std::ptrdiff_t>(rooms[room].probe_count));
    store_.upload(upload);
  }
  store_.settle();
}

}  // namespace probewalk::bench
