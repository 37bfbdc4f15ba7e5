// A furnished room with eight probes whose radiance is a smooth pattern over its surfaces: small and quick to make.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <initializer_list>
#include <utility>
#include <vector>

#include "content/bake/bake_probe.h"
#include "content/bake/placement.h"
#include "content/probe/device_probe.h"
#include "content/probe/probe_set.h"
#include "content/scene/ray_scene.h"
#include "render/probe_store.h"
#include "support/test_scenes.h"

namespace probewalk::test {

inline constexpr float kRadianceScale = 0.5f;

// Radiance in cd/m^2 at a point.
inline glm::vec3 pattern(glm::vec3 p) {
  return {0.6f + 0.4f * std::sin(3.0f * p.x), 0.6f + 0.4f * std::sin(3.0f * p.y), 0.6f + 0.4f * std::sin(3.0f * p.z)};
}

inline ProbeRadiance pattern_radiance(const RayScene& rays, glm::dvec3 position_m, int r) {
  ProbeRadiance radiance;
  radiance.r = r;
  std::vector<glm::vec3> mip;
  for (int j = 0; j < r; ++j) {
    for (int i = 0; i < r; ++i) {
      const glm::dvec3 q = octahedral_point((2 * i + 1.0) / r - 1, (2 * j + 1.0) / r - 1);
      const SurfaceHit hit = rays.closest(glm::vec3(position_m), glm::vec3(q));
      mip.push_back(hit.hit ? pattern(glm::vec3(position_m + q * static_cast<double>(hit.t))) : glm::vec3(2.0f));
      radiance.texel_w.push_back(hit.hit ? encode_texel_w(1.0f / hit.t) : std::uint16_t{0});  // |q|_1 = 1
    }
  }
  for (int size = r;; size /= 2) {
    for (const glm::vec3& color : mip) radiance.rgb9e5.push_back(encode_rgb9e5(color * kRadianceScale));
    if (size == 1) return radiance;
    std::vector<glm::vec3> coarser;
    for (int j = 0; j < size; j += 2) {
      for (int i = 0; i < size; i += 2) {
        const auto at = [&](int x, int y) { return mip[static_cast<std::size_t>(y) * size + x]; };
        coarser.push_back((at(i, j) + at(i + 1, j) + at(i, j + 1) + at(i + 1, j + 1)) * 0.25f);
      }
    }
    mip = std::move(coarser);
  }
}

struct ProbeRoom {
  Scene scene;
  ProbeGrid grid;
  std::vector<DeviceProbe> probes;

  // `samples` of the probes by turns, from the first on.
  explicit ProbeRoom(int n = 64, int r = 32, std::initializer_list<DeviceSamples> samples = {DeviceSamples::kFloat},
                     Scene of = furnished_room())
      : scene(std::move(of)) {
    const RayScene rays(scene);
    grid.origin_m = {-1.6, 0.9, -1.1};
    grid.spacing_m = {3.1, 1.1, 2.4};
    grid.dims = {2, 2, 2};
    for (int k = 0; k < 8; ++k) {
      const glm::dvec3 position = grid.origin_m + grid.spacing_m * glm::dvec3(k & 1, k >> 1 & 1, k >> 2);
      probes.push_back(build_device_probe({bake_geometry(rays, position, n), pattern_radiance(rays, position, r)},
                                          PyramidMaker::kHost,
                                          samples.begin()[static_cast<std::size_t>(k) % samples.size()]));
      grid.probe.push_back(static_cast<std::uint32_t>(k));
    }
  }

  RoomUpload upload(std::uint32_t level = 0) const { return {0, level, 0, probes}; }
  std::uint32_t probe_count() const { return static_cast<std::uint32_t>(probes.size()); }
  ProbeSet on_cpu() const { return ProbeSet(probes, grid); }
};

}  // namespace probewalk::test
