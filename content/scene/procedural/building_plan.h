// The large building on paper: a grid of rooms on two storeys, joined by doorways, enfilades and one stair, with a
// terrace before the entrance. x runs east, z runs south, y up; ground floor at y = 0.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace probewalk::procedural::building {

inline constexpr int kStoreys = 2;
inline constexpr double kStorey_m = 3.2;   // from floor to floor
inline constexpr double kCeiling_m = 2.8;  // above the floor
inline constexpr double kHalfWall_m = 0.1;
inline constexpr double kTerrace_m = 5.0;  // depth

enum class Kind {
  kLiving,
  kLibrary,
  kDining,
  kBedroom,
  kStudy,
  kKitchen,
  kBath,
  kGallery,
  kPlayroom,
  kWinterGarden,
  kStairwell,  // over both storeys
  kTerrace
};

enum class Opening { kNone, kWindow, kDoorway, kWideDoorway };

// A side of a room, seen from inside: its opening and where along the side the opening's middle is, counted from the
// side's western or northern end.
struct Side {
  Opening opening = Opening::kNone;
  double middle_m = 0.0;
};
// Order of a room's sides.
enum SideName { kNorth, kEast, kSouth, kWest };

struct Room {
  std::string name;
  Kind kind = Kind::kLiving;
  int storey = 0;
  glm::dvec3 lower_m{0.0}, upper_m{0.0};  // the air between walls, floor and ceiling
  std::array<Side, 4> sides;
  std::uint32_t seed = 0;
  double width_m() const { return upper_m.x - lower_m.x; }
  double depth_m() const { return upper_m.z - lower_m.z; }
  double length_m(int side) const { return side % 2 == 0 ? width_m() : depth_m(); }
};

struct Plan {
  std::vector<Room> rooms;        // the stairwell first, the terrace last
  std::vector<Side> upper_stair;  // the stairwell's four sides on the upper storey
  glm::dvec2 size_m{0.0};         // of the building, x and z, walls not counted
};

// The stair in the stairwell's own frame: a straight flight along the north wall, rising to the east.
inline constexpr double kStairFrom_m = 1.225, kStairTo_m = 5.9, kFlight_m = 1.3, kVoidFrom_m = 0.9, kVoid_m = 1.45;
inline constexpr double kStairwellWidth_m = 7.0;

// 20 or 200 rooms.
Plan make_plan(int rooms);

}  // namespace probewalk::procedural::building
