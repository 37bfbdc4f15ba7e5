// The space a walker can be in, found in any scene: floors, the reachable part, rooms, start pose and tour.
// Algorithm and parameters: column spans, floor graph, parts, score, rooms (the author's, else found where the way of
// heads narrows), portals, start, tour (design: rooms).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

inline constexpr double kEyeHeight_m = 1.6;
inline constexpr double kHeadroom_m = 1.7;
inline constexpr double kBodyRadius_m = 0.2;

// A head pose: position of the midpoint between the eyes, yaw (0 looks along -z, positive to the left), pitch up.
struct Pose {
  glm::dvec3 position_m{0.0};
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
};

// One piece of floor: the top of a solid span in one column of the grid, with room for a walker above it.
struct FloorNode {
  std::int32_t ix = 0, iz = 0;  // column
  float floor_m = 0.0f;         // y of the floor
  float headroom_m = 0.0f;      // free height above, clamped to 20
  std::uint16_t room = 0;       // index into Space::rooms
};

// The walkable, reachable floor as a height grid of square columns.
struct FloorMap {
  glm::dvec2 origin_m{0.0};  // x, z of the corner of column (0, 0)
  double cell_m = 0.05;
  glm::ivec2 columns{0};
  std::vector<FloorNode> nodes;  // sorted by (iz, ix, floor)
  // Node under a head or foot position: the highest floor at or below y + 0.45 in its column, or -1.
  std::int32_t find(glm::dvec3 position_m) const;
};

struct RoomRegion {
  std::string id;    // [a-z0-9-]{1,64}, unique
  std::string name;  // for people
  Bounds bounds;     // of the room's air; rooms may overlap, the first that holds a point wins
  std::vector<PlanLoop> outline;  // the author's, even-odd; empty = the bounds'
};

struct Portal {
  int room_a = 0, room_b = 0;       // indices into Space::rooms
  std::vector<glm::dvec3> polygon;  // planar, convex, metres
  bool walked = true;               // else only seen through: over a rail, a counter, an edge to a floor farther down
};

struct Space {
  FloorMap floor;
  std::vector<RoomRegion> rooms;  // at least one
  std::vector<Portal> portals;
  Pose start;
  std::vector<Pose> tour;  // key poses of a walk through all reachable rooms, about one every 0.25 m; at least one
  std::vector<std::string> warnings;
};

struct SpaceOptions {
  double voxel_m = 0.05;              // raised where memory would not suffice
  std::optional<glm::dvec3> start_m;  // --start: floor or eye position, moved to the nearest walkable floor
};

Space find_space(const Scene& scene, const RayScene& rays, const SpaceOptions& options, Progress& progress);

}  // namespace probewalk
