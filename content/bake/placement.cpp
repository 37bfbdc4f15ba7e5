#include "content/bake/placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "content/bake/placement/grid_choice.h"
#include "content/bake/placement/head_space.h"
#include "content/bake/placement/probe_sites.h"
#include "content/error.h"

namespace probewalk {

Placement place_probes(const Scene& scene, const RayScene& rays, const Space& space, const PlacementOptions& options) {
  if (options.max_probes < 1) throw BadUsage(fmt::format("--max-probes {} must be at least 1", options.max_probes));
  if (options.spacing_m != 0.0 && !(options.spacing_m >= 0.1 && options.spacing_m <= 1000.0)) {
    throw BadUsage(fmt::format("--spacing {} must be between 0.1 and 1000 metres", options.spacing_m));
  }
  const HeadSpace heads(scene, rays, space);
  const double spacing_m = options.spacing_m > 0.0 ? options.spacing_m : typical_spacing_m(rays, heads);
  Placement placement;
  const bool is_kept = options.kept_grid && still_serves(*options.kept_grid, heads, std::size_t(options.max_probes));
  placement.grid = is_kept ? *options.kept_grid : choose_grid(rays, heads, spacing_m, std::size_t(options.max_probes));
  SiteCounts counts;
  placement.sites = choose_sites(placement.grid, rays, space, heads, std::size_t(options.max_probes), counts);
  const ProbeGrid& grid = placement.grid;
  placement.statement = fmt::format(
      "{} probes on a grid of {} x {} x {} vertices, {:.2f} x {:.2f} x {:.2f} m apart{}: {} moved off their vertex, {} "
      "added "
      "where heads saw few, {} vertices near heads served by a neighbour's",
      placement.sites.size(), grid.dims.x, grid.dims.y, grid.dims.z, grid.spacing_m.x, grid.spacing_m.y,
      grid.spacing_m.z,
      is_kept ? " (the earlier bake's)"
      : std::max(grid.spacing_m.x, grid.spacing_m.z) > 1.3 * spacing_m
          ? fmt::format(" (widened from {:.2f})", spacing_m)
          : "",
      counts.moved, counts.added, counts.shared);
  return placement;
}

}  // namespace probewalk
