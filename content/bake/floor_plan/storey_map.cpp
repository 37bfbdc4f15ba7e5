#include "content/bake/floor_plan/storey_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "content/scene/space/column_spans.h"
#include "content/scene/space/floor_graph.h"
#include "content/scene/space/head_map.h"

namespace probewalk {
namespace {

constexpr double kLevelsApart_m = 1.5;   // at least, for two levels
constexpr double kLevelShare = 0.03;     // of the floor, that makes a level
constexpr std::size_t kMostLevels = 12;
constexpr double kBelowLevel_m = 0.6;    // what is no more than this below a level belongs to it; stairs to what they leave
constexpr double kOverlap_m2 = 2.0;      // levels that lie over each other by more are storeys of their own
constexpr double kOverlapShare = 0.05;
// Heights over the floor:
constexpr float kSameFloor_m = float(kStep_m);
constexpr float kThreshold_m = 0.12f;                 // lower is no furniture
constexpr float kShoulder_m = 1.4f, kCrown_m = 1.8f;  // as rooms are told apart
constexpr float kTall_m = 2.3f;                       // what is cut by the eyes and higher than this is a wall
constexpr float kSillFoot_m = 0.2f, kSill_m = 0.5f;   // a wall below a window has matter between
constexpr float kLintel_m = 0.15f;                    // and over it something this high hangs from the ceiling
constexpr double kVoid_m = 4.0;                       // how far over a storey below its edge is followed
constexpr double kInWalls_m = 0.6;                    // how deep walls are looked into
constexpr double kThickest_m = 1.2;                   // between two faces of one wall

// Heights at which much floor lies.
std::vector<double> find_levels(const FloorMap& floor) {
  std::map<int, std::size_t> area;  // by 0.2 m
  for (const FloorNode& node : floor.nodes) ++area[int(std::floor(node.floor_m / 0.2f + 0.5f))];
  std::vector<std::pair<std::size_t, double>> peaks;
  for (const auto& [height, count] : area) peaks.push_back({count, 0.2 * height});
  std::stable_sort(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<double> levels;
  for (const auto& [count, height] : peaks) {
    const bool apart =
        std::all_of(levels.begin(), levels.end(), [&](double s) { return std::abs(s - height) >= kLevelsApart_m; });
    const bool large = levels.empty() || double(count) >= kLevelShare * double(floor.nodes.size());
    if (apart && large && levels.size() < kMostLevels) levels.push_back(height);
  }
  std::sort(levels.begin(), levels.end());
  return levels;
}

std::size_t level_of(const std::vector<double>& levels, double floor_m) {
  std::size_t level = 0;
  for (std::size_t s = 1; s < levels.size(); ++s) level = floor_m > levels[s] - kBelowLevel_m ? s : level;
  return level;
}

// By level: its storey.
std::vector<std::size_t> group_levels(const FloorMap& floor, const std::vector<double>& levels) {
  const std::size_t columns = std::size_t(floor.columns.x) * floor.columns.y;
  std::vector<std::vector<std::uint32_t>> of_level(levels.size());
  for (const FloorNode& node : floor.nodes) {
    of_level[level_of(levels, node.floor_m)].push_back(std::uint32_t(node.iz) * std::uint32_t(floor.columns.x) +
                                                       std::uint32_t(node.ix));
  }
  std::vector<std::size_t> storey(levels.size(), 0);
  std::vector<bool> taken(columns, false);
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const auto over = std::count_if(of_level[level].begin(), of_level[level].end(),
                                    [&](std::uint32_t column) { return bool(taken[column]); });
    const double over_m2 = double(over) * floor.cell_m * floor.cell_m;
    const bool apart = over_m2 > kOverlap_m2 && double(over) > kOverlapShare * double(of_level[level].size());
    if (level > 0) storey[level] = storey[level - 1] + apart;
    if (apart) std::fill(taken.begin(), taken.end(), false);
    for (const std::uint32_t column : of_level[level]) taken[column] = true;
  }
  return storey;
}

PlanMatter matter_of(std::span<const SolidSpan> column, float floor_m, float ceiling_m) {
  bool stands = false, below = false, hangs = false, grounded = false;
  for (const SolidSpan& span : column) {
    if (span.upper_m > floor_m + kShoulder_m && span.lower_m < floor_m + kCrown_m) {
      const float tall_m = std::min(floor_m + kTall_m, ceiling_m - 0.3f);
      return span.upper_m >= tall_m ? PlanMatter::kWall : PlanMatter::kCupboard;
    }
    if (span.upper_m <= floor_m + kShoulder_m) {
      grounded |= span.upper_m >= floor_m - kSameFloor_m;
      stands |= span.upper_m > floor_m + kThreshold_m;
      below |= span.lower_m < floor_m + kSillFoot_m && span.upper_m > floor_m + kSill_m;
    } else {
      hangs |= span.lower_m < ceiling_m - kLintel_m && span.upper_m >= ceiling_m - kLintel_m;
    }
  }
  if (below && hangs) return PlanMatter::kWindow;
  if (stands) return PlanMatter::kFurniture;
  return grounded ? PlanMatter::kFloor : PlanMatter::kNothing;
}

bool is_solid(PlanMatter matter) { return matter >= PlanMatter::kCupboard; }

// Fills one storey's cells from its nodes outwards.
class StoreyBuilder {
 public:
  // `under`: the columns in which a lower storey has floor.
  StoreyBuilder(const FloorMap& floor, const ColumnSpans& spans, const std::vector<bool>& under)
      : floor_(floor), spans_(spans), under_(under), cells_(std::size_t(floor.columns.x) * floor.columns.y), ceiling_m_(cells_.size()) {}

  void add(const FloorNode& node) {  // ascending in height within a column: from above, the highest is seen
    const std::size_t c = index(node.ix, node.iz);
    if (cells_[c].matter == PlanMatter::kNothing) front_.push_back({node.ix, node.iz});
    cells_[c] = {PlanMatter::kFloor, node.room, node.floor_m};
    ceiling_m_[c] = node.floor_m + node.headroom_m;
  }

  std::vector<PlanCell> build() {
    lean_over_furniture();
    look_over_edges();
    look_into_walls();
    close_walls();
    return std::move(cells_);
  }

 private:
  std::size_t index(int ix, int iz) const { return std::size_t(iz) * floor_.columns.x + ix; }
  bool holds(glm::ivec2 p) const {
    return p.x >= 0 && p.y >= 0 && p.x < floor_.columns.x && p.y < floor_.columns.y;
  }

  // Calls visit(to, from) ring by ring for every cell beside the front that is not yet anything; it says whether the cell
  // belongs to the next front.
  template <class Visit>
  void spread(double far_m, Visit visit) {
    const int rings = int(far_m / floor_.cell_m);
    std::vector<glm::ivec2> front = front_;
    for (int ring = 0; ring < rings && !front.empty(); ++ring) {
      std::vector<glm::ivec2> grown;
      for (const glm::ivec2 from : front) {
        for (int k = 0; k < 4; ++k) {
          const glm::ivec2 to = from + glm::ivec2(kLinkX[k], kLinkZ[k]);
          if (holds(to) && visit(index(to.x, to.y), index(from.x, from.y), to)) grown.push_back(to);
        }
      }
      front_.insert(front_.end(), grown.begin(), grown.end());
      front = std::move(grown);
    }
  }

  void lean_over_furniture() {
    spread(kFurnitureDepth_m, [&](std::size_t to, std::size_t from, glm::ivec2 at) {
      if (cells_[to].matter != PlanMatter::kNothing) return false;
      const PlanMatter matter = matter_of(spans_.column(at.x, at.y), cells_[from].floor_m, ceiling_m_[from]);
      if (matter == PlanMatter::kNothing || is_solid(matter)) return false;
      cells_[to] = {matter, cells_[from].room, cells_[from].floor_m};
      ceiling_m_[to] = ceiling_m_[from];
      return true;
    });
  }

  void look_over_edges() {
    spread(kVoid_m, [&](std::size_t to, std::size_t from, glm::ivec2 at) {
      if (cells_[to].matter != PlanMatter::kNothing || !under_[to]) return false;
      if (matter_of(spans_.column(at.x, at.y), cells_[from].floor_m, ceiling_m_[from]) != PlanMatter::kNothing) return false;
      cells_[to] = {PlanMatter::kVoid, cells_[from].room, cells_[from].floor_m};
      ceiling_m_[to] = ceiling_m_[from];
      return true;
    });
  }

  // Faces of walls and of tall furniture, and the hollow behind them, which may be their inside.
  void look_into_walls() {
    seen_.assign(cells_.size(), false);
    spread(kInWalls_m, [&](std::size_t to, std::size_t from, glm::ivec2 at) {
      if (cells_[to].matter != PlanMatter::kNothing || seen_[to]) return false;
      const bool from_open = !seen_[from];
      PlanMatter matter = matter_of(spans_.column(at.x, at.y), cells_[from].floor_m, ceiling_m_[from]);
      if (from_open && !is_solid(matter)) return false;  // an edge of the floor, not a wall
      if (!is_solid(matter)) matter = PlanMatter::kNothing;
      seen_[to] = true;
      cells_[to] = {matter, cells_[from].room, cells_[from].floor_m};
      ceiling_m_[to] = ceiling_m_[from];
      return true;
    });
  }

  // What is hollow between two faces is the inside of what they belong to; of a cupboard, where one is a cupboard's. Of
  // the ways across, along x and along z, the shorter counts: it is the wall's thickness, not a window's width.
  void close_walls() {
    const auto longest = std::uint16_t(std::min(kThickest_m / floor_.cell_m, 60000.0));
    struct Inside {
      std::uint16_t thickness = 65535;
      PlanMatter matter = PlanMatter::kNothing;
    };
    std::vector<Inside> inside(cells_.size());
    const auto close_line = [&](std::size_t first, std::size_t step, int length) {
      int face = -1;
      for (int k = 0; k < length; ++k) {
        const std::size_t c = first + std::size_t(k) * step;
        const PlanMatter matter = cells_[c].matter;
        if (matter == PlanMatter::kNothing && seen_[c]) continue;
        const int between = k - face - 1;
        if (is_solid(matter) && face >= 0 && between <= longest) {
          const Inside found{std::uint16_t(between), std::min(matter, cells_[first + std::size_t(face) * step].matter)};
          for (int h = face + 1; h < k; ++h) {
            Inside& best = inside[first + std::size_t(h) * step];
            if (found.thickness < best.thickness) best = found;
          }
        }
        face = is_solid(matter) ? k : -1;
      }
    };
    const std::size_t width = std::size_t(floor_.columns.x);
    for (int iz = 0; iz < floor_.columns.y; ++iz) close_line(std::size_t(iz) * width, 1, floor_.columns.x);
    for (int ix = 0; ix < floor_.columns.x; ++ix) close_line(std::size_t(ix), width, floor_.columns.y);
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      if (inside[c].matter != PlanMatter::kNothing) cells_[c].matter = inside[c].matter;
    }
  }

  const FloorMap& floor_;
  const ColumnSpans& spans_;
  const std::vector<bool>& under_;
  std::vector<PlanCell> cells_;
  std::vector<float> ceiling_m_;
  std::vector<bool> seen_;
  std::vector<glm::ivec2> front_;
};

void find_used(StoreyMaps& maps) {
  maps.used_from = maps.columns;
  for (const StoreyMap& storey : maps.storeys) {
    for (int iz = 0; iz < maps.columns.y; ++iz) {
      for (int ix = 0; ix < maps.columns.x; ++ix) {
        if (storey.cells[std::size_t(iz) * maps.columns.x + ix].matter == PlanMatter::kNothing) continue;
        maps.used_from = glm::min(maps.used_from, glm::ivec2(ix, iz));
        maps.used_to = glm::max(maps.used_to, glm::ivec2(ix, iz) + 1);
      }
    }
  }
  maps.used_from = glm::min(maps.used_from, maps.used_to);
}

}  // namespace

StoreyMaps map_storeys(const Scene& scene, const Space& space) {
  StoreyMaps maps;
  if (space.floor.nodes.empty()) {
    maps.storeys.emplace_back().floor_m = space.start.position_m.y - kEyeHeight_m;
    maps.storeys[0].lowest_m = maps.storeys[0].highest_m = maps.storeys[0].floor_m;
    return maps;
  }
  const FloorMap& floor = space.floor;
  maps.origin_m = floor.origin_m;
  maps.cell_m = floor.cell_m;
  maps.columns = floor.columns;
  const ColumnSpans spans = build_column_spans(scene, floor.origin_m, floor.cell_m, floor.columns);
  const std::vector<double> levels = find_levels(floor);
  const std::vector<std::size_t> storey_of_level = group_levels(floor, levels);
  std::vector<std::size_t> area(levels.size(), 0);
  for (const FloorNode& node : floor.nodes) ++area[level_of(levels, node.floor_m)];
  std::vector<bool> under(std::size_t(floor.columns.x) * floor.columns.y, false);
  for (std::size_t s = 0; s <= storey_of_level.back(); ++s) {
    StoreyBuilder builder(floor, spans, under);
    for (const FloorNode& node : floor.nodes) {
      if (storey_of_level[level_of(levels, node.floor_m)] == s) builder.add(node);
    }
    StoreyMap& storey = maps.storeys.emplace_back();
    storey.cells = builder.build();
    for (std::size_t c = 0; c < storey.cells.size(); ++c) {
      under[c] = under[c] || storey.cells[c].matter == PlanMatter::kFloor || storey.cells[c].matter == PlanMatter::kFurniture;
    }
    storey.lowest_m = HUGE_VAL;
    storey.highest_m = -HUGE_VAL;
    std::size_t most = 0;
    for (std::size_t level = 0; level < levels.size(); ++level) {
      if (storey_of_level[level] != s) continue;
      storey.lowest_m = std::min(storey.lowest_m, levels[level]);
      storey.highest_m = std::max(storey.highest_m, levels[level]);
      if (area[level] > most) storey.floor_m = levels[level];
      most = std::max(most, area[level]);
    }
  }
  find_used(maps);
  return maps;
}

std::size_t StoreyMaps::storey_of(glm::dvec3 point_m) const {
  constexpr double kOver_m = 0.2;
  const glm::dvec2 cell = glm::floor((glm::dvec2(point_m.x, point_m.z) - origin_m) / cell_m);
  std::size_t found = storeys.size();
  if (cell.x >= 0.0 && cell.y >= 0.0 && cell.x < columns.x && cell.y < columns.y) {
    for (std::size_t s = 0; s < storeys.size(); ++s) {
      const PlanCell& at_cell = at(s, int(cell.x), int(cell.y));
      if (at_cell.matter > PlanMatter::kVoid && at_cell.floor_m <= point_m.y - kOver_m) found = s;
    }
  }
  if (found < storeys.size()) return found;
  found = 0;
  for (std::size_t s = 1; s < storeys.size(); ++s) found = storeys[s].lowest_m <= point_m.y - kOver_m ? s : found;
  return found;
}

}  // namespace probewalk
