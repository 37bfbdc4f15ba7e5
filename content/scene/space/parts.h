// Steps 5 and 6: the pieces of floor that a body can walk within, what each is worth, and which are places to be.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/space/floor_graph.h"

namespace probewalk {

struct FloorPart {
  std::vector<std::int32_t> places;  // ascending
  double area_m2 = 0.0;
  double widest_m = 0.0;  // twice the largest distance to a wall
  // Means over eye points on the part, 64 rays each:
  double hit = 0.0;     // share of rays that meet something
  double front = 0.0;   // share of those that meet a front face (either face of a double-sided material)
  double detail = 0.0;  // number of distinct triangles met
  double score = 0.0;   // area * mean of hit^4 * front^2 * min(1, detail / 24)
};

// Components of the places at least kBodyRadius_m from a wall, grown back by that much; those of 1 m^2 and more.
std::vector<FloorPart> find_parts(const FloorGraph& graph);

// Fills what rays tell. Throws Interrupted.
void score_parts(const Scene& scene, const RayScene& rays, const FloorGraph& graph, std::vector<FloorPart>& parts,
                 Progress& progress);

// Indices of the parts to keep: first the one to start in (the one nearest `start_m` where given, else the best), then
// by falling score those that are seen from kept ones, or closed but furnished, or mostly inside an authored room.
std::vector<std::size_t> choose_parts(const Scene& scene, const RayScene& rays, const FloorGraph& graph,
                                      const std::vector<FloorPart>& parts, const std::optional<glm::dvec3>& start_m);

// Place of the graph nearest to a floor or eye position among `places`, those at least kBodyRadius_m from a wall first.
std::int32_t nearest_place(const FloorGraph& graph, const std::vector<std::int32_t>& places, glm::dvec3 position_m);

}  // namespace probewalk
