#include "content/bake/direct_light.h"

#include <algorithm>
#include <cmath>

#include "content/bake/patterns.h"

namespace probewalk {
namespace {

// A ray that stands for a choice of emitters carries this share of all light at least (less is not worth one), and at
// most where kMostShadowRays allow: it is how much one such ray's yes or no changes the picture.
constexpr float kLeastShare = 0.003f;
constexpr float kMostShare = 0.02f;
constexpr float kDoubtfulRays = 2.0f;
constexpr std::uint32_t kListedSeed = 0x11u, kDoubtfulSeed = 0x12u, kFarSeed = 0x13u;

struct Candidate {
  std::uint32_t emitter = 0;
  float weight = 0.0f;  // about the light that arrives (lux)
  glm::vec3 unshadowed{0.0f};
  int rays = 1;
};

float unit_float(std::uint32_t word) {
  return static_cast<float>(word >> 8) * (1.0f / 16777216.0f);
}

// The weight from which on a candidate has a ray for certain, so that the expected number of rays is `rays`; the
// others' chance is their weight over it.
float certain_weight(const std::vector<Candidate>& candidates, int rays) {
  float threshold = 1e30f;
  for (;;) {
    float small = 0.0f;
    int certain = 0;
    for (const Candidate& candidate : candidates) {
      if (candidate.weight >= threshold) {
        ++certain;
      } else {
        small += candidate.weight;
      }
    }
    if (certain >= rays) return threshold;
    const float next = small / static_cast<float>(rays - certain);
    if (!(next < threshold)) return threshold;
    threshold = next;
  }
}

// Rays that are left over go where they soften a shadow most.
void share_out_rays(const EmitterLight& light, std::vector<Candidate>& candidates, float certain, int spare) {
  for (; spare > 0; --spare) {
    Candidate* best = nullptr;
    float best_gain = 0.0f;
    for (Candidate& candidate : candidates) {
      if (candidate.weight < certain || !light.is_patch(candidate.emitter) || candidate.rays >= kPatchSamples) continue;
      const float gain = candidate.weight / static_cast<float>(candidate.rays * candidate.rays);
      if (gain > best_gain) best_gain = gain, best = &candidate;
    }
    if (!best) return;
    ++best->rays;
  }
}

}  // namespace

DirectLight::DirectLight(const Scene& scene, const RayScene& rays, const CachePoints& points, Progress& progress)
    : emitters_(find_emitters(scene, rays)), light_(emitters_, rays), grid_(light_, points, kShadowRays, progress) {
  float sum = 0.0f;
  for (std::uint32_t e = 0; e < light_.count(); ++e) power_sums_.push_back(sum += light_.power(e));
}

std::uint32_t DirectLight::pick_by_power(float at) const {
  const auto found = std::upper_bound(power_sums_.begin(), power_sums_.end(), at * power_sums_.back());
  return std::uint32_t(std::min<std::ptrdiff_t>(found - power_sums_.begin(), std::ptrdiff_t(power_sums_.size()) - 1));
}

glm::vec3 DirectLight::irradiance(glm::vec3 position_m, glm::vec3 geometric_normal, glm::vec3 normal,
                                  std::uint64_t& rays_cast) const {
  const Receiver receiver{position_m, geometric_normal, normal};
  const LightGrid::Nearby nearby = grid_.at(position_m, geometric_normal);
  thread_local std::vector<Candidate> candidates;
  candidates.clear();
  float total = 0.0f;
  for (const LightGrid::Listed& listed : nearby.listed) {
    const glm::vec3 value = light_.unshadowed(listed.emitter, receiver);
    const float weight = strongest_channel(value) * listed.visible;
    if (!(weight > 0.0f)) continue;
    candidates.push_back({listed.emitter, weight, value, 1});
    total += weight;
  }
  const float doubtful_lux = nearby.doubtful.empty() ? 0.0f : nearby.doubtful.back().sum;
  const float rest_lux = doubtful_lux + nearby.far_lux;
  if (!(total + rest_lux > 0.0f)) return glm::vec3(0.0f);

  float certain = 0.0f;
  if (candidates.size() > std::size_t(kShadowRays)) {
    certain = certain_weight(candidates, kShadowRays);
    if (certain > kMostShare * total) {
      certain = std::max(certain_weight(candidates, kMostShadowRays), kMostShare * total);
    }
    certain = std::max(certain, kLeastShare * total);
  }
  float expected_rays = 0.0f;
  for (const Candidate& candidate : candidates) {
    expected_rays += candidate.weight >= certain ? 1.0f : candidate.weight / certain;
  }
  share_out_rays(light_, candidates, certain, kShadowRays - static_cast<int>(std::ceil(expected_rays)));

  glm::vec3 sum(0.0f);
  // Systematic sampling: a ray each time the weak ones' running sum passes another `certain`.
  float passed = unit_float(mix_place(position_m, kListedSeed)) * certain;
  for (const Candidate& candidate : candidates) {
    float scale = 1.0f;
    if (candidate.weight < certain) {
      passed += candidate.weight;
      if (passed < certain) continue;
      passed -= certain;
      scale = certain / candidate.weight;
    }
    sum += candidate.unshadowed *
           (scale * light_.visible_fraction(candidate.emitter, candidate.rays, receiver, rays_cast));
  }
  const auto add_chosen = [&](std::uint32_t emitter, float scale) {
    const glm::vec3 value = light_.unshadowed(emitter, receiver);
    if (!(strongest_channel(value) > 0.0f)) return;
    sum += value * (scale * light_.visible_fraction(emitter, 1, receiver, rays_cast));
  };
  // The rest hardly ever sends anything, so it gets few rays, however much it could send.
  const float step = std::max({certain, kLeastShare * (total + rest_lux), rest_lux / kDoubtfulRays});
  for (float at = unit_float(mix_place(position_m, kDoubtfulSeed)) * step; at < doubtful_lux; at += step) {
    const auto found = std::upper_bound(nearby.doubtful.begin(), nearby.doubtful.end(), at,
                                        [](float value, const LightGrid::Doubtful& d) { return value < d.sum; });
    const std::size_t k = std::min(std::size_t(found - nearby.doubtful.begin()), nearby.doubtful.size() - 1);
    const float before = k > 0 ? nearby.doubtful[k - 1].sum : 0.0f;
    add_chosen(nearby.doubtful[k].emitter, step / (nearby.doubtful[k].sum - before));
  }
  if (nearby.far_lux > 0.0f) {
    const std::uint32_t word = mix_place(position_m, kFarSeed);
    const float chance = std::min(nearby.far_lux / step, 1.0f);
    if (unit_float(word) < chance) {
      const std::uint32_t emitter = pick_by_power(unit_float(mix_bits(word, kFarSeed)));
      if (!grid_.lists(nearby, emitter)) add_chosen(emitter, power_sums_.back() / (light_.power(emitter) * chance));
    }
  }
  return sum;
}

}  // namespace probewalk
