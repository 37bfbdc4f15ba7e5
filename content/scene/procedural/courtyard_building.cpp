#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/scene/procedural/brush.h"
#include "content/scene/procedural/courtyard.h"
#include "content/scene/procedural/panel.h"

namespace probewalk::procedural::courtyard {
namespace {

constexpr double kPier_m = 0.36;   // width of the wall's foot between two arches
constexpr double kThick_m = 0.34;  // of the wall over the arches
constexpr double kWall_m = 0.3;    // of the outer walls

// One side of the yard in a frame whose x runs along the side's middle line, +z towards the yard.
struct Side {
  Brush frame;
  double half_m;  // half its length
  int bays;
};

// A round column with base and capital from y = 0 up to where the arches spring.
void draw_column(Brush brush, MaterialId stone) {
  const double r = 0.13, h = kSpring_m;
  brush.box(stone, {-0.19, -0.01, -0.19}, {0.19, 0.10, 0.19});
  brush.lathe(stone, {0, 0.10, 0},
              {{0, -0.001},
               {0.18, 0.0},
               {0.19, 0.03},
               {0.17, 0.06},
               {r, 0.09},
               {0.98 * r, 0.4 * h},
               {0.88 * r, h - 0.34},
               {0.92 * r, h - 0.32},
               {0.92 * r, h - 0.29},
               {0.17, h - 0.2},
               {0.17, h - 0.18}},
              20);
  brush.box(stone, {-0.19, h - 0.09, -0.19}, {0.19, h + 0.005, 0.19});
}

// The wall over one arch, x from 0 to kBay_m, its front in z = 0; a half circle is cut out of it.
void draw_arch(Brush brush, MaterialId front, MaterialId soffit) {
  constexpr int kPieces = 16;
  const double radius = 0.5 * (kBay_m - kPier_m), middle = 0.5 * kBay_m, left = 0.5 * kPier_m,
               back = -kThick_m;
  const auto arc = [&](int i) {
    const double angle = std::numbers::pi * (1.0 - static_cast<double>(i) / kPieces);
    return glm::dvec2(middle + radius * std::cos(angle), kSpring_m + radius * std::sin(angle));
  };
  const auto slab = [&](double x0, double x1, double y0, double y1) {
    brush.quad(front, {x0, y0, 0}, {x1, y1, 0}, {x1, kBand_m, 0}, {x0, kBand_m, 0});
    brush.quad(front, {x1, y1, back}, {x0, y0, back}, {x0, kBand_m, back}, {x1, kBand_m, back});
    brush.quad(soffit, {x0, y0, back}, {x1, y1, back}, {x1, y1, 0}, {x0, y0, 0});
  };
  slab(0, left, kSpring_m, kSpring_m);
  for (int i = 0; i < kPieces; ++i) slab(arc(i).x, arc(i + 1).x, arc(i).y, arc(i + 1).y);
  slab(kBay_m - left, kBay_m, kSpring_m, kSpring_m);
  // A raised ring of stones around the opening.
  for (int i = 0; i < kPieces; ++i) {
    const glm::dvec2 a = arc(i), b = arc(i + 1), centre(middle, kSpring_m);
    const glm::dvec2 a2 = centre + (a - centre) * 1.16, b2 = centre + (b - centre) * 1.16;
    const double rise = i % 2 == 0 ? 0.025 : 0.015;
    brush.quad(soffit, {a.x, a.y, rise}, {b.x, b.y, rise}, {b2.x, b2.y, rise}, {a2.x, a2.y, rise});
    brush.quad(soffit, {a2.x, a2.y, rise}, {b2.x, b2.y, rise}, {b2.x, b2.y, -0.001}, {a2.x, a2.y, -0.001});
    brush.quad(soffit, {a.x, a.y, -0.001}, {b.x, b.y, -0.001}, {b.x, b.y, rise}, {a.x, a.y, rise});
  }
}

void draw_arcade(const Side& side, const Palette& p) {
  Brush arches = side.frame.object("Arcade"), columns = side.frame.object("Columns");
  for (int bay = 0; bay < side.bays; ++bay) {
    const double x = -side.half_m + kBay_m * bay;
    draw_arch(arches.at({x, 0, 0.5 * kThick_m}), p.plaster_clay, p.marble);
    if (bay > 0) draw_column(columns.at({x, 0, 0}), p.marble);
  }
  Brush cornice = side.frame.object("Cornice");
  cornice.box(p.marble, {-side.half_m + 0.05, kBand_m - 0.02, -0.2},
              {side.half_m - 0.05, kBand_m + 0.06, 0.26});
  cornice.box(p.marble, {-side.half_m + 0.05, kBand_m + 0.05, -0.2},
              {side.half_m - 0.05, kGallery_m + 0.02, 0.32});
}

// Balustrade, posts and beam of the gallery, on its edge.
void draw_gallery_front(const Side& side, const Palette& p) {
  Brush rail = side.frame.object("Balustrade"), posts = side.frame.object("Gallery posts");
  const double y = kGallery_m, half = side.half_m;
  rail.box(p.walnut, {-half, y + 0.95, -0.06}, {half, y + 1.02, 0.06});
  rail.box(p.walnut, {-half, y + 0.10, -0.04}, {half, y + 0.15, 0.04});
  const int balusters = static_cast<int>(std::lround(2.0 * half / 0.2));
  for (int i = 1; i < balusters; ++i) {
    const double x = -half + 2.0 * half * i / balusters;
    rail.lathe(p.walnut, {x, y + 0.15, 0},
               {{0.016, 0}, {0.016, 0.1}, {0.036, 0.25}, {0.02, 0.45}, {0.014, 0.6}, {0.022, 0.8}}, 8);
  }
  for (int bay = 0; bay <= side.bays; ++bay) {
    const double x = -half + kBay_m * bay;
    posts.box(p.walnut, {x - 0.08, y, -0.08}, {x + 0.08, kEaves_m - 0.2, 0.08});
    posts.box(p.walnut, {x - 0.2, kEaves_m - 0.34, -0.07}, {x + 0.2, kEaves_m - 0.19, 0.07});
  }
  posts.box(p.walnut, {-half - 0.08, kEaves_m - 0.2, -0.1}, {half + 0.08, kEaves_m, 0.1});
}

// Tiles in waves, mitred at the corners, overhanging the yard; boards below.
void draw_roof(const Side& side, const Palette& p) {
  Brush roof = side.frame.object("Roof");
  const double half = side.half_m, out = kWalk_m + kWall_m, over = 0.45;
  const int waves = static_cast<int>(std::lround(2.0 * (half + out) / 0.24));
  const auto slope = [=](double u, double v, double lift) {
    const double z = glm::mix(over, -out, v), reach = half - z;  // mitre: the side grows as it goes back
    return glm::dvec3((2.0 * u - 1.0) * reach, glm::mix(kEaves_m + 0.02, kRoofTop_m, v) + lift, z);
  };
  roof.sheet(p.terracotta, 6 * waves, 1,
             [=](double u, double v) {
               return slope(u, v, 0.09 + 0.035 * std::sin(2.0 * std::numbers::pi * waves * u));
             },
             {1, 1});
  roof.sheet(p.walnut, 1, 1, [=](double u, double v) { return slope(1.0 - u, v, 0.0); }, {2.0 * half, out});
  for (int i = 0; i <= 4 * side.bays; ++i) {
    const double x = -half + 0.5 * kBay_m * i;
    if (i % 2 == 0) continue;
    roof.rod(p.walnut, {x, kEaves_m - 0.03, over}, {x, kRoofTop_m - 0.1, -kWalk_m - 0.05}, 0.045, 6);
  }
}

// The outer wall with doors below and doors above, and what frames them.
void draw_outer_wall(const Side& side, const Palette& p) {
  const double half = side.half_m + kWalk_m, width = 2.0 * half;
  Panel wall;
  wall.width_m = width, wall.height_m = kRoofTop_m + 0.3, wall.thickness_m = kWall_m;
  wall.material = [&](glm::dvec3 at) { return at.y < kGallery_m - 0.2 ? p.plaster_clay : p.plaster_sand; };
  wall.cuts_y_m = {kGallery_m - 0.1 + 0.2};
  wall.edge = p.plaster_outside;
  draw_panel(side.frame.object("Outer wall").at({-half, -0.2, -kWalk_m}), wall);
  Brush doors = side.frame.object("Doors");
  for (int bay = 0; bay < side.bays; ++bay) {
    const double x = -side.half_m + kBay_m * (bay + 0.5), z = -kWalk_m;
    for (const double y : {0.0, kGallery_m}) {
      if ((bay + (y > 0.0 ? 1 : 0)) % 2 != 0) continue;
      const double top = y + 2.15;
      doors.box(p.marble, {x - 0.62, y - 0.01, z - 0.01}, {x - 0.5, top + 0.12, z + 0.05});
      doors.box(p.marble, {x + 0.5, y - 0.01, z - 0.01}, {x + 0.62, top + 0.12, z + 0.05});
      doors.box(p.marble, {x - 0.5, top, z - 0.01}, {x + 0.5, top + 0.12, z + 0.05});
      doors.box(p.walnut, {x - 0.5, y + 0.01, z - 0.01}, {x + 0.5, top, z + 0.015});
      for (const double leaf : {-0.25, 0.25})
        for (const double panel : {0.25, 0.95, 1.65}) {
          const double tall = panel > 1.5 ? 0.35 : 0.55;
          doors.cushion(p.walnut, {x + leaf - 0.18, y + panel, z + 0.005},
                        {x + leaf + 0.18, y + panel + tall, z + 0.04}, 0.015, 1);
        }
      doors.ball(p.brass, {x + 0.05, y + 1.05, z + 0.05}, 0.028, 10);
    }
  }
}

// The four corners between the sides: piers below, floor and ceiling all around.
void draw_floors(Model& model, const Palette& p) {
  const double x = kYardX_m + kWalk_m, z = kYardZ_m + kWalk_m;
  Brush(model, "Ground").box(p.earth, {-x - 0.5, -0.6, -z - 0.5}, {x + 0.5, -0.25, z + 0.5});
  Brush(model, "Paving")
      .box(p.paving, {-kYardX_m - 0.3, -0.3, -kYardZ_m - 0.3}, {kYardX_m + 0.3, -0.02, kYardZ_m + 0.3});
  Brush walk(model, "Arcade floor"), gallery(model, "Gallery floor");
  const auto ring = [&](Brush& brush, MaterialId m, double inner, double y0, double y1) {
    const double ix = kYardX_m + inner, iz = kYardZ_m + inner;
    brush.box(m, {-x, y0, -z}, {x, y1, -iz});
    brush.box(m, {-x, y0, iz}, {x, y1, z});
    brush.box(m, {-x, y0, -iz}, {-ix, y1, iz});
    brush.box(m, {ix, y0, -iz}, {x, y1, iz});
  };
  ring(walk, p.stone_floor, -0.24, -0.3, 0.0);
  ring(gallery, p.oak_floor, -0.1, kBand_m - 0.05, kGallery_m);
  Brush piers(model, "Corner piers"), beams(model, "Arcade beams");
  for (const double sx : {-1.0, 1.0})
    for (const double sz : {-1.0, 1.0}) {
      const glm::dvec2 c{sx * kYardX_m, sz * kYardZ_m};
      piers.box(p.marble, {c.x - 0.24, -0.02, c.y - 0.24}, {c.x + 0.24, kBand_m, c.y + 0.24});
      piers.box(p.marble, {c.x - 0.29, -0.02, c.y - 0.29}, {c.x + 0.29, 0.22, c.y + 0.29});
    }
  for (int i = -5; i <= 5; ++i)
    for (const double s : {-1.0, 1.0}) {
      const double from = s * kYardZ_m, to = s * z;
      beams.box(p.walnut, {i * 1.0 - 0.06, kBand_m - 0.22, std::min(from, to)},
                {i * 1.0 + 0.06, kBand_m - 0.04, std::max(from, to)});
    }
}

}  // namespace

void build(Model& model, const Palette& p) {
  draw_floors(model, p);
  const Brush root(model, "Sides");
  const int bays_x = static_cast<int>(std::lround(2.0 * kYardX_m / kBay_m)),
            bays_z = static_cast<int>(std::lround(2.0 * kYardZ_m / kBay_m));
  const Side sides[] = {{root.at({0, 0, -kYardZ_m}, 0), kYardX_m, bays_x},
                        {root.at({0, 0, kYardZ_m}, 180), kYardX_m, bays_x},
                        {root.at({-kYardX_m, 0, 0}, 90), kYardZ_m, bays_z},
                        {root.at({kYardX_m, 0, 0}, -90), kYardZ_m, bays_z}};
  for (const Side& side : sides) {
    draw_arcade(side, p);
    draw_gallery_front(side, p);
    draw_roof(side, p);
    draw_outer_wall(side, p);
  }
}

}  // namespace probewalk::procedural::courtyard
