#include "content/bake/light_field.h"

#include <fmt/format.h>
#include <tbb/combinable.h>
#include <tbb/global_control.h>

#include <functional>
#include <numbers>
#include <optional>
#include <span>

#include "content/bake/cache_points.h"
#include "content/bake/direct_light.h"
#include "content/bake/irradiance_cache.h"
#include "content/bake/point_refinement.h"
#include "content/bake/surface_point.h"
#include "content/pack/pack_io.h"

namespace probewalk {
namespace {

// More points than this take longer to gather than they add; the spacing is raised instead.
constexpr std::size_t kMaxPoints = 300000;

}  // namespace

struct LightField::Impl {
  Impl(const Scene& scene_in, const RayScene& rays_in, const LightOptions& options, Progress& progress,
       std::vector<CachedLight> kept)
      : scene(scene_in),
        rays(rays_in),
        points(scene_in, rays_in, options.cache_spacing_m, kMaxPoints, progress),
        direct(scene_in, rays_in, points, progress),
        gather(scene_in, rays_in, direct, points, options.seed, progress),
        refinement(refine_points(scene_in, rays_in, gather, IrradianceCache::kFirstGather * options.samples, points,
                                 progress)),
        cache(points, gather, options, refinement, progress, std::move(kept)) {}

  const Scene& scene;
  const RayScene& rays;
  CachePoints points;
  DirectLight direct;
  LightGather gather;
  LightRefinement refinement;
  IrradianceCache cache;
  LightListener* listener = nullptr;
  mutable tbb::combinable<std::uint64_t> rays_cast{[] { return std::uint64_t(0); }};
};

LightField::LightField(const Scene& scene, const RayScene& rays, const LightOptions& options, Progress& progress,
                       std::vector<CachedLight> kept) {
  std::optional<tbb::global_control> limit;
  if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, options.threads);
  impl_ = std::make_unique<Impl>(scene, rays, options, progress, std::move(kept));
  if (impl_->points.spacing_m() > 1.001 * options.cache_spacing_m) {
    progress.note(fmt::format("indirect light is cached every {:.2f} m instead of {:.2f} m: the scene is large",
                              impl_->points.spacing_m(), options.cache_spacing_m));
  }
  const LightRefinement& refined = impl_->refinement;
  if (refined.added > 0) {
    progress.note(
        fmt::format("light is cached at {} points, {} of them closer together where light changes: their "
                    "neighbours were off by more than {:.0f} % at a twentieth of the points, and are by {:.0f} %",
                    impl_->points.size(), refined.added, 100.0 * refined.error_before, 100.0 * refined.error_after));
  }
  if (refined.rays_share < 1.0) {
    progress.note(
        fmt::format("light is gathered at {} points by {:.0f} % of the rays that its noise asks for: more would "
                    "take too long",
                    impl_->points.size(), 100.0 * refined.rays_share));
  }
}

LightField::~LightField() = default;

glm::vec3 LightField::outgoing(const SurfaceHit& hit, glm::vec3, glm::vec3 unit_direction, float footprint_m,
                               glm::vec3* irradiance) const {
  if (irradiance) *irradiance = glm::vec3(0.0f);
  const SurfacePoint point = surface_at(impl_->scene, hit, unit_direction, footprint_m);
  if (point.unlit || point.albedo == glm::vec3(0.0f)) return point.emission_cd_m2;
  const glm::vec3 direct =
      impl_->direct.irradiance(point.position_m, point.geometric_normal, point.normal, impl_->rays_cast.local());
  const glm::vec3 indirect = impl_->cache.indirect(point.position_m, point.normal);
  if (LightListener* listener = impl_->listener) {
    listener->lit(point.position_m, impl_->direct.grid().lists_all(point.position_m, point.geometric_normal));
    impl_->points.for_each_used(point.position_m, point.normal, [&](std::uint32_t p) { listener->used(p); });
  }
  if (irradiance) *irradiance = direct + indirect;
  return point.emission_cd_m2 + point.albedo * std::numbers::inv_pi_v<float> * (direct + indirect);
}

glm::vec3 LightField::outgoing_lit(const SurfaceHit& hit, glm::vec3 unit_direction, float footprint_m,
                                   glm::vec3 irradiance) const {
  const SurfacePoint point = surface_at(impl_->scene, hit, unit_direction, footprint_m);
  if (point.unlit) return point.emission_cd_m2;
  return point.emission_cd_m2 + point.albedo * std::numbers::inv_pi_v<float> * irradiance;
}

glm::vec3 LightField::along(glm::vec3 origin_m, glm::vec3 unit_direction, float spread_rad, SurfaceHit* hit,
                            glm::vec3* irradiance) const {
  const SurfaceHit found = impl_->rays.closest(origin_m, unit_direction);
  if (hit) *hit = found;
  if (!found.hit) return impl_->scene.sky.radiance(unit_direction);
  return outgoing(found, origin_m, unit_direction, found.t * spread_rad, irradiance);
}

glm::vec3 LightField::indirect(glm::vec3 position_m, glm::vec3 normal) const {
  return impl_->cache.indirect(position_m, normal);
}

std::uint64_t LightField::rays_cast() const {
  return impl_->points.rays_cast() + impl_->direct.rays_cast() + impl_->gather.rays_cast() +
         impl_->rays_cast.combine(std::plus<>());
}

std::size_t LightField::cache_points() const {
  return impl_->points.size();
}

const std::vector<CachedLight>& LightField::cache_values() const {
  return impl_->cache.values();
}

const CachePoints& LightField::points() const {
  return impl_->points;
}

const DirectLight& LightField::direct() const {
  return impl_->direct;
}

void LightField::tell(LightListener* listener) const {
  impl_->listener = listener;
}

std::string LightField::hash() const {
  return content_hash(std::as_bytes(std::span(impl_->cache.values())));
}

}  // namespace probewalk
