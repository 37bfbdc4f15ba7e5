#include <algorithm>

#include "content/scene/procedural/furniture.h"

namespace probewalk::procedural {

void draw_sofa(Brush brush, const Palette& p, double width) {
  const double half = 0.5 * width, arm = 0.20;
  for (const double x : {-half + 0.10, half - 0.10})
    for (const double z : {-0.36, 0.36}) brush.rod(p.walnut, {x, 0, z}, {x, 0.14, z}, 0.02);
  brush.cushion(p.sofa_cloth, {-half, 0.13, -0.44}, {half, 0.30, 0.44}, 0.04);
  brush.cushion(p.sofa_cloth, {-half, 0.24, -0.46}, {half, 0.80, -0.20}, 0.09, 3);
  for (const double side : {-1.0, 1.0}) {
    const double outer = side * half, inner = side * (half - arm);
    brush.cushion(p.sofa_cloth, {std::min(outer, inner), 0.24, -0.45}, {std::max(outer, inner), 0.62, 0.46},
                  0.07, 3);
  }
  const int seats = width > 1.9 ? 3 : 2;
  const double seat = (width - 2 * arm) / seats;
  for (int i = 0; i < seats; ++i) {
    const double left = -half + arm + i * seat;
    brush.cushion(p.sofa_cloth, {left + 0.006, 0.285, -0.24}, {left + seat - 0.006, 0.45, 0.46}, 0.05, 3);
    brush.at({left + 0.5 * seat, 0.44, -0.17})
        .turned({1, 0, 0}, -12)
        .cushion(p.sofa_cloth, {-0.5 * seat + 0.012, 0.0, -0.07}, {0.5 * seat - 0.012, 0.42, 0.10}, 0.07, 3);
  }
  brush.at({-half + arm + 0.24, 0.455, 0.05}, 12)
      .turned({1, 0, 0}, -24)
      .cushion(p.cushion_rust, {-0.21, 0, -0.06}, {0.21, 0.40, 0.06}, 0.058, 3);
  brush.at({half - arm - 0.26, 0.455, 0.04}, -16)
      .turned({1, 0, 0}, -26)
      .cushion(p.cushion_teal, {-0.21, 0, -0.06}, {0.21, 0.40, 0.06}, 0.058, 3);
}

void draw_armchair(Brush brush, const Palette& p, MaterialId cloth) {
  for (const double x : {-0.30, 0.30})
    for (const double z : {-0.30, 0.30}) brush.rod(p.walnut, {1.1 * x, 0, 1.1 * z}, {x, 0.25, z}, 0.015);
  brush.cushion(cloth, {-0.38, 0.22, -0.36}, {0.38, 0.34, 0.38}, 0.05, 3);
  brush.cushion(cloth, {-0.29, 0.33, -0.26}, {0.29, 0.46, 0.40}, 0.06, 3);
  brush.at({0, 0.28, -0.28})
      .turned({1, 0, 0}, -13)
      .cushion(cloth, {-0.36, 0, -0.10}, {0.36, 0.66, 0.07}, 0.08, 3);
  for (const double x : {-0.36, 0.36})
    brush.cushion(cloth, {x - 0.07, 0.28, -0.34}, {x + 0.07, 0.60, 0.37}, 0.065, 3);
}

void draw_chair(Brush brush, const Palette&, MaterialId wood) {
  constexpr double kLeg = 0.013;  // half the width of a leg
  for (const double x : {-0.19, 0.19}) {
    brush.box(wood, {x - kLeg, 0.0, 0.17}, {x + kLeg, 0.435, 0.17 + 2 * kLeg});
    brush.box(wood, {x - kLeg, 0.0, -0.20}, {x + kLeg, 0.435, -0.20 + 2 * kLeg});
    brush.at({x, 0.43, -0.187}).turned({1, 0, 0}, -8).box(wood, {-kLeg, 0.0, -kLeg}, {kLeg, 0.43, kLeg});
    brush.box(wood, {x - 0.008, 0.20, -0.18}, {x + 0.008, 0.222, 0.175});
  }
  brush.box(wood, {-0.178, 0.22, -0.194}, {0.178, 0.242, -0.180});
  brush.cushion(wood, {-0.22, 0.43, -0.215}, {0.22, 0.462, 0.225}, 0.014);
  const Brush back = brush.at({0, 0.43, -0.187}).turned({1, 0, 0}, -8);
  Brush(back).cushion(wood, {-0.215, 0.36, -0.016}, {0.215, 0.445, 0.016}, 0.012);
  for (const double x : {-0.115, -0.038, 0.038, 0.115})
    Brush(back).rod(wood, {x, 0.02, 0}, {x, 0.37, 0}, 0.007, 6);
}

void draw_stool(Brush brush, const Palette& p, double height) {
  for (const double x : {-1.0, 1.0})
    for (const double z : {-1.0, 1.0}) {
      brush.rod(p.black_metal, {0.20 * x, 0, 0.20 * z}, {0.12 * x, height - 0.03, 0.12 * z}, 0.011, 6);
    }
  const double ring = 0.32 * height, reach = 0.20 - 0.08 * 0.32;
  const glm::dvec3 corners[4] = {
      {-reach, ring, -reach}, {reach, ring, -reach}, {reach, ring, reach}, {-reach, ring, reach}};
  for (int i = 0; i < 4; ++i) brush.rod(p.black_metal, corners[i], corners[(i + 1) % 4], 0.008, 6);
  brush.lathe(p.oak, {0, height - 0.035, 0}, {{0, 0}, {0.165, 0}, {0.175, 0.012}, {0.17, 0.03}, {0.0, 0.035}},
              20);
}

void draw_bench(Brush brush, const Palette&, MaterialId wood, double width) {
  const double half = 0.5 * width;
  for (int slat = 0; slat < 4; ++slat) {
    const double z = -0.19 + 0.10 * slat;
    brush.box(wood, {-half, 0.42, z}, {half, 0.45, z + 0.08});
  }
  for (const double x : {-half + 0.12, half - 0.16}) {
    for (const double z : {-0.17, 0.14}) brush.box(wood, {x, 0, z}, {x + 0.04, 0.38, z + 0.04});
    brush.box(wood, {x, 0.38, -0.18}, {x + 0.04, 0.42, 0.19});
  }
}

}  // namespace probewalk::procedural
