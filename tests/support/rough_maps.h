// Maps of every kind that a pyramid must be built of, without a scene: planes seen from a probe, bumps on them as small
// as the tolerance of planes, sky, cuts, noise, and the extremes of what a pack may hold.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "content/probe/probe_map.h"
#include "support/low_discrepancy.h"

namespace probewalk::test {

struct RoughMap {
  std::string name;
  ProbeMap map;
};

// w as the walls of a box around the probe give it, exact on planes but for rounding.
inline float box_w(int n, int i, int j) {
  const glm::dvec3 q = octahedral_point(2.0 * i / n - 1.0, 2.0 * j / n - 1.0);
  return static_cast<float>(std::max({std::abs(q.x) / 2.1, q.y / 1.3, -q.y / 1.1, std::abs(q.z + 0.01 * q.x) / 3.7}));
}

inline ProbeMap blank_map(int n) {
  ProbeMap map;
  ProbeGeometry& g = map.geometry;
  const auto side = static_cast<std::size_t>(n), vertices = (side + 1) * (side + 1);
  g.n = n;
  g.w.assign(vertices, 0.0f);
  g.normals.assign(vertices, 0);
  g.edges_horizontal.assign(side * (side + 1), kConnected);
  g.edges_vertical.assign(side * (side + 1), kConnected);
  g.edges_diagonal.assign(side * side, kConnected);
  map.radiance.r = 8;
  map.radiance.rgb9e5.assign(mip_chain_texels(8), 0u);
  map.radiance.texel_w.assign(64, 0);
  return map;
}

// All kinds at n cells a side.
inline std::vector<RoughMap> rough_maps(int n) {
  std::vector<RoughMap> maps;
  const auto add = [&](const std::string& name, auto w) {
    RoughMap& made = maps.emplace_back(RoughMap{name + ", n = " + std::to_string(n), blank_map(n)});
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        made.map.geometry.w[static_cast<std::size_t>(j) * (n + 1) + static_cast<std::size_t>(i)] = w(i, j);
      }
    }
    return &made.map.geometry;
  };
  Random random(static_cast<unsigned>(n));
  const auto cut_some = [&](ProbeGeometry& g, double share) {
    for (auto* edges : {&g.edges_horizontal, &g.edges_vertical, &g.edges_diagonal}) {
      for (std::uint8_t& edge : *edges) {
        if (random(0.0, 1.0) < share) edge = static_cast<std::uint8_t>(random(1.0, kCutSteps + 0.99));
      }
    }
  };
  add("sky", [](int, int) { return 0.0f; });
  add("a wall everywhere at one L1 distance", [](int, int) { return 0.25f; });
  add("box", [&](int i, int j) { return box_w(n, i, j); });
  add("half sky", [&](int i, int j) { return i + j > n ? box_w(n, i, j) : 0.0f; });
  add("sky in one vertex", [&](int i, int j) { return i == n / 2 + 3 && j == n / 2 ? 0.0f : box_w(n, i, j); });
  add("bumps about as high as the tolerance",
      [&](int i, int j) { return box_w(n, i, j) * static_cast<float>(1.0 + 2e-6 * random(-1.0, 1.0)); });
  add("rare bumps", [&](int i, int j) {
    return box_w(n, i, j) * (random(0.0, 1.0) < 0.002 ? 1.0f + static_cast<float>(random(0.0, 4e-6)) : 1.0f);
  });
  add("noise", [&](int, int) { return static_cast<float>(std::exp(random(-6.0, 6.0))); });
  add("the extremes of a pack", [&](int, int) { return random(0.0, 1.0) < 0.5 ? 1e-9f : 1e6f; });
  add("a steep ramp to the fold", [&](int i, int j) {
    return 1e-3f + static_cast<float>(std::abs(i - n / 2) + std::abs(j - n / 2)) / static_cast<float>(n);
  });
  cut_some(*add("box with few cuts", [&](int i, int j) { return box_w(n, i, j); }), 0.003);
  cut_some(*add("noise with many cuts", [&](int, int) { return static_cast<float>(std::exp(random(-6.0, 6.0))); }),
           0.5);
  cut_some(*add("all cut", [&](int i, int j) { return box_w(n, i, j); }), 1.0);
  return maps;
}

}  // namespace probewalk::test
