// Gathers light at cache points: what arrives straight from the emitters, and over the hemisphere what sky and surfaces
// send by themselves, and what surfaces reflect of light that the points are known to get.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "content/bake/cache_points.h"
#include "content/bake/cached_light.h"
#include "content/bake/direct_light.h"
#include "content/bake/gathered_emitters.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

class LightGather {
 public:
  using Values = std::vector<CachedLight>;  // one a point

  // All must outlive this. The points may become more.
  LightGather(const Scene& scene, const RayScene& rays, const DirectLight& direct, const CachePoints& points,
              std::uint32_t seed, Progress& progress)
      : scene_(scene),
        rays_(rays),
        direct_(direct),
        points_(points),
        emitters_(scene, rays, direct.emitters()),
        seed_(seed),
        progress_(progress) {}

  // What is filled is resized to all points; where there is a `first`, those from it on are worked on. All throw
  // Interrupted.

  // What arrives straight from the emitters.
  void direct(Values& values, std::size_t first = 0);
  // What `source`, reflected once, sends to the points, by so many rays each. emitted receives what sky and surfaces
  // send by themselves, as far as it is not sampled directly; each: by so many rays instead, by point, no more than
  // `samples` to a pattern. Both may be null. pass: chooses other directions.
  void reflected(const Values& source, int samples, std::uint32_t pass, Values& values, Values* emitted = nullptr,
                 const std::vector<std::uint32_t>* each = nullptr);
  // What becomes of `source` by all reflections together (lux), found from point to point by so many rays each.
  std::vector<glm::vec3> reflected_for_ever(const Values& source, int samples);
  // The same by few rays, and how far off it may be: deviations receives standard errors (lux), or is null.
  void guess(const Values& source, int samples, std::uint32_t pass, Values& values, Values* emitted,
             std::vector<float>* deviations, std::size_t first);
  // Each point the mean of its open neighbourhood: what few rays found (a patch of sun) must not show as a blotch.
  Values smooth(const Values& values) const;

  std::uint64_t rays_cast() const { return rays_cast_; }

 private:
  template <typename Work>
  void for_each_point(std::size_t first, Work&& work);
  struct Batch {
    CachedLight reflected, emitted;
    float brightness() const { return strongest_channel(reflected.lux + emitted.lux); }
  };
  // Adds to the batch.
  void gather_batch(std::size_t k, const Values& source, int samples, std::uint32_t turn, bool with_emitted,
                    Batch& batch);

  const Scene& scene_;
  const RayScene& rays_;
  const DirectLight& direct_;
  const CachePoints& points_;
  const GatheredEmitters emitters_;
  const std::uint32_t seed_;
  Progress& progress_;
  std::atomic<std::uint64_t> done_{0}, rays_cast_{0};
};

}  // namespace probewalk
