#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/error.h"
#include "content/scene/space.h"
#include "content/scene/space/column_spans.h"
#include "content/scene/space/drop_portals.h"
#include "content/scene/space/floor_graph.h"
#include "content/scene/space/head_map.h"
#include "content/scene/space/parts.h"
#include "content/scene/space/room_edits.h"
#include "content/scene/space/room_search.h"
#include "content/scene/space/rooms_assignment.h"
#include "content/scene/space/start_and_tour.h"

namespace probewalk {
namespace {

constexpr std::size_t kMostPlaces = 1'500'000;
constexpr float kTallestHeadroom_m = 20.0f;
constexpr double kLargePart_m2 = 3.0;
constexpr double kWall_m = 0.1;  // a room's box reaches this far past the columns that its walls leave free

// Walls and floors of a building that stands upright make y the axis with most area across it.
void check_up_axis(const Scene& scene, std::vector<std::string>& warnings) {
  const double nearly = std::cos(11.0 * std::numbers::pi / 180.0);
  glm::dvec3 across(0.0);
  for (const glm::uvec3& t : scene.triangles) {
    const glm::dvec3 a(scene.positions_m[t.x]);
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(scene.positions_m[t.y]) - a, glm::dvec3(scene.positions_m[t.z]) - a);
    const double area = glm::length(normal);
    if (!std::isfinite(area)) continue;
    for (int k = 0; k < 3; ++k) across[k] += std::abs(normal[k]) > nearly * area ? area : 0.0;
  }
  if (across.y < 0.8 * std::max(across.x, across.z)) {
    warnings.push_back(
        fmt::format("{} axis may be up, not y (it has more level surface): floors are looked for along y; "
                    "turn the scene in its editor if that is wrong",
                    across.x > across.z ? "the x" : "the z"));
  }
}

struct Floors {
  ColumnSpans spans;
  FloorGraph graph;
};

Floors find_floors(const Scene& scene, double voxel_m, Progress& progress, std::vector<std::string>& warnings) {
  for (;;) {
    if (progress.cancelled()) throw Interrupted("interrupted while looking for floors");
    const GroundPlan plan = plan_ground(scene, voxel_m);
    ColumnSpans spans = build_column_spans(scene, plan);
    FloorGraph graph = build_floor_graph(spans);
    if (graph.places.size() > kMostPlaces) {
      voxel_m = 1.1 * plan.cell_m * std::sqrt(double(graph.places.size()) / kMostPlaces);
      continue;
    }
    if (plan.cropped) {
      warnings.push_back(
          fmt::format("the scene is too wide to look for floors everywhere: only x {:.0f} to {:.0f}, "
                      "z {:.0f} to {:.0f} m, where most of its triangles are, is walkable",
                      plan.lower_m.x, plan.upper_m.x, plan.lower_m.y, plan.upper_m.y));
    }
    if (plan.cell_m > 2.0 * kWidestCell_m) {
      warnings.push_back(
          fmt::format("floors are looked for in columns of {:.2f} m to bound memory: doors are missed", plan.cell_m));
    }
    return {std::move(spans), std::move(graph)};
  }
}

void grow(Bounds& bounds, glm::dvec3 point) {
  bounds.lower_m = glm::min(bounds.lower_m, point);
  bounds.upper_m = glm::max(bounds.upper_m, point);
}

// The air over each room's part of the head map, inside the scene.
void fill_air_bounds(const HeadMap& heads, const std::vector<std::int32_t>& room, const Bounds& scene,
                     std::vector<RoomRegion>& rooms) {
  const double reach_m = 0.5 * heads.graph.cell_m + kWall_m;
  for (std::size_t i = 0; i < heads.graph.places.size(); ++i) {
    const StandingPlace& place = heads.graph.places[i];
    const glm::dvec3 foot = heads.graph.foot_m(std::int32_t(i));
    const double headroom = std::min(kTallestHeadroom_m, place.ceiling_m - place.floor_m);
    Bounds& air = rooms[room[i]].bounds;
    grow(air, foot - glm::dvec3(reach_m, 0.0, reach_m));
    grow(air, foot + glm::dvec3(reach_m, headroom, reach_m));
  }
  for (RoomRegion& region : rooms) {
    for (int k = 0; k < 3; k += 2) {
      region.bounds.lower_m[k] = std::max(region.bounds.lower_m[k], scene.lower_m[k]);
      region.bounds.upper_m[k] = std::min(region.bounds.upper_m[k], scene.upper_m[k]);
    }
  }
}

HeadMap head_map_of(const Floors& floors, const std::vector<FloorPart>& parts, const std::vector<std::size_t>& kept) {
  std::vector<bool> is_kept(floors.graph.places.size(), false), is_other(floors.graph.places.size(), false);
  for (const FloorPart& part : parts) {
    if (part.area_m2 < kLargePart_m2) continue;
    for (const std::int32_t i : part.places) is_other[i] = true;
  }
  for (const std::size_t id : kept) {
    for (const std::int32_t i : parts[id].places) {
      is_kept[i] = true;
      is_other[i] = false;
    }
  }
  return build_head_map(floors.graph, floors.spans, is_kept, is_other);
}

// Those of a scene whose author named none.
std::vector<RoomRegion> name_rooms(std::int32_t count) {
  std::vector<RoomRegion> rooms;
  for (std::int32_t r = 1; r <= count; ++r)
    rooms.push_back({fmt::format("room-{}", r), fmt::format("Room {}", r), Bounds{}, {}});
  return rooms;
}

void fill_floor_map(const FloorGraph& graph, const std::vector<std::int32_t>& room, FloorMap& map) {
  map.origin_m = graph.origin_m;
  map.cell_m = graph.cell_m;
  map.columns = graph.columns;
  for (std::size_t i = 0; i < room.size(); ++i) {
    if (room[i] < 0) continue;
    const StandingPlace& p = graph.places[i];
    map.nodes.push_back(
        {p.ix, p.iz, p.floor_m, std::min(kTallestHeadroom_m, p.ceiling_m - p.floor_m), std::uint16_t(room[i])});
  }
}

// Nowhere to stand: the walker hovers at one point and looks around.
void fill_floorless(const Scene& scene, const RayScene& rays, const SpaceOptions& options, Space& space) {
  space.start = find_floorless_start(scene, rays);
  if (options.start_m) space.start.position_m = *options.start_m;
  space.tour = look_around(space.start);
  if (scene.rooms.empty()) {
    Bounds& air = space.rooms.front().bounds;
    air = scene.bounds;
    grow(air, space.start.position_m);
  }
  space.warnings.push_back(
      fmt::format("no walkable floor found (level, {:.1f} m free above, 1 m^2): the walk hovers at "
                  "{:.2f},{:.2f},{:.2f}; check --scale, or give --start",
                  kHeadroom_m, space.start.position_m.x, space.start.position_m.y, space.start.position_m.z));
}

}  // namespace

Space find_space(const Scene& scene, const RayScene& rays, const SpaceOptions& options, Progress& progress) {
  Space space;
  progress.begin("finding the walkable space", 4, "steps");
  if (!(options.voxel_m > 0.0)) throw BadUsage(fmt::format("voxel size {} m must be positive", options.voxel_m));
  const std::optional<glm::dvec3> start_m = options.start_m ? options.start_m : scene.authored_start_m;
  check_up_axis(scene, space.warnings);
  space.rooms = list_rooms(scene);

  const Floors floors = find_floors(scene, options.voxel_m, progress, space.warnings);
  const FloorGraph& graph = floors.graph;
  progress.advance(1);
  std::vector<FloorPart> parts = find_parts(graph);
  score_parts(scene, rays, graph, parts, progress);
  const std::vector<std::size_t> kept = choose_parts(scene, rays, graph, parts, start_m);
  progress.advance(1);

  if (kept.empty()) {
    fill_floor_map(graph, {}, space.floor);
    fill_floorless(scene, rays, options, space);
    return space;
  }
  const HeadMap heads = head_map_of(floors, parts, kept);
  FoundRooms found;
  if (scene.rooms.empty()) {
    found = search_rooms(heads);
    if (found.count > 1) space.rooms = name_rooms(found.count);
    fill_air_bounds(heads, found.room, scene.bounds, space.rooms);
  } else {
    for (std::size_t i = 0; i < heads.graph.places.size(); ++i) {
      found.room.push_back(room_at(space.rooms, heads.graph.foot_m(std::int32_t(i))));
    }
  }
  edit_rooms(scene.room_edits, heads.graph, space.rooms, found.room);
  std::vector<std::int32_t> room(graph.places.size(), -1);
  for (std::size_t i = 0; i < heads.floor_place.size(); ++i) {
    if (heads.floor_place[i] >= 0) room[heads.floor_place[i]] = found.room[i];
  }
  fill_floor_map(graph, room, space.floor);
  space.portals = find_portals(heads, found.room);
  for (Portal& drop : find_drops(heads, floors.spans, found.room)) space.portals.push_back(std::move(drop));
  progress.advance(1);

  const WalkGround ground{graph, parts[kept.front()].places, room};
  space.start = find_start(rays, ground, start_m);
  space.tour = find_tour(ground, space.start, progress);
  progress.advance(1);
  return space;
}

}  // namespace probewalk
