// The schematic figures of Donow's thesis, drawn as plans there, built as rooms here. Each shows one thing
// about which probe can answer which ray; tests/content/scene/thesis_scenes_test.cpp checks that it really
// does.
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "content/scene/procedural/plain_room.h"
#include "content/scene/procedural/scenes.h"
#include "content/scene/procedural/thesis_places.h"

namespace probewalk::procedural {
namespace {

constexpr double kHeight_m = 2.8;

// A prism's inner faces. `outline` (x, z) has an even number of corners, runs from x towards z and is
// star-shaped about `centre`; walls take the colours in turn, two walls each.
void draw_star_shaped_room(Brush brush, MaterialId floor, MaterialId ceiling,
                           const std::vector<MaterialId>& walls, glm::dvec2 centre,
                           const std::vector<glm::dvec2>& outline) {
  const std::size_t count = outline.size();
  const auto at = [](glm::dvec2 p, double y) { return glm::dvec3(p.x, y, p.y); };
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec2 a = outline[i], b = outline[(i + 1) % count];
    brush.quad(walls[(i / 2) % walls.size()], at(a, 0), at(b, 0), at(b, kHeight_m), at(a, kHeight_m));
  }
  for (std::size_t i = 0; i < count; i += 2) {
    const glm::dvec2 a = outline[i], tip = outline[i + 1], b = outline[(i + 2) % count];
    brush.quad(floor, at(centre, 0), at(b, 0), at(tip, 0), at(a, 0));
    brush.quad(ceiling, at(centre, kHeight_m), at(a, kHeight_m), at(tip, kHeight_m), at(b, kHeight_m));
  }
}

// A triangular prism standing on y = 0, its corners on a circle.
void draw_wedge(Brush brush, MaterialId material, double radius_m, double height_m) {
  brush.tube(material, {{0, -0.01, 0}, {0, height_m, 0}}, {radius_m, radius_m}, 3);
}

// What tells the cells apart: a ball, a block, a wedge, a lying rod, each with its cell's colours.
void furnish_cell(Brush brush, MaterialId thing, MaterialId other, int number) {
  switch (number % 3) {
    case 0:
      brush.ball(thing, {-0.35, 0.4, -0.35}, 0.4, 24);
      brush.box(other, {0.35, -0.01, 0.2}, {0.7, 0.5, 0.55});
      break;
    case 1:
      brush.at({-0.3, 0, -0.35}, 20).box(thing, {-0.35, -0.01, -0.35}, {0.35, 0.7, 0.35});
      brush.ball(other, {-0.3, 0.9, -0.35}, 0.2, 20);
      break;
    default:
      draw_wedge(brush.at({-0.2, 0, -0.3}, 10), thing, 0.5, 1.1);
      brush.rod(other, {-0.7, 0.1, 0.6}, {0.7, 0.1, 0.6}, 0.1, 20);
      break;
  }
}

}  // namespace

std::vector<glm::dvec3> boxes::points_m() {
  std::vector<glm::dvec3> points;
  for (const double y : {0.75, 2.0})
    for (int row = -1; row <= 1; ++row)
      for (int column = 0; column < 4; ++column)
        points.push_back({kSpacing_m * (column - 1.5), y, kSpacing_m * row});
  return points;
}

Model make_closed_cells() {
  Model model;
  model.name = "closed-cells";
  const PlainColours c = add_plain_colours(model);
  const std::array<MaterialId, 6> paints{
      add_plain(model, "ochre", 0xC99A4A), add_plain(model, "brick red", 0xA8503C),
      add_plain(model, "slate", 0x4F6678), add_plain(model, "moss", 0x6F8452),
      add_plain(model, "plum", 0x74506B),  add_plain(model, "sand", 0xD8C7A3)};
  const double half_m = 0.5 * cells::kCell_m, step_m = cells::kCell_m + cells::kWall_m;
  for (int number = 0; number < cells::kColumns * cells::kRows; ++number) {
    const glm::dvec3 middle = cells::middle_m(number);
    const MaterialId paint = paints[static_cast<std::size_t>(number)];
    const std::string name = "Cell " + std::to_string(number + 1);
    PlainColours own = c;
    own.wall = own.red_wall = own.green_wall = paint;
    Brush brush = Brush(model, name).at({middle.x, 0, middle.z});
    brush.box(c.floor, {-0.5 * step_m, -0.2, -0.5 * step_m}, {0.5 * step_m, 0.0, 0.5 * step_m});
    brush.box(c.ceiling, {-0.5 * step_m, kHeight_m, -0.5 * step_m},
              {0.5 * step_m, kHeight_m + 0.2, 0.5 * step_m});
    furnish_cell(brush.object(name + " things"), paints[static_cast<std::size_t>((number + 2) % 6)],
                 paints[static_cast<std::size_t>((number + 3) % 6)], number);
    // Walls: every cell draws its own four, half the wall thick.
    Brush walls = brush.object(name + " walls");
    const double outer_m = 0.5 * step_m, low_m = -0.1, high_m = kHeight_m + 0.1;
    walls.box(paint, {-outer_m, low_m, -outer_m}, {-half_m, high_m, outer_m});
    walls.box(paint, {half_m, low_m, -outer_m}, {outer_m, high_m, outer_m});
    walls.box(paint, {-half_m, low_m, -outer_m}, {half_m, high_m, -half_m});
    walls.box(paint, {-half_m, low_m, half_m}, {half_m, high_m, outer_m});
    add_point_light(model, middle + glm::dvec3(0.2, 1.0, 0.3), 110);
    model.rooms.push_back({name,
                           middle - glm::dvec3(half_m, middle.y, half_m),
                           {middle.x + half_m, kHeight_m, middle.z + half_m}});
  }
  const glm::dvec3 first = cells::middle_m(0);
  model.start_m = glm::dvec3(first.x + 0.5, 0.0, first.z - 0.2);
  return model;
}

Model make_corridor() {
  // A hall, and a corridor that leaves it through the middle of a long wall.
  Model model;
  model.name = "corridor";
  const PlainColours c = add_plain_colours(model);
  const double half_m = corridor::kHalfWidth_m, end_m = corridor::kEnd_m;
  const std::vector<glm::dvec2> outline{{-4, 0},     {-half_m, 0}, {-half_m, end_m}, {half_m, end_m},
                                        {half_m, 0}, {4, 0},       {4, 4},           {-4, 4}};
  Brush walls(model, "Walls");
  const std::array<MaterialId, 8> paints{c.wall, c.green_wall, c.thing, c.red_wall,
                                         c.wall, c.wall,       c.wall,  c.wall};
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    walls.quad(paints[i], {a.x, 0, a.y}, {b.x, 0, b.y}, {b.x, kHeight_m, b.y}, {a.x, kHeight_m, a.y});
  }
  // Floor and ceiling in strips whose corners are the walls' corners.
  const std::array<std::array<double, 4>, 4> areas{
      {{-4, 0, -half_m, 4}, {-half_m, 0, half_m, 4}, {half_m, 0, 4, 4}, {-half_m, end_m, half_m, 0}}};
  for (const auto& [x0, z0, x1, z1] : areas) {
    walls.quad(c.floor, {x0, 0, z1}, {x1, 0, z1}, {x1, 0, z0}, {x0, 0, z0});
    walls.quad(c.ceiling, {x0, kHeight_m, z0}, {x1, kHeight_m, z0}, {x1, kHeight_m, z1}, {x0, kHeight_m, z1});
  }
  for (int i = 0; i < 4; ++i) {
    const double z = -1.2 - 1.6 * i, side = i % 2 == 0 ? -1.0 : 1.0;
    Brush(model, "Corridor lamp")
        .box(c.lamp, {side * (half_m - 0.02) - 0.02, 1.9, z - 0.12},
             {side * (half_m - 0.02) + 0.02, 2.2, z + 0.12});
  }
  Brush end(model, "Ball at the end");
  end.ball(c.red_wall, {0, 0.9, end_m + 0.6}, 0.3, 32);
  end.box(c.wall, {-0.25, 0, end_m + 0.35}, {0.25, 0.62, end_m + 0.85});
  Brush(model, "Hall block").at({-2.8, 0, 2.8}, 30).box(c.thing, {-0.5, 0, -0.4}, {0.5, 0.8, 0.4});
  Brush(model, "Hall ball").ball(c.green_wall, {2.9, 0.45, 2.6}, 0.45, 32);
  add_point_light(model, {-2.0, 2.4, 2.0}, 220);
  add_point_light(model, {2.0, 2.4, 2.0}, 220);
  add_point_light(model, {0, 2.5, end_m + 1.6}, 60);
  model.rooms = {{"Hall", {-4, 0, 0}, {4, kHeight_m, 4}},
                 {"Corridor", {-half_m, 0, end_m}, {half_m, kHeight_m, 0}}};
  model.start_m = glm::dvec3(0.0, 0.0, 2.6);
  return model;
}

Model make_star_room() {
  Model model;
  model.name = "star-room";
  const PlainColours c = add_plain_colours(model);
  const std::vector<MaterialId> paints{add_plain(model, "ochre", 0xC99A4A), c.red_wall, c.thing, c.green_wall,
                                       add_plain(model, "plum", 0x74506B)};
  std::vector<glm::dvec2> outline;
  Brush things(model, "Things in the points");
  for (int i = 0; i < 10; ++i) {
    const double angle = std::numbers::pi * (i - 1) / 5.0;
    const double radius_m = i % 2 == 0 ? star::kInnerRadius_m : star::kOuterRadius_m;
    outline.push_back(radius_m * glm::dvec2(std::cos(angle), std::sin(angle)));
    if (i % 2 == 0) continue;
    const glm::dvec2 place = 0.66 * outline.back();
    const MaterialId thing = paints[static_cast<std::size_t>(i / 2 + 2) % 5];
    if (i % 4 == 1)
      things.ball(thing, {place.x, 0.35 + 0.1 * i, place.y}, 0.16, 24);
    else
      draw_wedge(things.at({place.x, 0, place.y}, 20.0 * i), thing, 0.18, 0.5 + 0.15 * i);
  }
  draw_star_shaped_room(Brush(model, "Room"), c.floor, c.ceiling, paints, {0, 0}, outline);
  add_point_light(model, {0.3, 2.5, -0.2}, 260);
  model.rooms.push_back({"Star",
                         glm::dvec3(-star::kOuterRadius_m, 0, -star::kOuterRadius_m),
                         {star::kOuterRadius_m, kHeight_m, star::kOuterRadius_m}});
  model.start_m = glm::dvec3(0.5, 0.0, 0.4);
  return model;
}

Model make_hand_over() {
  // Two pillars, each the other's image in the middle of the room: what one hides from one probe, the other
  // probe sees.
  Model model;
  model.name = "hand-over";
  const PlainColours c = add_plain_colours(model);
  draw_plain_room(Brush(model, "Room"), c, {-4, 0, -2.5}, {4, kHeight_m, 2.5});
  Brush(model, "Pillar east").box(c.thing, {0.3, -0.01, 0.3}, {0.9, kHeight_m + 0.01, 0.9});
  Brush(model, "Pillar west").box(c.thing, {-0.9, -0.01, -0.9}, {-0.3, kHeight_m + 0.01, -0.3});
  Brush(model, "Ball east").ball(c.red_wall, {3.4, 0.35, 1.6}, 0.35, 32);
  Brush(model, "Block west")
      .at({-3.2, 0, -1.6}, 25)
      .box(c.green_wall, {-0.35, -0.01, -0.35}, {0.35, 0.9, 0.35});
  add_point_light(model, {-2.6, 2.4, 0.9}, 200);
  add_point_light(model, {2.6, 2.4, -0.9}, 200);
  model.rooms.push_back({"Room", {-4, 0, -2.5}, {4, kHeight_m, 2.5}});
  model.start_m = glm::dvec3(-3.2, 0.0, 0.0);
  return model;
}

Model make_boxed_lattice() {
  // A small open-topped box around every point of a lattice, wedges between them: a probe that stayed on its
  // point would see little but the inside of its box.
  Model model;
  model.name = "boxed-lattice";
  const PlainColours c = add_plain_colours(model);
  const glm::dvec3 upper_m = boxes::kLower_m + boxes::kSize_m;
  draw_plain_room(Brush(model, "Room"), c, boxes::kLower_m, upper_m);
  const MaterialId ochre = add_plain(model, "ochre", 0xC99A4A);
  Brush crates(model, "Boxes"), rods(model, "Hangers"), wedges(model, "Wedges");
  for (const glm::dvec3& point : boxes::points_m()) {
    const glm::dvec3 outer(boxes::kHalfBox_m), inner(boxes::kHalfBox_m - 0.02);
    const glm::dvec3 lo = point - outer, hi = point + outer;
    crates.box(ochre, lo, {hi.x, point.y - inner.y, hi.z});
    crates.box(ochre, {lo.x, point.y - inner.y, lo.z}, {point.x - inner.x, hi.y, hi.z});
    crates.box(ochre, {point.x + inner.x, point.y - inner.y, lo.z}, {hi.x, hi.y, hi.z});
    crates.box(c.thing, {point.x - inner.x, point.y - inner.y, lo.z},
               {point.x + inner.x, hi.y, point.z - inner.z});
    crates.box(c.thing, {point.x - inner.x, point.y - inner.y, point.z + inner.z},
               {point.x + inner.x, hi.y, hi.z});
    // The lid leaves a slit all around.
    crates.box(ochre, {lo.x, hi.y + 0.03, lo.z}, {hi.x, hi.y + 0.05, hi.z});
    if (point.y > 0.5 * upper_m.y)
      rods.rod(c.wall, {point.x, hi.y + 0.04, point.z}, {point.x, upper_m.y + 0.01, point.z}, 0.008, 8);
    else
      rods.rod(c.wall, {point.x, -0.01, point.z}, {point.x, lo.y + 0.01, point.z}, 0.02, 8);
  }
  for (int i = 0; i < 6; ++i) {
    const glm::dvec3 place = boxes::kLower_m + glm::dvec3(1.55 + 1.5 * (i % 3), 0.0, 1.55 + 1.5 * (i / 3));
    draw_wedge(wedges.at(place, 25.0 * i), i % 2 == 0 ? c.red_wall : c.green_wall, 0.24, 0.7 + 0.16 * i);
  }
  add_point_light(model, {boxes::kLower_m.x + 0.4, 2.5, boxes::kLower_m.z + 0.4}, 160);
  add_point_light(model, {upper_m.x - 0.4, 2.5, upper_m.z - 0.4}, 160);
  model.rooms.push_back({"Room", boxes::kLower_m, upper_m});
  model.start_m = boxes::kLower_m + glm::dvec3(0.4, 0.0, 1.5);
  return model;
}

}  // namespace probewalk::procedural
