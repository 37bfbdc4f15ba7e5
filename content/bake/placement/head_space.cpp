#include "content/bake/placement/head_space.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "content/scene/space/floor_graph.h"

namespace probewalk {
namespace {

constexpr double kLean_m = 1.25;          // how far from the floor a head gets over a table or bed
constexpr float kFurnitureTop_m = 1.4f;   // higher than this is a wall to a head
constexpr float kPassage_m = 0.3f;        // least common height through which air joins
constexpr float kAboveFeet_m = 2.2f;      // air higher than this is not passed on from column to column
constexpr float kHighest_m = 2.6f;        // above the floor: no head, and no probe for heads, is higher
constexpr double kEyeSpacing_m = 0.5;
constexpr double kMostEyePlaces = 2000.0;
constexpr double kSittingEye_m = 0.8;

float gap_top(std::span<const SolidSpan> column, std::size_t s) {
  return s + 1 < column.size() ? column[s + 1].lower_m : column[s].upper_m + 20.0f;
}

}  // namespace

HeadSpace::HeadSpace(const Scene& scene, const RayScene& rays, const Space& space) : rays_(rays) {
  if (space.floor.nodes.empty()) {
    sample_hovering(scene, rays, space);
    return;
  }
  columns_ = build_column_spans(scene, space.floor.origin_m, space.floor.cell_m, space.floor.columns);
  spread_from_floor(space.floor);
  sample_standing(space);
}

void HeadSpace::spread_from_floor(const FloorMap& floor) {
  above_.resize(columns_.spans.size());
  struct Gap {
    int ix, iz;
    std::uint32_t span;
  };
  std::vector<Gap> front;
  for (const FloorNode& node : floor.nodes) {
    const std::size_t c = std::size_t(node.iz) * columns_.columns.x + node.ix;
    for (std::uint32_t s = columns_.first[c]; s < columns_.first[c + 1]; ++s) {
      if (std::abs(columns_.spans[s].upper_m - node.floor_m) > 1e-3f) continue;
      above_[s] = {node.floor_m, node.room, true};
      front.push_back({node.ix, node.iz, s});
    }
  }
  const int rings = int(kLean_m / columns_.cell_m);
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<Gap> grown;
    for (const Gap& gap : front) {
      const auto own = columns_.column(gap.ix, gap.iz);
      const std::size_t own_first = columns_.first[std::size_t(gap.iz) * columns_.columns.x + gap.ix];
      const float floor_m = above_[gap.span].floor_m;
      const float own_lower = columns_.spans[gap.span].upper_m;
      const float own_upper = std::min(gap_top(own, gap.span - own_first), floor_m + kAboveFeet_m);
      for (int k = 0; k < 4; ++k) {
        const int x = gap.ix + kLinkX[k];
        const int z = gap.iz + kLinkZ[k];
        if (!columns_.holds(x, z)) continue;
        const auto column = columns_.column(x, z);
        const std::uint32_t first = columns_.first[std::size_t(z) * columns_.columns.x + x];
        for (std::uint32_t s = 0; s < column.size(); ++s) {
          if (above_[first + s].reached) continue;
          const float lower = column[s].upper_m;
          const float upper = gap_top(column, s);
          const bool on_furniture = lower >= floor_m - float(kStep_m) && lower <= floor_m + kFurnitureTop_m;
          // Floor that is not part of the space (a garden behind an open window) ends it.
          const bool foreign_floor =
              column[s].walkable && upper - lower >= float(kHeadroom_m) && lower <= floor_m + float(kStep_m);
          if (!on_furniture || foreign_floor) continue;
          if (std::min(upper, own_upper) - std::max(lower, own_lower) < kPassage_m) continue;
          above_[first + s] = {floor_m, above_[gap.span].room, true};
          grown.push_back({x, z, first + s});
        }
      }
    }
    front = std::move(grown);
  }
}

void HeadSpace::sample_standing(const Space& space) {
  const FloorMap& floor = space.floor;
  const double area_m2 = double(floor.nodes.size()) * floor.cell_m * floor.cell_m;
  const double spacing_m = std::max(kEyeSpacing_m, std::sqrt(area_m2 / kMostEyePlaces));
  struct Bin {
    glm::dvec3 sum{0.0};
    std::vector<std::uint32_t> nodes;
  };
  std::map<std::tuple<int, int, int>, Bin> bins;  // by floor, z, x
  std::map<int, std::pair<double, double>> heights;  // by decimetre: nodes, sum of headrooms
  for (std::size_t i = 0; i < floor.nodes.size(); ++i) {
    const FloorNode& node = floor.nodes[i];
    const glm::dvec2 at = columns_.centre_m(node.ix, node.iz);
    const glm::ivec2 cell(glm::floor((at - floor.origin_m) / spacing_m));
    Bin& bin = bins[{int(std::floor(node.floor_m / 0.5f)), cell.y, cell.x}];
    bin.sum += glm::dvec3(at.x, node.floor_m, at.y);
    bin.nodes.push_back(std::uint32_t(i));
    auto& [count, headroom] = heights[int(std::floor(node.floor_m / 0.1f + 0.5f))];
    count += 1.0;
    headroom += node.headroom_m;
    bounds_.lower_m = glm::min(bounds_.lower_m, glm::dvec3(at.x, node.floor_m, at.y) - glm::dvec3(0.5, 0, 0.5) * floor.cell_m);
    bounds_.upper_m = glm::max(bounds_.upper_m, glm::dvec3(at.x, node.floor_m, at.y) + glm::dvec3(0.5, 0, 0.5) * floor.cell_m);
  }
  for (const auto& [key, bin] : bins) {
    const glm::dvec3 mean = bin.sum / double(bin.nodes.size());
    const auto nearest = std::min_element(bin.nodes.begin(), bin.nodes.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto away = [&](std::uint32_t i) {
        return glm::distance(columns_.centre_m(floor.nodes[i].ix, floor.nodes[i].iz), glm::dvec2(mean.x, mean.z));
      };
      return away(a) < away(b);
    });
    const FloorNode& node = floor.nodes[*nearest];
    const glm::dvec2 at = columns_.centre_m(node.ix, node.iz);
    eyes_.push_back({at.x, node.floor_m + std::min(kEyeHeight_m, node.headroom_m - 0.1), at.y});
    eyes_.push_back({at.x, node.floor_m + kSittingEye_m, at.y});
  }
  for (const auto& [decimetre, sums] : heights) {
    levels_.push_back({0.1 * decimetre, sums.second / sums.first, sums.first / double(floor.nodes.size())});
  }
  bounds_.lower_m.y += kSittingEye_m;
  bounds_.upper_m.y += kEyeHeight_m;
}

void HeadSpace::sample_hovering(const Scene& scene, const RayScene& rays, const Space& space) {
  constexpr int kSide = 9;
  hovering_ = true;
  hover_m_ = space.start.position_m;
  bounds_.lower_m = glm::min(scene.bounds.lower_m, hover_m_);
  bounds_.upper_m = glm::max(scene.bounds.upper_m, hover_m_);
  if (!glm::all(glm::lessThanEqual(scene.bounds.lower_m, scene.bounds.upper_m))) bounds_ = {hover_m_, hover_m_};
  eyes_.push_back(hover_m_);
  const glm::dvec3 extent = bounds_.upper_m - bounds_.lower_m;
  for (int code = 0; code < kSide * kSide * kSide; ++code) {
    const glm::dvec3 part(code % kSide + 1, code / kSide % kSide + 1, code / (kSide * kSide) + 1);
    const glm::dvec3 eye = bounds_.lower_m + extent * part / double(kSide + 1);
    if (!rays.occluded(glm::vec3(hover_m_), glm::vec3(eye - hover_m_), 0.0f, 1.0f)) eyes_.push_back(eye);
  }
}

std::int64_t HeadSpace::gap_at(glm::dvec3 point_m) const {
  const glm::ivec2 cell = columns_.column_of(point_m.x, point_m.z);
  if (!columns_.holds(cell.x, cell.y)) return -1;
  const auto column = columns_.column(cell.x, cell.y);
  const std::uint32_t first = columns_.first[std::size_t(cell.y) * columns_.columns.x + cell.x];
  for (std::uint32_t s = 0; s < column.size(); ++s) {
    if (point_m.y <= column[s].upper_m || point_m.y >= gap_top(column, s)) continue;
    const Owner& owner = above_[first + s];
    return owner.reached && point_m.y <= owner.floor_m + kHighest_m ? std::int64_t(first + s) : -1;
  }
  return -1;
}

bool HeadSpace::holds(glm::dvec3 point_m) const {
  if (!hovering_) return gap_at(point_m) >= 0;
  const bool inside = glm::all(glm::lessThanEqual(bounds_.lower_m, point_m)) && glm::all(glm::lessThanEqual(point_m, bounds_.upper_m));
  return inside && !rays_.occluded(glm::vec3(hover_m_), glm::vec3(point_m - hover_m_), 0.0f, 1.0f);
}

int HeadSpace::room(glm::dvec3 point_m) const {
  if (hovering_) return 0;
  const std::int64_t gap = gap_at(point_m);
  return gap < 0 ? 0 : above_[gap].room;
}

std::vector<std::uint32_t> HeadSpace::eyes_in(glm::dvec3 lower_m, glm::dvec3 upper_m, std::size_t most) const {
  std::vector<std::uint32_t> inside;
  for (std::size_t i = 0; i < eyes_.size(); ++i) {
    if (glm::all(glm::lessThanEqual(lower_m, eyes_[i])) && glm::all(glm::lessThanEqual(eyes_[i], upper_m))) {
      inside.push_back(std::uint32_t(i));
    }
  }
  if (inside.size() <= most) return inside;
  std::vector<std::uint32_t> thinned;
  for (std::size_t k = 0; k < most; ++k) thinned.push_back(inside[(2 * k + 1) * inside.size() / (2 * most)]);
  return thinned;
}

}  // namespace probewalk
