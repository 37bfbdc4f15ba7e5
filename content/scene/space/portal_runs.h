// Sides of columns where two rooms meet, gathered into openings.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "content/scene/space/floor_graph.h"

namespace probewalk {

// One side of a column where two rooms meet.
struct BorderSide {
  glm::ivec2 middle;  // in half columns
  double floor_m;
  double ceiling_m;
  bool walked;  // feet can step across
};

// Runs of sides that lie close together: each is one opening.
std::vector<std::vector<BorderSide>> gather_runs(const std::vector<BorderSide>& sides);

// A run cut where it turns, and where it goes around: its pieces keep to a line.
std::vector<std::vector<BorderSide>> straight_pieces(const FloorGraph& graph, const std::vector<BorderSide>& run);

// A straight piece cut where feet can go on to where only heads can look through; what would be a cut for a piece of
// furniture is none.
std::vector<std::vector<BorderSide>> parted_by_walking(const FloorGraph& graph, const std::vector<BorderSide>& piece);

// The upright rectangle over the line between the two ends of a run, from the floor to the lowest ceiling along it, at
// most 4 m high; empty when narrower than 0.4 m.
std::vector<glm::dvec3> upright_rectangle(const FloorGraph& graph, const std::vector<BorderSide>& run);

}  // namespace probewalk
