// Where probes stand: a grid over the reachable space whose spacing is widened until the number fits, every probe moved
// out of solids, its true position kept (thesis 8.3).
//
// Why the grid is upright and square, though the thesis (4.4) allows any lattice:
// - Turned about y: walls of rooms run along x and z, and lines of a turned grid cross them instead of running between
//   them. Measured by turning the scenes under the grid (--spacing 2, at most 200 probes; share of what heads see that
//   a probe of their cell sees, probes, vertices of the grid): the house 0.995, 156, 192 upright; 0.995, 195, 320 at
//   15 degrees; 0.995, 196, 360 at 30; 0.995, 196, 400 at 45. The courtyard 0.996, 178, 196; 0.996, 189, 256; 0.996, 198,
//   324; 0.995, 182, 324. A turned grid sees the same with more probes. A scene that stands askew in its file can be
//   turned there; a building with wings at odd angles would want a grid each, not one turned grid.
// - Skew: cells lose the eight corners that are told apart by three bits, and with them the probe orders of the tracer
//   (+3 mod 8 and its kin). What other lattices are good at does not matter here: a body-centred lattice of as many
//   points leaves no point as far from the next one (0.81 of the distance), but what a probe answers ends at walls, not
//   at a distance, and heads keep to one or two layers a storey, between which such a lattice would put its centres.
// Spacings differ by axis, layers fit the storeys, and every probe may leave its vertex by half a spacing: that is where
// the freedom of the lattice went.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
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
  // The lines of an earlier bake, to stay on as long as they cover where heads are now: what has not changed keeps its
  // probes then.
  std::optional<ProbeGrid> kept_grid;
};

Placement place_probes(const Scene& scene, const RayScene& rays, const Space& space, const PlacementOptions& options);

}  // namespace probewalk
