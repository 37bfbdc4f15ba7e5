#include "content/bake/placement/grid_choice.h"

#include <algorithm>
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

// The layers that fit the storeys best, about `layer_m` apart.
Lines choose_layers(const HeadSpace& heads, double layer_m) {
  const std::vector<HeadSpace::Level>& levels = heads.levels();
  if (levels.empty()) return spread(heads.bounds().lower_m.y, heads.bounds().upper_m.y, layer_m);
  const double lowest = levels.front().floor_m;
  const double highest = levels.back().floor_m + kEyeHeight_m + 0.1;
  Lines best;
  double least = HUGE_VAL;
  for (int stretch = -4; stretch <= 6; ++stretch) {
    for (int lift = -4; lift <= 6; ++lift) {
      Lines layers;
      layers.spacing_m = layer_m * (1.0 + 0.04 * stretch);
      layers.origin_m = lowest + kLowLayer_m + 0.05 * lift;
      layers.count = std::max(1, int(std::ceil((highest - layers.origin_m) / layers.spacing_m - 1e-9)) + 1);
      const double cost = misfit(levels, layers) + 0.01 * std::abs(stretch) + 0.001 * std::abs(lift);
      if (cost < least) {
        least = cost;
        best = layers;
      }
    }
  }
  return best;
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

bool is_useful(const ProbeGrid& grid, const HeadSpace& heads, glm::ivec3 vertex) {
  const glm::dvec3 at = vertex_m(grid, vertex);
  bool air = false;
  for (int code = 0; code < 125 && !air; ++code) {
    const glm::dvec3 offset = glm::dvec3(code % 5 - 2, code / 5 % 5 - 2, code / 25 - 2) * 0.24;
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

ProbeGrid choose_grid(const HeadSpace& heads, double spacing_m, std::size_t max_probes) {
  constexpr double kMostVertices = 4e4;  // more cannot be looked at in reasonable time, nor be needed
  double layer_m = std::max(1.0, std::min(kLayer_m, spacing_m));
  for (;;) {
    ProbeGrid grid = lay_grid(heads, spacing_m, layer_m);
    const double vertices = double(grid.dims.x) * grid.dims.y * grid.dims.z;
    const bool fits = vertices <= kMostVertices && count_useful(grid, heads) <= max_probes;
    const bool one_column = grid.dims.x == 1 && grid.dims.z == 1;
    if (fits || one_column) {
      if (!fits) grid.dims.y = int(std::clamp<std::size_t>(max_probes, 1, std::size_t(grid.dims.y)));
      grid.probe.assign(std::size_t(grid.dims.x) * grid.dims.y * grid.dims.z, 0);
      return grid;
    }
    spacing_m *= 1.06;
    layer_m *= 1.02;
  }
}

}  // namespace probewalk
