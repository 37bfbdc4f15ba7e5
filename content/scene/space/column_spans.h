// Step 3: the scene's triangles cut into the square columns of a grid, as sorted spans of solid matter.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "content/scene/scene.h"

namespace probewalk {

// Matter between two heights of one column. `walkable`: what lies on top is flatter than 45 degrees.
struct SolidSpan {
  float lower_m = 0.0f;
  float upper_m = 0.0f;
  bool walkable = false;
};

// Columns of cell_m by cell_m metres; column (ix, iz) covers origin + cell * [ix, ix + 1] x [iz, iz + 1], closed.
struct ColumnSpans {
  glm::dvec2 origin_m{0.0};  // x, z
  double cell_m = 0.05;
  glm::ivec2 columns{0};
  std::vector<std::uint32_t> first;  // columns.x * columns.y + 1 offsets into spans, x fastest
  std::vector<SolidSpan> spans;      // of one column: ascending and disjoint

  bool holds(int ix, int iz) const { return ix >= 0 && iz >= 0 && ix < columns.x && iz < columns.y; }
  std::span<const SolidSpan> column(int ix, int iz) const {
    const std::size_t c = std::size_t(iz) * columns.x + ix;
    return {spans.data() + first[c], spans.data() + first[c + 1]};
  }
  glm::dvec2 centre_m(int ix, int iz) const { return origin_m + cell_m * glm::dvec2(ix + 0.5, iz + 0.5); }
  glm::ivec2 column_of(double x_m, double z_m) const {
    return glm::ivec2(glm::floor((glm::dvec2(x_m, z_m) - origin_m) / cell_m));
  }
};

// The part of the ground plan that is worth columns: all of the scene, or, where that would need columns wider than
// kWidestCell_m (a house on a plain of kilometres), the box around the bulk of its triangles.
struct GroundPlan {
  glm::dvec2 lower_m{0.0};
  glm::dvec2 upper_m{0.0};
  double cell_m = 0.05;
  bool cropped = false;
};

inline constexpr double kWidestCell_m = 0.1;
inline constexpr double kMostColumns = 0.75e6;

// The finest cell at or above `voxel_m` whose columns and pieces of triangles stay within memory.
GroundPlan plan_ground(const Scene& scene, double voxel_m);

// Clips every triangle to every column that it touches; pieces closer than 2 cm become one span.
ColumnSpans build_column_spans(const Scene& scene, const GroundPlan& plan);
// The same over the grid of columns that a floor map uses.
ColumnSpans build_column_spans(const Scene& scene, glm::dvec2 origin_m, double cell_m, glm::ivec2 columns);

}  // namespace probewalk
