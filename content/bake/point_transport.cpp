#include "content/bake/point_transport.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "content/bake/patterns.h"
#include "content/bake/surface_point.h"
#include "content/error.h"

namespace probewalk {
namespace {

constexpr std::size_t kMostRays = 8'000'000;  // 16 bytes each
constexpr std::uint32_t kPass = 104, kChoice = 105;
// A part is done when a reflection adds less than this to what came before; what would follow is added by its ratio to
// the one before.
constexpr double kEnough = 0.002;
constexpr int kMostReflections = 400;

}  // namespace

PointTransport::PointTransport(const Scene& scene, const RayScene& rays, const CachePoints& points, int rays_per_point,
                               std::uint32_t seed, Progress& progress)
    : rays_per_point_(std::clamp(rays_per_point, 1, int(kMostRays / std::max<std::size_t>(points.size(), 1)) + 1)),
      ends_(std::size_t(rays_per_point_) * points.size()) {
  const auto count = static_cast<std::uint32_t>(rays_per_point_);
  PointSets parts(points.size());
  std::atomic<std::uint64_t> done{0};
  tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t k) {
    if (progress.cancelled()) return;
    const CachePoints::Point& point = points[k];
    const std::uint32_t turn = mix_place(point.position_m, seed + kPass), choice = mix_bits(turn, kChoice);
    glm::vec3 tangent, bitangent;
    tangent_frame(point.normal, tangent, bitangent);
    const glm::vec3 origin = point.position_m + point.geometric_normal * ray_offset_m(point.position_m);
    for (std::uint32_t s = 0; s < count; ++s) {
      const glm::vec3 local = cosine_direction(rotate_pattern(hammersley(s, count), turn));
      const glm::vec3 direction = tangent * local.x + bitangent * local.y + point.normal * local.z;
      if (glm::dot(direction, point.geometric_normal) <= 0.0f) continue;
      const SurfaceHit hit = rays.closest(origin, direction);
      if (!hit.hit) continue;
      const SurfacePoint surface = surface_at(scene, hit, direction, hit.t / std::sqrt(float(count)));
      if (surface.unlit || surface.albedo == glm::vec3(0.0f)) continue;
      const std::optional<std::uint32_t> end =
          points.one_seen(surface.position_m, surface.normal, rays, golden_sequence(s, choice));
      if (!end) continue;
      ends_[k * count + s] = {*end, surface.albedo};
      parts.join(std::uint32_t(k), *end);
    }
    if (++done % 1024 == 0) progress.advance(1024);
  });
  if (progress.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
  first_of_.resize(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) first_of_[k] = parts.first_of(k);
}

std::vector<glm::vec3> PointTransport::reflected(const std::vector<CachedLight>& light) const {
  const std::size_t count = first_of_.size();
  const float per_ray = 1.0f / static_cast<float>(rays_per_point_);
  std::vector<glm::vec3> sum(count, glm::vec3(0.0f)), last(count), next(count);
  for (std::size_t k = 0; k < count; ++k) last[k] = light[k].lux;

  struct Part {
    glm::dvec3 before{0.0}, added{0.0}, all{0.0};
    bool done = false;
  };
  std::vector<Part> parts(count);  // at their first points
  for (std::size_t k = 0; k < count; ++k) parts[first_of_[k]].added += glm::dvec3(last[k]);
  bool all_done = false;
  for (int reflection = 0; !all_done; ++reflection) {
    tbb::parallel_for(std::size_t(0), count, [&](std::size_t k) {
      glm::vec3 arrived(0.0f);
      if (!parts[first_of_[k]].done) {
        for (std::size_t r = k * rays_per_point_; r < (k + 1) * rays_per_point_; ++r) {
          if (ends_[r].point != kNowhere) arrived += ends_[r].albedo * last[ends_[r].point];
        }
      }
      next[k] = arrived * per_ray;
    });
    last.swap(next);
    for (Part& part : parts) part.before = part.added, part.added = glm::dvec3(0.0);
    for (std::size_t k = 0; k < count; ++k) {
      sum[k] += last[k];
      Part& part = parts[first_of_[k]];
      part.added += glm::dvec3(last[k]);
      part.all += glm::dvec3(last[k]);
    }
    all_done = true;
    for (std::size_t k = 0; k < count; ++k) {
      Part& part = parts[k];
      if (part.done || first_of_[k] != k) continue;
      part.done = reflection + 1 >= kMostReflections || glm::all(glm::lessThanEqual(part.added, kEnough * part.all));
      all_done &= part.done;
    }
    // The rest of the parts that are done now, a geometric series; nothing is left of those that were done before.
    for (std::size_t k = 0; k < count; ++k) {
      const Part& part = parts[first_of_[k]];
      if (!part.done) continue;
      for (int c = 0; c < 3; ++c) {
        const double ratio = part.before[c] > 0.0 ? std::min(part.added[c] / part.before[c], double(kMaxAlbedo)) : 0.0;
        sum[k][c] += static_cast<float>(last[k][c] * ratio / (1.0 - ratio));
      }
    }
  }
  return sum;
}

}  // namespace probewalk
