#include "content/scene/procedural/house_plan.h"

namespace probewalk::procedural {
namespace {

constexpr double kOuter_m = 0.25, kInner_m = 0.20;  // thickness of walls
constexpr double kSunk_m = 0.01;  // doorways reach this far into the floor, so that no faces coincide
constexpr double kDoorTop_m = 2.15;

PlanOpening doorway(double floor_m, double from_m, double to_m, double height_m = kDoorTop_m) {
  return {PlanOpening::Kind::kDoorway, from_m, to_m, floor_m - kSunk_m, floor_m + height_m, 1, 1};
}
PlanOpening window(double from_m, double to_m, double bottom_m, double top_m, int columns, int rows = 1) {
  return {PlanOpening::Kind::kWindow, from_m, to_m, bottom_m, top_m, columns, rows};
}
PlanOpening glazed_doors(double from_m, double to_m, double top_m, int columns) {
  return {PlanOpening::Kind::kGlazedDoors, from_m, to_m, -kSunk_m, top_m, columns, 1};
}

}  // namespace

HousePlan make_house_plan(const Palette& p) {
  constexpr double kUp = kUpperFloor_m, kLow = kGroundCeiling_m, kHigh = kUpperCeiling_m;
  HousePlan plan;
  plan.stair_void = {9.6, -0.05, 12.05, 3.3};
  plan.rooms = {
      {"Stairwell", {9.6, 0, 0}, {12, kHigh, 3.3}, p.plaster_white, p.oak_floor, p.ceiling, -1, false},
      {"Hall", {5.2, 0, 0}, {12, kLow, 4.4}, p.plaster_white, p.oak_floor, p.ceiling},
      {"Library", {0, 0, 0}, {5, kLow, 4.4}, p.plaster_sage, p.oak_floor, p.ceiling},
      {"Living room", {0, 0, 4.6}, {6.9, kLow, 9}, p.plaster_sand, p.oak_floor, p.ceiling},
      {"Kitchen", {7.1, 0, 4.6}, {12, kLow, 9}, p.plaster_white, p.stone_floor, p.ceiling},
      {"Landing", {5.2, kUp, 0}, {12, kHigh, 4.4}, p.plaster_white, p.oak_floor, p.ceiling},
      {"Bathroom",
       {2.3, kUp, 0},
       {5, kHigh, 4.4},
       p.plaster_white,
       p.bath_floor,
       p.ceiling,
       p.bath_wall,
       false},
      {"Dressing room", {0, kUp, 0}, {2.1, kHigh, 4.4}, p.plaster_clay, p.oak_floor, p.ceiling},
      {"Bedroom", {0, kUp, 4.6}, {6.9, kHigh, 9}, p.plaster_clay, p.oak_floor, p.ceiling},
      {"Children's room", {7.1, kUp, 4.6}, {12, kHigh, 9}, p.plaster_blue, p.oak_floor, p.ceiling},
      {"Courtyard",
       {0, kCourtyard_m, 9.25},
       {12, 6.0, 16.5},
       p.plaster_outside,
       p.paving,
       p.plaster_outside,
       -1,
       false},
  };
  constexpr double kFoot = -0.25, kRoof = kHigh + 0.1;
  plan.walls = {
      {"North wall",
       false,
       0.0,
       -0.25,
       12.25,
       kOuter_m,
       kFoot,
       kRoof,
       {window(0.8, 2.0, 0.9, 2.3, 2), window(3.0, 4.2, 0.9, 2.3, 2), doorway(0, 6.4, 7.4),
        window(7.9, 9.0, 0.9, 2.3, 2), window(10.0, 11.6, 2.3, 4.7, 2, 3), window(0.6, 1.5, 4.2, 5.3, 1),
        window(3.0, 4.2, 4.4, 5.3, 2), window(6.4, 8.4, 3.9, 5.3, 3)}},
      {"South wall",
       false,
       9.25,
       -0.25,
       12.25,
       kOuter_m,
       kFoot,
       kRoof,
       {glazed_doors(0.9, 5.9, 2.4, 4), glazed_doors(7.9, 9.1, 2.3, 1), window(9.7, 11.5, 0.95, 2.3, 3),
        window(1.2, 4.2, 3.6, 5.3, 3), window(8.3, 10.7, 3.9, 5.3, 3)}},
      {"West wall",
       true,
       -0.25,
       0.0,
       9.0,
       kOuter_m,
       kFoot,
       kRoof,
       {window(5.7, 7.7, 0.9, 2.3, 3), window(6.2, 7.6, 3.9, 5.3, 2)}},
      {"East wall",
       true,
       12.0,
       0.0,
       9.0,
       kOuter_m,
       kFoot,
       kRoof,
       {window(5.6, 7.6, 1.1, 2.3, 3), window(5.9, 7.5, 3.9, 5.3, 2)}},
      {"Spine wall",
       false,
       4.6,
       -0.1,
       12.1,
       kInner_m,
       -0.1,
       kRoof,
       {doorway(0, 1.9, 2.9), doorway(0, 5.6, 6.6), doorway(0, 7.9, 8.9), doorway(kUp, 0.7, 1.7),
        doorway(kUp, 5.6, 6.6), doorway(kUp, 8.2, 9.2)}},
      {"Library wall",
       true,
       5.0,
       -0.1,
       4.5,
       kInner_m,
       -0.1,
       kRoof,
       {doorway(0, 1.7, 2.7), doorway(kUp, 2.2, 3.2)}},
      {"Kitchen wall", true, 6.9, 4.5, 9.1, kInner_m, -0.1, kRoof, {doorway(0, 5.7, 7.5, 2.3)}},
      {"Dressing room wall", true, 2.1, -0.1, 4.5, kInner_m, kUp - 0.1, kRoof, {}},
  };
  return plan;
}

const PlanRoom* HousePlan::room_at(glm::dvec3 world_m, double margin_m) const {
  for (const double margin : {0.0, margin_m}) {
    for (const PlanRoom& room : rooms) {
      if (glm::all(glm::greaterThanEqual(world_m, room.lower_m - margin)) &&
          glm::all(glm::lessThanEqual(world_m, room.upper_m + margin)))
        return &room;
    }
  }
  return nullptr;
}

}  // namespace probewalk::procedural
