// The sample house on paper: rooms, walls with their openings, slabs. The shell is built from it, furniture
// is not in it. x runs east, z runs south, y up; ground floor at y = 0, upper floor at y = 3; the courtyard
// lies south of the house.
#pragma once

#include <string>
#include <vector>

#include "content/scene/procedural/palette.h"
#include "content/scene/procedural/panel.h"

namespace probewalk::procedural {

inline constexpr double kUpperFloor_m = 3.0;
inline constexpr double kGroundCeiling_m = 2.7;
inline constexpr double kUpperCeiling_m = 5.65;
inline constexpr double kCourtyard_m = -0.02;  // a threshold below the ground floor

struct PlanRoom {
  std::string name;
  glm::dvec3 lower_m, upper_m;
  MaterialId wall, floor, ceiling;
  MaterialId wall_low = -1;  // up to kDado_m above the floor, where it is set
  bool has_skirting = true;
};
inline constexpr double kDado_m = 1.25;

struct PlanOpening {
  enum class Kind { kDoorway, kWindow, kGlazedDoors };
  Kind kind;
  double from_m, to_m;        // along the wall: world x or z
  double bottom_m, top_m;     // world y
  int columns = 1, rows = 1;  // panes of a window
};

struct PlanWall {
  std::string name;
  bool along_z;         // else along x. The front of a wall along x faces south, of one along z faces west
  double front_m;       // world z (or x) of the front face
  double from_m, to_m;  // along the wall
  double thickness_m;   // backwards from the front
  double bottom_m, top_m;
  std::vector<PlanOpening> openings;
};

// Horizontal rectangle.
struct PlanArea {
  double x0_m, z0_m, x1_m, z1_m;
};

struct HousePlan {
  std::vector<PlanRoom> rooms;  // the first that holds a point wins
  std::vector<PlanWall> walls;
  PlanArea stair_void;
  // The room whose air holds the point, else one within `margin_m`, else null.
  const PlanRoom* room_at(glm::dvec3 world_m, double margin_m = 0.13) const;
};

HousePlan make_house_plan(const Palette& p);

}  // namespace probewalk::procedural
