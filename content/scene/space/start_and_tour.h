// Steps 12 and 13: where the walk begins, which way it looks, and a tour through everything one can walk to from there.
#pragma once

#include <optional>
#include <vector>

#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/space.h"
#include "content/scene/space/floor_graph.h"

namespace probewalk {

// `places` of the start part (ascending), `room` of each place of the graph (-1 = not part of the space).
struct WalkGround {
  const FloorGraph& graph;
  const std::vector<std::int32_t>& places;
  const std::vector<std::int32_t>& room;
};

// The place farthest from walls in the part's largest room, or the nearest to `start_m`; looking where there is most to
// see ahead.
Pose find_start(const RayScene& rays, const WalkGround& ground, const std::optional<glm::dvec3>& start_m);

// Walks from the start by way of the middle of every room and enough other stations to see all of it, one pose every
// 0.25 m, looking along the way and around at the stations. Throws Interrupted.
std::vector<Pose> find_tour(const WalkGround& ground, const Pose& start, Progress& progress);

// For a scene without floor: the bounds' middle at eye height, moved to where most is free and faces are seen from
// front.
Pose find_floorless_start(const Scene& scene, const RayScene& rays);

// A slow turn on the spot.
std::vector<Pose> look_around(const Pose& start);

// Yaw that looks along a direction; 0 along -z, positive to the left.
double yaw_of(glm::dvec3 direction);

}  // namespace probewalk
