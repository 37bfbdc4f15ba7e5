// The methods that the product is measured against, where their answers are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "content/baseline/host_tracer.h"
#include "support/analytic_rooms.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

constexpr float kSpread_rad = 1e-3f;

struct Baselines {
  Baselines(const Scene& source, const ProbeGrid& grid, int n)
      : scene(source), rays(scene), set(test::probe_set(rays, grid, n)) {
    SilentProgress progress;
    maps = make_baseline_maps(rays, test::grid_positions_m(grid), n, progress);
  }
  HostTracer tracer(std::string_view method) const { return tracer(choice_of(method)); }
  HostTracer tracer(const TracerChoice& choice) const { return HostTracer(set, default_dials(1.0), choice, &maps); }

  const Scene scene;
  const RayScene rays;
  const ProbeSet set;
  BaselineMaps maps;
};

const test::BoxRoom kRoom;

const Baselines& box() {
  static const Baselines shared(kRoom.scene(), test::plain_grid({-1.1, 0.6, -2.3}, {4.2, 1.4, 2.6}, {2, 2, 2}), 64);
  return shared;
}

// A point inside the box, 2 cm from its walls at least.
glm::dvec3 point_inside(test::Random& random) {
  const glm::dvec3 margin(0.02);
  return glm::mix(kRoom.lower_m + margin, kRoom.upper_m - margin, glm::dvec3(random(), random(), random()));
}

TEST(BaselineWalks, ABoxProxyIsExactInABox) {
  const HostTracer tracer = box().tracer("box-proxy");
  test::Random random(11);
  for (int k = 0; k < 5000; ++k) {
    const glm::dvec3 origin_m = point_inside(random), d = test::hammersley_direction(k, 5000);
    const BatchAnswer answer = tracer.trace(origin_m, d, kSpread_rad);
    const double expected = kRoom.distance(origin_m, d);
    ASSERT_EQ(answer.answer, kClassHit);
    ASSERT_NEAR(answer.t_m, expected, 2e-5 * std::max(expected, 1.0));
    ASSERT_EQ(answer.tries, 1u);
    ASSERT_EQ(answer.lookups, 1u);
  }
}

TEST(BaselineWalks, ASphereProxyIsExactInABall) {
  const Baselines ball(test::ball_room(3.0), test::plain_grid({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), 32);
  const HostTracer tracer = ball.tracer("sphere-proxy");
  test::Random random(12);
  for (int k = 0; k < 2000; ++k) {
    const glm::dvec3 origin_m = random.direction() * (2.9 * std::cbrt(random())), d = test::hammersley_direction(k, 2000);
    const double along = glm::dot(origin_m, d);
    const double expected = std::sqrt(along * along - glm::dot(origin_m, origin_m) + 9.0) - along;
    const BatchAnswer answer = tracer.trace(origin_m, d, kSpread_rad);
    ASSERT_EQ(answer.answer, kClassHit);
    // The triangles are within 3e-4 of the ball; rays that graze it feel that ten times over.
    ASSERT_NEAR(answer.t_m, expected, 1e-2);
  }
  // From outside of the proxy, looking past it, nothing is known: the last resort is the environment.
  const BatchAnswer outside = tracer.trace({0.0, 10.0, 0.0}, {1.0, 0.0, 0.0}, kSpread_rad);
  EXPECT_EQ(outside.answer, kClassUnknown);
  EXPECT_EQ(outside.probe, 0);
}

TEST(BaselineWalks, AnEnvironmentKnowsTheDirectionAlone) {
  const HostTracer tracer = box().tracer("environment");
  test::Random random(13);
  const glm::dvec3 near_first(-1.0, 0.7, -2.2);
  for (int k = 0; k < 1000; ++k) {
    const glm::dvec3 d = test::hammersley_direction(k, 1000);
    const BatchAnswer here = tracer.trace(near_first, d, kSpread_rad);
    const BatchAnswer there = tracer.trace(near_first + glm::dvec3(0.3, 0.1, -0.2), d, kSpread_rad);
    ASSERT_EQ(here.probe, 0);
    ASSERT_EQ(here.answer, kClassHit);
    ASSERT_EQ(here.t_m, there.t_m);
    ASSERT_EQ(here.radiance, there.radiance);
    // Where the probe itself sees the wall, to a vertex: 64 cells a side are 3.5 degrees at most.
    const double expected = kRoom.distance({-1.1, 0.6, -2.3}, d);
    ASSERT_NEAR(here.t_m, expected, 0.25 * expected);
  }
}

TEST(BaselineWalks, AnImpostorMeetsWallsByItsSecants) {
  const HostTracer tracer = box().tracer("impostor");
  test::Random random(14);
  std::vector<double> errors;
  int unknown = 0;
  for (int k = 0; k < 4000; ++k) {
    const glm::dvec3 origin_m = point_inside(random), d = test::hammersley_direction(k, 4000);
    const BatchAnswer answer = tracer.trace(origin_m, d, kSpread_rad);
    unknown += answer.answer != kClassHit;
    if (answer.answer == kClassHit) errors.push_back(std::abs(answer.t_m / kRoom.distance(origin_m, d) - 1.0));
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 2e-3);
  EXPECT_LT(errors[errors.size() * 9 / 10], 2e-2);
  EXPECT_LT(unknown, 200);  // starts so near to a wall that the filtered map hides them
}

// Exact distances of all that lies within the angle around a direction.
std::pair<double, double> distances_around(glm::dvec3 origin_m, glm::dvec3 d, double angle_rad) {
  const glm::dvec3 u = glm::normalize(glm::cross(d, std::abs(d.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 v = glm::cross(d, u);
  double least = kRoom.distance(origin_m, d), greatest = least;
  for (int k = 0; k < 32; ++k) {
    const double turn = 2.0 * std::numbers::pi * (k % 16) / 16, tilt = angle_rad * (k < 16 ? 1.0 : 0.5);
    const glm::dvec3 around = glm::normalize(d + (u * std::cos(turn) + v * std::sin(turn)) * std::tan(tilt));
    least = std::min(least, kRoom.distance(origin_m, around));
    greatest = std::max(greatest, kRoom.distance(origin_m, around));
  }
  return {least, greatest};
}

// The ray from a probe through its own map: whatever the method, a texel's error is all that is left.
TEST(BaselineWalks, FromTheProbesCentreEveryMethodIsExactWithinATexel) {
  const glm::dvec3 centre_m(-1.1, 0.6, -2.3);
  constexpr double kTexel_rad = 2.0 * 5.01 / 64;  // two mean diagonals: octahedral texels differ
  for (const MethodInfo& method : methods()) {
    if (method.number == kMethodSphereProxy) continue;  // its t is the sphere's; its look-up is tested below
    TracerChoice choice = choice_of(method.name);
    choice.rules.first = kFirstNearest;
    const HostTracer tracer = box().tracer(choice);
    for (int k = 0; k < 1500; ++k) {
      const glm::dvec3 d = test::hammersley_direction(k, 1500);
      const BatchAnswer answer = tracer.trace(centre_m, d, kSpread_rad);
      const auto [least, greatest] = distances_around(centre_m, d, kTexel_rad);
      ASSERT_EQ(answer.answer, kClassHit) << method.name << " " << k;
      ASSERT_EQ(answer.probe, 0) << method.name;
      ASSERT_GE(answer.t_m, least * 0.97) << method.name << " " << k;
      ASSERT_LE(answer.t_m, greatest * 1.03) << method.name << " " << k;
    }
  }
}

TEST(BaselineWalks, EveryMethodIsFiniteWhereverItStarts) {
  test::Random random(15);
  for (const MethodInfo& method : methods()) {
    const HostTracer tracer = box().tracer(method.name);
    for (int k = 0; k < 600; ++k) {
      glm::dvec3 origin_m = point_inside(random), d = random.direction();
      if (k % 3 == 1) origin_m += random.direction() * 20.0;               // outside
      if (k % 4 == 1) d = glm::dvec3(k % 8 == 1 ? 1.0 : 0.0, k % 8 == 1 ? 0.0 : -1.0, 0.0);
      if (k % 5 == 1) origin_m = {-1.1, 0.6, -2.3};                         // a probe's centre
      if (k % 7 == 1) origin_m.y = 0.0;                                     // on the floor
      const BatchAnswer answer = tracer.trace(origin_m, d, kSpread_rad);
      ASSERT_TRUE(std::isfinite(answer.t_m)) << method.name << " " << k;
      ASSERT_GE(answer.t_m, 0.0f) << method.name << " " << k;
      ASSERT_TRUE(std::isfinite(answer.radiance.x + answer.radiance.y + answer.radiance.z)) << method.name << " " << k;
      ASSERT_LE(answer.tries, 16u);
    }
  }
}

TEST(BaselineWalks, TheMarchesAgreeWithTheWallsToTheirThickness) {
  test::Random random(16);
  for (const std::string_view method : {"march-3d", "march-2d", "march-2d-hierarchical", "two-level", "restart"}) {
    const HostTracer tracer = box().tracer(method);
    std::vector<double> errors;
    int unknown = 0;
    for (int k = 0; k < 1500; ++k) {
      const glm::dvec3 origin_m = point_inside(random), d = test::hammersley_direction(k, 1500);
      const BatchAnswer answer = tracer.trace(origin_m, d, kSpread_rad);
      unknown += answer.answer != kClassHit;
      if (answer.answer == kClassHit) errors.push_back(std::abs(answer.t_m / kRoom.distance(origin_m, d) - 1.0));
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.05) << method;
    EXPECT_LT(errors[errors.size() * 9 / 10], 0.3) << method;
    EXPECT_LT(unknown, 300) << method;
  }
}

TEST(BaselineWalks, NodesSkippedChangeNothing) {
  const HostTracer plain = box().tracer("march-2d"), skipping = box().tracer("march-2d-hierarchical");
  test::Random random(17);
  int other = 0;
  for (int k = 0; k < 3000; ++k) {
    const glm::dvec3 origin_m = point_inside(random), d = test::hammersley_direction(k, 3000);
    const BatchAnswer a = plain.trace(origin_m, d, kSpread_rad), b = skipping.trace(origin_m, d, kSpread_rad);
    other += a.answer != b.answer || a.probe != b.probe || std::abs(a.t_m - b.t_m) > 1e-4f * a.t_m;
  }
  EXPECT_LE(other, 3);
}

TEST(BaselineWalks, RestartingAsksEveryProbeFromTheOrigin) {
  const Baselines room(test::furnished_room(), test::plain_grid({-1.6, 0.9, -1.1}, {3.1, 1.1, 2.4}, {2, 2, 2}), 64);
  const HostTracer handing = room.tracer("march-2d-hierarchical"), restarting = room.tracer("restart");
  test::Random random(18);
  std::uint64_t handing_lookups = 0, restarting_lookups = 0;
  int several = 0;
  for (int k = 0; k < 4000; ++k) {
    const glm::dvec3 origin_m(random(-2.8, 2.8), random(0.2, 2.4), random(-2.3, 2.3)), d = random.direction();
    const BatchAnswer a = handing.trace(origin_m, d, kSpread_rad), b = restarting.trace(origin_m, d, kSpread_rad);
    if (a.tries < 2) continue;
    ++several;
    handing_lookups += a.lookups;
    restarting_lookups += b.lookups;
  }
  ASSERT_GT(several, 200);
  EXPECT_GT(restarting_lookups, handing_lookups);
}

TEST(BaselineWalks, OatOnTheHostIsTheProduct) {
  const HostTracer tracer = box().tracer("oat"), flat = box().tracer("oat-flat");
  test::Random random(19);
  int off = 0;
  for (int k = 0; k < 1000; ++k) {
    const glm::dvec3 origin_m = point_inside(random), d = random.direction();
    const BatchAnswer a = tracer.trace(origin_m, d, kSpread_rad), b = flat.trace(origin_m, d, kSpread_rad);
    const double expected = kRoom.distance(origin_m, d);
    off += std::abs(a.t_m - expected) > 2e-5 * expected;
    ASSERT_EQ(a.answer, b.answer);
    ASSERT_NEAR(a.t_m, b.t_m, 1e-5 * a.t_m);  // walls are met as planes, within the planes' tolerance
  }
  EXPECT_LT(off, 150);  // cells that straddle two walls cut the corner between them
}

TEST(BaselineWalks, MapsThatAreMissingAreAnError) {
  EXPECT_THROW(HostTracer(box().set, default_dials(1.0), choice_of("impostor"), nullptr), std::logic_error);
  EXPECT_NO_THROW(HostTracer(box().set, default_dials(1.0), choice_of("environment"), nullptr));
}

}  // namespace
}  // namespace probewalk
