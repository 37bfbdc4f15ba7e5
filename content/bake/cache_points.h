// Points spread over all surfaces that can be seen, both sides, about a spacing apart, and the smooth interpolation
// between them.
// A point speaks for a flat neighbourhood of its own side only, as far as the surface lies open around it: light does
// not leak under walls, through thin sheets, or out from under furniture.
#pragma once

#include <array>
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

 private:
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

  float spacing_m_ = 0.25f;
  float reach_m_ = 0.4f;  // of a point's influence
  std::uint64_t rays_cast_ = 0;
  std::vector<Point> points_;
  float cell_m_ = 0.2f;          // of the index
  std::vector<Member> members_;  // grouped by the cell that they influence
  std::vector<Bucket> buckets_;  // open addressing, a power of two of them
};

}  // namespace probewalk
