#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "content/bake/bake_probe.h"
#include "content/bake/plain_scenes.h"

namespace probewalk {
namespace {

constexpr int kCells = 64;
const glm::dvec3 kProbe(0.25, 1.5, -0.5);

Scene room() {
  Scene scene;
  const std::uint32_t wall = plain::add_material(scene, glm::vec3(0.5f));
  plain::add_box(scene, {-2, 0, -3}, {2, 2.75f, 3}, wall);
  return scene;
}

std::size_t vertex(int i, int j) { return std::size_t(j) * (kCells + 1) + i; }

void expect_mirrored_border(const ProbeGeometry& map) {
  const int n = map.n;
  for (int k = 0; k <= n; ++k) {
    for (int side : {0, n}) {
      EXPECT_EQ(map.w[vertex(side, k)], map.w[vertex(side, n - k)]);
      EXPECT_EQ(map.w[vertex(k, side)], map.w[vertex(n - k, side)]);
      EXPECT_EQ(map.normals[vertex(side, k)], map.normals[vertex(side, n - k)]);
      EXPECT_EQ(map.normals[vertex(k, side)], map.normals[vertex(n - k, side)]);
    }
  }
  const auto mirrored = [](int value) { return value == kConnected ? int(kConnected) : 65 - value; };
  for (int k = 0; k < n; ++k) {
    for (int side : {0, n}) {
      EXPECT_EQ(int(map.edges_horizontal[std::size_t(side) * n + k]),
                mirrored(map.edges_horizontal[std::size_t(side) * n + n - 1 - k]));
      EXPECT_EQ(int(map.edges_vertical[std::size_t(k) * (n + 1) + side]),
                mirrored(map.edges_vertical[std::size_t(n - 1 - k) * (n + 1) + side]));
    }
  }
}

bool all_connected(const std::vector<std::uint8_t>& edges) {
  return std::all_of(edges.begin(), edges.end(), [](std::uint8_t e) { return e == kConnected; });
}

TEST(BakeGeometry, MatchesThePlanesOfAnEmptyRoomExactly) {
  const Scene scene = room();
  const RayScene rays(scene);
  std::uint64_t cast = 0;
  const ProbeGeometry map = bake_geometry(rays, kProbe, kCells, &cast);
  ASSERT_EQ(map.w.size(), std::size_t(kCells + 1) * (kCells + 1));
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const glm::dvec3 q = octahedral_point(2.0 * i / kCells - 1.0, 2.0 * j / kCells - 1.0);
      double w = 0.0;  // the nearest wall wins: the largest 1 / L1 distance
      for (int axis = 0; axis < 3; ++axis) {
        for (double wall : {scene.bounds.lower_m[axis], scene.bounds.upper_m[axis]}) w = std::max(w, q[axis] / (wall - kProbe[axis]));
      }
      ASSERT_NEAR(map.w[vertex(i, j)] / w, 1.0, 2e-7) << i << ", " << j;
    }
  }
  EXPECT_TRUE(all_connected(map.edges_horizontal));
  EXPECT_TRUE(all_connected(map.edges_vertical));
  EXPECT_TRUE(all_connected(map.edges_diagonal));
  EXPECT_TRUE(std::all_of(map.normals.begin(), map.normals.end(), [](std::uint16_t v) { return v == 0; }));
  EXPECT_GT(cast, map.w.size() - 4 * kCells);
  expect_mirrored_border(map);
}

// A sheet that hides part of the floor: its outline must be cut where it is.
TEST(BakeGeometry, CutsAnOutlineAtItsFraction) {
  Scene scene = room();
  plain::add_quad(scene, {-0.4f, 1.0f, -1.1f}, {-0.4f, 1.0f, 0.3f}, {1.0f, 1.0f, 0.3f}, {1.0f, 1.0f, -1.1f}, 0);
  const RayScene rays(scene);
  const ProbeGeometry map = bake_geometry(rays, kProbe, kCells);
  expect_mirrored_border(map);
  // Octant x > 0, y < 0, z > 0 around the sheet's corner edge x = 1: along a horizontal edge only u changes.
  int checked = 0;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const std::uint8_t value = map.edges_horizontal[std::size_t(j) * kCells + i];
      if (value == kConnected) continue;
      const glm::dvec3 a = octahedral_point(2.0 * i / kCells - 1.0, 2.0 * j / kCells - 1.0);
      const glm::dvec3 b = octahedral_point(2.0 * (i + 1) / kCells - 1.0, 2.0 * j / kCells - 1.0);
      // The outline is the sheet's border: just before and just after the cut the ray passes it on different sides.
      const auto in_sheet = [&](double f) {
        const glm::dvec3 q = glm::mix(a, b, f);
        if (q.y >= 0.0) return false;
        const glm::dvec3 p = kProbe + q * ((1.0 - kProbe.y) / q.y);
        return p.x > -0.4 && p.x < 1.0 && p.z > -1.1 && p.z < 0.3;
      };
      const double fraction = (value - 0.5) / kCutSteps;
      EXPECT_NE(in_sheet(fraction - 0.51 / kCutSteps), in_sheet(fraction + 0.51 / kCutSteps)) << i << ", " << j;
      ++checked;
      EXPECT_TRUE(map.normals[vertex(i, j)] != 0 && map.normals[vertex(i + 1, j)] != 0);
    }
  }
  EXPECT_GT(checked, 20);
}

TEST(BakeGeometry, CutsBetweenSkyAndSurfaceButNotInTheSky) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.5f));
  plain::add_quad(scene, {-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, 0);
  const RayScene rays(scene);
  const ProbeGeometry map = bake_geometry(rays, {0.1, 1.0, 0.2}, kCells);
  int cuts = 0, sky = 0;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const bool a = map.w[vertex(i, j)] > 0.0f, b = map.w[vertex(i + 1, j)] > 0.0f;
      const bool cut = map.edges_horizontal[std::size_t(j) * kCells + i] != kConnected;
      EXPECT_EQ(cut, a != b);
      cuts += cut;
      sky += !a;
    }
  }
  EXPECT_GT(cuts, 10);
  EXPECT_GT(sky, 1000);
  expect_mirrored_border(map);
}

TEST(BakeGeometry, StaysFiniteOnASurface) {
  const Scene scene = room();
  const RayScene rays(scene);
  const ProbeGeometry map = bake_geometry(rays, {0.0, 0.0, 0.0}, kCells);
  for (float w : map.w) {
    ASSERT_TRUE(std::isfinite(w));
    ASSERT_LE(w, 1e4f);
  }
}

}  // namespace
}  // namespace probewalk
