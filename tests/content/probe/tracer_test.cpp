// The tracer on bits that no baker would write, and whole answers, hand-offs included, against the triangles. The hard
// cases of single walks are in tests/hard_cases.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "content/bake/bake_probe.h"
#include "content/probe/device_probe.h"
#include "content/probe/probe_set.h"
#include "content/probe/tracer_f32.h"
#include "content/probe/tracer_f64.h"
#include "content/scene/ray_scene.h"
#include "support/low_discrepancy.h"
#include "support/test_scenes.h"

namespace probewalk {
namespace {

TEST(Tracer, EndsWithFiniteNumbersOnAnyBits) {
  test::Random random(3);
  for (int round = 0; round < 40; ++round) {
    ProbeMap map;
    map.geometry.n = 16;
    constexpr int n = 16;
    const auto byte = [&] { return static_cast<std::uint8_t>(random(0, 66)); };
    for (int k = 0; k < (n + 1) * (n + 1); ++k) {
      const double pick = random();
      map.geometry.w.push_back(pick < 0.2 ? 0.0f : static_cast<float>(std::exp2(random(-40, 20))));
      map.geometry.normals.push_back(static_cast<std::uint16_t>(random(0, 65536)));
    }
    for (int k = 0; k < n * (n + 1); ++k) {
      map.geometry.edges_horizontal.push_back(static_cast<std::uint8_t>(byte() % 65));
      map.geometry.edges_vertical.push_back(static_cast<std::uint8_t>(byte() % 65));
    }
    for (int k = 0; k < n * n; ++k) map.geometry.edges_diagonal.push_back(static_cast<std::uint8_t>(byte() % 65));
    DeviceProbe device = build_device_probe(map);
    if (round % 2 == 1) {
      // Worse than any map: samples and pyramid of arbitrary bits, NaN and infinity among them.
      const int words = f32::pyramid_begin(n, false) + f32::pyramid_words(4);
      for (std::size_t k = 0; k < static_cast<std::size_t>(words); ++k) device.geometry[k] = static_cast<std::uint32_t>(random(0, 4294967296.0));
    }
    const ProbeRecord record = record_in_memory(device);
    for (int k = 0; k < 2000; ++k) {
      const glm::vec3 x(static_cast<float>(random(-5, 5)), static_cast<float>(random(-5, 5)), static_cast<float>(random(-5, 5)));
      const f32::WalkState s = f32::walk_probe(record, x, glm::vec3(random.direction()), 0.0f, kStartLevel);
      ASSERT_LT(s.lookups, 4u * 200u);
      if (round % 2 == 0) {
        ASSERT_TRUE(std::isfinite(s.t) && std::isfinite(s.t_safe));
      }
    }
  }
}

// All probes of a room's grid, the way the renderer has them.
ProbeSet room_set(const RayScene& rays, int n) {
  ProbeGrid grid;
  grid.origin_m = {-2, 0.6, -1.6};
  grid.spacing_m = {2, 1.3, 1.6};
  grid.dims = {3, 2, 3};
  std::vector<DeviceProbe> probes;
  for (int z = 0; z < 3; ++z) {
    for (int y = 0; y < 2; ++y) {
      for (int x = 0; x < 3; ++x) {
        grid.probe.push_back(static_cast<std::uint32_t>(probes.size()));
        ProbeMap map{bake_geometry(rays, grid.origin_m + grid.spacing_m * glm::dvec3(x, y, z), n), {}};
        map.radiance.r = 8;
        map.radiance.rgb9e5.assign(mip_chain_texels(8), encode_rgb9e5({1, 2, 3}));
        map.radiance.texel_w.assign(64, 0);
        probes.push_back(build_device_probe(map));
      }
    }
  }
  return ProbeSet(std::move(probes), grid);
}

// Between the sky and a sample a million kilometres away a piece runs off to any distance: beyond what a float can
// square, and the light there must still come from the map.
TEST(TraceRay, AHitBeyondWhatFloatsCanSquareHasLightOfTheMap) {
  constexpr int n = 16;
  ProbeMap map;
  map.geometry.n = n;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) map.geometry.w.push_back((i + j) % 2 == 0 ? 1e-9f : 0.0f);
  }
  map.geometry.normals.assign(map.geometry.w.size(), 0);
  map.geometry.edges_horizontal.assign(n * (n + 1), kConnected);
  map.geometry.edges_vertical.assign(n * (n + 1), kConnected);
  map.geometry.edges_diagonal.assign(n * n, kConnected);
  map.radiance.r = 8;
  map.radiance.rgb9e5.assign(mip_chain_texels(8), encode_rgb9e5({1, 2, 3}));
  map.radiance.texel_w.assign(64, encode_texel_w(1e-9f));
  std::vector<DeviceProbe> probes{build_device_probe(map)};
  ProbeGrid grid;
  grid.probe = {0};
  const ProbeSet set(std::move(probes), grid);
  const TraceConstants dials = default_dials(1.0);
  test::Random random(4);
  int beyond = 0;
  for (int k = 0; k < 200000; ++k) {
    // Almost at a line of the map where w is zero: towards a vertex, a hair beside it.
    const int i = static_cast<int>(random(0, n + 1)), j = static_cast<int>(random(0, n + 1));
    const double hair = std::exp2(random(-40, -10));
    const glm::vec3 d(glm::normalize(octahedral_point(2.0 * i / n - 1 + hair * random(-1, 1), 2.0 * j / n - 1 + hair * random(-1, 1))));
    const glm::vec3 o(random.direction() * random(0, 2));
    const f32::RayAnswer answer = f32::trace_ray(set.grid(), dials, o, glm::vec3(0), d, kStartLevel);
    const bool is_beyond = answer.cls == kClassHit && answer.t > 2e19f;
    beyond += is_beyond;
    unsigned reads = 0;
    const glm::vec3 light = f32::ray_radiance(set.grid(), dials, answer, o, glm::vec3(0), d, 1e-3f, reads);
    ASSERT_TRUE(light.x > 0.99f && light.x < 1.01f && light.z > 2.97f && light.z < 3.03f) << answer.t << " " << light.x;
    if (is_beyond) {
      ASSERT_GE(reads, 8u) << "no mip but the finest is asked for the surface: the mip was no number";
    }
  }
  EXPECT_GT(beyond, 0);
}

TEST(TraceRay, FindsWhatTheTrianglesSay) {
  const Scene scene = test::furnished_room();
  const RayScene rays(scene);
  const ProbeSet set = room_set(rays, 256);
  const TraceConstants dials = default_dials(1.0);
  test::Random random(5);
  constexpr int kRays = 60000;
  int wrong = 0, unknown = 0, double_differs = 0;
  std::vector<double> errors;
  for (int k = 0; k < kRays; ++k) {
    const glm::dvec3 o(random(-2.8, 2.8), random(0.9, 2.2), random(-2.3, 2.3));
    if (o.x < -1.5 && o.x > -2.1 && o.z < -1.3 && o.z > -1.9) continue;  // inside the pillar
    const glm::vec3 d(random.direction());
    const f32::RayAnswer a = f32::trace_ray(set.grid(), dials, glm::vec3(o), glm::vec3(0), d, kStartLevel);
    const f64::RayAnswer b = f64::trace_ray(set.grid(), dials, glm::dvec3(glm::vec3(o)), glm::dvec3(0), glm::dvec3(d), kStartLevel);
    double_differs += a.cls != b.cls || (a.cls == kClassHit && std::abs(a.t - b.t) > 1e-3 * b.t);
    const SurfaceHit truth = rays.closest(glm::vec3(o), d);
    if (a.cls == kClassUnknown) {
      ++unknown;
    } else if ((a.cls == kClassHit) != truth.hit || (truth.hit && std::abs(a.t - truth.t) > 0.02f * truth.t)) {
      ++wrong;
    } else if (truth.hit) {
      errors.push_back(std::abs(a.t - truth.t) / truth.t);
    }
  }
  std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2), errors.end());
  std::printf("wrong %.2f %%, unknown %.2f %%, median error %.2g, float against double differ in %d of %d\n", 100.0 * wrong / kRays,
              100.0 * unknown / kRays, errors[errors.size() / 2], double_differs, kRays);
  EXPECT_LT(wrong, kRays / 50);
  EXPECT_LT(unknown, kRays / 50);
  EXPECT_LT(errors[errors.size() / 2], 1e-6);
  EXPECT_LT(double_differs, kRays / 2000);
}

TEST(TraceRay, KeepsItsPrecisionFarFromTheOrigin) {
  // The same room a hundred kilometres out: the answers must not know.
  const Scene scene = test::furnished_room();
  const RayScene rays(scene);
  const ProbeSet near_set = room_set(rays, 64);
  const glm::dvec3 offset(1e5, -3e4, 7e4);
  ProbeGrid grid;
  grid.origin_m = glm::dvec3(-2, 0.6, -1.6) + offset;
  grid.spacing_m = {2, 1.3, 1.6};
  grid.dims = {3, 2, 3};
  std::vector<DeviceProbe> moved = near_set.probes();
  for (std::size_t k = 0; k < moved.size(); ++k) {
    grid.probe.push_back(static_cast<std::uint32_t>(k));
    const glm::dvec3 at = glm::dvec3(moved[k].record.position_hi_m) + glm::dvec3(moved[k].record.position_lo_m) + offset;
    split_position(at, moved[k].record.position_hi_m, moved[k].record.position_lo_m);
  }
  const ProbeSet far_set(std::move(moved), grid);
  const TraceConstants dials = default_dials(1.0);
  test::Random random(9);
  int differs = 0;
  for (int k = 0; k < 20000; ++k) {
    const glm::dvec3 o(random(-2.5, 2.5), random(1, 2), random(-2, 2));
    const glm::vec3 d(random.direction());
    glm::vec3 hi, lo;
    split_position(o, hi, lo);
    const f32::RayAnswer a = f32::trace_ray(near_set.grid(), dials, hi, lo, d, kStartLevel);
    split_position(o + offset, hi, lo);
    const f32::RayAnswer b = f32::trace_ray(far_set.grid(), dials, hi, lo, d, kStartLevel);
    // Another first probe may be chosen (the grid cell is found in float), so compare what two probes agree on.
    differs += a.probe == b.probe && (a.cls != b.cls || (a.cls == kClassHit && std::abs(a.t - b.t) > 1e-4f * a.t));
  }
  EXPECT_LE(differs, 4);
}

TEST(TraceRay, ClampsAViewerOutsideTheGridAndAnswersWithoutProbes) {
  const Scene scene = test::furnished_room();
  const RayScene rays(scene);
  const ProbeSet set = room_set(rays, 32);
  const TraceConstants dials = default_dials(1.0);
  const f32::RayAnswer outside = f32::trace_ray(set.grid(), dials, glm::vec3(500, 3, -900), glm::vec3(0), glm::vec3(0, 1, 0), kStartLevel);
  EXPECT_GE(outside.probe, 0);
  GridConstants empty = set.grid();
  std::vector<ProbeRecord> none(set.records().size());
  const auto bits = reinterpret_cast<std::uintptr_t>(none.data());
  empty.probes_address = {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(static_cast<std::uint64_t>(bits) >> 32)};
  const f32::RayAnswer nobody = f32::trace_ray(empty, dials, glm::vec3(0, 1, 0), glm::vec3(0), glm::vec3(0, 0, 1), kStartLevel);
  EXPECT_EQ(nobody.cls, kClassUnknown);
  EXPECT_EQ(nobody.probe, -1);
  unsigned reads = 0;
  EXPECT_EQ(f32::ray_radiance(empty, dials, nobody, glm::vec3(0, 1, 0), glm::vec3(0), glm::vec3(0, 0, 1), 0.01f, reads), glm::vec3(0));
}

}  // namespace
}  // namespace probewalk
