// The marches of the baselines against scenes that are formulas: what they answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "content/baseline/analytic_map.h"
#include "content/baseline/march_rays.h"

namespace probewalk {
namespace {

using namespace test;

// A texel's corner is seen at most 4.3 / n from its centre.
double texel_radius_rad(int n) {
  return 4.3 / n;
}

// Is the answer on the room's surface, within a texel and epsilon, and not behind the first surface by more than these?
// Before it, it may be by more along the ray: a wall that the ray grazes is thickened by epsilon.
void expect_on_surface(int n, const Ray& ray, const test::AnalyticHit& truth, glm::dvec3 probe, double t,
                       double epsilon_m) {
  const glm::dvec3 from_probe = glm::dvec3(ray.x) + t * glm::dvec3(ray.d), point = from_probe + probe;
  const glm::dvec3 inside = glm::min(glm::abs(point - kLow), glm::abs(kHigh - point));
  const double texel_m = 1.5 * texel_radius_rad(n) * glm::length(from_probe);
  EXPECT_LT(std::min({inside.x, inside.y, inside.z}), texel_m + epsilon_m);
  const double along = std::abs(glm::dot(truth.normal, glm::dvec3(ray.d)));
  EXPECT_LT(t - truth.t, texel_m / along + epsilon_m * (1 + 1 / along));
}

TEST(March, DistancesInARoomAreWithinATexel) {
  const auto scene = test::box_room(kLow, kHigh);
  const glm::dvec3 probe(0.4, 0.1, -0.3);
  const AnalyticMap map(scene, probe, 8);
  for (const NamedMarch& method : marches()) {
    test::Random random(1);
    int hits = 0, unknown = 0, rays = 4000;
    for (int k = 0; k < rays; ++k) {
      const Ray ray = room_ray(random, probe);
      const auto truth = scene(probe + glm::dvec3(ray.x), glm::dvec3(ray.d));
      const WalkState state = method.march(map.record(), plain_rules(), ray, 0);
      ASSERT_NE(state.status, kClassMiss) << method.name << " saw sky in a closed room, ray " << k;
      if (state.status != kClassHit) {
        ++unknown;
        expect_on_surface(map.size(), ray, *truth, probe, state.t_safe, 0.05);
      } else {
        ++hits;
        expect_on_surface(map.size(), ray, *truth, probe, state.t, 0.05);
      }
      ASSERT_FALSE(HasFailure()) << method.name << " ray " << k;
    }
    EXPECT_LT(unknown, rays / 20) << method.name;  // grazing: the next texel's distance jumps by more than epsilon
    EXPECT_GT(hits, rays * 9 / 10) << method.name;
  }
}

TEST(March, TheErrorFallsWithTheResolution) {
  const auto scene = test::box_room(kLow, kHigh);
  const glm::dvec3 probe(0.4, 0.1, -0.3);
  std::vector<double> median_m;
  for (const int n_log2 : {5, 6, 7, 8, 9}) {
    const AnalyticMap map(scene, probe, n_log2);
    test::Random random(2);
    std::vector<double> error_m;
    for (int k = 0; k < 2000; ++k) {
      const Ray ray = room_ray(random, probe);
      const WalkState state = hierarchical(map.record(), plain_rules(1.0f), ray);
      if (state.status != kClassHit) continue;
      error_m.push_back(
          std::abs(static_cast<double>(state.t) - scene(probe + glm::dvec3(ray.x), glm::dvec3(ray.d))->t));
    }
    std::nth_element(error_m.begin(), error_m.begin() + static_cast<long>(error_m.size() / 2), error_m.end());
    median_m.push_back(error_m[error_m.size() / 2]);
  }
  for (std::size_t k = 1; k < median_m.size(); ++k) EXPECT_LT(median_m[k], 0.65 * median_m[k - 1]);
}

// First t at which the probe (at the origin) sees something else than the ray's point.
double hidden_from(const test::AnalyticScene& scene, const Ray& ray, double end, double step_m = 1e-3) {
  for (double t = 0; t < end; t += step_m) {
    const glm::dvec3 z = glm::dvec3(ray.x) + t * glm::dvec3(ray.d);
    const auto seen = scene(glm::dvec3(0), glm::normalize(z));
    if (seen && seen->t < glm::length(z)) return t;
  }
  return end;
}

TEST(March, ABallUnderOpenSkyIsHitOrMissed) {
  const glm::dvec3 centre(4, 0.5, -1);
  const auto scene = test::sphere(centre, 1.5);
  const AnalyticMap map(scene, glm::dvec3(0), 8);
  test::Random random(3);
  int hits = 0, misses = 0, shadowed = 0;
  for (int k = 0; k < 3000; ++k) {
    // Towards the ball from around the probe, and past it. What passes close to the rim is the resolution's business.
    const glm::dvec3 from(random(-0.5, 0.5), random(-0.5, 0.5), random(-0.5, 0.5));
    const glm::dvec3 d = glm::normalize(centre + 3.0 * random.direction() * random() - from);
    const double passes = glm::length(glm::cross(centre - from, d));
    if (passes > 1.3 && passes < 1.9) continue;
    const Ray ray{glm::vec3(from), glm::vec3(d)};
    const auto truth = scene(from, d);
    const bool hidden = !truth && hidden_from(scene, ray, 60, 0.05) < 60;
    for (const NamedMarch& method : marches()) {
      const WalkState state = method.march(map.record(), plain_rules(0.2f), ray, 0);
      if (truth) {
        ASSERT_EQ(state.status, kClassHit) << method.name << " ray " << k;
        ASSERT_NEAR(state.t, truth->t, 0.1) << method.name << " ray " << k;
      } else if (hidden) {
        ASSERT_NE(state.status, kClassHit) << method.name << " ray " << k;
      } else {
        ASSERT_EQ(state.status, kClassMiss) << method.name << " ray " << k;
      }
    }
    ++(truth ? hits : hidden ? shadowed : misses);
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(misses, 300);
  EXPECT_GT(shadowed, 3);
}

TEST(March, BehindAWallsEdgeTheRayIsUnknownFromTheShadowOn) {
  // The probe looks through a hole of 2 m in the wall x = 2, at a second wall 4 m behind. Rays start behind the hole.
  const auto scene = test::nearest_of({test::wall(2, 1), test::wall(6, -1)});
  const AnalyticMap map(scene, glm::dvec3(0), 8);
  test::Random random(4);
  const double rules_step_m = plain_rules().step_m;
  int unknown = 0;
  for (int k = 0; k < 2000; ++k) {
    const glm::dvec3 from(2.5, random(-0.9, 0.9), random(-0.9, 0.9));
    const glm::dvec3 d = glm::normalize(glm::dvec3(random(0.1, 1), random(-1, 1), random(-1, 1)));
    const Ray ray{glm::vec3(from), glm::vec3(d)};
    const double hit_t = (6 - from.x) / d.x, hidden_t = hidden_from(scene, ray, hit_t);
    const glm::dvec3 end = from + d * hit_t;
    for (const NamedMarch& method : marches()) {
      const WalkState state = method.march(map.record(), plain_rules(0.05f), ray, 0);
      if (hidden_t < hit_t - 0.3) {
        // In the shadow of the first wall, which is at least half a metre nearer to the probe.
        ++unknown;
        ASSERT_EQ(state.status, kClassUnknown) << method.name << " ray " << k;
        // There the probe sees the hole's edge, at 1 m from the axis in the plane x = 2.
        const glm::dvec3 z = from + d * static_cast<double>(state.t_safe);
        const double tolerance_m = 1.5 * texel_radius_rad(map.size()) * 3.0 + rules_step_m;
        ASSERT_NEAR(2 / z.x * std::max(std::abs(z.y), std::abs(z.z)), 1, tolerance_m) << method.name << " ray " << k;
        ASSERT_LE(state.t_safe, state.t);
      } else if (hidden_t >= hit_t && std::max(std::abs(end.y), std::abs(end.z)) < 0.46 * end.x && d.x > 0.5) {
        ASSERT_EQ(state.status, kClassHit) << method.name << " ray " << k;
      }
    }
  }
  EXPECT_GT(unknown, 500);
}

TEST(March, ARayThatStartsBehindAWallIsUnknownAtOnce) {
  const AnalyticMap map(test::wall(2, -1), glm::dvec3(0), 7);
  const Ray ray{{3, 0.1f, 0.2f}, {1, 0, 0}};
  for (const NamedMarch& method : marches()) {
    const WalkState state = method.march(map.record(), plain_rules(), ray, 0.25f);
    EXPECT_EQ(state.status, kClassUnknown) << method.name;
    EXPECT_EQ(state.t_safe, 0.25f) << method.name;
    EXPECT_EQ(state.t, 0.25f) << method.name;
  }
}

TEST(March, AThinPoleIsHitFromItsLitSideAndUnknownBehind) {
  const auto scene = test::nearest_of({test::pole(2, 0, 0.05), test::box_room(kLow, kHigh)});
  const AnalyticMap map(scene, glm::dvec3(0), 9);
  const Ray towards{{0.3f, 0.2f, 0.4f}, glm::normalize(glm::vec3(1.65f, 0.1f, -0.4f))};
  // Passes 0.5 m behind the pole as the probe sees it, in front of the room's end.
  const Ray behind{{2.5f, 0.1f, -1}, {0, 0, 1}};
  for (const NamedMarch& method : marches()) {
    const WalkState hit = method.march(map.record(), plain_rules(0.03f), towards, 0);
    ASSERT_EQ(hit.status, kClassHit) << method.name;
    EXPECT_NEAR(hit.t, scene(glm::dvec3(towards.x), glm::dvec3(towards.d))->t, 0.03) << method.name;
    const WalkState unknown = method.march(map.record(), plain_rules(0.03f), behind, 0);
    ASSERT_EQ(unknown.status, kClassUnknown) << method.name;
    EXPECT_NEAR(unknown.t_safe, 1 - 0.05 * 2.5 / 2, 0.03) << method.name << ": where the pole's shadow begins";
    // A thickness of more than the gap makes a hit of it: that is what epsilon does (thesis 7.1).
    const WalkState thick = method.march(map.record(), plain_rules(0.6f), behind, 0);
    EXPECT_EQ(thick.status, kClassHit) << method.name;
  }
}

TEST(March, APoleBetweenTheTexelsIsNotThere) {
  // 1 mm at 2 m, with texels of about 7 cm there: no centre meets it, and the ray passes through to the wall.
  const auto room = test::box_room(kLow, kHigh);
  const AnalyticMap map(test::nearest_of({test::pole(2.011, 0.013, 0.0005), room}), glm::dvec3(0), 7);
  const Ray ray{{0.3f, 0.2f, 0.4f}, glm::normalize(glm::vec3(1.711f, 0.1f, -0.387f))};
  for (const NamedMarch& method : marches()) {
    const WalkState state = method.march(map.record(), plain_rules(), ray, 0);
    ASSERT_EQ(state.status, kClassHit) << method.name;
    EXPECT_NEAR(state.t, room(glm::dvec3(ray.x), glm::dvec3(ray.d))->t, 0.15) << method.name;
  }
}

// A slab of 4 cm at x = 0 .. 0.04; the map's probe sees one side of it from 1 m away.
AnalyticMap slab_map(double probe_x) {
  return AnalyticMap(test::nearest_of({test::wall(0, -1), test::wall(0.04, -1)}), {probe_x, 0.013, 0.017}, 9);
}

TEST(March, ABackFaceIsNoHitAndTheNextProbeFindsTheFront) {
  const AnalyticMap beyond = slab_map(1.04), before = slab_map(-1);
  const glm::dvec3 from(-0.5, 0.3, 0.2), d = glm::normalize(glm::dvec3(1, 0.2, -0.1));
  const auto relative = [&](const AnalyticMap& map) { return Ray{glm::vec3(from - map.probe()), glm::vec3(d)}; };
  const double front_t = 0.5 / d.x;
  const auto t_start = static_cast<float>(front_t - 0.01);  // handed on just before the slab
  for (const NamedMarch& method : marches()) {
    MarchRules rules = plain_rules(0.08f);
    const WalkState accepted = method.march(beyond.record(), rules, relative(beyond), t_start);
    EXPECT_EQ(accepted.status, kClassHit) << method.name << ": within the thickness, and its normal is not asked";
    rules.reject_backfaces = true;
    const WalkState rejected = method.march(beyond.record(), rules, relative(beyond), t_start);
    ASSERT_EQ(rejected.status, kClassUnknown) << method.name;
    EXPECT_EQ(rejected.t_safe, t_start) << method.name << ": the next probe starts where this one did";
    EXPECT_GE(rejected.t, t_start);

    // Taken up nearer to the back: the front lies epsilon before at most.
    rules.backward_trace = true;
    const WalkState late = method.march(beyond.record(), rules, relative(beyond), 0.3f);
    const WalkState back = method.march(beyond.record(), rules, relative(beyond), t_start);
    EXPECT_EQ(late.status, kClassUnknown) << method.name;
    ASSERT_EQ(back.status, kClassUnknown) << method.name;
    EXPECT_NEAR(back.t_safe, std::max(t_start, back.t - 0.08f), 1e-6) << method.name;
    const WalkState front = method.march(before.record(), rules, relative(before), back.t_safe);
    ASSERT_EQ(front.status, kClassHit) << method.name;
    EXPECT_NEAR(front.t, front_t, 0.03) << method.name;
  }
}

TEST(March, TheDynamicEpsilonIsTheThesisFormula) {
  // eps = k tan(theta) d(X, Y) |alpha beta| (1 - beta nu). Where a march gives up, the surface must be farther than
  // that; a k that makes it just enough must get further.
  const auto scene = test::nearest_of({test::wall(2, 1), test::wall(6, -1)});
  const AnalyticMap map(scene, glm::dvec3(0), 7);
  const double theta = std::sqrt(8 * std::numbers::pi) / map.size();
  test::Random random(8);
  int checked = 0;
  for (int k = 0; k < 4000; ++k) {
    const Ray ray{glm::vec3(2.3, random(-0.9, 0.9), random(-0.9, 0.9)), glm::vec3(random.direction())};
    MarchRules rules = plain_rules(1);
    rules.epsilon_rule = kEpsilonDynamic;
    std::vector<test::ReadWord> reads;
    test::noted_reads = &reads;
    const WalkState state = flat(map.record(), rules, ray);
    test::noted_reads = nullptr;
    if (state.status != kClassUnknown) continue;
    int texel = -1;
    for (const test::ReadWord& read : reads) texel = map.is_distance(read.address) ? read.index : texel;
    const glm::dvec3 z = glm::dvec3(ray.x) + static_cast<double>(state.t) * glm::dvec3(ray.d);
    const double r = map.distance(texel), off = glm::length(z) - r;
    const glm::dvec3 y = glm::normalize(z) * r, alpha = glm::normalize(glm::dvec3(ray.x) - y);
    const glm::dvec3 beta = glm::normalize(glm::dvec3(ray.x)), normal(-1, 0, 0);
    const double epsilon =
        theta * glm::length(y - glm::dvec3(ray.x)) * std::abs(glm::dot(alpha, beta)) * (1 - glm::dot(beta, normal));
    ASSERT_GT(off, epsilon * (1 - 1e-3)) << k;
    if (epsilon < 1e-3) continue;  // perpendicular: no k makes it a hit
    ++checked;
    rules.epsilon_m = static_cast<float>(off / epsilon * 1.01);
    const WalkState grown = flat(map.record(), rules, ray);
    ASSERT_FALSE(grown.status == kClassUnknown && grown.t == state.t) << k;
  }
  EXPECT_GT(checked, 200);
}

TEST(March, ByTheAngleAnAnswerLooksNoFartherOffThanKTexels) {
  const auto scene = test::nearest_of({test::wall(2, 1), test::wall(6, -1)});
  const AnalyticMap map(scene, glm::dvec3(0), 7);
  const double theta = std::sqrt(8 * std::numbers::pi) / map.size();
  test::Random random(9);
  std::vector<int> hits;
  for (const float factor : {0.5f, 2.0f, 8.0f}) {
    MarchRules rules = plain_rules(factor);
    rules.epsilon_rule = kEpsilonAngle;
    hits.push_back(0);
    for (int k = 0; k < 3000; ++k) {
      const Ray ray{glm::vec3(2.3, random(-0.9, 0.9), random(-0.9, 0.9)), glm::vec3(random.direction())};
      std::vector<test::ReadWord> reads;
      test::noted_reads = &reads;
      const WalkState state = flat(map.record(), rules, ray);
      test::noted_reads = nullptr;
      if (state.status != kClassHit) continue;
      ++hits.back();
      // The point answered: the last texel's distance, in the direction of the plane's normal.
      const double r = map.distance(reads.back().index);
      const glm::dvec3 y = r * glm::normalize(glm::dvec3(state.plane)), to_y = y - glm::dvec3(ray.x);
      const double texel = 1.5 * 4.6 / map.size() * r;  // the plane is at t, which is itself an estimate within a texel
      ASSERT_LT(glm::length(glm::cross(to_y, glm::dvec3(ray.d))), factor * theta * glm::length(to_y) + texel) << k;
    }
  }
  EXPECT_LT(hits[0], hits[1]);
  EXPECT_LT(hits[1], hits[2]);
}

TEST(March, SharingAnExactPlaneWithTheProbeIsNothingSpecial) {
  // Where the successor's published shader divides 0 by 0: x, d or both without a component.
  const auto scene = test::box_room(kLow, kHigh);
  const AnalyticMap map(scene, glm::dvec3(0), 8);
  test::Random random(11);
  for (int k = 0; k < 3000; ++k) {
    glm::dvec3 x(random(-1.4, 1.4), random(-1.4, 1.4), random(-1.4, 1.4)), d = random.direction();
    x[k % 3] = 0;
    d[k % 3] = 0;
    if (k % 2 == 0) x[(k + 1) % 3] = 0;
    if (k % 4 == 0) d[(k + 1) % 3] = 0;
    d = glm::normalize(d);
    const Ray ray{glm::vec3(x), glm::vec3(d)};
    const auto truth = scene(x, d);
    for (const NamedMarch& method : marches()) {
      const WalkState state = method.march(map.record(), plain_rules(), ray, 0);
      ASSERT_NE(state.status, kClassMiss) << method.name << " ray " << k;
      if (state.status == kClassHit) expect_on_surface(map.size(), ray, *truth, glm::dvec3(0), state.t, 0.05);
      ASSERT_FALSE(HasFailure()) << method.name << " ray " << k;
    }
  }
}

}  // namespace
}  // namespace probewalk
