#include "content/scene/space/walk_paths.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "content/scene/space.h"

namespace probewalk {
namespace {

constexpr float kWallDread_m = 0.6f;    // a step costs 1 + this / (distance to the wall)
constexpr float kSqueezeFactor = 20.0f;  // where a body barely fits
constexpr float kCornerClearance_m = 0.45f;

float step_cost(float length_m, float wall_m) {
  const float squeeze = wall_m < float(kBodyRadius_m) ? kSqueezeFactor : 1.0f;
  return length_m * squeeze * (1.0f + kWallDread_m / std::max(0.1f, wall_m));
}

}  // namespace

WalkPaths::WalkPaths(const FloorGraph& graph, const std::vector<std::int32_t>& places)
    : graph_(graph), places_(places), local_(graph.places.size(), -1) {
  for (std::size_t i = 0; i < places.size(); ++i) local_[places[i]] = std::int32_t(i);
}

WalkTree WalkPaths::from(std::int32_t local_root, const SearchEnd& end) const {
  struct Front {
    float cost;
    std::int32_t local;
    bool operator>(const Front& other) const { return cost != other.cost ? cost > other.cost : local > other.local; }
  };
  WalkTree tree;
  tree.cost.assign(places_.size(), HUGE_VALF);
  tree.length_m.assign(places_.size(), HUGE_VALF);
  tree.previous.assign(places_.size(), -1);
  std::priority_queue<Front, std::vector<Front>, std::greater<>> queue;
  tree.cost[local_root] = tree.length_m[local_root] = 0.0f;
  queue.push({0.0f, local_root});
  std::size_t goals_reached = 0;
  const float straight_m = float(graph_.cell_m);
  const float diagonal_m = straight_m * std::sqrt(2.0f);
  while (!queue.empty()) {
    const Front front = queue.top();
    queue.pop();
    if (front.cost > tree.cost[front.local]) continue;
    if (end.goals && (*end.goals)[front.local] && ++goals_reached >= end.goal_count) break;
    if (end.within_m && tree.length_m[front.local] >= (*end.within_m)[front.local]) continue;
    const std::int32_t place = places_[front.local];
    for (int k = 0; k < 8; ++k) {
      const std::int32_t next = k < 4 ? graph_.places[place].link[k] : graph_.diagonal(place, k - 4);
      if (next < 0 || local_[next] < 0) continue;
      const float length = k < 4 ? straight_m : diagonal_m;
      const float cost = front.cost + step_cost(length, graph_.places[next].wall_m);
      const std::int32_t j = local_[next];
      if (cost >= tree.cost[j]) continue;
      tree.cost[j] = cost;
      tree.length_m[j] = tree.length_m[front.local] + length;
      tree.previous[j] = front.local;
      queue.push({cost, j});
    }
  }
  return tree;
}

std::vector<std::int32_t> straight_walk(const FloorGraph& graph, std::int32_t from, std::int32_t to,
                                        float clearance_m) {
  const StandingPlace& a = graph.places[from];
  const StandingPlace& b = graph.places[to];
  const int nx = std::abs(b.ix - a.ix);
  const int nz = std::abs(b.iz - a.iz);
  const int kx = b.ix > a.ix ? 0 : 2;  // links towards the goal
  const int kz = b.iz > a.iz ? 1 : 3;
  std::vector<std::int32_t> walk{from};
  // The line leaves column number cx through its side at (2 cx + 1) / (2 nx) of the way; compared without division.
  for (int cx = 0, cz = 0; cx < nx || cz < nz;) {
    const bool along_x = cz == nz || (cx < nx && std::int64_t(2 * cx + 1) * nz <= std::int64_t(2 * cz + 1) * nx);
    const std::int32_t next = graph.places[walk.back()].link[along_x ? kx : kz];
    if (next < 0 || graph.places[next].wall_m < clearance_m) return {};
    walk.push_back(next);
    ++(along_x ? cx : cz);
  }
  if (walk.back() != to) return {};
  return walk;
}

std::vector<std::int32_t> straightened(const FloorGraph& graph, const std::vector<std::int32_t>& way) {
  if (way.size() < 3) return way;
  constexpr std::size_t kLongestReach = 600;  // places; bounds the work on very long ways
  std::vector<std::int32_t> corners{way.front()};
  std::size_t at = 0;
  while (at + 1 < way.size()) {
    const std::size_t end = std::min(way.size() - 1, at + kLongestReach);
    std::vector<float> clearance(end - at + 1, kCornerClearance_m);  // least on the way from `at` to each place
    for (std::size_t j = at + 1; j <= end; ++j) {
      clearance[j - at] = std::min(clearance[j - at - 1], graph.places[way[j]].wall_m);
    }
    std::size_t reach = at + 1;
    for (std::size_t j = end; j > at + 1; --j) {
      if (straight_walk(graph, way[at], way[j], clearance[j - at]).empty()) continue;
      reach = j;
      break;
    }
    corners.push_back(way[reach]);
    at = reach;
  }
  return corners;
}

}  // namespace probewalk
