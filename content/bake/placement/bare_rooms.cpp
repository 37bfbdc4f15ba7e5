#include "content/bake/placement/bare_rooms.h"

#include <fmt/format.h>

#include <algorithm>

namespace probewalk {

std::string bare_rooms_warning(const Space& space, const std::vector<RoomEntry>& rooms, std::size_t most_probes) {
  std::vector<bool> has_floor(rooms.size(), false);
  for (const FloorNode& node : space.floor.nodes) has_floor[node.room] = true;
  std::vector<std::string> bare;
  for (std::size_t k = 0; k < rooms.size(); ++k) {
    if (has_floor[k] && rooms[k].probe_count == 0) bare.push_back(rooms[k].id);
  }
  if (bare.empty()) return {};
  return fmt::format(
      "{} of {} rooms with floor have no probe and are seen by their neighbours' alone: {}; raise --max-probes {}",
      bare.size(), std::count(has_floor.begin(), has_floor.end(), true), fmt::join(bare, ", "), most_probes);
}

}  // namespace probewalk
