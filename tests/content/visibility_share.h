// How much of what a head sees, some probe of its cell sees too.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "content/bake/placement.h"

namespace probewalk {

struct VisibilityShare {
  double covered = 0.0;     // of surface points seen from heads: share seen from at least one of the cell's 8 probes
  double mean_views = 0.0;  // distinct probes of its cell that see a head
  int least_views = 8;
  double few_views = 0.0;   // share of heads that fewer than 3 probes see
};

inline std::uint32_t next_random(std::uint32_t& state) {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state;
}

inline std::array<std::uint32_t, 8> probes_around(const ProbeGrid& grid, glm::dvec3 head_m) {
  const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor((head_m - grid.origin_m) / grid.spacing_m)), glm::ivec3(0),
                                     glm::max(grid.dims - 2, 0));
  std::array<std::uint32_t, 8> probes;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 v = glm::min(cell + glm::ivec3(k & 1, k >> 1 & 1, k >> 2), grid.dims - 1);
    probes[k] = grid.probe[(std::size_t(v.z) * grid.dims.y + v.y) * grid.dims.x + v.x];
  }
  return probes;
}

// Heads 1.1 to 1.75 m over random floor nodes, 40 random directions each.
inline VisibilityShare measure_visibility(const RayScene& rays, const Space& space, const Placement& placement,
                                          int heads) {
  VisibilityShare share;
  std::uint32_t state = 12345;
  const auto unit = [&] { return (next_random(state) >> 8) / 16777216.0; };
  std::size_t seen = 0, covered = 0;
  for (int h = 0; h < heads; ++h) {
    const FloorNode& node = space.floor.nodes[next_random(state) % space.floor.nodes.size()];
    const double eye = std::min(1.1 + 0.65 * unit(), node.headroom_m - 0.1);
    const glm::dvec3 head(space.floor.origin_m.x + (node.ix + unit()) * space.floor.cell_m, node.floor_m + eye,
                          space.floor.origin_m.y + (node.iz + unit()) * space.floor.cell_m);
    auto probes = probes_around(placement.grid, head);
    std::sort(probes.begin(), probes.end());
    const auto end = std::unique(probes.begin(), probes.end());
    int views = 0;
    for (auto p = probes.begin(); p != end; ++p) {
      const glm::dvec3 to = placement.sites[*p].position_m - head;
      views += !rays.occluded(glm::vec3(head), glm::vec3(to), 0.0f, 1.0f);
    }
    share.mean_views += double(views) / heads;
    share.least_views = std::min(share.least_views, views);
    share.few_views += views < 3 ? 1.0 / heads : 0.0;
    for (int d = 0; d < 40; ++d) {
      const double y = 2.0 * unit() - 1.0;
      const double phi = 2.0 * M_PI * unit();
      const double r = std::sqrt(1.0 - y * y);
      const glm::vec3 direction(float(r * std::cos(phi)), float(y), float(r * std::sin(phi)));
      const SurfaceHit hit = rays.closest(glm::vec3(head), direction);
      if (!hit.hit) continue;
      ++seen;
      const glm::vec3 point = glm::vec3(head) + direction * (hit.t * 0.999f - 1e-3f);
      covered += std::any_of(probes.begin(), end, [&](std::uint32_t p) {
        const glm::vec3 from(placement.sites[p].position_m);
        return !rays.occluded(from, point - from, 0.0f, 1.0f);
      });
    }
  }
  share.covered = seen > 0 ? double(covered) / double(seen) : 1.0;
  return share;
}

}  // namespace probewalk
