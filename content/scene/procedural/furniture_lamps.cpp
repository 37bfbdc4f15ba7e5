#include <cmath>

#include "content/scene/procedural/furniture.h"

namespace probewalk::procedural {
namespace {

constexpr glm::vec3 kWarm{1.0f, 0.86f,
                          0.68f};  // between a bulb and white, as an eye adapted to the room sees it

void add_bulb(const Brush& brush, glm::dvec3 local_m, double candela) {
  ModelLight light;
  light.name = "Bulb " + std::to_string(brush.model().lights.size() + 1);
  light.position_m = brush.world(local_m);
  light.color = kWarm;
  light.intensity = candela;
  brush.model().lights.push_back(light);
}

// An open shade of cloth: a single layer, narrower at the top.
void draw_shade(Brush& brush, const Palette& p, double bottom, double height, double bottom_radius,
                double top_radius) {
  brush.lathe(p.lamp_shade, {0, bottom, 0}, {{bottom_radius, 0}, {top_radius, height}}, 24);
}

}  // namespace

void draw_floor_lamp(Brush brush, const Palette& p, double candela) {
  brush.lathe(p.black_metal, {0, 0, 0}, {{0, 0}, {0.15, 0}, {0.15, 0.015}, {0.02, 0.03}, {0, 0.03}}, 20);
  brush.rod(p.black_metal, {0, 0.025, 0}, {0, 1.48, 0}, 0.010);
  draw_shade(brush, p, 1.32, 0.30, 0.23, 0.17);
  add_bulb(brush, {0, 1.56, 0}, candela);
}

void draw_table_lamp(Brush brush, const Palette& p, double candela) {
  brush.lathe(p.ceramic, {0, 0, 0},
              {{0, 0}, {0.055, 0}, {0.085, 0.06}, {0.075, 0.14}, {0.02, 0.20}, {0, 0.20}}, 16);
  brush.rod(p.brass, {0, 0.195, 0}, {0, 0.27, 0}, 0.008);
  draw_shade(brush, p, 0.24, 0.19, 0.15, 0.10);
  add_bulb(brush, {0, 0.36, 0}, candela);
}

void draw_pendant(Brush brush, const Palette& p, double drop, double candela) {
  brush.rod(p.black_metal, {0, -drop + 0.20, 0}, {0, 0.0, 0}, 0.004, 6);
  brush.lathe(p.black_metal, {0, -0.03, 0}, {{0, 0}, {0.05, 0.005}, {0.05, 0.03}}, 16);
  // A spun dome, open below: outside dark metal, a glowing disc in its mouth.
  brush.lathe(p.black_metal, {0, -drop, 0},
              {{0.225, 0}, {0.22, 0.05}, {0.16, 0.14}, {0.05, 0.20}, {0.015, 0.22}, {0, 0.22}}, 28);
  brush.lathe(p.ceiling_lamp, {0, -drop + 0.03, 0}, {{0, 0}, {0.17, 0}}, 24);
  add_bulb(brush, {0, -drop - 0.01, 0}, candela);
}

void draw_globe_pendant(Brush brush, const Palette& p, double drop, double radius, double candela) {
  brush.rod(p.brass, {0, -drop + radius, 0}, {0, 0, 0}, 0.005, 6);
  brush.lathe(p.brass, {0, -0.03, 0}, {{0, 0}, {0.05, 0.005}, {0.05, 0.03}}, 16);
  brush.lathe(p.brass, {0, -drop + 0.93 * radius, 0}, {{0.38 * radius, 0}, {0.30 * radius, 0.05}, {0, 0.06}},
              16);
  brush.ball(p.lamp_globe, {0, -drop, 0}, radius, 20);
  add_bulb(brush, {0, -drop - radius - 0.22, 0},
           candela);  // well below: the globe's shadow on the ceiling stays small
}

void draw_ceiling_lamp(Brush brush, const Palette& p, double candela) {
  brush.lathe(p.brass, {0, -0.04, 0}, {{0.215, 0}, {0.215, 0.04}}, 28);
  brush.lathe(p.ceiling_lamp, {0, -0.07, 0}, {{0, 0}, {0.15, 0.01}, {0.21, 0.04}}, 28);
  add_bulb(brush, {0, -0.12, 0}, candela);
}

void draw_reading_spot(Brush brush, const Palette& p, double candela) {
  brush.lathe(p.black_metal, {0, 0, 0}, {{0, 0}, {0.09, 0}, {0.09, 0.015}, {0, 0.02}}, 20);
  brush.rod(p.brass, {0, 0.015, 0}, {-0.05, 0.34, -0.02}, 0.008);
  brush.rod(p.brass, {-0.05, 0.34, -0.02}, {0.16, 0.46, 0.06}, 0.008);
  Brush head = brush.at({0.16, 0.45, 0.06});
  head.lathe(p.black_metal, {0, -0.08, 0}, {{0.085, 0}, {0.07, 0.05}, {0.025, 0.10}, {0, 0.105}}, 18);
  head.lathe(p.lamp_globe, {0, -0.06, 0}, {{0, 0}, {0.05, 0}}, 14);
  ModelLight light;
  light.name = "Reading spot " + std::to_string(brush.model().lights.size() + 1);
  light.kind = ModelLight::Kind::kSpot;
  light.position_m = head.world({0, -0.085, 0});
  light.direction = {0, -1, 0};
  light.color = kWarm;
  light.intensity = candela;
  light.inner_cone_rad = 0.55, light.outer_cone_rad = 1.0;
  brush.model().lights.push_back(light);
}

}  // namespace probewalk::procedural
