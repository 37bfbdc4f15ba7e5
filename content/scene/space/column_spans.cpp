#include "content/scene/space/column_spans.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace probewalk {
namespace {

constexpr double kWalkableNormalY = 0.7;  // about 45 degrees
constexpr float kSpanGap_m = 0.02f;       // pieces closer than this are one solid; also tells which piece lies on top
constexpr double kMostPieces = 24e6;      // 16 bytes each

// A triangle clipped by axis-aligned half-spaces: each can add one corner.
class Polygon {
 public:
  Polygon() = default;
  Polygon(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) : size_(3), corner_{a, b, c} {}

  bool empty() const { return size_ == 0; }
  // Keeps what lies on the side of `plane` that `sign` points to; corners on the plane stay on both sides.
  Polygon clipped(int axis, double plane, double sign) const {
    Polygon out;
    for (int i = 0; i < size_; ++i) {
      const glm::dvec3& a = corner_[i];
      const glm::dvec3& b = corner_[(i + 1) % size_];
      const double da = sign * (a[axis] - plane);
      const double db = sign * (b[axis] - plane);
      if (da >= 0.0) out.add(a);
      if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) out.add(a + (b - a) * (da / (da - db)));
    }
    return out;
  }
  double lowest(int axis) const {
    double v = corner_[0][axis];
    for (int i = 1; i < size_; ++i) v = std::min(v, corner_[i][axis]);
    return v;
  }
  double highest(int axis) const {
    double v = corner_[0][axis];
    for (int i = 1; i < size_; ++i) v = std::max(v, corner_[i][axis]);
    return v;
  }

 private:
  // Four half-spaces leave at most 7 corners; rounding may repeat one, and what exceeds the array repeats too.
  void add(glm::dvec3 p) {
    if (size_ < int(corner_.size())) corner_[size_++] = p;
  }
  int size_ = 0;
  std::array<glm::dvec3, 12> corner_{};
};

struct Piece {
  std::uint32_t column;
  SolidSpan span;
};

bool before(const SolidSpan& a, const SolidSpan& b) {
  if (a.lower_m != b.lower_m) return a.lower_m < b.lower_m;
  if (a.upper_m != b.upper_m) return a.upper_m < b.upper_m;
  return a.walkable < b.walkable;
}

// Sorted pieces of one column become disjoint spans; the highest piece (within the gap) decides whether one can walk.
void append_merged(std::span<const SolidSpan> pieces, std::vector<SolidSpan>& out) {
  const std::size_t begin = out.size();
  for (const SolidSpan& piece : pieces) {
    if (out.size() == begin || piece.lower_m > out.back().upper_m + kSpanGap_m) {
      out.push_back(piece);
      continue;
    }
    SolidSpan& last = out.back();
    if (piece.upper_m > last.upper_m + kSpanGap_m) {
      last.walkable = piece.walkable;
    } else if (piece.upper_m > last.upper_m - kSpanGap_m) {
      last.walkable = last.walkable || piece.walkable;
    }
    last.upper_m = std::max(last.upper_m, piece.upper_m);
  }
}

std::array<glm::dvec3, 3> corners(const Scene& scene, const glm::uvec3& triangle) {
  return {glm::dvec3(scene.positions_m[triangle.x]), glm::dvec3(scene.positions_m[triangle.y]),
          glm::dvec3(scene.positions_m[triangle.z])};
}

bool finite(const std::array<glm::dvec3, 3>& p) {
  for (const glm::dvec3& v : p) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
  }
  return true;
}

// Pieces that the triangles would make at most, boxes standing for triangles.
double count_pieces(const Scene& scene, const GroundPlan& plan) {
  double pieces = 0.0;
  for (const glm::uvec3& triangle : scene.triangles) {
    const auto p = corners(scene, triangle);
    if (!finite(p)) continue;
    double cells = 1.0;
    for (int k = 0; k < 2; ++k) {
      const int axis = 2 * k;
      const double lo = std::max(plan.lower_m[k], std::min({p[0][axis], p[1][axis], p[2][axis]}));
      const double hi = std::min(plan.upper_m[k], std::max({p[0][axis], p[1][axis], p[2][axis]}));
      cells *= hi < lo ? 0.0 : (hi - lo) / plan.cell_m + 1.0;
    }
    pieces += cells;
  }
  return pieces;
}

double cell_for(glm::dvec2 extent_m, double voxel_m) {
  return std::max(voxel_m, std::sqrt(extent_m.x * extent_m.y / kMostColumns));
}

// The box that holds all but the outermost 2 % of the triangles on every side, and a margin.
void crop_to_bulk(const Scene& scene, GroundPlan& plan) {
  constexpr double kMargin_m = 5.0;
  for (int k = 0; k < 2; ++k) {
    std::vector<double> middle;
    middle.reserve(scene.triangles.size());
    for (const glm::uvec3& triangle : scene.triangles) {
      const auto p = corners(scene, triangle);
      if (finite(p)) middle.push_back((p[0][2 * k] + p[1][2 * k] + p[2][2 * k]) / 3.0);
    }
    if (middle.empty()) return;
    std::sort(middle.begin(), middle.end());
    const std::size_t cut = middle.size() / 50;
    plan.lower_m[k] = std::max(plan.lower_m[k], middle[cut] - kMargin_m);
    plan.upper_m[k] = std::min(plan.upper_m[k], middle[middle.size() - 1 - cut] + kMargin_m);
  }
  plan.cropped = true;
}

}  // namespace

GroundPlan plan_ground(const Scene& scene, double voxel_m) {
  GroundPlan plan;
  plan.cell_m = voxel_m;
  const Bounds& box = scene.bounds;
  if (!(box.lower_m.x <= box.upper_m.x && box.lower_m.z <= box.upper_m.z)) return plan;
  plan.lower_m = {box.lower_m.x, box.lower_m.z};
  plan.upper_m = {box.upper_m.x, box.upper_m.z};
  if (cell_for(plan.upper_m - plan.lower_m, voxel_m) > kWidestCell_m) crop_to_bulk(scene, plan);
  plan.cell_m = cell_for(plan.upper_m - plan.lower_m, voxel_m);
  while (count_pieces(scene, plan) > kMostPieces && plan.cell_m < 1.0) plan.cell_m *= 1.25;
  return plan;
}

ColumnSpans build_column_spans(const Scene& scene, const GroundPlan& plan) {
  // Walls stand on round numbers; an odd origin keeps them off the borders of columns.
  const glm::dvec2 origin_m = plan.lower_m - plan.cell_m * glm::dvec2(2.37, 2.63);
  const glm::ivec2 columns = glm::ivec2((plan.upper_m - origin_m) / plan.cell_m) + 4;
  return build_column_spans(scene, origin_m, plan.cell_m, columns);
}

ColumnSpans build_column_spans(const Scene& scene, glm::dvec2 origin_m, double cell_m, glm::ivec2 columns) {
  ColumnSpans grid;
  grid.origin_m = origin_m;
  grid.cell_m = cell_m;
  grid.columns = columns;
  std::vector<Piece> pieces;
  const auto cell_index = [&](double value_m, int k) {
    const double cell = std::floor((value_m - origin_m[k]) / cell_m);
    return int(std::clamp(cell, -1.0, double(columns[k])));
  };
  for (const glm::uvec3& triangle : scene.triangles) {
    const auto p = corners(scene, triangle);
    if (!finite(p)) continue;
    const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double area2 = glm::length(normal);
    const bool walkable = area2 > 1e-12 && std::abs(normal.y) > kWalkableNormalY * area2;
    Polygon rest(p[0], p[1], p[2]);
    const int z_first = std::max(0, cell_index(rest.lowest(2), 1));
    const int z_last = std::min(columns.y - 1, cell_index(rest.highest(2), 1));
    rest = rest.clipped(2, origin_m.y + z_first * cell_m, 1.0);
    for (int iz = z_first; iz <= z_last && !rest.empty(); ++iz) {
      const double z_border = origin_m.y + (iz + 1) * cell_m;
      Polygon row = rest.clipped(2, z_border, -1.0);
      rest = rest.clipped(2, z_border, 1.0);
      if (row.empty()) continue;
      const int x_first = std::max(0, cell_index(row.lowest(0), 0));
      const int x_last = std::min(columns.x - 1, cell_index(row.highest(0), 0));
      row = row.clipped(0, origin_m.x + x_first * cell_m, 1.0);
      for (int ix = x_first; ix <= x_last && !row.empty(); ++ix) {
        const double x_border = origin_m.x + (ix + 1) * cell_m;
        const Polygon piece = row.clipped(0, x_border, -1.0);
        row = row.clipped(0, x_border, 1.0);
        if (piece.empty()) continue;
        pieces.push_back({std::uint32_t(iz) * std::uint32_t(columns.x) + std::uint32_t(ix),
                          {float(piece.lowest(1)), float(piece.highest(1)), walkable}});
      }
    }
  }

  const std::size_t count = std::size_t(columns.x) * std::size_t(columns.y);
  std::vector<std::uint32_t> begin(count + 1, 0);
  for (const Piece& piece : pieces) ++begin[piece.column + 1];
  for (std::size_t c = 0; c < count; ++c) begin[c + 1] += begin[c];
  std::vector<SolidSpan> by_column(pieces.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (const Piece& piece : pieces) by_column[next[piece.column]++] = piece.span;
  pieces = {};

  grid.first.reserve(count + 1);
  for (std::size_t c = 0; c < count; ++c) {
    grid.first.push_back(std::uint32_t(grid.spans.size()));
    const std::span<SolidSpan> column(by_column.data() + begin[c], by_column.data() + begin[c + 1]);
    std::sort(column.begin(), column.end(), before);
    append_merged(column, grid.spans);
  }
  grid.first.push_back(std::uint32_t(grid.spans.size()));
  return grid;
}

}  // namespace probewalk
