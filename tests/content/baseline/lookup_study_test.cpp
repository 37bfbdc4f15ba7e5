// What the figures count, and the predictions laid over it.
#include "content/baseline/lookup_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/baseline/analytic_map.h"
#include "content/baseline/lookup_theory.h"
#include "content/baseline/march_instance.h"
#include "support/analytic_rooms.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

TEST(LookupTheory, NoRayReadsMoreTexelsThanItsAngleAllows) {
  test::Random random(1);
  for (const int n_log2 : {4, 6, 8}) {
    const test::AnalyticMap map(test::open_sky(), glm::dvec3(0), n_log2);
    const march32::MarchRules rules{kEpsilonFixed, false, false, 0.05f, 0.01f, 1e12f, 1 << 18};
    double greatest = 0;
    for (int k = 0; k < 20000; ++k) {
      // Near the octahedron's vertices the rate is greatest: some rays stay there.
      const glm::dvec3 from = k % 2 == 0 ? random.direction() : glm::dvec3(1, random(-0.1, 0.1), random(-0.1, 0.1));
      const glm::dvec3 to = k % 2 == 0 ? random.direction() : from + glm::dvec3(0, random(-0.3, 0.3), random(-0.3, 0.3));
      const StudyRay ray{from, glm::normalize(to)};
      const auto state = march32::march_2d(map.record(), rules, glm::vec3(from), glm::vec3(ray.direction), 0, false);
      const double angle_rad = displacement_angle_rad(ray, glm::dvec3(0));
      const double most = most_texels_crossed(map.size(), angle_rad);
      ASSERT_LE(state.lookups, most) << "angle " << angle_rad;
      greatest = std::max(greatest, state.lookups / most);
    }
    if (n_log2 == 8) {
      EXPECT_GT(greatest, 0.7) << "a bound that nothing comes near says nothing";
    }
  }
}

TEST(LookupTheory, FactorAndGrowthAreFoundAgain) {
  const std::vector<double> side{128, 256, 512, 1024};
  std::vector<double> thrice, square;
  for (const double s : side) thrice.push_back(3 * s), square.push_back(0.1 * s * s);
  EXPECT_NEAR(fitted_factor(side, thrice), 3, 1e-12);
  EXPECT_NEAR(growth_exponent(side, thrice), 1, 1e-12);
  EXPECT_NEAR(growth_exponent(side, square), 2, 1e-12);
  EXPECT_NEAR(hierarchical_shape(1024, 0), 10, 1e-12);
  EXPECT_EQ(flat_shape(512), 512);
}

const test::BoxRoom kRoom;

const StudyScene& room() {
  static const StudyScene scene(kRoom.scene());
  return scene;
}

TEST(LookupStudy, RaysStartWhereAProbeSeesThem) {
  const glm::dvec3 probe_m = glm::mix(room().bounds().lower_m, room().bounds().upper_m, glm::dvec3(0.4, 0.6, 0.5));
  const std::vector<StudyRay> rays = rays_seen_by(room(), std::span(&probe_m, 1), 500);
  ASSERT_EQ(rays.size(), 500u);
  glm::dvec3 sum(0);
  for (const StudyRay& ray : rays) {
    EXPECT_NEAR(glm::length(ray.direction), 1, 1e-9);
    EXPECT_FALSE(room().rays().occluded(glm::vec3(probe_m), glm::vec3(ray.origin_m - probe_m), 0, 1));
    sum += ray.direction;
  }
  EXPECT_LT(glm::length(sum), 25) << "all directions alike";
  const StudyRay away{probe_m + glm::dvec3(0, 1, 0), {0, 1, 0}}, across{probe_m + glm::dvec3(0, 1, 0), {1, 0, 0}};
  EXPECT_NEAR(displacement_angle_rad(away, probe_m), 0, 1e-12);
  EXPECT_NEAR(displacement_angle_rad(across, probe_m), std::numbers::pi / 2, 1e-12);
}

TEST(LookupStudy, OneProbeAnswersByEveryMethodInAConvexRoom) {
  SilentProgress progress;
  const glm::dvec3 probe_m = glm::mix(room().bounds().lower_m, room().bounds().upper_m, glm::dvec3(0.4, 0.6, 0.5));
  const OneProbe probe(room(), probe_m, 128, progress);
  const std::vector<StudyRay> rays = rays_seen_by(room(), std::span(&probe_m, 1), 300);
  double flat = 0, nodes = 0;
  for (const char* name : {"march-3d", "march-2d", "march-2d-hierarchical", "two-level", "oat-flat", "oat"}) {
    int answered = 0;
    for (const StudyRay& ray : rays) {
      const Walk walk = probe.walk(choice_of(name), ray);
      answered += walk.cls == kClassHit ? 1 : 0;
      ASSERT_GT(walk.lookups, 0u);
      if (walk.cls == kClassHit) {
        ASSERT_LT(walk.t_m, kRoom.distance(ray.origin_m, ray.direction) + 1.0);
      }
      if (std::string_view(name) == "march-2d") flat += walk.lookups;
      if (std::string_view(name) == "march-2d-hierarchical") nodes += walk.lookups;
    }
    EXPECT_GT(answered, 255) << name;  // grazing rays lose a march whose epsilon is less than a texel's jump
  }
  EXPECT_LT(nodes, 0.6 * flat);
  // The first look from another level changes what it costs and not what is answered.
  for (const StudyRay& ray : rays) {
    const Walk usual = probe.walk(choice_of("oat"), ray), coarse = probe.walk(choice_of("oat"), ray, 1);
    ASSERT_EQ(usual.cls, coarse.cls);
    ASSERT_NEAR(usual.t_m, coarse.t_m, 1e-4 * usual.t_m);  // a plane may stand for its cells
  }
}

TEST(LookupStudy, OfMoreProbesTheBestOfAllIsMoreParallelAndTheBestOfTheCellIsNot) {
  SilentProgress progress;
  TracerChoice choice = choice_of("march-2d");
  choice.rules.first = kFirstSigned;
  std::vector<ManyProbes::Count> cell, best;
  for (const int per_axis : {2, 4}) {
    const ProbeLattice lattice = lattice_in(room(), per_axis);
    ASSERT_EQ(lattice.positions_m.size(), static_cast<std::size_t>(per_axis * per_axis * per_axis));
    const std::vector<StudyRay> rays = rays_seen_by(room(), lattice.positions_m, 400);
    const ManyProbes probes(room(), lattice, 64, progress);
    cell.push_back(probes.by_cell(choice, rays));
    best.push_back(probes.by_best_of_all(choice, rays));
    for (const ManyProbes::Count& count : {cell.back(), best.back()}) {
      double sum = 0, lookups = 0;
      for (std::size_t k = 0; k < count.share_by_tries.size(); ++k) {
        sum += count.share_by_tries[k];
        lookups += count.share_by_tries[k] * count.lookups_by_tries[k];
      }
      EXPECT_NEAR(sum, 1, 1e-9);
      EXPECT_NEAR(lookups, count.lookups_mean, 1e-6 * lookups);
      EXPECT_LT(count.unknown_share, 0.05);
    }
  }
  EXPECT_LT(best[1].angle_mean_rad, 0.75 * best[0].angle_mean_rad);
  EXPECT_LT(best[1].lookups_mean, 0.8 * best[0].lookups_mean);
  EXPECT_LT(best[1].angle_mean_rad, 0.8 * cell[1].angle_mean_rad);
  EXPECT_GT(cell[1].angle_mean_rad / cell[0].angle_mean_rad, best[1].angle_mean_rad / best[0].angle_mean_rad + 0.1);
}

}  // namespace
}  // namespace probewalk
