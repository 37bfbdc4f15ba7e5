// Lights, sky, rooms, start, credits, units: what an author says or leaves to be guessed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "content/error.h"
#include "content/scene/gltf_scene.h"

namespace probewalk {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

GltfScene with_light(const Json& light) {
  GltfScene small = GltfScene::floor();
  small.json["extensionsUsed"] = {"KHR_lights_punctual"};
  small.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
  small.json["nodes"].push_back({{"translation", {1, 2, 3}},
                                 {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}},
                                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  small.json["scenes"][0]["nodes"] = {0, 1};
  return small;
}

TEST(GltfLights, ReadsASpotInItsPlace) {
  const Scene scene = with_light({{"type", "spot"},
                                  {"color", {1.0, 0.5, 0.25}},
                                  {"intensity", 80.0},
                                  {"range", 7.0},
                                  {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.6}}}})
                          .load();
  ASSERT_EQ(scene.lights.size(), 1u);
  const Light& light = scene.lights[0];
  EXPECT_EQ(light.kind, Light::Kind::kSpot);
  EXPECT_EQ(light.position_m, glm::vec3(1, 2, 3));
  EXPECT_NEAR(light.direction.y, -1.0f, 1e-6f) << "turned from -z to straight down";
  EXPECT_EQ(light.intensity, glm::vec3(80, 40, 20));
  EXPECT_FLOAT_EQ(light.range_m, 7.0f);
  EXPECT_FLOAT_EQ(light.inner_cone_rad, 0.1f);
  EXPECT_FLOAT_EQ(light.outer_cone_rad, 0.6f);
  EXPECT_THAT(scene.light_statement, HasSubstr("1 light source"));
  EXPECT_TRUE(scene.sky.is_black());
}

TEST(GltfLights, CandelaFollowTheScaleAndLuxDoNot) {
  SceneLoadOptions millimetres;
  millimetres.scale = 0.001;
  const Scene point = with_light({{"type", "point"}, {"intensity", 1e6}}).load(millimetres);
  EXPECT_NEAR(point.lights[0].intensity.r, 1.0f, 1e-5f);
  EXPECT_NEAR(point.lights[0].position_m.z, 0.003f, 1e-7f);
  const Scene sun = with_light({{"type", "directional"}, {"intensity", 1e5}}).load(millimetres);
  EXPECT_NEAR(sun.lights[0].intensity.r, 1e5f, 1.0f);
}

TEST(GltfLights, RefusesAnUnknownKind) {
  EXPECT_THROW(with_light({{"type", "laser"}}).load(), BadInput);
}

// A closed room, 6 x 3 x 8, faces inwards.
GltfScene room(float unit = 1.0f) {
  const float x = 6 * unit, y = 3 * unit, z = 8 * unit;
  GltfScene small;
  const int position =
      small.add_floats({0, 0, 0, x, 0, 0, x, 0, z, 0, 0, z, 0, y, 0, x, y, 0, x, y, z, 0, y, z}, "VEC3");
  const int index = small.add_accessor(
      bytes_of<std::uint16_t>({0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 3, 6, 2, 3, 7, 6,
                               0, 4, 7, 0, 7, 3, 1, 6, 5, 1, 2, 6}),
      5123, "SCALAR", 36);
  small.add_mesh({{"attributes", {{"POSITION", position}}}, {"indices", index}});
  return small;
}

TEST(DefaultLight, HangsAPanelUnderTheCeilingOfARoom) {
  const Scene scene = room().load();
  EXPECT_THAT(scene.light_statement, HasSubstr("1 panel"));
  EXPECT_FALSE(scene.sky.is_black());
  ASSERT_EQ(scene.triangles.size(), 14u);
  for (std::size_t i = 12; i < 14; ++i) {
    const glm::uvec3 corner = scene.triangles[i];
    const glm::vec3 a = scene.positions_m[corner.x];
    const glm::vec3 normal = glm::cross(scene.positions_m[corner.y] - a, scene.positions_m[corner.z] - a);
    EXPECT_LT(normal.y, 0.0f) << "faces down";
    EXPECT_NEAR(a.y, 2.999f, 1e-5f) << "what it sends up is not caught in a gap";
    EXPECT_NEAR(a.x, 3.0f, 1.2f) << "near the middle";
    EXPECT_NEAR(a.z, 4.0f, 2.2f);
    EXPECT_GT(scene.materials[scene.triangle_material[i]].emissive_cd_m2.g, 1000.0f);
  }
  EXPECT_EQ(scene.normals.size(), scene.positions_m.size());
}

TEST(DefaultLight, IsOnlyASkyInTheOpen) {
  const Scene scene = GltfScene::floor().load();
  EXPECT_EQ(scene.triangles.size(), 2u);
  EXPECT_FALSE(scene.sky.is_black());
  EXPECT_THAT(scene.light_statement, HasSubstr("soft sky"));
}

TEST(Units, MetresNeedNoGuess) {
  const Scene scene = load_scene(room().write());
  EXPECT_EQ(scene.scale, 1.0);
  EXPECT_THAT(scene.scale_statement, HasSubstr("plausible in metres"));
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST(Units, AreToldFromStoreys) {
  for (const double unit : {0.001, 0.01}) {
    const Scene scene = load_scene(room(static_cast<float>(1.0 / unit)).write());
    EXPECT_DOUBLE_EQ(scene.scale, unit) << scene.scale_statement;
    EXPECT_NEAR(scene.bounds.upper_m.y, 3.0, 1e-4);
    EXPECT_THAT(scene.warnings, IsEmpty());
  }
}

TEST(Units, AnOpenSceneOfOddSizeIsWarnedOf) {
  GltfScene small = GltfScene::floor();
  small.json["nodes"][0]["scale"] = {1000, 1000, 1000};
  const Scene scene = load_scene(small.write());
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("--scale")));
}

TEST(Units, TheUserWins) {
  SceneLoadOptions options;
  options.scale = 0.5;
  const Scene scene = room().load(options);
  EXPECT_EQ(scene.scale, 0.5);
  EXPECT_DOUBLE_EQ(scene.bounds.upper_m.z, 4.0);
  for (const double scale : {0.0, -1.0, std::nan("")}) {
    options.scale = scale;
    EXPECT_THROW(room().load(options), BadUsage);
  }
}

TEST(Units, ASceneOnItsSideIsWarnedOf) {
  GltfScene small = GltfScene::floor();
  small.json["nodes"][0]["rotation"] = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  EXPECT_THAT(small.load().warnings, Contains(HasSubstr("z may be up")));
}

TEST(Units, RecentreMovesEverythingTogether) {
  GltfScene small = with_light({{"type", "point"}, {"intensity", 1.0}});
  small.json["nodes"][0]["translation"] = {100, 50, 20};
  small.json["scenes"][0]["extras"] = {{"probewalk_start", {102, 50, 18}}};
  small.json["nodes"][0]["extras"] = {
      {"probewalk_room", "All"}, {"probewalk_room_min", {0, 0, -4}}, {"probewalk_room_max", {4, 3, 0}}};
  SceneLoadOptions options;
  options.recentre = true;
  const Scene scene = small.load(options);
  EXPECT_EQ(scene.bounds.lower_m, glm::dvec3(-2, 0, -2));
  EXPECT_EQ(scene.authored_start_m.value(), glm::dvec3(0, 0, 0));
  EXPECT_EQ(scene.rooms[0].lower_m, glm::dvec3(-2, 0, -2));
  EXPECT_EQ(scene.lights[0].position_m, glm::vec3(-101, -48, -15));
}

TEST(Authored, ReadsSkyStartAndRoomsFromExtras) {
  GltfScene small = GltfScene::floor();
  small.json["scenes"][0]["extras"] = {
      {"probewalk_sky", {{"zenith", {1, 2, 3}}, {"horizon", {4, 5, 6}}, {"ground", {7, 8, 9}}}},
      {"probewalk_start", {1, 0, -1}}};
  const Json box{{"probewalk_room_min", {0, 0, 0}}, {"probewalk_room_max", {1, 2, 3}}};
  for (int i = 0; i < 2; ++i) {
    Json extras = box;
    extras["probewalk_room"] = "Living Room!";
    small.json["nodes"].push_back({{"translation", {10 * i, 0, 0}}, {"extras", extras}});
  }
  small.json["scenes"][0]["nodes"] = {0, 1, 2};
  const Scene scene = small.load();
  EXPECT_EQ(scene.sky.zenith_cd_m2, glm::vec3(1, 2, 3));
  EXPECT_EQ(scene.sky.ground_cd_m2, glm::vec3(7, 8, 9));
  EXPECT_THAT(scene.light_statement, HasSubstr("its sky"));
  EXPECT_EQ(scene.authored_start_m.value(), glm::dvec3(1, 0, -1));
  ASSERT_EQ(scene.rooms.size(), 2u);
  EXPECT_EQ(scene.rooms[0].name, "Living Room!");
  EXPECT_EQ(scene.rooms[0].id, "living-room");
  EXPECT_EQ(scene.rooms[1].id, "living-room-2");
  EXPECT_EQ(scene.rooms[1].lower_m, glm::dvec3(10, 0, 0));
  EXPECT_EQ(scene.rooms[1].upper_m, glm::dvec3(11, 2, 3));
}

TEST(Authored, ARoomsFileWins) {
  GltfScene small = GltfScene::floor();
  small.json["nodes"][0]["extras"] = {
      {"probewalk_room", "A"}, {"probewalk_room_min", {0, 0, 0}}, {"probewalk_room_max", {1, 1, 1}}};
  const auto file = GltfScene::write("my-rooms.json",
                                     R"({"rooms":[{"id":"hall","name":"Hall","min":[0,0,-4],"max":[4,3,0]}]})");
  SceneLoadOptions options;
  options.scale = 2.0;
  options.rooms_file = file;
  const Scene scene = small.load(options);
  ASSERT_EQ(scene.rooms.size(), 1u);
  EXPECT_EQ(scene.rooms[0].id, "hall");
  EXPECT_EQ(scene.rooms[0].upper_m, glm::dvec3(8, 6, 0)) << "in file units, so scaled";
  EXPECT_NE(scene.content_hash, small.load().content_hash) << "the rooms file is part of what was read";
}

TEST(Authored, RoomsFilesHavePolygonsAndEditsInFileUnits) {
  SceneLoadOptions options;
  options.scale = 0.5;
  options.rooms_file = GltfScene::write("polygons.json", R"({"rooms":[
      {"id":"l","floor":0,"ceiling":5,"polygon":[[0,0],[4,0],[4,2],[2,2],[2,4],[0,4]]},
      {"id":"ring","floor":0,"ceiling":5,"polygons":[[[0,0],[8,0],[8,8],[0,8]],[[2,2],[6,2],[6,6],[2,6]]]}],
      "edits":[{"merge":["l","ring"],"id":"all"},{"split":"all","line":[[2,0],[2,8]],"name":"Half"}]})");
  const Scene scene = GltfScene::floor().load(options);
  ASSERT_EQ(scene.rooms.size(), 2u);
  EXPECT_EQ(scene.rooms[0].lower_m, glm::dvec3(0, 0, 0));
  EXPECT_EQ(scene.rooms[0].upper_m, glm::dvec3(2, 2.5, 2));
  ASSERT_EQ(scene.rooms[0].outline.size(), 1u);
  EXPECT_EQ(scene.rooms[0].outline[0][2], glm::dvec2(2, 1));
  EXPECT_EQ(scene.rooms[1].outline.size(), 2u);
  ASSERT_EQ(scene.room_edits.size(), 2u);
  EXPECT_EQ(scene.room_edits[0].rooms, (std::vector<std::string>{"l", "ring"}));
  EXPECT_EQ(scene.room_edits[1].to_m, glm::dvec2(1, 4));
  EXPECT_EQ(scene.room_edits[1].name, "Half");
}

TEST(Authored, RefusesRoomsThatCannotBe) {
  const std::string deep = R"({"rooms":)" + std::string(100000, '[');
  const char* const cases[] = {
      "[]",
      "{",
      R"({"rooms":{}})",
      R"({"rooms":[1]})",
      deep.c_str(),
      R"({"rooms":[{"id":"../x","min":[0,0,0],"max":[1,1,1]}]})",
      R"({"rooms":[{"id":"a","min":[0,0,0],"max":[1,1,0]}]})",
      R"({"rooms":[{"id":"a","min":[0,0],"max":[1,1,1]}]})",
      R"({"rooms":[{"id":"a","min":[0,0,0]}]})",
      R"({"rooms":[{"id":"a","min":[0,0,0],"max":[1,1,1]},{"id":"a","min":[0,0,0],"max":[1,1,1]}]})",
      R"({"rooms":[{"id":"a","polygon":[[0,0],[1,0],[1,1]]}]})",
      R"({"rooms":[{"id":"a","floor":0,"ceiling":2,"polygon":[[0,0],[1,0]]}]})",
      R"({"rooms":[{"id":"a","floor":0,"ceiling":2,"polygon":[[0,0],[1,0],[1,1e300]]}]})",
      R"({"rooms":[{"id":"a","floor":2,"ceiling":0,"polygon":[[0,0],[1,0],[1,1]]}]})",
      R"({"rooms":[{"id":"a","floor":0,"ceiling":2,"polygons":[[0,0],[1,0],[1,1]]}]})",
      R"({"edits":[{"merge":["a"]}]})",
      R"({"edits":[{"merge":"a"}]})",
      R"({"edits":[{"rename":"a"}]})",
      R"({"edits":[1]})",
      R"({"edits":[{"rename":"a","split":"a","id":"b"}]})",
      R"({"edits":[{"split":"a"}]})",
      R"({"edits":[{"split":"a","line":[[0,0],[0,0]]}]})",
      R"({"edits":[{"rename":"a","id":"../x"}]})"};
  for (const char* text : cases) {
    SceneLoadOptions options;
    options.rooms_file = GltfScene::write("bad-rooms.json", text);
    try {
      GltfScene::floor().load(options);
      FAIL() << text;
    } catch (const BadInput& error) {
      EXPECT_THAT(error.what(), HasSubstr("bad-rooms.json")) << text;
    }
  }
}

TEST(Authored, CreditsComeFromTheAssetOrAFile) {
  GltfScene small = GltfScene::floor();
  small.json["asset"]["copyright"] = "(c) Somebody";
  small.json["asset"]["extras"] = {{"title", "A floor"}, {"author", "Somebody"}, {"license", "CC BY 4.0"}};
  EXPECT_EQ(small.load().credits, "A floor, Somebody, CC BY 4.0, (c) Somebody");
  SceneLoadOptions options;
  options.credits_file = GltfScene::write("credits.txt", "Floor by Anna\n");
  EXPECT_EQ(small.load(options).credits, "Floor by Anna");
  EXPECT_NE(small.load(options).content_hash, small.load().content_hash);
}

TEST(Authored, CreditsOfAnyShapeAreText) {
  GltfScene small = GltfScene::floor();
  small.json["asset"]["extras"] = "Floor by Anna";
  EXPECT_EQ(small.load().credits, "Floor by Anna");
  for (const Json& extras : {Json(7), Json::array({"a"}), Json{{"author", {{"name", "Anna"}}}}, Json(nullptr)}) {
    small.json["asset"]["extras"] = extras;
    EXPECT_EQ(small.load().credits, "") << extras;
  }
  small.json["asset"]["copyright"] = 3;
  EXPECT_EQ(small.load().credits, "");
}

TEST(Authored, LongCreditsAreCutBetweenCharacters) {
  GltfScene small = GltfScene::floor();
  std::string many;
  for (int i = 0; i < 50000; ++i) many += "\xc3\xa9";
  small.json["asset"]["copyright"] = many;
  const std::string credits = small.load().credits;
  EXPECT_EQ(credits.size(), 65535u) << "64 KiB without the half character that would fit before the dots";
  EXPECT_TRUE(credits.ends_with("\xc3\xa9..."));
  SceneLoadOptions options;
  options.credits_file = GltfScene::write("credits.txt", std::string(70000, 'x'));
  EXPECT_THROW(small.load(options), BadInput) << "a file that someone names is refused, not cut";
}

}  // namespace
}  // namespace probewalk
