// The spectator's view follows a head calmly.
#include "xr/spectator_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace probewalk {
namespace {

using Pose = SpectatorFilter::Pose;

double angle_between(const glm::dquat& a, const glm::dquat& b) {
  const glm::dquat q = glm::conjugate(a) * b;
  return 2.0 * std::atan2(glm::length(glm::dvec3(q.x, q.y, q.z)), std::abs(q.w));
}

glm::dquat turned(double yaw_rad) {
  return glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0));
}

TEST(SpectatorFilter, BeginsWhereTheHeadIs) {
  SpectatorFilter filter;
  const Pose head{{1, 2, 3}, turned(1.0)};
  const Pose seen = filter.next(head, 0.0);
  EXPECT_EQ(seen.position_m, head.position_m);
  EXPECT_EQ(seen.orientation, head.orientation);
}

TEST(SpectatorFilter, FollowsAStepWithoutSwingingPast) {
  for (const double dt_s : {1.0 / 120.0, 1.0 / 20.0, 0.4}) {
    SpectatorFilter filter;
    filter.next({{0, 1.6, 0}, turned(0.0)}, 0.0);
    const Pose head{{0.3, 1.6, 0}, turned(2.5)};
    double left_m = 0.3, left_rad = 2.5;
    for (double t_s = 0.0; t_s < 4.0; t_s += dt_s) {
      const Pose seen = filter.next(head, dt_s);
      EXPECT_LE(seen.position_m.x, 0.3 + 1e-12);
      EXPECT_LE(head.position_m.x - seen.position_m.x, left_m);
      EXPECT_LE(angle_between(seen.orientation, head.orientation), left_rad + 1e-9);
      left_m = head.position_m.x - seen.position_m.x;
      left_rad = angle_between(seen.orientation, head.orientation);
    }
    EXPECT_LT(left_m, 1e-6);
    EXPECT_LT(left_rad, 1e-6);
  }
}

TEST(SpectatorFilter, IsTheSameAtAnyFrameRate) {
  Pose seen[2];
  const double dt_s[2] = {0.3 / 3, 0.3 / 60};
  for (int k = 0; k < 2; ++k) {
    SpectatorFilter filter;
    filter.next({{0, 0, 0}, turned(0.0)}, 0.0);
    for (double t_s = 0.0; t_s < 0.3 - 1e-9; t_s += dt_s[k]) seen[k] = filter.next({{0.4, 0, 0}, turned(1.0)}, dt_s[k]);
  }
  EXPECT_NEAR(seen[0].position_m.x, seen[1].position_m.x, 1e-9);
  EXPECT_NEAR(angle_between(seen[0].orientation, seen[1].orientation), 0.0, 1e-7);
}

TEST(SpectatorFilter, TakesTheTremorOutOfAHead) {
  SpectatorFilter filter;
  filter.next({{0, 1.6, 0}, turned(0.0)}, 0.0);
  double most_rad = 0.0, most_m = 0.0;
  for (int k = 1; k < 900; ++k) {
    const double t_s = k / 90.0, wave = std::sin(2.0 * 3.141592653589793 * 6.0 * t_s);  // 6 Hz
    const Pose seen = filter.next({{0.01 * wave, 1.6, 0}, turned(0.02 * wave)}, 1.0 / 90.0);
    if (k < 90) continue;
    most_m = std::max(most_m, std::abs(seen.position_m.x));
    most_rad = std::max(most_rad, angle_between(seen.orientation, turned(0.0)));
  }
  EXPECT_LT(most_m, 0.01 / 10);
  EXPECT_LT(most_rad, 0.02 / 10);
}

TEST(SpectatorFilter, TeleportsAreFollowedAtOnceAndTheShortWayIsTaken) {
  SpectatorFilter filter;
  filter.next({{0, 1.6, 0}, turned(0.1)}, 0.0);
  EXPECT_EQ(filter.next({{3, 1.6, 0}, turned(0.1)}, 0.01).position_m.x, 3.0);
  // The same orientation by the other quaternion: nothing turns.
  const Pose seen = filter.next({{3, 1.6, 0}, -turned(0.1)}, 0.1);
  EXPECT_NEAR(angle_between(seen.orientation, turned(0.1)), 0.0, 1e-7);
}

}  // namespace
}  // namespace probewalk
