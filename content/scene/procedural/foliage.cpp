// A winter garden full of small opaque leaves: what stands between a ray and its probe is everywhere, and as
// small as a few texels. Twenty thousand leaf cards of 7 cm, as the tracer's goals for foliage are stated on.
#include <cmath>
#include <numbers>

#include "content/scene/procedural/plain_room.h"
#include "content/scene/procedural/plants.h"
#include "content/scene/procedural/scenes.h"
#include "content/scene/procedural/texture_canvas.h"

namespace probewalk::procedural {
namespace {

constexpr int kLeaves = 20'000;
constexpr double kLeaf_m = 0.07;

// One leaf card: a kite folded out along `axis`, seen from both sides.
void draw_card(Brush& brush, MaterialId leaf, glm::dvec3 foot, glm::dvec3 axis, glm::dvec3 facing) {
  const glm::dvec3 right = 0.5 * kLeaf_m * glm::normalize(glm::cross(axis, facing));
  const glm::dvec3 middle = foot + 0.4 * kLeaf_m * axis;
  brush.picture(leaf, foot, middle + right, foot + kLeaf_m * axis, middle - right);
}

double roll(int leaf, int what) {
  return hash01(leaf, what, 907);
}

glm::dvec3 random_direction(int leaf, int what) {
  const double y = 2.0 * roll(leaf, what) - 1.0, angle = 2.0 * std::numbers::pi * roll(leaf, what + 1),
               r = std::sqrt(1.0 - y * y);
  return {r * std::cos(angle), y, r * std::sin(angle)};
}

// Where a leaf hangs: a crown in the middle (half of all), hedges along two walls, a climber on the third.
glm::dvec3 place_of(int leaf) {
  const double a = roll(leaf, 10), b = roll(leaf, 11), c = roll(leaf, 12);
  const int share = leaf % 10;
  if (share < 5) {
    const glm::dvec3 d = random_direction(leaf, 13);
    return glm::dvec3(0, 2.35, 0) + d * std::cbrt(0.05 + 0.95 * a) * glm::dvec3(1.55, 0.95, 1.55);
  }
  if (share < 8) return {-3.4 + 6.8 * a, 0.1 + 1.1 * b, (share == 7 ? 2.75 : -3.35) + 0.6 * c};
  return {2.85 + 0.5 * c, 0.1 + 3.1 * b * (0.6 + 0.4 * std::sin(9.0 * a)), -2.6 + 5.2 * a};
}

}  // namespace

Model make_foliage() {
  Model model;
  model.name = "foliage";
  const PlainColours c = add_plain_colours(model);
  const glm::dvec3 lower_m{-3.5, 0, -3.5}, upper_m{3.5, 3.6, 3.5};
  draw_plain_room(Brush(model, "Room"), c, lower_m, upper_m);
  ModelMaterial leaf;
  leaf.double_sided = true, leaf.roughness = 0.7f;
  MaterialId leaves[3];
  const std::uint32_t greens[3] = {0x6E8F3C, 0x4F7334, 0x8FA650};
  for (int i = 0; i < 3; ++i) {
    leaf.name = "leaf " + std::to_string(i + 1), leaf.color = srgb(greens[i]);
    leaves[i] = model.add(leaf);
  }
  const MaterialId bark = add_plain(model, "bark", 0x6B5744), earth = add_plain(model, "earth", 0x5A4636);
  Brush wood(model, "Wood");
  wood.lathe(c.thing, {0, 0, 0}, {{0, -0.01}, {0.55, -0.01}, {0.65, 0.5}, {0.58, 0.5}, {0.56, 0.42}}, 24);
  wood.lathe(earth, {0, 0.43, 0}, {{0.57, 0}, {0, 0.001}}, 24);
  wood.tube(bark, {{0, 0.4, 0}, {0.06, 1.0, 0.03}, {0.0, 1.6, -0.04}, {0.03, 2.4, 0.0}},
            {0.10, 0.075, 0.06, 0.03}, 10);
  for (int i = 0; i < 9; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / 9.0, low = 1.3 + 0.09 * i;
    wood.tube(bark,
              {{0.02, low, 0.0},
               {0.5 * std::cos(turn), low + 0.45, 0.5 * std::sin(turn)},
               {1.15 * std::cos(turn + 0.2), low + 0.7, 1.15 * std::sin(turn + 0.2)}},
              {0.035, 0.022, 0.008}, 6);
  }
  Brush crown(model, "Leaves");
  for (int i = 0; i < kLeaves; ++i) {
    const glm::dvec3 axis = glm::normalize(random_direction(i, 1) + glm::dvec3(0, -0.3, 0));
    const glm::dvec3 facing = glm::normalize(random_direction(i, 4) + glm::dvec3(0, 0.9, 0) + 0.01 * axis);
    draw_card(crown, leaves[i % 3], place_of(i), axis, facing);
  }
  Brush(model, "Bench").at({-2.9, 0, 0.2}, 90).box(c.wall, {-0.8, -0.01, -0.22}, {0.8, 0.44, 0.22});
  Brush(model, "Skylight").box(c.lamp, {-0.9, 3.57, -0.9}, {0.9, 3.61, 0.9});
  add_point_light(model, {-2.2, 3.2, 2.2}, 240);
  add_point_light(model, {2.2, 3.2, -2.4}, 240);
  model.rooms.push_back({"Winter garden", lower_m, upper_m});
  model.start_m = glm::dvec3(-1.9, 0.0, 1.8);
  return model;
}

}  // namespace probewalk::procedural
