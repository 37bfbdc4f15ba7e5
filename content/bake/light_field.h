// Outgoing radiance at any surface point: one deterministic, view-independent function that the bake and the reference
// pictures share, so that errors measured are errors of the probes. Direct light by next-event estimation over a fixed
// low-discrepancy pattern (eight shadow rays, more only where more lights shine), indirect from irradiance cached on
// the surfaces, more densely where it changes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "content/bake/cached_light.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

// Raised when the same scene and options get other light, lest a bake go on from what an earlier baker has kept.
inline constexpr int kLightVersion = 4;

struct LightOptions {
  int bounces = 1;    // gathered one by one; all that follow are gathered together. 0: nothing is reflected
  int samples = 128;  // rays a cache point and bounce
  double cache_spacing_m = 0.25;
  std::uint32_t seed = 1;
  int threads = 0;  // 0 = all
};

class CachePoints;
class DirectLight;

// Is told what outgoing() reads beside surfaces and rays, from any thread.
class LightListener {
 public:
  virtual ~LightListener() = default;
  // Light was asked for at a place; by_all: what arrives there was looked for from all emitters alike.
  virtual void lit(glm::vec3 position_m, bool by_all) = 0;
  // The value of a cache point counted.
  virtual void used(std::uint32_t point) = 0;
};

class LightField {
 public:
  // Builds the irradiance cache (long: reports progress, obeys cancellation). Deterministic, whatever the threads.
  // kept: cache_values() of an equal scene and equal options, which spare the work; others than that many are ignored.
  LightField(const Scene& scene, const RayScene& rays, const LightOptions& options, Progress& progress,
             std::vector<CachedLight> kept = {});
  ~LightField();
  LightField(const LightField&) = delete;
  LightField& operator=(const LightField&) = delete;

  // Radiance in cd/m^2 that leaves the hit point towards -direction; footprint_m is the width of the ray's footprint on
  // a surface facing it (for texture filtering); `irradiance` receives the light that arrives there (lux). Thread-safe.
  glm::vec3 outgoing(const SurfaceHit& hit, glm::vec3 origin_m, glm::vec3 unit_direction, float footprint_m,
                     glm::vec3* irradiance = nullptr) const;
  // outgoing() under light that the caller already knows (lux): material and emission only, no shadow rays.
  glm::vec3 outgoing_lit(const SurfaceHit& hit, glm::vec3 unit_direction, float footprint_m,
                         glm::vec3 irradiance) const;
  // Radiance along a ray: outgoing() of what it meets, else the sky. spread_rad is the ray's angular width.
  glm::vec3 along(glm::vec3 origin_m, glm::vec3 unit_direction, float spread_rad, SurfaceHit* hit = nullptr,
                  glm::vec3* irradiance = nullptr) const;

  // Irradiance (lux) at a surface point with unit normal from everything that is not sampled directly: sky, large
  // emitters, reflected light. Thread-safe.
  glm::vec3 indirect(glm::vec3 position_m, glm::vec3 normal) const;

  // Content hash of everything the cache holds; equal between two builds of the same scene and options.
  std::string hash() const;
  // Rays cast so far: by the cache, and shadow rays by outgoing().
  std::uint64_t rays_cast() const;
  std::size_t cache_points() const;
  const std::vector<CachedLight>& cache_values() const;

  // What the field is made of, and whom to tell of what is read from it (null = nobody; not while it is read).
  const CachePoints& points() const;
  const DirectLight& direct() const;
  void tell(LightListener* listener) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace probewalk
