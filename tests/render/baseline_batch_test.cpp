// Every method compiled as GLSL against the same text compiled as C++ float, ray by ray, and the selection of probes.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "content/baseline/host_tracer.h"
#include "gpu_test.h"
#include "probe_room.h"
#include "render/baseline_store.h"
#include "render/ray_batch.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

constexpr float kSpread_rad = 0.01f;

class BaselineBatchTest : public test::GpuTest {
 protected:
  BaselineBatchTest() {
    store.upload(room.upload());
    store.settle();
    const RayScene rays(room.scene);
    std::vector<glm::dvec3> positions_m;
    for (int k = 0; k < 8; ++k) {
      positions_m.push_back(room.grid.origin_m + room.grid.spacing_m * glm::dvec3(k & 1, k >> 1 & 1, k >> 2));
    }
    SilentProgress progress;
    maps = make_baseline_maps(rays, positions_m, 64, progress);
  }

  std::vector<WorldRay> rays_through_the_room(int count) const {
    std::vector<WorldRay> rays;
    for (int k = 0; k < count; ++k) {
      const auto at = [&](std::uint32_t stride) { return test::radical_inverse(static_cast<std::uint32_t>(k) * stride + 1); };
      const glm::dvec3 origin(-2.8 + 5.6 * at(1), 0.2 + 2.2 * at(3), -2.3 + 4.6 * at(7));
      rays.push_back({origin, test::hammersley_direction(k, count) * (0.5 + at(5))});
    }
    return rays;
  }

  TracedRays on_device(const TracerChoice& choice, const std::vector<WorldRay>& rays) const {
    TracerSetup setup{choice, nullptr};
    std::unique_ptr<BaselineStore> baselines;
    if (choice.needs_maps()) {
      baselines = std::make_unique<BaselineStore>(device, maps, choice);
      setup.baselines = baselines.get();
    }
    return RayBatch(device, setup).trace_timed(store, dials, rays, kSpread_rad);
  }

  void expect_device_is_host(const TracerChoice& choice, const std::vector<WorldRay>& rays) const {
    const std::string name = std::string(name_of(choice)) + ", " + describe(choice);
    const ProbeSet set = room.on_cpu();
    const HostTracer host(set, dials, choice, &maps);
    const TracedRays traced = on_device(choice, rays);
    ASSERT_EQ(traced.answers.size(), rays.size());
    EXPECT_GT(traced.device_ns, 0) << name;
    int other = 0, other_radiance = 0, hits = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const BatchAnswer expected = host.trace(rays[k].origin_m, rays[k].direction, kSpread_rad);
      const BatchAnswer& actual = traced.answers[k];
      other += expected.answer != actual.answer || expected.t_m != actual.t_m || expected.probe != actual.probe ||
               expected.lookups != actual.lookups || expected.tries != actual.tries;
      other_radiance += glm::length(expected.radiance - actual.radiance) > 1e-3f * glm::length(expected.radiance);
      hits += expected.answer == kClassHit;
    }
    EXPECT_EQ(other, 0) << name;
    EXPECT_EQ(other_radiance, 0) << name;
    EXPECT_GT(hits, static_cast<int>(rays.size() / 2)) << name;
  }

  const test::ProbeRoom room;
  ProbeStore store{device, room.grid, room.probe_count()};
  const TraceConstants dials = default_dials(test::kRadianceScale);
  BaselineMaps maps;
};

TEST_F(BaselineBatchTest, EveryMethodAnswersAsTheSameTextInCpp) {
  const auto rays = rays_through_the_room(6000);
  for (const MethodInfo& method : methods()) expect_device_is_host(choice_of(method.name), rays);
  expect_device_is_host(choice_of("restart"), rays);
}

TEST_F(BaselineBatchTest, EveryRuleOfThicknessAnswersAsTheSameTextInCpp) {
  const auto rays = rays_through_the_room(3000);
  const auto expect = [&](std::string_view method, int rule, bool backward) {
    TracerChoice choice = choice_of(method);
    choice.epsilon_rule = rule;
    choice.baseline.epsilon_m = 2.0f;
    choice.baseline.epsilon_growth = 1.5f;
    choice.reject_backfaces = true;
    choice.backward_trace = backward;
    expect_device_is_host(choice, rays);
  };
  expect("march-3d", kEpsilonDynamic, false);
  expect("march-2d-hierarchical", kEpsilonAngle, true);
  expect("two-level", kEpsilonDynamic, true);
}

// Each rule's every value once; a pipeline takes seconds to make on a software device.
TEST_F(BaselineBatchTest, EveryRuleOfSelectionAnswersAsTheSameTextInCpp) {
  const auto rays = rays_through_the_room(2000);
  for (const int first : {kFirstNearest, kFirstSigned, kFirstUnsigned, kFirstSignedLessDistance}) {
    TracerChoice choice;
    choice.rules.first = first;
    choice.rules.order = first % 3;
    choice.rules.advance = first == kFirstSigned ? 0 : 1;
    choice.rules.retry = first == kFirstUnsigned ? 0 : 1;
    choice.rules.start_test = first == kFirstNearest ? 0 : 1;
    choice.rules.hand_on = first == kFirstUnsigned ? 0 : 1;
    choice.rules.last_resort = (first + 1) % 3;
    choice.max_tries = 3 + first;
    if (first == kFirstSignedLessDistance) choice.distance_weight = 0.5f;
    expect_device_is_host(choice, rays);
  }
}

TEST_F(BaselineBatchTest, TheDefaultIsTheProduct) {
  const auto rays = rays_through_the_room(3000);
  const auto plain = RayBatch(device).trace(store, dials, rays, kSpread_rad);
  const auto named = on_device(choice_of("oat"), rays).answers;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    ASSERT_EQ(plain[k].t_m, named[k].t_m);
    ASSERT_EQ(plain[k].radiance, named[k].radiance);
  }
}

TEST_F(BaselineBatchTest, OnlyTheMapsThatAMethodReadsAreResident) {
  const std::uint64_t texels = 8 * 64 * 64;
  const auto bytes = [&](const TracerChoice& choice) { return BaselineStore(device, maps, choice).device_bytes(); };
  const std::uint64_t distance_alone = bytes(choice_of("march-2d"));
  EXPECT_GE(distance_alone, 4 * texels);
  EXPECT_LT(distance_alone, 4 * texels + 4096);
  EXPECT_EQ(bytes(choice_of("box-proxy")), distance_alone);
  EXPECT_NEAR(static_cast<double>(bytes(choice_of("two-level"))), static_cast<double>(distance_alone) + 4.0 / 3.0 * static_cast<double>(texels), 64.0);
  TracerChoice rejecting = choice_of("march-2d");
  rejecting.reject_backfaces = true;
  EXPECT_EQ(bytes(rejecting), distance_alone + 4 * texels);
}

TEST_F(BaselineBatchTest, MapsThatAreMissingAreAnError) {
  EXPECT_THROW(RayBatch(device, {choice_of("two-level"), nullptr}), std::logic_error);
  EXPECT_NO_THROW(RayBatch(device, {choice_of("environment"), nullptr}));
}

}  // namespace
}  // namespace probewalk
