// Open ground full of opaque blades of grass, in tufts that share their meshes: many triangles by many placements, and
// what stands between a ray and its probe is thinner than any texel. A mown path leads through it.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "content/scene/procedural/plain_room.h"
#include "content/scene/procedural/scenes.h"
#include "content/scene/procedural/texture_canvas.h"

namespace probewalk::procedural {
namespace {

constexpr double kHalf_m = 6.0, kPathHalf_m = 0.9;
constexpr int kVariants = 5, kBlades = 50, kTrianglesPerTuft = 4 * kBlades;
constexpr double kTuft_m = 0.12;  // radius

double roll(std::int64_t index, int what, std::uint32_t seed) {
  return hash01(index, what, seed);
}

// A blade that bends over as it rises: two pieces of a sheet that narrows.
void draw_blade(Brush& brush, MaterialId grass, glm::dvec3 foot, double turn_rad, double height_m, double bend_m) {
  const glm::dvec3 lean(std::cos(turn_rad), 0.0, std::sin(turn_rad)), across(-lean.z, 0.0, lean.x);
  brush.sheet(grass, 1, 2,
              [&](double u, double v) {
                return foot + lean * (bend_m * v * v) + glm::dvec3(0.0, height_m * v, 0.0) +
                       across * ((u - 0.5) * 0.006 * (1.0 - 0.8 * v));
              },
              {0.006, height_m});
}

double path_z_m(double x_m) {
  return 1.2 * std::sin(0.55 * x_m);
}

}  // namespace

Model make_meadow(std::size_t triangles) {
  Model model;
  model.name = "meadow";
  const MaterialId earth = add_plain(model, "earth", 0x6A5B40), mown = add_plain(model, "mown", 0x74823E),
                   stone = add_plain(model, "stone", 0x8E8A80);
  MaterialId greens[kVariants];
  for (int k = 0; k < kVariants; ++k) {
    ModelMaterial grass;
    grass.name = "grass " + std::to_string(k + 1), grass.roughness = 0.7f, grass.double_sided = true;
    grass.color = srgb(0x56782Eu + std::uint32_t(k) * 0x0A0602u);
    greens[k] = model.add(grass);
  }
  Brush(model, "Ground").box(earth, {-kHalf_m, -0.3, -kHalf_m}, {kHalf_m, 0.0, kHalf_m});
  constexpr int kPathPieces = 48;
  Brush(model, "Path")
      .sheet(mown, kPathPieces, 1,
             [](double u, double v) {
               const double x = kHalf_m * (2.0 * u - 1.0);
               return glm::dvec3(x, 0.004, path_z_m(x) + kPathHalf_m * (1.0 - 2.0 * v));
             },
             {2.0 * kHalf_m, 2.0 * kPathHalf_m});
  Brush(model, "Boulders").cushion(stone, {1.8, -0.2, -3.6}, {3.4, 1.1, -2.4}, 0.45, 4);
  Brush(model, "Gatepost").box(stone, {-4.2, -0.1, 0.8}, {-3.8, 1.9, 1.2});

  std::size_t tufts[kVariants];
  for (int k = 0; k < kVariants; ++k) {
    Brush tuft(model, "Tuft " + std::to_string(k + 1));
    tufts[k] = model.objects.size() - 1;
    for (int b = 0; b < kBlades; ++b) {
      const std::int64_t blade = k * kBlades + b;
      const double away_m = kTuft_m * std::sqrt(roll(blade, 1, 31)),
                   angle = 2.0 * std::numbers::pi * roll(blade, 2, 31);
      draw_blade(tuft, greens[k], {away_m * std::cos(angle), -0.01, away_m * std::sin(angle)},
                 2.0 * std::numbers::pi * roll(blade, 3, 31), 0.10 + 0.16 * roll(blade, 4, 31),
                 0.02 + 0.10 * roll(blade, 5, 31));
    }
  }
  const std::size_t wanted = triangles / kTrianglesPerTuft;
  std::int64_t number = 0;
  for (std::size_t placed = 0; placed < wanted; ++number) {
    const double x = kHalf_m * (2.0 * roll(number, 1, 37) - 1.0), z = kHalf_m * (2.0 * roll(number, 2, 37) - 1.0);
    if (std::abs(z - path_z_m(x)) < kPathHalf_m + kTuft_m) continue;
    const std::size_t variant = std::size_t(kVariants * roll(number, 3, 37));
    model.placements.push_back(
        {"Tuft at " + std::to_string(placed), tufts[variant], {x, 0.0, z}, 360.0 * roll(number, 4, 37)});
    ++placed;
  }

  ModelLight sun;
  sun.name = "Sun", sun.kind = ModelLight::Kind::kDirectional;
  sun.direction = glm::normalize(glm::dvec3(-0.5, -0.75, 0.35)), sun.color = {1.0f, 0.95f, 0.85f};
  sun.intensity = 6000.0;
  model.lights.push_back(sun);
  model.sky = {{350.0f, 560.0f, 950.0f}, {1200.0f, 1300.0f, 1400.0f}, {300.0f, 320.0f, 220.0f}};
  model.rooms.push_back({"Meadow", {-kHalf_m, 0, -kHalf_m}, {kHalf_m, 6, kHalf_m}});
  model.start_m = glm::dvec3(-2.0, 0.0, path_z_m(-2.0));
  return model;
}

}  // namespace probewalk::procedural
