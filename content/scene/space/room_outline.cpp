#include "content/scene/space/room_outline.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <utility>

#include "content/scene/space/rooms_assignment.h"

namespace probewalk {
namespace {

// Of the plans of all rooms together. Rooms beyond that stay boxes: a pack may say anything of its floor.
constexpr std::size_t kMostPlanColumns = std::size_t{1} << 28;
constexpr double kFurniture_m = 1.25;  // without floor, but in the room that is nearest to it
constexpr double kTolerances_cells[]{2.0, 1.0, 0.7, 0.0};

double distance_to_line_m(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) {
  const glm::dvec2 along = b - a;
  const double square = glm::dot(along, along);
  const double at = square > 0.0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + at * along);
}

// Which columns of the floor belong to one room, those under its furniture included.
class RoomPlan {
 public:
  RoomPlan(const FloorMap& floor, std::size_t room, const Bounds& bounds, std::size_t most_columns) : floor_(floor) {
    low_ = {INT32_MAX, INT32_MAX};
    high_ = {INT32_MIN, INT32_MIN};
    for (const FloorNode& node : floor.nodes) {
      if (node.room != room) continue;
      low_ = glm::min(low_, glm::ivec2(node.ix, node.iz));
      high_ = glm::max(high_, glm::ivec2(node.ix, node.iz));
    }
    if (low_.x > high_.x) return;
    const glm::dvec2 lower(bounds.lower_m.x, bounds.lower_m.z), upper(bounds.upper_m.x, bounds.upper_m.z);
    low_ = glm::min(low_, column(lower + 0.51 * floor.cell_m));
    high_ = glm::max(high_, column(upper - 0.51 * floor.cell_m));
    size_ = high_ - low_ + 1;
    if (std::size_t(size_.x) * std::size_t(size_.y) > most_columns) return;
    owner_.assign(std::size_t(size_.x) * size_.y, kNobody);
    std::vector<glm::ivec2> front;
    for (const FloorNode& node : floor.nodes) {
      const glm::ivec2 cell(node.ix, node.iz);
      if (!holds(cell)) continue;
      // Floors above and below are other storeys.
      if (node.room != room && (node.floor_m < bounds.lower_m.y - 0.5 || node.floor_m > bounds.upper_m.y)) continue;
      if (at(cell) == kNobody) front.push_back(cell);
      if (at(cell) != kOwn) at(cell) = node.room == room ? kOwn : kForeign;
    }
    for (int ring = int(kFurniture_m / floor.cell_m); ring > 0 && !front.empty(); --ring) {
      std::vector<glm::ivec2> next;
      for (const glm::ivec2& cell : front) {
        for (const glm::ivec2 step : {glm::ivec2(1, 0), {0, 1}, {-1, 0}, {0, -1}}) {
          if (!holds(cell + step) || at(cell + step) != kNobody) continue;
          at(cell + step) = at(cell);
          next.push_back(cell + step);
        }
      }
      front = std::move(next);
    }
    fill_holes();
  }

  bool empty() const { return owner_.empty(); }
  std::size_t columns() const { return owner_.size(); }
  // Corners of columns along the border, the room to the left.
  std::vector<std::vector<glm::ivec2>> loops() const {
    std::multimap<std::pair<int, int>, glm::ivec2> next;  // by (z, x)
    for_each([&](glm::ivec2 c) {
      if (!own(c + glm::ivec2(0, -1))) next.emplace(std::pair(c.y, c.x), c + glm::ivec2(1, 0));
      if (!own(c + glm::ivec2(1, 0))) next.emplace(std::pair(c.y, c.x + 1), c + glm::ivec2(1, 1));
      if (!own(c + glm::ivec2(0, 1))) next.emplace(std::pair(c.y + 1, c.x + 1), c + glm::ivec2(0, 1));
      if (!own(c + glm::ivec2(-1, 0))) next.emplace(std::pair(c.y + 1, c.x), c);
    });
    std::vector<std::vector<glm::ivec2>> loops;
    while (!next.empty()) {
      std::vector<glm::ivec2> loop{{next.begin()->first.second, next.begin()->first.first}};
      glm::ivec2 before(0);
      for (;;) {
        const glm::ivec2 corner = loop.back();
        auto [found, end] = next.equal_range({corner.y, corner.x});
        // Where two columns touch at a corner the line turns left: it stays round one of them.
        if (std::next(found) != end) {
          const glm::ivec2 way = found->second - corner;
          const int turn = before.x * way.y - before.y * way.x;
          if (turn < 0) ++found;
        }
        const glm::ivec2 to = found->second;
        next.erase(found);
        before = to - corner;
        if (to == loop.front()) break;
        loop.push_back(to);
      }
      loops.push_back(std::move(loop));
    }
    return loops;
  }

 private:
  enum : std::uint8_t { kNobody, kOwn, kForeign };

  glm::ivec2 column(glm::dvec2 p) const {
    constexpr double kFar = 1 << 28;
    return glm::ivec2(glm::clamp(glm::floor((p - floor_.origin_m) / floor_.cell_m), -kFar, kFar));
  }
  bool holds(glm::ivec2 c) const { return c.x >= low_.x && c.y >= low_.y && c.x <= high_.x && c.y <= high_.y; }
  std::uint8_t& at(glm::ivec2 c) { return owner_[std::size_t(c.y - low_.y) * size_.x + (c.x - low_.x)]; }
  bool own(glm::ivec2 c) const {
    return holds(c) && owner_[std::size_t(c.y - low_.y) * size_.x + (c.x - low_.x)] == kOwn;
  }
  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (int z = low_.y; z <= high_.y; ++z) {
      for (int x = low_.x; x <= high_.x; ++x) {
        if (own({x, z})) visit(glm::ivec2(x, z));
      }
    }
  }

  // What nobody stands on, and the room surrounds, is its own.
  void fill_holes() {
    std::vector<bool> seen(owner_.size(), false);
    for (int z = low_.y; z <= high_.y; ++z) {
      for (int x = low_.x; x <= high_.x; ++x) {
        std::vector<glm::ivec2> hole{{x, z}};
        if (at({x, z}) != kNobody || seen[std::size_t(&at({x, z}) - owner_.data())]) continue;
        seen[std::size_t(&at({x, z}) - owner_.data())] = true;
        bool inside = true;
        for (std::size_t k = 0; k < hole.size(); ++k) {
          for (const glm::ivec2 step : {glm::ivec2(1, 0), {0, 1}, {-1, 0}, {0, -1}}) {
            const glm::ivec2 cell = hole[k] + step;
            inside = inside && holds(cell) && at(cell) != kForeign;
            if (!holds(cell) || at(cell) != kNobody || seen[std::size_t(&at(cell) - owner_.data())]) continue;
            seen[std::size_t(&at(cell) - owner_.data())] = true;
            hole.push_back(cell);
          }
        }
        if (!inside) continue;
        for (const glm::ivec2& cell : hole) at(cell) = kOwn;
      }
    }
  }

  const FloorMap& floor_;
  glm::ivec2 low_{0}, high_{-1}, size_{0};
  std::vector<std::uint8_t> owner_;
};

// Corners that a line within the tolerance needs (Douglas and Peucker 1973).
void keep_needed(const std::vector<glm::ivec2>& loop, std::size_t first, std::size_t last, double tolerance,
                 std::vector<bool>& kept) {
  double most = -1.0;
  std::size_t farthest = first;
  for (std::size_t k = first + 1; k < last; ++k) {
    const double away = distance_to_line_m(loop[first], loop[last % loop.size()], loop[k]);
    if (away > most) most = away, farthest = k;
  }
  if (most <= tolerance + 1e-9) return;
  kept[farthest] = true;
  keep_needed(loop, first, farthest, tolerance, kept);
  keep_needed(loop, farthest, last, tolerance, kept);
}

std::vector<glm::ivec2> simplified(std::vector<glm::ivec2> loop, double tolerance_cells) {
  // From a corner that stays: the least.
  std::rotate(loop.begin(),
              std::min_element(loop.begin(), loop.end(),
                               [](glm::ivec2 a, glm::ivec2 b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); }),
              loop.end());
  std::vector<bool> kept(loop.size(), false);
  kept[0] = true;
  std::size_t opposite = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const auto away = [&](std::size_t i) { return glm::distance(glm::dvec2(loop[i]), glm::dvec2(loop[0])); };
    if (away(k) > away(opposite)) opposite = k;
  }
  kept[opposite] = true;
  keep_needed(loop, 0, opposite, tolerance_cells, kept);
  keep_needed(loop, opposite, loop.size(), tolerance_cells, kept);
  std::vector<glm::ivec2> result;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    if (kept[k]) result.push_back(loop[k]);
  }
  return result;
}

// By room: how many pieces of floor it takes from others.
std::vector<std::size_t> taken(const FloorMap& floor, const std::vector<RoomRegion>& rooms) {
  std::vector<std::size_t> counts(rooms.size(), 0);
  for (const FloorNode& node : floor.nodes) {
    const glm::dvec2 at = floor.origin_m + (glm::dvec2(node.ix, node.iz) + 0.5) * floor.cell_m;
    const int room = room_at(rooms, {at.x, double(node.floor_m), at.y});
    if (room != int(node.room)) ++counts[std::size_t(room)];
  }
  return counts;
}

std::size_t sum(const std::vector<std::size_t>& counts) {
  std::size_t all = 0;
  for (const std::size_t count : counts) all += count;
  return all;
}

}  // namespace

bool outline_holds(const std::vector<PlanLoop>& outline, glm::dvec2 p) {
  bool inside = false;
  for (const PlanLoop& loop : outline) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const glm::dvec2 a = loop[k], b = loop[(k + 1) % loop.size()];
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
  }
  return inside;
}

double distance_to_outline_m(const std::vector<PlanLoop>& outline, glm::dvec2 point_m) {
  double least = HUGE_VAL;
  for (const PlanLoop& loop : outline) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      least = std::min(least, distance_to_line_m(loop[k], loop[(k + 1) % loop.size()], point_m));
    }
  }
  return least;
}

OutlinedRooms outline_rooms(const FloorMap& floor, const std::vector<RoomRegion>& rooms, double grid_m) {
  std::vector<RoomPlan> plans;
  std::vector<bool> drawn;
  std::size_t left = kMostPlanColumns;
  for (std::size_t k = 0; k < rooms.size(); ++k) {
    plans.emplace_back(floor, k, rooms[k].bounds, left);
    left -= plans.back().columns();
    drawn.push_back(false);
  }
  OutlinedRooms best;
  best.strayed = floor.nodes.size() + 1;
  for (const double tolerance : kTolerances_cells) {
    for (;;) {
      OutlinedRooms tried{rooms, 0};
      for (std::size_t k = 0; k < rooms.size(); ++k) {
        tried.rooms[k].outline.clear();
        if (!drawn[k]) continue;
        for (const std::vector<glm::ivec2>& loop : plans[k].loops()) {
          PlanLoop line;
          for (const glm::ivec2& corner : simplified(loop, tolerance)) {
            line.push_back(glm::round((floor.origin_m + glm::dvec2(corner) * floor.cell_m) / grid_m) * grid_m);
          }
          if (line.size() >= 3) tried.rooms[k].outline.push_back(std::move(line));
        }
      }
      const std::vector<std::size_t> counts = taken(floor, tried.rooms);
      tried.strayed = sum(counts);
      if (tried.strayed < best.strayed) best = std::move(tried);
      if (best.strayed == 0) return best;
      // Boxes that take what is not theirs are drawn, too.
      bool more = false;
      for (std::size_t k = 0; k < rooms.size(); ++k) {
        if (counts[k] == 0 || drawn[k] || plans[k].empty()) continue;
        drawn[k] = more = true;
      }
      if (!more) break;
    }
  }
  return best;
}

}  // namespace probewalk
