// Rooms that no boxes tell apart: out as a file's outlines and in again; merged, renamed and cut.
#include "content/scene/space/room_outline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "content/box_scene.h"
#include "content/error.h"
#include "content/scene/ray_scene.h"
#include "content/scene/space.h"

namespace probewalk {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

// Two L-shaped rooms that lie in each other's corner, furnished, with a door between them.
BoxScene interlocking() {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {10, 2.6f, 8});
  boxes.solid({3.95f, 0, 0}, {4.05f, 2.6f, 2})
      .solid({3.95f, 0, 2.9f}, {4.05f, 2.6f, 5.05f})
      .solid({3.95f, 2, 2}, {4.05f, 2.6f, 2.9f});
  boxes.solid({4.05f, 0, 4.95f}, {7.05f, 2.6f, 5.05f}).solid({6.95f, 0, 5.05f}, {7.05f, 2.6f, 8});
  boxes.solid({1, 0, 6}, {2.5f, 0.75f, 7}).solid({8, 0, 0}, {10, 0.5f, 1.2f}).solid({0, 0, 0}, {0.5f, 2, 2});
  return boxes;
}

Space find(const Scene& scene) {
  SilentProgress progress;
  const RayScene rays(scene);
  return find_space(scene, rays, {}, progress);
}

std::vector<int> rooms_of_floor(const Space& space) {
  std::vector<int> rooms;
  for (const FloorNode& node : space.floor.nodes) rooms.push_back(node.room);
  return rooms;
}

Scene authored(Scene scene, const std::vector<RoomRegion>& rooms) {
  scene.rooms.clear();
  for (const RoomRegion& room : rooms) {
    scene.rooms.push_back({room.id, room.name, room.bounds.lower_m, room.bounds.upper_m, room.outline});
  }
  return scene;
}

RoomEdit edit(RoomEdit::Kind kind, std::vector<std::string> rooms, const std::string& id = "") {
  RoomEdit e;
  e.kind = kind;
  e.rooms = std::move(rooms);
  e.id = id;
  return e;
}

TEST(RoomOutline, GivesInterlockingRoomsTheirFloorAgain) {
  const Scene scene = interlocking().scene;
  const Space found = find(scene);
  ASSERT_THAT(found.rooms, SizeIs(2));
  EXPECT_NE(rooms_of_floor(find(authored(scene, found.rooms))), rooms_of_floor(found))
      << "boxes do, and this tests nothing";

  const OutlinedRooms outlined = outline_rooms(found.floor, found.rooms, 0.001);
  EXPECT_EQ(outlined.strayed, 0u);
  std::size_t corners = 0;
  for (const RoomRegion& room : outlined.rooms) {
    for (const PlanLoop& loop : room.outline) corners += loop.size();
  }
  EXPECT_GE(corners, 6u);
  EXPECT_LE(corners, 40u) << "a person is to read this";
  const Space again = find(authored(scene, outlined.rooms));
  EXPECT_EQ(rooms_of_floor(again), rooms_of_floor(found));
  ASSERT_THAT(again.portals, SizeIs(found.portals.size()));
  EXPECT_EQ(again.portals[0].polygon, found.portals[0].polygon);
  const OutlinedRooms twice = outline_rooms(again.floor, again.rooms, 0.001);
  for (std::size_t k = 0; k < outlined.rooms.size(); ++k) EXPECT_EQ(twice.rooms[k].outline, outlined.rooms[k].outline);
}

TEST(RoomOutline, HoldsWhatItSurroundsLessItsHoles) {
  const std::vector<PlanLoop> ring{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {1, 3}, {3, 3}, {3, 1}}};
  EXPECT_TRUE(outline_holds(ring, {0.5, 2.0}));
  EXPECT_FALSE(outline_holds(ring, {2.0, 2.0}));
  EXPECT_FALSE(outline_holds(ring, {5.0, 2.0}));
  EXPECT_DOUBLE_EQ(distance_to_outline_m(ring, {2.0, 2.25}), 0.75);
}

TEST(RoomEdits, MergeRenameAndCutFoundRooms) {
  Scene scene = interlocking().scene;
  const Space found = find(scene);
  scene.room_edits = {edit(RoomEdit::Kind::kMerge, {"room-1", "room-2"}, "both")};
  const Space merged = find(scene);
  ASSERT_THAT(merged.rooms, SizeIs(1));
  EXPECT_EQ(merged.rooms[0].id, "both");
  EXPECT_TRUE(merged.portals.empty());
  EXPECT_EQ(merged.floor.nodes.size(), found.floor.nodes.size());

  // Cut along x = 5: what is right of the way along +z, which is towards -x.
  RoomEdit cut = edit(RoomEdit::Kind::kSplit, {"both"}, "west");
  cut.from_m = {5.0, 0.0};
  cut.to_m = {5.0, 8.0};
  scene.room_edits.push_back(cut);
  scene.room_edits.push_back(edit(RoomEdit::Kind::kRename, {"both"}, "east"));
  const Space parted = find(scene);
  ASSERT_THAT(parted.rooms, SizeIs(2));
  EXPECT_EQ(parted.rooms[0].id, "east");
  EXPECT_EQ(parted.rooms[1].id, "west");
  EXPECT_GE(parted.portals.size(), 1u);
  for (const FloorNode& node : parted.floor.nodes) {
    const double x = parted.floor.origin_m.x + (node.ix + 0.5) * parted.floor.cell_m;
    EXPECT_EQ(node.room, x < 5.0 ? 1 : 0);
  }
  EXPECT_NEAR(parted.rooms[0].bounds.lower_m.x, 5.0, 0.2);
  EXPECT_NEAR(parted.rooms[1].bounds.upper_m.x, 5.0, 0.2);
}

TEST(RoomEdits, OfWhatIsNotThereAreRefused) {
  Scene scene = interlocking().scene;
  const auto message = [&](RoomEdit e) -> std::string {
    scene.room_edits = {std::move(e)};
    try {
      find(scene);
    } catch (const BadInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message(edit(RoomEdit::Kind::kRename, {"attic"}, "loft")), HasSubstr("'attic'"));
  EXPECT_THAT(message(edit(RoomEdit::Kind::kRename, {"room-1"}, "room-2")), HasSubstr("'room-2'"));
  EXPECT_THAT(message(edit(RoomEdit::Kind::kMerge, {"room-1", "room-1"})), HasSubstr("itself"));
  RoomEdit beside = edit(RoomEdit::Kind::kSplit, {"room-1"});
  beside.from_m = {50.0, 0.0};
  beside.to_m = {50.0, 1.0};
  EXPECT_THAT(message(beside), HasSubstr("one side"));
}

}  // namespace
}  // namespace probewalk
