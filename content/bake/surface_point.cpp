#include "content/bake/surface_point.h"

#include <algorithm>
#include <cmath>

namespace probewalk {
namespace {

// Below this agreement an interpolated normal says more about the mesh's faults than about its shape.
constexpr float kShadingNormalCosine = 0.5f;

template <typename Value>
Value interpolate(const std::vector<Value>& values, glm::uvec3 index, glm::vec2 barycentric) {
  return values[index.x] * (1.0f - barycentric.x - barycentric.y) + values[index.y] * barycentric.x +
         values[index.z] * barycentric.y;
}

// Colour of a texture at a point of a triangle; lod from texels per metre.
glm::vec4 sample_texture(const Scene& scene, TextureRef ref, std::uint32_t triangle, glm::vec2 barycentric,
                         float footprint_m) {
  const std::vector<glm::vec2>& uvs = scene.uvs[ref.uv_set];
  const Texture& texture = scene.textures[ref.texture];
  if (uvs.empty()) return texture.sample(glm::vec2(0.0f), 0.0f);
  const glm::uvec3 index = scene.triangles[triangle];
  const glm::vec2 e1 = uvs[index.y] - uvs[index.x], e2 = uvs[index.z] - uvs[index.x];
  const float texels = std::abs(e1.x * e2.y - e1.y * e2.x) * static_cast<float>(texture.levels[0].width_px) *
                       static_cast<float>(texture.levels[0].height_px);
  const glm::vec3 a = scene.positions_m[index.x];
  const float area_m2 = glm::length(glm::cross(scene.positions_m[index.y] - a, scene.positions_m[index.z] - a));
  float lod = 0.0f;
  if (area_m2 > 0.0f && texels > 0.0f) {
    lod = std::log2(std::max(footprint_m, 1e-9f)) + 0.5f * std::log2(texels / area_m2);
  }
  lod = std::clamp(lod, 0.0f, static_cast<float>(texture.levels.size() - 1));
  return texture.sample(interpolate(uvs, index, barycentric), lod);
}

glm::vec3 base_color_at(const Scene& scene, const Material& material, std::uint32_t triangle, glm::vec2 barycentric,
                        float footprint_m) {
  glm::vec3 color(material.base_color_factor);
  if (material.base_color.texture >= 0) {
    color *= glm::vec3(sample_texture(scene, material.base_color, triangle, barycentric, footprint_m));
  }
  return color;
}

}  // namespace

glm::vec3 emission_at(const Scene& scene, std::uint32_t triangle, glm::vec2 barycentric, float footprint_m) {
  const Material& material = scene.materials[scene.triangle_material[triangle]];
  if (material.unlit || material.emissive_cd_m2 == glm::vec3(0.0f)) return glm::vec3(0.0f);
  if (material.emissive.texture < 0) return material.emissive_cd_m2;
  return material.emissive_cd_m2 *
         glm::vec3(sample_texture(scene, material.emissive, triangle, barycentric, footprint_m));
}

SurfacePoint surface_at(const Scene& scene, const SurfaceHit& hit, glm::vec3 direction, float footprint_m) {
  const glm::uvec3 index = scene.triangles[hit.triangle];
  const Material& material = scene.materials[scene.triangle_material[hit.triangle]];
  SurfacePoint point;
  point.position_m = interpolate(scene.positions_m, index, hit.barycentric);
  const float facing = glm::dot(hit.geometric_normal, direction);
  point.geometric_normal = facing > 0.0f ? -hit.geometric_normal : hit.geometric_normal;
  point.normal = point.geometric_normal;
  if (!scene.normals.empty()) {
    glm::vec3 smooth = interpolate(scene.normals, index, hit.barycentric);
    const float length = glm::length(smooth);
    if (length > 0.0f) {
      smooth /= length;
      if (glm::dot(smooth, point.geometric_normal) < 0.0f) smooth = -smooth;
      if (glm::dot(smooth, point.geometric_normal) > kShadingNormalCosine) point.normal = smooth;
    }
  }
  // A footprint seen at an angle is long one way; its mean width keeps textures between blur and shimmer.
  const float across_m = footprint_m / std::sqrt(std::max(std::abs(facing), 0.1f));
  const glm::vec3 color = base_color_at(scene, material, hit.triangle, hit.barycentric, across_m);
  if (material.unlit) {
    point.unlit = true;
    point.emission_cd_m2 = color * kUnlitCdM2;
    return point;
  }
  point.albedo = glm::clamp(color, 0.0f, kMaxAlbedo);
  point.emission_cd_m2 = emission_at(scene, hit.triangle, hit.barycentric, across_m);
  return point;
}

float ray_offset_m(glm::vec3 position_m) {
  const glm::vec3 size = glm::abs(position_m);
  return 1e-4f + 4e-6f * std::max(size.x, std::max(size.y, size.z));
}

}  // namespace probewalk
