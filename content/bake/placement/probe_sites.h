// Which vertices of the grid get a probe of their own, where exactly it stands, and who serves the others.
#pragma once

#include <cstddef>
#include <vector>

#include "content/bake/placement.h"
#include "content/bake/placement/head_space.h"

namespace probewalk {

struct SiteCounts {
  std::size_t moved = 0;    // probes that do not stand on their vertex
  std::size_t shared = 0;   // vertices near heads that another vertex's probe serves
  std::size_t added = 0;    // probes that were added because some head saw too few
};

// Fills grid.probe with indices into the returned sites, which are sorted by room, then by vertex; at most
// `max_probes`, at least one. Every site keeps its distance from surfaces and is seen from a head.
std::vector<ProbeSite> choose_sites(ProbeGrid& grid, const RayScene& rays, const Space& space, const HeadSpace& heads,
                                    std::size_t max_probes, SiteCounts& counts);

// Least distance to a surface in 26 directions, at most far_m.
double clearance_m(const RayScene& rays, glm::dvec3 point_m, double far_m);

}  // namespace probewalk
