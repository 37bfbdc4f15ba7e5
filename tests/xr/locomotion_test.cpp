#include "xr/locomotion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "xr/frame_pacer.h"
#include "xr/mirror_pacer.h"
#include "xr/path.h"
#include "xr/window_layout.h"

namespace probewalk {
namespace {

// A floor of 0.05 m columns over [0, size) m; `height` gives the floor's y, NaN = no floor there.
FloorMap make_floor(glm::dvec2 size_m, const std::function<double(double x, double z)>& height,
                    float headroom_m = 2.5f) {
  FloorMap floor;
  floor.cell_m = 0.05;
  floor.columns = glm::ivec2(glm::round(size_m / floor.cell_m));
  for (int iz = 0; iz < floor.columns.y; ++iz) {
    for (int ix = 0; ix < floor.columns.x; ++ix) {
      const double y = height((ix + 0.5) * floor.cell_m, (iz + 0.5) * floor.cell_m);
      if (std::isnan(y)) continue;
      FloorNode node;
      node.ix = ix;
      node.iz = iz;
      node.floor_m = static_cast<float>(y);
      node.headroom_m = headroom_m;
      floor.nodes.push_back(node);
    }
  }
  return floor;
}

Pose eye_at(double x, double z, double yaw_rad = 0.0, double floor_m = 0.0) {
  Pose pose;
  pose.position_m = {x, floor_m + kEyeHeight_m, z};
  pose.yaw_rad = yaw_rad;
  return pose;
}

void walk(FloorWalker& walker, glm::dvec2 wish, double seconds) {
  for (double t = 0; t < seconds; t += 0.01) walker.advance(wish, 1.0, 0.01);
}

// Two rooms of 4 m x 2 m, z in [0, 2) and [2.15, 4), with a wall of 0.15 m between them and a door at x in [3, 3.8).
double two_rooms(double x, double z) { return z > 2.0 && z < 2.15 && !(x >= 3.0 && x < 3.8) ? NAN : 0.0; }

TEST(FloorWalker, WalksForwardAlongItsYaw) {
  const FloorMap floor = make_floor({4, 4}, [](double, double) { return 0.0; });
  FloorWalker ahead(floor, eye_at(2, 3));
  walk(ahead, {0, 1}, 1.0);
  EXPECT_NEAR(ahead.head().position_m.z, 2.0, 0.03);
  EXPECT_NEAR(ahead.head().position_m.x, 2.0, 1e-9);
  FloorWalker left(floor, eye_at(2, 3, std::numbers::pi / 2));
  walk(left, {0, 1}, 1.0);
  EXPECT_NEAR(left.head().position_m.x, 1.0, 0.03);
  FloorWalker diagonal(floor, eye_at(2, 3));
  walk(diagonal, {1, 1}, 1.0);  // two keys are not faster than one
  EXPECT_NEAR(glm::distance(diagonal.head().position_m, glm::dvec3(2, kEyeHeight_m, 3)), 1.0, 0.03);
}

TEST(FloorWalker, IsStoppedByWallsAtABodysWidthAndSlidesAlongThem) {
  const FloorMap floor = make_floor({4, 4}, two_rooms);
  FloorWalker walker(floor, eye_at(1, 1));
  walk(walker, {0, -1}, 5.0);
  EXPECT_LT(walker.head().position_m.z, 2.0 - kBodyRadius_m + 0.06);
  EXPECT_GT(walker.head().position_m.z, 1.7);
  const double x = walker.head().position_m.x;
  walk(walker, {0.7, -0.7}, 1.0);
  EXPECT_GT(walker.head().position_m.x, x + 0.5);
  EXPECT_LT(walker.head().position_m.z, 2.0);
}

TEST(FloorWalker, GoesThroughDoors) {
  const FloorMap floor = make_floor({4, 4}, two_rooms);
  FloorWalker walker(floor, eye_at(3.4, 1));
  walk(walker, {0, -1}, 2.0);
  EXPECT_NEAR(walker.head().position_m.z, 3.0, 0.1);
}

TEST(FloorWalker, ClimbsStepsSmoothlyButNoLedge) {
  // Steps of 0.2 m every 0.3 m up to 1 m, and a ledge of 0.6 m at z = 0.5.
  const FloorMap floor = make_floor({2, 6}, [](double, double z) {
    if (z < 0.5) return 1.6;
    return std::clamp(std::floor((4.0 - z) / 0.3) * 0.2, 0.0, 1.0);
  });
  FloorWalker walker(floor, eye_at(1, 5.5));
  double last_y = walker.head().position_m.y;
  for (int i = 0; i < 800; ++i) {
    walker.advance({0, 1}, 1.0, 0.01);
    const double y = walker.head().position_m.y;
    EXPECT_LE(std::abs(y - last_y), 0.05);
    last_y = y;
  }
  EXPECT_NEAR(last_y, 1.0 + kEyeHeight_m, 0.01);
  EXPECT_GT(walker.head().position_m.z, 0.5);
}

TEST(FloorWalker, TeleportsInTheDark) {
  const FloorMap floor = make_floor({4, 4}, [](double, double) { return 0.0; });
  FloorWalker walker(floor, eye_at(1, 1));
  walker.teleport({3, 0, 3});
  float darkest = 0.0f;
  for (int i = 0; i < 60; ++i) {
    const glm::dvec3 before = walker.head().position_m;
    walker.advance({0, 0}, 1.0, 0.01);
    if (walker.head().position_m != before) {
      EXPECT_GT(walker.fade(), 0.9f);
    }
    darkest = std::max(darkest, walker.fade());
  }
  EXPECT_GE(darkest, 0.99f);
  EXPECT_EQ(walker.fade(), 0.0f);
  EXPECT_NEAR(glm::distance(walker.head().position_m, glm::dvec3(3, kEyeHeight_m, 3)), 0.0, 1e-6);
}

TEST(FloorUnderRay, FindsTheFloorInViewAndNothingBehindWalls) {
  const FloorMap floor = make_floor({4, 4}, two_rooms);
  const glm::dvec3 eye(1, kEyeHeight_m, 1);
  const auto near = floor_under_ray(floor, eye, {0, -1.6, 0.5});
  ASSERT_TRUE(near);
  EXPECT_NEAR(near->z, 1.5, 0.03);
  EXPECT_FALSE(floor_under_ray(floor, eye, {0, -1.6, 2.0}));  // the floor beyond the wall
  EXPECT_FALSE(floor_under_ray(floor, eye, {0, 0.2, 1}));     // the ceiling
  EXPECT_FALSE(floor_under_ray(floor, eye, {0, 0, 0}));
  const auto through_door = floor_under_ray(floor, {3.4, kEyeHeight_m, 1}, {0, -1.6, 2.0});
  ASSERT_TRUE(through_door);
  EXPECT_NEAR(through_door->z, 3.0, 0.03);
}

TEST(ClearWay, EndsAtWallsAndGoesThroughDoors) {
  const FloorMap floor = make_floor({4, 4}, two_rooms);
  const glm::dvec3 eye(1, kEyeHeight_m, 1);
  EXPECT_TRUE(is_clear_way(floor, eye, eye));
  EXPECT_TRUE(is_clear_way(floor, eye, {3.4, 1.2, 1.2}));
  EXPECT_FALSE(is_clear_way(floor, eye, {1, 1.3, 3})) << "a hand held through the wall";
  EXPECT_FALSE(is_clear_way(floor, {1, 1.3, 3}, eye));
  EXPECT_TRUE(is_clear_way(floor, {3.4, kEyeHeight_m, 1}, {3.4, 1.3, 3})) << "through the door";
  const FloorMap with_table = make_floor({4, 4}, [](double x, double z) { return x > 2 && x < 3 && z > 2 && z < 3 ? NAN : 0.0; });
  EXPECT_FALSE(is_clear_way(with_table, {1, kEyeHeight_m, 2.5}, {3.5, 1.3, 2.5})) << "columns cannot tell a table from a wall";
  EXPECT_TRUE(is_clear_way(FloorMap{}, eye, {1, 1.3, 30})) << "without a floor nothing is known to be in the way";
}

TEST(WallFade, DarkensAndComesBackGradually) {
  WallFade fade;
  fade.advance(false, WallFade::kFade_s / 2);
  EXPECT_NEAR(fade.darkness(), 0.5f, 1e-5f);
  fade.advance(false, 1.0);
  EXPECT_EQ(fade.darkness(), 1.0f);
  fade.advance(true, WallFade::kFade_s / 2);
  EXPECT_NEAR(fade.darkness(), 0.5f, 1e-5f);
}

TEST(Rig, PutsTheWearersHeadWhereItShallBe) {
  const glm::dvec3 head_m(0.4, 1.7, -0.3);
  const Rig rig = Rig::with_head_at({5, 2, 6}, 1.0, head_m, 0.25);
  const glm::dvec3 world = rig.world_from_rig(head_m);
  EXPECT_NEAR(glm::distance(world, glm::dvec3(5, 3.7, 6)), 0.0, 1e-12);
  const Pose pose = pose_of(world, rig.world_from_rig(orientation_of(0.25, 0.1)));
  EXPECT_NEAR(pose.yaw_rad, 1.0, 1e-12);
  EXPECT_NEAR(pose.pitch_rad, 0.1, 1e-12);
  const Rig there = rig.teleported({1, 0, 1}, head_m);
  EXPECT_NEAR(glm::distance(there.world_from_rig(head_m), glm::dvec3(1, 1.7, 1)), 0.0, 1e-12);
  EXPECT_EQ(there.yaw_rad, rig.yaw_rad);
}

TEST(FramePacer, KeepsToItsTicksAndSkipsThoseItMissed) {
  FramePacer pacer(100);
  const auto first = pacer.next(1000);
  EXPECT_EQ(first.wake_ns, 1000);
  EXPECT_EQ(first.predicted_display_ns, 1100);
  const auto early = pacer.next(1040);  // finished early: waits for its tick
  EXPECT_EQ(early.wake_ns, 1100);
  EXPECT_EQ(early.predicted_display_ns, 1200);
  const auto late = pacer.next(1230);  // late by less than a tick: begins at once, reaches the next tick
  EXPECT_EQ(late.wake_ns, 1230);
  EXPECT_EQ(late.predicted_display_ns, 1300);
  const auto very_late = pacer.next(1570);
  EXPECT_EQ(very_late.wake_ns, 1570);
  EXPECT_EQ(very_late.predicted_display_ns, 1600);
}

// Frames every `step` refreshes of the headset, its refreshes as long as the window's: how many pictures are taken.
int pictures_taken(MirrorPacer& pacer, std::int64_t& now_ns, int frames, int step) {
  constexpr std::int64_t kRefresh_ns = 10'000'000;
  int taken = 0;
  for (int k = 0; k < frames; ++k) {
    now_ns += step * kRefresh_ns;
    taken += pacer.next(now_ns, now_ns + kRefresh_ns, kRefresh_ns) == MirrorPacer::Turn::kTaken;
  }
  return taken;
}

TEST(MirrorPacer, TakesEveryRefreshUntilTheHeadsetIsLateAndAgainAfterwards) {
  MirrorPacer pacer(10'000'000);
  std::int64_t now_ns = 5'000'000'000;
  EXPECT_EQ(pictures_taken(pacer, now_ns, 100, 1), 100);
  const int late = pictures_taken(pacer, now_ns, 100, 2);  // two seconds
  EXPECT_GE(late, 7) << "the window still moves";
  EXPECT_LE(late, 10);
  pictures_taken(pacer, now_ns, 40, 1);
  EXPECT_EQ(pictures_taken(pacer, now_ns, 100, 1), 100);
}

TEST(MirrorPacer, IsNotDueBeforeTheWindowRefreshes) {
  MirrorPacer pacer(10'000'000);
  EXPECT_EQ(pacer.next(50'000'000, 60'000'000, 5'000'000), MirrorPacer::Turn::kTaken);
  EXPECT_EQ(pacer.next(55'000'000, 65'000'000, 5'000'000), MirrorPacer::Turn::kNotDue);
  EXPECT_EQ(pacer.next(61'000'000, 70'000'000, 5'000'000), MirrorPacer::Turn::kTaken);
  // The headset has missed a refresh; the next picture would be due, but it waits twice as long.
  EXPECT_EQ(pacer.next(71'000'000, 80'000'000, 5'000'000), MirrorPacer::Turn::kSkipped);
}

TEST(WindowLayout, KeepsTheEyesShapeAndCentresThem) {
  const auto exact = window_layout(ShownEyes::kBoth, {320, 240}, {640, 240});
  ASSERT_EQ(exact.size(), 2u);
  EXPECT_EQ(exact[0].extent.width, 320u);
  EXPECT_EQ(exact[1].offset.x, 320);
  EXPECT_EQ(exact[1].offset.y, 0);
  const auto tall = window_layout(ShownEyes::kRight, {320, 240}, {640, 960});
  ASSERT_EQ(tall.size(), 1u);
  EXPECT_EQ(tall[0].view, 1u);
  EXPECT_EQ(tall[0].extent.width, 640u);
  EXPECT_EQ(tall[0].extent.height, 480u);
  EXPECT_EQ(tall[0].offset.y, 240);
  for (const VkExtent2D window : {VkExtent2D{1, 1}, VkExtent2D{3, 1000}, VkExtent2D{4000, 2}}) {
    for (const ShownView& shown : window_layout(ShownEyes::kBoth, {320, 240}, window)) {
      EXPECT_GE(shown.offset.x, 0);
      EXPECT_GE(shown.extent.width, 1u);
      EXPECT_LE(shown.offset.y + shown.extent.height, std::max(1u, window.height));
    }
  }
}

TEST(WindowLayout, FindsTheViewUnderAClick) {
  const VkExtent2D window{640, 480};
  const auto layout = window_layout(ShownEyes::kBoth, {320, 240}, window);
  const auto place = view_under(layout, window, {0.75, 0.5});
  ASSERT_TRUE(place);
  EXPECT_EQ(place->view, 1u);
  EXPECT_NEAR(place->place.x, 0.5, 1e-9);
  EXPECT_NEAR(place->place.y, 0.5, 1e-9);
  EXPECT_FALSE(view_under(layout, window, {0.5, 0.01}));  // in the black above
}

}  // namespace
}  // namespace probewalk
