#include "content/bake/direct_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "content/bake/patterns.h"
#include "content/bake/surface_point.h"

namespace probewalk {
namespace {

// A light fades out between these shares of all the light that arrives unshadowed: less is not worth a ray.
constexpr float kFadeStart = 0.010f;
constexpr float kFadeEnd = 0.003f;
constexpr float kRankFade = 1.5f;  // the weakest light with a ray is full only this far above the first without
constexpr float kLeastSay = 1e-3f;  // share of a faded light's vote on what those without a ray are worth
constexpr float kFarAway_m = 1e6f;

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

struct Receiver {
  glm::vec3 position_m, geometric_normal, normal;
  // Cosine at the surface for a unit direction towards light; 0 behind either normal.
  float cosine(glm::vec3 to_light) const {
    return glm::dot(geometric_normal, to_light) > 0.0f ? std::max(glm::dot(normal, to_light), 0.0f) : 0.0f;
  }
};

struct Candidate {
  float estimate = 0.0f;  // luminance of the unshadowed irradiance
  glm::vec3 irradiance{0.0f};
  const PunctualEmitter* light = nullptr;  // this or
  const EmissivePatch* patch = nullptr;    // this
  int rays = 1;
};

// The strongest candidates, strongest first; one more than there are rays, to know what the first left out is worth.
class Strongest {
 public:
  int count() const { return count_; }
  Candidate& operator[](int k) { return slots_[k]; }
  // Below this a candidate cannot enter.
  float threshold() const { return count_ == int(slots_.size()) ? slots_.back().estimate : 0.0f; }
  void offer(const Candidate& candidate) {
    if (!(candidate.estimate > threshold())) return;
    int place = count_ < int(slots_.size()) ? count_++ : count_ - 1;
    for (; place > 0 && slots_[place - 1].estimate < candidate.estimate; --place) slots_[place] = slots_[place - 1];
    slots_[place] = candidate;
  }

 private:
  std::array<Candidate, kShadowRays + 1> slots_;
  int count_ = 0;
};

// KHR_lights_punctual: distance, range window and cone.
float attenuation(const Light& light, glm::vec3 to_light, float distance_m) {
  float value = 1.0f / std::max(distance_m * distance_m, 1e-4f);
  if (light.range_m > 0.0f) {
    const float ratio = distance_m / light.range_m;
    value *= std::clamp(1.0f - ratio * ratio * ratio * ratio, 0.0f, 1.0f);
  }
  if (light.kind == Light::Kind::kSpot) {
    const float inner = std::cos(light.inner_cone_rad), outer = std::cos(light.outer_cone_rad);
    const float cone = std::clamp((glm::dot(light.direction, -to_light) - outer) / std::max(0.001f, inner - outer), 0.0f, 1.0f);
    value *= cone * cone;
  }
  return value;
}

glm::vec3 unshadowed(const Light& light, const Receiver& receiver) {
  if (light.kind == Light::Kind::kDirectional) return light.intensity * receiver.cosine(-light.direction);
  const glm::vec3 offset = light.position_m - receiver.position_m;
  const float distance_m = glm::length(offset);
  if (!(distance_m > 0.0f)) return glm::vec3(0.0f);
  const float cosine = receiver.cosine(offset / distance_m);
  return cosine > 0.0f ? light.intensity * (cosine * attenuation(light, offset / distance_m, distance_m))
                       : glm::vec3(0.0f);
}

// Irradiance from one sample of a patch. Its own extent softens the inverse square nearby (a disk seen along its axis).
glm::vec3 unshadowed(const EmissivePatch& patch, const EmissivePatch::Sample& sample, const Receiver& receiver) {
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

glm::vec3 unshadowed(const EmissivePatch& patch, const Receiver& receiver) {
  glm::vec3 sum(0.0f);
  for (const EmissivePatch::Sample& sample : patch.samples) sum += unshadowed(patch, sample, receiver);
  return sum;
}

// No point of the patch can send more than this.
float upper_bound(const EmissivePatch& patch, const Receiver& receiver) {
  const glm::vec3 offset = patch.centre_m - receiver.position_m;
  if (glm::dot(offset, receiver.geometric_normal) < -patch.radius_m) return 0.0f;
  const float nearest_m = std::max(glm::length(offset) - patch.radius_m, 0.0f);
  return patch.power_cd / (nearest_m * nearest_m + patch.sample_area_m2 * std::numbers::inv_pi_v<float>);
}

// Rays that are left over go where they soften a shadow most.
void share_out_rays(Strongest& strongest, int count) {
  for (int spare = kShadowRays - count; spare > 0; --spare) {
    Candidate* best = nullptr;
    float best_gain = 0.0f;
    for (int k = 0; k < count; ++k) {
      Candidate& candidate = strongest[k];
      if (!candidate.patch || candidate.rays >= kPatchSamples) continue;
      const float gain = candidate.estimate / static_cast<float>(candidate.rays * candidate.rays);
      if (gain > best_gain) {
        best_gain = gain;
        best = &candidate;
      }
    }
    if (!best) return;
    ++best->rays;
  }
}

bool reaches(const RayScene& rays, glm::vec3 origin, glm::vec3 target, float stop_short_m) {
  const glm::vec3 offset = target - origin;
  const float distance_m = glm::length(offset);
  const float far_m = distance_m * (1.0f - 1e-4f) - stop_short_m;
  return far_m <= 0.0f || !rays.occluded(origin, offset / distance_m, 0.0f, far_m);
}

float visible_fraction(const RayScene& rays, const PunctualEmitter& emitter, glm::vec3 origin, std::uint64_t& cast) {
  ++cast;
  if (emitter.light.kind == Light::Kind::kDirectional) {
    return rays.occluded(origin, -emitter.light.direction, 0.0f, kFarAway_m) ? 0.0f : 1.0f;
  }
  return reaches(rays, origin, emitter.light.position_m, emitter.lamp_radius_m) ? 1.0f : 0.0f;
}

float visible_fraction(const RayScene& rays, const EmissivePatch& patch, int count, const Receiver& receiver,
                       glm::vec3 origin, std::uint64_t& cast) {
  float seen = 0.0f, all = 0.0f;
  for (int k = 0; k < kPatchSamples && (k < count || all == 0.0f); ++k) {
    const float weight = luminance(unshadowed(patch, patch.samples[k], receiver));
    if (!(weight > 0.0f)) continue;
    all += weight;
    ++cast;
    if (reaches(rays, origin, patch.samples[k].position_m, ray_offset_m(patch.samples[k].position_m))) seen += weight;
  }
  return all > 0.0f ? seen / all : 0.0f;
}

}  // namespace

glm::vec3 DirectLight::irradiance(glm::vec3 position_m, glm::vec3 geometric_normal, glm::vec3 normal,
                                  std::uint64_t& rays_cast) const {
  const Receiver receiver{position_m, geometric_normal, normal};
  Strongest strongest;
  glm::vec3 arriving(0.0f);  // unshadowed, from all
  for (const PunctualEmitter& emitter : emitters_.lights) {
    const glm::vec3 value = unshadowed(emitter.light, receiver);
    arriving += value;
    strongest.offer({luminance(value), value, &emitter, nullptr, 1});
  }
  for (const EmissivePatch& patch : emitters_.patches) {
    if (!(upper_bound(patch, receiver) > strongest.threshold())) continue;
    const glm::vec3 value = unshadowed(patch, receiver);
    arriving += value;
    strongest.offer({luminance(value), value, nullptr, &patch, 1});
  }
  if (strongest.count() == 0) return glm::vec3(0.0f);

  float total = 0.0f;
  for (int k = 0; k < strongest.count(); ++k) total += strongest[k].estimate;
  const float left_out = strongest.count() > kShadowRays ? strongest[kShadowRays].estimate : 0.0f;
  int count = std::min(strongest.count(), kShadowRays);
  while (count > 1 && strongest[count - 1].estimate <= kFadeEnd * total) --count;
  share_out_rays(strongest, count);

  const glm::vec3 origin = position_m + geometric_normal * ray_offset_m(position_m);
  glm::vec3 sum(0.0f), traced(0.0f);
  float seen_weight = 0.0f, weights = 0.0f;
  for (int k = 0; k < count; ++k) {
    const Candidate& candidate = strongest[k];
    float keep = smooth_step(kFadeEnd, kFadeStart, candidate.estimate / total);
    if (left_out > 0.0f) keep *= smooth_step(1.0f, kRankFade, candidate.estimate / left_out);
    const float seen = candidate.light
                           ? visible_fraction(rays_, *candidate.light, origin, rays_cast)
                           : visible_fraction(rays_, *candidate.patch, candidate.rays, receiver, origin, rays_cast);
    sum += candidate.irradiance * (keep * seen);
    traced += candidate.irradiance * keep;
    // Rays that fade still speak where none is full: equal lights must not fade one another out.
    const float weight = candidate.estimate * (keep + kLeastSay);
    seen_weight += weight * seen;
    weights += weight;
  }
  // What has no ray of its own is as visible as what has.
  return sum + glm::max(arriving - traced, glm::vec3(0.0f)) * (weights > 0.0f ? seen_weight / weights : 0.0f);
}

}  // namespace probewalk
