// The plan of a room that no box fits: closed lines, even-odd, in x and z.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "content/scene/scene.h"
#include "content/scene/space.h"

namespace probewalk {

bool outline_holds(const std::vector<PlanLoop>& outline, glm::dvec2 point_m);
// To the nearest line; infinite without one.
double distance_to_outline_m(const std::vector<PlanLoop>& outline, glm::dvec2 point_m);

// What a rooms file has to say so that it gives each piece of floor to the room that it is in now.
struct OutlinedRooms {
  std::vector<RoomRegion> rooms;  // with outlines where boxes would not do
  std::size_t strayed = 0;        // pieces of floor that go to another room all the same
};

// Of the rooms of a pack. Lines follow the cells of the floor and are as simple as keeps every piece in its room;
// coordinates are multiples of grid_m.
OutlinedRooms outline_rooms(const FloorMap& floor, const std::vector<RoomRegion>& rooms, double grid_m);

}  // namespace probewalk
