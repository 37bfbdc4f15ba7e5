// Where probes stand: a grid over the reachable space whose spacing is widened until the number fits, every probe moved
// out of solids, its true position kept (thesis 8.3).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/scene/ray_scene.h"
#include "content/scene/space.h"

namespace probewalk {

struct ProbeSite {
  glm::dvec3 position_m{0.0};
  int room = 0;  // index into Space::rooms
};

// Vertex (x, y, z) of the grid lies at origin + spacing * (x, y, z); `probe` has dims.x*dims.y*dims.z entries, x
// fastest: index into Placement::sites of the probe that serves the vertex (its own, or where the vertex is not worth
// one, the nearest that sees it), always valid.
struct ProbeGrid {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 spacing_m{1.0};
  glm::ivec3 dims{1};
  std::vector<std::uint32_t> probe;
};

struct Placement {
  ProbeGrid grid;
  std::vector<ProbeSite> sites;  // sorted by room
  std::string statement;         // one sentence: spacing, number, what was moved and left out
};

struct PlacementOptions {
  double spacing_m = 0.0;  // 0 = chosen from the rooms' sizes
  int max_probes = 200;    // spacing is widened until at most this many are needed
};

Placement place_probes(const Scene& scene, const RayScene& rays, const Space& space, const PlacementOptions& options);

}  // namespace probewalk
