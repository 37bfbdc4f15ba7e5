#include "content/bake/cache_points.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <span>
#include <unordered_map>

#include "content/bake/patterns.h"
#include "content/bake/surface_point.h"
#include "content/error.h"
#include "content/pack/pack_io.h"

namespace probewalk {
namespace {

constexpr float kReachPerSpacing = 1.75f;   // five or six points speak at any place
constexpr float kCellPerReach = 0.5f;       // smaller cells list fewer points in vain, in more lists
constexpr float kSameFacing = 0.8f;         // cosine above which two points are in each other's way
constexpr float kCandidatesPerSquare = 5.0f;
constexpr float kCandidatesPerLength = 2.0f;  // of a spacing, along thin triangles
// Nobody sees a place whose hemisphere is nearly all closed this near, or inside a solid: back faces this near. Wrongly wound
// rooms are larger than that.
constexpr float kHidden_m = 0.03f;
constexpr float kInside_m = 1.0f;
constexpr int kHiddenRays = 16;
constexpr int kHiddenLeast = 15;
constexpr float kLookHeight_m = 0.02f;      // thinner things (a rug's edge) do not part a surface
constexpr float kLookTilt = 0.15f;          // tangent of the angle at which the view along the surface rises
constexpr float kLookReach = 3.0f;          // in reaches: a wall must be known in the directions beside the nearest, too

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

bool is_hidden(const RayScene& rays, glm::vec3 position_m, glm::vec3 normal) {
  glm::vec3 tangent, bitangent;
  tangent_frame(normal, tangent, bitangent);
  const glm::vec3 origin = position_m + normal * ray_offset_m(position_m);
  int closed = 0;
  for (int k = 0; k < kHiddenRays; ++k) {
    const glm::vec3 local = cosine_direction(hammersley(k, kHiddenRays));
    const glm::vec3 direction = tangent * local.x + bitangent * local.y + normal * local.z;
    const SurfaceHit hit = rays.closest(origin, direction, 0.0f, kInside_m);
    closed += hit.hit && (hit.t < kHidden_m || glm::dot(hit.geometric_normal, direction) > 0.0f);
    if (closed + kHiddenRays - 1 - k < kHiddenLeast) return false;
  }
  return true;
}

}  // namespace

CachePoints::CachePoints(const Scene& scene, const RayScene& rays, double spacing_m, std::size_t max_points,
                         Progress& progress) {
  // Poisson disks put down about 0.7 pairs of points a square of the spacing.
  double area_m2 = 0.0;
  for (const glm::uvec3& t : scene.triangles) {
    const glm::dvec3 a(scene.positions_m[t.x]), b(scene.positions_m[t.y]), c(scene.positions_m[t.z]);
    area_m2 += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  spacing_m = std::max(spacing_m, std::sqrt(1.2 * area_m2 / static_cast<double>(max_points)));
  for (spacing_m_ = static_cast<float>(spacing_m); !scatter(scene, rays, max_points, progress);) spacing_m_ *= 1.2f;
  look_around(rays, progress);
  build_index();
}

// Dart throwing over fixed candidates; false when there are too many.
bool CachePoints::scatter(const Scene& scene, const RayScene& rays, std::size_t max_points, Progress& progress) {
  progress.begin("light cache points", scene.triangles.size(), "triangles");
  reach_m_ = spacing_m_ * kReachPerSpacing;
  points_.clear();
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> taken;
  const auto cell_of = [&](glm::vec3 p) { return glm::ivec3(glm::floor(p / spacing_m_)); };
  const auto is_free = [&](glm::vec3 p, glm::vec3 normal) {
    const glm::ivec3 centre = cell_of(p);
    for (int k = 0; k < 27; ++k) {
      const auto found = taken.find(cell_key(centre + glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      if (found == taken.end()) continue;
      for (std::uint32_t index : found->second) {
        const Point& other = points_[index];
        if (glm::dot(other.normal, normal) < kSameFacing) continue;
        const glm::vec3 offset = p - other.position_m;
        const float across = glm::dot(offset, other.normal);
        const float square = glm::dot(offset, offset) + (kOffPlane * kOffPlane - 1.0f) * across * across;
        if (square < spacing_m_ * spacing_m_) return false;
      }
    }
    return true;
  };
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    progress.advance(1);
    const glm::uvec3 index = scene.triangles[t];
    const glm::vec3 a = scene.positions_m[index.x], b = scene.positions_m[index.y], c = scene.positions_m[index.z];
    const glm::vec3 cross = glm::cross(b - a, c - a);
    const float twice_area = glm::length(cross);
    if (!(twice_area > 0.0f)) continue;
    SurfaceHit hit;
    hit.triangle = t;
    hit.geometric_normal = cross / twice_area;
    const float squares = 0.5f * twice_area / (spacing_m_ * spacing_m_);
    const float lengths = std::max(glm::length(b - a), std::max(glm::length(c - b), glm::length(a - c))) / spacing_m_;
    const float wanted = std::max(squares * kCandidatesPerSquare, lengths * kCandidatesPerLength);
    const auto candidates = 1u + static_cast<std::uint32_t>(std::min(wanted, 1e6f));
    for (std::uint32_t k = 0; k < candidates; ++k) {
      if (k % 256 == 0 && progress.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
      const glm::vec2 square = r2_sequence(k);
      const float root = std::sqrt(square.x);
      hit.barycentric = {root * (1.0f - square.y), root * square.y};
      for (glm::vec3 towards : {-hit.geometric_normal, hit.geometric_normal}) {
        const SurfacePoint surface = surface_at(scene, hit, towards, spacing_m_);
        if (!is_free(surface.position_m, surface.normal)) continue;
        if (is_hidden(rays, surface.position_m, surface.geometric_normal)) continue;
        if (points_.size() == max_points) return false;
        taken[cell_key(cell_of(surface.position_m))].push_back(static_cast<std::uint32_t>(points_.size()));
        points_.push_back({surface.position_m, surface.normal, surface.geometric_normal, {}});
      }
    }
  }
  return true;
}

void CachePoints::look_around(const RayScene& rays, Progress& progress) {
  tbb::parallel_for(std::size_t(0), points_.size(), [&](std::size_t k) {
    if (progress.cancelled()) return;
    Point& point = points_[k];
    const glm::vec3 n = point.geometric_normal;
    glm::vec3 tangent, bitangent;
    tangent_frame(point.normal, tangent, bitangent);
    for (int s = 0; s < kSectors; ++s) {
      const glm::vec2 along = sector_direction(s);
      const glm::vec3 direction = tangent * along.x + bitangent * along.y + n * kLookTilt;
      const SurfaceHit hit = rays.closest(point.position_m + n * kLookHeight_m, direction, 0.0f, kLookReach * reach_m_);
      const float nearness = kNearSteps * reach_m_ / std::max(hit.t, 1e-4f);
      point.nearness[s] = hit.hit ? static_cast<std::uint8_t>(std::min(nearness, 255.0f)) : 0;
    }
  });
  if (progress.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
  rays_cast_ += points_.size() * kSectors;
}

std::uint64_t CachePoints::cell_key(glm::ivec3 cell) const {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1FFFFFu; };
  return part(cell.x) << 42 | part(cell.y) << 21 | part(cell.z);
}

void CachePoints::build_index() {
  cell_m_ = kCellPerReach * reach_m_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries;
  for (std::uint32_t k = 0; k < points_.size(); ++k) {
    const glm::vec3 p = points_[k].position_m, half = influence_m(k);
    const glm::ivec3 low(glm::floor((p - half) / cell_m_)), high(glm::floor((p + half) / cell_m_));
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) entries.emplace_back(cell_key({x, y, z}), k);
      }
    }
  }
  tbb::parallel_sort(entries.begin(), entries.end());  // pairs are unique: one order
  members_.resize(entries.size());
  std::size_t cells = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Point& point = points_[entries[k].second];
    members_[k] = {point.position_m, entries[k].second, point.normal};
    cells += k == 0 || entries[k].first != entries[k - 1].first;
  }
  std::size_t capacity = 16;
  while (capacity < 2 * cells) capacity *= 2;
  buckets_.assign(capacity, {});
  for (std::size_t first = 0; first < entries.size();) {
    std::size_t end = first;
    while (end < entries.size() && entries[end].first == entries[first].first) ++end;
    std::size_t slot = (entries[first].first * 0x9E3779B97F4A7C15ull) >> 32 & (capacity - 1);
    while (buckets_[slot].key != ~0ull) slot = (slot + 1) & (capacity - 1);
    buckets_[slot] = {entries[first].first, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)};
    first = end;
  }
}

const CachePoints::Bucket* CachePoints::find(std::uint64_t key) const {
  const std::size_t mask = buckets_.size() - 1;
  for (std::size_t slot = (key * 0x9E3779B97F4A7C15ull) >> 32 & mask;; slot = (slot + 1) & mask) {
    if (buckets_[slot].key == key) return &buckets_[slot];
    if (buckets_[slot].key == ~0ull) return nullptr;
  }
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
  const float free_m = kNearSteps * reach_m_ / nearness;
  return std::clamp((free_m - tangential_m) / (0.15f * reach_m_), 0.0f, 1.0f);
}

glm::vec3 CachePoints::interpolate(const std::vector<glm::vec3>& values, glm::vec3 position_m, glm::vec3 normal) const {
  glm::vec3 open_sum(0.0f), blocked_sum(0.0f);
  float blocked_weights = 0.0f;
  const float open_weights = for_each_weight(position_m, normal, [&](std::uint32_t point, float open, float blocked) {
    open_sum += values[point] * open;
    blocked_sum += values[point] * blocked;
    blocked_weights += blocked;
  });
  if (open_weights > kVanishing) return open_sum / open_weights;
  // No point sees the place: any light is better there than none. Elsewhere one behind a wall has no say at all, or
  // what changes in a closed room would change the next.
  return blocked_weights > kVanishing ? blocked_sum / blocked_weights : glm::vec3(0.0f);
}

glm::vec3 CachePoints::interpolate_seen(const std::vector<glm::vec3>& values, glm::vec3 position_m,
                                        glm::vec3 normal) const {
  glm::vec3 sum(0.0f);
  const float weights =
      for_each_weight(position_m, normal, [&](std::uint32_t point, float open, float) { sum += values[point] * open; });
  return weights > kVanishing ? sum / weights : glm::vec3(0.0f);
}

std::uint64_t CachePoints::identity(std::size_t k) const {
  static_assert(sizeof(Point) == 9 * sizeof(float) + kSectors, "no padding");
  return short_hash(std::as_bytes(std::span(&points_[k], 1)));
}

// The influence is a flat ellipsoid; its box.
glm::vec3 CachePoints::influence_m(std::size_t k) const {
  const glm::vec3 n = points_[k].normal;
  return reach_m_ * glm::sqrt(glm::max(glm::vec3(1.0f) - n * n * (1.0f - 1.0f / (kOffPlane * kOffPlane)), 0.0f));
}

}  // namespace probewalk
