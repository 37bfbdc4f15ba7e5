#include "content/bake/point_scatter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <unordered_set>
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
constexpr float kLeastWay_m = 0.02f;   // a single ray that meets a rug's edge is no gap
constexpr float kFarWays = 8.0f;   // what is so much further than the free way asked about hardly shortens it
constexpr float kPieceSpacings = 4.0f;  // edge of the pieces of a triangle that are looked at or skipped as a whole
constexpr std::size_t kFewPoints = 20000;  // cost next to nothing
constexpr int kMostTries = 6;          // to have no more close points than others, where all the scene is narrow

struct Corners {
  glm::vec3 a, b, c;  // barycentric or metres
  glm::vec3 lower() const { return glm::min(a, glm::min(b, c)); }
  glm::vec3 upper() const { return glm::max(a, glm::max(b, c)); }
  float longest() const { return std::max(glm::length(b - a), std::max(glm::length(c - b), glm::length(a - c))); }
  float area() const { return 0.5f * glm::length(glm::cross(b - a, c - a)); }
};

// Points by cells as wide as their spacing.
class NearPoints {
 public:
  explicit NearPoints(float cell_m) : cell_m_(cell_m) {}
  glm::ivec3 cell_of(glm::vec3 position_m) const { return glm::ivec3(glm::floor(position_m / cell_m_)); }
  void add(glm::vec3 position_m, std::uint32_t point) { cells_[point_cell_key(cell_of(position_m))].push_back(point); }
  // Whether any point less than a cell away passes the test, and some others.
  template <typename Test>
  bool any_near(glm::vec3 position_m, Test&& test) const {
    const glm::ivec3 centre = cell_of(position_m);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find(point_cell_key(centre + glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      if (found == cells_.end()) continue;
      for (std::uint32_t point : found->second) {
        if (test(point)) return true;
      }
    }
    return false;
  }

 private:
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

class Scatter {
 public:
  Scatter(const Scene& scene, const RayScene& rays, Progress& progress)
      : scene_(scene), rays_(rays), progress_(progress) {}

  // Everywhere, from nothing. False when there are more than most.
  bool cover(float spacing_m, std::size_t most) {
    points_.clear();
    free_ways_m_.clear();
    rejected_.reset();
    return fill(spacing_m, most, [](const Corners&) { return true; }, [](const SurfacePoint&) { return true; });
  }

  // Where the spacing that the free way wants is less than that of the points so far. False when there are more than
  // most.
  bool refine(float spacing_m, float spacing_per_free_way, std::size_t most) {
    measure_free_ways();
    const float before_m = 2.0f * spacing_m, short_m = before_m / spacing_per_free_way;
    // The free way changes no faster than one moves: only near points whose own is short can it be short.
    const NearPoints cells(before_m);
    std::unordered_set<std::uint64_t> wanted;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      if (free_ways_m_[k] > short_m + 2.0f * before_m) continue;
      const glm::ivec3 centre = cells.cell_of(points_[k].position_m);
      for (int n = 0; n < 27; ++n) {
        wanted.insert(point_cell_key(centre + glm::ivec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1)));
      }
    }
    if (wanted.empty()) return true;
    rejected_.emplace(spacing_m);
    return fill(
        spacing_m, most,
        [&](const Corners& piece_m) {
          const glm::ivec3 low = cells.cell_of(piece_m.lower()), high = cells.cell_of(piece_m.upper());
          for (int z = low.z; z <= high.z; ++z) {
            for (int y = low.y; y <= high.y; ++y) {
              for (int x = low.x; x <= high.x; ++x) {
                if (wanted.contains(point_cell_key({x, y, z}))) return true;
              }
            }
          }
          return false;
        },
        [&](const SurfacePoint& at) {
          if (!wanted.contains(point_cell_key(cells.cell_of(at.position_m)))) return false;
          rays_cast_ += kFreeWayRays;
          const float way_m = free_way_m(at.position_m, at.geometric_normal, at.normal, kFarWays * short_m);
          if (way_m < short_m) return true;
          rejected_->add(at, std::clamp(way_m - short_m, 0.5f * spacing_m, spacing_m));
          return false;
        });
  }

  void keep(std::size_t count) {
    points_.resize(count);
    free_ways_m_.resize(std::min(free_ways_m_.size(), count));
  }
  std::size_t size() const { return points_.size(); }
  std::vector<CachePoints::Point> take() { return std::move(points_); }
  std::uint64_t rays_cast() const { return rays_cast_; }

 private:
  // Dart throwing over fixed candidates. piece_matters(corners in metres) may skip a part of a triangle, matters(surface)
  // a place.
  template <typename PieceMatters, typename Matters>
  bool fill(float spacing_m, std::size_t most, PieceMatters&& piece_matters, Matters&& matters) {
    progress_.begin("light cache points", scene_.triangles.size(), "triangles");
    NearPoints near(spacing_m);
    for (std::uint32_t k = 0; k < points_.size(); ++k) near.add(points_[k].position_m, k);
    std::vector<Corners> pieces;
    for (std::uint32_t t = 0; t < scene_.triangles.size(); ++t) {
      if (t % 256 == 0 && progress_.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
      progress_.advance(1);
      const glm::uvec3 index = scene_.triangles[t];
      const Corners whole_m{scene_.positions_m[index.x], scene_.positions_m[index.y], scene_.positions_m[index.z]};
      const glm::vec3 cross = glm::cross(whole_m.b - whole_m.a, whole_m.c - whole_m.a);
      const float twice_area = glm::length(cross);
      if (!(twice_area > 0.0f)) continue;
      SurfaceHit hit;
      hit.triangle = t;
      hit.geometric_normal = cross / twice_area;
      pieces.assign(1, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
      while (!pieces.empty()) {
        const Corners piece = pieces.back();
        pieces.pop_back();
        const auto in_metres = [&](glm::vec3 p) { return p.x * whole_m.a + p.y * whole_m.b + p.z * whole_m.c; };
        const Corners piece_m{in_metres(piece.a), in_metres(piece.b), in_metres(piece.c)};
        if (splits() && piece_m.longest() > 2.0f * kPieceSpacings * spacing_m) {
          const glm::vec3 ab = 0.5f * (piece.a + piece.b), bc = 0.5f * (piece.b + piece.c), ca = 0.5f * (piece.c + piece.a);
          for (const Corners& part : {Corners{piece.a, ab, ca}, {ab, piece.b, bc}, {ca, bc, piece.c}, {bc, ca, ab}}) {
            pieces.push_back(part);
          }
          continue;
        }
        if (!piece_matters(piece_m)) continue;
        if (!fill_piece(hit, piece, piece_m, spacing_m, most, near, matters)) return false;
      }
    }
    return true;
  }

  // The first points' own sequence runs over whole triangles.
  bool splits() const { return !free_ways_m_.empty(); }

  template <typename Matters>
  bool fill_piece(SurfaceHit& hit, const Corners& piece, const Corners& piece_m, float spacing_m, std::size_t most,
                  NearPoints& near, Matters&& matters) {
    const float squares = piece_m.area() / (spacing_m * spacing_m), lengths = piece_m.longest() / spacing_m;
    const float wanted = std::max(squares * kCandidatesPerSquare, lengths * kCandidatesPerLength);
    const auto candidates = 1u + static_cast<std::uint32_t>(std::min(wanted, 1e6f));
    for (std::uint32_t k = 0; k < candidates; ++k) {
      if (k % 256 == 255 && progress_.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
      const glm::vec2 square = r2_sequence(k);
      const float root = std::sqrt(square.x), b = root * (1.0f - square.y), c = root * square.y;
      const glm::vec3 place = (1.0f - b - c) * piece.a + b * piece.b + c * piece.c;
      hit.barycentric = {place.y, place.z};
      for (glm::vec3 towards : {-hit.geometric_normal, hit.geometric_normal}) {
        const SurfacePoint surface = surface_at(scene_, hit, towards, spacing_m);
        if (is_taken(near, surface, spacing_m) || (rejected_ && rejected_->hold(surface)) || !matters(surface)) continue;
        if (is_hidden(surface)) {
          if (rejected_) rejected_->add(surface, 0.5f * spacing_m);
          continue;
        }
        if (points_.size() == most) return false;
        near.add(surface.position_m, static_cast<std::uint32_t>(points_.size()));
        points_.push_back({surface.position_m, surface.normal, surface.geometric_normal, spacing_m, {}});
      }
    }
    return true;
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

  // What is further than far_m counts as infinitely far.
  float free_way_m(glm::vec3 position_m, glm::vec3 geometric_normal, glm::vec3 normal, float far_m) const {
    glm::vec3 tangent, bitangent;
    tangent_frame(normal, tangent, bitangent);
    const glm::vec3 origin = position_m + geometric_normal * ray_offset_m(position_m);
    const std::uint32_t turn = mix_place(position_m, 0);
    float sum = 0.0f;
    for (int k = 0; k < kFreeWayRays; ++k) {
      const glm::vec3 local = cosine_direction(rotate_pattern(hammersley(k, kFreeWayRays), turn));
      const glm::vec3 direction = tangent * local.x + bitangent * local.y + normal * local.z;
      if (glm::dot(direction, geometric_normal) <= 0.0f) continue;
      const SurfaceHit hit = rays_.closest(origin, direction, 0.0f, far_m);
      if (hit.hit) sum += 1.0f / std::max(hit.t, kLeastWay_m);
    }
    return kFreeWayRays / std::max(sum, kFreeWayRays / far_m);
  }

  // Of the points that have none yet.
  void measure_free_ways() {
    const std::size_t first = free_ways_m_.size();
    free_ways_m_.resize(points_.size());
    tbb::parallel_for(first, points_.size(), [&](std::size_t k) {
      const CachePoints::Point& p = points_[k];
      free_ways_m_[k] = free_way_m(p.position_m, p.geometric_normal, p.normal,
                                   kFarWays * p.spacing_m / kSpacingPerFreeWay);
    });
    rays_cast_ += (points_.size() - first) * kFreeWayRays;
  }

  const Scene& scene_;
  const RayScene& rays_;
  Progress& progress_;
  std::vector<CachePoints::Point> points_;
  std::vector<float> free_ways_m_;    // of the first points
  std::optional<Rejected> rejected_;  // while refining
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
  const std::size_t wide = scatter.size(), most = wide + std::max(wide, kFewPoints);
  float spacing_per_free_way = kSpacingPerFreeWay;
  for (int tries = 0; tries < kMostTries; ++tries, spacing_per_free_way *= 2.0f) {
    bool fits = true;
    for (int halving = 1; halving <= kHalvings && fits; ++halving) {
      fits = scatter.refine(std::ldexp(result.spacing_m, -halving), spacing_per_free_way, most);
    }
    if (fits) break;
    scatter.keep(wide);  // where that is too many, only the narrowest places have closer points
  }
  result.points = scatter.take();
  result.rays_cast = scatter.rays_cast();
  return result;
}

}  // namespace probewalk
