// Points spread over all surfaces that can be seen, both sides, about a spacing apart and closer in narrow places
// (point_scatter.h), and the smooth interpolation between them.
// A point speaks for a flat neighbourhood of its own side only, as far as the surface lies open around it: light does
// not leak under walls, through thin sheets, or out from under furniture.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "content/bake/cached_light.h"
#include "content/bake/point_index.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

class CachePoints {
 public:
  static constexpr float kOffPlane = 6.0f;  // distance across the surface counts this much more than along it
  static constexpr float kNoCover = 1e30f;
  static constexpr int kSectors = 32;  // fine enough to see along a strip as narrow as a door frame
  struct Point {
    glm::vec3 position_m{0.0f};
    glm::vec3 normal{0.0f};  // unit; shading normal of its side
    glm::vec3 geometric_normal{0.0f};
    float spacing_m = 0.0f;  // to the others around; its reach grows with it
    // How far before the surface something covers it (a picture on a wall), where that is so near that the point could
    // be heard beyond.
    float cover_m = kNoCover;
    // How near the surface around is closed, by direction: kNearSteps * reach / free way; 0 = open. The reciprocal is
    // what interpolates well: along a straight wall it is affine in the direction.
    std::array<std::uint8_t, kSectors> nearness{};
  };

  // Spacing is raised until at most max_points are needed, beside as many closer ones; spacing_m() says what it became.
  CachePoints(const Scene& scene, const RayScene& rays, double spacing_m, std::size_t max_points, Progress& progress);

  // Adds points that are closer together than the first, without their nearness.
  void add(std::vector<Point> closer, const RayScene& rays, Progress& progress);

  std::size_t size() const { return points_.size(); }
  const Point& operator[](std::size_t k) const { return points_[k]; }
  float spacing_m() const { return spacing_m_; }
  std::uint64_t rays_cast() const { return rays_cast_; }

  // Irradiance (lux) by values (one per point) at a surface position with unit normal. Thread-safe.
  glm::vec3 interpolate(const std::vector<CachedLight>& values, glm::vec3 position_m, glm::vec3 normal) const;
  // The same from points that see the place alone, which rays decide where none is known to: things stand about it.
  // Black where none does, as within walls, where few rays stray.
  glm::vec3 interpolate_seen(const std::vector<CachedLight>& values, glm::vec3 position_m, glm::vec3 normal,
                             const RayScene& rays) const;
  // One of the points that interpolate_seen() goes by, each by its share; chosen by a number of [0, 1).
  std::optional<std::uint32_t> one_seen(glm::vec3 position_m, glm::vec3 normal, const RayScene& rays,
                                        float choice) const;
  // What the others around say of the irradiance at a point; nothing where none sees it.
  std::optional<glm::vec3> by_others(const std::vector<CachedLight>& values, std::size_t k) const;
  // The mean of the values around a point, its own among them.
  CachedLight mean_around(const std::vector<CachedLight>& values, std::size_t k) const;
  // Calls visit(point) for each point whose value counts there.
  template <typename Visit>
  void for_each_used(glm::vec3 position_m, glm::vec3 normal, Visit&& visit) const {
    const float seen = for_each_weight(position_m, normal, [&](std::uint32_t point, float open, float) {
      if (open > 0.0f) visit(point);
    });
    if (seen > kVanishing) return;
    for_each_weight(position_m, normal, [&](std::uint32_t point, float, float) { visit(point); });
  }

  // A hash of all that a point is, its number not counted.
  std::uint64_t identity(std::size_t k) const;
  // Where the value of a point counts.
  PointIndex::Influence influence(std::size_t k) const;

 private:
  static constexpr float kVanishing = 1e-12f;
  static constexpr float kReachPerSpacing = 1.75f;  // five or six points speak at any place
  static constexpr float kLeastFacing = 0.2f;       // cosine below which a point says nothing
  static constexpr float kNearSteps = 12.0f;
  // Points of one spacing.
  struct Level {
    float reach_m = 0.0f;  // of a point's influence
    PointIndex index;
  };

  void look_around(const RayScene& rays, std::size_t first, Progress& progress);
  void build_levels(std::size_t first);
  void look_up(const RayScene& rays, Point& point) const;
  float look_height_m(const Point& point) const;
  float open_fraction(const Point& point, glm::vec3 offset, float tangential_m) const;
  static constexpr std::uint32_t kNobody = ~0u;
  // Calls visit(point, weight if it sees the place, weight if it need not); returns the sum of the former.
  template <typename Visit>
  float for_each_weight(glm::vec3 position_m, glm::vec3 normal, Visit&& visit, std::uint32_t without = kNobody) const;

  // Calls visit(point, weight) for the points that rays find to see the place; returns the sum of the weights.
  template <typename Visit>
  float for_each_by_rays(glm::vec3 position_m, glm::vec3 normal, const RayScene& rays, Visit&& visit) const;

  float spacing_m_ = 0.25f;
  std::uint64_t rays_cast_ = 0;
  std::vector<Point> points_;
  std::vector<Level> levels_;  // those that have points; the first knows where others matter
};

template <typename Visit>
float CachePoints::for_each_weight(glm::vec3 position_m, glm::vec3 normal, Visit&& visit, std::uint32_t without) const {
  if (levels_.empty()) return 0.0f;
  // The closer points speak first; the wider ones have what they leave: nothing where there are enough of them.
  const PointIndex::Found widest = levels_.front().index.at(position_m);
  float sum = 0.0f, left = 1.0f;
  for (std::size_t l = widest.has_closer ? levels_.size() - 1 : 0; left > 0.0f; --l) {
    const Level& level = levels_[l];
    const float inverse_square = 1.0f / (level.reach_m * level.reach_m), share = left;
    for (const PointIndex::Member& member : (l == 0 ? widest : level.index.at(position_m)).members) {
      const glm::vec3 offset = position_m - member.position_m;
      const float facing = glm::dot(member.normal, normal), across = glm::dot(offset, member.normal);
      const float straight_square = glm::dot(offset, offset);
      const float square = (straight_square + (kOffPlane * kOffPlane - 1.0f) * across * across) * inverse_square;
      if (facing <= kLeastFacing || square >= 1.0f || member.point == without) continue;
      const Point& point = points_[member.point];
      const float along_m = std::sqrt(std::max(straight_square - across * across, 0.0f));
      const float kernel = (1.0f - square) * (1.0f - square);
      const float turned = (facing - kLeastFacing) / (1.0f - kLeastFacing);
      const float blocked = kernel * turned * turned;
      const float open = across < point.cover_m ? blocked * open_fraction(point, offset, along_m) : 0.0f;
      visit(member.point, share * open, share * blocked);
      sum += share * open;
      left -= open;
    }
    if (l == 0) break;
  }
  return sum;
}

}  // namespace probewalk
