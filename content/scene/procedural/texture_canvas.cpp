#include "content/scene/procedural/texture_canvas.h"

#include <algorithm>
#include <cmath>

namespace probewalk::procedural {
namespace {

ModelTexture fill_channels(const std::string& name, int width_px, int height_px, int channels,
                           const std::function<glm::dvec4(glm::dvec2)>& colour) {
  ModelTexture texture{name, width_px, height_px, channels, {}};
  texture.pixels.reserve(static_cast<std::size_t>(width_px) * height_px * channels);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const glm::dvec4 c = colour({(x + 0.5) / width_px, (y + 0.5) / height_px});
      for (int i = 0; i < channels; ++i)
        texture.pixels.push_back(static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(c[i], 0.0, 1.0))));
    }
  }
  return texture;
}

std::int64_t wrap(std::int64_t value, std::int64_t period) {
  return ((value % period) + period) % period;
}

}  // namespace

double hash01(std::int64_t x, std::int64_t y, std::uint32_t seed) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15u ^
                    static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Fu ^
                    (static_cast<std::uint64_t>(seed) + 1) * 0x165667B19E3779F9u;
  h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;  // SplitMix64's finaliser (Steele et al. 2014)
  h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
  return static_cast<double>((h ^ (h >> 31)) >> 11) * 0x1p-53;
}

double value_noise(glm::dvec2 p, glm::ivec2 period, std::uint32_t seed) {
  const glm::dvec2 cell = glm::floor(p);
  const glm::dvec2 f = p - cell, s = f * f * (3.0 - 2.0 * f);
  const auto at = [&](int dx, int dy) {
    return hash01(wrap(static_cast<std::int64_t>(cell.x) + dx, period.x),
                  wrap(static_cast<std::int64_t>(cell.y) + dy, period.y), seed);
  };
  return glm::mix(glm::mix(at(0, 0), at(1, 0), s.x), glm::mix(at(0, 1), at(1, 1), s.x), s.y);
}

double fractal_noise(glm::dvec2 p, glm::ivec2 period, int octaves, std::uint32_t seed) {
  double sum = 0.0, weight = 0.5, total = 0.0;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * value_noise(p, period, seed + static_cast<std::uint32_t>(i));
    total += weight;
    weight *= 0.5, p *= 2.0, period *= 2;
  }
  return sum / total;
}

glm::dvec3 paint(std::uint32_t rgb) {
  return glm::dvec3((rgb >> 16) & 255u, (rgb >> 8) & 255u, rgb & 255u) / 255.0;
}

ModelTexture fill(const std::string& name, int width_px, int height_px,
                  const std::function<glm::dvec3(glm::dvec2)>& colour) {
  return fill_channels(name, width_px, height_px, 3,
                       [&](glm::dvec2 uv) { return glm::dvec4(colour(uv), 1.0); });
}

ModelTexture fill_rgba(const std::string& name, int width_px, int height_px,
                       const std::function<glm::dvec4(glm::dvec2)>& colour) {
  return fill_channels(name, width_px, height_px, 4, colour);
}

}  // namespace probewalk::procedural
