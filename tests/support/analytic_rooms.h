// Rooms whose every ray has a known answer: a box and a ball, seen from inside, with probes baked in them.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

#include "content/bake/bake_probe.h"
#include "content/probe/device_probe.h"
#include "content/probe/probe_set.h"
#include "content/scene/ray_scene.h"
#include "support/test_scenes.h"

namespace probewalk::test {

struct BoxRoom {
  glm::dvec3 lower_m{-2.0, 0.0, -3.0};
  glm::dvec3 upper_m{4.0, 2.5, 1.0};

  Scene scene() const { return SceneBuilder().box(glm::vec3(lower_m), glm::vec3(upper_m), true).build(); }
  // Metres along the unit direction from a point inside.
  double distance(glm::dvec3 origin_m, glm::dvec3 direction) const {
    double nearest = 1e300;
    for (int axis = 0; axis < 3; ++axis) {
      if (direction[axis] == 0.0) continue;
      const double wall = direction[axis] > 0.0 ? upper_m[axis] : lower_m[axis];
      nearest = std::min(nearest, (wall - origin_m[axis]) / direction[axis]);
    }
    return nearest;
  }
};

// A ball of triangles so fine that they are within 1e-4 of its radius.
inline Scene ball_room(double radius_m, glm::dvec3 centre_m = glm::dvec3(0.0)) {
  constexpr int kRings = 256, kSectors = 512;
  Scene scene;
  scene.name = "ball";
  scene.materials.push_back({});
  const auto add = [&](glm::dvec3 direction) {
    const glm::vec3 position_m(centre_m + direction * radius_m);
    scene.positions_m.push_back(position_m);
    scene.normals.push_back(glm::vec3(-direction));
    scene.bounds.lower_m = glm::min(scene.bounds.lower_m, glm::dvec3(position_m));
    scene.bounds.upper_m = glm::max(scene.bounds.upper_m, glm::dvec3(position_m));
  };
  for (int ring = 0; ring <= kRings; ++ring) {
    const double theta = std::numbers::pi * ring / kRings;
    for (int sector = 0; sector < kSectors; ++sector) {
      const double phi = 2.0 * std::numbers::pi * sector / kSectors;
      add({std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
    }
  }
  for (std::uint32_t ring = 0; ring < kRings; ++ring) {
    for (std::uint32_t sector = 0; sector < kSectors; ++sector) {
      const std::uint32_t next = (sector + 1) % kSectors;
      const std::uint32_t a = ring * kSectors + sector, b = ring * kSectors + next;
      const std::uint32_t c = a + kSectors, d = b + kSectors;
      for (const glm::uvec3& corners : {glm::uvec3(a, c, b), glm::uvec3(b, c, d)}) {
        scene.triangles.push_back(corners);
        scene.triangle_material.push_back(0);
        scene.triangle_object.push_back(0);
      }
    }
  }
  return scene;
}

// A radiance of one colour: for tests of distance.
inline ProbeRadiance grey_radiance(int r) {
  ProbeRadiance radiance;
  radiance.r = r;
  radiance.rgb9e5.assign(mip_chain_texels(r), encode_rgb9e5(glm::vec3(0.5f)));
  radiance.texel_w.assign(static_cast<std::size_t>(r) * static_cast<std::size_t>(r), encode_texel_w(0.3f));
  return radiance;
}

// Baked probes at the corners of a grid.
inline ProbeSet probe_set(const RayScene& rays, const ProbeGrid& grid, int n) {
  std::vector<DeviceProbe> probes;
  for (int z = 0; z < grid.dims.z; ++z) {
    for (int y = 0; y < grid.dims.y; ++y) {
      for (int x = 0; x < grid.dims.x; ++x) {
        const glm::dvec3 position_m = grid.origin_m + grid.spacing_m * glm::dvec3(x, y, z);
        probes.push_back(build_device_probe({bake_geometry(rays, position_m, n), grey_radiance(8)}));
      }
    }
  }
  return ProbeSet(std::move(probes), grid);
}

// A grid with a probe of its own at every vertex.
inline ProbeGrid plain_grid(glm::dvec3 origin_m, glm::dvec3 spacing_m, glm::ivec3 dims) {
  ProbeGrid grid{origin_m, spacing_m, dims, {}};
  for (int k = 0; k < dims.x * dims.y * dims.z; ++k) grid.probe.push_back(static_cast<std::uint32_t>(k));
  return grid;
}

inline std::vector<glm::dvec3> grid_positions_m(const ProbeGrid& grid) {
  std::vector<glm::dvec3> positions_m;
  for (int z = 0; z < grid.dims.z; ++z) {
    for (int y = 0; y < grid.dims.y; ++y) {
      for (int x = 0; x < grid.dims.x; ++x) positions_m.push_back(grid.origin_m + grid.spacing_m * glm::dvec3(x, y, z));
    }
  }
  return positions_m;
}

}  // namespace probewalk::test
