#include "content/bake/light_gather.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/bake/patterns.h"
#include "content/bake/point_transport.h"
#include "content/bake/surface_point.h"
#include "content/error.h"

namespace probewalk {
namespace {

constexpr int kRaysPerPick = 4;   // over the hemisphere, to one to an emitter
constexpr int kGuessBatches = 4;  // that tell the noise of a guess

}  // namespace

template <typename Work>
void LightGather::for_each_point(std::size_t first, Work&& work) {
  tbb::parallel_for(first, points_.size(), [&](std::size_t k) {
    if (progress_.cancelled()) return;
    work(k);
    if (++done_ % 1024 == 0) progress_.advance(1024);
  });
  if (progress_.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
}

void LightGather::direct(Values& values, std::size_t first) {
  values.resize(points_.size());
  for_each_point(first, [&](std::size_t k) {
    std::uint64_t cast = 0;
    const CachePoints::Point& p = points_[k];
    values[k].lux = direct_.irradiance(p.position_m, p.geometric_normal, p.normal, cast);
    rays_cast_ += cast;
  });
}

void LightGather::reflected(const Values& source, int samples, std::uint32_t pass, Values& values, Values* emitted,
                            const std::vector<std::uint32_t>* each) {
  values.resize(points_.size());
  if (emitted) emitted->resize(points_.size());
  for_each_point(0, [&](std::size_t k) {
    const std::uint32_t turn = mix_place(points_[k].position_m, seed_ + pass);
    const int count = each ? int((*each)[k]) : samples, batches = (count + samples - 1) / samples;
    Batch sum;
    for (int b = 0; b < batches; ++b) {
      gather_batch(k, source, count / batches, b == 0 ? turn : mix_bits(std::uint32_t(b), turn), emitted != nullptr,
                   sum);
    }
    values[k] = sum.reflected * (1.0f / static_cast<float>(batches));
    if (emitted) (*emitted)[k] = sum.emitted * (1.0f / static_cast<float>(batches));
  });
}

void LightGather::guess(const Values& source, int samples, std::uint32_t pass, Values& values, Values* emitted,
                        std::vector<float>* deviations, std::size_t first) {
  values.resize(points_.size());
  if (emitted) emitted->resize(points_.size());
  if (deviations) deviations->resize(points_.size());
  for_each_point(first, [&](std::size_t k) {
    const std::uint32_t turn = mix_place(points_[k].position_m, seed_ + pass);
    Batch sum;
    float squares = 0.0f;  // of the brightness of each batch
    for (std::uint32_t b = 0; b < kGuessBatches; ++b) {
      Batch batch;
      gather_batch(k, source, std::max(samples / kGuessBatches, 1), mix_bits(b, turn), emitted != nullptr, batch);
      sum.reflected += batch.reflected;
      sum.emitted += batch.emitted;
      squares += batch.brightness() * batch.brightness();
    }
    constexpr float kCount = kGuessBatches;
    values[k] = sum.reflected * (1.0f / kCount);
    if (emitted) (*emitted)[k] = sum.emitted * (1.0f / kCount);
    const float mean = sum.brightness() / kCount;
    if (deviations) (*deviations)[k] = std::sqrt(std::max(squares / kCount - mean * mean, 0.0f) / (kCount - 1.0f));
  });
}

std::vector<glm::vec3> LightGather::reflected_for_ever(const Values& source, int samples) {
  const PointTransport transport(scene_, rays_, points_, samples, seed_, progress_);
  rays_cast_ += transport.rays_cast();
  return transport.reflected(source);
}

LightGather::Values LightGather::smooth(const Values& values) const {
  Values smoothed(points_.size());
  tbb::parallel_for(std::size_t(0), points_.size(),
                    [&](std::size_t k) { smoothed[k] = points_.mean_around(values, k); });
  return smoothed;
}

void LightGather::gather_batch(std::size_t k, const Values& source, int samples, std::uint32_t turn, bool with_emitted,
                               Batch& batch) {
  const CachePoints::Point& point = points_[k];
  glm::vec3 tangent, bitangent;
  tangent_frame(point.normal, tangent, bitangent);
  const glm::vec3 origin = point.position_m + point.geometric_normal * ray_offset_m(point.position_m);
  const float spread_rad = std::sqrt(std::numbers::pi_v<float> / static_cast<float>(samples));
  const int picks = with_emitted && !emitters_.empty() ? std::max(samples / kRaysPerPick, 1) : 0;
  // The balance heuristic's share of light that a ray of the hemisphere, or a pick, found in a direction.
  const auto share = [&](glm::vec3 direction, float pick_density) {
    const float by_rays =
        static_cast<float>(samples) * std::max(glm::dot(direction, point.normal), 0.0f) * std::numbers::inv_pi_v<float>;
    return by_rays > 0.0f ? by_rays / (by_rays + static_cast<float>(picks) * pick_density) : 0.0f;
  };
  CachedLight sum, own;
  std::uint64_t cast = static_cast<std::uint64_t>(samples);
  for (int s = 0; s < samples; ++s) {
    const glm::vec3 local = cosine_direction(rotate_pattern(hammersley(s, samples), turn));
    const glm::vec3 direction = tangent * local.x + bitangent * local.y + point.normal * local.z;
    if (glm::dot(direction, point.geometric_normal) <= 0.0f) continue;
    const SurfaceHit hit = rays_.closest(origin, direction);
    if (!hit.hit) {
      if (with_emitted) own.add(scene_.sky.radiance(direction), direction, point.normal);
      continue;
    }
    const SurfacePoint surface = surface_at(scene_, hit, direction, hit.t * spread_rad);
    if (surface.unlit) continue;
    if (with_emitted && !direct_.emitters().is_patch[hit.triangle]) {
      own.add(surface.emission_cd_m2 * share(direction, emitters_.density(hit, direction)), direction, point.normal);
    }
    sum.add(surface.albedo * points_.interpolate_seen(source, surface.position_m, surface.normal, rays_), direction,
            point.normal);
  }
  for (int s = 0; s < picks; ++s) {
    const GatheredEmitters::Sample sample =
        emitters_.pick(origin, point.normal, golden_sequence(std::uint32_t(s), ~turn),
                       rotate_pattern(r2_sequence(std::uint32_t(s)), mix_bits(turn, 1)), cast);
    if (!(glm::dot(sample.direction, point.geometric_normal) > 0.0f)) continue;
    own.add(sample.radiance * share(sample.direction, sample.density), sample.direction, point.normal);
  }
  rays_cast_ += cast;
  // Cosine-distributed: irradiance = pi * mean radiance; reflected radiance = albedo / pi * irradiance.
  batch.reflected += sum * (1.0f / static_cast<float>(samples));
  batch.emitted += own * (std::numbers::pi_v<float> / static_cast<float>(samples));
}

}  // namespace probewalk
