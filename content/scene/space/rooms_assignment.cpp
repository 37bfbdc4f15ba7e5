#include "content/scene/space/rooms_assignment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "content/scene/space/portal_runs.h"
#include "content/scene/space/room_outline.h"

namespace probewalk {

std::vector<RoomRegion> list_rooms(const Scene& scene) {
  std::vector<RoomRegion> rooms;
  for (const AuthoredRoom& room : scene.rooms) {
    rooms.push_back({room.id, room.name, Bounds{room.lower_m, room.upper_m}, room.outline});
  }
  if (rooms.empty()) rooms.push_back({"room", scene.name.empty() ? "Room" : scene.name, Bounds{}, {}});
  return rooms;
}

int room_at(const std::vector<RoomRegion>& rooms, glm::dvec3 foot_m) {
  const glm::dvec3 air_m = foot_m + glm::dvec3(0.0, 1.0, 0.0);
  int nearest = 0;
  double least = HUGE_VAL;
  for (std::size_t r = 0; r < rooms.size(); ++r) {
    const Bounds& box = rooms[r].bounds;
    const glm::dvec3 outside = glm::max(glm::max(box.lower_m - air_m, air_m - box.upper_m), glm::dvec3(0.0));
    double distance = glm::length(outside);
    if (const glm::dvec2 plan_m(air_m.x, air_m.z); !rooms[r].outline.empty()) {
      distance = outline_holds(rooms[r].outline, plan_m)
                     ? outside.y
                     : std::hypot(distance_to_outline_m(rooms[r].outline, plan_m), outside.y);
    }
    if (distance < least) {
      least = distance;
      nearest = int(r);
    }
  }
  return nearest;
}

std::vector<Portal> find_portals(const HeadMap& heads, const std::vector<std::int32_t>& room) {
  const FloorGraph& graph = heads.graph;
  std::map<std::pair<int, int>, std::vector<BorderSide>> borders;
  for (std::size_t i = 0; i < graph.places.size(); ++i) {
    if (room[i] < 0) continue;
    const StandingPlace& a = graph.places[i];
    for (int k = 0; k < 2; ++k) {  // towards +x and +z: every side once
      const std::int32_t j = a.link[k];
      if (j < 0 || room[j] < 0 || room[j] == room[i]) continue;
      const StandingPlace& b = graph.places[j];
      borders[std::minmax(room[i], room[j])].push_back({{2 * a.ix + kLinkX[k], 2 * a.iz + kLinkZ[k]},
                                                         std::min(a.floor_m, b.floor_m),
                                                         std::min(a.ceiling_m, b.ceiling_m),
                                                         heads.floor_place[i] >= 0 && heads.floor_place[j] >= 0});
    }
  }
  std::vector<Portal> portals;
  for (const auto& [pair, sides] : borders) {
    for (const std::vector<BorderSide>& run : gather_runs(sides)) {
      for (const std::vector<BorderSide>& piece : straight_pieces(graph, run)) {
        for (const std::vector<BorderSide>& part : parted_by_walking(graph, piece)) {
          std::vector<glm::dvec3> polygon = upright_rectangle(graph, part);
          if (!polygon.empty()) portals.push_back({pair.first, pair.second, std::move(polygon), part.front().walked});
        }
      }
    }
  }
  return portals;
}

}  // namespace probewalk
