// Points spread over all surfaces that can be seen, both sides, about a spacing apart, and the smooth interpolation
// between them.
// A point speaks for a flat neighbourhood of its own side only, as far as the surface lies open around it: light does
// not leak under walls, through thin sheets, or out from under furniture.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

class CachePoints {
 public:
  static constexpr int kSectors = 32;  // fine enough to see along a strip as narrow as a door frame
  struct Point {
    glm::vec3 position_m{0.0f};
    glm::vec3 normal{0.0f};  // unit; shading normal of its side
    glm::vec3 geometric_normal{0.0f};
    // How near the surface around is closed, by direction: kNearSteps * reach / free way; 0 = open. The reciprocal is
    // what interpolates well: along a straight wall it is affine in the direction.
    std::array<std::uint8_t, kSectors> nearness{};
  };

  // Spacing is raised until at most max_points are needed; spacing_m() says what it became.
  CachePoints(const Scene& scene, const RayScene& rays, double spacing_m, std::size_t max_points, Progress& progress);

  std::size_t size() const { return points_.size(); }
  const Point& operator[](std::size_t k) const { return points_[k]; }
  float spacing_m() const { return spacing_m_; }
  std::uint64_t rays_cast() const { return rays_cast_; }

  // Interpolates values (one per point) at a surface position with unit normal. Thread-safe.
  glm::vec3 interpolate(const std::vector<glm::vec3>& values, glm::vec3 position_m, glm::vec3 normal) const;
  // The same from points that see the place alone: black where none does, as within walls, where few rays stray.
  glm::vec3 interpolate_seen(const std::vector<glm::vec3>& values, glm::vec3 position_m, glm::vec3 normal) const;
  // Calls visit(point) for each point whose value counts there; returns whether any of them sees the place.
  template <typename Visit>
  bool for_each_seen(glm::vec3 position_m, glm::vec3 normal, Visit&& visit) const {
    return for_each_weight(position_m, normal, [&](std::uint32_t point, float open, float) {
             if (open > 0.0f) visit(point);
           }) > kVanishing;
  }
  template <typename Visit>
  void for_each_used(glm::vec3 position_m, glm::vec3 normal, Visit&& visit) const {
    if (for_each_seen(position_m, normal, visit)) return;
    for_each_weight(position_m, normal, [&](std::uint32_t point, float, float) { visit(point); });
  }

  // A hash of all that a point is, its number not counted.
  std::uint64_t identity(std::size_t k) const;
  // Half the box around a point outside of which its value counts nowhere.
  glm::vec3 influence_m(std::size_t k) const;

 private:
  static constexpr float kVanishing = 1e-12f;
  static constexpr float kOffPlane = 6.0f;     // distance across the surface counts this much more than along it
  static constexpr float kLeastFacing = 0.2f;  // cosine below which a point says nothing
  static constexpr float kNearSteps = 12.0f;
  // What decides whether a point matters at a place, copied beside its neighbours': looking is most of the work.
  struct Member {
    glm::vec3 position_m{0.0f};
    std::uint32_t point = 0;
    glm::vec3 normal{0.0f};
  };
  struct Bucket {
    std::uint64_t key = ~0ull;
    std::uint32_t first = 0, count = 0;
  };

  bool scatter(const Scene& scene, const RayScene& rays, std::size_t max_points, Progress& progress);
  void look_around(const RayScene& rays, Progress& progress);
  void build_index();
  std::uint64_t cell_key(glm::ivec3 cell) const;
  const Bucket* find(std::uint64_t key) const;
  float open_fraction(const Point& point, glm::vec3 offset, float tangential_m) const;
  // Calls visit(point, weight if it sees the place, weight if it need not); returns the sum of the former.
  template <typename Visit>
  float for_each_weight(glm::vec3 position_m, glm::vec3 normal, Visit&& visit) const;

  float spacing_m_ = 0.25f;
  float reach_m_ = 0.4f;  // of a point's influence
  std::uint64_t rays_cast_ = 0;
  std::vector<Point> points_;
  float cell_m_ = 0.2f;          // of the index
  std::vector<Member> members_;  // grouped by the cell that they influence
  std::vector<Bucket> buckets_;  // open addressing, a power of two of them
};

template <typename Visit>
float CachePoints::for_each_weight(glm::vec3 position_m, glm::vec3 normal, Visit&& visit) const {
  const Bucket* bucket = find(cell_key(glm::ivec3(glm::floor(position_m / cell_m_))));
  if (!bucket) return 0.0f;
  const float inverse_square = 1.0f / (reach_m_ * reach_m_);
  float sum = 0.0f;
  for (std::uint32_t m = bucket->first; m < bucket->first + bucket->count; ++m) {
    const Member& member = members_[m];
    const glm::vec3 offset = position_m - member.position_m;
    const float facing = glm::dot(member.normal, normal), across = glm::dot(offset, member.normal);
    const float straight_square = glm::dot(offset, offset);
    const float square = (straight_square + (kOffPlane * kOffPlane - 1.0f) * across * across) * inverse_square;
    if (facing <= kLeastFacing || square >= 1.0f) continue;
    const Point& point = points_[member.point];
    const float along_m = std::sqrt(std::max(straight_square - across * across, 0.0f));
    const float kernel = (1.0f - square) * (1.0f - square);
    const float turned = (facing - kLeastFacing) / (1.0f - kLeastFacing);
    const float blocked = kernel * turned * turned, open = blocked * open_fraction(point, offset, along_m);
    visit(member.point, open, blocked);
    sum += open;
  }
  return sum;
}

}  // namespace probewalk
