#include "content/scene/procedural/textures.h"

#include <array>
#include <cmath>
#include <numbers>

#include "content/scene/procedural/texture_canvas.h"

namespace probewalk::procedural {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

double smooth(double from, double to, double value) {
  const double t = glm::clamp((value - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// Long streaks along u with a few darker pores: 0 = light wood, 1 = dark wood.
double grain(glm::dvec2 p, glm::ivec2 period, std::uint32_t seed) {
  const double bend = 0.6 * fractal_noise(p, period, 2, seed);
  const double streaks =
      fractal_noise({p.x, 12.0 * p.y + 4.0 * bend}, {period.x, 12 * period.y}, 3, seed + 7);
  const double pores = fractal_noise({2.0 * p.x, 48.0 * p.y}, {2 * period.x, 48 * period.y}, 2, seed + 13);
  return glm::clamp(0.75 * streaks + 0.45 * (pores - 0.5), 0.0, 1.0);
}

// Distance to the joint lines of a grid cell in units of the cell, 0 on the joint.
double joint_distance(glm::dvec2 in_cell, glm::dvec2 cell_size) {
  const glm::dvec2 edge = glm::min(in_cell, 1.0 - in_cell) * cell_size;
  return glm::min(edge.x, edge.y);
}

}  // namespace

ModelTexture plank_floor_texture(std::uint32_t light, std::uint32_t dark) {
  constexpr int kPlanks = 10;
  return fill("plank floor", 512, 512, [=](glm::dvec2 uv) {
    const double row = uv.y * kPlanks;
    const int plank = static_cast<int>(row);
    const double along = uv.x + hash01(plank, 0, 3);  // each row is shifted, and cut into two boards
    const int board = static_cast<int>(std::floor(along * 2.0)) & 1;
    const double tone = hash01(plank, board, 5);
    const double dark_share =
        0.55 * grain({4.0 * uv.x, row}, {4, kPlanks}, 11u + static_cast<std::uint32_t>(board)) + 0.32 * tone;
    const double joint = joint_distance({along * 2.0 - std::floor(along * 2.0), row - plank}, {0.8, 0.16});
    return glm::mix(paint(light), paint(dark), dark_share) * glm::mix(0.55, 1.0, smooth(0.0, 0.005, joint));
  });
}

ModelTexture wood_texture(const std::string& name, std::uint32_t light, std::uint32_t dark) {
  return fill(name, 256, 256, [=](glm::dvec2 uv) {
    return glm::mix(paint(light), paint(dark), grain({3.0 * uv.x, 5.0 * uv.y}, {3, 5}, 21));
  });
}

ModelTexture plaster_texture() {
  return fill("plaster", 256, 256, [](glm::dvec2 uv) {
    const double trowel = fractal_noise(6.0 * uv, {6, 6}, 4, 31),
                 sand = hash01(static_cast<int>(uv.x * 256), static_cast<int>(uv.y * 256), 32);
    return glm::dvec3(0.955 + 0.05 * (trowel - 0.5) + 0.012 * (sand - 0.5));
  });
}

ModelTexture cloth_texture() {
  return fill("cloth", 128, 128, [](glm::dvec2 uv) {
    const double warp = 0.5 + 0.5 * std::cos(kTurn_rad * 16.0 * uv.x),
                 weft = 0.5 + 0.5 * std::cos(kTurn_rad * 16.0 * uv.y);
    const bool over = (static_cast<int>(16.0 * uv.x) + static_cast<int>(16.0 * uv.y)) % 2 == 0;
    const double slub = fractal_noise(8.0 * uv, {8, 8}, 3, 41);
    return glm::dvec3(0.88 + 0.08 * (over ? 1.0 - warp : 1.0 - weft) + 0.14 * (slub - 0.5));
  });
}

ModelTexture tile_texture(const std::string& name, std::uint32_t glaze, std::uint32_t grout, int columns,
                          int rows) {
  return fill(name, 256, 256, [=](glm::dvec2 uv) {
    const glm::dvec2 grid = uv * glm::dvec2(columns, rows), cell = glm::floor(grid);
    const double tone = hash01(static_cast<int>(cell.x), static_cast<int>(cell.y), 51);
    const double joint = joint_distance(grid - cell, {1.0 / columns, 1.0 / rows});
    return glm::mix(paint(grout), paint(glaze) * (0.95 + 0.08 * tone), smooth(0.003, 0.008, joint));
  });
}

ModelTexture stone_floor_texture() {
  return fill("stone floor", 512, 512, [](glm::dvec2 uv) {
    const glm::dvec2 grid = uv * 2.0, cell = glm::floor(grid);
    const auto seed =
        static_cast<std::uint32_t>(60 + 2 * static_cast<int>(cell.x) + static_cast<int>(cell.y));
    const double cloud = fractal_noise(6.0 * uv, {6, 6}, 5, seed);
    const double vein = std::abs(fractal_noise(4.0 * uv, {4, 4}, 5, seed + 9) - 0.5);
    const double joint = joint_distance(grid - cell, {0.5, 0.5});
    const glm::dvec3 stone =
        glm::mix(paint(0xC9C0B2), paint(0xA79C8D), cloud) * (1.0 - 0.10 * smooth(0.03, 0.0, vein));
    return glm::mix(paint(0x8B8378), stone * (0.97 + 0.05 * hash01(seed, 0, 2)),
                    smooth(0.0015, 0.0035, joint));
  });
}

ModelTexture paving_texture() {
  constexpr int kRows = 6;
  return fill("paving", 512, 512, [](glm::dvec2 uv) {
    const int row = static_cast<int>(uv.y * kRows);
    const double along = 4.0 * (uv.x + hash01(row, 1, 71));
    const double slab = std::floor(along);
    const int number = static_cast<int>(slab) % 4;
    const double tone = hash01(row, number, 72);
    const double rough = fractal_noise(24.0 * uv, {24, 24}, 4, 73);
    const double joint = joint_distance({along - slab, uv.y * kRows - row}, {0.25, 1.0 / kRows});
    const glm::dvec3 stone = glm::mix(paint(0xB9AE9F), paint(0x998E82), 0.6 * tone + 0.5 * (rough - 0.3));
    return glm::mix(paint(0x6E675C), stone, smooth(0.002, 0.006, joint));
  });
}

ModelTexture brick_texture() {
  return fill("brick", 512, 512, [](glm::dvec2 uv) {
    const glm::dvec2 grid = uv * glm::dvec2(4.0, 12.0);
    const int row = static_cast<int>(grid.y);
    const double along = grid.x + 0.5 * (row % 2);
    const int number = static_cast<int>(along) % 4;
    const double tone = hash01(row, number, 81);
    const double rough = fractal_noise(32.0 * uv, {32, 32}, 3, 82);
    const double joint = joint_distance({along - std::floor(along), grid.y - row}, {0.25, 1.0 / 12.0});
    const glm::dvec3 brick = glm::mix(paint(0xC79B80), paint(0xA4705A), tone) * (0.86 + 0.24 * rough);
    return glm::mix(paint(0xC9C0B2) * (0.9 + 0.15 * rough), brick, smooth(0.004, 0.009, joint));
  });
}

ModelTexture grass_texture() {
  return fill("grass", 256, 256, [](glm::dvec2 uv) {
    const double tuft = fractal_noise(10.0 * uv, {10, 10}, 3, 91),
                 blade = value_noise(glm::dvec2(96.0, 64.0) * uv, {96, 64}, 92);
    return glm::mix(paint(0x4E6330), paint(0x8DA052), 0.55 * tuft + 0.45 * blade);
  });
}

ModelTexture bark_texture() {
  return fill("bark", 128, 128, [](glm::dvec2 uv) {
    const double ridge = fractal_noise({3.0 * uv.x, 12.0 * uv.y}, {3, 12}, 4, 101);
    return glm::mix(paint(0x55483C), paint(0x8F7F6C), ridge);
  });
}

ModelTexture marble_texture() {
  return fill("marble", 256, 256, [](glm::dvec2 uv) {
    const double warp = fractal_noise(3.0 * uv, {3, 3}, 4, 111);
    const double vein = std::abs(fractal_noise(3.0 * uv + 0.8 * warp, {3, 3}, 5, 112) - 0.5);
    return glm::mix(paint(0x9C9890), paint(0xEDEAE4), smooth(0.0, 0.09, vein) * 0.8 + 0.2 * warp);
  });
}

ModelTexture knot_rug_texture(const std::string& name, std::uint32_t ground, std::uint32_t figure,
                              std::uint32_t accent) {
  return fill(name, 384, 256, [=](glm::dvec2 uv) {
    const glm::dvec2 from_edge = glm::min(uv, 1.0 - uv) * glm::dvec2(3.0, 2.0);
    const double edge = glm::min(from_edge.x, from_edge.y);
    const double pile = 0.90 + 0.16 * hash01(static_cast<int>(uv.x * 384), static_cast<int>(uv.y * 256), 121);
    if (edge < 0.05) return paint(figure) * 0.8 * pile;
    if (edge < 0.22) {
      const double wave = std::abs(std::fmod((uv.x * 3.0 + uv.y * 2.0) * 8.0, 1.0) - 0.5);
      return (wave < 0.18 ? paint(ground) : paint(accent)) * pile;
    }
    if (edge < 0.25) return paint(figure) * pile;
    const glm::dvec2 cell = glm::abs(glm::fract(uv * glm::dvec2(6.0, 4.0)) - 0.5);
    const double diamond = cell.x + cell.y;
    if (diamond < 0.10) return paint(accent) * pile;
    if (diamond < 0.24) return paint(figure) * pile;
    return (diamond > 0.42 && diamond < 0.46 ? glm::mix(paint(ground), paint(figure), 0.5) : paint(ground)) *
           pile;
  });
}

ModelTexture stripe_rug_texture() {
  return fill("stripe rug", 256, 256, [](glm::dvec2 uv) {
    static constexpr std::array<std::uint32_t, 5> kStripes{0xE4DAC8, 0x3F5B5E, 0xE4DAC8, 0xC98A4B, 0xD9CDB8};
    const int stripe = static_cast<int>(uv.x * 20.0) % 5;
    const double pile = 0.90 + 0.16 * hash01(static_cast<int>(uv.x * 256), static_cast<int>(uv.y * 256), 131);
    return paint(kStripes[static_cast<std::size_t>(stripe)]) * pile;
  });
}

ModelTexture blanket_texture(std::uint32_t ground, std::uint32_t line) {
  return fill("blanket", 128, 128, [=](glm::dvec2 uv) {
    const glm::dvec2 cell = glm::fract(uv * 4.0);
    const double lines = (cell.x < 0.12 ? 0.5 : 0.0) + (cell.y < 0.12 ? 0.5 : 0.0);
    const double wool = 0.93 + 0.10 * value_noise(64.0 * uv, {64, 64}, 141);
    return glm::mix(paint(ground), paint(line), lines) * wool;
  });
}

ModelTexture leaf_texture() {
  // Leaves left and right of a stem that grows from the lower edge; each leaf is a lens with a midrib.
  return fill_rgba("leaf", 128, 128, [](glm::dvec2 uv) {
    const glm::dvec2 p{uv.x - 0.5, 1.0 - uv.y};
    glm::dvec4 colour{0.30, 0.36, 0.17, 0.0};
    if (std::abs(p.x) < 0.012 && p.y < 0.8) colour = {0.40, 0.33, 0.22, 1.0};
    for (int leaf = 0; leaf < 7; ++leaf) {
      const double side = leaf == 6 ? 0.0 : (leaf % 2 == 0 ? 1.0 : -1.0);
      const glm::dvec2 foot{0.0, leaf == 6 ? 0.62 : 0.10 + 0.095 * leaf};
      const glm::dvec2 axis = glm::normalize(glm::dvec2(side, side == 0.0 ? 1.0 : 0.75));
      const double length = leaf == 6 ? 0.37 : 0.44 - 0.02 * leaf;
      const glm::dvec2 q = p - foot;
      const double along = glm::dot(q, axis) / length, across = (q.x * axis.y - q.y * axis.x) / length;
      if (along < 0.0 || along > 1.0) continue;
      const double width = 0.27 * std::sin(std::numbers::pi * std::pow(along, 0.75));
      if (std::abs(across) > width) continue;
      const double tone = 0.85 + 0.3 * hash01(leaf, 0, 151) - (std::abs(across) < 0.018 ? 0.12 : 0.0) +
                          (across > 0.0 ? 0.08 : 0.0);
      colour = {0.42 * tone, 0.54 * tone, 0.22 * tone, 1.0};
    }
    return colour;
  });
}

ModelTexture book_spines_texture() {
  static constexpr std::array<std::uint32_t, kBookColours> kColours{
      0x7A2E2B, 0x2F4858, 0xC9A66B, 0x33523F, 0xE3D9C6, 0x8C5A3C, 0x1F2D3A, 0xA8553A,
      0x5B6B5A, 0xD8C39A, 0x4A3B52, 0x9A8F80, 0xB58B3A, 0x3B3A38, 0x6E8790, 0xEDE6DA};
  return fill("book spines", 4 * kBookColours, 4,
              [](glm::dvec2 uv) { return paint(kColours[static_cast<std::size_t>(uv.x * kBookColours)]); });
}

}  // namespace probewalk::procedural
