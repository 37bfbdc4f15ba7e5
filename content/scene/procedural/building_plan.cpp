#include "content/scene/procedural/building_plan.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "content/scene/procedural/texture_canvas.h"

namespace probewalk::procedural::building {
namespace {

constexpr double kWall_m = 2.0 * kHalfWall_m;
constexpr std::array kColumnWidths_m{4.4, 5.2, 6.4, 4.8};
constexpr std::array kRowDepths_m{4.4, 5.0, 4.6};
constexpr int kEnfilade = 3;         // every third row has its doorways in one line
constexpr double kLoops = 0.4;       // share of the walls with a doorway beyond those that join all rooms
constexpr double kWindows = 0.45;    // share of the outer walls with a window
constexpr double kToCorner_m = 1.1;  // corners are for furniture

struct Grid {
  int columns, rows;
  int stair_column, stair_row;
  std::vector<double> x_m, z_m;  // where the air of a column or row begins
  std::vector<double> width_m, depth_m;
  bool is_stair(int i, int j) const { return i == stair_column && j == stair_row; }
};

Grid make_grid(int rooms) {
  Grid grid{};
  grid.columns = rooms >= 200 ? 10 : 5;
  grid.rows = rooms / (kStoreys * grid.columns);
  grid.stair_column = grid.columns / 2, grid.stair_row = grid.rows / 2;
  double x = 0.0, z = 0.0;
  for (int i = 0; i < grid.columns; ++i) {
    const double width =
        i == grid.stair_column ? kStairwellWidth_m : kColumnWidths_m[std::size_t(i) % kColumnWidths_m.size()];
    grid.x_m.push_back(x), grid.width_m.push_back(width);
    x += width + kWall_m;
  }
  for (int j = 0; j < grid.rows; ++j) {
    const double depth = kRowDepths_m[std::size_t(j) % kRowDepths_m.size()];
    grid.z_m.push_back(z), grid.depth_m.push_back(depth);
    z += depth + kWall_m;
  }
  return grid;
}

// A wall between two cells of one storey: between (i, j) and its eastern or southern neighbour.
struct Wall {
  int storey, i, j;
  bool east;
  double order;
};

const char* name_of(Kind kind) {
  constexpr std::array kNames{"Living room", "Library", "Dining room", "Bedroom",       "Study",     "Kitchen",
                              "Bathroom",    "Gallery", "Playroom",    "Winter garden", "Stairwell", "Terrace"};
  return kNames[std::size_t(kind)];
}

// Rooms that need a bare wall to put their largest piece against come only where there is one.
Kind kind_of(const Room& room) {
  constexpr std::array kNeedWall{Kind::kLiving, Kind::kBedroom, Kind::kStudy, Kind::kKitchen, Kind::kBath};
  constexpr std::array kAnywhere{Kind::kLibrary, Kind::kDining, Kind::kGallery, Kind::kPlayroom, Kind::kWinterGarden};
  const bool bare =
      std::any_of(room.sides.begin(), room.sides.end(), [](const Side& s) { return s.opening == Opening::kNone; });
  const double roll = hash01(room.seed, 17, 903), which = hash01(room.seed, 18, 906);
  return bare && roll < 0.75 ? kNeedWall[std::size_t(which * kNeedWall.size())]
                             : kAnywhere[std::size_t(which * kAnywhere.size())];
}

}  // namespace

Plan make_plan(int room_count) {
  const Grid grid = make_grid(room_count);
  const int cells = grid.columns * grid.rows;
  const auto cell = [&](int storey, int i, int j) { return std::size_t(storey * cells + j * grid.columns + i); };
  std::vector<Room> rooms(std::size_t(kStoreys * cells));
  for (int storey = 0; storey < kStoreys; ++storey) {
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        Room& room = rooms[cell(storey, i, j)];
        room.storey = storey;
        room.lower_m = {grid.x_m[std::size_t(i)], kStorey_m * storey, grid.z_m[std::size_t(j)]};
        room.upper_m =
            room.lower_m + glm::dvec3(grid.width_m[std::size_t(i)], kCeiling_m, grid.depth_m[std::size_t(j)]);
        room.seed = std::uint32_t(cell(storey, i, j));
      }
    }
  }

  // Doorways: walls in random order; one opens when it joins what was apart, some of the others too.
  std::vector<Wall> walls;
  for (int storey = 0; storey < kStoreys; ++storey) {
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        for (const bool east : {true, false}) {
          if (east ? i + 1 >= grid.columns : j + 1 >= grid.rows) continue;
          if (!east && grid.is_stair(i, j + 1)) continue;  // the flight stands along the stairwell's north wall
          walls.push_back({storey, i, j, east, hash01(int(cell(storey, i, j)), east, 77)});
        }
      }
    }
  }
  std::stable_sort(walls.begin(), walls.end(), [](const Wall& a, const Wall& b) { return a.order < b.order; });
  std::vector<std::size_t> joined(rooms.size());
  std::iota(joined.begin(), joined.end(), std::size_t(0));
  const auto root = [&](std::size_t c) {
    while (joined[c] != c) c = joined[c] = joined[joined[c]];
    return c;
  };
  for (const Wall& wall : walls) {
    const std::size_t a = cell(wall.storey, wall.i, wall.j);
    const std::size_t b = wall.east ? cell(wall.storey, wall.i + 1, wall.j) : cell(wall.storey, wall.i, wall.j + 1);
    const bool joins = root(a) != root(b);
    if (!joins && hash01(int(a), wall.east, 78) >= kLoops) continue;
    joined[root(a)] = root(b);
    const double length_m = rooms[a].length_m(wall.east ? kEast : kSouth);
    const bool wide = length_m >= 4.5 && hash01(int(a), wall.east, 79) < 0.3;
    const double end_m = kToCorner_m + (wide ? 0.9 : 0.5);
    double along = hash01(int(a), wall.east, 80);
    if (wall.east && wall.j % kEnfilade == 0) along = 0.5;
    if (wall.east && (grid.is_stair(wall.i, wall.j) || grid.is_stair(wall.i + 1, wall.j)))
      along = 0.9;  // off the flight
    const Side side{wide ? Opening::kWideDoorway : Opening::kDoorway, glm::mix(end_m, length_m - end_m, along)};
    rooms[a].sides[wall.east ? kEast : kSouth] = side;
    rooms[b].sides[wall.east ? kWest : kNorth] = side;
  }
  for (int storey = 0; storey < kStoreys; ++storey) {
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        Room& room = rooms[cell(storey, i, j)];
        const std::array outer{j == 0, i + 1 == grid.columns, j + 1 == grid.rows, i == 0};
        for (int side = 0; side < 4; ++side) {
          if (!outer[std::size_t(side)] || hash01(int(room.seed), side, 81) >= kWindows) continue;
          room.sides[std::size_t(side)] = {Opening::kWindow, 0.5 * room.length_m(side)};
        }
      }
    }
  }

  // The entrance, from a terrace as wide as the room behind it.
  Room& entrance = rooms[cell(0, grid.stair_column - 1, grid.rows - 1)];
  entrance.sides[kSouth] = {Opening::kWideDoorway, 0.5 * entrance.width_m()};
  Room terrace;
  terrace.name = name_of(Kind::kTerrace), terrace.kind = Kind::kTerrace;
  terrace.lower_m = {entrance.lower_m.x, 0.0, entrance.upper_m.z + kWall_m};
  terrace.upper_m = {entrance.upper_m.x, 2.0 * kStorey_m, entrance.upper_m.z + kWall_m + kTerrace_m};
  terrace.seed = 9999;

  Plan plan;
  Room stairwell = rooms[cell(0, grid.stair_column, grid.stair_row)];
  stairwell.kind = Kind::kStairwell, stairwell.name = name_of(stairwell.kind);
  stairwell.upper_m.y = kStorey_m * (kStoreys - 1) + kCeiling_m;
  const Room& above = rooms[cell(1, grid.stair_column, grid.stair_row)];
  plan.upper_stair.assign(above.sides.begin(), above.sides.end());
  plan.rooms.push_back(std::move(stairwell));
  for (int storey = 0; storey < kStoreys; ++storey) {
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        if (grid.is_stair(i, j)) continue;
        Room& room = rooms[cell(storey, i, j)];
        room.kind = kind_of(room);
        room.name = std::string(name_of(room.kind)) + " " + std::to_string(100 * (storey + 1) + j * grid.columns + i);
        plan.rooms.push_back(std::move(room));
      }
    }
  }
  plan.rooms.push_back(std::move(terrace));
  plan.size_m = {grid.x_m.back() + grid.width_m.back(), grid.z_m.back() + grid.depth_m.back()};
  return plan;
}

}  // namespace probewalk::procedural::building
