#include "xr/locomotion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/floors.h"
#include "xr/desktop_head.h"
#include "xr/frame_pacer.h"
#include "xr/mirror_pacer.h"
#include "xr/path.h"
#include "xr/window_layout.h"

namespace probewalk {
namespace {

using test::eye_at;
using test::make_floor;
using test::r2_point;
using test::two_cells;
using test::two_rooms;

constexpr double kPi = std::numbers::pi;

// Somebody at a desktop: the head stands in the middle of its rig.
struct Person {
  Person(const FloorMap& floor, const Pose& start, const LocomotionOptions& options = {})
      : locomotion(floor, options), head(options.eye_height_m, start.pitch_rad) {
    locomotion.place(start, head.pose(), {});
  }
  void walk(glm::dvec2 wish, double seconds) {
    MoveInput input;
    input.wish = wish;
    input.speed_m_s = 1.0;
    for (double t = 0; t < seconds; t += 0.01) locomotion.advance(head.pose(), input, 0.01);
  }
  void press(const MoveInput& input) {
    locomotion.advance(head.pose(), input, 0.01);
    for (int i = 0; i < 60; ++i) locomotion.advance(head.pose(), {}, 0.01);
  }
  Pose eye() const { return head.in_world(locomotion.rig()); }

  Locomotion locomotion;
  DesktopHead head;
};

TEST(Locomotion, WalksForwardAlongItsYaw) {
  const FloorMap floor = make_floor({4, 4}, [](double, double) { return 0.0; });
  Person ahead(floor, eye_at(2, 3));
  ahead.walk({0, 1}, 1.0);
  EXPECT_NEAR(ahead.eye().position_m.z, 2.0, 0.03);
  EXPECT_NEAR(ahead.eye().position_m.x, 2.0, 1e-9);
  Person left(floor, eye_at(2, 3, kPi / 2));
  left.walk({0, 1}, 1.0);
  EXPECT_NEAR(left.eye().position_m.x, 1.0, 0.03);
  Person diagonal(floor, eye_at(2, 3));
  diagonal.walk({1, 1}, 1.0);  // two keys are not faster than one
  EXPECT_NEAR(glm::distance(diagonal.eye().position_m, glm::dvec3(2, kEyeHeight_m, 3)), 1.0, 0.03);
}

TEST(Locomotion, GoesWhereTheHeadLooksAtTheStatedSpeed) {
  const FloorMap floor = make_floor({12, 12}, [](double, double) { return 0.0; });
  for (int i = 0; i < 64; ++i) {
    const glm::dvec2 u = r2_point(i);
    Locomotion locomotion(floor, {});
    const HeadPose head{{u.x - 0.5, 1.7, u.y - 0.5}, 2 * kPi * u.y};
    const double yaw_rad = 2 * kPi * u.x;
    locomotion.place(eye_at(6, 6, yaw_rad), head, {});
    // The head turns by a quarter in its rig: forward is where it looks now.
    const HeadPose turned{head.position_m, head.yaw_rad + kPi / 2};
    const glm::dvec3 before = locomotion.rig().world_from_rig(head.position_m);
    MoveInput input;
    input.wish = {0, 1};
    for (int k = 0; k < 100; ++k) locomotion.advance(turned, input, 0.01);
    const glm::dvec3 way = locomotion.rig().world_from_rig(head.position_m) - before;
    EXPECT_NEAR(way.x, -std::sin(yaw_rad + kPi / 2) * kWalkSpeed_m_s, 1e-6);
    EXPECT_NEAR(way.z, -std::cos(yaw_rad + kPi / 2) * kWalkSpeed_m_s, 1e-6);
  }
}

TEST(Locomotion, HoldsStillForAStickInItsDeadZone) {
  const FloorMap floor = make_floor({4, 4}, [](double, double) { return 0.0; });
  Person person(floor, eye_at(2, 2), {.turn = TurnStyle::kSmooth});
  MoveInput input;
  input.wish = {0.1, -0.1};
  input.turn = 0.12;
  for (int i = 0; i < 100; ++i) person.locomotion.advance(person.head.pose(), input, 0.01);
  EXPECT_EQ(person.eye().position_m, glm::dvec3(2, kEyeHeight_m, 2));
  EXPECT_EQ(person.eye().yaw_rad, 0.0);
}

TEST(Locomotion, IsStoppedByWallsAtABodysWidthAndSlidesAlongThem) {
  const FloorMap floor = make_floor({4, 4}, two_rooms);
  Person person(floor, eye_at(1, 1));
  person.walk({0, -1}, 5.0);
  EXPECT_LT(person.eye().position_m.z, 2.0 - kBodyRadius_m + 0.06);
  EXPECT_GT(person.eye().position_m.z, 1.7);
  const double x = person.eye().position_m.x;
  person.walk({0.7, -0.7}, 1.0);
  EXPECT_GT(person.eye().position_m.x, x + 0.5);
  EXPECT_LT(person.eye().position_m.z, 2.0);
}

TEST(Locomotion, GoesThroughDoors) {
  const FloorMap floor = make_floor({4, 4}, two_rooms);
  Person person(floor, eye_at(3.4, 1));
  person.walk({0, -1}, 2.0);
  EXPECT_NEAR(person.eye().position_m.z, 3.0, 0.1);
}

TEST(Locomotion, GoesThroughWallsOnlyWhenToldTo) {
  const FloorMap floor = make_floor({4, 4}, two_cells);
  Person held(floor, eye_at(1, 1));
  held.walk({0, -1}, 3.0);
  EXPECT_LT(held.eye().position_m.z, 2.0);
  Person ghost(floor, eye_at(1, 1), {.through_walls = true});
  ghost.walk({0, -1}, 2.0);
  EXPECT_NEAR(ghost.eye().position_m.z, 3.0, 0.05);
  EXPECT_NEAR(ghost.eye().position_m.y, kEyeHeight_m, 1e-6);
}

// Whatever sticks, turns, throws and the head itself within reach of its middle do, nobody gets to the other side.
TEST(Locomotion, NeverGetsThroughAWall) {
  const FloorMap floor = make_floor({4, 4}, two_cells);
  for (int run = 0; run < 8; ++run) {
    Locomotion locomotion(floor, {.turn = run % 2 == 0 ? TurnStyle::kSnap : TurnStyle::kSmooth});
    HeadPose head{{0, 1.6, 0}, 0.0};
    locomotion.place(eye_at(2, 1, run), head, {});
    for (int i = 0; i < 500; ++i) {
      const glm::dvec2 u = r2_point(run * 1000 + i), v = r2_point(run * 777 + 3 * i);
      MoveInput input;
      input.wish = 2.0 * u - 1.0;
      input.speed_m_s = kRunSpeed_m_s;
      input.turn = 2.0 * v.x - 1.0;
      const double aim_rad = 2 * kPi * v.y;
      const glm::dvec3 hand = head.position_m + glm::dvec3(0.5 * std::sin(6.3 * u.x), -0.3, 0.5 * std::cos(6.3 * u.x));
      input.aim = AimRay{hand, {std::sin(aim_rad), 2.0 * u.y - 1.0, std::cos(aim_rad)}};
      input.teleport = i % 7 == 0;
      input.recentre = i % 31 == 0;
      locomotion.advance(head, input, 0.25 * v.x);
      const glm::dvec3 at = locomotion.rig().world_from_rig(head.position_m);
      ASSERT_LT(at.z, 2.0) << run << " " << i;
      ASSERT_GT(at.z, 0.0);
      ASSERT_GT(at.x, 0.0);
      ASSERT_LT(at.x, 4.0);
      if (locomotion.aim() != nullptr && locomotion.aim()->landing_m) {
        ASSERT_LT(locomotion.aim()->landing_m->z, 2.0);
      }
    }
  }
}

TEST(Locomotion, BringsBackAHeadThatLeantIntoAWall) {
  const FloorMap floor = make_floor({4, 4}, two_cells);
  Locomotion locomotion(floor, {});
  const HeadPose upright{{0, 1.6, 0}, 0.0};
  locomotion.place(eye_at(2, 1.6), upright, {});
  // Looks along -z and leans backwards, half a metre, into the wall.
  const HeadPose leaning{{0, 1.6, 0.47}, 0.0};
  const auto z_after = [&](double wish) {
    MoveInput input;
    input.wish = {0, wish};
    for (int i = 0; i < 100; ++i) locomotion.advance(leaning, input, 0.01);
    return locomotion.rig().world_from_rig(leaning.position_m).z;
  };
  EXPECT_NEAR(z_after(-1.0), 2.07, 0.001) << "the stick does not push it through";
  EXPECT_LT(z_after(1.0), 1.5) << "but lets it come back";
}

TEST(Locomotion, ClimbsStepsSmoothlyButNoLedge) {
  // Steps of 0.2 m every 0.3 m up to 1 m, and a ledge of 0.6 m at z = 0.5.
  const FloorMap floor = make_floor({2, 6}, [](double, double z) {
    if (z < 0.5) return 1.6;
    return std::clamp(std::floor((4.0 - z) / 0.3) * 0.2, 0.0, 1.0);
  });
  Person person(floor, eye_at(1, 5.5));
  double last_y = person.eye().position_m.y;
  for (int i = 0; i < 800; ++i) {
    person.walk({0, 1}, 0.005);
    const double y = person.eye().position_m.y;
    EXPECT_LE(std::abs(y - last_y), 0.05);
    last_y = y;
  }
  EXPECT_NEAR(last_y, 1.0 + kEyeHeight_m, 0.01);
  EXPECT_GT(person.eye().position_m.z, 0.5);
}

TEST(Locomotion, TurnsAboutTheHead) {
  const FloorMap floor = make_floor({4, 4}, [](double, double) { return 0.0; });
  for (const TurnStyle style : {TurnStyle::kSnap, TurnStyle::kSmooth}) {
    for (int i = 0; i < 256; ++i) {
      const glm::dvec2 u = r2_point(i), v = r2_point(i + 5000);
      LocomotionOptions options;
      options.turn = style;
      options.snap_rad = i % 2 == 0 ? kPi / 6 : kPi / 4;
      options.world_scale = std::exp2(4.0 * v.y - 2.0);
      Locomotion locomotion(floor, options);
      const HeadPose head{{4.0 * u.x - 2.0, 0.8 + u.y, 4.0 * u.y - 2.0}, 2 * kPi * v.x};
      locomotion.place(eye_at(2, 2, 2 * kPi * u.x), head, {});
      const glm::dvec3 before = locomotion.rig().world_from_rig(head.position_m);
      const double yaw_rad = locomotion.rig().yaw_rad;
      MoveInput input;
      input.turn = i % 3 == 0 ? -1.0 : 1.0;
      double turned_rad = 0.0;
      for (int k = 0; k < 50; ++k) {
        locomotion.advance(head, input, 0.011);
        EXPECT_LT(glm::distance(locomotion.rig().world_from_rig(head.position_m), before), 1e-9);
        turned_rad = std::remainder(locomotion.rig().yaw_rad - yaw_rad, 2 * kPi);
      }
      const double wanted = style == TurnStyle::kSnap ? options.snap_rad : kTurnSpeed_rad_s * 50 * 0.011;
      EXPECT_NEAR(turned_rad, -input.turn * wanted, 1e-9) << "right is clockwise; a held stick snaps once";
    }
  }
}

TEST(Locomotion, SnapsAgainOnlyAfterTheStickCameBack) {
  const FloorMap floor = make_floor({4, 4}, [](double, double) { return 0.0; });
  Person person(floor, eye_at(2, 2));
  const auto push = [&](double turn) {
    MoveInput input;
    input.turn = turn;
    person.locomotion.advance(person.head.pose(), input, 0.01);
    return std::lround(glm::degrees(person.eye().yaw_rad));
  };
  EXPECT_EQ(push(0.6), 0);
  EXPECT_EQ(push(0.8), -30);
  EXPECT_EQ(push(0.5), -30);  // trembles about the threshold
  EXPECT_EQ(push(0.9), -30);
  EXPECT_EQ(push(0.1), -30);
  EXPECT_EQ(push(-1.0), 0);
  Person still(floor, eye_at(2, 2), {.turn = TurnStyle::kOff});
  MoveInput input;
  input.turn = 1.0;
  still.press(input);
  EXPECT_EQ(still.eye().yaw_rad, 0.0);
}

TEST(Locomotion, TeleportsInTheDark) {
  const FloorMap floor = make_floor({4, 4}, [](double, double) { return 0.0; });
  Person person(floor, eye_at(1, 1));
  MoveInput input;
  input.aim = AimRay{{0, kEyeHeight_m, 0}, {2, -kEyeHeight_m, 2}, true};
  person.locomotion.advance(person.head.pose(), input, 0.01);
  ASSERT_NE(person.locomotion.aim(), nullptr);
  ASSERT_TRUE(person.locomotion.aim()->landing_m);
  const glm::dvec3 promised = *person.locomotion.aim()->landing_m;
  EXPECT_NEAR(glm::distance(promised, glm::dvec3(3, 0, 3)), 0.0, 0.04);
  EXPECT_EQ(person.locomotion.fade(), 0.0f) << "aiming alone leads nowhere";
  input.teleport = true;
  person.locomotion.advance(person.head.pose(), input, 0.01);
  EXPECT_EQ(person.locomotion.aim(), nullptr);
  float darkest = 0.0f;
  for (int i = 0; i < 60; ++i) {
    const glm::dvec3 before = person.eye().position_m;
    person.locomotion.advance(person.head.pose(), {}, 0.01);
    if (person.eye().position_m != before) {
      EXPECT_GT(person.locomotion.fade(), 0.9f);
    }
    darkest = std::max(darkest, person.locomotion.fade());
  }
  EXPECT_GE(darkest, 0.99f);
  EXPECT_EQ(person.locomotion.fade(), 0.0f);
  EXPECT_NEAR(glm::distance(person.eye().position_m, promised + glm::dvec3(0, kEyeHeight_m, 0)), 0.0, 1e-6)
      << "where the ring was";
}

TEST(Locomotion, TeleportsAWearerWhoStandsBesideTheMiddle) {
  const FloorMap floor = make_floor({6, 6}, [](double, double) { return 0.0; });
  for (int i = 0; i < 64; ++i) {
    const glm::dvec2 u = r2_point(i);
    Locomotion locomotion(floor, {});
    const HeadPose head{{u.x - 0.5, 1.7, u.y - 0.5}, 2 * kPi * u.y};
    locomotion.place(eye_at(3, 3, 2 * kPi * u.x), head, {});
    MoveInput input;
    input.aim = AimRay{head.position_m + glm::dvec3(0.2, -0.4, 0.1), {std::sin(6.3 * u.x), -1.0, std::cos(6.3 * u.x)}};
    locomotion.advance(head, input, 0.01);
    ASSERT_TRUE(locomotion.aim() != nullptr && locomotion.aim()->landing_m);
    const glm::dvec3 promised = *locomotion.aim()->landing_m;
    input.teleport = true;
    locomotion.advance(head, input, 0.01);
    for (int k = 0; k < 60; ++k) locomotion.advance(head, {}, 0.01);
    EXPECT_LT(glm::distance(locomotion.rig().world_from_rig(head.position_m), promised + glm::dvec3(0, 1.7, 0)), 1e-9);
    EXPECT_NEAR(std::remainder(locomotion.rig().yaw_rad + head.yaw_rad - 2 * kPi * u.x, 2 * kPi), 0.0, 1e-9);
  }
}

TEST(Locomotion, KnowsNoWayForAHandThroughAWall) {
  const FloorMap floor = make_floor({4, 4}, two_cells);
  Person person(floor, eye_at(2, 1.7));
  MoveInput input;
  input.aim = AimRay{{0, 1.3, 0.6}, {0, -1, 0.5}};  // the hand is beyond it
  person.locomotion.advance(person.head.pose(), input, 0.01);
  ASSERT_NE(person.locomotion.aim(), nullptr);
  EXPECT_FALSE(person.locomotion.aim()->landing_m);
  input.teleport = true;
  person.press(input);
  EXPECT_EQ(person.eye().position_m, glm::dvec3(2, kEyeHeight_m, 1.7));
}

TEST(Locomotion, RecentresToFreeFloorWhereverTheWearerHasGot) {
  const FloorMap floor = make_floor({4, 4}, two_cells);
  Locomotion locomotion(floor, {});
  const HeadPose middle{{0, 1.6, 0}, 0.0};
  locomotion.place(eye_at(2, 1), middle, {});
  // Walks to the wall by stick, then leans into it; and somebody who was put down inside the wall at first.
  MoveInput back;
  back.wish = {0, -1};
  for (int i = 0; i < 100; ++i) locomotion.advance(middle, back, 0.01);
  const HeadPose leaning{{0.3, 1.5, 0.4}, 1.0};
  MoveInput menu;
  menu.recentre = true;
  locomotion.advance(leaning, menu, 0.01);
  for (int i = 0; i < 60; ++i) locomotion.advance(leaning, {}, 0.01);
  const glm::dvec3 at = locomotion.rig().world_from_rig(leaning.position_m);
  EXPECT_TRUE(can_stand(floor, {at.x, 0, at.z}));
  EXPECT_LT(at.z, 2.0);
  EXPECT_NEAR(at.y, 1.5, 1e-9);

  Person walled(floor, eye_at(2, 2.07));
  walled.press(menu);
  EXPECT_TRUE(can_stand(floor, {walled.eye().position_m.x, 0, walled.eye().position_m.z}));
}

TEST(Locomotion, RecentresToTheSideOneCameFromThoughTheSpaceChangedInTheWall) {
  const FloorMap floor = make_floor({4, 4}, two_cells);
  for (const double side : {-1.0, 1.0}) {
    Locomotion locomotion(floor, {});
    const HeadPose middle{{0, 1.6, 0}, 0.0};
    locomotion.place(eye_at(2, 2 + side), middle, {});
    const HeadPose leaning{{0, 1.6, 0.07 - side}, 0.0};  // the wall is there
    locomotion.advance(leaning, {}, 0.01);
    glm::dvec3 at = locomotion.rig().world_from_rig(leaning.position_m);
    ASSERT_FALSE(can_stand(floor, {at.x, 0, at.z}, 0.0)) << "in the wall";
    // The runtime's own recentring: the same head, told from elsewhere.
    const HeadPose moved{{1, 1.6, 1}, 0.0};
    locomotion.place(locomotion.anchor(leaning), moved, {});
    MoveInput menu;
    menu.recentre = true;
    locomotion.advance(moved, menu, 0.01);
    for (int i = 0; i < 60; ++i) locomotion.advance(moved, {}, 0.01);
    at = locomotion.rig().world_from_rig(moved.position_m);
    EXPECT_TRUE(can_stand(floor, {at.x, 0, at.z}));
    EXPECT_GT(side * (at.z - 2.0), 0.0);
  }
}

TEST(Locomotion, PutsSeatedEyesAtTheStatedHeightAtRestAndAtRecentring) {
  const FloorMap floor = make_floor({4, 4}, [](double, double) { return 2.0; });
  for (const double eye_height_m : {1.2, 1.6}) {
    Locomotion locomotion(floor, {.eye_height_m = eye_height_m});
    HeadPose head{{0.1, 0.0, 0.2}, 0.3};  // the origin is the resting place
    locomotion.place(eye_at(2, 2, 0.0, 2.0), head, {-eye_height_m, false});
    EXPECT_NEAR(locomotion.rig().world_from_rig(head.position_m).y, 2.0 + eye_height_m, 1e-9);
    head.position_m.y = -0.15;  // sinks into the chair
    locomotion.advance(head, {}, 0.01);
    EXPECT_NEAR(locomotion.rig().world_from_rig(head.position_m).y, 2.0 + eye_height_m - 0.15, 1e-9);
    MoveInput menu;
    menu.recentre = true;
    locomotion.advance(head, menu, 0.01);
    for (int i = 0; i < 60; ++i) locomotion.advance(head, {}, 0.01);
    EXPECT_NEAR(locomotion.rig().world_from_rig(head.position_m).y, 2.0 + eye_height_m, 1e-9);
  }
  // A rig whose floor is known keeps it: who kneels stays low.
  Locomotion standing(floor, {});
  const HeadPose kneeling{{0, 0.9, 0}, 0.0};
  standing.place(eye_at(2, 2, 0.0, 2.0), kneeling, {});
  MoveInput menu;
  menu.recentre = true;
  standing.advance(kneeling, menu, 0.01);
  for (int i = 0; i < 60; ++i) standing.advance(kneeling, {}, 0.01);
  EXPECT_NEAR(standing.rig().world_from_rig(kneeling.position_m).y, 2.9, 1e-9);
}

TEST(Locomotion, ScalesTheWearerNotTheFloor) {
  const FloorMap floor = make_floor({40, 40}, [](double, double) { return 1.0; }, 20.0f);
  for (const double scale : {0.5, 1.0, 2.0, 4.0}) {
    LocomotionOptions options;
    options.world_scale = scale;
    Locomotion locomotion(floor, options);
    const HeadPose head{{0.3, 1.7, 0.1}, 0.0};
    locomotion.place(eye_at(20, 20, 0.4, 1.0), head, {});
    const Rig& rig = locomotion.rig();
    EXPECT_NEAR(rig.world_from_rig({0, 0, 0}).y, 1.0, 1e-9) << "the wearer's floor lies on the scene's";
    EXPECT_NEAR(rig.world_from_rig(head.position_m).y, 1.0 + 1.7 * scale, 1e-9);
    EXPECT_NEAR(rig.world_from_rig(head.position_m).x, 20.0, 1e-9);
    const glm::dvec3 half_ipd(0.0315, 0, 0);
    EXPECT_NEAR(
        glm::distance(rig.world_from_rig(head.position_m - half_ipd), rig.world_from_rig(head.position_m + half_ipd)),
        0.063 * scale, 1e-9);
    const HeadPose stepped{head.position_m + glm::dvec3(0, 0, -1), 0.0};
    EXPECT_NEAR(glm::distance(rig.world_from_rig(stepped.position_m), rig.world_from_rig(head.position_m)), scale,
                1e-9);
    MoveInput input;
    input.wish = {0, 1};
    const glm::dvec3 before = rig.world_from_rig(head.position_m);
    for (int i = 0; i < 100; ++i) locomotion.advance(head, input, 0.01);
    EXPECT_NEAR(glm::distance(locomotion.rig().world_from_rig(head.position_m), before), kWalkSpeed_m_s * scale, 1e-6);
  }
}

TEST(Locomotion, StartsOverTheFloorBelowHoweverHighTheHead) {
  const FloorMap floor = make_floor({4, 4}, [](double, double) { return 0.5; });
  for (const double eye_m : {0.9, 1.6, 2.0}) {
    Locomotion locomotion(floor, {});
    Pose anchor = eye_at(2, 2);
    anchor.position_m.y = 0.5 + eye_m;
    locomotion.place(anchor, {{0, eye_m, 0}, 0.0}, {});
    EXPECT_NEAR(locomotion.rig().position_m.y, 0.5, 1e-9) << eye_m;
    EXPECT_NEAR(locomotion.anchor({{0, eye_m, 0}, 0.0}).position_m.y, 0.5 + kEyeHeight_m, 1e-9);
  }
  Locomotion floating(FloorMap{}, {});
  floating.place(eye_at(2, 2), {{0, kEyeHeight_m, 0}, 0.0}, {});
  EXPECT_NEAR(floating.rig().world_from_rig({0, kEyeHeight_m, 0}).y, kEyeHeight_m, 1e-9);
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

TEST(DesktopHead, LooksFurtherThanStraightUpNowhere) {
  DesktopHead head(1.6, 0.0);
  head.look(7.0, 3.0);
  EXPECT_NEAR(head.in_rig().pitch_rad, glm::radians(85.0), 1e-12);
  EXPECT_NEAR(head.in_rig().yaw_rad, 7.0 - 2 * kPi, 1e-12);
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
