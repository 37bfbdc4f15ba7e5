// Rooms as the residency policy sees them: boxes joined by portals. Pure geometry.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "content/pack/manifest.h"

namespace probewalk {

class RoomGraph {
 public:
  RoomGraph(std::span<const RoomEntry> rooms, std::span<const Portal> portals);

  std::size_t size() const { return bounds_.size(); }

  // The room that holds the point: the first whose bounds do, else the nearest. `previous` (a room, or -1) is kept
  // until the point is `margin_m` outside of it or as deep inside another that comes first, so that a head that sways
  // in a doorway stays in one room.
  std::uint32_t room_of(const glm::dvec3& point_m, std::int64_t previous, double margin_m) const;

  struct Reach {
    std::uint32_t room = 0;
    std::uint32_t portals = 0;  // fewest portals between
    double distance_m = 0.0;    // shortest way through the portals' middles, from the point
  };
  // Rooms within `most_portals` of `room`, itself first, by number of portals, then distance, then index.
  std::vector<Reach> reach(std::uint32_t room, const glm::dvec3& point_m, std::uint32_t most_portals) const;

 private:
  struct Door {
    std::uint32_t to = 0;
    glm::dvec3 middle_m{0.0};
  };
  std::vector<Bounds> bounds_;
  std::vector<std::vector<Door>> doors_;  // of each room
};

}  // namespace probewalk
