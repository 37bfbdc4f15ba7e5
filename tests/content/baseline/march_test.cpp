// The marches of the baselines against scenes that are formulas: what they answer, which texels they read, and that
// they end on anything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "content/baseline/analytic_map.h"
#include "content/baseline/march_instance.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

using march32::MarchRules;
using march32::WalkState;
using test::AnalyticMap;

constexpr float kFar_m = 50.0f;

MarchRules plain_rules(float epsilon_m = 0.05f) {
  return {.epsilon_rule = kEpsilonFixed,
          .reject_backfaces = false,
          .backward_trace = false,
          .epsilon_m = epsilon_m,
          .step_m = 0.01f,
          .farthest_m = kFar_m,
          .max_steps = 100000};
}

struct Ray {
  glm::vec3 x;  // relative to the probe
  glm::vec3 d;
};

using March = std::function<WalkState(const BaselineRecord&, const MarchRules&, const Ray&, float)>;

struct NamedMarch {
  std::string name;
  March march;
};

WalkState flat(const BaselineRecord& map, const MarchRules& rules, const Ray& ray, float t_start = 0) {
  return march32::march_2d(map, rules, ray.x, ray.d, t_start, false);
}
WalkState hierarchical(const BaselineRecord& map, const MarchRules& rules, const Ray& ray, float t_start = 0) {
  return march32::march_2d(map, rules, ray.x, ray.d, t_start, true);
}
WalkState two_level(const BaselineRecord& map, const MarchRules& rules, const Ray& ray, float t_start = 0) {
  return march32::march_two_level(map, rules, ray.x, ray.d, t_start);
}
WalkState steps(const BaselineRecord& map, const MarchRules& rules, const Ray& ray, float t_start = 0) {
  return march32::march_3d(map, rules, ray.x, ray.d, t_start);
}

std::vector<NamedMarch> marches() {
  return {{"march-2d", flat}, {"march-2d-hierarchical", hierarchical}, {"two-level", two_level}, {"march-3d", steps}};
}

const glm::dvec3 kLow(-3, -1.5, -2), kHigh(3, 1.5, 2);

Ray room_ray(test::Random& random, glm::dvec3 probe) {
  const glm::dvec3 from(random(-2.9, 2.9), random(-1.4, 1.4), random(-1.9, 1.9));
  return {glm::vec3(from - probe), glm::vec3(random.direction())};
}

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
