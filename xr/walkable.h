// Where a person can stand, go and throw a teleport: questions to the pack's reachable floor. Pure maths.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "content/scene/space.h"

namespace probewalk {

inline constexpr double kStep_m = 0.45;  // what a foot climbs without a jump

// The floor under a foot: the node of the column whose floor lies within one step, or nothing (wall, furniture, void).
std::optional<double> floor_height_m(const FloorMap& floor, glm::dvec3 foot_m);

// Whether a body of this radius has floor all around it at (x, z).
bool can_stand(const FloorMap& floor, glm::dvec3 foot_m, double radius_m = kBodyRadius_m);

// The nearest place, at most a body's width away, where a whole body can stand, on the same side of every wall; the
// foot itself where there is none, or no floor at all.
glm::dvec3 standing_near(const FloorMap& floor, glm::dvec3 foot_m);

// Free air over walkable floor all the way between two points. Columns know no air over furniture: a way across it
// counts as not clear. Where there is no floor at all nothing is in the way.
bool is_clear_way(const FloorMap& floor, glm::dvec3 from_m, glm::dvec3 to_m);

// Where something thrown flies, and where it first meets the floor. It ends at the first column without free air at its
// height, so that nobody teleports through a wall.
struct FloorArc {
  std::vector<glm::dvec3> points_m;     // from the origin to where it ends; at most kPoints, equal times apart
  std::optional<glm::dvec3> landing_m;  // on walkable floor; nothing = it met a wall, furniture, the ceiling or nothing
  bool is_straight = false;             // a ray
  static constexpr int kPoints = 33;
};
// `gravity_m_s2` 0 = a ray. Ends after `reach_m` along the way. A velocity of no length meets nothing.
FloorArc arc_to_floor(const FloorMap& floor, glm::dvec3 origin_m, glm::dvec3 velocity_m_s, double gravity_m_s2,
                      double reach_m);

}  // namespace probewalk
