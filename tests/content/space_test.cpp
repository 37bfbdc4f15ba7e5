#include "content/scene/space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "content/box_scene.h"
#include "content/error.h"

namespace probewalk {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Space find(const Scene& scene, const SpaceOptions& options = {}) {
  const RayScene rays(scene);
  SilentProgress progress;
  return find_space(scene, rays, options, progress);
}

double floor_area_m2(const Space& space) {
  return double(space.floor.nodes.size()) * space.floor.cell_m * space.floor.cell_m;
}

// Least distance to a surface in 26 directions, at most 1 m.
double clearance_m(const RayScene& rays, glm::dvec3 point) {
  double least = 1.0;
  for (int code = 0; code < 27; ++code) {
    if (code == 13) continue;
    const glm::vec3 direction = glm::normalize(glm::vec3(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1));
    const SurfaceHit hit = rays.closest(glm::vec3(point), direction);
    if (hit.hit) least = std::min(least, double(hit.t));
  }
  return least;
}

bool finite(const Pose& pose) {
  return std::isfinite(pose.position_m.x) && std::isfinite(pose.position_m.y) && std::isfinite(pose.position_m.z) &&
         std::isfinite(pose.yaw_rad) && std::isfinite(pose.pitch_rad);
}

void expect_tour_is_walkable(const Scene& scene, const Space& space) {
  const RayScene rays(scene);
  for (std::size_t i = 0; i < space.tour.size(); ++i) {
    const Pose& pose = space.tour[i];
    ASSERT_TRUE(finite(pose)) << i;
    ASSERT_GE(clearance_m(rays, pose.position_m), 0.15) << "pose " << i;
    ASSERT_GE(space.floor.find(pose.position_m), 0) << "pose " << i;
    if (i == 0) continue;
    const glm::dvec3 before = space.tour[i - 1].position_m;
    ASSERT_LT(glm::distance(before, pose.position_m), 0.4) << "pose " << i;
    ASSERT_FALSE(rays.occluded(glm::vec3(before), glm::vec3(pose.position_m - before), 0.0f, 1.0f)) << "pose " << i;
    ASSERT_LT(std::abs(std::remainder(pose.yaw_rad - space.tour[i - 1].yaw_rad, 2 * M_PI)), 0.8) << "pose " << i;
  }
}

BoxScene two_rooms() {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 8}).wall_with_door(0, 4, 4, 2.5f, 1.0f, 1.9f);
  return boxes;
}

TEST(Space, ABoxRoomIsOneRoomWithItsWholeFloor) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {5, 2.6f, 4});
  boxes.scene.name = "box";
  const Space space = find(boxes.scene);
  EXPECT_NEAR(floor_area_m2(space), 20.0, 1.0);
  ASSERT_THAT(space.rooms, SizeIs(1));
  EXPECT_EQ(space.rooms[0].id, "room");
  EXPECT_EQ(space.rooms[0].name, "box");
  EXPECT_NEAR(space.rooms[0].bounds.lower_m.x, 0.0, 1e-6);
  EXPECT_NEAR(space.rooms[0].bounds.upper_m.z, 4.0, 1e-6);
  EXPECT_NEAR(space.start.position_m.y, 1.6, 1e-6);
  EXPECT_NEAR(space.start.position_m.z, 2.0, 0.1);
  EXPECT_THAT(space.portals, IsEmpty());
  EXPECT_THAT(space.warnings, IsEmpty());
  expect_tour_is_walkable(boxes.scene, space);
}

TEST(Space, FindsTheFloorUnderAHeadAndUnderFeet) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 4}).room({0, 3, 0}, {4, 5.5f, 4});
  const Space space = find(boxes.scene);
  const auto floor_at = [&](glm::dvec3 p) {
    const std::int32_t node = space.floor.find(p);
    return node < 0 ? -1.0f : space.floor.nodes[node].floor_m;
  };
  EXPECT_FLOAT_EQ(floor_at({2, 1.6, 2}), 0.0f);
  EXPECT_FLOAT_EQ(floor_at({2, 0.0, 2}), 0.0f);
  EXPECT_FLOAT_EQ(floor_at({2, -1.0, 2}), -1.0f);
  EXPECT_FLOAT_EQ(floor_at({9, 1.6, 2}), -1.0f);
  EXPECT_FLOAT_EQ(floor_at({std::nan(""), 1.6, 2}), -1.0f);
}

TEST(Space, AuthoredRoomsMeetInAPortalOfTheDoorsSize) {
  BoxScene boxes = two_rooms();
  boxes.authored_room("south", {0, 0, 0}, {4, 2.5, 4}).authored_room("north", {0, 0, 4}, {4, 2.5, 8});
  const Space space = find(boxes.scene);
  ASSERT_THAT(space.rooms, SizeIs(2));
  EXPECT_EQ(space.rooms[1].id, "north");
  ASSERT_THAT(space.portals, SizeIs(1));
  const Portal& portal = space.portals[0];
  EXPECT_EQ(portal.room_a, 0);
  EXPECT_EQ(portal.room_b, 1);
  ASSERT_THAT(portal.polygon, SizeIs(4));
  EXPECT_NEAR(glm::distance(portal.polygon[0], portal.polygon[1]), 0.9, 0.11);
  EXPECT_NEAR(portal.polygon[0].z, 4.0, 0.06);
  EXPECT_NEAR(portal.polygon[0].y, 0.0, 1e-5);
  EXPECT_NEAR(portal.polygon[2].y, 2.0, 1e-5);
  std::set<int> visited;
  for (const Pose& pose : space.tour) visited.insert(space.floor.nodes[space.floor.find(pose.position_m)].room);
  EXPECT_THAT(visited, ElementsAre(0, 1)) << "the tour goes through the door";
  expect_tour_is_walkable(boxes.scene, space);
}

TEST(Space, TheTourKeepsToTheMiddleOfANarrowDoor) {
  const Scene scene = two_rooms().scene;
  const Space space = find(scene);
  int in_door = 0;
  for (const Pose& pose : space.tour) {
    if (std::abs(pose.position_m.z - 4.0) > 0.14) continue;  // a pose every 0.25 m
    ++in_door;
    EXPECT_NEAR(pose.position_m.x, 1.45, 0.12);
  }
  EXPECT_GT(in_door, 0);
}

TEST(Space, StairsJoinStoreys) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {10, 6, 4});
  boxes.solid({6, 2.3f, 0}, {10, 2.5f, 4});
  for (int step = 0; step < 14; ++step) {
    const float x = 2.5f + 0.25f * float(step);
    boxes.solid({x, 0, 1}, {6, 2.5f * float(step + 1) / 14.0f, 2.2f});
  }
  const Space space = find(boxes.scene);
  double highest = 0.0;
  for (const Pose& pose : space.tour) highest = std::max(highest, pose.position_m.y);
  EXPECT_NEAR(highest, 2.5 + 1.6, 0.1) << "the tour climbs the stair";
  expect_tour_is_walkable(boxes.scene, space);
}

TEST(Space, AOneMetreLedgeSeparatesParts) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {12, 4, 5}).solid({7, 0, 0}, {12, 1, 5});
  const Space space = find(boxes.scene);
  const std::int32_t below = space.floor.find({3, 1.6, 2.5});
  const std::int32_t above = space.floor.find({10, 2.6, 2.5});
  ASSERT_GE(below, 0);
  ASSERT_GE(above, 0) << "seen from the start part, so part of the space";
  for (const Pose& pose : space.tour) EXPECT_LT(pose.position_m.x, 7.0) << "but nobody can walk there";
  SpaceOptions on_the_ledge;
  on_the_ledge.start_m = glm::dvec3(10, 1, 2.5);
  const Space other = find(boxes.scene, on_the_ledge);
  EXPECT_NEAR(other.start.position_m.x, 10.0, 0.05);
  EXPECT_NEAR(other.start.position_m.y, 2.6, 1e-5);
  for (const Pose& pose : other.tour) EXPECT_GT(pose.position_m.x, 7.0);
}

TEST(Space, FurnitureDoesNotKillARoomNorBecomeOne) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {5, 3, 5});
  boxes.solid({0, 0, 0}, {2.2f, 0.5f, 2.0f});   // a bed
  boxes.solid({3, 0.7f, 2}, {4.2f, 0.75f, 3});  // a table top
  boxes.solid({4.5f, 0, 0}, {5, 2, 2});         // a wardrobe
  const Space space = find(boxes.scene);
  EXPECT_GT(floor_area_m2(space), 14.0);
  EXPECT_LT(space.floor.find({1, 2.0, 1}), 0) << "nobody walks on the bed";
  EXPECT_LT(space.floor.find({3.6, 1.6, 2.5}), 0) << "nor through the table";
  expect_tour_is_walkable(boxes.scene, space);
}

TEST(Space, TheInsideOfAWardrobeIsNotAPlaceToBe) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {5, 2.5f, 5}).authored_room("only", {0, 0, 0}, {5, 2.5, 5});
  boxes.solid({0, 0, 0}, {1.2f, 2.2f, 0.05f}).solid({0, 0, 1.15f}, {1.2f, 2.2f, 1.2f});
  boxes.solid({0, 0, 0}, {0.05f, 2.2f, 1.2f})
      .solid({1.15f, 0, 0}, {1.2f, 2.2f, 1.2f})
      .solid({0, 2.15f, 0}, {1.2f, 2.2f, 1.2f});
  const Space space = find(boxes.scene);
  EXPECT_GE(space.floor.find({3, 1.6, 3}), 0);
  EXPECT_LT(space.floor.find({0.6, 1.6, 0.6}), 0);
}

TEST(Space, AClosedVoidInASlabIsNotAPlaceToBe) {
  BoxScene boxes;
  // A room, and under it a larger hollow slab that shows its inside only back faces.
  boxes.room({0, 0, 0}, {5, 2.5f, 5}).solid({-6, -2.6f, -6}, {11, -0.3f, 11});
  boxes.solid({1, 0, 1}, {1.5f, 0.8f, 1.5f}).solid({3, 0, 3}, {3.5f, 0.8f, 4}).solid({3, 1.5f, 0}, {4, 1.8f, 0.3f});
  for (int i = 0; i < 6; ++i) boxes.solid({0.2f + 0.3f * float(i), 1, 4.7f}, {0.4f + 0.3f * float(i), 1.4f, 5});
  const Space space = find(boxes.scene);
  EXPECT_NEAR(space.start.position_m.y, 1.6, 1e-5);
  EXPECT_LT(space.floor.find({8, -1.0, 8}), 0);
}

TEST(Space, WithoutFloorTheWalkerHoversAndIsTold) {
  BoxScene boxes;
  boxes.solid({-0.3f, 0, -0.3f}, {0.3f, 0.5f, 0.3f});
  const Space space = find(boxes.scene);
  EXPECT_THAT(space.floor.nodes, IsEmpty());
  ASSERT_THAT(space.rooms, SizeIs(1));
  ASSERT_THAT(space.warnings, SizeIs(1));
  EXPECT_THAT(space.warnings[0], HasSubstr("no walkable floor"));
  ASSERT_GE(space.tour.size(), 8u);
  for (const Pose& pose : space.tour) {
    EXPECT_TRUE(finite(pose));
    EXPECT_EQ(pose.position_m, space.start.position_m);
  }
}

TEST(Space, AnEmptySceneStillHasAStart) {
  Scene scene;
  const Space space = find(scene);
  ASSERT_THAT(space.rooms, SizeIs(1));
  EXPECT_TRUE(finite(space.start));
  EXPECT_FALSE(space.tour.empty());
  EXPECT_TRUE(std::isfinite(space.rooms[0].bounds.lower_m.x));
}

TEST(Space, ABoundlessPlainStaysWithinMemory) {
  BoxScene boxes;
  boxes.floor({-3000, -3000}, {3000, 3000}, 0.0f).solid({-2, 0, -2}, {-1, 1, 2}).solid({2, 0, -2}, {3, 2, 2});
  for (int i = 0; i < 10; ++i) boxes.solid({0.3f * float(i), 0, 6}, {0.2f + 0.3f * float(i), 1, 6.2f});
  const Space space = find(boxes.scene);
  EXPECT_LE(double(space.floor.columns.x) * space.floor.columns.y, 0.8e6);
  EXPECT_LE(space.floor.cell_m, 0.1) << "the bulk of the triangles is a house of ordinary size";
  EXPECT_LT(std::abs(space.start.position_m.x), 20.0);
  expect_tour_is_walkable(boxes.scene, space);
}

TEST(Space, BrokenCornersDoNoHarm) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 4});
  boxes.floor({0, 0}, {1, 1}, 1.0f);
  boxes.scene.positions_m.back().x = std::numeric_limits<float>::quiet_NaN();
  const Space space = find(boxes.scene);
  EXPECT_TRUE(finite(space.start));
  for (const Pose& pose : space.tour) EXPECT_TRUE(finite(pose));
}

TEST(Space, TheSameSceneGivesTheSameSpace) {
  const Scene scene = two_rooms().scene;
  const Space a = find(scene);
  const Space b = find(scene);
  ASSERT_EQ(a.tour.size(), b.tour.size());
  for (std::size_t i = 0; i < a.tour.size(); ++i) {
    EXPECT_EQ(a.tour[i].position_m, b.tour[i].position_m);
    EXPECT_EQ(a.tour[i].yaw_rad, b.tour[i].yaw_rad);
  }
  EXPECT_EQ(a.floor.nodes.size(), b.floor.nodes.size());
}

class CancelledProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void note(std::string_view) override {}
  bool cancelled() const override { return true; }
};

TEST(Space, StopsWhenAsked) {
  const Scene scene = two_rooms().scene;
  const RayScene rays(scene);
  CancelledProgress progress;
  EXPECT_THROW(find_space(scene, rays, {}, progress), Interrupted);
}

}  // namespace
}  // namespace probewalk
