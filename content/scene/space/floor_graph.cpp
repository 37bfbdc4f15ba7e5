#include "content/scene/space/floor_graph.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "content/scene/space.h"

namespace probewalk {
namespace {

constexpr float kOpenSky_m = 1000.0f;

}  // namespace

void link_places(FloorGraph& graph, const LinkRule& rule) {
  std::vector<StandingPlace>& places = graph.places;
  // Places are sorted: those of a column follow each other.
  std::vector<std::int32_t> first(std::size_t(graph.columns.x) * graph.columns.y + 1, 0);
  for (const StandingPlace& p : places) ++first[std::size_t(p.iz) * graph.columns.x + p.ix + 1];
  for (std::size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
  for (StandingPlace& a : places) {
    for (int k = 0; k < 4; ++k) {
      const int x = a.ix + kLinkX[k];
      const int z = a.iz + kLinkZ[k];
      if (x < 0 || z < 0 || x >= graph.columns.x || z >= graph.columns.y) continue;
      const std::size_t column = std::size_t(z) * graph.columns.x + x;
      float nearest = rule.step_m;
      for (std::int32_t j = first[column]; j < first[column + 1]; ++j) {
        const StandingPlace& b = places[j];
        const float rise = std::abs(b.floor_m - a.floor_m);
        const float common = std::min(a.ceiling_m, b.ceiling_m) - std::max(a.floor_m, b.floor_m);
        if (rise > nearest || (rise == nearest && a.link[k] >= 0) || common < rule.headroom_m) continue;
        nearest = rise;
        a.link[k] = j;
      }
    }
  }
  // Two floors may both take a third as their nearest: only mutual choices are links.
  std::vector<std::array<bool, 4>> mutual(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (int k = 0; k < 4; ++k) {
      const std::int32_t j = places[i].link[k];
      mutual[i][k] = j >= 0 && places[j].link[(k + 2) % 4] == std::int32_t(i);
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (int k = 0; k < 4; ++k) {
      if (!mutual[i][k]) places[i].link[k] = -1;
    }
  }
}

// Brushfire from every missing link that carries the point it started from, so that distances are Euclidean.
void measure_walls(FloorGraph& graph) {
  constexpr double kFar_m = 50.0;
  struct Front {
    double distance2;
    std::int32_t place;
    bool operator>(const Front& other) const {
      return distance2 != other.distance2 ? distance2 > other.distance2 : place > other.place;
    }
  };
  std::vector<StandingPlace>& places = graph.places;
  std::vector<double> distance2(places.size(), HUGE_VAL);  // in cells
  std::vector<glm::ivec2> source(places.size());           // in half cells
  std::vector<bool> settled(places.size(), false);
  std::priority_queue<Front, std::vector<Front>, std::greater<>> queue;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (int k = 0; k < 4 && distance2[i] > 0.25; ++k) {
      if (places[i].link[k] >= 0) continue;
      distance2[i] = 0.25;
      source[i] = {2 * places[i].ix + kLinkX[k], 2 * places[i].iz + kLinkZ[k]};
      queue.push({0.25, std::int32_t(i)});
    }
  }
  while (!queue.empty()) {
    const std::int32_t i = queue.top().place;
    queue.pop();
    if (settled[i]) continue;
    settled[i] = true;
    for (const std::int32_t j : places[i].link) {
      if (j < 0 || settled[j]) continue;
      const double dx = places[j].ix - 0.5 * source[i].x;
      const double dz = places[j].iz - 0.5 * source[i].y;
      const double d2 = dx * dx + dz * dz;
      if (d2 >= distance2[j]) continue;
      distance2[j] = d2;
      source[j] = source[i];
      queue.push({d2, j});
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i].wall_m = float(std::min(kFar_m, std::sqrt(distance2[i]) * graph.cell_m));
  }
}

glm::dvec3 FloorGraph::foot_m(std::int32_t place) const {
  const StandingPlace& p = places[place];
  return {origin_m.x + (p.ix + 0.5) * cell_m, p.floor_m, origin_m.y + (p.iz + 0.5) * cell_m};
}

glm::dvec3 FloorGraph::eye_m(std::int32_t place) const {
  const StandingPlace& p = places[place];
  return foot_m(place) + glm::dvec3(0.0, std::min(kEyeHeight_m, double(p.ceiling_m - p.floor_m) - 0.1), 0.0);
}

std::int32_t FloorGraph::diagonal(std::int32_t place, int k) const {
  const std::int32_t a = places[place].link[k];
  const std::int32_t b = places[place].link[(k + 1) % 4];
  if (a < 0 || b < 0) return -1;
  const std::int32_t over_a = places[a].link[(k + 1) % 4];
  return over_a >= 0 && over_a == places[b].link[k] ? over_a : -1;
}

FloorGraph build_floor_graph(const ColumnSpans& spans) {
  FloorGraph graph;
  graph.origin_m = spans.origin_m;
  graph.cell_m = spans.cell_m;
  graph.columns = spans.columns;
  for (int iz = 0; iz < spans.columns.y; ++iz) {
    for (int ix = 0; ix < spans.columns.x; ++ix) {
      const auto column = spans.column(ix, iz);
      for (std::size_t s = 0; s < column.size(); ++s) {
        const float floor = column[s].upper_m;
        const float ceiling = s + 1 < column.size() ? column[s + 1].lower_m : floor + kOpenSky_m;
        if (!column[s].walkable || ceiling - floor < float(kHeadroom_m)) continue;
        graph.places.push_back({ix, iz, floor, ceiling});
      }
    }
  }
  link_places(graph, {float(kStep_m), float(kHeadroom_m)});
  measure_walls(graph);
  return graph;
}

}  // namespace probewalk
