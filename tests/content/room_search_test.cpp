// Rooms that nobody named: found where heads' ways narrow.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "content/box_scene.h"
#include "content/pack/file_io.h"
#include "content/scene/procedural/procedural.h"
#include "content/scene/space.h"
#include "content/stream/room_boxes.h"

namespace probewalk {
namespace {

using ::testing::SizeIs;

Space find(const Scene& scene, double voxel_m = 0.05) {
  const RayScene rays(scene);
  SilentProgress progress;
  SpaceOptions options;
  options.voxel_m = voxel_m;
  return find_space(scene, rays, options, progress);
}

int room_under(const Space& space, glm::dvec3 head_m) {
  const std::int32_t node = space.floor.find(head_m);
  return node < 0 ? -1 : space.floor.nodes[node].room;
}

double area_m2(const Space& space, int room) {
  const auto count = std::count_if(space.floor.nodes.begin(), space.floor.nodes.end(),
                                   [&](const FloorNode& node) { return node.room == room; });
  return double(count) * space.floor.cell_m * space.floor.cell_m;
}

void expect_equal(const Space& a, const Space& b) {
  ASSERT_EQ(a.rooms.size(), b.rooms.size());
  ASSERT_EQ(a.portals.size(), b.portals.size());
  for (std::size_t p = 0; p < a.portals.size(); ++p) {
    EXPECT_EQ(a.portals[p].room_a, b.portals[p].room_a);
    EXPECT_EQ(a.portals[p].polygon, b.portals[p].polygon);
  }
  ASSERT_EQ(a.floor.nodes.size(), b.floor.nodes.size());
  for (std::size_t n = 0; n < a.floor.nodes.size(); ++n) ASSERT_EQ(a.floor.nodes[n].room, b.floor.nodes[n].room);
}

TEST(RoomSearch, ADoorPartsTwoRoomsByAQuadOfItsSize) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 8}).wall_with_door(0, 4, 4, 2.5f, 1.0f, 1.9f);
  const Space space = find(boxes.scene);
  ASSERT_THAT(space.rooms, SizeIs(2));
  EXPECT_NE(space.rooms[0].id, space.rooms[1].id);
  EXPECT_NE(room_under(space, {2, 1.6, 2}), room_under(space, {2, 1.6, 6}));
  ASSERT_THAT(space.portals, SizeIs(1));
  const std::vector<glm::dvec3>& quad = space.portals[0].polygon;
  ASSERT_THAT(quad, SizeIs(4));
  EXPECT_NEAR(glm::distance(quad[0], quad[1]), 0.9, 0.11);
  EXPECT_NEAR(quad[0].y, 0.0, 1e-5);
  EXPECT_NEAR(quad[2].y, 2.0, 0.01) << "the lintel";
  for (const glm::dvec3& corner : quad) EXPECT_NEAR(corner.z, 4.0, 0.12);
  std::set<int> visited;
  for (const Pose& pose : space.tour) visited.insert(room_under(space, pose.position_m));
  EXPECT_THAT(visited, SizeIs(2)) << "the tour goes through the door";
  expect_equal(space, find(boxes.scene));
}

TEST(RoomSearch, WhatEndsBelowTheShoulderPartsNothing) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 8}).solid({0, 0, 3.9f}, {2.0f, 1.1f, 4.1f}).solid({3.0f, 0, 3.9f}, {4, 1.1f, 4.1f});
  EXPECT_THAT(find(boxes.scene).rooms, SizeIs(1)) << "a counter with a gap of a metre";
  boxes.solid({0, 0, 3.9f}, {2.0f, 2.5f, 4.1f}).solid({3.0f, 0, 3.9f}, {4, 2.5f, 4.1f});
  EXPECT_THAT(find(boxes.scene).rooms, SizeIs(2)) << "the same as a wall";
}

TEST(RoomSearch, ARoomInTheCornerOfAHallIsNotTheHalls) {
  BoxScene boxes;  // the hall is an L around the bath
  boxes.room({0, 0, 0}, {8, 2.5f, 8}).wall_with_door(0, 3, 3, 2.5f, 1.0f, 1.8f).solid({3, 0, 0}, {3.1f, 2.5f, 3.05f});
  const Space space = find(boxes.scene);
  ASSERT_THAT(space.rooms, SizeIs(2));
  const int bath = room_under(space, {1.5, 1.6, 1.5});
  EXPECT_NEAR(area_m2(space, bath), 9.0, 0.7);
  std::vector<Bounds> bounds;
  for (const RoomRegion& room : space.rooms) bounds.push_back(room.bounds);
  EXPECT_EQ(RoomBoxes(bounds).find({1.5, 1.6, 1.5}), std::uint32_t(bath)) << "though the hall's box holds it too";
}

TEST(RoomSearch, ASmallClosetIsPartOfWhatItOpensTo) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {5, 2.5f, 4})
      .wall_with_door(0, 1.0f, 1.0f, 2.5f, 0.1f, 0.8f)
      .solid({1.0f, 0, 0}, {1.1f, 2.5f, 1.05f});
  const Space space = find(boxes.scene);
  EXPECT_THAT(space.rooms, SizeIs(1));
  EXPECT_GE(room_under(space, {0.5, 1.6, 0.5}), 0);
}

TEST(RoomSearch, ALargeHallIsCutIntoPiecesThatStreamingCanLoad) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {40, 6, 25});
  const Space space = find(boxes.scene, 0.1);
  EXPECT_GE(space.rooms.size(), 7u);
  EXPECT_LE(space.rooms.size(), 16u);
  std::set<int> joined;
  for (const Portal& portal : space.portals) joined.insert({portal.room_a, portal.room_b});
  EXPECT_EQ(joined.size(), space.rooms.size());
  for (int room = 0; room < int(space.rooms.size()); ++room) {
    EXPECT_LE(area_m2(space, room), 150.0);
    EXPECT_GE(area_m2(space, room), 12.0);
  }
}

// Buildings whose author named the rooms: what is found without the names, beside them.
struct Known {
  const char* scene;
  double voxel_m;
  double least_share;    // of the floor: in the one room that has most of its author's room
  std::size_t most_off;  // rooms found too many or too few
};

class KnownRooms : public testing::TestWithParam<Known> {};

TEST_P(KnownRooms, AreFoundWithoutTheirNames) {
  const std::filesystem::path folder = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / "room_search";
  std::filesystem::create_directories(folder);
  const std::filesystem::path file = folder / (std::string(GetParam().scene) + ".glb");
  write_file_whole(file, make_procedural_glb(GetParam().scene));
  Scene scene = load_scene(file);
  const std::vector<AuthoredRoom> authored = std::exchange(scene.rooms, {});
  const Space space = find(scene, GetParam().voxel_m);
  std::map<std::size_t, std::map<int, std::size_t>> found;  // by authored room: nodes by found room
  for (const FloorNode& node : space.floor.nodes) {
    const glm::dvec2 at = space.floor.origin_m + space.floor.cell_m * (glm::dvec2(node.ix, node.iz) + 0.5);
    const glm::dvec3 air{at.x, node.floor_m + 1.0, at.y};
    const auto room = std::find_if(authored.begin(), authored.end(), [&](const AuthoredRoom& r) {
      return glm::all(glm::lessThanEqual(r.lower_m, air)) && glm::all(glm::lessThanEqual(air, r.upper_m));
    });
    if (room != authored.end()) ++found[std::size_t(room - authored.begin())][node.room];
  }
  EXPECT_EQ(found.size(), authored.size()) << "a room has no floor";
  double own = 0.0, all = 0.0;
  for (const auto& [room, parts] : found) {
    std::size_t most = 0;
    for (const auto& [id, nodes] : parts) {
      most = std::max(most, nodes);
      all += double(nodes);
    }
    own += double(most);
  }
  EXPECT_GE(own / all, GetParam().least_share);
  EXPECT_LE(space.rooms.size(), authored.size() + GetParam().most_off);
  EXPECT_GE(space.rooms.size() + GetParam().most_off, authored.size());
  std::set<int> visited;
  for (const Pose& pose : space.tour) visited.insert(room_under(space, pose.position_m));
  EXPECT_EQ(visited.size(), space.rooms.size()) << "the tour leaves rooms out";
}

INSTANTIATE_TEST_SUITE_P(Procedural, KnownRooms,
                         testing::Values(Known{"house", 0.05, 0.93, 1}, Known{"building-20", 0.075, 0.9, 1}),
                         [](const auto& known) {
                           std::string name = known.param.scene;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace probewalk
