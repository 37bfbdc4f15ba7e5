#include "content/bake/cache_points.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "content/bake/patterns.h"
#include "content/bake/point_scatter.h"
#include "content/bake/surface_point.h"
#include "content/error.h"
#include "content/pack/pack_io.h"

namespace probewalk {
namespace {

constexpr float kCellPerReach = 0.5f;   // smaller cells list fewer points in vain, in more lists
constexpr float kLookHeight_m = 0.02f;  // thinner things (a rug's edge) do not part a surface, but between close points
constexpr float kLookTilt = 0.15f;      // tangent of the angle at which the view along the surface rises
constexpr float kLookReach = 3.0f;      // in reaches: a wall must be known in the directions beside the nearest, too

// Position among kSectors directions round a point: monotone in the angle, without trigonometry.
float sector_of(float x, float y) {
  const float sum = std::abs(x) + std::abs(y);
  if (!(sum > 0.0f)) return 0.0f;
  const float quarter = y / sum;  // 0 at +x, 1 at +y
  const float turn = x >= 0.0f ? (y >= 0.0f ? quarter : 4.0f + quarter) : 2.0f - quarter;
  return turn * (CachePoints::kSectors / 4.0f);
}

// The direction that sector_of maps to `sector`.
glm::vec2 sector_direction(int sector) {
  const float turn = static_cast<float>(sector) * 4.0f / CachePoints::kSectors;
  const float y = turn <= 1.0f ? turn : turn <= 3.0f ? 2.0f - turn : turn - 4.0f;
  const float x = turn <= 2.0f ? 1.0f - turn : turn - 3.0f;
  return glm::normalize(glm::vec2(x, y));
}

}  // namespace

CachePoints::CachePoints(const Scene& scene, const RayScene& rays, double spacing_m, std::size_t max_points,
                         Progress& progress) {
  ScatteredPoints scattered = scatter_points(scene, rays, spacing_m, max_points, progress);
  spacing_m_ = scattered.spacing_m;
  points_ = std::move(scattered.points);
  rays_cast_ = scattered.rays_cast;
  look_around(rays, 0, progress);
  build_levels(0);
}

void CachePoints::add(std::vector<Point> closer, const RayScene& rays, Progress& progress) {
  const std::size_t first = points_.size();
  points_.insert(points_.end(), closer.begin(), closer.end());
  look_around(rays, first, progress);
  build_levels(first);
}

void CachePoints::look_around(const RayScene& rays, std::size_t first, Progress& progress) {
  tbb::parallel_for(first, points_.size(), [&](std::size_t k) {
    if (progress.cancelled()) return;
    Point& point = points_[k];
    look_up(rays, point);
    const glm::vec3 n = point.geometric_normal;
    glm::vec3 tangent, bitangent;
    tangent_frame(point.normal, tangent, bitangent);
    const float reach_m = kReachPerSpacing * point.spacing_m, height_m = look_height_m(point);
    for (int s = 0; s < kSectors; ++s) {
      const glm::vec2 along = sector_direction(s);
      const glm::vec3 direction = tangent * along.x + bitangent * along.y + n * kLookTilt;
      const SurfaceHit hit = rays.closest(point.position_m + n * height_m, direction, 0.0f, kLookReach * reach_m);
      const float nearness = kNearSteps * reach_m / std::max(hit.t, 1e-4f);
      point.nearness[s] = hit.hit ? static_cast<std::uint8_t>(std::min(nearness, 255.0f)) : 0;
    }
  });
  if (progress.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
  rays_cast_ += (points_.size() - first) * (kSectors + 1);
}

void CachePoints::look_up(const RayScene& rays, Point& point) const {
  const float heard_m = kReachPerSpacing * point.spacing_m / kOffPlane;
  const glm::vec3 from = point.position_m + point.geometric_normal * ray_offset_m(point.position_m);
  const SurfaceHit hit = rays.closest(from, point.geometric_normal, 0.0f, heard_m);
  point.cover_m = hit.hit ? hit.t : kNoCover;
}

float CachePoints::look_height_m(const Point& point) const {
  return std::min(kLookHeight_m * point.spacing_m / spacing_m_, 0.5f * point.cover_m);
}

// Each level with all its points again where one of them is new.
void CachePoints::build_levels(std::size_t first) {
  std::set<float> changed;
  for (std::size_t k = first; k < points_.size(); ++k) changed.insert(points_[k].spacing_m);
  std::map<float, std::vector<PointIndex::Influence>, std::greater<>> by_spacing;
  std::vector<PointIndex::Influence> closer;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const float spacing_m = points_[k].spacing_m;
    if (!changed.contains(spacing_m)) continue;
    by_spacing[spacing_m].push_back(influence(k));
    if (k >= first && spacing_m != points_.front().spacing_m) closer.push_back(influence(k));
  }
  for (const auto& [spacing_m, influences] : by_spacing) {
    const float reach_m = kReachPerSpacing * spacing_m;
    const auto at = std::ranges::find_if(levels_, [&](const Level& level) { return level.reach_m <= reach_m; });
    const auto level = at != levels_.end() && at->reach_m == reach_m ? at : levels_.insert(at, Level{reach_m, {}});
    level->index = PointIndex(influences, kCellPerReach * reach_m);
  }
  if (!levels_.empty()) levels_.front().index.mark_closer(closer);
}

// 1 where the place lies well within the point's free surroundings, falling to 0 at whatever closes them.
float CachePoints::open_fraction(const Point& point, glm::vec3 offset, float tangential_m) const {
  glm::vec3 tangent, bitangent;
  tangent_frame(point.normal, tangent, bitangent);
  const float sector = sector_of(glm::dot(offset, tangent), glm::dot(offset, bitangent));
  const int low = static_cast<int>(sector);
  const float part = sector - static_cast<float>(low);
  const std::uint8_t a = point.nearness[low % kSectors], b = point.nearness[(low + 1) % kSectors];
  if (a == 0 && b == 0) return 1.0f;
  const float nearness = static_cast<float>(a) * (1.0f - part) + static_cast<float>(b) * part;
  const float reach_m = kReachPerSpacing * point.spacing_m, free_m = kNearSteps * reach_m / nearness;
  return std::clamp((free_m - tangential_m) / (0.15f * reach_m), 0.0f, 1.0f);
}

glm::vec3 CachePoints::interpolate(const std::vector<CachedLight>& values, glm::vec3 position_m,
                                   glm::vec3 normal) const {
  glm::vec3 open_sum(0.0f), blocked_sum(0.0f);
  float blocked_weights = 0.0f;
  const float open_weights = for_each_weight(position_m, normal, [&](std::uint32_t point, float open, float blocked) {
    const glm::vec3 lux = values[point].at(normal - points_[point].normal);
    open_sum += lux * open;
    blocked_sum += lux * blocked;
    blocked_weights += blocked;
  });
  if (open_weights > kVanishing) return open_sum / open_weights;
  // No point sees the place: any light is better there than none. Elsewhere one behind a wall has no say at all, or
  // what changes in a closed room would change the next.
  return blocked_weights > kVanishing ? blocked_sum / blocked_weights : glm::vec3(0.0f);
}

glm::vec3 CachePoints::interpolate_seen(const std::vector<CachedLight>& values, glm::vec3 position_m, glm::vec3 normal,
                                        const RayScene& rays) const {
  glm::vec3 sum(0.0f);
  float weights = for_each_weight(position_m, normal, [&](std::uint32_t point, float open, float) {
    if (open > 0.0f) sum += values[point].at(normal - points_[point].normal) * open;
  });
  if (weights > kVanishing) return sum / weights;
  sum = glm::vec3(0.0f);
  weights = for_each_by_rays(position_m, normal, rays, [&](std::uint32_t point, float weight) {
    sum += values[point].at(normal - points_[point].normal) * weight;
  });
  return weights > kVanishing ? sum / weights : glm::vec3(0.0f);
}

template <typename Visit>
float CachePoints::for_each_by_rays(glm::vec3 position_m, glm::vec3 normal, const RayScene& rays, Visit&& visit) const {
  float sum = 0.0f;
  for_each_weight(position_m, normal, [&](std::uint32_t point, float, float blocked) {
    if (!(blocked > 0.0f)) return;
    const Point& p = points_[point];
    const float height_m = look_height_m(p);
    const glm::vec3 from = position_m + normal * height_m, to = p.position_m + p.geometric_normal * height_m;
    if (rays.occluded(from, to - from, 0.0f, 1.0f)) return;
    visit(point, blocked);
    sum += blocked;
  });
  return sum;
}

std::optional<std::uint32_t> CachePoints::one_seen(glm::vec3 position_m, glm::vec3 normal, const RayScene& rays,
                                                   float choice) const {
  thread_local std::vector<std::pair<std::uint32_t, float>> shares;
  shares.clear();
  float sum = for_each_weight(position_m, normal, [&](std::uint32_t point, float open, float) {
    if (open > 0.0f) shares.emplace_back(point, open);
  });
  if (!(sum > kVanishing)) {
    shares.clear();
    sum = for_each_by_rays(position_m, normal, rays,
                           [&](std::uint32_t point, float weight) { shares.emplace_back(point, weight); });
    if (!(sum > kVanishing)) return {};
  }
  float left = choice * sum;
  for (const auto& [point, share] : shares) {
    left -= share;
    if (left < 0.0f) return point;
  }
  return shares.back().first;
}

std::optional<glm::vec3> CachePoints::by_others(const std::vector<CachedLight>& values, std::size_t k) const {
  const Point& at = points_[k];
  glm::vec3 sum(0.0f);
  const float weights = for_each_weight(
      at.position_m, at.normal,
      [&](std::uint32_t point, float open, float) {
        if (open > 0.0f) sum += values[point].at(at.normal - points_[point].normal) * open;
      },
      std::uint32_t(k));
  if (!(weights > kVanishing)) return {};
  return sum / weights;
}

CachedLight CachePoints::mean_around(const std::vector<CachedLight>& values, std::size_t k) const {
  const Point& at = points_[k];
  CachedLight mean;
  const float weights = for_each_weight(at.position_m, at.normal, [&](std::uint32_t point, float open, float) {
    if (!(open > 0.0f)) return;
    mean.lux += values[point].at(at.normal - points_[point].normal) * open;
    mean.turn += values[point].turn * open;
  });
  return weights > kVanishing ? mean * (1.0f / weights) : values[k];
}

std::uint64_t CachePoints::identity(std::size_t k) const {
  static_assert(sizeof(Point) == 11 * sizeof(float) + kSectors, "no padding");
  return short_hash(std::as_bytes(std::span(&points_[k], 1)));
}

PointIndex::Influence CachePoints::influence(std::size_t k) const {
  const Point& point = points_[k];
  const float reach_m = kReachPerSpacing * point.spacing_m;
  return {{point.position_m, static_cast<std::uint32_t>(k), point.normal}, reach_m, reach_m / kOffPlane};
}

}  // namespace probewalk
