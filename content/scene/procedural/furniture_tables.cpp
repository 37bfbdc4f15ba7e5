#include "content/scene/procedural/furniture.h"

namespace probewalk::procedural {

void draw_table(Brush brush, MaterialId top, MaterialId legs, double width, double depth, double height) {
  const double x = 0.5 * width, z = 0.5 * depth;
  brush.cushion(top, {-x, height - 0.035, -z}, {x, height, z}, 0.012);
  for (const double side : {-1.0, 1.0}) {
    for (const double end : {-1.0, 1.0})
      brush.tube(
          legs,
          {{side * (x - 0.07), 0, end * (z - 0.07)}, {side * (x - 0.10), height - 0.034, end * (z - 0.10)}},
          {0.014, 0.024}, 10);
    brush.box(legs, {-x + 0.12, height - 0.095, side * (z - 0.10) - 0.010},
              {x - 0.12, height - 0.035, side * (z - 0.10) + 0.010});
    brush.box(legs, {side * (x - 0.10) - 0.010, height - 0.094, -z + 0.12},
              {side * (x - 0.10) + 0.010, height - 0.0355, z - 0.12});
  }
}

void draw_round_table(Brush brush, MaterialId top, MaterialId leg, double radius, double height) {
  brush.lathe(top, {0, height - 0.03, 0},
              {{0, 0}, {radius - 0.01, 0}, {radius, 0.012}, {radius, 0.02}, {radius - 0.01, 0.03}, {0, 0.03}},
              28);
  for (int i = 0; i < 3; ++i) {
    const double angle = 2.0944 * i + 0.4;
    const glm::dvec3 out{std::sin(angle), 0, std::cos(angle)};
    brush.rod(leg, 0.85 * radius * out, 0.45 * radius * out + glm::dvec3(0, height - 0.029, 0), 0.012);
  }
}

void draw_coffee_table(Brush brush, const Palette& p) {
  brush.cushion(p.walnut_glossy, {-0.60, 0.36, -0.35}, {0.60, 0.395, 0.35}, 0.014);
  brush.box(p.black_metal, {-0.57, 0.335, -0.32}, {0.57, 0.36, -0.30});
  brush.box(p.black_metal, {-0.57, 0.335, 0.30}, {0.57, 0.36, 0.32});
  for (const double x : {-0.57, 0.55}) {
    for (const double z : {-0.32, 0.30}) brush.box(p.black_metal, {x, 0, z}, {x + 0.02, 0.335, z + 0.02});
    brush.box(p.black_metal, {x, 0.335, -0.30}, {x + 0.02, 0.3595, 0.30});
  }
  brush.box(p.walnut, {-0.55, 0.12, -0.295}, {0.55, 0.14, 0.295});
  for (const double x : {-0.575, 0.555})
    brush.box(p.black_metal, {x, 0.105, -0.31}, {x + 0.02, 0.1195, 0.31});
}

void draw_desk(Brush brush, const Palette& p) {
  draw_table(brush, p.walnut, p.walnut, 1.5, 0.7, 0.74);
  brush.box(p.walnut, {0.28, 0.48, -0.27}, {0.66, 0.70, 0.26});
  for (const double y : {0.495, 0.60}) {
    brush.box(p.walnut, {0.295, y, 0.26}, {0.645, y + 0.09, 0.275});
    brush.box(p.brass, {0.43, y + 0.04, 0.275}, {0.51, y + 0.052, 0.29});
  }
}

void draw_rug(Brush brush, MaterialId rug, MaterialId edge, double width, double depth) {
  const double x = 0.5 * width, z = 0.5 * depth, top = 0.012;
  brush.picture(rug, {-x, top, z}, {x, top, z}, {x, top, -z}, {-x, top, -z});
  brush.quad(edge, {-x, 0, z}, {x, 0, z}, {x, top, z}, {-x, top, z});
  brush.quad(edge, {x, 0, -z}, {-x, 0, -z}, {-x, top, -z}, {x, top, -z});
  brush.quad(edge, {x, 0, z}, {x, 0, -z}, {x, top, -z}, {x, top, z});
  brush.quad(edge, {-x, 0, -z}, {-x, 0, z}, {-x, top, z}, {-x, top, -z});
}

}  // namespace probewalk::procedural
