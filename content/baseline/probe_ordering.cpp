#include "content/baseline/probe_ordering.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <stdexcept>

#include "content/probe/tracer_f32.h"

namespace probewalk {
namespace {

constexpr int kLeastCells = 8;

// A probe under open sky: only its place matters here.
DeviceProbe open_probe(glm::dvec3 position_m) {
  constexpr std::size_t n = kLeastCells;
  ProbeMap map;
  map.geometry.position_m = position_m;
  map.geometry.n = kLeastCells;
  map.geometry.w.assign((n + 1) * (n + 1), 0.0f);
  map.geometry.edges_horizontal.assign(n * (n + 1), kConnected);
  map.geometry.edges_vertical.assign(n * (n + 1), kConnected);
  map.geometry.edges_diagonal.assign(n * n, kConnected);
  map.geometry.normals.assign((n + 1) * (n + 1), 0);
  map.radiance.r = kLeastCells;
  map.radiance.rgb9e5.assign(mip_chain_texels(kLeastCells), 0);
  map.radiance.texel_w.assign(n * n, 0);
  return build_device_probe(map);
}

glm::dvec3 cube_corner(int k) {
  return {k & 1, k >> 1 & 1, k >> 2};
}

ProbeSet cube_probes() {
  ProbeGrid grid;
  grid.dims = {2, 2, 2};
  std::vector<DeviceProbe> probes;
  for (int k = 0; k < 8; ++k) {
    probes.push_back(open_probe(cube_corner(k)));
    grid.probe.push_back(static_cast<std::uint32_t>(k));
  }
  return ProbeSet(std::move(probes), grid);
}

double square_score(int first, glm::dvec2 origin, glm::dvec2 d, glm::dvec2 corner) {
  const glm::dvec2 away = origin - corner;
  const double distance = glm::length(away) + 1e-12, cosine = glm::dot(away, d) / distance;
  const double cell_diagonal = std::sqrt(8.0);
  if (first == kFirstNearest) return -distance;
  if (first == kFirstSigned) return cosine;
  if (first == kFirstUnsigned) return std::abs(cosine);
  // As in tracer.h: what lies beyond the cell's middle fades out, 8 a cell.
  const double off_cells = 0.5 * std::max(std::abs(away.x), std::abs(away.y));
  return cosine - distance / cell_diagonal - 8.0 * std::max(off_cells - 0.5, 0.0);
}

}  // namespace

std::array<int, 4> square_order(int first, glm::dvec2 origin, glm::dvec2 unit_direction) {
  std::array<double, 4> score{};
  for (std::size_t k = 0; k < 4; ++k)
    score[k] = square_score(first, origin, unit_direction, glm::dvec2(kSquareCorners[k]));
  std::array<int, 4> order{0, 1, 2, 3};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return score[static_cast<std::size_t>(a)] > score[static_cast<std::size_t>(b)];
  });
  return order;
}

std::vector<OrderSector> square_sectors(int first, glm::dvec2 origin) {
  constexpr int kCoarse = 1440;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  // Half a step off, so that the symmetric directions, where scores tie, are never sampled.
  const auto angle_of = [](int k) { return kTurn * (k + 0.5) / kCoarse; };
  const auto order_at = [&](double angle) { return square_order(first, origin, {std::cos(angle), std::sin(angle)}); };
  std::vector<double> borders;
  std::vector<std::array<int, 4>> orders;
  for (int k = 0; k < kCoarse; ++k) {
    double start = angle_of(k);
    auto before = order_at(start);
    const auto after = order_at(angle_of(k + 1));
    // A step may hold several borders.
    while (before != after) {
      double low = start, high = angle_of(k + 1);
      while (high - low > 1e-10) {
        const double middle = 0.5 * (low + high);
        (order_at(middle) == before ? low : high) = middle;
      }
      start = high;
      before = order_at(high);
      borders.push_back(high);
      orders.push_back(before);
    }
  }
  std::vector<OrderSector> sectors;
  if (borders.empty()) return {{0.0, kTurn, order_at(angle_of(0))}};
  for (std::size_t k = 0; k < borders.size(); ++k) {
    const double end = k + 1 < borders.size() ? borders[k + 1] : borders[0] + kTurn;
    sectors.push_back({borders[k], end, orders[k]});
  }
  return sectors;
}

CubeOrdering::CubeOrdering() : probes_(cube_probes()) {}

std::array<int, 8> CubeOrdering::order(const SelectionRules& rules, glm::dvec3 origin,
                                       glm::dvec3 unit_direction) const {
  f32::CellCandidates cell =
      f32::cell_candidates(probes_.grid(), default_dials(1.0), rules, glm::vec3(origin), glm::vec3(unit_direction));
  std::array<int, 8> order{};
  for (int& id : order) {
    const int corner = f32::best_candidate(cell);
    if (corner == PW_CANDIDATES) throw std::logic_error("a cell with eight probes has fewer than eight candidates");
    id = f32::candidate_probe(cell, corner);
    f32::strike_candidate(cell, id);
  }
  return order;
}

OrderStatistics order_statistics(const CubeOrdering& cube, const SelectionRules& rules, glm::dvec3 origin,
                                 int directions) {
  OrderStatistics statistics;
  std::set<std::array<int, 8>> seen;
  for (int k = 0; k < directions; ++k) {
    const glm::dvec3 d = spread_direction(k, directions);
    const std::array<int, 8> order = cube.order(rules, origin, d);
    seen.insert(order);
    statistics.first_share[static_cast<std::size_t>(order[0])] += 1.0 / directions;
    const glm::dvec3 first = glm::normalize(origin - cube_corner(order[0]));
    const glm::dvec3 second = glm::normalize(origin - cube_corner(order[1]));
    statistics.first_cosine += glm::dot(first, d) / directions;
    statistics.second_turn_rad += std::acos(std::clamp(glm::dot(first, second), -1.0, 1.0)) / directions;
    for (std::size_t i = 0; i + 1 < order.size(); ++i) {
      const int differing = order[i] ^ order[i + 1];
      statistics.corners_moved += ((differing & 1) + (differing >> 1 & 1) + (differing >> 2)) / 7.0 / directions;
    }
  }
  statistics.distinct_orders = static_cast<int>(seen.size());
  return statistics;
}

glm::dvec3 spread_direction(int k, int n) {
  const double z = 1.0 - (2.0 * k + 1.0) / n, r = std::sqrt(std::max(0.0, 1.0 - z * z));
  const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * k;
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace probewalk
