#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/scene/procedural/furniture.h"

namespace probewalk::procedural {
namespace {

void draw_tap(Brush brush, MaterialId metal, double height, double reach) {
  std::vector<glm::dvec3> arc{{0, 0, 0}, {0, height - 0.5 * reach, 0}};
  for (int i = 1; i <= 6; ++i) {
    const double angle = std::numbers::pi * i / 6.0;
    arc.push_back(
        {0, height - 0.5 * reach + 0.5 * reach * std::sin(angle), 0.5 * reach * (1.0 - std::cos(angle))});
  }
  brush.tube(metal, arc, std::vector<double>(arc.size(), 0.011), 8);
  brush.rod(metal, {0.05, 0, 0}, {0.05, 0.05, 0}, 0.012);
}

}  // namespace

void draw_counter(Brush brush, const Palette& p, double width, bool sink, bool hob) {
  const double half = 0.5 * width;
  brush.box(p.counter_front, {-half, 0.10, -0.30}, {half, 0.88, 0.27});
  brush.box(p.black_metal, {-half + 0.01, 0, -0.29}, {half - 0.01, 0.10, 0.22});
  const int fronts = std::max(1, static_cast<int>(std::lround(width / 0.6)));
  const double front = width / fronts;
  for (int i = 0; i < fronts; ++i) {
    const double left = -half + i * front;
    const bool drawers = i % 2 == 1;
    const int rows = drawers ? 3 : 1;
    for (int r = 0; r < rows; ++r) {
      const double bottom = 0.11 + r * 0.76 / rows, top = 0.11 + (r + 1) * 0.76 / rows - 0.006;
      brush.box(p.counter_front, {left + 0.003, bottom, 0.27}, {left + front - 0.003, top, 0.29});
      brush.box(p.brass, {left + 0.5 * front - 0.09, top - 0.06, 0.29},
                {left + 0.5 * front + 0.09, top - 0.045, 0.315});
    }
  }
  // The top, with a hole for the sink.
  const double x0 = -0.29, x1 = 0.29, z0 = -0.17, z1 = 0.19;
  if (sink) {
    brush.box(p.counter_top, {-half, 0.88, -0.30}, {x0, 0.92, 0.31});
    brush.box(p.counter_top, {x1, 0.88, -0.30}, {half, 0.92, 0.31});
    brush.box(p.counter_top, {x0, 0.88, -0.30}, {x1, 0.92, z0});
    brush.box(p.counter_top, {x0, 0.88, z1}, {x1, 0.92, 0.31});
    brush.quad(p.chrome, {x0, 0.882, z1}, {x1, 0.882, z1}, {x1, 0.882, z0}, {x0, 0.882, z0});
    draw_tap(brush.at({0, 0.92, -0.235}), p.chrome, 0.32, 0.22);
  } else {
    brush.box(p.counter_top, {-half, 0.88, -0.30}, {half, 0.92, 0.31});
  }
  if (hob) {
    brush.box(p.black_glass, {-0.36, 0.92, -0.24}, {0.36, 0.927, 0.24});
    brush.lathe(p.black_metal, {-0.17, 0.928, 0.05},
                {{0, 0}, {0.11, 0}, {0.115, 0.01}, {0.115, 0.13}, {0.10, 0.14}, {0.02, 0.15}, {0, 0.165}},
                20);
    brush.rod(p.black_metal, {-0.05, 1.035, 0.05}, {0.10, 1.05, 0.12}, 0.009);
  }
}

void draw_wall_cabinet(Brush brush, const Palette& p, double width) {
  const double half = 0.5 * width;
  brush.box(p.counter_front, {-half, 0, -0.17}, {half, 0.65, 0.15});
  const int fronts = std::max(1, static_cast<int>(std::lround(width / 0.6)));
  const double front = width / fronts;
  for (int i = 0; i < fronts; ++i) {
    const double left = -half + i * front;
    brush.box(p.counter_front, {left + 0.003, 0.004, 0.15}, {left + front - 0.003, 0.646, 0.17});
    brush.box(p.brass, {left + 0.5 * front - 0.06, 0.04, 0.17}, {left + 0.5 * front + 0.06, 0.052, 0.19});
  }
}

void draw_fridge(Brush brush, const Palette& p) {
  brush.box(p.counter_front, {-0.31, 0.06, -0.30}, {0.31, 2.15, 0.27});
  brush.box(p.black_metal, {-0.30, 0, -0.29}, {0.30, 0.06, 0.22});
  for (const auto& [bottom, top] : {std::pair{0.07, 0.80}, std::pair{0.81, 2.14}}) {
    brush.box(p.counter_front, {-0.307, bottom, 0.27}, {0.307, top, 0.292});
    brush.box(p.brass, {-0.27, bottom + 0.45 * (top - bottom), 0.292},
              {-0.25, bottom + 0.45 * (top - bottom) + 0.25, 0.32});
  }
}

void draw_bathtub(Brush brush, const Palette& p) {
  // An oval shell drawn as one closed profile: up the outside, over the rim, down the inside.
  constexpr double kLong = 0.86, kWide = 0.39;
  static const std::vector<glm::dvec2> kProfile{{0.0, 0.02},  {0.70, 0.02}, {0.80, 0.06},  {0.92, 0.35},
                                                {1.0, 0.58},  {1.0, 0.60},  {0.955, 0.60}, {0.93, 0.57},
                                                {0.84, 0.32}, {0.72, 0.15}, {0.55, 0.12},  {0.0, 0.12}};
  const auto rows = static_cast<int>(kProfile.size()) - 1;
  brush.sheet(p.ceramic, 36, rows,
              [&](double u, double v) {
                const double at = std::clamp(v * rows, 0.0, static_cast<double>(rows));
                const auto k = std::min(static_cast<std::size_t>(at), kProfile.size() - 2);
                const glm::dvec2 q = glm::mix(kProfile[k], kProfile[k + 1], at - static_cast<double>(k));
                const double angle = 2.0 * std::numbers::pi * u;
                return glm::dvec3(kLong * q.x * std::sin(angle), q.y, kWide * q.x * std::cos(angle));
              },
              {0, 0});
  brush.rod(p.chrome, {0.0, 0, -0.52}, {0.0, 0.86, -0.52}, 0.016);
  brush.rod(p.chrome, {0.0, 0.84, -0.53}, {0.0, 0.84, -0.34}, 0.012);
}

void draw_washstand(Brush brush, const Palette& p) {
  brush.box(p.oak, {-0.55, 0.35, -0.23}, {0.55, 0.80, 0.22});
  for (const double x : {-0.545, 0.005}) brush.box(p.oak, {x, 0.36, 0.22}, {x + 0.54, 0.79, 0.238});
  brush.box(p.marble, {-0.57, 0.80, -0.24}, {0.57, 0.83, 0.25});
  brush.lathe(p.ceramic, {0, 0.83, 0.02},
              {{0, 0},
               {0.14, 0.0},
               {0.20, 0.06},
               {0.215, 0.12},
               {0.20, 0.12},
               {0.185, 0.06},
               {0.12, 0.02},
               {0, 0.018}},
              26);
  draw_tap(brush.at({0, 0.83, -0.20}), p.brass, 0.28, 0.16);
}

void draw_toilet(Brush brush, const Palette& p) {
  brush.cushion(p.ceramic, {-0.18, 0.10, -0.30}, {0.18, 0.40, 0.25}, 0.12, 3);
  brush.cushion(p.ceramic, {-0.19, 0.40, -0.28}, {0.19, 0.435, 0.265}, 0.016, 3);
  brush.box(p.trim, {-0.26, 0.0, -0.42}, {0.26, 1.05, -0.29});
  brush.box(p.oak, {-0.27, 1.05, -0.42}, {0.27, 1.075, -0.28});
  brush.box(p.chrome, {-0.09, 0.86, -0.29}, {0.09, 0.98, -0.282});
}

}  // namespace probewalk::procedural
