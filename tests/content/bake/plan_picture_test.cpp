// The plan beside a pack, by what is on it.
#include "content/bake/plan_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "content/box_scene.h"
#include "content/pack/file_io.h"
#include "content/scene/procedural/house_plan.h"
#include "content/scene/procedural/procedural.h"

namespace probewalk {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

struct Drawn {
  Space space;
  Placement placement;
  PlanPicture plan;
};

Drawn draw(const Scene& scene, int max_probes = 200, double voxel_m = 0.05) {
  const RayScene rays(scene);
  SilentProgress progress;
  Drawn drawn;
  drawn.space = find_space(scene, rays, {voxel_m, std::nullopt}, progress);
  PlacementOptions options;
  options.max_probes = max_probes;
  drawn.placement = place_probes(scene, rays, drawn.space, options);
  drawn.plan = draw_plan(scene, drawn.space, drawn.placement);
  return drawn;
}

// Nothing lies over floors and walls but portals and the tour.
Drawn draw_without_probes(const Scene& scene) {
  const RayScene rays(scene);
  SilentProgress progress;
  Drawn drawn;
  drawn.space = find_space(scene, rays, {}, progress);
  drawn.plan = draw_plan(scene, drawn.space, {});
  return drawn;
}

Scene procedural(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / "plan_picture";
  std::filesystem::create_directories(folder);
  const std::filesystem::path file = folder / (name + ".glb");
  write_file_whole(file, make_procedural_glb(name));
  return load_scene(file);
}

const Drawn& house() {
  static const Drawn drawn = draw(procedural("house"));
  return drawn;
}

glm::ivec3 pixel_at(const PlanPicture& plan, glm::ivec2 p) {
  const std::size_t at = 3 * (std::size_t(p.y) * std::size_t(plan.image.width_px) + std::size_t(p.x));
  return {plan.image.rgb.at(at), plan.image.rgb.at(at + 1), plan.image.rgb.at(at + 2)};
}
glm::ivec3 colour_at(const Drawn& drawn, std::size_t panel, glm::dvec3 at_m) {
  return pixel_at(drawn.plan, glm::ivec2(glm::floor(drawn.plan.pixel(panel, at_m))));
}
bool is_dark(glm::ivec3 c) { return std::max({c.r, c.g, c.b}) < 100; }
bool is_red(glm::ivec3 c) { return c.r > 150 && c.g < 100 && c.b < 100; }

std::set<std::size_t> numbers_on(const PlanPicture& plan) {
  std::set<std::size_t> numbers;
  for (const PlanLabel& label : plan.labels) {
    if (label.of != PlanLabel::Of::kProbes) continue;
    std::istringstream text(label.text);
    for (std::string number; std::getline(text, number, '/');) {
      EXPECT_TRUE(numbers.insert(std::stoul(number)).second) << number << " is there twice";
    }
  }
  return numbers;
}

void expect_every_probe_numbered(const Drawn& drawn) {
  const std::set<std::size_t> numbers = numbers_on(drawn.plan);
  EXPECT_EQ(numbers.size(), drawn.placement.sites.size());
  EXPECT_EQ(*numbers.rbegin() + 1, drawn.placement.sites.size());
}

// Every label has ink, lies in the picture and over no other.
void expect_legible(const PlanPicture& plan) {
  for (const PlanLabel& a : plan.labels) {
    ASSERT_GE(a.box.lower.x, 0);
    ASSERT_GE(a.box.lower.y, 0);
    ASSERT_LE(a.box.upper.x, plan.image.width_px);
    ASSERT_LE(a.box.upper.y, plan.image.height_px);
    int dark = 0;
    for (int y = a.box.lower.y; y < a.box.upper.y; ++y) {
      for (int x = a.box.lower.x; x < a.box.upper.x; ++x) dark += is_dark(pixel_at(plan, {x, y}));
    }
    EXPECT_GE(dark, 4 * int(a.text.size())) << a.text;
    for (const PlanLabel& b : plan.labels) {
      if (&a == &b) continue;
      const bool apart = glm::any(glm::lessThanEqual(a.box.upper, b.box.lower)) ||
                         glm::any(glm::lessThanEqual(b.box.upper, a.box.lower));
      EXPECT_TRUE(apart) << a.text << " lies over " << b.text;
    }
  }
}

void expect_every_room_named(const Drawn& drawn) {
  std::set<std::size_t> named;
  for (const PlanLabel& label : drawn.plan.labels) {
    if (label.of == PlanLabel::Of::kProbes) continue;
    named.insert(label.index);
    const std::string& name = drawn.space.rooms[label.index].name;
    if (label.of == PlanLabel::Of::kRoom) {
      EXPECT_EQ(label.text, name);
    } else {
      EXPECT_THAT(drawn.plan.legend, Contains(name)) << "what " << label.text << " means";
    }
  }
  EXPECT_EQ(named.size(), drawn.space.rooms.size());
}

TEST(PlanPicture, WallsAreDarkAndDoorsOpen) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 8}).wall_with_door(0, 4, 4, 2.5f, 1.0f, 1.9f);
  const Drawn drawn = draw_without_probes(boxes.scene);
  ASSERT_THAT(drawn.plan.panels, SizeIs(1));
  for (double x = 0.1; x < 3.95; x += 0.05) {
    const glm::ivec3 colour = colour_at(drawn, 0, {x, 0, 4.0});
    if (x < 0.9 || x > 2.0) {
      EXPECT_TRUE(is_dark(colour)) << "the wall at x " << x;
    } else if (x > 1.1 && x < 1.8) {
      EXPECT_FALSE(is_dark(colour)) << "the door at x " << x;
    }
  }
  EXPECT_THAT(drawn.plan.legend, AllOf(Contains("wall"), Contains(HasSubstr("portal")), Contains(StartsWith("tour"))));
  // The portal's line is as wide as the door, and no wider.
  int red = 0;
  for (double x = 0.0; x < 4.0; x += 0.01) {
    bool found = false;
    for (double z = 3.9; z <= 4.1; z += 0.01) found |= is_red(colour_at(drawn, 0, {x, 0, z}));
    red += found;
  }
  EXPECT_NEAR(0.01 * red, 0.9, 0.2);
}

TEST(PlanPicture, ShowsTheHousesWallsWhereTheyAre) {
  const procedural::HousePlan known = procedural::make_house_plan({});
  const Drawn bare = draw_without_probes(procedural("house"));
  ASSERT_THAT(bare.plan.panels, SizeIs(2));
  EXPECT_NEAR(bare.plan.panels[0].lowest_m, 0.0, 0.11);
  EXPECT_NEAR(bare.plan.panels[1].lowest_m, 3.0, 0.11);
  int wall = 0, dark = 0, doorway = 0, dark_doorway = 0;
  for (std::size_t storey = 0; storey < 2; ++storey) {
    const double eye_m = double(storey) * procedural::kUpperFloor_m + 1.6;
    for (const procedural::PlanWall& w : known.walls) {
      if (eye_m < w.bottom_m || eye_m > w.top_m) continue;
      for (double along = std::max(0.3, w.from_m + 0.2); along < std::min(w.along_z ? 8.7 : 11.7, w.to_m - 0.2); along += 0.1) {
        // In the middle of its thickness, which is hollow in the triangles.
        const double across = w.front_m + (w.along_z ? 0.5 : -0.5) * w.thickness_m;
        const glm::dvec3 at = w.along_z ? glm::dvec3(across, 0, along) : glm::dvec3(along, 0, across);
        double from_opening_m = 1e9;
        bool in_doorway = false;
        for (const procedural::PlanOpening& o : w.openings) {
          if (o.top_m < eye_m || o.bottom_m > eye_m) continue;
          from_opening_m = std::min(from_opening_m, std::max(o.from_m - along, along - o.to_m));
          in_doorway |= o.kind == procedural::PlanOpening::Kind::kDoorway && along > o.from_m + 0.1 && along < o.to_m - 0.1;
        }
        const bool shut = in_doorway && w.name == "North wall";  // the front door
        if (from_opening_m > 0.12 || shut) {
          ++wall;
          dark += is_dark(colour_at(bare, storey, at));
        } else if (in_doorway) {
          ++doorway;
          dark_doorway += is_dark(colour_at(bare, storey, at));
        }
      }
    }
  }
  EXPECT_GT(wall, 500);
  EXPECT_GT(dark, 0.95 * wall);
  EXPECT_GT(doorway, 50);
  EXPECT_LT(dark_doorway, 0.05 * doorway);
}

TEST(PlanPicture, NumbersEveryProbeOfTheHouseLegibly) {
  expect_every_probe_numbered(house());
  expect_legible(house().plan);
  expect_every_room_named(house());
}

TEST(PlanPicture, StaysReadableForABuildingOfManyRooms) {
  const Drawn drawn = draw(procedural("building-20"), 150, 0.075);
  EXPECT_THAT(drawn.plan.panels, SizeIs(2));
  expect_every_probe_numbered(drawn);
  expect_legible(drawn.plan);
  expect_every_room_named(drawn);
}

TEST(PlanPicture, RoomsThatMeetHaveDifferentColours) {
  const Drawn& drawn = house();
  std::map<int, std::map<int, int>> colours;  // by room: nodes by colour
  for (const FloorNode& node : drawn.space.floor.nodes) {
    const glm::dvec2 at = drawn.space.floor.origin_m + drawn.space.floor.cell_m * (glm::dvec2(node.ix, node.iz) + 0.5);
    const glm::ivec3 c = colour_at(drawn, node.floor_m > 2.0f, {at.x, 0, at.y});
    ++colours[node.room][c.r << 16 | c.g << 8 | c.b];
  }
  const auto main_colour = [&](int room) {
    const auto& all = colours[room];
    return std::max_element(all.begin(), all.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
  };
  ASSERT_FALSE(drawn.space.portals.empty());
  for (const Portal& portal : drawn.space.portals) {
    EXPECT_NE(main_colour(portal.room_a), main_colour(portal.room_b))
        << drawn.space.rooms[std::size_t(portal.room_a)].name << " and " << drawn.space.rooms[std::size_t(portal.room_b)].name;
  }
}

TEST(PlanPicture, TheSameSceneGivesTheSameBytes) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 8}).wall_with_door(0, 4, 4, 2.5f, 1.0f, 1.9f).solid({2, 0, 1}, {3, 0.8f, 2});
  EXPECT_EQ(draw(boxes.scene).plan.image.rgb, draw(boxes.scene).plan.image.rgb);
}

TEST(PlanPicture, FurnitureIsLighterThanWallsAndDarkerThanFloor) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {5, 2.5f, 5}).solid({1, 0, 1}, {2, 0.8f, 2}).solid({3.5f, 0, 4.4f}, {4.5f, 2.0f, 5});
  const Drawn drawn = draw_without_probes(boxes.scene);
  const auto brightness = [&](glm::dvec3 at) {
    const glm::ivec3 c = colour_at(drawn, 0, at);
    return c.r + c.g + c.b;
  };
  int wall = 765;  // a sheet without thickness: in the one cell that it runs through
  for (double z = 4.95; z < 5.06; z += 0.01) wall = std::min(wall, brightness({2.5, 0, z}));
  const int table = brightness({1.25, 0, 1.25}), cupboard = brightness({4.0, 0, 4.7}),
            floor = brightness({4.6, 0, 0.3});
  EXPECT_LT(wall + 90, cupboard);
  EXPECT_LT(cupboard, table);
  EXPECT_LT(table, floor);
  EXPECT_THAT(drawn.plan.legend, AllOf(Contains("furniture"), Contains("higher than the eyes"), Not(Contains("window")),
                                       Not(Contains(HasSubstr("portal")))));
}

TEST(PlanPicture, AWindowIsNeitherWallNorDoor) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {4, 2.5f, 8});
  boxes.solid({0, 0, 3.9f}, {1.0f, 2.5f, 4.1f}).solid({1.9f, 0, 3.9f}, {2.5f, 2.5f, 4.1f}).solid({3.5f, 0, 3.9f}, {4, 2.5f, 4.1f});
  boxes.solid({1.0f, 2.0f, 3.9f}, {1.9f, 2.5f, 4.1f}).solid({2.5f, 2.0f, 3.9f}, {3.5f, 2.5f, 4.1f});
  boxes.solid({2.5f, 0, 3.9f}, {3.5f, 0.9f, 4.1f});
  const Drawn drawn = draw(boxes.scene);
  EXPECT_THAT(drawn.plan.legend, Contains("window"));
  const glm::ivec3 pane = colour_at(drawn, 0, {3.0, 0, 4.0});
  EXPECT_FALSE(is_dark(pane));
  EXPECT_GT(pane.b, 200) << "neither furniture";
}

TEST(PlanPicture, TerracesShareAPlanAndStoreysDoNot) {
  BoxScene boxes;  // two halves of a floor, one 2 m higher, a stair between
  boxes.room({0, 0, 0}, {10, 6, 4}).solid({6, 0, 0}, {10, 2.0f, 4});
  for (int step = 0; step < 9; ++step) boxes.solid({3.75f + 0.25f * float(step), 0, 0}, {6, 0.2f * float(step + 1), 4});
  const Drawn terraces = draw(boxes.scene);
  ASSERT_THAT(terraces.plan.panels, SizeIs(1));
  EXPECT_NEAR(terraces.plan.panels[0].lowest_m, 0.0, 0.11);
  EXPECT_NEAR(terraces.plan.panels[0].highest_m, 2.0, 0.11);
}

TEST(PlanPicture, AnEmptySceneIsASheetWithItsStart) {
  Scene scene;
  const Drawn drawn = draw(scene);
  EXPECT_GT(drawn.plan.image.width_px, 0);
  EXPECT_LT(drawn.plan.image.rgb.size(), 6'000'000u);
  EXPECT_THAT(drawn.plan.legend, Contains(StartsWith("start")));
  for (const char* absent : {"wall", "window", "furniture", "higher", "portal", "tour"}) {
    EXPECT_THAT(drawn.plan.legend, Not(Contains(StartsWith(absent)))) << absent;
  }
}

TEST(PlanPicture, OneTriangleIsNoWall) {
  BoxScene boxes;
  boxes.scene.positions_m = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  boxes.scene.normals.assign(3, {0, 0, 1});
  boxes.scene.triangles = {{0, 1, 2}};
  boxes.scene.triangle_material = boxes.scene.triangle_object = {0};
  boxes.scene.bounds = {{0, 0, 0}, {1, 1, 0}};
  const Drawn drawn = draw(boxes.scene);
  EXPECT_THAT(drawn.plan.legend, Not(Contains("wall")));
  expect_legible(drawn.plan);
}

TEST(PlanPicture, APlainOfTenKilometresMakesNoLargerPicture) {
  BoxScene boxes;
  boxes.floor({-5000, -5000}, {5000, 5000}, 0).solid({-3, 0, -3}, {3, 2.6f, -2.8f}).solid({-3, 0, 2.8f}, {3, 2.6f, 3});
  const Drawn square = draw(boxes.scene);
  EXPECT_LT(square.plan.image.rgb.size() / 3, 9'000'000u);
  EXPECT_LE(square.space.rooms.size(), 4096u);
  EXPECT_THAT(square.plan.legend, Contains(HasSubstr(" more")));
  BoxScene street;
  street.floor({-5000, -1}, {5000, 1}, 0);
  const Drawn strip = draw(street.scene);
  EXPECT_LT(strip.plan.image.rgb.size() / 3, 9'000'000u);
  EXPECT_LT(strip.plan.image.width_px, 8000);
}

TEST(PlanPicture, ThousandsOfProbesLeaveTheirNumbersOutAndSaySo) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {6, 2.5f, 6});
  const RayScene rays(boxes.scene);
  SilentProgress progress;
  const Space space = find_space(boxes.scene, rays, {}, progress);
  Placement placement;
  for (int k = 0; k < 10000; ++k) placement.sites.push_back({{0.06 * (k % 100), 1.6, 0.06 * (k / 100)}, 0});
  const PlanPicture plan = draw_plan(boxes.scene, space, placement);
  EXPECT_THAT(plan.legend, Contains(HasSubstr("10000 have no room")));
  expect_legible(plan);
}

TEST(PlanPicture, NamesThatHaveNoLettersAreIds) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {6, 2.5f, 12});
  boxes.scene.rooms.push_back({"kitchen", "K\u00fcche", {0, 0, 0}, {6, 2.5, 4}, {}});
  boxes.scene.rooms.push_back({"bath", "\u6d74\u5ba4", {0, 0, 4}, {6, 2.5, 8}, {}});
  boxes.scene.rooms.push_back({"hall", std::string(300, 'H'), {0, 0, 8}, {6, 2.5, 12}, {}});
  const Drawn drawn = draw(boxes.scene);
  std::vector<std::string> names;
  for (const PlanLabel& label : drawn.plan.labels) {
    if (label.of == PlanLabel::Of::kRoom) names.push_back(label.text);
  }
  names.insert(names.end(), drawn.plan.legend.begin(), drawn.plan.legend.end());
  EXPECT_THAT(names, AllOf(Contains("K\u00fcche"), Contains("bath"), Contains(std::string(37, 'H') + "...")));
  expect_legible(drawn.plan);
}

}  // namespace
}  // namespace probewalk
