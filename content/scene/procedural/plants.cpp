#include "content/scene/procedural/plants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/scene/procedural/texture_canvas.h"

namespace probewalk::procedural {
namespace {

// A stream of numbers in [0, 1) that belongs to one plant.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : seed_(seed) {}
  double roll() { return hash01(count_++, 7, seed_); }
  double between(double low, double high) { return low + (high - low) * roll(); }
  glm::dvec3 direction() {
    const double y = between(-1, 1), angle = between(0, 2.0 * std::numbers::pi), r = std::sqrt(1.0 - y * y);
    return {r * std::cos(angle), y, r * std::sin(angle)};
  }

 private:
  std::uint32_t seed_;
  std::int64_t count_ = 0;
};

// One quad that shows a whole twig, its stem at `foot`, growing along `axis`, lying flat towards `facing`.
void draw_leaf(Brush& brush, MaterialId leaf, glm::dvec3 foot, glm::dvec3 axis, glm::dvec3 facing,
               double size) {
  const glm::dvec3 up = glm::normalize(axis) * size;
  const glm::dvec3 across = glm::cross(axis, facing);
  const double length = glm::length(across);
  const glm::dvec3 right = (length > 1e-6 ? across / length : glm::dvec3(1, 0, 0)) * (0.5 * size);
  brush.picture(leaf, foot - right, foot + right, foot + right + up, foot - right + up);
}

struct Twig {
  glm::dvec3 tip, direction;
};

// A branch that bends upwards and splits; collects the places where leaves grow.
void grow(Brush& brush, const Palette& p, Dice& dice, glm::dvec3 foot, glm::dvec3 direction, double length,
          double radius, int depth, std::vector<Twig>& twigs) {
  std::vector<glm::dvec3> points{foot};
  std::vector<double> radii{radius};
  constexpr int kPieces = 4;
  glm::dvec3 heading = direction;
  for (int i = 1; i <= kPieces; ++i) {
    heading = glm::normalize(heading + 0.16 * dice.direction() + glm::dvec3(0, depth == 0 ? 0.10 : 0.05, 0));
    points.push_back(points.back() + heading * (length / kPieces));
    radii.push_back(radius * (1.0 - 0.42 * i / kPieces));
    if (depth >= 2) twigs.push_back({points.back(), heading});
  }
  brush.tube(p.bark, points, radii, depth == 0 ? 12 : (depth == 1 ? 8 : 5));
  if (depth == 3) return;
  const int children = depth == 0 ? 6 : (depth == 1 ? 5 : 3);
  for (int i = 0; i < children; ++i) {
    const double at = i == 0 ? kPieces : dice.between(depth == 0 ? 2.6 : 1.6, kPieces);
    const auto k = std::min(static_cast<std::size_t>(at), points.size() - 2);
    const glm::dvec3 start = glm::mix(points[k], points[k + 1], at - static_cast<double>(k));
    const double turn = 2.0 * std::numbers::pi * (i + dice.between(-0.3, 0.3)) / children;
    const glm::dvec3 side =
        glm::normalize(glm::cross(heading, glm::dvec3(std::cos(turn), 0.2, std::sin(turn))));
    const glm::dvec3 out = glm::normalize(heading * (i == 0 ? 1.2 : 0.55) + side * dice.between(0.6, 1.0));
    grow(brush, p, dice, start, out, length * dice.between(0.52, 0.70), radii[k] * 0.62, depth + 1, twigs);
  }
}

}  // namespace

void draw_tree(Brush brush, const Palette& p, MaterialId leaf, const TreeShape& shape) {
  Dice dice(shape.seed);
  std::vector<Twig> twigs;
  grow(brush, p, dice, {0, -0.05, 0}, glm::normalize(glm::dvec3(0.05, 1, 0.03)), 0.46 * shape.height_m,
       shape.trunk_radius_m, 0, twigs);
  for (int i = 0; i < shape.leaves; ++i) {
    const Twig& twig = twigs[static_cast<std::size_t>(dice.roll() * static_cast<double>(twigs.size()))];
    const glm::dvec3 axis = glm::normalize(twig.direction + 1.1 * dice.direction());
    const glm::dvec3 foot = twig.tip + dice.between(0.0, 0.5 * shape.leaf_m) * dice.direction();
    const glm::dvec3 facing = glm::normalize(glm::dvec3(0, 1, 0) + 0.9 * dice.direction());
    draw_leaf(brush, leaf, foot, axis, facing, shape.leaf_m * dice.between(0.7, 1.15));
  }
}

void draw_potted_plant(Brush brush, const Palette& p, MaterialId pot, double height_m, std::uint32_t seed) {
  Dice dice(seed);
  const double r = 0.10 + 0.05 * height_m, pot_height = 0.16 + 0.12 * height_m;
  brush.lathe(pot, {0, 0, 0},
              {{0, 0}, {0.78 * r, 0}, {r, pot_height}, {0.9 * r, pot_height}, {0.88 * r, pot_height - 0.03}},
              20);
  brush.lathe(p.earth, {0, pot_height - 0.031, 0}, {{0.885 * r, 0}, {0, 0.001}}, 20);
  const int stems = 3 + static_cast<int>(2 * height_m);
  for (int s = 0; s < stems; ++s) {
    const double turn = 2.0 * std::numbers::pi * s / stems + dice.between(-0.3, 0.3);
    const glm::dvec3 lean{std::cos(turn), 0, std::sin(turn)};
    std::vector<glm::dvec3> points;
    std::vector<double> radii;
    const double tall = (height_m - pot_height) * dice.between(0.55, 0.9),
                 reach = height_m * dice.between(0.06, 0.20);
    constexpr int kPieces = 5;
    for (int i = 0; i <= kPieces; ++i) {
      const double t = static_cast<double>(i) / kPieces;
      points.push_back(lean * (0.25 * r + reach * t * t) +
                       glm::dvec3(0, pot_height - 0.04 + (tall + 0.04) * t, 0));
      radii.push_back(0.009 * (1.0 - 0.6 * t) * (0.7 + 0.5 * height_m));
    }
    brush.tube(p.bark, points, radii, 6);
    for (int i = 2; i <= kPieces; ++i) {
      for (int l = 0; l < 4; ++l) {
        const double around = turn + 1.57 * l + 0.8 * i + dice.between(-0.3, 0.3);
        const glm::dvec3 axis =
            glm::normalize(glm::dvec3(std::cos(around), dice.between(0.1, 0.9), std::sin(around)));
        draw_leaf(brush, p.leaf_dark, points[static_cast<std::size_t>(i)], axis,
                  glm::normalize(glm::dvec3(0, 1, 0) + 0.4 * dice.direction()),
                  dice.between(0.16, 0.26) * (0.55 + 0.45 * height_m));
      }
    }
  }
}

void draw_bush(Brush brush, const Palette& p, MaterialId leaf, glm::dvec3 size_m, int leaves,
               std::uint32_t seed) {
  Dice dice(seed);
  for (int i = 0; i < 9; ++i) {
    const glm::dvec3 d = dice.direction();
    brush.tube(p.bark,
               {{0.1 * d.x, -0.02, 0.1 * d.z}, {0.3 * size_m.x * d.x, 0.6 * size_m.y, 0.3 * size_m.z * d.z}},
               {0.012, 0.005}, 5);
  }
  for (int i = 0; i < leaves; ++i) {
    const glm::dvec3 d = dice.direction();
    const double shell = std::cbrt(dice.between(0.25, 1.0));
    const glm::dvec3 foot = 0.5 * size_m * d * shell + glm::dvec3(0, 0.5 * size_m.y, 0);
    draw_leaf(brush, leaf, foot, glm::normalize(d + 0.8 * dice.direction() + glm::dvec3(0, 0.4, 0)),
              glm::normalize(d + glm::dvec3(0, 0.7, 0)), dice.between(0.10, 0.17));
  }
}

void draw_grass_tufts(Brush brush, const Palette& p, double width_m, double depth_m, int tufts,
                      std::uint32_t seed) {
  Dice dice(seed);
  for (int t = 0; t < tufts; ++t) {
    const glm::dvec3 foot{(dice.roll() - 0.5) * width_m, 0.0, (dice.roll() - 0.5) * depth_m};
    for (int b = 0; b < 12; ++b) {
      const double turn = dice.between(0, 2.0 * std::numbers::pi), tall = dice.between(0.25, 0.5),
                   reach = dice.between(0.06, 0.22);
      const glm::dvec3 lean{std::cos(turn), 0, std::sin(turn)}, side{-0.006 * lean.z, 0, 0.006 * lean.x};
      const glm::dvec3 knee = foot + 0.3 * reach * lean + glm::dvec3(0, 0.6 * tall, 0),
                       tip = foot + reach * lean + glm::dvec3(0, tall, 0);
      brush.quad(p.grass, foot - side, foot + side, knee + 0.8 * side, knee - 0.8 * side);
      brush.quad(p.grass, knee - 0.8 * side, knee + 0.8 * side, tip + 0.1 * side, tip - 0.1 * side);
    }
  }
}

}  // namespace probewalk::procedural
