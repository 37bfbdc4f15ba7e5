#include "content/scene/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "content/scene/ray_scene.h"

namespace probewalk {
namespace {

struct Unit {
  double scale;
  double cost;  // how much less likely than metres
  const char* name;
};

constexpr std::array<Unit, 10> kUnits{{{1.0, 0.0, "metres"},
                                       {0.01, 0.7, "centimetres"},
                                       {0.001, 0.7, "millimetres"},
                                       {0.0254, 1.0, "inches"},
                                       {0.3048, 1.0, "feet"},
                                       {0.1, 1.2, "tenths of a metre"},
                                       {0.05, 1.2, "twentieths of a metre"},
                                       {0.025, 1.2, "fortieths of a metre"},
                                       {10.0, 1.2, "tens of metres"},
                                       {100.0, 1.2, "hundreds of metres"}}};
constexpr int kProbePoints = 20000;
// Fewer gaps than this say nothing about storeys.
constexpr std::size_t kMinGaps = 100;
constexpr double kMinStorey_m = 1.9;
// Weight of being close to a usual storey, among units that the rule holds equally likely.
constexpr double kTieBreak = 1e-3;

// Point of the R3 sequence (Roberts 2018) in the unit cube: fixed, and even in every projection.
glm::dvec3 sequence_point(int index) {
  constexpr glm::dvec3 kStep(0.8191725133961645, 0.6710436067037893, 0.5497004779019703);
  const glm::dvec3 p = glm::dvec3(0.5) + static_cast<double>(index + 1) * kStep;
  return p - glm::floor(p);
}

// Median free height between surfaces that face each other, over the volume of the scene; 0 when there is hardly any.
double median_gap(const Scene& scene) {
  const RayScene rays(scene);
  const glm::dvec3 extent = scene.bounds.upper_m - scene.bounds.lower_m;
  std::vector<double> gaps;
  for (int i = 0; i < kProbePoints; ++i) {
    const glm::vec3 origin(scene.bounds.lower_m + extent * sequence_point(i));
    const SurfaceHit up = rays.closest(origin, {0, 1, 0});
    if (!up.hit || up.geometric_normal.y >= 0.0f) continue;
    const SurfaceHit down = rays.closest(origin, {0, -1, 0});
    if (!down.hit || down.geometric_normal.y <= 0.0f) continue;
    gaps.push_back(static_cast<double>(up.t) + static_cast<double>(down.t));
  }
  if (gaps.size() < kMinGaps) return 0.0;
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  return gaps[gaps.size() / 2];
}

double unit_cost(const Unit& unit, double gap, double extent) {
  double cost = unit.cost;
  if (gap > 0.0) {
    const double storey_m = gap * unit.scale;
    cost += 0.5 * std::max({0.0, std::log(storey_m / 5.0), std::log(2.2 / storey_m)});
    if (storey_m < kMinStorey_m || storey_m > 25.0) cost += 2.0;
    cost += kTieBreak * std::abs(std::log(storey_m / 2.7));
  }
  const double extent_m = extent * unit.scale;
  if (extent_m < 2.5 || extent_m > 300.0) cost += 2.0;
  return cost;
}

}  // namespace

UnitGuess guess_unit(const Scene& scene) {
  const glm::dvec3 size = scene.bounds.upper_m - scene.bounds.lower_m;
  const double extent = std::max(size.x, size.z);
  if (extent >= 3.0 && extent <= 300.0 && size.y >= 1.8 && size.y <= 120.0) {
    return {1.0,
            fmt::format("1 unit is 1 m: {:.4g} x {:.4g} x {:.4g} is plausible in metres", size.x, size.y, size.z),
            std::nullopt};
  }
  const double gap = median_gap(scene);
  const Unit& best = *std::min_element(kUnits.begin(), kUnits.end(), [&](const Unit& a, const Unit& b) {
    return unit_cost(a, gap, extent) < unit_cost(b, gap, extent);
  });
  UnitGuess guess;
  guess.scale = best.scale;
  const std::string measured =
      gap > 0.0 ? fmt::format("floors and ceilings are {:.4g} units apart", gap) : "no storeys to measure";
  guess.statement = fmt::format("1 unit is {:g} m ({}), guessed: {:.4g} x {:.4g} x {:.4g} units, {}", best.scale,
                                best.name, size.x, size.y, size.z, measured);
  if (gap <= 0.0) {
    guess.warning =
        fmt::format("the unit cannot be told from the scene; {:g} m is a guess, --scale says it", best.scale);
  } else if (gap * best.scale < kMinStorey_m) {
    guess.warning = fmt::format("with {:g} m a unit, storeys are {:.2f} m high; --scale says the unit", best.scale,
                                gap * best.scale);
  }
  return guess;
}

std::optional<std::string> check_up_axis(const Scene& scene) {
  constexpr double kAligned = 0.9816271834476639;  // cos 11 degrees
  constexpr double kClearlyLess = 0.8;
  glm::dvec3 area(0.0);
  for (const glm::uvec3& corner : scene.triangles) {
    const glm::dvec3 a = scene.positions_m[corner.x];
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(scene.positions_m[corner.y]) - a, glm::dvec3(scene.positions_m[corner.z]) - a);
    const double length = std::sqrt(glm::dot(normal, normal));
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(normal[axis]) >= kAligned * length) area[axis] += length;
    }
  }
  const double largest = std::max(area.x, area.z);
  if (area.y >= kClearlyLess * largest) return std::nullopt;
  return fmt::format("{} may be up instead of y ({:.0f} % as much area faces y); turn the scene if it lies on its side",
                     area.x > area.z ? "x" : "z", 100.0 * area.y / largest);
}

}  // namespace probewalk
