#include "content/bake/rebake/space_cells.h"

#include <algorithm>

namespace probewalk {
namespace {

constexpr double kThinWall_m = 0.15;
constexpr double kMostCells = 2e6;

}  // namespace

SpaceCells SpaceCells::around(const Bounds& bounds) {
  SpaceCells cells;
  for (cells.cell_m = kThinWall_m;; cells.cell_m *= 1.25) {
    const glm::dvec3 first = glm::floor(bounds.lower_m / cells.cell_m) - 1.0;
    const glm::dvec3 last = glm::floor(bounds.upper_m / cells.cell_m) + 1.0;
    const glm::dvec3 count = last - first + 1.0;
    if (count.x * count.y * count.z > kMostCells) continue;
    cells.lower = glm::ivec3(first);
    cells.dims = glm::ivec3(count);
    return cells;
  }
}

// From border to border (Amanatides and Woo 1987). A hit is found a little off its place, so a ray ends a little later.
void insert_segment(const SpaceCells& cells, glm::dvec3 origin_m, glm::dvec3 direction, double t_end, IndexSet& set) {
  const double speed = glm::length(direction);
  t_end = t_end * (1.0 + 1e-6) + 1e-4 / speed;
  const glm::dvec3 low = cells.lower_m(glm::ivec3(0)), high = cells.lower_m(cells.dims);
  // The part within the cubes.
  double from = 0.0, to = t_end;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0.0) {
      if (origin_m[k] < low[k] || origin_m[k] >= high[k]) to = -1.0;
      continue;
    }
    const double a = (low[k] - origin_m[k]) / direction[k], b = (high[k] - origin_m[k]) / direction[k];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  if (from > 0.0 || to < t_end) set.insert(cells.outside());
  if (!(from <= to)) return;
  const glm::dvec3 start = origin_m + from * direction;
  glm::ivec3 cell = glm::clamp(cells.cell_of(start), glm::ivec3(0), cells.dims - 1);
  glm::ivec3 step(0);
  glm::dvec3 next(HUGE_VAL), each(HUGE_VAL);  // t at the next border, and between two
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0.0) continue;
    step[k] = direction[k] > 0.0 ? 1 : -1;
    const double border = double(cell[k] + cells.lower[k] + (step[k] > 0)) * cells.cell_m;
    next[k] = (border - origin_m[k]) / direction[k];
    each[k] = cells.cell_m / std::abs(direction[k]);
  }
  const glm::ivec3 stride(1, cells.dims.x, cells.dims.x * cells.dims.y);
  for (std::size_t at = cells.index(cell);;) {
    set.insert(at);
    const int axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
    if (next[axis] > to) return;
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] >= cells.dims[axis]) return;
    at += std::ptrdiff_t(step[axis]) * stride[axis];
    next[axis] += each[axis];
  }
}

}  // namespace probewalk
