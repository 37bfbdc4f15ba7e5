// One room in as many triangles as wanted: the same walls, columns, cushions and ornaments, ever finer. What
// is added is real: every surface has a relief of millimetres (trowel marks, weave, flutes) that finer
// triangles follow.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "content/scene/procedural/plain_room.h"
#include "content/scene/procedural/scenes.h"

namespace probewalk::procedural {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr glm::dvec3 kLower_m{-2.6, 0.0, -2.1}, kUpper_m{2.6, 2.9, 2.1};

// A surface over [0, 1]^2, its front where d/du x d/dv points.
struct Patch {
  const char* name;
  MaterialId material;
  std::function<glm::dvec3(double, double)> point;
  glm::dvec2 size_m;       // across u and v, roughly: how triangles are shared out
  glm::ivec2 least;        // fewest pieces that still show what it is
  bool has_poles = false;  // v = 0 and v = 1 are single points

  glm::ivec2 pieces(double edge_m) const { return glm::max(least, glm::ivec2(glm::round(size_m / edge_m))); }
  std::size_t triangles(double edge_m) const {
    const glm::ivec2 n = pieces(edge_m);
    return static_cast<std::size_t>(2 * std::int64_t{n.x} * n.y - (has_poles ? 2 * n.x : 0));
  }
};

// Bumps of wavelengths from 30 cm down to 2 cm, each about 1/100 as high as long; within 3 mm together.
double relief_m(glm::dvec3 p) {
  double sum = 0.0, height_m = 1.6e-3, frequency = kTurn_rad / 0.3;
  for (int octave = 0; octave < 4; ++octave) {
    sum += height_m * std::sin(frequency * (p.x + 0.31 * p.y - 0.57 * p.z) + octave) *
           std::sin(frequency * (0.43 * p.x - 0.29 * p.y + 0.86 * p.z) + 2.0 * octave) *
           std::cos(frequency * (0.17 * p.x + 0.95 * p.y + 0.24 * p.z));
    height_m *= 0.42, frequency *= 2.45;
  }
  return sum;
}

double signed_power(double x, double exponent) {
  return std::abs(x) < 1e-9 ? 0.0 : std::copysign(std::pow(std::abs(x), exponent), x);
}

class Room {
 public:
  explicit Room(const PlainColours& c) : c_(c) {}

  // One of the room's six faces, from corner `a` along `across` and `up`; its relief fades towards its edges,
  // so that neighbours meet.
  void wall(const char* name, MaterialId m, glm::dvec3 a, glm::dvec3 across, glm::dvec3 up) {
    const glm::dvec2 size(glm::length(across), glm::length(up));
    const glm::dvec3 out = glm::normalize(glm::cross(across, up));
    patches_.push_back({name,
                        m,
                        [=](double u, double v) {
                          const glm::dvec3 p = a + u * across + v * up;
                          const double inside_m =
                              std::min(std::min(u, 1.0 - u) * size.x, std::min(v, 1.0 - v) * size.y);
                          const double fade = std::clamp(inside_m / 0.1, 0.0, 1.0);
                          return p + out * (relief_m(p) * fade * fade);
                        },
                        size,
                        {2, 2}});
  }
  // A box with round edges (`softness` 1 = an ellipsoid, towards 0 = a box).
  void soft_box(const char* name, MaterialId m, glm::dvec3 middle, glm::dvec3 half, double softness,
                double tilt_rad = 0.0, glm::ivec2 least = {8, 4}) {
    const double ct = std::cos(tilt_rad), st = std::sin(tilt_rad);
    patches_.push_back({name,
                        m,
                        [=](double u, double v) {
                          const double around = -kTurn_rad * u, rise = std::numbers::pi * (v - 0.5);
                          const double ring = signed_power(std::cos(rise), softness);
                          glm::dvec3 q{ring * signed_power(std::cos(around), softness),
                                       signed_power(std::sin(rise), softness),
                                       ring * signed_power(std::sin(around), softness)};
                          q *= half;
                          q = {q.x, ct * q.y - st * q.z, st * q.y + ct * q.z};
                          const glm::dvec3 p = middle + q;
                          return p + q * (relief_m(2.0 * p) / std::max(0.05, glm::length(q)));
                        },
                        {4.0 * (half.x + half.z), 2.0 * (half.y + std::min(half.x, half.z))},
                        least,
                        true});
  }
  // A surface of revolution: radius(v) over height; flutes cut into it.
  void turned(const char* name, MaterialId m, glm::dvec3 foot, double height_m, double widest_m,
              const std::function<double(double)>& radius_m, int flutes, glm::ivec2 least) {
    patches_.push_back({name,
                        m,
                        [=](double u, double v) {
                          const double around = -kTurn_rad * u;
                          const double flute =
                              flutes > 0 ? 1.0 - 0.05 * std::abs(std::sin(0.5 * flutes * around)) : 1.0;
                          const glm::dvec3 base = foot + glm::dvec3(0, height_m * v, 0);
                          const glm::dvec3 out(std::cos(around), 0, std::sin(around));
                          const double r = radius_m(v) * flute;
                          return base + out * (r + (r > 0.02 ? 0.7 * relief_m(base + r * out) : 0.0));
                        },
                        {kTurn_rad * widest_m, height_m},
                        least});
  }
  void sheet(const char* name, MaterialId m, glm::dvec2 size_m, glm::ivec2 least,
             const std::function<glm::dvec3(double, double)>& point) {
    patches_.push_back({name, m, point, size_m, least});
  }

  std::size_t triangles(double edge_m) const {
    std::size_t sum = 0;
    for (const Patch& patch : patches_) sum += patch.triangles(edge_m);
    return sum;
  }
  // Edges as long as they can be with at least `wanted` triangles in all; no longer than 10 m, no shorter
  // than 0.5 mm.
  double edge_for(std::size_t wanted) const {
    double low = std::log(5e-4), high = std::log(10.0);
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (triangles(std::exp(middle)) >= wanted ? low : high) = middle;
    }
    return std::exp(low);
  }
  void draw(Model& model, double edge_m) const {
    for (const Patch& patch : patches_) {
      const glm::ivec2 n = patch.pieces(edge_m);
      Brush(model, patch.name).sheet(patch.material, n.x, n.y, patch.point, patch.size_m);
    }
  }

  const PlainColours& colours() const { return c_; }

 private:
  PlainColours c_;
  std::vector<Patch> patches_;
};

void add_shell(Room& room, MaterialId rug) {
  const PlainColours& c = room.colours();
  const glm::dvec3 size = kUpper_m - kLower_m, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  const glm::dvec3 lo = kLower_m, hi = kUpper_m;
  room.wall("Floor", c.floor, {lo.x, lo.y, hi.z}, x, -z);
  room.wall("Ceiling", c.ceiling, {lo.x, hi.y, lo.z}, x, z);
  room.wall("North wall", c.wall, lo, x, y);
  room.wall("South wall", c.wall, {hi.x, lo.y, hi.z}, -x, y);
  room.wall("West wall", c.red_wall, {lo.x, lo.y, hi.z}, -z, y);
  room.wall("East wall", c.green_wall, {hi.x, lo.y, lo.z}, z, y);
  room.sheet("Rug", rug, {2.2, 1.5}, {2, 2}, [](double u, double v) {
    const glm::dvec3 p{-1.1 + 2.2 * u, 0.012, 0.85 - 1.5 * v};
    return p + glm::dvec3(0, relief_m(3.0 * p), 0);
  });
}

void add_furniture(Room& room, MaterialId cloth, MaterialId pillow, MaterialId wood, MaterialId clay) {
  const PlainColours& c = room.colours();
  for (const double x : {-2.2, 2.2})
    for (const double z : {-1.75, 1.75})
      room.turned("Column", c.ceiling, {x, -0.01, z}, 2.92, 0.14,
                  [](double v) {
                    return 0.14 - 0.02 * v + 0.06 * std::exp(-40.0 * v) + 0.05 * std::exp(40.0 * (v - 1.0));
                  },
                  16, {16, 2});
  room.soft_box("Seat", cloth, {0, 0.26, -1.45}, {0.95, 0.2, 0.42}, 0.35);
  room.soft_box("Back", cloth, {0, 0.58, -1.82}, {0.98, 0.36, 0.16}, 0.4);
  room.soft_box("Pillow", pillow, {-0.6, 0.62, -1.5}, {0.24, 0.2, 0.08}, 0.6, -0.35);
  room.soft_box("Pillow", c.thing, {0.58, 0.62, -1.5}, {0.24, 0.2, 0.08}, 0.6, -0.35);
  room.soft_box("Table top", wood, {0.2, 0.45, 0.1}, {0.6, 0.03, 0.4}, 0.3, 0.0, {12, 4});
  room.turned("Table foot", wood, {0.2, 0.0, 0.1}, 0.44, 0.2,
              [](double v) { return 0.07 + 0.13 * std::pow(1.0 - v, 6.0); }, 0, {8, 3});
  room.turned(
      "Vase", clay, {0.35, 0.478, 0.0}, 0.36, 0.1,
      [](double v) { return 0.035 + 0.075 * std::sin(std::numbers::pi * std::pow(v, 0.8)) + 0.02 * v; }, 0,
      {10, 5});
  room.soft_box("Fruit", pillow, {-0.1, 0.53, 0.2}, glm::dvec3(0.055), 1.0);
  room.soft_box("Fruit", c.green_wall, {0.03, 0.53, 0.27}, glm::dvec3(0.05), 1.0);
}

void add_ornament(Room& room, MaterialId curtain, MaterialId stucco) {
  // A rosette of stucco on the east wall, a curtain at the west wall.
  room.sheet("Rosette", stucco, {1.2, 1.2}, {6, 6}, [](double u, double v) {
    const glm::dvec2 q{2.0 * u - 1.0, 2.0 * v - 1.0};
    const double r = glm::length(q), angle = std::atan2(q.y, q.x);
    const double petals = 0.5 + 0.5 * std::cos(8.0 * angle) * std::sin(kTurn_rad * 1.5 * r);
    const double rim = std::clamp((1.0 - std::max(std::abs(q.x), std::abs(q.y))) / 0.06, 0.0, 1.0);
    const glm::dvec3 p{kUpper_m.x - 0.02, 1.6 + 0.6 * q.y, 0.6 * q.x};
    return p - glm::dvec3(rim * (0.02 + 0.05 * petals * std::exp(-0.9 * r * r) + relief_m(2.0 * p)), 0, 0);
  });
  room.sheet("Curtain", curtain, {3.0, 2.5}, {12, 1}, [](double u, double v) {
    const glm::dvec3 p{kLower_m.x + 0.15 + 0.05 * std::sin(kTurn_rad * 6.0 * u), 0.1 + 2.6 * v,
                       1.2 - 2.4 * u};
    return p + glm::dvec3(1.5 * relief_m(1.5 * p), 0, 0);
  });
}

}  // namespace

Model make_triangle_room(std::size_t triangles) {
  Model model;
  model.name = "triangles";
  const PlainColours c = add_plain_colours(model);
  const MaterialId rug = add_plain(model, "rug", 0x6C4A52), cloth = add_plain(model, "cloth", 0x7F8F92),
                   pillow = add_plain(model, "pillow", 0xC98F45), wood = add_plain(model, "wood", 0x8A5F3F),
                   clay = add_plain(model, "clay", 0x3F6E70), curtain = add_plain(model, "curtain", 0xEADCC0),
                   stucco = add_plain(model, "stucco", 0xF1ECE0);
  model.materials[static_cast<std::size_t>(curtain)].double_sided = true;
  Room room(c);
  add_shell(room, rug);
  add_furniture(room, cloth, pillow, wood, clay);
  add_ornament(room, curtain, stucco);
  room.draw(model, room.edge_for(triangles));
  add_point_light(model, {1.2, 2.5, 0.9}, 240);
  add_point_light(model, {-1.2, 2.5, -0.2}, 160);
  model.rooms.push_back({"Room", kLower_m, kUpper_m});
  model.start_m = glm::dvec3(-0.6, 0.0, 1.3);
  return model;
}

}  // namespace probewalk::procedural
