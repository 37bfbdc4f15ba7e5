// Portals that are seen through and not walked: galleries, stair wells, balconies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <set>
#include <string>

#include "content/box_scene.h"
#include "content/pack/file_io.h"
#include "content/scene/procedural/procedural.h"
#include "content/scene/space.h"

namespace probewalk {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

Space find(const Scene& scene, double voxel_m = 0.05) {
  const RayScene rays(scene);
  SilentProgress progress;
  return find_space(scene, rays, {voxel_m, std::nullopt}, progress);
}

std::vector<Portal> drops_of(const Space& space) {
  std::vector<Portal> drops;
  std::ranges::copy_if(space.portals, std::back_inserter(drops), [](const Portal& portal) { return !portal.walked; });
  return drops;
}
std::size_t walked_of(const Space& space) { return space.portals.size() - drops_of(space).size(); }

double width_m(const Portal& portal) { return glm::distance(portal.polygon[0], portal.polygon[1]); }

// A hall of 10 x 4 m, its eastern end under an upper floor at 2.5 m, a stair up to that in the middle.
BoxScene hall_with_gallery() {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {10, 6, 4}).solid({6, 2.3f, 0}, {10, 2.5f, 4});
  for (int step = 0; step < 14; ++step) {
    boxes.solid({2.5f + 0.25f * float(step), 0, 1}, {6, 2.5f * float(step + 1) / 14.0f, 2.2f});
  }
  boxes.authored_room("gallery", {6, 2.5, 0}, {10, 6, 4}).authored_room("hall", {0, 0, 0}, {10, 6, 4});
  return boxes;
}

// Two storeys of 8 x 8 m, one over the other, with a hole of 3 x 2 m between.
BoxScene stair_well() {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {8, 5.4f, 8});
  boxes.solid({0, 2.6f, 0}, {8, 2.8f, 3}).solid({0, 2.6f, 5}, {8, 2.8f, 8});
  boxes.solid({0, 2.6f, 3}, {2, 2.8f, 5}).solid({5, 2.6f, 3}, {8, 2.8f, 5});
  boxes.authored_room("up", {0, 2.8, 0}, {8, 5.4, 8}).authored_room("down", {0, 0, 0}, {8, 2.6, 8});
  return boxes;
}

// Where the segment goes through the rectangle, a little enlarged.
bool goes_through(const Portal& portal, glm::dvec3 from, glm::dvec3 to) {
  constexpr double kMargin_m = 0.12;
  const glm::dvec3 a = portal.polygon[0], u = portal.polygon[1] - a, v = portal.polygon[3] - a;
  const glm::dvec3 normal = glm::cross(u, v);
  const double start = glm::dot(from - a, normal), end = glm::dot(to - a, normal);
  if (start * end > 0.0) return false;
  const glm::dvec3 at = from + (to - from) * (start / (start - end)) - a;
  const double along = glm::dot(at, u) / glm::length(u), up = glm::dot(at, v) / glm::length(v);
  return along > -kMargin_m && along < glm::length(u) + kMargin_m && up > -kMargin_m && up < glm::length(v) + kMargin_m;
}

// Of heads in two different rooms that see each other, the share that do so through a portal of the first one's.
double seen_through_portals(const Scene& scene, const Space& space) {
  const RayScene rays(scene);
  std::mt19937 dice(7);
  int seen = 0, through = 0;
  for (int k = 0; k < 200'000; ++k) {
    const FloorNode& a = space.floor.nodes[dice() % space.floor.nodes.size()];
    const FloorNode& b = space.floor.nodes[dice() % space.floor.nodes.size()];
    if (a.room == b.room) continue;
    const auto head = [&](const FloorNode& node) {
      const glm::dvec2 at = space.floor.origin_m + space.floor.cell_m * (glm::dvec2(node.ix, node.iz) + 0.5);
      return glm::dvec3(at.x, node.floor_m + 1.5, at.y);
    };
    const glm::dvec3 from = head(a), to = head(b);
    if (rays.occluded(glm::vec3(from), glm::vec3(to - from), 0.0f, 1.0f)) continue;
    ++seen;
    through += std::ranges::any_of(space.portals, [&](const Portal& portal) {
      return (portal.room_a == a.room || portal.room_b == a.room) && goes_through(portal, from, to);
    });
  }
  EXPECT_GT(seen, 100);
  return double(through) / seen;
}

TEST(DropPortals, AGallerySeesTheHallBesideItsStair) {
  const BoxScene boxes = hall_with_gallery();
  const Space space = find(boxes.scene);
  EXPECT_EQ(walked_of(space), 1u) << "the head of the stair";
  const std::vector<Portal> drops = drops_of(space);
  ASSERT_THAT(drops, SizeIs(2)) << "the edge on either side of it";
  double wide_m = 0.0;
  for (const Portal& drop : drops) {
    EXPECT_EQ(space.rooms[std::size_t(drop.room_a)].id, "gallery") << "from above";
    EXPECT_EQ(space.rooms[std::size_t(drop.room_b)].id, "hall");
    ASSERT_THAT(drop.polygon, SizeIs(4));
    for (const glm::dvec3& corner : drop.polygon) EXPECT_NEAR(corner.x, 6.0, 0.11);
    EXPECT_NEAR(drop.polygon[0].y, 2.5, 0.01);
    EXPECT_NEAR(drop.polygon[2].y, 6.0, 0.01);
    wide_m += width_m(drop);
  }
  EXPECT_NEAR(wide_m, 2.8, 0.3);
  EXPECT_GT(seen_through_portals(boxes.scene, space), 0.99);
}

TEST(DropPortals, AStairWellHasOneOnEachOfItsSides) {
  const BoxScene boxes = stair_well();
  const Space space = find(boxes.scene);
  EXPECT_EQ(walked_of(space), 0u);
  const std::vector<Portal> drops = drops_of(space);
  ASSERT_THAT(drops, SizeIs(4));
  std::vector<double> widths;
  for (const Portal& drop : drops) {
    EXPECT_EQ(space.rooms[std::size_t(drop.room_a)].id, "up");
    widths.push_back(width_m(drop));
  }
  std::ranges::sort(widths);
  EXPECT_NEAR(widths[0], 2.0, 0.25);
  EXPECT_NEAR(widths[1], 2.0, 0.25);
  EXPECT_NEAR(widths[2], 3.0, 0.25);
  EXPECT_NEAR(widths[3], 3.0, 0.25);
  EXPECT_GT(seen_through_portals(boxes.scene, space), 0.99);
}

TEST(DropPortals, ARailIsLookedOverAndAParapetIsNot) {
  const auto fence = [](BoxScene& boxes, float height) {
    boxes.solid({1.9f, 2.8f, 2.9f}, {5.1f, 2.8f + height, 3}).solid({1.9f, 2.8f, 5}, {5.1f, 2.8f + height, 5.1f});
    boxes.solid({1.9f, 2.8f, 3}, {2, 2.8f + height, 5}).solid({5, 2.8f, 3}, {5.1f, 2.8f + height, 5});
  };
  BoxScene rail = stair_well();
  fence(rail, 1.0f);
  const Space space = find(rail.scene);
  EXPECT_THAT(drops_of(space), SizeIs(4));
  EXPECT_GT(seen_through_portals(rail.scene, space), 0.99);
  BoxScene parapet = stair_well();
  fence(parapet, 2.2f);
  EXPECT_THAT(drops_of(find(parapet.scene)), IsEmpty());
}

TEST(DropPortals, AClosedFloorAndACrackHaveNone) {
  BoxScene closed = stair_well();
  closed.solid({2, 2.6f, 3}, {5, 2.8f, 5});
  EXPECT_THAT(drops_of(find(closed.scene)), IsEmpty());
  BoxScene cracked = stair_well();
  cracked.solid({2, 2.6f, 3}, {5, 2.8f, 4.8f});
  EXPECT_THAT(drops_of(find(cracked.scene)), IsEmpty()) << "0.2 m are no opening";
}

TEST(DropPortals, ABalconyHighOverACourtSeesIt) {
  BoxScene boxes;
  boxes.floor({0, 0}, {10, 10}, 0).solid({0, 0, 10}, {10, 12, 10.3f}).solid({3, 8.8f, 8}, {7, 9, 10});
  boxes.authored_room("balcony", {3, 9, 8}, {7, 12, 10}).authored_room("court", {0, 0, 0}, {10, 8.8, 10});
  const std::vector<Portal> drops = drops_of(find(boxes.scene));
  ASSERT_THAT(drops, SizeIs(3)) << "a side for each but that on the wall";
  for (const Portal& drop : drops) EXPECT_NEAR(drop.polygon[0].y, 9.0, 0.01);
}

TEST(DropPortals, ARoundHoleIsSeenThroughAllAround) {
  BoxScene boxes;  // a disc of slabs is left out of the upper floor
  boxes.room({0, 0, 0}, {8, 5.4f, 8});
  constexpr float kStrip_m = 0.1f;
  for (int k = 0; k < 80; ++k) {
    const float z = kStrip_m * float(k), off = z + 0.5f * kStrip_m - 4.0f;
    const float half = off * off < 4.0f ? std::sqrt(4.0f - off * off) : 0.0f;
    boxes.solid({0, 2.6f, z}, {4 - half, 2.8f, z + kStrip_m}).solid({4 + half, 2.6f, z}, {8, 2.8f, z + kStrip_m});
  }
  boxes.authored_room("up", {0, 2.8, 0}, {8, 5.4, 8}).authored_room("down", {0, 0, 0}, {8, 2.6, 8});
  const Space space = find(boxes.scene);
  EXPECT_GE(drops_of(space).size(), 4u);
  EXPECT_LE(drops_of(space).size(), 12u);
  EXPECT_GT(seen_through_portals(boxes.scene, space), 0.97);
}

TEST(DropPortals, AreTheSameEachTime) {
  const BoxScene boxes = hall_with_gallery();
  const Space a = find(boxes.scene), b = find(boxes.scene);
  ASSERT_EQ(a.portals.size(), b.portals.size());
  for (std::size_t k = 0; k < a.portals.size(); ++k) EXPECT_EQ(a.portals[k].polygon, b.portals[k].polygon);
}

TEST(DropPortals, TheHousesLandingLooksDownItsStairwell) {
  const std::filesystem::path folder = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / "drop_portals";
  std::filesystem::create_directories(folder);
  write_file_whole(folder / "house.glb", make_procedural_glb("house"));
  const Scene scene = load_scene(folder / "house.glb");
  const Space space = find(scene);
  const auto name = [&](int room) { return space.rooms[std::size_t(room)].name; };
  double landing_m = 0.0;
  for (const Portal& drop : drops_of(space)) {
    if (std::set{name(drop.room_a), name(drop.room_b)} != std::set<std::string>{"Landing", "Stairwell"}) continue;
    landing_m += width_m(drop);
    for (const glm::dvec3& corner : drop.polygon) {  // around the void
      EXPECT_GT(corner.x, 9.2);
      EXPECT_LT(corner.z, 3.7);
    }
  }
  EXPECT_GT(landing_m, 2.0);
  EXPECT_GT(seen_through_portals(scene, space), 0.9);
}

}  // namespace
}  // namespace probewalk
