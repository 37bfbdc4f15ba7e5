#include <algorithm>
#include <cmath>

#include "content/scene/procedural/furniture.h"
#include "content/scene/procedural/texture_canvas.h"

namespace probewalk::procedural {

void draw_books(Brush brush, const Palette& p, double width, double max_height, double depth, int seed) {
  const auto s = static_cast<std::uint32_t>(seed);
  double x = -0.5 * width;
  for (int i = 0;; ++i) {
    const double thick = 0.018 + 0.030 * hash01(i, 0, s);
    if (x + thick > 0.5 * width) break;
    const double tall = max_height * (0.70 + 0.28 * hash01(i, 1, s));
    const double deep = depth * (0.75 + 0.2 * hash01(i, 2, s));
    const double hue = (std::floor(kBookColours * hash01(i, 3, s)) + 0.5) / kBookColours;
    if (hash01(i, 4, s) < 0.06) {  // a gap, the next one leans
      x += 0.05;
      continue;
    }
    brush.box_of_colour(p.books, {x + 0.0008, 0, -0.5 * depth},
                        {x + thick - 0.0008, tall, -0.5 * depth + deep}, {hue, 0.5});
    x += thick;
  }
}

void draw_book_pile(Brush brush, const Palette& p, int count, int seed) {
  const auto s = static_cast<std::uint32_t>(seed);
  double y = 0.0;
  for (int i = 0; i < count; ++i) {
    const double thick = 0.02 + 0.02 * hash01(i, 0, s), wide = 0.13 - 0.006 * i, deep = 0.10 - 0.005 * i;
    const double hue = (std::floor(kBookColours * hash01(i, 3, s)) + 0.5) / kBookColours;
    brush.at({0, y, 0}, 30.0 * (hash01(i, 1, s) - 0.5))
        .box_of_colour(p.books, {-wide, 0.0003, -deep}, {wide, thick, deep}, {hue, 0.5});
    y += thick;
  }
}

void draw_bookcase(Brush brush, const Palette& p, MaterialId wood, double width, double height, int seed) {
  constexpr double kBoard = 0.025, kDepth = 0.30;
  const double half = 0.5 * width;
  const int shelves = static_cast<int>(std::lround(height / 0.36));
  const double step = (height - 0.08 - kBoard) / shelves;
  brush.box(wood, {-half, 0, -0.5 * kDepth}, {-half + kBoard, height, 0.5 * kDepth});
  brush.box(wood, {half - kBoard, 0, -0.5 * kDepth}, {half, height, 0.5 * kDepth});
  brush.box(wood, {-half + kBoard, 0.08, -0.5 * kDepth}, {half - kBoard, height, -0.5 * kDepth + 0.012});
  brush.box(wood, {-half + kBoard, 0, 0.5 * kDepth - 0.04}, {half - kBoard, 0.08, 0.5 * kDepth - 0.02});
  const int bays = std::max(1, static_cast<int>(std::lround(width / 0.85)));
  const double bay = (width - kBoard) / bays;
  for (int i = 0; i <= shelves; ++i) {
    const double y = 0.08 + i * step;
    brush.box(wood, {-half + kBoard, y, -0.5 * kDepth + 0.012},
              {half - kBoard, y + kBoard, 0.5 * kDepth - 0.005});
  }
  for (int b = 0; b < bays; ++b) {
    const double left = -half + b * bay;
    if (b > 0)
      brush.box(wood, {left, 0.08, -0.5 * kDepth + 0.013},
                {left + kBoard, height - kBoard, 0.5 * kDepth - 0.006});
    for (int i = 0; i < shelves; ++i) {
      const auto s = static_cast<std::uint32_t>(seed);
      const Brush shelf = brush.at({left + 0.5 * kBoard + 0.5 * bay, 0.08 + i * step + kBoard, -0.005});
      const double space = bay - kBoard - 0.02, tall = std::min(step - kBoard - 0.02, 0.29);
      const double kind = hash01(b, i, s);
      if (kind < 0.15) {
        draw_vase(Brush(shelf).at({-0.18 * space, 0, 0}), kind < 0.07 ? p.ceramic : p.terracotta, 0.22);
        draw_book_pile(Brush(shelf).at({0.22 * space, 0, 0}), p, 4, seed + 31 * i + b);
      } else if (kind < 0.40) {
        draw_books(Brush(shelf).at({-0.20 * space, 0, 0}), p, 0.58 * space, tall, 0.24,
                   seed + 17 * i + 5 * b);
        draw_vase(Brush(shelf).at({0.30 * space, 0, 0}), p.ceramic_dark, 0.16);
      } else {
        draw_books(shelf, p, space, tall, 0.24, seed + 17 * i + 5 * b);
      }
    }
  }
}

void draw_wall_shelf(Brush brush, const Palette& p, double width, int seed) {
  const double half = 0.5 * width;
  brush.box(p.oak, {-half, 0, 0}, {half, 0.03, 0.22});
  for (const double x : {-half + 0.12, half - 0.14})
    brush.box(p.black_metal, {x, -0.12, 0.0}, {x + 0.02, -0.0005, 0.02});
  draw_books(brush.at({-0.2 * width, 0.03, 0.11}), p, 0.5 * width, 0.22, 0.18, seed);
  draw_vase(brush.at({0.30 * width, 0.03, 0.11}), p.terracotta, 0.18);
}

void draw_sideboard(Brush brush, const Palette& p, MaterialId wood, double width) {
  const double half = 0.5 * width;
  for (const double x : {-half + 0.08, half - 0.08})
    for (const double z : {-0.16, 0.16}) brush.rod(p.black_metal, {x, 0, z}, {x, 0.16, z}, 0.012);
  brush.box(wood, {-half, 0.155, -0.21}, {half, 0.72, 0.19});
  brush.cushion(wood, {-half - 0.01, 0.72, -0.215}, {half + 0.01, 0.745, 0.215}, 0.008);
  const int doors = std::max(2, static_cast<int>(std::lround(width / 0.5)));
  const double door = width / doors;
  for (int i = 0; i < doors; ++i) {
    const double left = -half + i * door;
    brush.box(wood, {left + 0.006, 0.17, 0.19}, {left + door - 0.006, 0.705, 0.208});
    brush.box(p.brass, {left + 0.5 * door - 0.05, 0.62, 0.208}, {left + 0.5 * door + 0.05, 0.632, 0.224});
  }
}

void draw_wardrobe(Brush brush, const Palette& p, double width) {
  const double half = 0.5 * width;
  brush.box(p.oak, {-half, 0.05, -0.29}, {half, 2.20, 0.27});
  brush.box(p.oak, {-half + 0.03, 0, -0.27}, {half - 0.03, 0.05, 0.24});
  const int doors = static_cast<int>(std::lround(width / 0.5));
  const double door = width / doors;
  for (int i = 0; i < doors; ++i) {
    const double left = -half + i * door, grip = i % 2 == 0 ? left + door - 0.05 : left + 0.035;
    brush.box(p.oak, {left + 0.004, 0.06, 0.27}, {left + door - 0.004, 2.19, 0.29});
    brush.box(p.black_metal, {grip, 0.95, 0.29}, {grip + 0.015, 1.20, 0.315});
  }
}

void draw_clothes_rail(Brush brush, const Palette& p, double width) {
  const double half = 0.5 * width;
  for (const double x : {-half, half}) {
    brush.rod(p.black_metal, {x, 0.01, 0}, {x, 1.62, 0}, 0.012);
    brush.rod(p.black_metal, {x, 0.012, -0.24}, {x, 0.012, 0.24}, 0.012);
  }
  brush.rod(p.black_metal, {-half, 1.62, 0}, {half, 1.62, 0}, 0.012);
  const MaterialId cloths[] = {p.linen,          p.cushion_rust, p.blanket_blue, p.sofa_cloth,
                               p.armchair_cloth, p.cushion_teal, p.leather};
  const int garments = static_cast<int>(width / 0.11);
  for (int i = 0; i < garments; ++i) {
    const double x = -half + 0.12 + (width - 0.24) * i / (garments - 1.0);
    const double length = 0.75 + 0.35 * hash01(i, 0, 201);
    const MaterialId cloth = cloths[static_cast<std::size_t>(7 * hash01(i, 1, 201))];
    brush.rod(p.black_metal, {x, 1.52, 0}, {x, 1.605, 0}, 0.003, 5);
    brush.sheet(cloth, 6, 6,
                [&](double u, double v) {  // hangs from shoulders, widening, with a soft fold
                  const double z = (u - 0.5) * (0.40 + 0.10 * (1.0 - v)),
                               shoulder = 0.10 * std::abs(2.0 * u - 1.0);
                  return glm::dvec3(x + 0.018 * std::sin(9.0 * u + 2.0 * v + i),
                                    1.52 - shoulder - length * (1.0 - v), z);
                },
                {0.5, length});
  }
}

void draw_nightstand(Brush brush, const Palette& p) {
  for (const double x : {-0.19, 0.19})
    for (const double z : {-0.15, 0.15}) brush.rod(p.walnut, {x, 0, z}, {x, 0.20, z}, 0.013);
  brush.box(p.walnut, {-0.23, 0.195, -0.19}, {0.23, 0.46, 0.18});
  brush.box(p.walnut, {-0.215, 0.21, 0.18}, {0.215, 0.445, 0.195});
  brush.box(p.brass, {-0.05, 0.33, 0.195}, {0.05, 0.342, 0.21});
}

void draw_fireplace(Brush brush, const Palette& p) {
  // A breast of plaster with a hearth: four slabs around the fire, a back, a mantel.
  constexpr double kHalf = 0.75, kFire = 0.42, kTop = 0.80, kDepth = 0.36;
  brush.box(p.marble, {-kHalf, 0, 0}, {-kFire, 1.15, kDepth});
  brush.box(p.marble, {kFire, 0, 0}, {kHalf, 1.15, kDepth});
  brush.box(p.marble, {-kFire, kTop, 0}, {kFire, 1.15, kDepth});
  brush.box(p.black_metal, {-kFire, 0, 0}, {kFire, 0.10, kDepth - 0.02});
  brush.box(p.black_metal, {-kFire, 0.10, 0}, {kFire, kTop, 0.03});
  brush.cushion(p.walnut, {-kHalf - 0.06, 1.15, 0}, {kHalf + 0.06, 1.20, kDepth + 0.06}, 0.012);
  brush.box(p.black_metal, {-kHalf - 0.05, 0, kDepth}, {kHalf + 0.05, 0.02, kDepth + 0.35});
  for (int i = 0; i < 5; ++i) {
    const double a = hash01(i, 0, 211) - 0.5, b = hash01(i, 1, 211) - 0.5;
    brush.rod(p.bark, {-0.26 + 0.05 * i, 0.13 + 0.035 * i, 0.12 + 0.04 * a},
              {0.24 - 0.03 * i, 0.14 + 0.045 * i, 0.20 + 0.10 * b}, 0.03, 8);
  }
  brush.cushion(p.embers, {-0.24, 0.095, 0.09}, {0.24, 0.125, 0.26}, 0.012);
}

}  // namespace probewalk::procedural
