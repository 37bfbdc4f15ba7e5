// Where the lines of the probe grid run: layers at heights that suit sitting and standing heads on every storey,
// horizontal spacing from the rooms' sizes, widened until the number of probes fits.
#pragma once

#include <array>

#include "content/bake/placement.h"
#include "content/bake/placement/head_space.h"

namespace probewalk {

// A vertex's probe may stand this far off it, in spacings along each axis.
inline constexpr double kReach = 0.48;

// Half of the typical distance across rooms, 1.6 to 3 m.
double typical_spacing_m(const RayScene& rays, const HeadSpace& heads);

// Vertices of the grid that some head needs and that have reachable air around them.
std::size_t count_useful(const ProbeGrid& grid, const HeadSpace& heads);
bool is_useful(const ProbeGrid& grid, const HeadSpace& heads, glm::ivec3 vertex);

// `probe` of the result is sized and zero.
ProbeGrid choose_grid(const RayScene& rays, const HeadSpace& heads, double spacing_m, std::size_t max_probes);

// Whether a grid that was chosen for other heads still does for these.
bool still_serves(const ProbeGrid& grid, const HeadSpace& heads, std::size_t max_probes);

// The vertices of the cell that serves a head, as the tracer chooses it; outside the grid that at its edge.
std::array<glm::ivec3, 8> cell_corners(const ProbeGrid& grid, glm::dvec3 head_m);

inline glm::dvec3 vertex_m(const ProbeGrid& grid, glm::ivec3 vertex) {
  return grid.origin_m + grid.spacing_m * glm::dvec3(vertex);
}
inline std::size_t vertex_index(const ProbeGrid& grid, glm::ivec3 vertex) {
  return (std::size_t(vertex.z) * grid.dims.y + vertex.y) * grid.dims.x + vertex.x;
}

}  // namespace probewalk
