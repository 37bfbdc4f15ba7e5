// Space cut into small cubes: where rays have passed, and what lies there.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

#include "content/bake/rebake/index_set.h"
#include "content/scene/scene.h"

namespace probewalk {

struct SpaceCells {
  double cell_m = 0.15;
  glm::ivec3 lower{0};  // the first cell, in cells from the origin
  glm::ivec3 dims{1};

  // Around the bounds. Cells are as thin as a wall, so that what stands against its other side is not in them, unless
  // that would be more than two million.
  static SpaceCells around(const Bounds& bounds);

  std::size_t inside() const { return std::size_t(dims.x) * dims.y * dims.z; }
  // Everything beyond the cubes, the sky included, counts as one cell; and what is asked for everywhere as another.
  std::size_t outside() const { return inside(); }
  std::size_t everywhere() const { return inside() + 1; }
  std::size_t count() const { return inside() + 2; }

  glm::ivec3 cell_of(glm::dvec3 position_m) const { return glm::ivec3(glm::floor(position_m / cell_m)) - lower; }
  bool holds(glm::ivec3 cell) const {
    return glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) && glm::all(glm::lessThan(cell, dims));
  }
  std::size_t index(glm::ivec3 cell) const {
    return holds(cell) ? (std::size_t(cell.z) * dims.y + cell.y) * dims.x + cell.x : outside();
  }
  glm::dvec3 lower_m(glm::ivec3 cell) const { return glm::dvec3(cell + lower) * cell_m; }

  bool operator==(const SpaceCells&) const = default;
};

// Thread-safe. All cells that origin + t * direction passes for t from 0 to t_end, which may be infinite.
void insert_segment(const SpaceCells& cells, glm::dvec3 origin_m, glm::dvec3 direction, double t_end, IndexSet& set);

}  // namespace probewalk
