#include "content/bake/placement/grid_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace probewalk {
namespace {

constexpr double kInset_m = 0.3;        // outermost lines run this far inside: heads beyond are clamped to the edge
constexpr double kLayer_m = 1.3;
constexpr double kLowLayer_m = 0.6;     // above a floor: under tables, sitting heads
constexpr double kHighLayer_m = 1.9;    // above standing heads

struct Lines {
  double origin_m = 0.0;
  double spacing_m = 1.0;
  int count = 1;
};

// Lines over [lower, upper], inset, at most about `spacing` apart.
Lines spread(double lower_m, double upper_m, double spacing_m) {
  const double length_m = upper_m - lower_m - 2.0 * kInset_m;
  const int cells = length_m <= 0.0 ? 0 : int(std::ceil(length_m / spacing_m - 0.3));
  if (cells < 1) return {0.5 * (lower_m + upper_m), spacing_m, 1};
  return {lower_m + kInset_m, length_m / cells, cells + 1};
}

double nearest_layer_m(const Lines& layers, double height_m) {
  const double layer = std::clamp(std::round((height_m - layers.origin_m) / layers.spacing_m), 0.0, layers.count - 1.0);
  return std::abs(layers.origin_m + layer * layers.spacing_m - height_m);
}

double misfit(const std::vector<HeadSpace::Level>& levels, const Lines& layers) {
  double sum = 0.0;
  for (const HeadSpace::Level& level : levels) {
    const double low = nearest_layer_m(layers, level.floor_m + kLowLayer_m);
    const double high = nearest_layer_m(layers, level.floor_m + std::min(kHighLayer_m, level.headroom_m - 0.25));
    const double in_floor = std::max(0.0, 0.15 - nearest_layer_m(layers, level.floor_m));
    sum += level.share * (low * low + high * high + 20.0 * in_floor * in_floor);
  }
  return sum;
}

// The height under which a share of the floor lies.
double height_below(const std::vector<HeadSpace::Level>& levels, double share) {
  double below = 0.0;
  for (const HeadSpace::Level& level : levels) {
    below += level.share;
    if (below >= share) return level.floor_m;
  }
  return levels.back().floor_m;
}

// The layers that fit the storeys best, about `layer_m` apart.
Lines choose_layers(const HeadSpace& heads, double layer_m) {
  const std::vector<HeadSpace::Level>& levels = heads.levels();
  if (levels.empty()) return spread(heads.bounds().lower_m.y, heads.bounds().upper_m.y, layer_m);
  // Heads above the last layer and below the first are served by it, so a small platform or pit needs none of its own.
  const double lowest = std::min(height_below(levels, 0.03), levels.front().floor_m + 0.5);
  const double highest = std::max(height_below(levels, 0.97) + kEyeHeight_m, levels.back().floor_m + 1.0);
  Lines best;
  double least = HUGE_VAL;
  for (int stretch = -4; stretch <= 6; ++stretch) {
    for (int lift = -4; lift <= 6; ++lift) {
      Lines layers;
      layers.spacing_m = layer_m * (1.0 + 0.04 * stretch);
      layers.origin_m = lowest + kLowLayer_m + 0.05 * lift;
      layers.count = std::max(1, int(std::ceil((highest - layers.origin_m) / layers.spacing_m - 0.05)) + 1);
      const double cost = misfit(levels, layers) + 0.01 * std::abs(stretch) + 0.001 * std::abs(lift);
      if (cost < least) {
        least = cost;
        best = layers;
      }
    }
  }
  return best;
}

bool fits(const ProbeGrid& grid, const HeadSpace& heads, std::size_t max_probes) {
  constexpr double kMostVertices = 4e4;  // more cannot be looked at in reasonable time, nor be needed
  const double vertices = double(grid.dims.x) * grid.dims.y * grid.dims.z;
  return vertices <= kMostVertices && count_useful(grid, heads) <= max_probes;
}

// How badly heads would be served: the share of wanted views that no probe within reach of the vertices of their cells
// could give. 0 is best.
double unserved(const ProbeGrid& grid, const RayScene& rays, const HeadSpace& heads) {
  constexpr std::size_t kEyes = 400;
  constexpr int kWantedViews = 4;
  const std::size_t stride = std::max<std::size_t>(1, heads.eyes().size() / kEyes) | 1;
  double missing = 0.0, count = 0.0;
  for (std::size_t i = 0; i < heads.eyes().size(); i += stride) {
    const glm::dvec3 eye = heads.eyes()[i];
    int views = 0;
    for (const glm::ivec3& corner : cell_corners(grid, eye)) {
      const glm::dvec3 vertex = vertex_m(grid, corner);
      const glm::dvec3 reach = kReach * grid.spacing_m;
      // The nearest place that a probe of the vertex can take, a little inwards.
      const glm::dvec3 place = glm::mix(glm::clamp(eye, vertex - reach, vertex + reach), vertex, 0.15);
      views += heads.holds(place) && !rays.occluded(glm::vec3(eye), glm::vec3(place - eye), 0.0f, 1.0f);
    }
    missing += std::max(0, kWantedViews - views) / double(kWantedViews);
    count += 1.0;
  }
  return count > 0.0 ? missing / count : 0.0;
}

// Walls between rooms should not leave a strip of room without lines: tries other insets and one line more along each
// axis, and keeps what serves heads best for its number of probes.
void shift_lines(ProbeGrid& grid, const RayScene& rays, const HeadSpace& heads, std::size_t max_probes) {
  constexpr double kPriceOfProbes = 0.15;  // views that doubling the number of probes must be worth
  constexpr std::array<double, 4> kInsets_m{0.3, 0.6, 0.9, 1.2};
  const double probes_before = double(std::max<std::size_t>(1, count_useful(grid, heads)));
  double least = unserved(grid, rays, heads);
  for (const int axis : {0, 2, 0}) {
    const double lower = heads.bounds().lower_m[axis];
    const double length = heads.bounds().upper_m[axis] - lower;
    const ProbeGrid base = grid;
    for (int cells = base.dims[axis] - 1; cells <= base.dims[axis]; ++cells) {
      for (const double from : kInsets_m) {
        for (const double to : kInsets_m) {
          if (cells < 1 || length - from - to < 0.5 * cells) continue;
          ProbeGrid shifted = base;
          shifted.origin_m[axis] = lower + from;
          shifted.spacing_m[axis] = (length - from - to) / cells;
          shifted.dims[axis] = cells + 1;
          const double missing = unserved(shifted, rays, heads);
          if (missing >= least || !fits(shifted, heads, max_probes)) continue;
          const double price = kPriceOfProbes * std::log2(double(count_useful(shifted, heads)) / probes_before);
          if (missing + std::max(0.0, price) >= least - 1e-9) continue;
          least = missing + std::max(0.0, price);
          grid = shifted;
        }
      }
    }
  }
}

ProbeGrid lay_grid(const HeadSpace& heads, double spacing_m, double layer_m) {
  const Bounds& box = heads.bounds();
  const Lines x = spread(box.lower_m.x, box.upper_m.x, spacing_m);
  const Lines y = choose_layers(heads, layer_m);
  const Lines z = spread(box.lower_m.z, box.upper_m.z, spacing_m);
  ProbeGrid grid;
  grid.origin_m = {x.origin_m, y.origin_m, z.origin_m};
  grid.spacing_m = {x.spacing_m, y.spacing_m, z.spacing_m};
  grid.dims = {x.count, y.count, z.count};
  return grid;
}

}  // namespace

double typical_spacing_m(const RayScene& rays, const HeadSpace& heads) {
  constexpr std::size_t kEyes = 200;
  constexpr int kDirections = 16;
  constexpr double kNarrowest_m = 1.6;
  constexpr double kWidest_m = 3.0;
  std::vector<double> free_m;
  const std::size_t stride = std::max<std::size_t>(1, heads.eyes().size() / kEyes) | 1;  // odd: standing and sitting
  for (std::size_t i = 0; i < heads.eyes().size(); i += stride) {
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.5) / kDirections;
      const SurfaceHit hit = rays.closest(glm::vec3(heads.eyes()[i]), {float(std::cos(angle)), 0.0f, float(std::sin(angle))});
      free_m.push_back(hit.hit ? double(hit.t) : 10.0);
    }
  }
  std::nth_element(free_m.begin(), free_m.begin() + std::ptrdiff_t(free_m.size() / 2), free_m.end());
  return std::clamp(1.25 * free_m[free_m.size() / 2], kNarrowest_m, kWidest_m);
}

std::array<glm::ivec3, 8> cell_corners(const ProbeGrid& grid, glm::dvec3 head_m) {
  const glm::dvec3 cell = glm::floor((head_m - grid.origin_m) / grid.spacing_m);
  const glm::ivec3 first = glm::ivec3(glm::clamp(cell, glm::dvec3(0.0), glm::dvec3(glm::max(grid.dims - 2, 0))));
  std::array<glm::ivec3, 8> corners;
  for (int k = 0; k < 8; ++k) corners[k] = glm::min(first + glm::ivec3(k & 1, k >> 1 & 1, k >> 2), grid.dims - 1);
  return corners;
}

bool is_useful(const ProbeGrid& grid, const HeadSpace& heads, glm::ivec3 vertex) {
  const glm::dvec3 at = vertex_m(grid, vertex);
  bool air = false;
  for (int code = 0; code < 125 && !air; ++code) {
    const glm::dvec3 offset = glm::dvec3(code % 5 - 2, code / 5 % 5 - 2, code / 25 - 2) * (0.5 * kReach);
    air = heads.holds(at + offset * grid.spacing_m);
  }
  return air && !heads.eyes_in(at - grid.spacing_m, at + grid.spacing_m, 1).empty();
}

std::size_t count_useful(const ProbeGrid& grid, const HeadSpace& heads) {
  std::size_t count = 0;
  for (int z = 0; z < grid.dims.z; ++z) {
    for (int y = 0; y < grid.dims.y; ++y) {
      for (int x = 0; x < grid.dims.x; ++x) count += is_useful(grid, heads, {x, y, z});
    }
  }
  return count;
}

bool still_serves(const ProbeGrid& grid, const HeadSpace& heads, std::size_t max_probes) {
  // As far as choose_grid leaves heads outside its lines.
  const glm::dvec3 beyond_m = glm::max(glm::dvec3(1.3), 0.75 * grid.spacing_m);
  const glm::dvec3 lower = grid.origin_m - beyond_m, upper = vertex_m(grid, grid.dims - 1) + beyond_m;
  for (const glm::dvec3& eye : heads.eyes()) {
    if (glm::any(glm::lessThan(eye, lower)) || glm::any(glm::greaterThan(eye, upper))) return false;
  }
  return fits(grid, heads, max_probes);
}

ProbeGrid choose_grid(const RayScene& rays, const HeadSpace& heads, double spacing_m, std::size_t max_probes) {
  double layer_m = std::max(1.0, std::min(kLayer_m, spacing_m));
  for (;;) {
    ProbeGrid grid = lay_grid(heads, spacing_m, layer_m);
    const bool fitting = fits(grid, heads, max_probes);
    const bool one_column = grid.dims.x == 1 && grid.dims.z == 1;
    if (fitting || one_column) {
      if (fitting) shift_lines(grid, rays, heads, max_probes);
      if (!fitting) grid.dims.y = int(std::clamp<std::size_t>(max_probes, 1, std::size_t(grid.dims.y)));
      grid.probe.assign(std::size_t(grid.dims.x) * grid.dims.y * grid.dims.z, 0);
      return grid;
    }
    spacing_m *= 1.06;
    layer_m = std::max(layer_m, std::min(2.0 * kLayer_m, layer_m * 1.04));
  }
}

}  // namespace probewalk
