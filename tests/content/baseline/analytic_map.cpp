#include "content/baseline/analytic_map.h"

#include <algorithm>
#include <cmath>

namespace probewalk::test {
namespace {

pw_uvec2 address_of(const void* data) {
  const auto place = reinterpret_cast<std::uintptr_t>(data);
  return {static_cast<pw_uint>(place), static_cast<pw_uint>(static_cast<std::uint64_t>(place) >> 32)};
}

// Octahedral, two snorm 16, u in the low half; 0 is kept for sky.
pw_uint normal_word(glm::dvec3 normal) {
  const double len = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  double u = normal.x / len, v = normal.y / len;
  if (normal.z < 0) {
    const double folded = (1 - std::abs(v)) * (u < 0 ? -1 : 1);
    v = (1 - std::abs(u)) * (v < 0 ? -1 : 1);
    u = folded;
  }
  const auto snorm = [](double value) { return static_cast<pw_uint>(std::lround(value * 32767)) & 0xffffu; };
  const pw_uint word = snorm(u) | snorm(v) << 16;
  return word == 0 ? 1u : word;
}

}  // namespace

glm::dvec3 map_direction(double u, double v) {
  const double z = 1 - std::abs(u) - std::abs(v);
  if (z >= 0) return {u, v, z};
  return {(1 - std::abs(v)) * (u < 0 ? -1 : 1), (1 - std::abs(u)) * (v < 0 ? -1 : 1), z};
}

AnalyticScene box_room(glm::dvec3 low, glm::dvec3 high) {
  return [=](glm::dvec3 from, glm::dvec3 d) -> std::optional<AnalyticHit> {
    AnalyticHit hit{1e300, {}};
    for (int axis = 0; axis < 3; ++axis) {
      if (d[axis] == 0) continue;
      const double t = ((d[axis] > 0 ? high[axis] : low[axis]) - from[axis]) / d[axis];
      if (t >= 0 && t < hit.t) {
        hit = {t, glm::dvec3(0)};
        hit.normal[axis] = 1;
      }
    }
    if (hit.t > 1e299) return std::nullopt;
    return hit;
  };
}

AnalyticScene sphere(glm::dvec3 centre, double radius) {
  return [=](glm::dvec3 from, glm::dvec3 d) -> std::optional<AnalyticHit> {
    const glm::dvec3 x = from - centre;
    const double b = glm::dot(x, d), under = b * b - glm::dot(x, x) + radius * radius;
    if (under < 0) return std::nullopt;
    const double root = std::sqrt(under), t = -b - root >= 0 ? -b - root : -b + root;
    if (t < 0) return std::nullopt;
    return AnalyticHit{t, (x + d * t) / radius};
  };
}

AnalyticScene wall(double at, double half_hole) {
  return [=](glm::dvec3 from, glm::dvec3 d) -> std::optional<AnalyticHit> {
    if (d.x == 0) return std::nullopt;
    const double t = (at - from.x) / d.x;
    const glm::dvec3 p = from + d * t;
    if (t < 0 || std::max(std::abs(p.y), std::abs(p.z)) < half_hole) return std::nullopt;
    return AnalyticHit{t, {1, 0, 0}};
  };
}

AnalyticScene pole(double x, double z, double radius) {
  return [=](glm::dvec3 from, glm::dvec3 d) -> std::optional<AnalyticHit> {
    const glm::dvec2 o(from.x - x, from.z - z), e(d.x, d.z);
    const double a = glm::dot(e, e);
    if (a == 0) return std::nullopt;
    const double b = glm::dot(o, e) / a, under = b * b - (glm::dot(o, o) - radius * radius) / a;
    if (under < 0) return std::nullopt;
    const double root = std::sqrt(under), t = -b - root >= 0 ? -b - root : -b + root;
    if (t < 0) return std::nullopt;
    const glm::dvec2 n = (o + e * t) / radius;
    return AnalyticHit{t, {n.x, 0, n.y}};
  };
}

AnalyticScene nearest_of(std::vector<AnalyticScene> scenes) {
  return [scenes = std::move(scenes)](glm::dvec3 from, glm::dvec3 d) {
    std::optional<AnalyticHit> best;
    for (const AnalyticScene& scene : scenes) {
      const auto hit = scene(from, d);
      if (hit && (!best || hit->t < best->t)) best = hit;
    }
    return best;
  };
}

AnalyticScene open_sky() {
  return [](glm::dvec3, glm::dvec3) -> std::optional<AnalyticHit> { return std::nullopt; };
}

AnalyticMap::AnalyticMap(const AnalyticScene& scene, glm::dvec3 probe, int n_log2) : probe_(probe), n_log2_(n_log2) {
  const int n = size();
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const glm::dvec3 d = glm::normalize(map_direction((2.0 * i + 1) / n - 1, (2.0 * j + 1) / n - 1));
      const auto hit = scene(probe, d);
      distance_.push_back(hit ? static_cast<float>(hit->t) : kBaselineSky_m);
      normal_.push_back(hit ? normal_word(glm::dot(hit->normal, d) > 0 ? -hit->normal : hit->normal) : 0u);
    }
  }
  // Each texel counts with its neighbours, so that a node bounds what lies between the centres; finer never exceeds.
  std::vector<float> finer(distance_.size());
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      float least = kBaselineSky_m;
      for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
          const int x = std::clamp(i + di, 0, n - 1), y = std::clamp(j + dj, 0, n - 1);
          least = std::min(least, distance_[static_cast<std::size_t>(y * n + x)]);
        }
      }
      finer[static_cast<std::size_t>(j * n + i)] = least;
    }
  }
  for (int level = 1; level <= n_log2; ++level) {
    const int side = n >> level;
    std::vector<float> coarser;
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const auto at = [&](int dx, int dy) {
          return finer[static_cast<std::size_t>((2 * j + dy) * 2 * side + 2 * i + dx)];
        };
        coarser.push_back(std::min({at(0, 0), at(1, 0), at(0, 1), at(1, 1)}));
      }
    }
    minimum_.insert(minimum_.end(), coarser.begin(), coarser.end());
    finer = std::move(coarser);
  }
}

BaselineRecord AnalyticMap::record() const {
  BaselineRecord record{};
  record.distance_address = address_of(distance_.data());
  record.minimum_address = address_of(minimum_.data());
  record.normal_address = address_of(normal_.data());
  record.n_log2 = static_cast<pw_uint>(n_log2_);
  return record;
}

}  // namespace probewalk::test
