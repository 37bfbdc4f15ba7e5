#include "content/bake/point_scatter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "content/bake/patterns.h"
#include "content/bake/point_index.h"
#include "content/bake/surface_point.h"
#include "content/error.h"

namespace probewalk {
namespace {

constexpr float kSameFacing = 0.8f;  // cosine above which two points are in each other's way
constexpr float kCandidatesPerSquare = 5.0f;
constexpr float kCandidatesPerLength = 2.0f;  // of a spacing, along thin triangles
// Nobody sees a place whose hemisphere is nearly all closed this near, or inside a solid: back faces this near. Wrongly
// wound rooms are larger than that.
constexpr float kHidden_m = 0.03f;
constexpr float kInside_m = 1.0f;
constexpr int kHiddenRays = 16;
constexpr int kHiddenLeast = 15;
// Closer points.
constexpr int kHalvings = 3;                // of the spacing
constexpr float kSpacingPerFreeWay = 0.5f;  // wanted; a gap is half again as free as it is wide
constexpr int kFreeWayRays = 16;
constexpr float kLeastWay_m = 0.02f;        // a single ray that meets a rug's edge is no gap
constexpr float kFarWays = 8.0f;            // what is so much further than the free way asked about hardly shortens it
constexpr std::uint32_t kTriedAround = 48;  // places round a point whose free way is short
constexpr float kAround = 2.4f;             // spacings away, at most
constexpr float kRound = 2.0f;              // the same round points where light changes
constexpr std::uint32_t kTriedRound = 32;
constexpr float kOver = 0.25f;              // spacings over the surface: from there the next place is looked for
constexpr std::size_t kFewPoints = 20000;   // closer ones may be had by any scene, however small
constexpr float kSeen_m = 0.3f;             // from where people look
constexpr float kNarrower = 2.5f;           // is asked for with each try to have no more closer points than may be
constexpr int kMostTries = 5;

// Points by cells as wide as their spacing.
class NearPoints {
 public:
  explicit NearPoints(float cell_m) : cell_m_(cell_m) {}
  void add(glm::vec3 position_m, std::uint32_t point) { cells_[point_cell_key(cell_of(position_m))].push_back(point); }
  // Whether any point less than a cell away passes the test, and some others.
  template <typename Test>
  bool any_near(glm::vec3 position_m, Test&& test) const {
    const glm::ivec3 centre = cell_of(position_m);
    for (int k = 0; k < 27; ++k) {
      const auto cell = cells_.find(point_cell_key(centre + glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      if (cell != cells_.end() && std::ranges::any_of(cell->second, test)) return true;
    }
    return false;
  }

 private:
  glm::ivec3 cell_of(glm::vec3 position_m) const { return glm::ivec3(glm::floor(position_m / cell_m_)); }

  float cell_m_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

// Places that were looked at in vain: what is near them need not be looked at again.
class Rejected {
 public:
  explicit Rejected(float cell_m) : near_(cell_m) {}
  // within_m: at most a cell.
  void add(const SurfacePoint& at, float within_m) {
    near_.add(at.position_m, static_cast<std::uint32_t>(places_.size()));
    places_.push_back({at.position_m, at.normal, within_m * within_m});
  }
  bool hold(const SurfacePoint& at) const {
    return near_.any_near(at.position_m, [&](std::uint32_t k) {
      const glm::vec3 offset = at.position_m - places_[k].position_m;
      return glm::dot(offset, offset) < places_[k].within_m2 && glm::dot(at.normal, places_[k].normal) > kSameFacing;
    });
  }

 private:
  struct Place {
    glm::vec3 position_m, normal;
    float within_m2;
  };
  NearPoints near_;
  std::vector<Place> places_;
};

// The surface around a point, as far as one gets along it.
class Surroundings {
 public:
  Surroundings(const RayScene& rays, const CachePoints::Point& point, float over_m) : rays_(rays), point_(point) {
    tangent_frame(point.geometric_normal, tangent_, bitangent_);
    offset_m_ = ray_offset_m(point.position_m);
    // Not through what hangs over it.
    const glm::vec3 start = point.position_m + point.geometric_normal * offset_m_;
    const SurfaceHit roof = rays.closest(start, point.geometric_normal, 0.0f, 2.0f * over_m);
    over_m_ = roof.hit ? 0.5f * roof.t : over_m;
    above_m_ = start + point.geometric_normal * over_m_;
  }
  // The surface that the kth place of the disc round the point lies on; none where something stands between.
  SurfaceHit find(std::uint32_t k, float radius_m) const {
    const glm::vec2 square = rotate_pattern(r2_sequence(k), mix_place(point_.position_m, 1));
    const float away_m = radius_m * std::sqrt(square.x), angle = 2.0f * std::numbers::pi_v<float> * square.y;
    const glm::vec3 aside = away_m * (std::cos(angle) * tangent_ + std::sin(angle) * bitangent_);
    if (rays_.occluded(above_m_, aside, 0.0f, 1.0f)) return {};
    return rays_.closest(above_m_ + aside, -point_.geometric_normal, 0.0f, 2.0f * over_m_ + offset_m_);
  }

 private:
  const RayScene& rays_;
  const CachePoints::Point& point_;
  glm::vec3 tangent_{0.0f}, bitangent_{0.0f}, above_m_{0.0f};
  float offset_m_ = 0.0f, over_m_ = 0.0f;
};

class Scatter {
 public:
  Scatter(const Scene& scene, const RayScene& rays, Progress& progress)
      : scene_(scene), rays_(rays), progress_(progress) {}

  // Dart throwing over fixed candidates on every triangle. False when there are more than most.
  bool cover(float spacing_m, std::size_t most) {
    progress_.begin("light cache points", scene_.triangles.size(), "triangles");
    points_.clear();
    free_ways_.clear();
    NearPoints near(spacing_m);
    for (std::uint32_t t = 0; t < scene_.triangles.size(); ++t) {
      progress_.advance(1);
      const glm::uvec3 index = scene_.triangles[t];
      const glm::vec3 a = scene_.positions_m[index.x], b = scene_.positions_m[index.y], c = scene_.positions_m[index.z];
      const glm::vec3 cross = glm::cross(b - a, c - a);
      const float twice_area = glm::length(cross);
      if (!(twice_area > 0.0f)) continue;
      SurfaceHit hit;
      hit.triangle = t;
      hit.geometric_normal = cross / twice_area;
      const float squares = 0.5f * twice_area / (spacing_m * spacing_m);
      const float lengths = std::max(glm::length(b - a), std::max(glm::length(c - b), glm::length(a - c))) / spacing_m;
      const float wanted = std::max(squares * kCandidatesPerSquare, lengths * kCandidatesPerLength);
      const auto candidates = 1u + static_cast<std::uint32_t>(std::min(wanted, 1e6f));
      for (std::uint32_t k = 0; k < candidates; ++k) {
        if (k % 256 == 0) stop_when_cancelled();
        const glm::vec2 square = r2_sequence(k);
        const float root = std::sqrt(square.x);
        hit.barycentric = {root * (1.0f - square.y), root * square.y};
        for (glm::vec3 towards : {-hit.geometric_normal, hit.geometric_normal}) {
          const SurfacePoint surface = surface_at(scene_, hit, towards, spacing_m);
          if (is_taken(near, surface, spacing_m) || is_hidden(surface)) continue;
          if (points_.size() == most) return false;
          add(near, surface, spacing_m);
        }
      }
    }
    return true;
  }

  // Round the points so far, where the spacing that the free way wants is less than theirs. False when there are more
  // than most.
  bool refine(float spacing_m, float spacing_per_free_way, std::size_t most) {
    const float before_m = 2.0f * spacing_m, short_m = before_m / spacing_per_free_way;
    if (short_m <= kLeastWay_m) return true;
    measure_free_ways();
    NearPoints near(spacing_m);
    for (std::uint32_t k = 0; k < points_.size(); ++k) near.add(points_[k].position_m, k);
    Rejected rejected(spacing_m);
    const std::size_t parents = points_.size();
    progress_.begin("light cache points", parents, "points");
    for (std::size_t k = 0; k < parents; ++k) {
      if (k % 256 == 0) stop_when_cancelled();
      progress_.advance(1);
      // The free way changes no faster than one moves.
      if (!free_ways_[k].is_seen || free_ways_[k].mean_m > short_m + 0.5f * before_m) continue;
      const CachePoints::Point parent = points_[k];
      const Surroundings around(rays_, parent, kOver * spacing_m);
      for (std::uint32_t tried = 0; tried < kTriedAround; ++tried) {
        const SurfaceHit hit = around.find(tried, kAround * spacing_m);
        if (!hit.hit) continue;
        const SurfacePoint surface = surface_at(scene_, hit, -parent.geometric_normal, spacing_m);
        if (is_taken(near, surface, spacing_m) || rejected.hold(surface)) continue;
        rays_cast_ += kFreeWayRays;
        const FreeWay way = free_way(surface.position_m, surface.geometric_normal, surface.normal, kFarWays * short_m);
        if (!way.is_seen || way.mean_m >= short_m) {
          rejected.add(surface, std::clamp(way.mean_m - short_m, 0.5f * spacing_m, spacing_m));
          continue;
        }
        if (points_.size() == most) return false;
        add(near, surface, spacing_m);
      }
    }
    return true;
  }

  // Round given points of twice the spacing; others are in the way alone.
  std::vector<CachePoints::Point> fill(const CachePoints& given, std::span<const std::uint32_t> round, float spacing_m,
                                       std::size_t most) {
    NearPoints near(spacing_m);
    for (std::uint32_t k = 0; k < given.size(); ++k) add(near, given[k], given[k].spacing_m);
    const std::size_t first = points_.size();
    progress_.begin("light cache points", round.size(), "points");
    for (std::size_t k = 0; k < round.size() && points_.size() < first + most; ++k) {
      if (k % 256 == 0) stop_when_cancelled();
      progress_.advance(1);
      const CachePoints::Point parent = points_[round[k]];
      const Surroundings around(rays_, parent, kOver * spacing_m);
      for (std::uint32_t tried = 0; tried < kTriedRound && points_.size() < first + most; ++tried) {
        const SurfaceHit hit = around.find(tried, kRound * spacing_m);
        if (!hit.hit) continue;
        const SurfacePoint surface = surface_at(scene_, hit, -parent.geometric_normal, spacing_m);
        if (!is_taken(near, surface, spacing_m)) add(near, surface, spacing_m);
      }
    }
    return {points_.begin() + std::ptrdiff_t(first), points_.end()};
  }

  void keep(std::size_t count) {
    points_.resize(count);
    free_ways_.resize(std::min(free_ways_.size(), count));
  }
  std::size_t size() const { return points_.size(); }
  std::vector<CachePoints::Point> take() { return std::move(points_); }
  std::uint64_t rays_cast() const { return rays_cast_; }

 private:
  void stop_when_cancelled() const {
    if (progress_.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
  }

  template <typename Surface>
  void add(NearPoints& near, const Surface& surface, float spacing_m) {
    near.add(surface.position_m, static_cast<std::uint32_t>(points_.size()));
    points_.push_back({surface.position_m, surface.normal, surface.geometric_normal, spacing_m, {}});
  }

  bool is_taken(const NearPoints& near, const SurfacePoint& surface, float spacing_m) const {
    return near.any_near(surface.position_m, [&](std::uint32_t k) {
      const CachePoints::Point& other = points_[k];
      if (glm::dot(other.normal, surface.normal) < kSameFacing) return false;
      const glm::vec3 offset = surface.position_m - other.position_m;
      const float across = glm::dot(offset, other.normal);
      constexpr float kOff = CachePoints::kOffPlane;
      return glm::dot(offset, offset) + (kOff * kOff - 1.0f) * across * across < spacing_m * spacing_m;
    });
  }

  bool is_hidden(const SurfacePoint& surface) const {
    glm::vec3 tangent, bitangent;
    tangent_frame(surface.geometric_normal, tangent, bitangent);
    const glm::vec3 origin = surface.position_m + surface.geometric_normal * ray_offset_m(surface.position_m);
    int closed = 0;
    for (int k = 0; k < kHiddenRays; ++k) {
      const glm::vec3 local = cosine_direction(hammersley(k, kHiddenRays));
      const glm::vec3 direction = tangent * local.x + bitangent * local.y + surface.geometric_normal * local.z;
      const SurfaceHit hit = rays_.closest(origin, direction, 0.0f, kInside_m);
      closed += hit.hit && (hit.t < kHidden_m || glm::dot(hit.geometric_normal, direction) > 0.0f);
      if (closed + kHiddenRays - 1 - k < kHiddenLeast) return false;
    }
    return true;
  }

  struct FreeWay {
    float mean_m = 0.0f;   // harmonic
    bool is_seen = false;  // from a distance; nobody looks where every ray soon ends
  };

  // What is further than far_m counts as infinitely far.
  FreeWay free_way(glm::vec3 position_m, glm::vec3 geometric_normal, glm::vec3 normal, float far_m) const {
    glm::vec3 tangent, bitangent;
    tangent_frame(normal, tangent, bitangent);
    const glm::vec3 origin = position_m + geometric_normal * ray_offset_m(position_m);
    const std::uint32_t turn = mix_place(position_m, 0);
    FreeWay way;
    float sum = 0.0f;
    for (int k = 0; k < kFreeWayRays; ++k) {
      const glm::vec3 local = cosine_direction(rotate_pattern(hammersley(k, kFreeWayRays), turn));
      const glm::vec3 direction = tangent * local.x + bitangent * local.y + normal * local.z;
      if (glm::dot(direction, geometric_normal) <= 0.0f) continue;
      const SurfaceHit hit = rays_.closest(origin, direction, 0.0f, std::max(far_m, kSeen_m));
      // Seen through its back, a surface is the inside of a solid.
      way.is_seen |= !hit.hit || (hit.t > kSeen_m && glm::dot(hit.geometric_normal, direction) < 0.0f);
      if (hit.hit && hit.t < far_m) sum += 1.0f / std::max(hit.t, kLeastWay_m);
    }
    way.mean_m = kFreeWayRays / std::max(sum, kFreeWayRays / far_m);
    return way;
  }

  // Of the points that have none yet.
  void measure_free_ways() {
    const std::size_t first = free_ways_.size();
    free_ways_.resize(points_.size());
    tbb::parallel_for(first, points_.size(), [&](std::size_t k) {
      const CachePoints::Point& p = points_[k];
      free_ways_[k] = free_way(p.position_m, p.geometric_normal, p.normal, kFarWays * p.spacing_m / kSpacingPerFreeWay);
    });
    rays_cast_ += (points_.size() - first) * kFreeWayRays;
  }

  const Scene& scene_;
  const RayScene& rays_;
  Progress& progress_;
  std::vector<CachePoints::Point> points_;
  std::vector<FreeWay> free_ways_;  // of the first points
  std::uint64_t rays_cast_ = 0;
};

}  // namespace

ScatteredPoints scatter_points(const Scene& scene, const RayScene& rays, double spacing_m, std::size_t max_points,
                               Progress& progress) {
  // Poisson disks put down about 0.7 pairs of points a square of the spacing.
  double area_m2 = 0.0;
  for (const glm::uvec3& t : scene.triangles) {
    const glm::dvec3 a(scene.positions_m[t.x]), b(scene.positions_m[t.y]), c(scene.positions_m[t.z]);
    area_m2 += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  ScatteredPoints result;
  Scatter scatter(scene, rays, progress);
  spacing_m = std::max(spacing_m, std::sqrt(1.2 * area_m2 / static_cast<double>(max_points)));
  for (result.spacing_m = static_cast<float>(spacing_m); !scatter.cover(result.spacing_m, max_points);) {
    result.spacing_m *= 1.2f;
  }
  // Where all the scene is narrow, only the narrowest places have closer points.
  const std::size_t wide = scatter.size(), closer = std::max(wide / 2, kFewPoints);
  float spacing_per_free_way = kSpacingPerFreeWay;
  for (int tries = 0; tries < kMostTries; ++tries, spacing_per_free_way *= kNarrower) {
    bool fits = true;
    for (int halving = 1; halving <= kHalvings && fits; ++halving) {
      fits = scatter.refine(std::ldexp(result.spacing_m, -halving), spacing_per_free_way, wide + closer);
    }
    if (fits) break;
    scatter.keep(wide);
  }
  result.points = scatter.take();
  result.rays_cast = scatter.rays_cast();
  return result;
}

std::vector<CachePoints::Point> scatter_round(const Scene& scene, const RayScene& rays, const CachePoints& points,
                                              std::span<const std::uint32_t> round, float spacing_m, std::size_t most,
                                              Progress& progress) {
  return Scatter(scene, rays, progress).fill(points, round, spacing_m, most);
}

}  // namespace probewalk
