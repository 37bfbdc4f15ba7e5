#include "content/scene/procedural/panel.h"
#include "content/scene/procedural/plain_room.h"
#include "content/scene/procedural/plants.h"
#include "content/scene/procedural/scenes.h"

namespace probewalk::procedural {
Model make_box_room() {
  Model model;
  model.name = "box-room";
  const PlainColours c = add_plain_colours(model);
  draw_plain_room(Brush(model, "Room"), c, {-2.0, 0, -2.0}, {2.0, 2.6, 2.0});
  Brush(model, "Block").at({-0.7, 0, -0.8}, 25).box(c.thing, {-0.4, 0, -0.4}, {0.4, 0.9, 0.4});
  add_point_light(model, {0.3, 2.3, 0.2}, 250);
  model.rooms.push_back({"Room", {-2.0, 0, -2.0}, {2.0, 2.6, 2.0}});
  model.start_m = glm::dvec3(0.8, 0.0, 1.2);
  return model;
}

Model make_two_rooms() {
  // West room x -5..0, east room x 0.2..5, a doorway 1 m wide in the wall between.
  Model model;
  model.name = "two-rooms";
  const PlainColours c = add_plain_colours(model);
  Brush outer(model, "Outer walls");
  outer.box(c.wall, {-5.2, -0.1, -2.2}, {5.2, 2.8, -2.0});
  outer.box(c.wall, {-5.2, -0.1, 2.0}, {5.2, 2.8, 2.2});
  outer.box(c.red_wall, {-5.2, -0.1, -2.0}, {-5.0, 2.8, 2.0});
  outer.box(c.green_wall, {5.0, -0.1, -2.0}, {5.2, 2.8, 2.0});
  Brush(model, "Floor").box(c.floor, {-5.1, -0.2, -2.1}, {5.1, 0, 2.1});
  Brush(model, "Ceiling").box(c.ceiling, {-5.1, 2.6, -2.1}, {5.1, 2.75, 2.1});
  Panel middle;
  middle.width_m = 4.2, middle.height_m = 2.8, middle.thickness_m = 0.2;
  middle.openings = {{1.9, 0.09, 2.9, 2.25}};
  middle.material = [&](glm::dvec3) { return c.wall; };
  middle.edge = c.ceiling;
  draw_panel(Brush(model, "Middle wall").at({0.0, -0.1, -2.1}, -90), middle);
  Brush(model, "Table").at({-3.2, 0, -0.9}).box(c.thing, {-0.6, 0.7, -0.35}, {0.6, 0.74, 0.35});
  Brush legs(model, "Table legs");
  for (const double x : {-3.75, -2.65})
    for (const double z : {-1.2, -0.6})
      legs.box(c.thing, {x - 0.013, 0, z - 0.013}, {x + 0.013, 0.7, z + 0.013});
  Brush(model, "Column").rod(c.thing, {3.2, -0.01, 0.6}, {3.2, 2.61, 0.6}, 0.2, 24);
  Brush(model, "Lamp panel").box(c.lamp, {-2.9, 2.55, -0.3}, {-2.1, 2.61, 0.3});
  add_point_light(model, {2.6, 2.2, -0.6}, 220);
  model.rooms = {{"West room", {-5, 0, -2}, {0, 2.6, 2}}, {"East room", {0.2, 0, -2}, {5, 2.6, 2}}};
  model.start_m = glm::dvec3(-1.5, 0.0, 0.8);
  return model;
}

Model make_lattice() {
  // A grille of 2 cm bars, 12 cm apart, across the middle of a room, and a second one behind it, turned.
  Model model;
  model.name = "lattice";
  const PlainColours c = add_plain_colours(model);
  draw_plain_room(Brush(model, "Room"), c, {-3.0, 0, -3.0}, {3.0, 2.8, 3.0});
  constexpr double kBar_m = 0.01;  // half a bar
  Brush grille(model, "Grille");
  for (int i = 0; i <= 30; ++i) {
    const double x = -1.8 + 0.12 * i;
    grille.box(c.thing, {x - kBar_m, 0.1, -kBar_m}, {x + kBar_m, 2.5, kBar_m});
  }
  for (int j = 0; j <= 20; ++j) {
    const double y = 0.1 + 0.12 * j;
    grille.box(c.thing, {-1.81, y - kBar_m, kBar_m}, {1.81, y + kBar_m, 3 * kBar_m});
  }
  Brush turned = Brush(model, "Turned grille").at({0, 1.3, -1.4}, 20);
  for (int i = -9; i <= 9; ++i) {
    turned.rod(c.red_wall, {0.12 * i - 0.6, -1.0, 0}, {0.12 * i + 0.6, 1.0, 0}, kBar_m, 6);
    turned.rod(c.red_wall, {0.12 * i + 0.6, -1.0, 0.03}, {0.12 * i - 0.6, 1.0, 0.03}, kBar_m, 6);
  }
  add_point_light(model, {1.2, 2.4, 1.6}, 300);
  add_point_light(model, {-1.5, 2.4, -2.2}, 200);
  model.rooms.push_back({"Room", {-3, 0, -3}, {3, 2.8, 3}});
  model.start_m = glm::dvec3(0.5, 0.0, 2.2);
  return model;
}

Model make_grove() {
  // Trees and bushes on open ground under a sky.
  Model model;
  model.name = "grove";
  const Palette p = make_palette(model);
  Brush(model, "Ground").box(p.grass, {-8, -0.3, -8}, {8, 0, 8});
  int number = 0;
  for (const glm::dvec2 at :
       {glm::dvec2(-3.5, -3), {2.8, -4.2}, {4.5, 1.8}, {-4.4, 3.2}, {0.2, 5.6}, {-0.6, -6.2}}) {
    TreeShape shape;
    shape.height_m = 4.2 + 0.35 * number, shape.leaves = 1400,
    shape.seed = static_cast<std::uint32_t>(300 + number);
    draw_tree(Brush(model, "Tree").at({at.x, 0, at.y}), p, number % 2 == 0 ? p.leaf : p.leaf_olive, shape);
    draw_bush(Brush(model, "Bush").at({0.72 * at.y, 0.0, -0.8 * at.x}), p, p.leaf_dark, {1.3, 1.0, 1.2}, 350,
              static_cast<std::uint32_t>(400 + number));
    ++number;
  }
  draw_grass_tufts(Brush(model, "Tufts").at({0, 0, 0}), p, 12, 12, 90, 501);
  ModelLight sun;
  sun.name = "Sun", sun.kind = ModelLight::Kind::kDirectional;
  sun.direction = glm::normalize(glm::dvec3(-0.4, -0.8, 0.45)), sun.color = {1.0f, 0.95f, 0.85f},
  sun.intensity = 6000.0;
  model.lights.push_back(sun);
  model.sky = {{350.0f, 560.0f, 950.0f}, {1200.0f, 1300.0f, 1400.0f}, {300.0f, 320.0f, 220.0f}};
  model.rooms.push_back({"Grove", {-8, 0, -8}, {8, 7, 8}});
  model.start_m = glm::dvec3(0.0, 0.0, 1.0);
  return model;
}

}  // namespace probewalk::procedural
