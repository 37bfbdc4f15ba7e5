#include "content/scene/space/portal_runs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "content/scene/space.h"

namespace probewalk {
namespace {

constexpr double kNarrowest_m = 0.4;
constexpr double kHighest_m = 4.0;
constexpr int kGap_cells = 2;   // pieces of border at most this far apart are one opening
constexpr double kGap_m = 1.0;  // and this far in height
constexpr double kAside_m = 0.8;      // beside what is walked: a plant at the jamb, or a rail
constexpr double kStraight_m = 0.3;  // sides this near to a line lie on it

std::size_t farthest_from(const std::vector<BorderSide>& sides, glm::ivec2 point) {
  std::size_t farthest = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const double distance = glm::length(glm::dvec2(sides[i].middle - point));
    if (distance > most) {
      most = distance;
      farthest = i;
    }
  }
  return farthest;
}

}  // namespace

// Sides are found by the column that they border on.
std::vector<std::vector<BorderSide>> gather_runs(const std::vector<BorderSide>& sides) {
  std::vector<std::size_t> parent(sides.size());
  std::iota(parent.begin(), parent.end(), std::size_t(0));
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::multimap<std::pair<int, int>, std::size_t> at;
  for (std::size_t i = 0; i < sides.size(); ++i) at.emplace(std::pair(sides[i].middle.y, sides[i].middle.x), i);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    for (int dz = 0; dz <= 2 * kGap_cells; ++dz) {
      const int z = sides[i].middle.y + dz;
      const auto begin = at.lower_bound({z, sides[i].middle.x - 2 * kGap_cells});
      const auto end = at.upper_bound({z, sides[i].middle.x + 2 * kGap_cells});
      for (auto j = begin; j != end; ++j) {
        if (std::abs(sides[j->second].floor_m - sides[i].floor_m) >= kGap_m) continue;
        const std::size_t a = root(i);
        const std::size_t b = root(j->second);
        parent[std::max(a, b)] = std::min(a, b);
      }
    }
  }
  std::map<std::size_t, std::vector<BorderSide>> clusters;
  for (std::size_t i = 0; i < sides.size(); ++i) clusters[root(i)].push_back(sides[i]);
  std::vector<std::vector<BorderSide>> out;
  for (auto& [first, members] : clusters) out.push_back(std::move(members));
  return out;
}

std::vector<std::vector<BorderSide>> straight_pieces(const FloorGraph& graph, const std::vector<BorderSide>& run) {
  const glm::dvec2 a(run[farthest_from(run, run.front().middle)].middle);
  const glm::dvec2 b(run[farthest_from(run, glm::ivec2(a))].middle);
  const double length = glm::distance(a, b);
  if (length == 0.0) return {run};
  const glm::dvec2 along = (b - a) / length;
  const auto off = [&](const BorderSide& side) {
    const glm::dvec2 from_a = glm::dvec2(side.middle) - a;
    return along.x * from_a.y - along.y * from_a.x;
  };
  double left = 0.0, right = 0.0, turn = 0.0;  // the last: how far along the farthest one is
  for (const BorderSide& side : run) {
    const double away = off(side);
    if (std::abs(away) > std::max(left, right)) turn = glm::dot(glm::dvec2(side.middle) - a, along);
    left = std::max(left, away);
    right = std::max(right, -away);
  }
  const double straight = 2.0 * kStraight_m / graph.cell_m;
  if (std::max(left, right) <= straight) return {run};
  const bool goes_around = std::min(left, right) > straight;
  std::vector<BorderSide> first, second;
  for (const BorderSide& side : run) {
    const bool is_first = goes_around ? off(side) > 0.0 : glm::dot(glm::dvec2(side.middle) - a, along) < turn;
    (is_first ? first : second).push_back(side);
  }
  if (first.empty() || second.empty()) return {run};
  std::vector<std::vector<BorderSide>> pieces;
  for (const std::vector<BorderSide>& half : {first, second}) {
    for (const std::vector<BorderSide>& part : gather_runs(half)) {
      for (std::vector<BorderSide>& piece : straight_pieces(graph, part)) pieces.push_back(std::move(piece));
    }
  }
  return pieces;
}

std::vector<std::vector<BorderSide>> parted_by_walking(const FloorGraph& graph, const std::vector<BorderSide>& piece) {
  const glm::ivec2 a = piece[farthest_from(piece, piece.front().middle)].middle;
  const glm::ivec2 b = piece[farthest_from(piece, a)].middle;
  std::vector<BorderSide> along = piece;
  const auto way = [&](const BorderSide& side) {
    return (side.middle.x - a.x) * (b.x - a.x) + (side.middle.y - a.y) * (b.y - a.y);
  };
  std::ranges::stable_sort(along, {}, way);
  std::vector<std::vector<BorderSide>> parts;
  for (const BorderSide& side : along) {
    if (parts.empty() || parts.back().front().walked != side.walked) parts.emplace_back();
    parts.back().push_back(side);
  }
  const auto is_short = [&](const std::vector<BorderSide>& part, double least_m) {
    return glm::distance(glm::dvec2(part.front().middle), glm::dvec2(part.back().middle)) * 0.5 * graph.cell_m + graph.cell_m <
           least_m;
  };
  // First what is too narrow for feet is not walked, then what is too short to be looked at alone is of its neighbour.
  for (const bool walked : {true, false}) {
    std::vector<std::vector<BorderSide>> joined;
    for (std::vector<BorderSide>& part : parts) {
      const bool alone = parts.size() == 1;
      const bool is_walked = part.front().walked;
      const bool turns = is_walked == walked && is_short(part, walked ? kNarrowest_m : kAside_m) && (walked || !alone);
      for (BorderSide& side : part) side.walked = turns ? !is_walked : is_walked;
      if (joined.empty() || joined.back().front().walked != part.front().walked) joined.emplace_back();
      joined.back().insert(joined.back().end(), part.begin(), part.end());
    }
    parts = std::move(joined);
  }
  return parts;
}

std::vector<glm::dvec3> upright_rectangle(const FloorGraph& graph, const std::vector<BorderSide>& run) {
  const BorderSide& a = run[farthest_from(run, run.front().middle)];
  const BorderSide& b = run[farthest_from(run, a.middle)];
  const auto plan_m = [&](const BorderSide& side) {
    return graph.origin_m + graph.cell_m * (0.5 * glm::dvec2(side.middle) + 0.5);
  };
  glm::dvec2 from = plan_m(a);
  glm::dvec2 to = plan_m(b);
  const double between_m = glm::distance(from, to);
  if (between_m + graph.cell_m < kNarrowest_m) return {};
  const glm::dvec2 half_side = 0.5 * graph.cell_m * (to - from) / between_m;
  from -= half_side;
  to += half_side;
  double floor_m = HUGE_VAL, ceiling_m = HUGE_VAL;
  for (const BorderSide& side : run) {
    floor_m = std::min(floor_m, side.floor_m);
    ceiling_m = std::min(ceiling_m, side.ceiling_m);
  }
  const double top_m = std::clamp(ceiling_m, floor_m + kHeadroom_m, floor_m + kHighest_m);
  return {{from.x, floor_m, from.y}, {to.x, floor_m, to.y}, {to.x, top_m, to.y}, {from.x, top_m, from.y}};
}

}  // namespace probewalk
