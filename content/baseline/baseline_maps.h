// What the baselines read beside a pack's probes, made from the scene for a measurement; layout: see
// shaders/shared/baseline_layout.h. A probe sees what it saw when the pack was baked: every triangle from both sides,
// points that an alpha test leaves out excepted.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "content/baseline/method.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"

namespace probewalk {

struct BaselineMap {
  std::vector<float> distance_m;      // n^2
  std::vector<float> minimum_m;       // levels 1 .. log2(n) one after the other: (n^2 - 1) / 3
  std::vector<std::uint32_t> normal;  // n^2
  BaselineRecord record{};            // everything but the addresses
};

struct BaselineMaps {
  int n = 0;                        // texels a side, 2^k
  std::vector<BaselineMap> probes;  // in the order of the pack's probes
  float farthest_m = 0.0f;          // distance of the farthest surface that any probe sees
};

inline constexpr int kLeastBaselineSide = 8;
inline constexpr int kGreatestBaselineSide = 8192;

// One ray through every texel's centre, on all cores. n = 2^k in [kLeastBaselineSide, kGreatestBaselineSide], else
// BadUsage. Throws Interrupted.
BaselineMaps make_baseline_maps(const RayScene& rays, std::span<const glm::dvec3> positions_m, int n, Progress& progress);

// A probe's pyramid and record from its distances and normals, which are kept.
BaselineMap derive_baseline_map(int n, std::vector<float> distance_m, std::vector<std::uint32_t> normal);

// BaselineMaps::farthest_m of these probes.
float farthest_seen_m(std::span<const BaselineMap> probes);

// Words where level 1 .. of the pyramid begins in minimum_m.
std::size_t minimum_offset(int n, int level);

// Unit normal as stored: octahedral, two snorm16. Never 0, which stands for the sky.
std::uint32_t encode_baseline_normal(glm::vec3 unit_normal);
glm::vec3 decode_baseline_normal(std::uint32_t word);

// The constants that a choice traces with on these maps: an end to rays where the choice has none. Without addresses.
BaselineConstants baseline_constants_for(const TracerChoice& choice, const BaselineMaps& maps);

}  // namespace probewalk
