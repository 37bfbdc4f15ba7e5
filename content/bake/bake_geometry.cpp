#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "content/bake/bake_probe.h"

namespace probewalk {
namespace {

// Nothing is nearer to a probe than this, so that w stays finite where a probe touches geometry.
constexpr double kMinDistance_m = 1e-4;
constexpr std::uint32_t kSky = std::numeric_limits<std::uint32_t>::max();

// Tolerances of connectivity, relative to w (design: tracer, section 5).
constexpr double kSamePlane = 2e-4;
constexpr double kNearPlane = 0.005;      // the smaller error, when the larger is below kFarPlane ...
constexpr double kFarPlane = 0.02;        // ... and the normals agree by kSmoothCosine: a curved surface
constexpr double kSmoothCosine = 0.7;
constexpr double kFoldTolerance = 0.005;  // a ray at a predicted fold must meet it this exactly
constexpr double kJumpKept = 0.15;        // a jump that six halvings leave above this share is a true jump
constexpr double kJumpLeast = 1e-4;       // ... unless it is none
constexpr int kHalvings = 6;

// What a ray through a point of the octahedron meets.
struct Sample {
  float w = 0.0f;  // 1 / L1 distance; 0 = sky
  std::uint32_t triangle = kSky;
};

// The plane of a triangle as seen from a probe: w at any octahedron point q is the affine (normal . q) / distance.
struct Plane {
  glm::dvec3 normal{0.0};  // unit
  double distance = 0.0;   // normal . (vertex - probe)
  double w(glm::dvec3 q) const { return glm::dot(normal, q) / distance; }
  bool usable() const { return std::abs(distance) > 1e-9; }
};

class GeometryBaker {
 public:
  GeometryBaker(const RayScene& rays, glm::dvec3 position_m, int n) : rays_(rays), scene_(rays.scene()) {
    map_.position_m = position_m;
    map_.n = n;
    const std::size_t vertices = std::size_t(n + 1) * (n + 1);
    map_.w.resize(vertices);
    map_.edges_horizontal.resize(std::size_t(n) * (n + 1));
    map_.edges_vertical.resize(std::size_t(n) * (n + 1));
    map_.edges_diagonal.resize(std::size_t(n) * n);
    map_.normals.assign(vertices, 0);
    triangle_.resize(vertices);
  }

  ProbeGeometry bake(std::uint64_t* rays_cast) {
    sample_vertices();
    classify_edges();
    keep_needed_normals();
    if (rays_cast) *rays_cast += cast_.load();
    return std::move(map_);
  }

 private:
  std::size_t vertex(int i, int j) const { return std::size_t(j) * (map_.n + 1) + i; }
  glm::dvec3 point(int i, int j) const {
    return octahedral_point(2.0 * i / map_.n - 1.0, 2.0 * j / map_.n - 1.0);
  }

  Plane plane_of(std::uint32_t triangle) const {
    const glm::uvec3 index = scene_.triangles[triangle];
    const glm::dvec3 a(scene_.positions_m[index.x]), b(scene_.positions_m[index.y]), c(scene_.positions_m[index.z]);
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double length = glm::length(cross);
    if (!(length > 0.0)) return {};
    const glm::dvec3 normal = cross / length;
    return {normal, glm::dot(normal, a - map_.position_m)};
  }

  Sample sample(glm::dvec3 q) const {
    const double length = glm::length(q);
    const SurfaceHit hit = rays_.closest(glm::vec3(map_.position_m), glm::vec3(q / length));
    if (!hit.hit) return {};
    double t_m = std::max(double(hit.t), kMinDistance_m);
    // The plane in double makes w affine to the last bit of the float it is stored in; the ray's own t is good to
    // float only. Where the plane is seen edge-on it knows nothing, and the ray's t stays.
    const Plane plane = plane_of(hit.triangle);
    if (plane.usable()) {
      const double exact_m = length / plane.w(q);
      if (std::abs(exact_m - t_m) < 1e-3 * t_m) t_m = std::max(exact_m, kMinDistance_m);
    }
    return {static_cast<float>(length / t_m), hit.triangle};
  }

  // The four edges of the square are folded onto themselves: a vertex there has a mirror copy, the corners three.
  std::pair<int, int> canonical(int i, int j) const {
    const int n = map_.n;
    if (i == 0 || i == n) j = std::min(j, n - j);
    if (j == 0 || j == n) i = std::min(i, n - i);
    if (i == 0 || i == n) j = std::min(j, n - j);
    return {i, j};
  }

  void sample_vertices() {
    const int n = map_.n;
    tbb::parallel_for(0, n + 1, [&](int j) {
      std::uint64_t cast = 0;
      for (int i = 0; i <= n; ++i) {
        if (canonical(i, j) != std::pair(i, j)) continue;
        const Sample s = sample(point(i, j));
        map_.w[vertex(i, j)] = s.w;
        triangle_[vertex(i, j)] = s.triangle;
        ++cast;
      }
      cast_ += cast;
    });
    for (int k = 0; k <= n; ++k) {
      for (auto [i, j] : {std::pair(k, 0), std::pair(k, n), std::pair(0, k), std::pair(n, k)}) {
        const auto [ci, cj] = canonical(i, j);
        map_.w[vertex(i, j)] = map_.w[vertex(ci, cj)];
        triangle_[vertex(i, j)] = triangle_[vertex(ci, cj)];
      }
    }
  }

  // 0 = connected, else the cut's code. Vertices a and b, points qa and qb.
  std::uint8_t edge(std::size_t a, glm::dvec3 qa, std::size_t b, glm::dvec3 qb, std::uint64_t& cast) const {
    const double wa = map_.w[a], wb = map_.w[b];
    if (triangle_[a] == triangle_[b]) return kConnected;  // sky and sky as well
    if (wa > 0.0 && wb > 0.0) {
      const Plane pa = plane_of(triangle_[a]), pb = plane_of(triangle_[b]);
      if (pa.usable() && pb.usable()) {
        // Plane of b minus plane of a, at both ends: no difference = one surface, opposite signs = they meet between.
        const double at_a = pb.w(qa) - wa, at_b = wb - pa.w(qb);
        const double scale = std::max(wa, wb);
        const double low = std::min(std::abs(at_a), std::abs(at_b)), high = std::max(std::abs(at_a), std::abs(at_b));
        if (high < kSamePlane * scale) return kConnected;
        const double cosine = std::abs(glm::dot(pa.normal, pb.normal));
        if (low < kNearPlane * scale && high < kFarPlane * scale && cosine > kSmoothCosine) return kConnected;
        if (at_a * at_b < 0.0) {
          // The fold that the planes predict is asked for: planes also cross where one surface hides the other.
          const glm::dvec3 q = glm::mix(qa, qb, at_a / (at_a - at_b));
          ++cast;
          if (std::abs(sample(q).w - pa.w(q)) < kFoldTolerance * scale) return kConnected;
        }
      }
    }
    return bisect({map_.w[a], triangle_[a]}, qa, {map_.w[b], triangle_[b]}, qb, cast);
  }

  std::uint8_t bisect(Sample at_low, glm::dvec3 qa, Sample at_high, glm::dvec3 qb, std::uint64_t& cast) const {
    const double jump = std::abs(at_low.w - at_high.w), scale = std::max(at_low.w, at_high.w);
    int low = 0, high = kCutSteps;
    for (int k = 0; k < kHalvings; ++k) {
      const int middle = (low + high) / 2;
      const Sample at_middle = sample(glm::mix(qa, qb, double(middle) / kCutSteps));
      ++cast;
      if (std::abs(at_middle.w - at_low.w) > std::abs(at_middle.w - at_high.w)) {
        high = middle;
        at_high = at_middle;
      } else {
        low = middle;
        at_low = at_middle;
      }
    }
    if (at_low.w > 0.0f && at_high.w > 0.0f) {
      const double kept = std::abs(at_low.w - at_high.w);
      if (kept < std::max(kJumpKept * jump, kJumpLeast * scale)) return kConnected;
      // Ends that hardly differ (a corner of three walls between them) leave the surface's own slope.
      if (jump < kFarPlane * scale && at_low.triangle == at_high.triangle) return kConnected;
    }
    return static_cast<std::uint8_t>(low + 1);  // (value - 0.5) / 64 is the middle of the last interval
  }

  void classify_edges() {
    const int n = map_.n, half = n / 2;
    tbb::parallel_for(0, n + 1, [&](int j) {
      std::uint64_t cast = 0;
      const bool row_on_border = j == 0 || j == n;
      for (int i = 0; i < (row_on_border ? half : n); ++i) {
        map_.edges_horizontal[std::size_t(j) * n + i] =
            edge(vertex(i, j), point(i, j), vertex(i + 1, j), point(i + 1, j), cast);
      }
      if (j < n) {
        for (int i = 0; i <= n; ++i) {
          if ((i == 0 || i == n) && j >= half) continue;
          map_.edges_vertical[std::size_t(j) * (n + 1) + i] =
              edge(vertex(i, j), point(i, j), vertex(i, j + 1), point(i, j + 1), cast);
        }
        for (int i = 0; i < n; ++i) {
          const bool same_sign = (i >= half) == (j >= half);
          const int i0 = same_sign ? i + 1 : i, i1 = same_sign ? i : i + 1;
          map_.edges_diagonal[std::size_t(j) * n + i] =
              edge(vertex(i0, j), point(i0, j), vertex(i1, j + 1), point(i1, j + 1), cast);
        }
      }
      cast_ += cast;
    });
    // Mirror copies run the other way, so their fractions do too.
    const auto mirrored = [](std::uint8_t value) {
      return value == kConnected ? kConnected : static_cast<std::uint8_t>(kCutSteps + 1 - value);
    };
    for (int k = 0; k < half; ++k) {
      const int m = n - 1 - k;
      for (int j : {0, n}) {
        map_.edges_horizontal[std::size_t(j) * n + m] = mirrored(map_.edges_horizontal[std::size_t(j) * n + k]);
      }
      for (int i : {0, n}) {
        map_.edges_vertical[std::size_t(m) * (n + 1) + i] = mirrored(map_.edges_vertical[std::size_t(k) * (n + 1) + i]);
      }
    }
  }

  bool cell_has_cut(int i, int j) const {
    const int n = map_.n;
    return map_.edges_diagonal[std::size_t(j) * n + i] != kConnected ||
           map_.edges_horizontal[std::size_t(j) * n + i] != kConnected ||
           map_.edges_horizontal[std::size_t(j + 1) * n + i] != kConnected ||
           map_.edges_vertical[std::size_t(j) * (n + 1) + i] != kConnected ||
           map_.edges_vertical[std::size_t(j) * (n + 1) + i + 1] != kConnected;
  }

  void keep_needed_normals() {
    const int n = map_.n;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        if (!cell_has_cut(i, j)) continue;
        for (auto [x, y] : {std::pair(i, j), std::pair(i + 1, j), std::pair(i, j + 1), std::pair(i + 1, j + 1)}) {
          const std::size_t v = vertex(x, y);
          if (map_.normals[v] != 0 || triangle_[v] == kSky) continue;
          const Plane plane = plane_of(triangle_[v]);
          if (!plane.usable()) continue;
          // Towards the probe, so that the mirror copies of a border vertex agree.
          map_.normals[v] = encode_normal(glm::vec3(plane.distance > 0.0 ? -plane.normal : plane.normal));
        }
      }
    }
    for (int k = 0; k <= n; ++k) {  // a border vertex is needed where either copy is
      for (auto [i, j] : {std::pair(k, 0), std::pair(k, n), std::pair(0, k), std::pair(n, k)}) {
        const auto [ci, cj] = canonical(i, j);
        if (map_.normals[vertex(ci, cj)] == 0) map_.normals[vertex(ci, cj)] = map_.normals[vertex(i, j)];
      }
    }
    for (int k = 0; k <= n; ++k) {
      for (auto [i, j] : {std::pair(k, 0), std::pair(k, n), std::pair(0, k), std::pair(n, k)}) {
        const auto [ci, cj] = canonical(i, j);
        map_.normals[vertex(i, j)] = map_.normals[vertex(ci, cj)];
      }
    }
  }

  const RayScene& rays_;
  const Scene& scene_;
  ProbeGeometry map_;
  std::vector<std::uint32_t> triangle_;
  mutable std::atomic<std::uint64_t> cast_{0};
};

}  // namespace

ProbeGeometry bake_geometry(const RayScene& rays, glm::dvec3 position_m, int n, std::uint64_t* rays_cast) {
  return GeometryBaker(rays, position_m, n).bake(rays_cast);
}

}  // namespace probewalk
