// The author's rooms, and the openings between rooms.
#pragma once

#include <vector>

#include "content/scene/scene.h"
#include "content/scene/space.h"
#include "content/scene/space/head_map.h"

namespace probewalk {

// The author's rooms, else one room that is the whole scene. Never empty; bounds of the latter are left to be grown.
std::vector<RoomRegion> list_rooms(const Scene& scene);

// Index of the first room whose bounds, or outline between their heights, hold the air a metre above the foot, else of
// the nearest one.
int room_at(const std::vector<RoomRegion>& rooms, glm::dvec3 foot_m);

// Openings of at least 0.4 m where a head can pass from one room to another, in straight pieces. `room` of each place of
// the head map, -1 = not part of the space. Each is an upright rectangle from the floor to the lowest ceiling along it, at
// most 4 m high; walked where the floor goes through, else looked through, over a rail or a counter.
std::vector<Portal> find_portals(const HeadMap& heads, const std::vector<std::int32_t>& room);

}  // namespace probewalk
