#include "xr/walkable.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace probewalk {
namespace {

// The node of the column at (x, z) whose air holds height y, or null.
const FloorNode* air_at(const FloorMap& floor, glm::dvec3 point_m) {
  // A head under a ceiling is at most one headroom above its floor; `find` looks up to one step above its argument.
  const std::int32_t index = floor.find({point_m.x, point_m.y - kStep_m, point_m.z});
  if (index < 0) return nullptr;
  const FloorNode& node = floor.nodes[static_cast<std::size_t>(index)];
  return point_m.y <= static_cast<double>(node.floor_m + node.headroom_m) ? &node : nullptr;
}

// Where a way from `from_m`, in free air, to `to_m` meets the floor; nothing where it meets something else.
std::optional<glm::dvec3> landing(const FloorMap& floor, glm::dvec3 from_m, glm::dvec3 to_m) {
  const std::int32_t index = floor.find(to_m);
  if (index < 0 || to_m.y >= from_m.y) return std::nullopt;
  const double height_m = floor.nodes[static_cast<std::size_t>(index)].floor_m;
  if (height_m < to_m.y || height_m > from_m.y + kStep_m) return std::nullopt;
  return glm::dvec3(to_m.x, height_m, to_m.z);
}

}  // namespace

std::optional<double> floor_height_m(const FloorMap& floor, glm::dvec3 foot_m) {
  const std::int32_t index = floor.find(foot_m);
  if (index < 0) return std::nullopt;
  const double height_m = floor.nodes[static_cast<std::size_t>(index)].floor_m;
  if (height_m < foot_m.y - kStep_m) return std::nullopt;
  return height_m;
}

bool can_stand(const FloorMap& floor, glm::dvec3 foot_m, double radius_m) {
  const auto centre = floor_height_m(floor, foot_m);
  if (!centre) return false;
  if (radius_m <= 0.0) return true;
  for (int i = 0; i < 8; ++i) {
    const double angle = i * std::numbers::pi / 4;
    const glm::dvec3 rim(foot_m.x + radius_m * std::cos(angle), *centre, foot_m.z + radius_m * std::sin(angle));
    if (!floor_height_m(floor, rim)) return false;
  }
  return true;
}

glm::dvec3 standing_near(const FloorMap& floor, glm::dvec3 foot_m) {
  if (floor.nodes.empty() || can_stand(floor, foot_m)) return foot_m;
  const glm::dvec3 chest(0, 1.0, 0);
  // A foot in a wall is on neither side of it.
  const bool keeps_side = floor_height_m(floor, foot_m).has_value();
  for (double away_m = floor.cell_m; away_m <= 2.0 * kBodyRadius_m; away_m += floor.cell_m) {
    for (int i = 0; i < 16; ++i) {
      const double angle = i * std::numbers::pi / 8;
      glm::dvec3 there = foot_m + away_m * glm::dvec3(std::cos(angle), 0, std::sin(angle));
      if (!can_stand(floor, there)) continue;
      there.y = *floor_height_m(floor, there);
      if (!keeps_side || is_clear_way(floor, foot_m + chest, there + chest)) return there;
    }
  }
  return foot_m;
}

bool is_clear_way(const FloorMap& floor, glm::dvec3 from_m, glm::dvec3 to_m) {
  if (floor.nodes.empty()) return true;
  const int steps = std::max(1, static_cast<int>(std::ceil(glm::length(to_m - from_m) / (floor.cell_m * 0.5))));
  for (int i = 0; i <= steps; ++i) {
    if (air_at(floor, from_m + (to_m - from_m) * (static_cast<double>(i) / steps)) == nullptr) return false;
  }
  return true;
}

FloorArc arc_to_floor(const FloorMap& floor, glm::dvec3 origin_m, glm::dvec3 velocity_m_s, double gravity_m_s2,
                      double reach_m) {
  FloorArc arc;
  arc.is_straight = gravity_m_s2 == 0.0;
  const double speed_m_s = glm::length(velocity_m_s);
  if (!(speed_m_s > 0.0) || !std::isfinite(speed_m_s)) return arc;
  const auto at = [&](double t_s) {
    return origin_m + velocity_m_s * t_s - glm::dvec3(0, 0.5 * gravity_m_s2 * t_s * t_s, 0);
  };
  // No step is longer than half a column, so that nothing is stepped over; what falls gets faster.
  const double step_m = floor.cell_m * 0.5;
  double t_s = 0.0, way_m = 0.0;
  glm::dvec3 point = origin_m;
  while (way_m < reach_m) {
    const double fall_m_s = gravity_m_s2 * t_s;
    const double now_m_s = glm::length(velocity_m_s - glm::dvec3(0, fall_m_s, 0));
    // Half a step's time at the speed that it may have at its end.
    const double dt_s = step_m / (now_m_s + std::sqrt(gravity_m_s2 * step_m) + 1e-9);
    const glm::dvec3 next = at(t_s + dt_s);
    t_s += dt_s;
    if (air_at(floor, next) == nullptr) {
      arc.landing_m = landing(floor, point, next);
      point = arc.landing_m.value_or(next);
      break;
    }
    way_m += glm::distance(point, next);
    point = next;
  }
  arc.points_m.reserve(FloorArc::kPoints);
  for (int i = 0; i + 1 < FloorArc::kPoints; ++i) arc.points_m.push_back(at(t_s * i / (FloorArc::kPoints - 1)));
  arc.points_m.push_back(point);
  return arc;
}

}  // namespace probewalk
