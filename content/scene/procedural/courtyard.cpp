// A courtyard in the manner of San Miguel, the thesis's last experiment (figure 9.4): arcades, a gallery, a
// fountain, set tables under trees.
#include "content/scene/procedural/courtyard.h"

#include <cmath>
#include <numbers>

#include "content/scene/procedural/furniture.h"
#include "content/scene/procedural/plants.h"
#include "content/scene/procedural/scenes.h"

namespace probewalk::procedural {
namespace courtyard {
namespace {

constexpr double kGround_m = -0.02;

void draw_fountain(Brush brush, const Palette& p) {
  // Eight-cornered basin on a step, a bowl on a shaft, a smaller bowl, water in all.
  brush.lathe(p.marble, {0, 0, 0}, {{0, -0.01}, {1.75, -0.01}, {1.75, 0.14}, {1.45, 0.14}, {1.45, 0.15}}, 8);
  brush.lathe(
      p.marble, {0, 0, 0},
      {{1.4, 0.1}, {1.36, 0.2}, {1.36, 0.5}, {1.44, 0.56}, {1.44, 0.62}, {1.2, 0.62}, {1.2, 0.2}, {0, 0.2}},
      8);
  brush.lathe(p.water, {0, 0.5, 0}, {{1.24, 0}, {0, 0.001}}, 24);
  brush.lathe(p.marble, {0, 0.2, 0},
              {{0.34, 0},
               {0.3, 0.1},
               {0.16, 0.3},
               {0.13, 0.6},
               {0.16, 0.8},
               {0.34, 0.92},
               {0.68, 1.06},
               {0.72, 1.12},
               {0.66, 1.12},
               {0.4, 1.02},
               {0.1, 0.98},
               {0, 0.98}},
              28);
  brush.lathe(p.water, {0, 1.28, 0}, {{0.66, 0}, {0, 0.001}}, 24);
  brush.lathe(p.marble, {0, 1.16, 0},
              {{0.12, 0},
               {0.08, 0.2},
               {0.07, 0.4},
               {0.16, 0.5},
               {0.36, 0.58},
               {0.38, 0.62},
               {0.33, 0.62},
               {0.05, 0.56},
               {0.05, 0.66},
               {0.09, 0.72},
               {0.05, 0.8},
               {0, 0.84}},
              24);
  // Four jets, thin arcs of water.
  for (int i = 0; i < 4; ++i) {
    std::vector<glm::dvec3> points;
    std::vector<double> radii;
    const double turn = 0.5 * std::numbers::pi * (i + 0.5);
    for (int k = 0; k <= 8; ++k) {
      const double t = k / 8.0, r = 0.36 + 0.6 * t;
      points.push_back({r * std::cos(turn), 1.77 + 0.32 * t - 1.56 * t * t, r * std::sin(turn)});
      radii.push_back(0.008 + 0.004 * t);
    }
    brush.tube(p.chrome, points, radii, 6);
  }
}

// A round table laid for four, its chairs pushed back a little, each differently.
void draw_set_table(Model& model, const Palette& p, glm::dvec2 at, double turn_deg, int seed) {
  const glm::dvec3 foot(at.x, kGround_m, at.y);
  draw_round_table(Brush(model, "Table").at(foot), p.marble, p.black_metal, 0.52, 0.73);
  for (int i = 0; i < 4; ++i) {
    const double yaw_deg = turn_deg + 90.0 * i + 7.0 * std::sin(3.0 * seed + i);
    const Brush place = Brush(model, "Chair").at(foot, yaw_deg);
    draw_chair(place.at({0, 0, 0.82 + 0.06 * std::sin(5.0 * seed + 2.0 * i)}, 180), p,
               seed % 2 == 0 ? p.walnut : p.black_metal);
    draw_tableware(place.object("Tableware").at({-0.06, 0.7305, 0.33}), p);
  }
  if (seed % 2 == 0)
    draw_fruit_bowl(Brush(model, "Fruit").at(foot + glm::dvec3(0, 0.7305, 0)), p);
  else
    draw_vase(Brush(model, "Vase").at(foot + glm::dvec3(0, 0.7305, 0)), p.ceramic_dark, 0.26);
}

// A square bed with a rim, and a tree in it.
void draw_tree_bed(Model& model, const Palette& p, glm::dvec2 at, MaterialId leaf, const TreeShape& shape) {
  Brush bed = Brush(model, "Tree bed").at({at.x, kGround_m, at.y});
  const double h = 0.75, w = 0.16;
  bed.box(p.marble, {-h, -0.05, -h}, {h, 0.4, -h + w});
  bed.box(p.marble, {-h, -0.05, h - w}, {h, 0.4, h});
  bed.box(p.marble, {-h, -0.05, -h + w}, {-h + w, 0.4, h - w});
  bed.box(p.marble, {h - w, -0.05, -h + w}, {h, 0.4, h - w});
  bed.box(p.earth, {-h + w, -0.05, -h + w}, {h - w, 0.33, h - w});
  draw_tree(Brush(model, "Tree").at({at.x, 0.3, at.y}), p, leaf, shape);
  draw_grass_tufts(Brush(model, "Tufts").at({at.x, 0.31, at.y}), p, 1.0, 1.0, 9, shape.seed + 1);
}

}  // namespace

void furnish(Model& model, const Palette& p) {
  draw_fountain(Brush(model, "Fountain").at({0, kGround_m, 0}), p);
  TreeShape tree;
  tree.height_m = 5.8, tree.leaves = 5200, tree.leaf_m = 0.2, tree.seed = 21, tree.trunk_radius_m = 0.15;
  draw_tree_bed(model, p, {-4.0, 2.9}, p.leaf, tree);
  tree.height_m = 5.0, tree.leaves = 4200, tree.seed = 22;
  draw_tree_bed(model, p, {4.1, -3.0}, p.leaf_olive, tree);
  const glm::dvec2 tables[] = {{-3.9, -2.9}, {-1.3, -3.4}, {-3.6, 0.3}, {3.9, 0.6}, {3.7, 3.3}, {0.9, 3.5}};
  for (int i = 0; i < 6; ++i) draw_set_table(model, p, tables[i], 23.0 * i, i);
  int seed = 700;
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < 3; ++i) {
      const double x = -4.0 + 4.0 * i;
      draw_potted_plant(Brush(model, "Pot").at({x, kGround_m, side * (kYardZ_m - 0.42)}), p, p.terracotta,
                        0.8 + 0.2 * i, static_cast<std::uint32_t>(++seed));
      draw_potted_plant(Brush(model, "Arcade pot").at({x + 1.6, 0.0, side * (kYardZ_m + kWalk_m - 0.45)}), p,
                        i == 1 ? p.ceramic_dark : p.terracotta, 1.3, static_cast<std::uint32_t>(++seed));
      draw_potted_plant(Brush(model, "Gallery pot").at({x - 1.0, kGallery_m, side * (kYardZ_m + 0.5)}), p,
                        p.terracotta, 0.9, static_cast<std::uint32_t>(++seed));
    }
    draw_bench(Brush(model, "Bench").at({side * (kYardX_m + kWalk_m - 0.4), 0.0, -2.0}, -90.0 * side), p,
               p.walnut, 1.6);
    draw_bench(Brush(model, "Bench").at({side * (kYardX_m + kWalk_m - 0.4), 0.0, 2.0}, -90.0 * side), p,
               p.walnut, 1.6);
  }
  for (int i = -2; i <= 2; i += 2)
    for (const double side : {-1.0, 1.0})
      draw_globe_pendant(
          Brush(model, "Lantern").at({2.0 * i + 1.0, kBand_m - 0.05, side * (kYardZ_m + 0.5 * kWalk_m)}), p,
          0.6, 0.12, 70);
  for (const double side : {-1.0, 1.0})
    draw_globe_pendant(Brush(model, "Lantern").at({side * (kYardX_m + 0.5 * kWalk_m), kBand_m - 0.05, 0}), p,
                       0.6, 0.12, 70);
}

}  // namespace courtyard

Model make_courtyard() {
  Model model;
  model.name = "courtyard";
  const Palette p = make_palette(model);
  courtyard::build(model, p);
  courtyard::furnish(model, p);
  ModelLight sun;
  sun.name = "Sun", sun.kind = ModelLight::Kind::kDirectional;
  sun.direction = glm::normalize(glm::dvec3(0.42, -0.85, 0.36)), sun.color = {1.0f, 0.93f, 0.80f},
  sun.intensity = 1800.0;
  model.lights.push_back(sun);
  model.sky = {{80.0f, 140.0f, 280.0f}, {280.0f, 320.0f, 370.0f}, {110.0f, 112.0f, 95.0f}};
  using namespace courtyard;
  const double x = kYardX_m + kWalk_m, z = kYardZ_m + kWalk_m;
  model.rooms.push_back({"Courtyard", {-x, -0.02, -z}, {x, 7.5, z}});
  model.start_m = glm::dvec3(-1.6, kGround_m, 1.9);
  return model;
}

}  // namespace probewalk::procedural
