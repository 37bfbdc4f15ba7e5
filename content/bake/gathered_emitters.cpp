#include "content/bake/gathered_emitters.h"

#include <algorithm>
#include <cmath>

#include "content/bake/patterns.h"
#include "content/bake/surface_point.h"

namespace probewalk {
namespace {

constexpr std::uint32_t kPowerPlaces = 4;  // of a triangle, whose mean emission says how often it is picked

}  // namespace

GatheredEmitters::GatheredEmitters(const Scene& scene, const RayScene& rays, const Emitters& emitters)
    : scene_(scene), rays_(rays) {
  std::vector<float> areas_m2;
  double sum = 0.0;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const Material& material = scene.materials[scene.triangle_material[t]];
    if (emitters.is_patch[t] || material.emissive_cd_m2 == glm::vec3(0.0f) || material.unlit) continue;
    const glm::uvec3 index = scene.triangles[t];
    const glm::vec3 a = scene.positions_m[index.x], b = scene.positions_m[index.y], c = scene.positions_m[index.z];
    const float area_m2 = 0.5f * glm::length(glm::cross(b - a, c - a));
    if (!(area_m2 > 0.0f)) continue;
    float mean = 0.0f;
    for (std::uint32_t k = 0; k < kPowerPlaces; ++k) {
      mean +=
          luminance(emission_at(scene, t, triangle_point(r2_sequence(k)), 0.5f * std::sqrt(area_m2))) / kPowerPlaces;
    }
    const double power = double(mean) * double(area_m2);
    if (!(power > 0.0)) continue;
    triangles_.push_back(t);
    areas_m2.push_back(area_m2);
    sums_.push_back(sum += power);
  }
  if (triangles_.empty()) return;
  per_m2_.assign(scene.triangles.size(), 0.0f);
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    const double power = sums_[k] - (k > 0 ? sums_[k - 1] : 0.0);
    per_m2_[triangles_[k]] = static_cast<float>(power / (sum * double(areas_m2[k])));
  }
}

GatheredEmitters::Sample GatheredEmitters::pick(glm::vec3 origin_m, glm::vec3 normal, float choice, glm::vec2 square,
                                                std::uint64_t& rays_cast) const {
  const auto found = std::upper_bound(sums_.begin(), sums_.end(), double(choice) * sums_.back());
  const std::uint32_t t = triangles_[std::min(std::size_t(found - sums_.begin()), triangles_.size() - 1)];
  const glm::uvec3 index = scene_.triangles[t];
  const glm::vec3 a = scene_.positions_m[index.x], b = scene_.positions_m[index.y], c = scene_.positions_m[index.z];
  const glm::vec2 barycentric = triangle_point(square);
  const glm::vec3 place = a + (b - a) * barycentric.x + (c - a) * barycentric.y, offset = place - origin_m;
  const float square_m2 = glm::dot(offset, offset);
  Sample sample;
  if (!(square_m2 > 0.0f)) return sample;
  const float distance_m = std::sqrt(square_m2);
  sample.direction = offset / distance_m;
  const float at_light = std::abs(glm::dot(glm::normalize(glm::cross(b - a, c - a)), sample.direction));
  if (!(at_light > 1e-6f) || !(glm::dot(sample.direction, normal) > 0.0f)) return sample;
  sample.density = per_m2_[t] * square_m2 / at_light;
  ++rays_cast;
  const float far_m = distance_m * (1.0f - 1e-4f) - ray_offset_m(place);
  if (far_m > 0.0f && rays_.occluded(origin_m, sample.direction, 0.0f, far_m)) return sample;
  sample.radiance = emission_at(scene_, t, barycentric, 0.1f * distance_m);
  return sample;
}

float GatheredEmitters::density(const SurfaceHit& hit, glm::vec3 unit_direction) const {
  if (per_m2_.empty() || !(per_m2_[hit.triangle] > 0.0f)) return 0.0f;
  const float at_light = std::abs(glm::dot(hit.geometric_normal, unit_direction));
  return at_light > 1e-6f ? per_m2_[hit.triangle] * hit.t * hit.t / at_light : 1e30f;
}

}  // namespace probewalk
