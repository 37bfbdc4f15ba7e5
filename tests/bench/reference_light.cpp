#include "bench/reference_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "content/bake/surface_point.h"

namespace probewalk::bench {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kFootprint_m = 0.005f;
constexpr int kPowerPlaces = 8;        // a side
constexpr float kLeastDensity = 0.1f;  // of a texture's places that those tried say are dark
constexpr float kSunRadius_rad = 0.004625f;
constexpr int kSureBounces = 2;

float unit(std::mt19937& random) {
  return float(random() >> 8) * (1.0f / 16777216.0f);
}

float strongest(glm::vec3 v) {
  return std::max(v.r, std::max(v.g, v.b));
}

void frame(glm::vec3 n, glm::vec3& u, glm::vec3& v) {
  u = glm::normalize(glm::cross(n, std::abs(n.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
  v = glm::cross(n, u);
}

glm::vec2 folded(float a, float b) {
  return a + b > 1.0f ? glm::vec2(1.0f - a, 1.0f - b) : glm::vec2(a, b);
}

float intensity_factor(const Light& light, glm::vec3 to_light, float distance_m) {
  float value = 1.0f / std::max(distance_m * distance_m, 1e-4f);
  if (light.range_m > 0.0f) value *= std::clamp(1.0f - std::pow(distance_m / light.range_m, 4.0f), 0.0f, 1.0f);
  if (light.kind != Light::Kind::kSpot) return value;
  const float outer = std::cos(light.outer_cone_rad), inner = std::cos(light.inner_cone_rad);
  const float cone = (-glm::dot(light.direction, to_light) - outer) / std::max(inner - outer, 0.001f);
  return value * std::clamp(cone, 0.0f, 1.0f) * std::clamp(cone, 0.0f, 1.0f);
}

}  // namespace

float ReferenceLight::Place::cosine(glm::vec3 direction) const {
  return glm::dot(geometric_normal, direction) > 0.0f ? std::max(glm::dot(normal, direction), 0.0f) : 0.0f;
}

ReferenceLight::ReferenceLight(const Scene& scene, const RayScene& rays, std::vector<bool> marked,
                               std::vector<float> lamp_radii_m, Sampling sampling)
    : scene_(scene),
      rays_(rays),
      marked_(std::move(marked)),
      lamp_radii_m_(std::move(lamp_radii_m)),
      sampling_(sampling),
      per_m2_(scene.triangles.size(), 0.0f) {
  marked_.resize(scene.triangles.size(), false);
  lamp_radii_m_.resize(scene.lights.size(), 0.0f);
  double sum = 0.0;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const Material& material = scene.materials[scene.triangle_material[t]];
    if (material.unlit || !(strongest(material.emissive_cd_m2) > 0.0f)) continue;
    const glm::uvec3 i = scene.triangles[t];
    const glm::vec3 a = scene.positions_m[i.x], b = scene.positions_m[i.y], c = scene.positions_m[i.z];
    const float area_m2 = 0.5f * glm::length(glm::cross(b - a, c - a));
    if (!(area_m2 > 0.0f)) continue;
    float mean = kLeastDensity * strongest(material.emissive_cd_m2);
    for (int k = 0; k < kPowerPlaces * kPowerPlaces; ++k) {
      const glm::vec2 at = folded((float(k % kPowerPlaces) + 0.5f) / kPowerPlaces,
                                  (float(k) / kPowerPlaces + 0.25f) / (kPowerPlaces + 1));
      mean += strongest(emission_at(scene, t, at, kFootprint_m)) / (kPowerPlaces * kPowerPlaces);
    }
    triangles_.push_back(t);
    sums_.push_back(sum += double(mean) * area_m2);
    per_m2_[t] = mean;
  }
  for (const std::uint32_t t : triangles_) per_m2_[t] = float(per_m2_[t] / sum);
}

float ReferenceLight::area_density(const SurfaceHit& hit, glm::vec3 direction) const {
  return per_m2_[hit.triangle] * hit.t * hit.t / std::max(std::abs(glm::dot(hit.geometric_normal, direction)), 1e-9f);
}

glm::vec3 ReferenceLight::punctual(const Place& at, std::mt19937& random) const {
  glm::vec3 sum(0.0f);
  for (std::size_t k = 0; k < scene_.lights.size(); ++k) {
    const Light& light = scene_.lights[k];
    if (light.kind == Light::Kind::kDirectional) {
      const float cosine = at.cosine(-light.direction);
      if (!(cosine > 0.0f)) continue;
      glm::vec3 u, v;
      frame(light.direction, u, v);
      const float radius = kSunRadius_rad * std::sqrt(unit(random)), turn = 2.0f * kPi * unit(random);
      const glm::vec3 to = -light.direction + radius * (std::cos(turn) * u + std::sin(turn) * v);
      if (!rays_.closest(at.origin_m, to).hit) sum += light.intensity * cosine;
      continue;
    }
    const glm::vec3 offset = light.position_m - at.origin_m;
    const float distance_m = glm::length(offset);
    if (!(distance_m > 0.0f)) continue;
    const glm::vec3 to = offset / distance_m;
    const float factor = at.cosine(to) * intensity_factor(light, to, distance_m);
    if (!(factor > 0.0f)) continue;
    const float far_m = distance_m * 0.9999f - lamp_radii_m_[k];
    if (far_m <= 0.0f || !rays_.occluded(at.origin_m, to, 0.0f, far_m)) sum += light.intensity * factor;
  }
  return sum;
}

glm::vec3 ReferenceLight::emissive(const Place& at, std::mt19937& random, bool& is_marked) const {
  if (triangles_.empty()) return glm::vec3(0.0f);
  const auto found = std::upper_bound(sums_.begin(), sums_.end(), double(unit(random)) * sums_.back());
  const std::uint32_t t = triangles_[std::min(std::size_t(found - sums_.begin()), triangles_.size() - 1)];
  const float first = unit(random), second = unit(random);
  const glm::vec2 place = folded(first, second);
  const glm::uvec3 i = scene_.triangles[t];
  const glm::vec3 a = scene_.positions_m[i.x];
  const glm::vec3 target = a + place.x * (scene_.positions_m[i.y] - a) + place.y * (scene_.positions_m[i.z] - a);
  if (target == at.origin_m) return glm::vec3(0.0f);
  const glm::vec3 direction = glm::normalize(target - at.origin_m);
  const float cosine = at.cosine(direction);
  if (!(cosine > 0.0f)) return glm::vec3(0.0f);
  // Seen is what a ray that goes there would hit, as for those that find it by chance: both know the same scene.
  const SurfaceHit hit = rays_.closest(at.origin_m, direction);
  if (!hit.hit || hit.triangle != t) return glm::vec3(0.0f);
  is_marked = marked_[t];
  const float density = area_density(hit, direction), by_hit = cosine / kPi;
  const float weight = sampling_ == Sampling::kAreas ? 1.0f : density / (density + by_hit);
  return emission_at(scene_, t, hit.barycentric, kFootprint_m) * (cosine * weight / density);
}

ArrivingLight ReferenceLight::path(glm::vec3 position_m, glm::vec3 geometric_normal, glm::vec3 normal,
                                   std::mt19937& random) const {
  ArrivingLight light;
  Place at{position_m + geometric_normal * ray_offset_m(position_m), geometric_normal, normal};
  glm::vec3 share(1.0f);
  for (int bounce = 0;; ++bounce) {
    const auto part = [&](bool is_marked) -> glm::vec3& {
      return bounce > 0 ? light.reflected : is_marked ? light.marked : light.unmarked;
    };
    (bounce > 0 ? light.reflected : light.lights) += share * punctual(at, random);
    if (sampling_ != Sampling::kHits) {
      bool is_marked = false;
      const glm::vec3 lux = emissive(at, random, is_marked);
      part(is_marked) += share * lux;
    }
    glm::vec3 u, v;
    frame(at.normal, u, v);
    const float square = unit(random), turn = 2.0f * kPi * unit(random);
    const glm::vec3 direction = glm::normalize(std::sqrt(square) * (std::cos(turn) * u + std::sin(turn) * v) +
                                               std::sqrt(1.0f - square) * at.normal);
    const float by_hit = at.cosine(direction) / kPi;
    if (!(by_hit > 0.0f)) return light;
    const SurfaceHit hit = rays_.closest(at.origin_m, direction);
    if (!hit.hit) {
      part(false) += share * kPi * scene_.sky.radiance(direction);
      return light;
    }
    const SurfacePoint surface = surface_at(scene_, hit, direction, kFootprint_m);
    if (surface.unlit) return light;
    if (per_m2_[hit.triangle] > 0.0f && sampling_ != Sampling::kAreas) {
      const float density = sampling_ == Sampling::kHits ? 0.0f : area_density(hit, direction);
      part(marked_[hit.triangle]) += share * kPi * emission_at(scene_, hit.triangle, hit.barycentric, kFootprint_m) *
                                     (by_hit / (by_hit + density));
    }
    share *= surface.albedo;
    if (bounce >= kSureBounces) {
      const float survival = std::min(strongest(share), 1.0f);
      if (!(unit(random) < survival)) return light;
      share /= survival;
    }
    if (share == glm::vec3(0.0f)) return light;
    at = {surface.position_m + surface.geometric_normal * ray_offset_m(surface.position_m), surface.geometric_normal,
          surface.normal};
  }
}

}  // namespace probewalk::bench
