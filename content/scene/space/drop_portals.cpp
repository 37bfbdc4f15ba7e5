#include "content/scene/space/drop_portals.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "content/scene/space/portal_runs.h"

namespace probewalk {
namespace {

constexpr float kEye_m = 1.5f, kCrown_m = 1.8f;  // what is free between, heads look through
constexpr double kOpen_m = 0.3;                  // a narrower gap along an edge is a crack
constexpr double kFar_m = 1.0;                   // out from the edge: how far the room below may begin
constexpr float kDeepest_m = 30.0f;              // a fall from higher is out of all rooms

// Air of one column.
struct Gap {
  float lower_m, upper_m;
};

class DropSearch {
 public:
  DropSearch(const HeadMap& heads, const ColumnSpans& spans, const std::vector<std::int32_t>& room)
      : graph_(heads.graph), spans_(spans), room_(room), first_(std::size_t(graph_.columns.x) * graph_.columns.y + 1, 0) {
    for (const StandingPlace& p : graph_.places) ++first_[column(p.ix, p.iz) + 1];
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  }

  std::vector<Portal> run() const {
    std::map<std::pair<int, int>, std::vector<BorderSide>> edges;  // upper room, lower room
    for (std::size_t i = 0; i < graph_.places.size(); ++i) {
      if (room_[i] < 0) continue;
      const StandingPlace& edge = graph_.places[i];
      for (int k = 0; k < 4; ++k) {
        if (edge.link[k] >= 0) continue;
        const std::optional<Below> below = look_down(edge, k);
        if (!below || below->room == room_[i]) continue;
        edges[{room_[i], below->room}].push_back(
            {{2 * edge.ix + kLinkX[k], 2 * edge.iz + kLinkZ[k]}, edge.floor_m, std::min(edge.ceiling_m, below->ceiling_m), false});
      }
    }
    std::vector<Portal> drops;
    for (const auto& [pair, sides] : edges) {
      for (const std::vector<BorderSide>& opening : gather_runs(sides)) {
        for (const std::vector<BorderSide>& piece : straight_pieces(graph_, opening)) {
          std::vector<glm::dvec3> polygon = upright_rectangle(graph_, piece);
          if (!polygon.empty()) drops.push_back({pair.first, pair.second, std::move(polygon), false});
        }
      }
    }
    return drops;
  }

 private:
  struct Below {
    std::int32_t room;
    float ceiling_m;
  };

  std::size_t column(int ix, int iz) const { return std::size_t(iz) * graph_.columns.x + ix; }

  // That in which the eyes of somebody on this floor would be, where nothing stands in front of them.
  std::optional<Gap> gap_at(int ix, int iz, float floor_m) const {
    if (!spans_.holds(ix, iz)) return std::nullopt;
    Gap gap{-HUGE_VALF, floor_m + 1000.0f};
    for (const SolidSpan& span : spans_.column(ix, iz)) {
      if (span.lower_m >= floor_m + kCrown_m) {
        gap.upper_m = span.lower_m;
        break;
      }
      if (span.upper_m > floor_m + kEye_m) return std::nullopt;
      gap.lower_m = span.upper_m;
    }
    return gap;
  }

  // The room whose air begins beyond the edge: out to there every column is open down past the floor by more than a step.
  std::optional<Below> look_down(const StandingPlace& edge, int k) const {
    const int open = std::max(1, int(std::lround(kOpen_m / graph_.cell_m)));
    const int far = std::max(open, int(kFar_m / graph_.cell_m));
    std::optional<Below> found;
    for (int step = 1; step <= far && (!found || step <= open); ++step) {
      const int ix = edge.ix + step * kLinkX[k], iz = edge.iz + step * kLinkZ[k];
      const std::optional<Gap> gap = gap_at(ix, iz, edge.floor_m);
      if (!gap || gap->lower_m > edge.floor_m - float(kStep_m)) return std::nullopt;
      if (!found) found = room_in(ix, iz, edge.floor_m, *gap);
    }
    return found;
  }

  // Of a place in the column whose air is this gap: the highest, should there be more.
  std::optional<Below> room_in(int ix, int iz, float edge_m, Gap gap) const {
    std::optional<Below> found;
    const std::size_t c = column(ix, iz);
    for (std::uint32_t j = first_[c]; j < first_[c + 1]; ++j) {
      const StandingPlace& place = graph_.places[j];
      const bool below = place.floor_m < edge_m - float(kStep_m) && place.floor_m > edge_m - kDeepest_m;
      if (room_[j] >= 0 && below && place.ceiling_m > edge_m + kEye_m) found = Below{room_[j], gap.upper_m};
    }
    return found;
  }

  const FloorGraph& graph_;
  const ColumnSpans& spans_;
  const std::vector<std::int32_t>& room_;
  std::vector<std::uint32_t> first_;  // place of each column, and the end
};

}  // namespace

std::vector<Portal> find_drops(const HeadMap& heads, const ColumnSpans& spans, const std::vector<std::int32_t>& room) {
  return DropSearch(heads, spans, room).run();
}

}  // namespace probewalk
