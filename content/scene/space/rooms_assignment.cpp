#include "content/scene/space/rooms_assignment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "content/scene/space/room_outline.h"

namespace probewalk {
namespace {

constexpr double kNarrowest_m = 0.4;
constexpr double kHighest_m = 4.0;
constexpr int kGap_cells = 2;   // pieces of border at most this far apart are one opening
constexpr double kGap_m = 1.0;  // and this far in height

// One side of a column where two rooms meet.
struct BorderSide {
  glm::ivec2 middle;  // in half columns
  double floor_m;
  double ceiling_m;
};

// Union of sides that lie close together; sides are found by the column that they border on.
std::vector<std::vector<BorderSide>> cluster(const std::vector<BorderSide>& sides) {
  std::vector<std::size_t> parent(sides.size());
  std::iota(parent.begin(), parent.end(), std::size_t(0));
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::multimap<std::pair<int, int>, std::size_t> at;
  for (std::size_t i = 0; i < sides.size(); ++i) at.emplace(std::pair(sides[i].middle.y, sides[i].middle.x), i);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    for (int dz = 0; dz <= 2 * kGap_cells; ++dz) {
      const int z = sides[i].middle.y + dz;
      const auto begin = at.lower_bound({z, sides[i].middle.x - 2 * kGap_cells});
      const auto end = at.upper_bound({z, sides[i].middle.x + 2 * kGap_cells});
      for (auto j = begin; j != end; ++j) {
        if (std::abs(sides[j->second].floor_m - sides[i].floor_m) >= kGap_m) continue;
        const std::size_t a = root(i);
        const std::size_t b = root(j->second);
        parent[std::max(a, b)] = std::min(a, b);
      }
    }
  }
  std::map<std::size_t, std::vector<BorderSide>> clusters;
  for (std::size_t i = 0; i < sides.size(); ++i) clusters[root(i)].push_back(sides[i]);
  std::vector<std::vector<BorderSide>> out;
  for (auto& [first, members] : clusters) out.push_back(std::move(members));
  return out;
}

std::size_t farthest_from(const std::vector<BorderSide>& sides, glm::ivec2 point) {
  std::size_t farthest = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const double distance = glm::length(glm::dvec2(sides[i].middle - point));
    if (distance > most) {
      most = distance;
      farthest = i;
    }
  }
  return farthest;
}

// The rectangle over the line between the two ends of a run of sides; empty when too narrow.
std::vector<glm::dvec3> rectangle(const FloorGraph& graph, const std::vector<BorderSide>& run) {
  const BorderSide& a = run[farthest_from(run, run.front().middle)];
  const BorderSide& b = run[farthest_from(run, a.middle)];
  const auto plan_m = [&](const BorderSide& side) {
    return graph.origin_m + graph.cell_m * (0.5 * glm::dvec2(side.middle) + 0.5);
  };
  glm::dvec2 from = plan_m(a);
  glm::dvec2 to = plan_m(b);
  const double between_m = glm::distance(from, to);
  if (between_m + graph.cell_m < kNarrowest_m) return {};
  const glm::dvec2 half_side = 0.5 * graph.cell_m * (to - from) / between_m;
  from -= half_side;
  to += half_side;
  double floor_m = HUGE_VAL, ceiling_m = HUGE_VAL;
  for (const BorderSide& side : run) {
    floor_m = std::min(floor_m, side.floor_m);
    ceiling_m = std::min(ceiling_m, side.ceiling_m);
  }
  const double top_m = std::clamp(ceiling_m, floor_m + kHeadroom_m, floor_m + kHighest_m);
  return {{from.x, floor_m, from.y}, {to.x, floor_m, to.y}, {to.x, top_m, to.y}, {from.x, top_m, from.y}};
}

}  // namespace

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

std::vector<Portal> find_portals(const FloorGraph& graph, const std::vector<std::int32_t>& room) {
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
                                                         std::min(a.ceiling_m, b.ceiling_m)});
    }
  }
  std::vector<Portal> portals;
  for (const auto& [pair, sides] : borders) {
    for (const std::vector<BorderSide>& run : cluster(sides)) {
      std::vector<glm::dvec3> polygon = rectangle(graph, run);
      if (!polygon.empty()) portals.push_back({pair.first, pair.second, std::move(polygon)});
    }
  }
  return portals;
}

}  // namespace probewalk
