#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <vector>

#include "content/bake/bake_probe.h"

namespace probewalk {
namespace {

constexpr double kMinDistance_m = 1e-4;  // as for the samples of the geometry
// A sub-sample counts when it lies on the surface that the centre sees: within this share of the centre's plane, or
// this near to it for something curved that faces the same way.
constexpr float kSamePlane = 2e-3f;
constexpr float kCurved = 0.03f;
constexpr float kSameFacing = 0.7f;
// A texel whose neighbours on the same surface are lit alike within this share is as good as its centre: textures are
// filtered over its footprint anyway, so only light can change inside it.
constexpr float kEven = 0.03f;
constexpr float kEvenFloor_lux = 1e-2f;
// Sub-samples within the texel, rotated so that no two share a row or column (the centre is a fifth).
constexpr std::array<glm::dvec2, 4> kSubSamples{{{-0.375, -0.125}, {0.125, -0.375}, {0.375, 0.125}, {-0.125, 0.375}}};

struct Centre {
  glm::vec3 radiance{0.0f};
  glm::vec3 irradiance{0.0f};
  float w = 0.0f;  // 0 = sky
  glm::vec3 direction{0.0f};  // unit
  SurfaceHit hit;
  float plane_distance = 0.0f;  // geometric normal . (point - probe)
  float footprint_m = 0.0f;
};

class RadianceBaker {
 public:
  RadianceBaker(const RayScene& rays, const LightField& light, glm::dvec3 position_m, int r)
      : rays_(rays), light_(light), origin_m_(position_m), r_(r), centres_(std::size_t(r) * r) {}

  ProbeRadiance bake(float radiance_scale, std::uint64_t* rays_cast) {
    // Every other texel of every other row is lit by shadow rays; the rest too, but where the lit ones around agree.
    for_each_row([&](int j, std::uint64_t& cast) {
      for (int i = 0; i < r_; ++i) see_centre(i, j, i % 2 == 0 && j % 2 == 0);
      cast += r_;
    });
    for_each_row([&](int j, std::uint64_t&) {
      for (int i = j % 2 == 0 ? 1 : 0; i < r_; i += j % 2 == 0 ? 2 : 1) light_between(i, j);
    });
    std::vector<glm::vec3> level(centres_.size());
    for_each_row([&](int j, std::uint64_t& cast) {
      for (int i = 0; i < r_; ++i) level[texel(i, j)] = radiance_scale * (is_even(i, j) ? centres_[texel(i, j)].radiance : average(i, j, cast));
    });
    ProbeRadiance map;
    map.r = r_;
    map.texel_w.resize(centres_.size());
    for (std::size_t k = 0; k < centres_.size(); ++k) map.texel_w[k] = encode_texel_w(centres_[k].w);
    map.rgb9e5.reserve(mip_chain_texels(r_));
    append_mips(std::move(level), map.rgb9e5);
    if (rays_cast) *rays_cast += cast_.load();
    return map;
  }

 private:
  std::size_t texel(int i, int j) const { return std::size_t(j) * r_ + i; }
  glm::dvec3 point(double i, double j) const {
    return octahedral_point((2.0 * i + 1.0) / r_ - 1.0, (2.0 * j + 1.0) / r_ - 1.0);
  }
  // Square root of the texel's solid angle: du dv / |q|^3 on the octahedron.
  float spread_rad(double length) const { return static_cast<float>(2.0 / r_ / (length * std::sqrt(length))); }

  template <typename Work>
  void for_each_row(Work&& work) {
    tbb::parallel_for(0, r_, [&](int j) {
      std::uint64_t cast = 0;
      work(j, cast);
      cast_ += cast;
    });
  }

  void see_centre(int i, int j, bool lit) {
    const glm::dvec3 q = point(i, j);
    const double length = glm::length(q);
    Centre& centre = centres_[texel(i, j)];
    centre.direction = glm::vec3(q / length);
    centre.hit = rays_.closest(glm::vec3(origin_m_), centre.direction);
    if (!centre.hit.hit) {
      centre.radiance = rays_.scene().sky.radiance(centre.direction);
      return;
    }
    centre.footprint_m = spread_rad(length) * centre.hit.t;
    centre.w = static_cast<float>(length / std::max(double(centre.hit.t), kMinDistance_m));
    centre.plane_distance = glm::dot(centre.hit.geometric_normal, centre.direction) * centre.hit.t;
    if (lit) light_centre(centre);
  }

  void light_centre(Centre& centre) const {
    centre.radiance = light_.outgoing(centre.hit, glm::vec3(origin_m_), centre.direction, centre.footprint_m, &centre.irradiance);
  }

  // Between texels of the same surface that are lit alike the light is theirs; anywhere else it is looked for.
  void light_between(int i, int j) {
    Centre& centre = centres_[texel(i, j)];
    if (centre.w == 0.0f) return;
    const int du = i % 2, dv = j % 2;
    glm::vec3 sum(0.0f), low(1e30f), high(0.0f);
    int count = 0;
    bool alike = i + du < r_ && j + dv < r_;
    for (int y = j - dv; alike && y <= j + dv; y += std::max(2 * dv, 1)) {
      for (int x = i - du; alike && x <= i + du; x += std::max(2 * du, 1)) {
        const Centre& other = centres_[texel(x, y)];
        alike = other.w > 0.0f && continues(centre, other);
        sum += other.irradiance;
        low = glm::min(low, other.irradiance);
        high = glm::max(high, other.irradiance);
        ++count;
      }
    }
    if (!alike || differs(low, high)) return light_centre(centre);
    centre.irradiance = sum / static_cast<float>(count);
    centre.radiance = light_.outgoing_lit(centre.hit, centre.direction, centre.footprint_m, centre.irradiance);
  }

  static bool differs(glm::vec3 low, glm::vec3 high) {
    return glm::any(glm::greaterThan(high - low, kEven * high + kEvenFloor_lux));
  }
  static bool continues(const Centre& centre, const Centre& other) {
    return continues(centre, other.direction, other.hit.t, other.hit.geometric_normal, other.hit.triangle);
  }

  // Whether a hit along a unit direction continues the surface that the centre sees.
  static bool continues(const Centre& centre, glm::vec3 direction, float t, glm::vec3 normal, std::uint32_t triangle) {
    if (triangle == centre.hit.triangle) return true;
    const float on_plane = glm::dot(centre.hit.geometric_normal, direction) * t;
    const float error = std::abs(on_plane - centre.plane_distance);
    const float scale = std::max(std::abs(centre.plane_distance), 0.05f * t);
    if (error < kSamePlane * scale) return std::abs(glm::dot(centre.hit.geometric_normal, normal)) > kSameFacing;
    return error < kCurved * scale && std::abs(glm::dot(centre.hit.geometric_normal, normal)) > kSameFacing;
  }

  bool is_even(int i, int j) const {
    const Centre& own = centres_[texel(i, j)];
    for (auto [x, y] : {std::pair(i - 1, j), std::pair(i + 1, j), std::pair(i, j - 1), std::pair(i, j + 1)}) {
      if (x < 0 || y < 0 || x >= r_ || y >= r_) continue;
      const Centre& other = centres_[texel(x, y)];
      if (other.w == 0.0f || own.w == 0.0f) continue;
      if (!continues(own, other)) continue;
      if (differs(glm::min(own.irradiance, other.irradiance), glm::max(own.irradiance, other.irradiance))) return false;
    }
    return true;
  }

  glm::vec3 average(int i, int j, std::uint64_t& cast) const {
    const Centre& centre = centres_[texel(i, j)];
    glm::vec3 sum = centre.radiance;
    float count = 1.0f;
    for (glm::dvec2 offset : kSubSamples) {
      const glm::dvec3 q = point(i + offset.x, j + offset.y);
      const double length = glm::length(q);
      const glm::vec3 direction(q / length);
      const SurfaceHit hit = rays_.closest(glm::vec3(origin_m_), direction);
      ++cast;
      if (!hit.hit || centre.w == 0.0f) {
        if (hit.hit || centre.w != 0.0f) continue;
        sum += rays_.scene().sky.radiance(direction);
      } else {
        if (!continues(centre, direction, hit.t, hit.geometric_normal, hit.triangle)) continue;
        // Half the texel's width: four of them share its area.
        sum += light_.outgoing(hit, glm::vec3(origin_m_), direction, 0.5f * spread_rad(length) * hit.t);
      }
      count += 1.0f;
    }
    return sum / count;
  }

  // Box-filtered in linear floats, so that no rounding of one mip reaches the next.
  void append_mips(std::vector<glm::vec3> level, std::vector<std::uint32_t>& words) const {
    for (int side = r_;; side /= 2) {
      for (const glm::vec3& value : level) words.push_back(encode_rgb9e5(value));
      if (side == 1) return;
      const int half = side / 2;
      std::vector<glm::vec3> next(std::size_t(half) * half);
      for (int j = 0; j < half; ++j) {
        for (int i = 0; i < half; ++i) {
          const std::size_t k = std::size_t(2 * j) * side + 2 * i;
          next[std::size_t(j) * half + i] = 0.25f * (level[k] + level[k + 1] + level[k + side] + level[k + side + 1]);
        }
      }
      level = std::move(next);
    }
  }

  const RayScene& rays_;
  const LightField& light_;
  const glm::dvec3 origin_m_;
  const int r_;
  std::vector<Centre> centres_;
  std::atomic<std::uint64_t> cast_{0};
};

}  // namespace

ProbeRadiance bake_radiance(const RayScene& rays, const LightField& light, glm::dvec3 position_m, int r,
                            float radiance_scale, std::uint64_t* rays_cast) {
  return RadianceBaker(rays, light, position_m, r).bake(radiance_scale, rays_cast);
}

}  // namespace probewalk
