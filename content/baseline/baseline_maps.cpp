#include "content/baseline/baseline_maps.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "content/error.h"
#include "content/probe/probe_map.h"

namespace probewalk {
namespace {

// As bake_geometry.cpp has it: nothing is nearer to a probe.
constexpr double kMinDistance_m = 1e-4;
// A surface faces along an axis when its normal is within 26 degrees of it.
constexpr float kFacingCosine = 0.9f;
// The probe's box has at least this much room around it.
constexpr float kLeastBox_m = 1e-3f;

glm::dvec3 texel_point(int n, int i, int j) { return octahedral_point((2 * i + 1.0) / n - 1, (2 * j + 1.0) / n - 1); }

// Solid angle of a texel, up to a factor that all texels of a map share.
double texel_weight(glm::dvec3 point) { return std::pow(glm::length(point), -3.0); }

// Index of texel (i, j), steps by one outside folded back over the octahedron's edges.
std::size_t folded(int n, int i, int j) {
  if (i < 0 || i >= n) {
    i = i < 0 ? 0 : n - 1;
    j = n - 1 - j;
  }
  if (j < 0 || j >= n) {
    j = j < 0 ? 0 : n - 1;
    i = n - 1 - i;
  }
  return static_cast<std::size_t>(std::clamp(j, 0, n - 1)) * static_cast<std::size_t>(n) +
         static_cast<std::size_t>(std::clamp(i, 0, n - 1));
}

void check_side(int n) {
  if (n < kLeastBaselineSide || n > kGreatestBaselineSide || !std::has_single_bit(static_cast<unsigned>(n))) {
    throw BadUsage(fmt::format("baseline maps of {} texels a side; give a power of two from {} to {}", n,
                               kLeastBaselineSide, kGreatestBaselineSide));
  }
}

std::vector<float> minimum_pyramid(int n, const std::vector<float>& distance_m) {
  std::vector<float> pyramid;
  pyramid.reserve((distance_m.size() - 1) / 3);
  // Level 1 takes its 2 x 2 texels and the ring around them: a texel's neighbours bound the surface up to their centres.
  for (int y = 0; y < n; y += 2) {
    for (int x = 0; x < n; x += 2) {
      float least = kBaselineSky_m;
      for (int j = y - 1; j <= y + 2; ++j) {
        for (int i = x - 1; i <= x + 2; ++i) least = std::min(least, distance_m[folded(n, i, j)]);
      }
      pyramid.push_back(least);
    }
  }
  for (int level = 2; (n >> level) >= 1; ++level) {
    const std::size_t finer = minimum_offset(n, level - 1), side = static_cast<std::size_t>(n >> (level - 1));
    for (std::size_t y = 0; y < side; y += 2) {
      for (std::size_t x = 0; x < side; x += 2) {
        const float* at = pyramid.data() + finer + y * side + x;
        pyramid.push_back(std::min(std::min(at[0], at[1]), std::min(at[side], at[side + 1])));
      }
    }
  }
  return pyramid;
}

// Where along an axis the box ends: the plane across the axis that holds the middle of what faces the probe, by solid
// angle. Furniture covers less of a wall than is left of it.
float box_side(std::vector<std::pair<float, float>>& offset_and_weight, float farthest_m) {
  if (offset_and_weight.empty()) return std::max(farthest_m, kLeastBox_m);
  std::sort(offset_and_weight.begin(), offset_and_weight.end());
  double sum = 0.0;
  for (const auto& [offset, weight] : offset_and_weight) sum += static_cast<double>(weight);
  double so_far = 0.0;
  for (const auto& [offset, weight] : offset_and_weight) {
    so_far += static_cast<double>(weight);
    if (2.0 * so_far >= sum) return std::max(offset, kLeastBox_m);
  }
  return std::max(offset_and_weight.back().first, kLeastBox_m);
}

void measure_proxies(int n, const std::vector<float>& distance_m, const std::vector<std::uint32_t>& normals,
                     BaselineRecord& record) {
  double weights = 0.0, distances = 0.0;
  std::array<std::vector<std::pair<float, float>>, 6> facing;  // lower x, upper x, lower y, ...
  std::array<float, 6> farthest_m{};
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const std::size_t texel = static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i);
      if (!(distance_m[texel] < kBaselineSky_m)) continue;
      const glm::dvec3 point = texel_point(n, i, j);
      const double weight = texel_weight(point);
      weights += weight;
      distances += weight * static_cast<double>(distance_m[texel]);
      const glm::vec3 hit = glm::vec3(point * (static_cast<double>(distance_m[texel]) / glm::length(point)));
      const glm::vec3 normal = decode_baseline_normal(normals[texel]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int component = static_cast<int>(axis);
        const std::size_t side = 2 * axis + (hit[component] > 0.0f ? 1 : 0);
        const float offset = std::abs(hit[component]);
        farthest_m[side] = std::max(farthest_m[side], offset);
        // The normal is turned to the probe.
        const bool faces = hit[component] > 0.0f ? normal[component] < -kFacingCosine : normal[component] > kFacingCosine;
        if (faces) facing[side].emplace_back(offset, static_cast<float>(weight));
      }
    }
  }
  record.mean_m = weights > 0.0 ? static_cast<float>(distances / weights) : 0.0f;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int component = static_cast<int>(axis);
    record.box_min_m[component] = -box_side(facing[2 * axis], farthest_m[2 * axis]);
    record.box_max_m[component] = box_side(facing[2 * axis + 1], farthest_m[2 * axis + 1]);
  }
}

}  // namespace

std::size_t minimum_offset(int n, int level) {
  const auto side = static_cast<std::size_t>(n), finer = static_cast<std::size_t>(n >> (level - 1));
  return (side * side - finer * finer) / 3;
}

std::uint32_t encode_baseline_normal(glm::vec3 unit_normal) {
  const glm::dvec2 uv = octahedral_coordinates(glm::dvec3(unit_normal));
  const auto snorm = [](double value) {
    return static_cast<std::uint32_t>(static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(value * 32767.0))));
  };
  const std::uint32_t word = snorm(uv.x) | snorm(uv.y) << 16;
  return word != 0 ? word : 1u;  // straight up: a step of 1/32767 beside it
}

glm::vec3 decode_baseline_normal(std::uint32_t word) {
  if (word == 0) return glm::vec3(0.0f);
  const auto snorm = [](std::uint32_t bits) { return static_cast<std::int16_t>(static_cast<std::uint16_t>(bits)) / 32767.0; };
  return glm::vec3(glm::normalize(octahedral_point(snorm(word & 0xffffu), snorm(word >> 16))));
}

BaselineMap derive_baseline_map(int n, std::vector<float> distance_m, std::vector<std::uint32_t> normal) {
  BaselineMap map;
  map.record.n_log2 = static_cast<std::uint32_t>(std::bit_width(static_cast<unsigned>(n)) - 1);
  measure_proxies(n, distance_m, normal, map.record);
  map.minimum_m = minimum_pyramid(n, distance_m);
  map.distance_m = std::move(distance_m);
  map.normal = std::move(normal);
  return map;
}

BaselineMaps make_baseline_maps(const RayScene& rays, std::span<const glm::dvec3> positions_m, int n,
                                Progress& progress) {
  check_side(n);
  const std::size_t texels = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  BaselineMaps maps;
  maps.n = n;
  progress.begin("baseline maps", positions_m.size() * static_cast<std::uint64_t>(n), "rows");
  for (const glm::dvec3 position_m : positions_m) {
    std::vector<float> distance_m(texels, kBaselineSky_m);
    std::vector<std::uint32_t> normal(texels, 0);
    tbb::parallel_for(0, n, [&](int j) {
      if (progress.cancelled()) return;
      for (int i = 0; i < n; ++i) {
        const glm::dvec3 direction = glm::normalize(texel_point(n, i, j));
        const SurfaceHit hit = rays.closest(glm::vec3(position_m), glm::vec3(direction));
        if (!hit.hit) continue;
        const glm::dvec3 n_hit(hit.geometric_normal);
        const double facing = glm::dot(n_hit, direction);
        double t_m = std::max(static_cast<double>(hit.t), kMinDistance_m);
        // The triangle's plane in double, as the baker has it, where it is not seen edge-on.
        const Scene& scene = rays.scene();
        const double offset_m =
            glm::dot(n_hit, glm::dvec3(scene.positions_m[scene.triangles[hit.triangle].x]) - position_m);
        if (std::abs(facing) > 1e-9 && std::abs(offset_m / facing - t_m) < 1e-3 * t_m) {
          t_m = std::max(offset_m / facing, kMinDistance_m);
        }
        const std::size_t texel = static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i);
        distance_m[texel] = static_cast<float>(t_m);
        normal[texel] = encode_baseline_normal(facing > 0.0 ? -hit.geometric_normal : hit.geometric_normal);
      }
      progress.advance(1);
    });
    if (progress.cancelled()) throw Interrupted("interrupted while casting the baseline maps; nothing was kept");
    maps.probes.push_back(derive_baseline_map(n, std::move(distance_m), std::move(normal)));
  }
  maps.farthest_m = farthest_seen_m(maps.probes);
  return maps;
}

float farthest_seen_m(std::span<const BaselineMap> probes) {
  float farthest_m = 0.0f;
  for (const BaselineMap& map : probes) {
    for (const float distance_m : map.distance_m) {
      if (distance_m < kBaselineSky_m) farthest_m = std::max(farthest_m, distance_m);
    }
  }
  return farthest_m;
}

BaselineConstants baseline_constants_for(const TracerChoice& choice, const BaselineMaps& maps) {
  BaselineConstants constants = choice.baseline;
  // From anywhere that a probe sees to anywhere that it sees.
  if (!(constants.farthest_m > 0.0f)) constants.farthest_m = std::max(2.0f * maps.farthest_m, 1.0f);
  return constants;
}

}  // namespace probewalk
