// The marches of the baselines step by step: which texels they read, and that they end on anything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "content/baseline/analytic_map.h"
#include "content/baseline/march_rays.h"

namespace probewalk {
namespace {

using namespace test;

int texel_of(int n, glm::dvec3 p, glm::dvec2* place = nullptr) {
  p /= std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
  glm::dvec2 uv(p.x, p.y);
  if (p.z < 0) uv = {(1 - std::abs(p.y)) * (p.x < 0 ? -1 : 1), (1 - std::abs(p.x)) * (p.y < 0 ? -1 : 1)};
  uv = (uv + 1.0) * (n * 0.5);
  if (place != nullptr) *place = uv;
  return std::clamp(static_cast<int>(uv.y), 0, n - 1) * n + std::clamp(static_cast<int>(uv.x), 0, n - 1);
}

TEST(March, ReadsExactlyTheTexelsThatTheRayCrosses) {
  const AnalyticMap map(test::open_sky(), glm::dvec3(0), 5);
  const int n = map.size();
  const march64::MarchRules rules{kEpsilonFixed, false, false, 0.05, 0.01, 1e6, 100000};
  test::Random random(5);
  for (int k = 0; k < 200; ++k) {
    const glm::dvec3 x = random.direction() * random(0.05, 2), d = random.direction();
    std::vector<test::ReadWord> reads;
    test::noted_reads = &reads;
    march64::march_2d(map.record(), rules, x, d, 0, false);
    test::noted_reads = nullptr;
    std::vector<int> visited;
    for (const test::ReadWord& read : reads) {
      if (map.is_distance(read.address) && (visited.empty() || visited.back() != read.index))
        visited.push_back(read.index);
    }
    // The ray by small, equal angles as the probe sees it: every texel that a sample falls into, in order.
    const double closest_t = -glm::dot(x, d), passes = glm::length(x + d * closest_t);
    const double first = std::atan2(-closest_t, passes), last = std::atan2(1e6 - closest_t, passes);
    std::vector<int> sampled;
    std::vector<glm::dvec2> places;
    constexpr int kSamples = 40000;
    for (int i = 0; i <= kSamples; ++i) {
      const double t = closest_t + passes * std::tan(first + (last - first) * i / kSamples);
      glm::dvec2 place;
      const int texel = texel_of(n, x + d * t, &place);
      places.push_back(place);
      if (sampled.empty() || sampled.back() != texel) sampled.push_back(texel);
    }
    std::size_t at = 0;
    for (const int texel : visited) at += at < sampled.size() && sampled[at] == texel ? 1 : 0;
    ASSERT_EQ(at, sampled.size()) << "ray " << k << ": a crossed texel was not read, or not in order";
    const std::set<int> seen(sampled.begin(), sampled.end());
    for (const int texel : visited) {
      if (seen.contains(texel)) continue;
      // Between two samples at most: a corner that the ray cuts.
      const glm::dvec2 low(texel % n, texel / n);
      double nearest = 1e9;
      for (const glm::dvec2 place : places)
        nearest = std::min(nearest, glm::length(glm::max(glm::max(low - place, place - low - 1.0), glm::dvec2(0))));
      ASSERT_LT(nearest, 3e-3) << "ray " << k << ": texel " << texel << " was read and is not crossed";
    }
  }
}

TEST(March, SkippingNodesChangesNothing) {
  struct NamedMap {
    std::string name;
    AnalyticMap map;
  };
  const glm::dvec3 probe(0.4, 0.1, -0.3);
  std::vector<test::AnalyticScene> grille{test::box_room(kLow, kHigh)};
  for (int k = -7; k <= 7; ++k) grille.push_back(test::pole(1.2, 0.25 * k, 0.03));
  const std::vector<NamedMap> maps{{"room", {test::box_room(kLow, kHigh), probe, 8}},
                                   {"grille", {test::nearest_of(grille), probe, 8}},
                                   {"ball in the sky", {test::sphere({2, 1, 0}, 0.9), probe, 6}},
                                   {"small", {test::box_room(kLow, kHigh), probe, 2}}};
  for (const NamedMap& named : maps) {
    const BaselineRecord map = named.map.record();
    test::Random random(6);
    std::uint64_t flat_lookups = 0, node_lookups = 0, leap_lookups = 0;
    for (int k = 0; k < 20000; ++k) {
      const Ray ray = room_ray(random, probe);
      MarchRules rules = plain_rules();
      rules.epsilon_rule = k % 3;
      if (rules.epsilon_rule != kEpsilonFixed) rules.epsilon_m = 2;
      rules.reject_backfaces = k % 2 == 1;
      const float t_start = k % 5 == 0 ? static_cast<float>(random(0, 2)) : 0.0f;
      const WalkState plain = flat(map, rules, ray, t_start);
      const WalkState nodes = hierarchical(map, rules, ray, t_start), leaps = two_level(map, rules, ray, t_start);
      for (const WalkState& other : {nodes, leaps}) {
        ASSERT_EQ(plain.status, other.status) << named.name << " ray " << k;
        ASSERT_EQ(plain.t, other.t) << named.name << " ray " << k;
        ASSERT_EQ(plain.plane, other.plane) << named.name << " ray " << k;
        if (plain.status == kClassUnknown) {
          ASSERT_EQ(plain.t_safe, other.t_safe) << named.name << " ray " << k;
        }
      }
      flat_lookups += plain.lookups;
      node_lookups += nodes.lookups;
      leap_lookups += leaps.lookups;
    }
    if (named.map.size() >= 256) {
      EXPECT_LT(node_lookups, flat_lookups / 2) << named.name;
      EXPECT_LT(leap_lookups, flat_lookups / 2) << named.name;
    }
  }
}

TEST(March, ARayParallelToItsDisplacementTakesOneLookUpAndIsExact) {
  // Thesis 4.3 and 9.1. Directions of texel centres, where the map holds the very distance.
  const auto scene = test::box_room(kLow, kHigh);
  const AnalyticMap map(scene, glm::dvec3(0), 6);
  test::Random random(7);
  for (int k = 0; k < 500; ++k) {
    const int texel = static_cast<int>(random(0, 64 * 64));
    const glm::dvec3 d =
        glm::normalize(test::map_direction((2 * (texel % 64) + 1) / 64.0 - 1, (2 * (texel / 64) + 1) / 64.0 - 1));
    const Ray ray{glm::vec3(d * random(0, 1.2)), glm::vec3(d)};
    const WalkState state = flat(map.record(), plain_rules(), ray);
    ASSERT_EQ(state.status, kClassHit) << k;
    ASSERT_EQ(state.lookups, 1u) << k;
    ASSERT_NEAR(state.t + glm::length(ray.x), map.distance(texel), 2e-6 * map.distance(texel)) << k;
    // By the angle the first point's answer is right, however far ahead it lies.
    MarchRules by_angle = plain_rules(1);
    by_angle.epsilon_rule = kEpsilonAngle;
    const WalkState points = steps(map.record(), by_angle, ray);
    ASSERT_EQ(points.status, kClassHit) << k;
    ASSERT_LE(points.lookups, 2u) << k;  // at the probe itself there is nothing to look up
    ASSERT_NEAR(points.t + glm::length(ray.x), map.distance(texel), 2e-6 * map.distance(texel)) << k;
  }
}

TEST(March, StepsInSpaceCostWhatTheRayIsLong) {
  const AnalyticMap map(test::open_sky(), glm::dvec3(0), 4);
  MarchRules rules = plain_rules();
  rules.step_m = 0.25f;
  rules.farthest_m = 10;
  const WalkState state = steps(map.record(), rules, {{1, 2, 3}, {0, 0, 1}});
  EXPECT_EQ(state.status, kClassMiss);
  EXPECT_EQ(state.lookups, 40u);
}

TEST(March, EndsAtTheFarthestAndAfterTheMostSteps) {
  const AnalyticMap map(test::box_room(kLow, kHigh), glm::dvec3(0), 8);
  const Ray ray{{-1, 0.1f, 0.2f}, {1, 0, 0}};
  for (const NamedMarch& method : marches()) {
    MarchRules rules = plain_rules();
    rules.farthest_m = 3.5f;
    const WalkState near_end = method.march(map.record(), rules, ray, 0);
    EXPECT_EQ(near_end.status, kClassMiss) << method.name;
    EXPECT_EQ(near_end.t_safe, 3.5f) << method.name;
    EXPECT_EQ(method.march(map.record(), rules, ray, 4).status, kClassMiss) << method.name;
    rules = plain_rules();
    rules.max_steps = 4;
    const WalkState stopped = method.march(map.record(), rules, ray, 0);
    EXPECT_EQ(stopped.status, kClassUnknown) << method.name;
    EXPECT_LE(stopped.lookups, 4u) << method.name;
    EXPECT_LT(stopped.t_safe, 4) << method.name;
    rules.max_steps = 0;
    EXPECT_EQ(method.march(map.record(), rules, ray, 1).status, kClassUnknown) << method.name;
  }
}

// Words that no baker writes.
float odd_distance(test::Random& random) {
  switch (static_cast<int>(random(0, 12))) {
    case 0:
      return 0;
    case 1:
      return 1e-40f;
    case 2:
      return std::numeric_limits<float>::infinity();
    case 3:
      return std::numeric_limits<float>::quiet_NaN();
    case 4:
      return -1;
    case 5:
      return kBaselineSky_m;
    default:
      return static_cast<float>(random(0, 4));
  }
}

TEST(March, EndsAndFormsNoNaNOnAnyRayAndAnyMap) {
  const AnalyticMap room(test::box_room(kLow, kHigh), glm::dvec3(0), 6);
  test::Random random(10);
  std::vector<float> odd(64 * 64), minimum(64 * 64);
  std::vector<pw_uint> normal(64 * 64);
  for (std::size_t k = 0; k < odd.size(); ++k) {
    odd[k] = odd_distance(random);
    minimum[k] = odd_distance(random);
    normal[k] = static_cast<pw_uint>(random(0, 4294967295.0));
  }
  BaselineRecord odd_map = room.record();
  const auto address = [](const void* data) {
    const auto place = reinterpret_cast<std::uintptr_t>(data);
    return pw_uvec2(static_cast<pw_uint>(place), static_cast<pw_uint>(static_cast<std::uint64_t>(place) >> 32));
  };
  odd_map.distance_address = address(odd.data());
  odd_map.minimum_address = address(minimum.data());
  odd_map.normal_address = address(normal.data());

  const std::vector<float> odd_numbers{0, -0.0f, 1e-45f, 1e-38f, -1e-30f, 1e-7f, 0.25f, 0.5f, 1, -1, 3, 1e4f, -1e6f};
  const auto pick = [&] {
    return odd_numbers[static_cast<std::size_t>(random(0, static_cast<double>(odd_numbers.size())))];
  };
  for (int k = 0; k < 60000; ++k) {
    Ray ray{{pick(), pick(), pick()}, glm::vec3(random.direction())};
    if (k % 2 == 0) ray.d = {pick(), pick(), pick()};
    if (k % 7 == 0) ray.d = glm::vec3(k % 3 == 0, k % 3 == 1, k % 3 == 2) * (k % 2 == 0 ? 1.0f : -1.0f);
    if (k % 11 == 0) ray.x = -ray.d * static_cast<float>(random(0, 3));  // through the probe
    if (k % 13 == 0) ray.x = ray.d * static_cast<float>(random(0, 3));   // away from it
    if (k % 17 == 0) ray.d = glm::vec3(1, k % 2 == 0 ? 1 : -1, 0);       // along a seam of the map
    if (k % 19 == 0) ray.x = glm::vec3(0);
    const double len = glm::length(glm::dvec3(ray.d));
    ray.d = len > 0 ? glm::vec3(glm::dvec3(ray.d) / len) : glm::vec3(0, 0, 1);
    MarchRules rules = plain_rules();
    rules.epsilon_rule = k % 3;
    rules.reject_backfaces = k % 4 == 1;
    rules.backward_trace = k % 8 == 1;
    rules.step_m = k % 29 == 0 ? 0.0f : 0.1f;
    rules.max_steps = 2000;
    if (k % 31 == 0) rules.farthest_m = 3e38f;
    const float t_start = k % 5 == 0 ? static_cast<float>(random(0, 100)) : 0.0f;
    for (const BaselineRecord& map : {room.record(), odd_map}) {
      for (const NamedMarch& method : marches()) {
        const WalkState state = method.march(map, rules, ray, t_start);
        ASSERT_TRUE(state.status == kClassHit || state.status == kClassMiss || state.status == kClassUnknown)
            << method.name;
        ASSERT_TRUE(std::isfinite(state.t) && std::isfinite(state.t_safe)) << method.name << " ray " << k;
        ASSERT_GE(state.t, t_start) << method.name << " ray " << k;
        ASSERT_GE(state.t_safe, t_start) << method.name << " ray " << k;
        if (method.name != "march-3d") {
          ASSERT_LT(state.lookups, 600u) << method.name << " ray " << k;
        }
        if (state.status == kClassHit) {
          ASSERT_TRUE(std::isfinite(state.plane.x) && std::isfinite(state.plane.y) && std::isfinite(state.plane.z))
              << method.name << " ray " << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace probewalk
