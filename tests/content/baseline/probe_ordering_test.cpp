// The order in which a ray asks the probes of its cell, in the square and in the cube.
#include "content/baseline/probe_ordering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

constexpr std::array<int, 4> kFirsts{kFirstNearest, kFirstSigned, kFirstUnsigned, kFirstSignedLessDistance};

glm::dvec2 direction_at(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }

TEST(ProbeOrdering, SectorsCoverTheCircleAndEachHasOneOrder) {
  test::Random random(1);
  for (const int first : kFirsts) {
    for (int k = 0; k < 30; ++k) {
      const glm::dvec2 origin(random(-0.99, 0.99), random(-0.99, 0.99));
      const std::vector<OrderSector> sectors = square_sectors(first, origin);
      double sum_rad = 0;
      for (std::size_t i = 0; i < sectors.size(); ++i) {
        const OrderSector& sector = sectors[i];
        const OrderSector& next = sectors[(i + 1) % sectors.size()];
        sum_rad += sector.to_rad - sector.from_rad;
        EXPECT_LT(sector.from_rad, sector.to_rad);
        for (const double part : {1e-6, 0.3, 0.5, 0.7, 1 - 1e-6}) {
          const double angle_rad = sector.from_rad + part * (sector.to_rad - sector.from_rad);
          if (sector.to_rad - sector.from_rad < 1e-3) continue;  // borders are known to 1e-10 of it
          EXPECT_EQ(square_order(first, origin, direction_at(angle_rad)), sector.order) << first << " " << part;
        }
        if (sectors.size() == 1) continue;
        EXPECT_NE(sector.order, next.order);
        EXPECT_NEAR(std::remainder(sector.to_rad - next.from_rad, 2 * std::numbers::pi), 0, 1e-12);
      }
      EXPECT_NEAR(sum_rad, 2 * std::numbers::pi, 1e-9);
    }
  }
}

TEST(ProbeOrdering, ARayStraightAwayFromACornerAsksItFirst) {
  test::Random random(2);
  for (int k = 0; k < 400; ++k) {
    const glm::dvec2 origin(random(-0.99, 0.99), random(-0.99, 0.99));
    const int corner = k % 4;
    const glm::dvec2 away = glm::normalize(origin - glm::dvec2(kSquareCorners[static_cast<std::size_t>(corner)]));
    EXPECT_EQ(square_order(kFirstSigned, origin, away)[0], corner);
    EXPECT_EQ(square_order(kFirstUnsigned, origin, away)[0], corner);
    EXPECT_EQ(square_order(kFirstUnsigned, origin, -away)[0], corner);
    EXPECT_EQ(square_order(kFirstNearest, origin, away), square_order(kFirstNearest, origin, -away));
  }
}

glm::dvec3 corner_m(int k) { return {k & 1, k >> 1 & 1, k >> 2}; }

SelectionRules rules_with(int first, int order) {
  SelectionRules rules = default_rules();
  rules.first = first;
  rules.order = order;
  return rules;
}

TEST(ProbeOrdering, TheCubesOrdersAreTheRules) {
  const CubeOrdering cube;
  test::Random random(3);
  for (int k = 0; k < 500; ++k) {
    const glm::dvec3 origin(random(0.02, 0.98), random(0.02, 0.98), random(0.02, 0.98)), d = random.direction();
    const auto cosine = [&](int corner) { return glm::dot(glm::normalize(origin - corner_m(corner)), d); };
    const auto sorted = cube.order(rules_with(kFirstSigned, kOrderSorted), origin, d);
    for (std::size_t i = 0; i + 1 < 8; ++i) EXPECT_GT(cosine(sorted[i]), cosine(sorted[i + 1]) - 1e-5);
    const auto plus_three = cube.order(rules_with(kFirstSigned, kOrderPlusThree), origin, d);
    EXPECT_NEAR(cosine(plus_three[0]), cosine(sorted[0]), 1e-5);
    int sum = 0;
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(plus_three[(i + 1) % 8], (plus_three[i] + 3) % 8);
    const auto by_xor = cube.order(rules_with(kFirstSigned, kOrderMaximalXor), origin, d);
    for (std::size_t i = 0; i < 8; ++i) sum += by_xor[i] ^ by_xor[(i + 1) % 8];
    EXPECT_EQ(sum, 50);
    const auto nearest = cube.order(rules_with(kFirstNearest, kOrderSorted), origin, d);
    for (std::size_t i = 0; i + 1 < 8; ++i) {
      EXPECT_LT(glm::length(origin - corner_m(nearest[i])), glm::length(origin - corner_m(nearest[i + 1])) + 1e-5);
    }
  }
}

TEST(ProbeOrdering, StatisticsSayWhatTheFiguresSay) {
  const CubeOrdering cube;
  const glm::dvec3 origin(0.8, 0.7, 0.25);
  const auto of = [&](int first, int order) { return order_statistics(cube, rules_with(first, order), origin, 2000); };
  const OrderStatistics sorted = of(kFirstSigned, kOrderSorted), plus_three = of(kFirstSigned, kOrderPlusThree);
  const OrderStatistics by_xor = of(kFirstSigned, kOrderMaximalXor), nearest = of(kFirstNearest, kOrderSorted);
  double sum = 0;
  for (const double share : sorted.first_share) sum += share;
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_NEAR(*std::max_element(nearest.first_share.begin(), nearest.first_share.end()), 1, 1e-9);
  EXPECT_EQ(nearest.distinct_orders, 1);
  EXPECT_EQ(plus_three.distinct_orders, 8);
  EXPECT_GT(sorted.distinct_orders, 100);
  EXPECT_GT(sorted.first_cosine, 0.6);
  EXPECT_GT(sorted.first_cosine, of(kFirstUnsigned, kOrderSorted).first_cosine + 0.3);
  EXPECT_NEAR(nearest.first_cosine, 0, 1e-3);
  // The next most parallel probe looks from nearly where the first did; fixed orders turn farther.
  EXPECT_LT(sorted.second_turn_rad, 0.8 * plus_three.second_turn_rad);
  EXPECT_LT(sorted.second_turn_rad, 0.8 * by_xor.second_turn_rad);
  // 50 against 40 of exclusive ors: more coordinates change.
  EXPECT_GT(by_xor.corners_moved, plus_three.corners_moved);
}

TEST(ProbeOrdering, SpreadDirectionsAreUnitAndEven) {
  glm::dvec3 sum(0), squares(0);
  for (int k = 0; k < 1000; ++k) {
    const glm::dvec3 d = spread_direction(k, 1000);
    EXPECT_NEAR(glm::length(d), 1, 1e-12);
    sum += d;
    squares += d * d;
  }
  EXPECT_LT(glm::length(sum), 1);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(squares[axis], 1000 / 3.0, 2);
}

}  // namespace
}  // namespace probewalk
