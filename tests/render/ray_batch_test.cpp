// The tracer compiled as GLSL against the same text compiled as C++ float, ray by ray.
#include "render/ray_batch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <optional>

#include "content/probe/tracer_f32.h"
#include "gpu_test.h"
#include "probe_room.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

class RayBatchTest : public test::GpuTest {
 protected:
  RayBatchTest() {
    store.upload(room.upload());
    store.settle();
  }
  std::vector<WorldRay> random_rays(int count) const {
    test::Random random(5);
    std::vector<WorldRay> rays;
    for (int k = 0; k < count; ++k) {
      const glm::dvec3 origin(random(-2.8, 2.8), random(0.2, 2.4), random(-2.3, 2.3));
      rays.push_back({origin, random.direction() * random(0.5, 2.0)});
    }
    return rays;
  }
  const test::ProbeRoom room;
  ProbeStore store{device, room.grid, room.probe_count()};
  const TraceConstants dials = default_dials(test::kRadianceScale);
};

TEST_F(RayBatchTest, AnswersAsTheSameTextInCpp) {
  constexpr float kSpread_rad = 0.01f;
  const auto rays = random_rays(20000);
  const auto answers = RayBatch(device).trace(store, dials, rays, kSpread_rad);
  ASSERT_EQ(answers.size(), rays.size());
  const ProbeSet set = room.on_cpu();
  int other_class = 0, other_t = 0, other_radiance = 0, hits = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    glm::vec3 hi, lo;
    split_position(rays[k].origin_m, hi, lo);
    const glm::vec3 d(glm::normalize(rays[k].direction));
    const f32::RayAnswer expected = f32::trace_ray(set.grid(), dials, hi, lo, d, kStartLevel);
    unsigned reads = 0;
    const glm::vec3 radiance = f32::ray_radiance(set.grid(), dials, expected, hi, lo, d, kSpread_rad, reads);
    other_class += expected.cls != answers[k].answer;
    other_t += expected.t != answers[k].t_m || expected.lookups != answers[k].lookups ||
               expected.probe != answers[k].probe || expected.tries != answers[k].tries;
    // log2 of the footprint is the one operation that devices need not round alike.
    other_radiance += glm::length(radiance - answers[k].radiance) > 1e-3f * glm::length(radiance);
    hits += expected.cls == kClassHit;
  }
  EXPECT_EQ(other_class, 0);
  EXPECT_EQ(other_t, 0);
  EXPECT_EQ(other_radiance, 0);
  EXPECT_GT(hits, 15000);
}

// Samples in tiles, floats and both resident at once give the same answers to the bit, on the device and on the host.
TEST_F(RayBatchTest, AnswersAlikeHoweverSamplesLie) {
  constexpr float kSpread_rad = 0.01f;
  using enum DeviceSamples;
  const auto rays = random_rays(20000);
  const auto ask = [&](const test::ProbeRoom& of, std::optional<std::uint32_t> split, DeviceSamples pipeline) {
    ProbeStore holder(device, of.grid, of.probe_count());
    if (split) {  // two rooms
      holder.upload({0, 0, 0, {of.probes.begin(), of.probes.begin() + *split}});
      holder.upload({1, 0, *split, {of.probes.begin() + *split, of.probes.end()}});
    } else {
      holder.upload(of.upload());
    }
    holder.settle();
    EXPECT_EQ(holder.device_bytes(), ProbeStore::bytes_of(of.probes));
    TracerSetup setup;
    setup.choice.samples = pipeline;
    return std::pair(RayBatch(device, setup).trace(holder, dials, rays, kSpread_rad), holder.device_bytes());
  };
  const test::ProbeRoom floats(256, 32), tiled(256, 32, {kTiledAlways}), both(256, 32, {kTiledAlways, kFloat});
  for (const DeviceProbe& probe : tiled.probes) ASSERT_NE(probe.record.flags & kFlagTiledSamples, 0u);
  const auto [expected, bytes_floats] = ask(floats, {}, kFloat);
  const auto expect_same = [&](const std::vector<BatchAnswer>& answers, const char* what) {
    ASSERT_EQ(answers.size(), expected.size());
    EXPECT_EQ(std::memcmp(answers.data(), expected.data(), expected.size() * sizeof(BatchAnswer)), 0) << what;
  };
  const auto [of_tiles, bytes_tiles] = ask(tiled, {}, kTiled);
  expect_same(of_tiles, "tiles");
  EXPECT_LT(bytes_tiles, bytes_floats);
  const auto [of_both, bytes_both] = ask(both, 3, kTiled);
  expect_same(of_both, "both");
  EXPECT_LT(bytes_tiles, bytes_both);
  EXPECT_LT(bytes_both, bytes_floats);
  expect_same(ask(floats, {}, kTiled).first, "floats by a pipeline that can read tiles");
  const ProbeSet set = tiled.on_cpu(), plain = floats.on_cpu();
  for (std::size_t k = 0; k < rays.size(); ++k) {
    glm::vec3 hi, lo;
    split_position(rays[k].origin_m, hi, lo);
    const glm::vec3 d(glm::normalize(rays[k].direction));
    const f32::RayAnswer host = f32::trace_ray(set.grid(), dials, hi, lo, d, kStartLevel);
    ASSERT_TRUE(host.cls == expected[k].answer && host.t == expected[k].t_m && host.lookups == expected[k].lookups)
        << k;
    const f32::RayAnswer other = f32::trace_ray(plain.grid(), dials, hi, lo, d, kStartLevel);
    ASSERT_TRUE(host.t == other.t && host.plane == other.plane) << k;
  }
}

TEST_F(RayBatchTest, SplitsLongListsAndKeepsTheirOrder) {
  auto rays = random_rays(1000);
  const auto once = RayBatch(device).trace(store, dials, rays, 0.01f);
  rays.insert(rays.begin(), (1u << 20) - 500, WorldRay{{0.0, 1.4, 0.0}, {0.0, 1.0, 0.0}});
  const auto split = RayBatch(device).trace(store, dials, rays, 0.01f);
  ASSERT_EQ(split.size(), rays.size());
  for (std::size_t k = 0; k < once.size(); ++k) ASSERT_EQ(split[rays.size() - once.size() + k].t_m, once[k].t_m);
}

TEST_F(RayBatchTest, AnswersNothingWithNothing) {
  EXPECT_TRUE(RayBatch(device).trace(store, dials, {}, 0.01f).empty());
}

}  // namespace
}  // namespace probewalk
