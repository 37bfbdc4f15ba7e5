#include "content/scene/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shaders/shared/display_transform.h"

namespace probewalk {
namespace {

struct DecodeTables {
  std::array<float, 256> linear;
  std::array<float, 256> srgb;
  DecodeTables() {
    for (int i = 0; i < 256; ++i) {
      linear[i] = static_cast<float>(i) / 255.0f;
      srgb[i] = srgb_decode(linear[i]);
    }
  }
};

const DecodeTables& decode_tables() {
  static const DecodeTables tables;
  return tables;
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255.0f));
}

// The two neighbouring texels of a coordinate and the weight of the second.
struct Taps {
  int first = 0;
  int second = 0;
  float weight = 0.0f;
};

Taps taps(float u, int size, WrapMode wrap) {
  if (!std::isfinite(u)) u = 0.0f;
  switch (wrap) {
    case WrapMode::kRepeat:
      u -= std::floor(u);
      break;
    case WrapMode::kMirroredRepeat:
      u -= 2.0f * std::floor(0.5f * u);
      if (u > 1.0f) u = 2.0f - u;
      break;
    case WrapMode::kClampToEdge:
      u = std::clamp(u, 0.0f, 1.0f);
      break;
  }
  const float x = u * static_cast<float>(size) - 0.5f;
  const float base = std::floor(x);
  const int first = static_cast<int>(base);
  Taps result{first, first + 1, x - base};
  if (wrap == WrapMode::kRepeat) {
    if (result.first < 0) result.first += size;
    if (result.second >= size) result.second -= size;
  } else {
    result.first = std::max(result.first, 0);
  }
  result.second = std::min(result.second, size - 1);
  return result;
}

glm::vec4 texel(const Texture::Level& level, const std::array<float, 256>& color, int x, int y) {
  const std::uint8_t* rgba = &level.rgba[(static_cast<std::size_t>(y) * level.width_px + x) * 4];
  return {color[rgba[0]], color[rgba[1]], color[rgba[2]], decode_tables().linear[rgba[3]]};
}

glm::vec4 bilinear(const Texture& texture, const Texture::Level& level, glm::vec2 uv) {
  const std::array<float, 256>& color = texture.srgb ? decode_tables().srgb : decode_tables().linear;
  const Taps x = taps(uv.x, level.width_px, texture.wrap_u);
  const Taps y = taps(uv.y, level.height_px, texture.wrap_v);
  const glm::vec4 top =
      glm::mix(texel(level, color, x.first, y.first), texel(level, color, x.second, y.first), x.weight);
  const glm::vec4 low =
      glm::mix(texel(level, color, x.first, y.second), texel(level, color, x.second, y.second), x.weight);
  return glm::mix(top, low, y.weight);
}

// Source texels under target texel `i` and how much of each it covers (at most three after halving).
struct Cover {
  int first = 0;
  int count = 0;
  std::array<float, 4> weight{};
};

Cover cover(int i, int source, int target) {
  const double begin = static_cast<double>(i) * source / target;
  const double end = static_cast<double>(i + 1) * source / target;
  Cover result;
  result.first = static_cast<int>(begin);
  for (int s = result.first; s < source && s < end && result.count < 4; ++s) {
    result.weight[result.count++] =
        static_cast<float>(std::min(end, s + 1.0) - std::max(begin, static_cast<double>(s)));
  }
  return result;
}

Texture::Level halved(const Texture& texture, const Texture::Level& source, bool weight_by_alpha) {
  const std::array<float, 256>& color = texture.srgb ? decode_tables().srgb : decode_tables().linear;
  Texture::Level level;
  level.width_px = std::max(1, source.width_px / 2);
  level.height_px = std::max(1, source.height_px / 2);
  level.rgba.resize(static_cast<std::size_t>(level.width_px) * level.height_px * 4);
  std::uint8_t* out = level.rgba.data();
  for (int y = 0; y < level.height_px; ++y) {
    const Cover rows = cover(y, source.height_px, level.height_px);
    for (int x = 0; x < level.width_px; ++x, out += 4) {
      const Cover columns = cover(x, source.width_px, level.width_px);
      glm::vec4 sum(0.0f);
      glm::vec3 existing(0.0f);
      float total = 0.0f;
      for (int r = 0; r < rows.count; ++r) {
        for (int c = 0; c < columns.count; ++c) {
          const float weight = rows.weight[r] * columns.weight[c];
          const glm::vec4 value = texel(source, color, columns.first + c, rows.first + r);
          sum += weight * value;
          existing += weight * value.a * glm::vec3(value);
          total += weight;
        }
      }
      glm::vec3 rgb = glm::vec3(sum) / total;
      if (weight_by_alpha && sum.a > 0.0f) rgb = existing / sum.a;
      for (int c = 0; c < 3; ++c) out[c] = to_byte(texture.srgb ? srgb_encode(rgb[c]) : rgb[c]);
      out[3] = to_byte(sum.a / total);
    }
  }
  return level;
}

}  // namespace

glm::vec4 Texture::sample(glm::vec2 uv, float lod) const {
  const float last = static_cast<float>(levels.size() - 1);
  lod = lod > 0.0f ? std::min(lod, last) : 0.0f;
  const int fine = static_cast<int>(lod);
  const glm::vec4 value = bilinear(*this, levels[fine], uv);
  const float blend = lod - static_cast<float>(fine);
  return blend > 0.0f ? glm::mix(value, bilinear(*this, levels[fine + 1], uv), blend) : value;
}

void build_mip_chain(Texture& texture, bool weight_by_alpha) {
  texture.levels.resize(1);
  while (texture.levels.back().width_px > 1 || texture.levels.back().height_px > 1) {
    texture.levels.push_back(halved(texture, texture.levels.back(), weight_by_alpha));
  }
}

}  // namespace probewalk
