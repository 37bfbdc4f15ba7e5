#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/error.h"
#include "content/scene/space.h"
#include "content/scene/space/column_spans.h"
#include "content/scene/space/floor_graph.h"
#include "content/scene/space/parts.h"
#include "content/scene/space/rooms_assignment.h"
#include "content/scene/space/start_and_tour.h"

namespace probewalk {
namespace {

constexpr std::size_t kMostPlaces = 1'500'000;
constexpr float kTallestHeadroom_m = 20.0f;
constexpr double kFurnitureDepth_m = 1.25;  // how far a head can lean over what stands along the floor's edge

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

FloorGraph find_floors(const Scene& scene, double voxel_m, Progress& progress, std::vector<std::string>& warnings) {
  for (;;) {
    if (progress.cancelled()) throw Interrupted("interrupted while looking for floors");
    const GroundPlan plan = plan_ground(scene, voxel_m);
    FloorGraph graph = build_floor_graph(build_column_spans(scene, plan));
    if (graph.places.size() > kMostPlaces) {
      voxel_m = 1.1 * plan.cell_m * std::sqrt(double(graph.places.size()) / kMostPlaces);
      continue;
    }
    if (plan.cropped) {
      warnings.push_back(fmt::format("the scene is too wide to look for floors everywhere: only x {:.0f} to {:.0f}, "
                                     "z {:.0f} to {:.0f} m, where most of its triangles are, is walkable",
                                     plan.lower_m.x, plan.upper_m.x, plan.lower_m.y, plan.upper_m.y));
    }
    if (plan.cell_m > 2.0 * kWidestCell_m) {
      warnings.push_back(
          fmt::format("floors are looked for in columns of {:.2f} m to bound memory: doors are missed", plan.cell_m));
    }
    return graph;
  }
}

void grow(Bounds& bounds, glm::dvec3 point) {
  bounds.lower_m = glm::min(bounds.lower_m, point);
  bounds.upper_m = glm::max(bounds.upper_m, point);
}

// The air over the floor and over the furniture along its edges, inside the scene.
Bounds air_bounds(const FloorGraph& graph, const std::vector<std::int32_t>& room, const Bounds& scene) {
  Bounds air;
  for (std::size_t i = 0; i < graph.places.size(); ++i) {
    if (room[i] < 0) continue;
    const glm::dvec3 foot = graph.foot_m(std::int32_t(i));
    const double headroom = std::min(kTallestHeadroom_m, graph.places[i].ceiling_m - graph.places[i].floor_m);
    grow(air, foot - glm::dvec3(kFurnitureDepth_m, 0.0, kFurnitureDepth_m));
    grow(air, foot + glm::dvec3(kFurnitureDepth_m, headroom, kFurnitureDepth_m));
  }
  for (int k = 0; k < 3; k += 2) {
    air.lower_m[k] = std::max(air.lower_m[k], scene.lower_m[k]);
    air.upper_m[k] = std::min(air.upper_m[k], scene.upper_m[k]);
  }
  return air;
}

void fill_floor_map(const FloorGraph& graph, const std::vector<std::int32_t>& room, FloorMap& map) {
  map.origin_m = graph.origin_m;
  map.cell_m = graph.cell_m;
  map.columns = graph.columns;
  for (std::size_t i = 0; i < graph.places.size(); ++i) {
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

  const FloorGraph graph = find_floors(scene, options.voxel_m, progress, space.warnings);
  progress.advance(1);
  std::vector<FloorPart> parts = find_parts(graph);
  score_parts(scene, rays, graph, parts, progress);
  const std::vector<std::size_t> kept = choose_parts(scene, rays, graph, parts, start_m);
  progress.advance(1);

  std::vector<std::int32_t> room(graph.places.size(), -1);
  for (const std::size_t id : kept) {
    for (const std::int32_t i : parts[id].places) room[i] = room_at(space.rooms, graph.foot_m(i));
  }
  fill_floor_map(graph, room, space.floor);
  if (kept.empty()) {
    fill_floorless(scene, rays, options, space);
    return space;
  }
  if (scene.rooms.empty()) space.rooms.front().bounds = air_bounds(graph, room, scene.bounds);
  space.portals = find_portals(graph, room);
  progress.advance(1);

  const WalkGround ground{graph, parts[kept.front()].places, room};
  space.start = find_start(rays, ground, start_m);
  space.tour = find_tour(ground, space.start, progress);
  progress.advance(1);
  return space;
}

}  // namespace probewalk
