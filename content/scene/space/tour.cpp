#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "content/error.h"
#include "content/scene/space/parts.h"
#include "content/scene/space/start_and_tour.h"
#include "content/scene/space/walk_paths.h"

namespace probewalk {
namespace {

constexpr double kPoseStep_m = 0.25;
constexpr double kStationSpacing_m = 3.0;   // no roomy place of a small home is farther from a station, walking
constexpr float kRoomy_m = 0.45f;           // from walls; stations are not put into narrower nooks
constexpr std::size_t kFewestStations = 4;  // of a small room, where it has room for them
constexpr float kNearestStation_m = 1.2f;
constexpr std::size_t kMostStations = 24;   // besides the middles of rooms
constexpr std::size_t kMostRoomStations = 1000;  // the order takes time with the cube of it
constexpr std::size_t kFewStations = 64;  // among more, ways are searched only as far as the nearest few stations
constexpr std::size_t kNearStations = 12;

// Uphill in the distance to walls, not farther than a step or two: the middle of where one is.
std::int32_t climb(const FloorGraph& graph, const WalkPaths& paths, std::int32_t place) {
  constexpr double kFarthest_m = 1.25;
  for (int step = 0; step < int(kFarthest_m / graph.cell_m); ++step) {
    std::int32_t up = place;
    for (const std::int32_t j : graph.places[place].link) {
      if (j >= 0 && paths.local(j) >= 0 && graph.places[j].wall_m > graph.places[up].wall_m) up = j;
    }
    if (up == place) break;
    place = up;
  }
  return place;
}

// Root first, then the widest place of every room, then the place farthest from all stations, until all are near:
// indices into the part's places.
std::vector<std::int32_t> find_stations(const WalkGround& ground, const WalkPaths& paths, std::int32_t root,
                                        Progress& progress) {
  std::map<std::int32_t, std::int32_t> widest;  // by room
  for (const std::int32_t i : ground.places) {
    const auto [entry, fresh] = widest.try_emplace(ground.room[i], i);
    if (!fresh && ground.graph.places[i].wall_m > ground.graph.places[entry->second].wall_m) entry->second = i;
  }
  const double area_m2 = ground.graph.area_m2(ground.places.size());
  const float spacing_m = float(std::max(kStationSpacing_m, 0.3 * std::sqrt(area_m2)));

  std::vector<std::int32_t> stations;
  std::vector<float> nearest_m(ground.places.size(), HUGE_VALF);
  const auto add = [&](std::int32_t local) {
    if (progress.cancelled()) throw Interrupted("interrupted while planning the tour");
    // Of many stations it matters only what is nearer to them than to those before.
    SearchEnd end;
    if (widest.size() > kFewStations) end.within_m = &nearest_m;
    const WalkTree tree = paths.from(local, end);
    stations.push_back(local);
    for (std::size_t i = 0; i < nearest_m.size(); ++i) nearest_m[i] = std::min(nearest_m[i], tree.length_m[i]);
  };
  add(root);
  for (const auto& [room, place] : widest) {
    if (stations.size() > kMostRoomStations) break;
    if (nearest_m[paths.local(place)] > float(kPoseStep_m)) add(paths.local(place));
  }

  for (std::size_t extra = 0; extra < kMostStations; ++extra) {
    std::int32_t farthest = -1;
    for (std::size_t i = 0; i < nearest_m.size(); ++i) {
      const bool roomy = ground.graph.places[ground.places[i]].wall_m >= kRoomy_m;
      if (!roomy || nearest_m[i] == HUGE_VALF) continue;
      if (farthest < 0 || nearest_m[i] > nearest_m[farthest]) farthest = std::int32_t(i);
    }
    const bool few = stations.size() < kFewestStations;
    if (farthest < 0 || nearest_m[farthest] < (few ? kNearestStation_m : spacing_m)) break;
    const std::int32_t middle = paths.local(climb(ground.graph, paths, ground.places[farthest]));
    const bool new_ground = nearest_m[middle] >= 0.5f * nearest_m[farthest];
    add(new_ground ? middle : farthest);
  }
  return stations;
}

// A point of the way, on a straight line between corners.
struct WayPoint {
  glm::dvec3 foot_m;
  double headroom_m;
  bool station;
};

// What the way from each station to each other costs; infinite where no way leads. Among many, ways to stations farther
// than the nearest few are put together from the ways between those.
std::vector<std::vector<double>> costs_between(const WalkPaths& paths, const std::vector<std::int32_t>& stations,
                                               Progress& progress) {
  const std::size_t count = stations.size();
  std::vector<std::vector<double>> cost(count, std::vector<double>(count, HUGE_VAL));
  std::vector<bool> is_station(paths.places().size(), false);
  for (const std::int32_t local : stations) is_station[local] = true;
  SearchEnd end;
  if (count > kFewStations) end = {nullptr, &is_station, kNearStations + 1};  // and the station itself
  for (std::size_t a = 0; a < count; ++a) {
    if (progress.cancelled()) throw Interrupted("interrupted while planning the tour");
    const WalkTree tree = paths.from(stations[a], end);
    for (std::size_t b = 0; b < count; ++b) cost[a][b] = double(tree.cost[stations[b]]);
  }
  if (count <= kFewStations) return cost;

  // A way costs about the same in both directions. Where the near ones leave pieces (storeys that a stair joins), one
  // station of each piece is searched from to the end.
  std::vector<std::size_t> piece(count);
  for (std::size_t a = 0; a < count; ++a) piece[a] = a;
  const auto root = [&](std::size_t a) {
    while (piece[a] != a) a = piece[a] = piece[piece[a]];
    return a;
  };
  const auto mirror = [&](std::size_t a) {
    for (std::size_t b = 0; b < count; ++b) cost[a][b] = cost[b][a] = std::min(cost[a][b], cost[b][a]);
  };
  for (std::size_t a = 0; a < count; ++a) {
    mirror(a);
    for (std::size_t b = 0; b < count; ++b)
      if (cost[a][b] != HUGE_VAL) piece[std::max(root(a), root(b))] = std::min(root(a), root(b));
  }
  for (std::size_t a = 1; a < count; ++a) {
    if (root(a) != a) continue;
    if (progress.cancelled()) throw Interrupted("interrupted while planning the tour");
    const WalkTree tree = paths.from(stations[a]);
    for (std::size_t b = 0; b < count; ++b) cost[a][b] = std::min(cost[a][b], double(tree.cost[stations[b]]));
    mirror(a);
  }
  for (std::size_t over = 0; over < count; ++over) {
    for (std::size_t a = 0; a < count; ++a) {
      if (cost[a][over] == HUGE_VAL) continue;
      for (std::size_t b = 0; b < count; ++b) cost[a][b] = std::min(cost[a][b], cost[a][over] + cost[over][b]);
    }
  }
  return cost;
}

// Stations in walking order from the first: nearest unvisited first, then stretches turned round while that shortens
// the way (2-opt).
std::vector<std::size_t> order_stations(const std::vector<std::vector<double>>& costs) {
  const auto cost = [&](std::size_t a, std::size_t b) { return costs[a][b] + costs[b][a]; };
  std::vector<std::size_t> order{0};
  std::vector<bool> visited(costs.size(), false);
  visited[0] = true;
  for (;;) {
    std::size_t next = 0;
    for (std::size_t s = 1; s < costs.size(); ++s) {
      if (visited[s] || cost(order.back(), s) == HUGE_VAL) continue;
      if (next == 0 || cost(order.back(), s) < cost(order.back(), next)) next = s;
    }
    if (next == 0) break;
    visited[next] = true;
    order.push_back(next);
  }
  for (bool shorter = true; shorter;) {
    shorter = false;
    for (std::size_t i = 1; i + 1 < order.size(); ++i) {
      for (std::size_t j = i + 1; j < order.size(); ++j) {
        double gain = cost(order[i - 1], order[i]) - cost(order[i - 1], order[j]);
        if (j + 1 < order.size()) gain += cost(order[j], order[j + 1]) - cost(order[i], order[j + 1]);
        if (gain <= 1e-6) continue;
        std::reverse(order.begin() + std::ptrdiff_t(i), order.begin() + std::ptrdiff_t(j) + 1);
        shorter = true;
      }
    }
  }
  return order;
}

// The way from station to station: straight stretches, one point for every column crossed.
std::vector<WayPoint> walk_stations(const WalkGround& ground, const WalkPaths& paths,
                                    const std::vector<std::int32_t>& stations, Progress& progress) {
  const FloorGraph& graph = ground.graph;
  std::vector<WayPoint> way;
  const auto add_point = [&](glm::dvec2 at, std::int32_t place, bool station) {
    const StandingPlace& p = graph.places[place];
    way.push_back({{at.x, p.floor_m, at.y}, p.ceiling_m - p.floor_m, station});
  };
  const auto middle = [&](std::int32_t place) {
    const glm::dvec3 foot = graph.foot_m(place);
    return glm::dvec2(foot.x, foot.z);
  };
  add_point(middle(ground.places[stations[0]]), ground.places[stations[0]], true);
  const std::vector<std::size_t> order = order_stations(costs_between(paths, stations, progress));
  for (std::size_t leg = 1; leg < order.size(); ++leg) {
    std::vector<bool> goal(ground.places.size(), false);
    goal[stations[order[leg]]] = true;
    const WalkTree tree = paths.from(stations[order[leg - 1]], {nullptr, &goal, 1});
    std::vector<std::int32_t> places;
    for (std::int32_t i = stations[order[leg]]; i >= 0; i = tree.previous[i]) places.push_back(ground.places[i]);
    std::reverse(places.begin(), places.end());
    const std::vector<std::int32_t> corners = straightened(graph, places);
    for (std::size_t c = 1; c < corners.size(); ++c) {
      const glm::dvec2 a = middle(corners[c - 1]);
      const glm::dvec2 b = middle(corners[c]);
      std::vector<std::int32_t> crossed = straight_walk(graph, corners[c - 1], corners[c], 0.0f);
      if (crossed.empty()) crossed = {corners[c - 1], corners[c]};  // diagonal neighbours
      for (std::size_t k = 1; k < crossed.size(); ++k) {
        const glm::dvec2 p = a + (b - a) * (double(k) / double(crossed.size() - 1));
        add_point(p, crossed[k], c + 1 == corners.size() && k + 1 == crossed.size());
      }
    }
  }
  return way;
}

struct Sample {
  glm::dvec3 foot_m{0.0};
  double headroom_m = 0.0;
};

std::vector<double> distances_along(const std::vector<WayPoint>& way) {
  std::vector<double> along(way.size(), 0.0);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const glm::dvec3 d = way[i].foot_m - way[i - 1].foot_m;
    along[i] = along[i - 1] + std::hypot(d.x, d.z);
  }
  return along;
}

// Mean of values within `radius` samples, tapering off: removes steps from floors and jerks from turning.
std::vector<double> smoothed(const std::vector<double>& values, double sigma) {
  const int radius = int(std::ceil(3.0 * sigma));
  std::vector<double> out(values.size());
  for (int i = 0; i < int(values.size()); ++i) {
    double sum = 0.0, weight = 0.0;
    for (int k = -radius; k <= radius; ++k) {
      const double w = std::exp(-0.5 * k * k / (sigma * sigma));
      sum += w * values[std::clamp(i + k, 0, int(values.size()) - 1)];
      weight += w;
    }
    out[i] = sum / weight;
  }
  return out;
}

// Turns to one side and the other within two metres of a station, nothing beyond.
double glance_rad(double from_station_m) {
  constexpr double kReach_m = 2.0;
  constexpr double kAngle_rad = 0.6;
  if (std::abs(from_station_m) >= kReach_m) return 0.0;
  const double x = from_station_m / kReach_m;
  const double window = 0.5 + 0.5 * std::cos(std::numbers::pi * x);
  return kAngle_rad * window * std::sin(std::numbers::pi * x);
}

}  // namespace

std::vector<Pose> find_tour(const WalkGround& ground, const Pose& start, Progress& progress) {
  const WalkPaths paths(ground.graph, ground.places);
  const std::int32_t root = paths.local(nearest_place(ground.graph, ground.places, start.position_m));
  const std::vector<WayPoint> way =
      walk_stations(ground, paths, find_stations(ground, paths, root, progress), progress);
  const std::vector<double> along_m = distances_along(way);
  const int count = int(std::round(along_m.back() / kPoseStep_m)) + 1;
  if (count < 8) return look_around(start);

  std::vector<Sample> samples(count);
  std::vector<double> floor_m(count), yaw_rad(count);
  std::size_t segment = 0;
  for (int i = 0; i < count; ++i) {
    const double s = std::min(along_m.back(), along_m.back() * i / (count - 1));
    while (segment + 2 < way.size() && along_m[segment + 1] <= s) ++segment;
    const WayPoint& a = way[segment];
    const WayPoint& b = way[segment + 1];
    const double f =
        std::clamp((s - along_m[segment]) / std::max(1e-9, along_m[segment + 1] - along_m[segment]), 0.0, 1.0);
    const WayPoint& nearer = f < 0.5 ? a : b;
    samples[i] = {glm::mix(a.foot_m, b.foot_m, f), std::min(a.headroom_m, b.headroom_m)};
    samples[i].foot_m.y = nearer.foot_m.y;
    floor_m[i] = nearer.foot_m.y;
    const double yaw = yaw_of(b.foot_m - a.foot_m);
    const double before = i > 0 ? yaw_rad[i - 1] : yaw;
    yaw_rad[i] = before + std::remainder(yaw - before, 2.0 * std::numbers::pi);
  }

  const std::vector<double> level_m = smoothed(floor_m, 1.2);
  std::vector<double> look_rad = smoothed(yaw_rad, 3.0);
  for (std::size_t w = 0; w < way.size(); ++w) {
    if (!way[w].station) continue;
    for (int i = 0; i < count; ++i) look_rad[i] += glance_rad(along_m.back() * i / (count - 1) - along_m[w]);
  }
  std::vector<Pose> tour(count);
  for (int i = 0; i < count; ++i) {
    const Sample& at = samples[i];
    // Smoothed over steps, but with the head where the column is known to be free.
    const double top = at.foot_m.y + at.headroom_m - 0.1;
    const double eye = std::clamp(level_m[i] + kEyeHeight_m, at.foot_m.y + 1.2, std::min(top, at.foot_m.y + 2.0));
    tour[i].position_m = {at.foot_m.x, eye, at.foot_m.z};
    tour[i].yaw_rad = std::remainder(look_rad[i], 2.0 * std::numbers::pi);
  }
  return tour;
}

}  // namespace probewalk
