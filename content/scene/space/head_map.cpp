#include "content/scene/space/head_map.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace probewalk {
namespace {

constexpr float kShoulder_m = 1.4f;  // what is lower parts no room
constexpr float kCrown_m = 1.8f;
constexpr float kOneFloor_m = 1.0f;  // places of one column nearer to each other than this are the same
constexpr float kHeadStep_m = 0.5f;

class HeadMapBuilder {
 public:
  HeadMapBuilder(const FloorGraph& floor, const ColumnSpans& spans, const std::vector<bool>& other)
      : floor_(floor),
        spans_(spans),
        first_(columns(), -1),
        first_other_(columns(), -1),
        next_other_(floor.places.size(), -1) {
    for (std::size_t i = 0; i < floor.places.size(); ++i) {
      if (!other[i]) continue;
      std::int32_t& first = first_other_[column(floor.places[i].ix, floor.places[i].iz)];
      next_other_[i] = first;
      first = std::int32_t(i);
    }
  }

  HeadMap build(const std::vector<bool>& kept) {
    for (std::size_t i = 0; i < floor_.places.size(); ++i) {
      if (kept[i])
        add({floor_.places[i].ix, floor_.places[i].iz, floor_.places[i].floor_m, floor_.places[i].ceiling_m},
            std::int32_t(i));
    }
    const int rings = int(kFurnitureDepth_m / floor_.cell_m);
    std::size_t begin = 0;
    for (int ring = 0; ring < rings; ++ring) {
      const std::size_t end = places_.size();
      for (; begin < end; ++begin) lean_out(begin);
    }
    return sorted();
  }

 private:
  std::size_t columns() const { return std::size_t(floor_.columns.x) * floor_.columns.y; }
  std::size_t column(int ix, int iz) const { return std::size_t(iz) * floor_.columns.x + ix; }

  void add(StandingPlace place, std::int32_t floor_place) {
    std::int32_t& first = first_[column(place.ix, place.iz)];
    next_.push_back(first);
    first = std::int32_t(places_.size());
    places_.push_back(place);
    floor_place_.push_back(floor_place);
  }

  void lean_out(std::size_t from) {
    for (int k = 0; k < 4; ++k) {
      StandingPlace place{places_[from].ix + kLinkX[k], places_[from].iz + kLinkZ[k], places_[from].floor_m, 0.0f};
      if (place.ix < 0 || place.iz < 0 || place.ix >= floor_.columns.x || place.iz >= floor_.columns.y) continue;
      if (is_taken(place) || !is_over_furniture(place)) continue;
      add(place, -1);
    }
  }

  bool is_taken(const StandingPlace& place) const {
    for (std::int32_t j = first_[column(place.ix, place.iz)]; j >= 0; j = next_[j]) {
      if (std::abs(places_[j].floor_m - place.floor_m) < kOneFloor_m) return true;
    }
    for (std::int32_t j = first_other_[column(place.ix, place.iz)]; j >= 0; j = next_other_[j]) {
      if (std::abs(floor_.places[j].floor_m - place.floor_m) <= float(kStep_m)) return true;
    }
    return false;
  }

  // Sets the ceiling.
  bool is_over_furniture(StandingPlace& place) const {
    bool stands = false;
    place.ceiling_m = place.floor_m + 1000.0f;
    for (const SolidSpan& span : spans_.column(place.ix, place.iz)) {
      if (span.upper_m > place.floor_m + kShoulder_m && span.lower_m < place.floor_m + kCrown_m) return false;
      stands |= span.upper_m > place.floor_m - float(kStep_m) && span.lower_m < place.floor_m + kShoulder_m;
      if (span.lower_m >= place.floor_m + kCrown_m) {
        place.ceiling_m = span.lower_m;
        break;
      }
    }
    return stands;
  }

  HeadMap sorted() {
    std::vector<std::int32_t> order(places_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = std::int32_t(i);
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
      return std::tuple(places_[a].iz, places_[a].ix, places_[a].floor_m, a) <
             std::tuple(places_[b].iz, places_[b].ix, places_[b].floor_m, b);
    });
    HeadMap map;
    map.graph.origin_m = floor_.origin_m;
    map.graph.cell_m = floor_.cell_m;
    map.graph.columns = floor_.columns;
    for (const std::int32_t i : order) {
      map.graph.places.push_back(places_[i]);
      map.floor_place.push_back(floor_place_[i]);
    }
    link_places(map.graph, {kHeadStep_m, 0.0f});
    measure_walls(map.graph);
    return map;
  }

  const FloorGraph& floor_;
  const ColumnSpans& spans_;
  // Lists by column, as indices of the first and the next.
  std::vector<std::int32_t> first_, next_, first_other_, next_other_;
  std::vector<StandingPlace> places_;
  std::vector<std::int32_t> floor_place_;
};

}  // namespace

HeadMap build_head_map(const FloorGraph& floor, const ColumnSpans& spans, const std::vector<bool>& kept,
                       const std::vector<bool>& other) {
  return HeadMapBuilder(floor, spans, other).build(kept);
}

}  // namespace probewalk
