#include "content/stream/room_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace probewalk {

namespace {

// Positive outside, negative inside: how far the point is from the box's surface.
double signed_distance(const Bounds& box, const glm::dvec3& point_m) {
  const glm::dvec3 beyond_m = glm::max(box.lower_m - point_m, point_m - box.upper_m);
  const double outside_m = glm::length(glm::max(beyond_m, glm::dvec3(0.0)));
  return outside_m > 0.0 ? outside_m : std::max({beyond_m.x, beyond_m.y, beyond_m.z});
}

}  // namespace

RoomGraph::RoomGraph(std::span<const RoomEntry> rooms, std::span<const Portal> portals) : doors_(rooms.size()) {
  for (const RoomEntry& room : rooms) bounds_.push_back(room.bounds);
  for (const Portal& portal : portals) {
    glm::dvec3 middle_m(0.0);
    for (const glm::dvec3& corner : portal.polygon) middle_m += corner / static_cast<double>(portal.polygon.size());
    const auto a = static_cast<std::uint32_t>(portal.room_a), b = static_cast<std::uint32_t>(portal.room_b);
    doors_[a].push_back({b, middle_m});
    doors_[b].push_back({a, middle_m});
  }
}

std::uint32_t RoomGraph::room_of(const glm::dvec3& point_m, std::int64_t previous, double margin_m) const {
  std::uint32_t found = 0;
  double found_m = std::numeric_limits<double>::infinity();
  for (std::uint32_t room = 0; room < bounds_.size(); ++room) {
    const double distance_m = signed_distance(bounds_[room], point_m);
    if (std::max(distance_m, 0.0) < found_m) {
      found = room;
      found_m = std::max(distance_m, 0.0);
    }
    if (distance_m <= 0.0) break;
  }
  if (previous < 0 || static_cast<std::uint64_t>(previous) >= bounds_.size()) return found;
  const auto old_room = static_cast<std::uint32_t>(previous);
  if (found == old_room) return found;
  const double old_m = signed_distance(bounds_[old_room], point_m);
  const double new_m = signed_distance(bounds_[found], point_m);
  const bool left = old_m > margin_m && old_m > new_m;
  const bool deep_inside = new_m <= -margin_m;
  return left || deep_inside ? found : old_room;
}

std::vector<RoomGraph::Reach> RoomGraph::reach(std::uint32_t room, const glm::dvec3& point_m,
                                               std::uint32_t most_portals) const {
  struct Way {
    Reach reach;
    glm::dvec3 at_m;
  };
  std::vector<Reach> found{{room, 0, 0.0}};
  std::vector<Way> ring{{found[0], point_m}};
  std::set<std::uint32_t> seen{room};
  for (std::uint32_t portals = 1; portals <= most_portals && !ring.empty(); ++portals) {
    std::map<std::uint32_t, Way> next;  // shortest way to each new room
    for (const Way& way : ring) {
      for (const Door& door : doors_[way.reach.room]) {
        if (seen.contains(door.to)) continue;
        const Way there{{door.to, portals, way.reach.distance_m + glm::distance(way.at_m, door.middle_m)},
                        door.middle_m};
        const auto [known, is_new] = next.try_emplace(door.to, there);
        if (!is_new && there.reach.distance_m < known->second.reach.distance_m) known->second = there;
      }
    }
    ring.clear();
    for (const auto& [index, way] : next) {
      seen.insert(index);
      ring.push_back(way);
      found.push_back(way.reach);
    }
  }
  std::sort(found.begin(), found.end(), [](const Reach& a, const Reach& b) {
    return std::tuple(a.portals, a.distance_m, a.room) < std::tuple(b.portals, b.distance_m, b.room);
  });
  return found;
}

}  // namespace probewalk
