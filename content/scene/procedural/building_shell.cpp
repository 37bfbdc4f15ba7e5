#include <fmt/format.h>

#include <array>

#include "content/scene/procedural/building_parts.h"
#include "content/scene/procedural/furniture.h"
#include "content/scene/procedural/panel.h"
#include "content/scene/procedural/plants.h"

namespace probewalk::procedural::building {
namespace {

constexpr double kSunk_m = 0.05;     // walls begin this far below the floor
constexpr double kOverlap_m = 0.09;  // and reach this far into the corners
constexpr double kDoorTop_m = 2.15, kWideTop_m = 2.35;

// Half a wall: the side of one room, as thick as half the wall, with the room's colour in front. In the frame of
// draw_panel, x along the side from `0` at the room's corner.
void draw_side(Brush brush, const Palette& p, MaterialId wall, double length_m, double height_m, Side side) {
  Panel panel;
  panel.width_m = length_m + 2.0 * kOverlap_m, panel.height_m = height_m, panel.thickness_m = kHalfWall_m;
  const double middle_m = side.middle_m + kOverlap_m;
  switch (side.opening) {
    case Opening::kNone:
      break;
    case Opening::kWindow:
      panel.openings.push_back({middle_m - 0.8, kSunk_m + 0.9, middle_m + 0.8, kSunk_m + 2.2});
      break;
    case Opening::kDoorway:
      panel.openings.push_back({middle_m - 0.5, kSunk_m - 0.01, middle_m + 0.5, kSunk_m + kDoorTop_m});
      break;
    case Opening::kWideDoorway:
      panel.openings.push_back({middle_m - 0.9, kSunk_m - 0.01, middle_m + 0.9, kSunk_m + kWideTop_m});
      break;
  }
  panel.material = [&](glm::dvec3 world_m) { return world_m.z > 0.0 ? wall : p.plaster_outside; };
  panel.edge = p.plaster_white;
  draw_panel(brush.at({-kOverlap_m, -kSunk_m, 0.0}), panel);
  if (side.opening == Opening::kWindow) {
    Brush frame = brush;
    for (const double x : {side.middle_m - 0.79, side.middle_m - 0.03, side.middle_m + 0.73})
      frame.box(p.window_frame, {x, 0.9, -0.09}, {x + 0.06, 2.2, -0.04});
  }
}

struct Colours {
  MaterialId wall, floor;
};

Colours colours_of(const Palette& p, const Room& room) {
  const std::array walls{p.plaster_white, p.plaster_sand, p.plaster_sage, p.plaster_blue, p.plaster_clay};
  const MaterialId wall = walls[(room.seed * 7 + room.seed / 10) % walls.size()];
  switch (room.kind) {
    case Kind::kKitchen:
      return {p.kitchen_wall, p.stone_floor};
    case Kind::kBath:
      return {p.bath_wall, p.bath_floor};
    case Kind::kWinterGarden:
      return {p.brick, p.paving};
    case Kind::kGallery:
      return {p.plaster_white, p.marble};
    case Kind::kStairwell:
      return {p.plaster_white, p.oak_floor};
    case Kind::kTerrace:
      return {p.brick, p.paving};
    default:
      return {wall, room.seed % 4 == 0 ? p.stone_floor : p.oak_floor};
  }
}

void place_sides(Parts& parts, const Palette& p, MaterialId wall, const Room& room, double floor_m, const Side* sides) {
  for (int name = kNorth; name <= kWest; ++name) {
    Side side = sides[name];
    const double length_m = room.length_m(name);
    // Seen from inside, x of a panel runs west to east on the north side and back on the south side.
    if (name == kSouth || name == kWest) side.middle_m = length_m - side.middle_m;
    if (side.opening == Opening::kNone) side.middle_m = 0.0;
    const std::array<glm::dvec3, 4> corners{glm::dvec3(room.lower_m.x, floor_m, room.lower_m.z),
                                            {room.upper_m.x, floor_m, room.lower_m.z},
                                            {room.upper_m.x, floor_m, room.upper_m.z},
                                            {room.lower_m.x, floor_m, room.upper_m.z}};
    const std::string variant =
        fmt::format("Wall {} {:.2f} {} {:.3f}", wall, length_m, int(side.opening), side.middle_m);
    parts.place(
        variant, [&](Brush brush) { draw_side(brush, p, wall, length_m, kStorey_m, side); }, corners[std::size_t(name)],
        -90.0 * name);
  }
}

// Floor and ceiling reach to the middle of the walls.
void draw_level(Brush brush, MaterialId material, glm::dvec2 lower, glm::dvec2 upper, double y, bool faces_up) {
  if (faces_up)
    brush.quad(material, {lower.x, y, upper.y}, {upper.x, y, upper.y}, {upper.x, y, lower.y}, {lower.x, y, lower.y});
  else
    brush.quad(material, {lower.x, y, lower.y}, {upper.x, y, lower.y}, {upper.x, y, upper.y}, {lower.x, y, upper.y});
}

void draw_stair(Brush brush, const Palette& p, double depth_m) {
  constexpr int kRises = 18;
  constexpr double kRise_m = kStorey_m / kRises, kTread_m = (kStairTo_m - kStairFrom_m) / (kRises - 1);
  for (int step = 0; step + 1 < kRises; ++step) {
    const double x = kStairFrom_m + kTread_m * step, y = kRise_m * (step + 1);
    brush.box(p.plaster_white, {x, -0.01, -0.05}, {x + kTread_m, y - 0.03, kFlight_m});
    brush.box(p.oak, {x - 0.02, y - 0.03, -0.05}, {x + kTread_m, y, kFlight_m + 0.02});
  }
  const double rail_z = kFlight_m - 0.05;
  brush.rod(p.walnut, {kStairFrom_m, kRise_m + 0.9, rail_z}, {kStairTo_m - 0.15, kStorey_m + 0.75, rail_z}, 0.025);
  for (int step = 0; step + 1 < kRises; step += 2) {
    const double x = kStairFrom_m + kTread_m * (step + 0.5), y = kRise_m * (step + 1);
    brush.rod(p.black_metal, {x, y, rail_z}, {x, y + 0.97, rail_z}, 0.01, 6);
  }
  // The upper floor around the void, its landing in the east.
  constexpr double kBoards_m = kStorey_m - 0.03, kEdge_m = kHalfWall_m;
  const auto slab = [&](glm::dvec2 lower, glm::dvec2 upper) {
    brush.box(p.ceiling, {lower.x, kCeiling_m, lower.y}, {upper.x, kBoards_m, upper.y});
    brush.box(p.oak_floor, {lower.x, kBoards_m, lower.y}, {upper.x, kStorey_m, upper.y});
  };
  slab({kStairTo_m, -kEdge_m}, {kStairwellWidth_m + kEdge_m, depth_m + kEdge_m});
  slab({-kEdge_m, kVoid_m}, {kStairTo_m, depth_m + kEdge_m});
  slab({-kEdge_m, -kEdge_m}, {kVoidFrom_m, kVoid_m});
  const auto rail = [&](glm::dvec3 from, glm::dvec3 to) {
    brush.rod(p.walnut, from + glm::dvec3(0, 0.95, 0), to + glm::dvec3(0, 0.95, 0), 0.03);
    const int posts = int(glm::distance(from, to) / 0.13);
    for (int i = 0; i <= posts; ++i) {
      const glm::dvec3 at = glm::mix(from, to, double(i) / posts);
      brush.rod(p.black_metal, at, at + glm::dvec3(0, 0.95, 0), 0.01, 6);
    }
  };
  rail({kVoidFrom_m, kStorey_m, kVoid_m}, {kStairTo_m, kStorey_m, kVoid_m});
  rail({kVoidFrom_m, kStorey_m, 0.03}, {kVoidFrom_m, kStorey_m, kVoid_m});
}

void build_terrace(Parts& parts, const Palette& p, const Room& room) {
  parts.place(
      "Terrace",
      [&](Brush brush) {
        const double w = room.width_m(), d = room.depth_m(), h = 1.15, t = 0.25;
        brush.box(p.paving, {-t, -0.3, -kHalfWall_m}, {w + t, 0.0, d + t});
        brush.box(p.brick, {-t, -0.01, 0.0}, {0, h, d + t});
        brush.box(p.brick, {w, -0.01, 0.0}, {w + t, h, d + t});
        brush.box(p.brick, {0, -0.01, d}, {w, h, d + t});
      },
      room.lower_m);
}

}  // namespace

void build_shell(Parts& parts, const Palette& p, const Plan& plan) {
  for (const Room& room : plan.rooms) {
    const Colours colours = colours_of(p, room);
    if (room.kind == Kind::kTerrace) {
      build_terrace(parts, p, room);
      continue;
    }
    place_sides(parts, p, colours.wall, room, room.lower_m.y, room.sides.data());
    const glm::dvec2 size{room.width_m(), room.depth_m()};
    const glm::dvec2 lower{-kHalfWall_m}, upper = size + kHalfWall_m;
    const std::string area = fmt::format("{:.2f} x {:.2f}", size.x, size.y);
    parts.place(
        fmt::format("Floor {} {}", colours.floor, area),
        [&](Brush brush) { draw_level(brush, colours.floor, lower, upper, 0.0, true); }, room.lower_m);
    const glm::dvec3 ceiling_m{room.lower_m.x, room.upper_m.y, room.lower_m.z};
    parts.place(
        "Ceiling " + area, [&](Brush brush) { draw_level(brush, p.ceiling, lower, upper, 0.0, false); }, ceiling_m);
    if (room.kind == Kind::kStairwell) {
      place_sides(parts, p, colours.wall, room, room.lower_m.y + kStorey_m, plan.upper_stair.data());
      parts.place("Stair", [&](Brush brush) { draw_stair(brush, p, room.depth_m()); }, room.lower_m);
    }
  }
  Brush roof(parts.model(), "Roof");
  const double top = kStorey_m * (kStoreys - 1) + kStorey_m;
  roof.box(p.terracotta, {-0.3, top - 0.1, -0.3}, {plan.size_m.x + 0.3, top + 0.1, plan.size_m.y + 0.3});
}

}  // namespace probewalk::procedural::building
