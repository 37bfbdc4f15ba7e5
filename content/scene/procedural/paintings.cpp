// The pictures in the frames.
#include <array>
#include <cmath>
#include <numbers>

#include "content/scene/procedural/texture_canvas.h"
#include "content/scene/procedural/textures.h"

namespace probewalk::procedural {
namespace {

// Ranges of hills, paler with distance, under an evening sky.
glm::dvec3 hills(glm::dvec2 uv) {
  glm::dvec3 colour = glm::mix(paint(0x6F8CA0), paint(0xF0C79A), glm::clamp(uv.y * 1.7, 0.0, 1.0));
  const double sun = glm::length((uv - glm::dvec2(0.66, 0.36)) * glm::dvec2(1.3, 1.0));
  colour = glm::mix(paint(0xFBE7BE), colour, glm::smoothstep(0.07, 0.085, sun));
  static constexpr std::array<std::uint32_t, 4> kRanges{0xC99B86, 0x9A7A7C, 0x5F5F6B, 0x33424A};
  for (int range = 0; range < 4; ++range) {
    const double crest = 0.46 + 0.13 * range +
                         0.14 * (fractal_noise({(2.0 + range) * uv.x, 0.0}, {64, 64}, 4,
                                               161u + static_cast<std::uint32_t>(range)) -
                                 0.5);
    if (uv.y > crest)
      colour = paint(kRanges[static_cast<std::size_t>(range)]) * (1.0 + 0.25 * (uv.y - crest));
  }
  return colour;
}

// Soft-edged blocks of colour one above the other.
glm::dvec3 blocks(glm::dvec2 uv) {
  const glm::dvec3 ground = paint(0xB5502F);
  const double inside_x = glm::smoothstep(0.06, 0.10, uv.x) * glm::smoothstep(0.94, 0.90, uv.x);
  const double wobble = 0.012 * (fractal_noise(8.0 * uv, {8, 8}, 3, 171) - 0.5);
  const auto band = [&](double top, double bottom) {
    return inside_x * glm::smoothstep(top, top + 0.03, uv.y + wobble) *
           glm::smoothstep(bottom, bottom - 0.03, uv.y + wobble);
  };
  glm::dvec3 colour = glm::mix(ground, paint(0xE8B04B), band(0.06, 0.42));
  colour = glm::mix(colour, paint(0x2B3A42), band(0.46, 0.74));
  colour = glm::mix(colour, paint(0xEBDCC2), band(0.78, 0.94));
  return colour * (0.94 + 0.10 * fractal_noise(24.0 * uv, {24, 24}, 3, 172));
}

// A branch with opposite leaves on paper.
glm::dvec3 plant_study(glm::dvec2 uv) {
  glm::dvec3 colour = paint(0xEFE7D6) * (0.97 + 0.05 * fractal_noise(12.0 * uv, {12, 12}, 3, 181));
  const glm::dvec2 p{uv.x - 0.5 - 0.05 * std::sin(3.0 * uv.y), 1.0 - uv.y};
  if (std::abs(p.x) < 0.007 && p.y > 0.08 && p.y < 0.84) colour = paint(0x4B5B3A);
  for (int leaf = 0; leaf < 11; ++leaf) {
    const double side = leaf == 10 ? 0.0 : (leaf % 2 == 0 ? 1.0 : -1.0);
    const glm::dvec2 q = p - glm::dvec2(0.0, leaf == 10 ? 0.80 : 0.22 + 0.125 * (leaf / 2));
    const glm::dvec2 axis = glm::normalize(glm::dvec2(side, side == 0.0 ? 1.0 : 0.6));
    const double length = leaf == 10 ? 0.14 : 0.30 - 0.018 * leaf;
    const double along = glm::dot(q, axis) / length, across = (q.x * axis.y - q.y * axis.x) / length;
    if (along <= 0.0 || along >= 1.0) continue;
    if (std::abs(across) < 0.17 * std::sin(std::numbers::pi * along))
      colour = across > 0.0 ? paint(0x6F8458) : paint(0x55694A);
  }
  return colour;
}

// A low sun over water.
glm::dvec3 sea(glm::dvec2 uv) {
  const double horizon = 0.52;
  const double glow = std::exp(-6.0 * std::abs(uv.x - 0.38));
  if (uv.y < horizon) {
    const glm::dvec3 sky = glm::mix(paint(0x39566B), paint(0xE9A877), std::pow(uv.y / horizon, 1.6));
    return glm::mix(paint(0xFFF0CE), sky,
                    glm::smoothstep(0.055, 0.07, glm::length(uv - glm::dvec2(0.38, 0.44))));
  }
  const double depth = (uv.y - horizon) / (1.0 - horizon);
  const double ripple = value_noise({10.0 * uv.x / (0.3 + depth), 60.0 * std::sqrt(depth)}, {512, 512}, 191);
  return glm::mix(paint(0x2C4A5C), paint(0x18303F), depth) +
         paint(0xE7A574) * (0.75 * glow * ripple * (1.0 - 0.6 * depth));
}

}  // namespace

ModelTexture painting_texture(int which) {
  switch (which) {
    case 0:
      return fill("painting: hills", 256, 192, hills);
    case 1:
      return fill("painting: blocks", 192, 256, blocks);
    case 2:
      return fill("painting: plant study", 192, 256, plant_study);
    default:
      return fill("painting: sea", 256, 192, sea);
  }
}

}  // namespace probewalk::procedural
