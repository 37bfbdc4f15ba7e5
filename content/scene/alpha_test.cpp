#include "content/scene/alpha_test.h"

#include <algorithm>
#include <utility>

namespace probewalk {
namespace {

constexpr float kBlendCutoff = 0.5f;

// Smallest and largest stored alpha; bilinear look-ups stay between them.
std::pair<float, float> alpha_range(const Texture& texture) {
  std::uint8_t low = 255;
  std::uint8_t high = 0;
  const std::vector<std::uint8_t>& rgba = texture.levels.front().rgba;
  for (std::size_t i = 3; i < rgba.size(); i += 4) {
    low = std::min(low, rgba[i]);
    high = std::max(high, rgba[i]);
  }
  return {static_cast<float>(low) / 255.0f, static_cast<float>(high) / 255.0f};
}

}  // namespace

float alpha_threshold(const Material& material) {
  switch (material.alpha_mode) {
    case AlphaMode::kOpaque:
      return 0.0f;
    case AlphaMode::kMask:
      return material.alpha_cutoff;
    case AlphaMode::kBlend:
      return kBlendCutoff;
  }
  return 0.0f;
}

std::vector<AlphaClass> classify_alpha(const Scene& scene) {
  std::vector<AlphaClass> classes;
  classes.reserve(scene.materials.size());
  for (const Material& material : scene.materials) {
    if (material.alpha_mode == AlphaMode::kOpaque) {
      classes.push_back(AlphaClass::kAlways);
      continue;
    }
    const float threshold = alpha_threshold(material);
    std::pair<float, float> range{1.0f, 1.0f};
    if (material.base_color.texture >= 0) range = alpha_range(scene.textures[material.base_color.texture]);
    // A margin of half an 8-bit step leaves what rounding could decide to the test at the point itself.
    constexpr float kMargin = 0.5f / 255.0f;
    const float factor = material.base_color_factor.a;
    const bool textured = material.base_color.texture >= 0;
    const float margin = textured ? kMargin : 0.0f;
    if (range.first * factor >= threshold + margin) {
      classes.push_back(AlphaClass::kAlways);
    } else if (range.second * factor < threshold - margin) {
      classes.push_back(AlphaClass::kNever);
    } else {
      classes.push_back(textured ? AlphaClass::kTested : AlphaClass::kNever);
    }
  }
  return classes;
}

glm::vec2 interpolate_uv(const Scene& scene, std::uint32_t triangle, glm::vec2 barycentric, int uv_set) {
  const std::vector<glm::vec2>& uvs = scene.uvs[uv_set == 1 ? 1 : 0];
  if (uvs.empty()) return glm::vec2(0.0f);
  const glm::uvec3 corner = scene.triangles[triangle];
  return (1.0f - barycentric.x - barycentric.y) * uvs[corner.x] + barycentric.x * uvs[corner.y] +
         barycentric.y * uvs[corner.z];
}

bool point_exists(const Scene& scene, std::uint32_t triangle, glm::vec2 barycentric) {
  const Material& material = scene.materials[scene.triangle_material[triangle]];
  if (material.alpha_mode == AlphaMode::kOpaque) return true;
  float alpha = material.base_color_factor.a;
  if (material.base_color.texture >= 0) {
    const glm::vec2 uv = interpolate_uv(scene, triangle, barycentric, material.base_color.uv_set);
    alpha *= scene.textures[material.base_color.texture].sample(uv, 0.0f).a;
  }
  return alpha >= alpha_threshold(material);
}

}  // namespace probewalk
