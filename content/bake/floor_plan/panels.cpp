#include "content/bake/floor_plan/panels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "content/scene/space/floor_graph.h"

namespace probewalk {
namespace {

constexpr double kFinest_px_m = 64.0;
constexpr double kMostPixels = 7.5e6;   // of all panels
constexpr double kLongest_px = 6000.0;  // of all panels side by side
constexpr int kLeastWidth_px = 720;     // the legend needs it
constexpr double kMargin_m = 0.4;
constexpr double kFarthest_m = 1e7;  // from the origin: what is farther is not on the plan
constexpr double kStep_least_m = 0.08;  // what is lower is a threshold
constexpr int kHatch_px = 9;            // between the lines over a void
constexpr double kWallBetween_m = 0.6;  // rooms nearer than this to each other meet

// Light, so that lines and letters read on them, and as far from each other as that allows.
constexpr std::array<Colour, 12> kRooms{{{250, 206, 176}, {178, 212, 240}, {184, 226, 178}, {250, 236, 156},
                                         {216, 194, 238}, {244, 186, 202}, {160, 224, 220}, {226, 208, 176},
                                         {212, 234, 146}, {186, 192, 236}, {255, 216, 128}, {190, 210, 204}}};

}  // namespace

Panels lay_out_panels(const StoreyMaps& maps, const Space& space, const Placement& placement) {
  Panels panels;
  glm::dvec2 lower(HUGE_VAL), upper(-HUGE_VAL);
  const auto include = [&](glm::dvec2 p) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return;
    p = glm::clamp(p, -kFarthest_m, kFarthest_m);
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  };
  if (maps.used_to.x > maps.used_from.x) {
    include(maps.origin_m + maps.cell_m * glm::dvec2(maps.used_from));
    include(maps.origin_m + maps.cell_m * glm::dvec2(maps.used_to));
  }
  for (const ProbeSite& site : placement.sites) include({site.position_m.x, site.position_m.z});
  include({space.start.position_m.x, space.start.position_m.z});
  if (lower.x > upper.x) lower = upper = glm::dvec2(0.0);
  lower -= std::max(kMargin_m, maps.cell_m);
  upper += std::max(kMargin_m, maps.cell_m);

  // As many columns of panels as make them largest.
  const glm::dvec2 size_m = upper - lower;
  const double storeys = double(maps.storeys.size());
  double best_px_m = 0.0;
  int columns = 1;
  for (int c = 1; c <= int(maps.storeys.size()); ++c) {
    const double rows = std::ceil(storeys / c);
    const glm::dvec2 all_m = size_m * glm::dvec2(c, rows);
    double px_m = std::min({kFinest_px_m, kLongest_px / all_m.x, kLongest_px / all_m.y,
                            std::sqrt(kMostPixels / (all_m.x * all_m.y))});
    // Among equals the one nearest to a page's shape.
    const double shape = std::abs(std::log(all_m.x / all_m.y / 1.4));
    px_m *= 1.0 - 0.02 * std::min(shape, 10.0);
    if (px_m > best_px_m) {
      best_px_m = px_m;
      columns = c;
    }
  }
  const double rows = std::ceil(storeys / columns);
  const glm::dvec2 all_m = size_m * glm::dvec2(columns, rows);
  panels.px_per_m = std::min({kFinest_px_m, kLongest_px / all_m.x, kLongest_px / all_m.y,
                              std::sqrt(kMostPixels / (all_m.x * all_m.y))});
  // Cells of whole pixels make even edges.
  const double px_cell = panels.px_per_m * maps.cell_m;
  if (px_cell >= 2.0) panels.px_per_m = std::floor(px_cell) / maps.cell_m;
  const glm::ivec2 panel_px = glm::max(glm::ivec2(glm::ceil(size_m * panels.px_per_m)), glm::ivec2(1));
  // The corner lies on a cell's, for the same reason.
  panels.lower_m = maps.origin_m + maps.cell_m * glm::floor((lower - maps.origin_m) / maps.cell_m);
  const glm::ivec2 pitch = panel_px + glm::ivec2(kSheetMargin_px, kSheetMargin_px + kPanelTitle_px);
  for (int s = 0; s < int(maps.storeys.size()); ++s) {
    const glm::ivec2 corner =
        glm::ivec2(kSheetMargin_px, kSheetMargin_px + 2 * kPanelTitle_px) + pitch * glm::ivec2(s % columns, s / columns);
    panels.boxes.push_back({corner, corner + panel_px});
  }
  panels.size_px = glm::ivec2(kSheetMargin_px, kSheetMargin_px + kPanelTitle_px) + pitch * glm::ivec2(columns, int(rows));
  panels.size_px.x = std::max(panels.size_px.x, kLeastWidth_px);
  return panels;
}

std::vector<Colour> choose_room_colours(const StoreyMaps& maps, std::size_t rooms) {
  std::vector<std::set<std::size_t>> beside(rooms);
  const int far = std::max(1, int(kWallBetween_m / maps.cell_m));
  for (const StoreyMap& storey : maps.storeys) {
    if (storey.cells.empty()) continue;
    const auto look_along = [&](std::size_t first, std::size_t step, int length) {
      std::size_t last = rooms;
      int last_at = 0;
      for (int k = 0; k < length; ++k) {
        const PlanCell& cell = storey.cells[first + std::size_t(k) * step];
        if (cell.matter != PlanMatter::kFloor && cell.matter != PlanMatter::kFurniture) continue;
        if (last < rooms && last != cell.room && k - last_at <= far) {
          beside[last].insert(cell.room);
          beside[cell.room].insert(last);
        }
        last = cell.room;
        last_at = k;
      }
    };
    const std::size_t width = std::size_t(maps.columns.x);
    for (int iz = 0; iz < maps.columns.y; ++iz) look_along(std::size_t(iz) * width, 1, maps.columns.x);
    for (int ix = 0; ix < maps.columns.x; ++ix) look_along(std::size_t(ix), width, maps.columns.y);
  }
  std::vector<std::size_t> number(rooms, kRooms.size());
  std::array<std::size_t, kRooms.size()> used{};
  std::vector<Colour> colours;
  for (std::size_t room = 0; room < rooms; ++room) {
    std::array<std::size_t, kRooms.size()> cost = used;
    for (const std::size_t other : beside[room]) {
      if (number[other] < kRooms.size()) cost[number[other]] += rooms + 1;
    }
    number[room] = std::size_t(std::min_element(cost.begin(), cost.end()) - cost.begin());
    ++used[number[room]];
    colours.push_back(kRooms[number[room]]);
  }
  return colours;
}

namespace {

class MatterPainter {
 public:
  MatterPainter(const StoreyMaps& maps, std::size_t storey, const std::vector<Colour>& colours)
      : maps_(maps), storey_(storey), colours_(colours) {}

  // The most solid of a rectangle of cells; `to` excluded.
  const PlanCell* top(glm::ivec2 from, glm::ivec2 to) {
    const PlanCell* best = nullptr;
    for (int iz = std::max(0, from.y); iz < std::min(to.y, maps_.columns.y); ++iz) {
      for (int ix = std::max(0, from.x); ix < std::min(to.x, maps_.columns.x); ++ix) {
        const PlanCell& cell = maps_.at(storey_, ix, iz);
        if (!best || cell.matter > best->matter) {
          best = &cell;
          at_ = {ix, iz};
        }
      }
    }
    return best;
  }

  Colour colour(const PlanCell& cell) const {
    using namespace plan_colour;
    switch (cell.matter) {
      case PlanMatter::kNothing: return kPaper;
      case PlanMatter::kVoid: return kPaper;
      case PlanMatter::kFloor: return is_step(cell) ? mixed(colours_[cell.room], kInk, 0.3) : colours_[cell.room];
      case PlanMatter::kFurniture: return mixed(colours_[cell.room], kCupboard, is_edge(false) ? 0.9 : 0.45);
      case PlanMatter::kCupboard: return kCupboard;
      case PlanMatter::kWindow: return is_edge(true) ? kPaneEdge : kPane;
      case PlanMatter::kWall: return kWall;
    }
    return kPaper;
  }

 private:
  // Whether the floor rises or falls beside the cell found last, as at the edge of a step.
  bool is_step(const PlanCell& cell) const {
    const double least_m = std::max(kStep_least_m, 0.9 * maps_.cell_m);
    for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(0, 1)}) {
      const glm::ivec2 p = at_ + step;
      if (p.x >= maps_.columns.x || p.y >= maps_.columns.y) continue;
      const PlanCell& beside = maps_.at(storey_, p.x, p.y);
      const double rise_m = std::abs(double(beside.floor_m) - cell.floor_m);
      if (beside.matter == PlanMatter::kFloor && rise_m > least_m && rise_m < kStep_m + 0.01) return true;
    }
    return false;
  }

  // Whether the cell found last lies beside floor, or nothing; a window's beside its walls is none.
  bool is_edge(bool window) const {
    for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)}) {
      const glm::ivec2 p = at_ + step;
      if (p.x < 0 || p.y < 0 || p.x >= maps_.columns.x || p.y >= maps_.columns.y) return true;
      const PlanMatter beside = maps_.at(storey_, p.x, p.y).matter;
      if (beside <= PlanMatter::kFloor || (window && beside == PlanMatter::kFurniture)) return true;
    }
    return false;
  }

  const StoreyMaps& maps_;
  std::size_t storey_;
  const std::vector<Colour>& colours_;
  glm::ivec2 at_{0};
};

}  // namespace

void draw_matter(const StoreyMaps& maps, const Panels& panels, const std::vector<Colour>& colours, Canvas& canvas,
                 LabelPlaces& places) {
  for (std::size_t s = 0; s < maps.storeys.size(); ++s) {
    if (maps.storeys[s].cells.empty()) continue;
    MatterPainter painter(maps, s, colours);
    const PixelBox& box = panels.boxes[s];
    const auto cell_at = [&](int px, int axis) {
      const double at_m = panels.lower_m[axis] + px / panels.px_per_m - maps.origin_m[axis];
      return int(std::clamp(std::floor(at_m / maps.cell_m + 1e-6), -1.0, double(maps.columns[axis])));
    };
    for (int y = box.lower.y; y < box.upper.y; ++y) {
      const int z0 = cell_at(y - box.lower.y, 1), z1 = std::max(z0 + 1, cell_at(y + 1 - box.lower.y, 1));
      for (int x = box.lower.x; x < box.upper.x; ++x) {
        const int x0 = cell_at(x - box.lower.x, 0), x1 = std::max(x0 + 1, cell_at(x + 1 - box.lower.x, 0));
        const PlanCell* cell = painter.top({x0, z0}, {x1, z1});
        if (!cell || cell->matter == PlanMatter::kNothing) continue;
        if (cell->matter == PlanMatter::kVoid) {
          if ((x + y) % kHatch_px == 0) canvas.set({x, y}, plan_colour::kFaint);
          continue;
        }
        canvas.set({x, y}, painter.colour(*cell));
        if (cell->matter == PlanMatter::kWall) places.note({{x, y}, {x + 1, y + 1}}, LabelPlaces::kDark);
      }
    }
  }
}

}  // namespace probewalk
