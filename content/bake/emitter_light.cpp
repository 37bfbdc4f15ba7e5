#include "content/bake/emitter_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "content/bake/patterns.h"
#include "content/bake/polygon_light.h"
#include "content/bake/surface_point.h"

namespace probewalk {
namespace {

constexpr float kFarAway_m = 1e6f;

// A directional light is taken for the sun: half of 0.53 degrees, which makes its shadows as soft as they are far.
constexpr float kSunRadius_rad = 0.004625f;
// The disc in sixteen equal areas, an outer ring and an inner one; the first four are spread round the rim, so that
// where they agree the rest would too.
constexpr int kDiscSamples = 16;
constexpr int kDiscScouts = 4;
glm::vec2 disc_sample(int k) {
  constexpr std::array<int, 8> kRound{0, 4, 2, 6, 1, 5, 3, 7};
  const bool outer = k < kDiscSamples / 2;
  const float turn = float(kRound[std::size_t(k % 8)]) + (outer ? 0.0f : 0.5f);
  const float radius = std::sqrt(outer ? 0.75f : 0.25f), angle = 0.25f * std::numbers::pi_v<float> * turn;
  return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

// KHR_lights_punctual: the window that ends a light at its range.
float range_window(const Light& light, float distance_m) {
  if (!(light.range_m > 0.0f)) return 1.0f;
  const float ratio = distance_m / light.range_m;
  return std::clamp(1.0f - ratio * ratio * ratio * ratio, 0.0f, 1.0f);
}

// KHR_lights_punctual: distance, range window and cone.
float attenuation(const Light& light, glm::vec3 to_light, float distance_m) {
  const float value = range_window(light, distance_m) / std::max(distance_m * distance_m, 1e-4f);
  if (light.kind != Light::Kind::kSpot) return value;
  const float inner = std::cos(light.inner_cone_rad), outer = std::cos(light.outer_cone_rad);
  const float cone = (glm::dot(light.direction, -to_light) - outer) / std::max(0.001f, inner - outer);
  const float clamped = std::clamp(cone, 0.0f, 1.0f);
  return value * clamped * clamped;
}

glm::vec3 unshadowed_light(const Light& light, const Receiver& receiver) {
  if (light.kind == Light::Kind::kDirectional) return light.intensity * receiver.cosine(-light.direction);
  const glm::vec3 offset = light.position_m - receiver.position_m;
  const float distance_m = glm::length(offset);
  if (!(distance_m > 0.0f)) return glm::vec3(0.0f);
  const float cosine = receiver.cosine(offset / distance_m);
  return cosine > 0.0f ? light.intensity * (cosine * attenuation(light, offset / distance_m, distance_m))
                       : glm::vec3(0.0f);
}

// Irradiance from one sample of a patch. Its own extent softens the inverse square nearby (a disk seen along its axis).
glm::vec3 unshadowed_sample(const EmissivePatch& patch, const EmissivePatch::Sample& sample, const Receiver& receiver) {
  const glm::vec3 offset = sample.position_m - receiver.position_m;
  const float square = glm::dot(offset, offset);
  if (!(square > 0.0f)) return glm::vec3(0.0f);
  const glm::vec3 to_light = offset / std::sqrt(square);
  const float cosine = receiver.cosine(to_light);
  if (!(cosine > 0.0f)) return glm::vec3(0.0f);
  const float at_light = -glm::dot(sample.normal, to_light);
  if (at_light > 0.0f ? !sample.front_open : !sample.back_open) return glm::vec3(0.0f);
  return sample.weight *
         (cosine * std::abs(at_light) / (square + patch.sample_area_m2 * std::numbers::inv_pi_v<float>));
}

bool reaches(const RayScene& rays, glm::vec3 origin, glm::vec3 target, float stop_short_m) {
  const glm::vec3 offset = target - origin;
  const float distance_m = glm::length(offset);
  const float far_m = distance_m * (1.0f - 1e-4f) - stop_short_m;
  return far_m <= 0.0f || !rays.occluded(origin, offset / distance_m, 0.0f, far_m);
}

float visible_sun(const RayScene& rays, glm::vec3 origin, glm::vec3 to_light, std::uint64_t& rays_cast) {
  glm::vec3 tangent, bitangent;
  tangent_frame(to_light, tangent, bitangent);
  int seen = 0;
  for (int k = 0; k < kDiscSamples; ++k) {
    if (k == kDiscScouts && seen % kDiscScouts == 0) return seen > 0 ? 1.0f : 0.0f;
    const glm::vec2 offset = kSunRadius_rad * disc_sample(k);
    ++rays_cast;
    seen += !rays.occluded(origin, to_light + tangent * offset.x + bitangent * offset.y, 0.0f, kFarAway_m);
  }
  return static_cast<float>(seen) / kDiscSamples;
}

// Whether the receiver is so near that the patch's faces say more than its samples.
constexpr float kNearRadii = 3.0f;
constexpr float kInPlane = 1e-3f;  // radii
bool is_near(const EmissivePatch& patch, const Receiver& receiver) {
  const glm::vec3 offset = patch.centre_m - receiver.position_m;
  const float near_m = kNearRadii * patch.radius_m;
  return !patch.faces.empty() && glm::dot(offset, offset) < near_m * near_m;
}

glm::vec3 unshadowed_faces(const EmissivePatch& patch, const Receiver& receiver) {
  glm::vec3 sum(0.0f);
  for (const EmissivePatch::Face& face : patch.faces) {
    const std::array<glm::vec3, 3> corners_m{face.corners_m[0] - receiver.position_m,
                                             face.corners_m[1] - receiver.position_m,
                                             face.corners_m[2] - receiver.position_m};
    const float in_front_m = -glm::dot(corners_m[0], face.normal);
    if (std::abs(in_front_m) < kInPlane * patch.radius_m) continue;  // seen edge on; its own triangles among them
    if (in_front_m > 0.0f ? !face.front_open : !face.back_open) continue;
    sum += face.radiance * triangle_cosine_integral(corners_m, receiver.geometric_normal, receiver.normal);
  }
  return sum;
}

}  // namespace

glm::vec3 EmitterLight::unshadowed(std::uint32_t emitter, const Receiver& receiver) const {
  if (!is_patch(emitter)) return unshadowed_light(emitters_.lights[emitter].light, receiver);
  const EmissivePatch& patch = emitters_.patches[emitter - emitters_.lights.size()];
  const float behind_m = glm::dot(patch.centre_m - receiver.position_m, receiver.geometric_normal);
  if (behind_m < -patch.radius_m) return glm::vec3(0.0f);
  if (is_near(patch, receiver)) return unshadowed_faces(patch, receiver);
  glm::vec3 sum(0.0f);
  for (const EmissivePatch::Sample& sample : patch.samples) sum += unshadowed_sample(patch, sample, receiver);
  return sum;
}

float EmitterLight::power(std::uint32_t emitter) const {
  return is_patch(emitter) ? emitters_.patches[emitter - emitters_.lights.size()].power_cd
                           : strongest_channel(emitters_.lights[emitter].light.intensity);
}

float EmitterLight::strength_near(std::uint32_t emitter, glm::vec3 centre_m, float radius_m) const {
  if (is_patch(emitter)) {
    const EmissivePatch& patch = emitters_.patches[emitter - emitters_.lights.size()];
    const float distance_m = glm::length(patch.centre_m - centre_m);
    return patch.power_cd / std::max(distance_m * distance_m, radius_m * radius_m);
  }
  const Light& light = emitters_.lights[emitter].light;
  if (light.kind == Light::Kind::kDirectional) return power(emitter);
  const float distance_m = glm::length(light.position_m - centre_m);
  return power(emitter) * range_window(light, std::max(distance_m - radius_m, 0.0f)) /
         std::max(distance_m * distance_m, radius_m * radius_m);
}

float EmitterLight::visible_fraction(std::uint32_t emitter, int ray_count, const Receiver& receiver,
                                     std::uint64_t& rays_cast) const {
  const glm::vec3 origin = receiver.position_m + receiver.geometric_normal * ray_offset_m(receiver.position_m);
  if (!is_patch(emitter)) {
    const PunctualEmitter& punctual = emitters_.lights[emitter];
    if (punctual.light.kind == Light::Kind::kDirectional) {
      return visible_sun(rays_, origin, -punctual.light.direction, rays_cast);
    }
    ++rays_cast;
    return reaches(rays_, origin, punctual.light.position_m, punctual.lamp_radius_m) ? 1.0f : 0.0f;
  }
  const EmissivePatch& patch = emitters_.patches[emitter - emitters_.lights.size()];
  float seen = 0.0f, all = 0.0f;
  for (int k = 0; k < kPatchSamples && (k < ray_count || all == 0.0f); ++k) {
    const EmissivePatch::Sample& sample = patch.samples[k];
    const float weight = luminance(unshadowed_sample(patch, sample, receiver));
    if (!(weight > 0.0f)) continue;
    all += weight;
    ++rays_cast;
    if (reaches(rays_, origin, sample.position_m, ray_offset_m(sample.position_m))) seen += weight;
  }
  return all > 0.0f ? seen / all : 0.0f;
}

glm::vec3 EmitterLight::irradiance_by_one(std::uint32_t emitter, std::uint32_t word, const Receiver& receiver,
                                          std::uint64_t& rays_cast) const {
  const glm::vec3 origin = receiver.position_m + receiver.geometric_normal * ray_offset_m(receiver.position_m);
  if (is_patch(emitter)) {
    const EmissivePatch& patch = emitters_.patches[emitter - emitters_.lights.size()];
    std::uint32_t chosen = word % kPatchSamples;
    glm::vec3 value(0.0f);
    if (is_near(patch, receiver)) {
      // A sample by what it sends, for whether light arrives; the faces for how much.
      std::array<float, kPatchSamples> sums{};
      float sum = 0.0f;
      for (std::uint32_t k = 0; k < kPatchSamples; ++k) {
        sums[k] = sum += luminance(unshadowed_sample(patch, patch.samples[k], receiver));
      }
      if (!(sum > 0.0f)) return glm::vec3(0.0f);
      const float at = static_cast<float>(word >> 8) * (1.0f / 16777216.0f) * sum;
      chosen = std::min(std::uint32_t(std::upper_bound(sums.begin(), sums.end(), at) - sums.begin()),
                        std::uint32_t(kPatchSamples - 1));
      value = unshadowed_faces(patch, receiver);
    } else {
      value = float(kPatchSamples) * unshadowed_sample(patch, patch.samples[chosen], receiver);
    }
    const EmissivePatch::Sample& sample = patch.samples[chosen];
    if (!(strongest_channel(value) > 0.0f)) return glm::vec3(0.0f);
    ++rays_cast;
    return reaches(rays_, origin, sample.position_m, ray_offset_m(sample.position_m)) ? value : glm::vec3(0.0f);
  }
  const PunctualEmitter& punctual = emitters_.lights[emitter];
  const glm::vec3 value = unshadowed_light(punctual.light, receiver);
  if (!(strongest_channel(value) > 0.0f)) return glm::vec3(0.0f);
  ++rays_cast;
  if (punctual.light.kind != Light::Kind::kDirectional) {
    return reaches(rays_, origin, punctual.light.position_m, punctual.lamp_radius_m) ? value : glm::vec3(0.0f);
  }
  const glm::vec3 to_light = -punctual.light.direction;
  glm::vec3 tangent, bitangent;
  tangent_frame(to_light, tangent, bitangent);
  const glm::vec2 offset = kSunRadius_rad * disc_sample(int(word % kDiscSamples));
  const glm::vec3 direction = to_light + tangent * offset.x + bitangent * offset.y;
  return rays_.occluded(origin, direction, 0.0f, kFarAway_m) ? glm::vec3(0.0f) : value;
}

}  // namespace probewalk
