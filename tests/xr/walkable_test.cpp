#include "xr/walkable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/floors.h"
#include "xr/locomotion.h"

namespace probewalk {
namespace {

using test::make_floor;
using test::r2_point;
using test::two_cells;
using test::two_rooms;

constexpr double kPi = std::numbers::pi;

TEST(FloorArc, OfNoGravityFindsTheFloorInViewAndNothingBehindWalls) {
  const FloorMap floor = make_floor({4, 4}, two_rooms);
  const auto landing = [&](glm::dvec3 from, glm::dvec3 direction) {
    return arc_to_floor(floor, from, direction, 0.0, 12.0).landing_m;
  };
  const glm::dvec3 eye(1, kEyeHeight_m, 1);
  const auto near = landing(eye, {0, -1.6, 0.5});
  ASSERT_TRUE(near);
  EXPECT_NEAR(near->z, 1.5, 0.03);
  EXPECT_FALSE(landing(eye, {0, -1.6, 2.0}));  // the floor beyond the wall
  EXPECT_FALSE(landing(eye, {0, 0.2, 1}));     // the ceiling
  EXPECT_FALSE(landing(eye, {0, 0, 0}));
  EXPECT_FALSE(landing(eye, {NAN, 0, 0}));
  const auto through_door = landing({3.4, kEyeHeight_m, 1}, {0, -1.6, 2.0});
  ASSERT_TRUE(through_door);
  EXPECT_NEAR(through_door->z, 3.0, 0.03);
}

TEST(FloorArc, FliesAParabolaAndLandsOnIt) {
  const FloorMap floor = make_floor({30, 30}, [](double, double) { return 0.25; }, 20.0f);
  for (int i = 0; i < 256; ++i) {
    const glm::dvec2 u = r2_point(i);
    const double pitch_rad = (u.x - 0.5) * 3.0, yaw_rad = 2 * kPi * u.y;
    const glm::dvec3 from(15, 1.45, 15);
    const double across_m_s = kThrowSpeed_m_s * std::cos(pitch_rad), up_m_s = kThrowSpeed_m_s * std::sin(pitch_rad);
    const FloorArc arc = arc_to_floor(
        floor, from, {across_m_s * std::sin(yaw_rad), up_m_s, across_m_s * std::cos(yaw_rad)}, kGravity_m_s2, 60.0);
    ASSERT_TRUE(arc.landing_m) << pitch_rad;
    const double t_s = (up_m_s + std::sqrt(up_m_s * up_m_s + 2 * kGravity_m_s2 * 1.2)) / kGravity_m_s2;
    EXPECT_NEAR(glm::distance(glm::dvec2(arc.landing_m->x, arc.landing_m->z), {15, 15}), across_m_s * t_s, 0.04);
    EXPECT_FLOAT_EQ(static_cast<float>(arc.landing_m->y), 0.25f);
    ASSERT_EQ(arc.points_m.size(), static_cast<std::size_t>(FloorArc::kPoints));
    EXPECT_EQ(arc.points_m.front(), from);
    EXPECT_EQ(arc.points_m.back(), *arc.landing_m);
    for (const glm::dvec3& point : arc.points_m) {
      const double t = glm::distance(glm::dvec2(point.x, point.z), {15, 15}) / across_m_s;
      EXPECT_NEAR(point.y, 1.45 + up_m_s * t - 0.5 * kGravity_m_s2 * t * t, 0.05);
    }
  }
}

TEST(FloorArc, ClearsARailingThatARayDoesNotAndNoWall) {
  // A step of 0.4 m at z in [2, 2.3), which a flat throw goes over.
  const FloorMap step = make_floor({4, 8}, [](double, double z) { return z > 2 && z < 2.3 ? 0.4 : 0.0; });
  const FloorArc over = arc_to_floor(step, {2, 1.2, 1}, {0, 2.0, 4.0}, kGravity_m_s2, 14.0);
  ASSERT_TRUE(over.landing_m);
  EXPECT_GT(over.landing_m->z, 2.3);
  const FloorMap cells = make_floor({4, 4}, two_cells);
  for (int i = 0; i < 512; ++i) {
    const glm::dvec2 u = r2_point(i), v = r2_point(i + 9999);
    const double yaw_rad = 2 * kPi * v.x, pitch_rad = (v.y - 0.5) * 3.0;
    const glm::dvec3 direction(std::cos(pitch_rad) * std::sin(yaw_rad), std::sin(pitch_rad),
                               std::cos(pitch_rad) * std::cos(yaw_rad));
    const FloorArc arc =
        arc_to_floor(cells, {4 * u.x, 1.2, 2 * u.y}, direction * kThrowSpeed_m_s, kGravity_m_s2, kTeleportReach_m);
    if (arc.landing_m) {
      EXPECT_LT(arc.landing_m->z, 2.0 + 1e-9);
    }
    for (const glm::dvec3& point : arc.points_m)
      EXPECT_LT(point.z, 2.06) << "the arc is drawn to the wall and no further";
  }
}

TEST(StandingNear, GivesABodyRoomOnTheSameSideOfTheWall) {
  const FloorMap floor = make_floor({4, 4}, two_cells);
  for (int i = 0; i < 256; ++i) {
    const glm::dvec2 u = r2_point(i);
    const glm::dvec3 foot(0.3 + 3.4 * u.x, 0, 0.3 + 1.69 * u.y);  // up to 1 cm from the wall
    const glm::dvec3 there = standing_near(floor, foot);
    EXPECT_TRUE(can_stand(floor, there));
    EXPECT_LT(there.z, 2.0);
    EXPECT_LE(glm::distance(there, foot), 2 * kBodyRadius_m + 1e-9);
    if (can_stand(floor, foot)) {
      EXPECT_EQ(there, foot);
    }
  }
}

TEST(ClearWay, EndsAtWallsAndGoesThroughDoors) {
  const FloorMap floor = make_floor({4, 4}, two_rooms);
  const glm::dvec3 eye(1, kEyeHeight_m, 1);
  EXPECT_TRUE(is_clear_way(floor, eye, eye));
  EXPECT_TRUE(is_clear_way(floor, eye, {3.4, 1.2, 1.2}));
  EXPECT_FALSE(is_clear_way(floor, eye, {1, 1.3, 3})) << "a hand held through the wall";
  EXPECT_FALSE(is_clear_way(floor, {1, 1.3, 3}, eye));
  EXPECT_TRUE(is_clear_way(floor, {3.4, kEyeHeight_m, 1}, {3.4, 1.3, 3})) << "through the door";
  const FloorMap with_table =
      make_floor({4, 4}, [](double x, double z) { return x > 2 && x < 3 && z > 2 && z < 3 ? NAN : 0.0; });
  EXPECT_FALSE(is_clear_way(with_table, {1, kEyeHeight_m, 2.5}, {3.5, 1.3, 2.5}))
      << "columns cannot tell a table from a wall";
  EXPECT_TRUE(is_clear_way(FloorMap{}, eye, {1, 1.3, 30})) << "without a floor nothing is known to be in the way";
}

}  // namespace
}  // namespace probewalk
