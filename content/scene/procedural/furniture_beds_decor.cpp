#include <cmath>
#include <numbers>

#include "content/scene/procedural/furniture.h"

namespace probewalk::procedural {
namespace {

// Frame, headboard, mattress, blanket and pillows of a bed of any width, head at -z.
void draw_bed(Brush& brush, const Palette& p, MaterialId wood, MaterialId blanket, double width,
              int pillows) {
  const double x = 0.5 * width;
  for (const double side : {-1.0, 1.0})
    for (const double z : {-0.90, 0.92})
      brush.box(wood, {side * (x - 0.05) - 0.025, 0, z - 0.025},
                {side * (x - 0.05) + 0.025, 0.20, z + 0.025});
  brush.box(wood, {-x, 0.20, -1.02}, {x, 0.32, 1.02});
  brush.cushion(wood, {-x - 0.02, 0.20, -1.07}, {x + 0.02, 1.02, -1.02}, 0.015);
  brush.cushion(p.bedding, {-x + 0.015, 0.31, -1.01}, {x - 0.015, 0.53, 1.0}, 0.06, 3);
  brush.cushion(p.bedding, {-x - 0.015, 0.34, -0.52}, {x + 0.015, 0.575, 1.025}, 0.05, 3);
  brush.cushion(blanket, {-x - 0.03, 0.35, 0.20}, {x + 0.03, 0.59, 0.85}, 0.05, 3);
  const double each = width / pillows;
  for (int i = 0; i < pillows; ++i) {
    const double middle = -x + (i + 0.5) * each;
    brush.at({middle, 0.52, -0.76})
        .turned({1, 0, 0}, 14)
        .cushion(p.linen, {-0.5 * each + 0.06, 0, -0.21}, {0.5 * each - 0.06, 0.15, 0.21}, 0.072, 3);
  }
}

}  // namespace

void draw_double_bed(Brush brush, const Palette& p) {
  draw_bed(brush, p, p.walnut, p.blanket_blue, 1.64, 2);
  brush.at({0.0, 0.60, -0.50}, 8)
      .turned({1, 0, 0}, -50)
      .cushion(p.cushion_rust, {-0.2, 0, -0.05}, {0.2, 0.36, 0.05}, 0.048, 3);
}

void draw_single_bed(Brush brush, const Palette& p) {
  draw_bed(brush, p, p.oak, p.blanket_check, 0.96, 1);
}

void draw_painting(Brush brush, MaterialId painting, MaterialId frame, double width, double height) {
  const double x = 0.5 * width, y = 0.5 * height, rim = 0.03;
  brush.picture(painting, {-x, -y, 0.012}, {x, -y, 0.012}, {x, y, 0.012}, {-x, y, 0.012});
  brush.box(frame, {-x - rim, -y - rim, 0.001}, {x + rim, -y, 0.028});
  brush.box(frame, {-x - rim, y, 0.001}, {x + rim, y + rim, 0.028});
  brush.box(frame, {-x - rim, -y, 0.001}, {-x, y, 0.0275});
  brush.box(frame, {x, -y, 0.001}, {x + rim, y, 0.0275});
}

void draw_curtain(Brush brush, const Palette& p, double width, double height, double folds) {
  brush.sheet(p.curtain, static_cast<int>(folds * 10), 6,
              [=](double u, double v) {
                const double swing = 0.035 + 0.015 * (1.0 - v);  // folds open a little towards the hem
                const double wave = std::sin(2.0 * std::numbers::pi * folds * u) +
                                    0.25 * std::sin(5.0 * std::numbers::pi * folds * u + 1.0);
                return glm::dvec3((u - 0.5) * width + 0.012 * std::sin(6.0 * v + 9.0 * u),
                                  -height * (1.0 - v), swing * wave);
              },
              {1.6 * width, height});
}

void draw_curtain_rod(Brush brush, const Palette& p, double width) {
  brush.rod(p.brass, {-0.5 * width, 0.03, 0}, {0.5 * width, 0.03, 0}, 0.012);
  for (const double x : {-0.5 * width, 0.5 * width}) brush.ball(p.brass, {x, 0.03, 0}, 0.025, 10);
}

void draw_vase(Brush brush, MaterialId clay, double height) {
  const double h = height;
  brush.lathe(clay, {0, 0, 0},
              {{0, 0},
               {0.22 * h, 0},
               {0.34 * h, 0.25 * h},
               {0.30 * h, 0.55 * h},
               {0.12 * h, 0.82 * h},
               {0.16 * h, h},
               {0.13 * h, h},
               {0.09 * h, 0.82 * h},
               {0, 0.80 * h}},
              18);
}

void draw_fruit_bowl(Brush brush, const Palette& p) {
  brush.lathe(p.ceramic, {0, 0, 0},
              {{0, 0}, {0.07, 0}, {0.15, 0.06}, {0.17, 0.09}, {0.16, 0.09}, {0.13, 0.055}, {0, 0.02}}, 24);
  const glm::dvec3 places[] = {
      {0.05, 0.065, 0.03}, {-0.05, 0.065, 0.04}, {0.0, 0.065, -0.06}, {0.0, 0.12, 0.01}};
  for (int i = 0; i < 4; ++i) brush.ball(i % 2 == 0 ? p.fruit_orange : p.fruit_green, places[i], 0.042, 12);
}

void draw_tableware(Brush brush, const Palette& p) {
  brush.lathe(p.ceramic, {0, 0, 0},
              {{0, 0.0005}, {0.08, 0.0005}, {0.13, 0.018}, {0.125, 0.02}, {0.08, 0.006}, {0, 0.006}}, 22);
  brush.lathe(
      p.ceramic_dark, {0.19, 0, -0.08},
      {{0, 0.0005}, {0.025, 0.0005}, {0.036, 0.02}, {0.038, 0.085}, {0.034, 0.085}, {0.03, 0.02}, {0, 0.015}},
      16);
}

void draw_candle(Brush brush, const Palette& p, double height) {
  brush.lathe(p.brass, {0, 0, 0},
              {{0, 0}, {0.045, 0}, {0.04, 0.012}, {0.012, 0.02}, {0.012, 0.06}, {0.018, 0.065}, {0, 0.066}},
              14);
  brush.rod(p.paper, {0, 0.064, 0}, {0, height, 0}, 0.011);
}

}  // namespace probewalk::procedural
