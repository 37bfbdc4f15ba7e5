// What cannot be read is refused with one line that names the file and the value, whatever its bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "content/error.h"
#include "content/scene/gltf_scene.h"

namespace probewalk {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string refusal(const std::filesystem::path& file) {
  try {
    SceneLoadOptions options;
    options.scale = 1.0;
    load_scene(file, options);
  } catch (const BadInput& error) {
    return error.what();
  }
  return "accepted";
}

TEST(GltfRefusal, NamesTheRequiredExtensionItDoesNotKnow) {
  GltfScene small = GltfScene::floor();
  small.json["extensionsUsed"] = {"KHR_texture_basisu"};
  EXPECT_THAT(small.load().warnings, testing::Contains(HasSubstr("KHR_texture_basisu")));
  small.json["extensionsRequired"] = {"KHR_texture_basisu"};
  EXPECT_THAT(refusal(small.write()), AllOf(HasSubstr("small.gltf"), HasSubstr("KHR_texture_basisu")));
}

TEST(GltfRefusal, NamesTheVersion) {
  GltfScene small = GltfScene::floor();
  small.json["asset"]["version"] = "1.0";
  EXPECT_THAT(refusal(small.write()), HasSubstr("1.0"));
  std::string glb = GltfScene::floor().glb();
  glb[4] = 1;
  EXPECT_THAT(refusal(GltfScene::write("old.glb", glb)), HasSubstr("version 1"));
}

TEST(GltfRefusal, ForeignAndMissingFiles) {
  EXPECT_THAT(refusal("no/such/file.glb"), HasSubstr("no/such/file.glb"));
  EXPECT_THAT(refusal(GltfScene::folder()), HasSubstr("regular file"));
  for (const char* text :
       {"", "   ", "PNG", "{", "{}", "[]", "{\"asset\":{}}", "{\"asset\":7}", "glTF", "{\"asset\":{\"version\":2}}"}) {
    EXPECT_THAT(refusal(GltfScene::write("foreign.gltf", text)), HasSubstr("foreign.gltf")) << text;
  }
  EXPECT_THAT(refusal(GltfScene::write("empty.gltf", R"({"asset":{"version":"2.0"}})")), HasSubstr("no triangle"));
}

TEST(GltfRefusal, UrisThatLeaveTheFolder) {
  for (const char* uri :
       {"../secret.bin", "/etc/passwd", "a/../../b.bin", "%2e%2e/secret.bin", "http://example.org/a.bin",
        "file:///etc/passwd", "C:\\a.bin", "..", "data:text/plain,abc", "data:;base64,!!"}) {
    GltfScene small = GltfScene::floor();
    small.json["buffers"][0]["uri"] = uri;
    EXPECT_THAT(refusal(small.write()), AllOf(HasSubstr("small.gltf"), HasSubstr("URI"))) << uri;
  }
  GltfScene small = GltfScene::floor();
  small.json["images"] = {{{"uri", "../picture.png"}}};
  EXPECT_THAT(refusal(small.write()), HasSubstr("../picture.png"));
}

// Percent signs are decoded before the path is judged, once: "%252e" is a file's name.
TEST(GltfRefusal, PicturesOutsideTheFolderAreNotOpenedHoweverTheyAreSpelled) {
  const std::vector<std::uint8_t> png = png_row({255, 255, 255, 255});
  const std::filesystem::path outside = GltfScene::folder().parent_path() / "outside.png";
  std::ofstream(outside, std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  GltfScene::write("beside.png", std::string(png.begin(), png.end()));
  const auto textures = [](const std::string& uri) -> std::size_t {
    GltfScene small = GltfScene::floor();
    small.set_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    small.json["images"] = {{{"uri", uri}}};
    small.json["textures"] = {{{"source", 0}}};
    try {
      return small.load().textures.size();
    } catch (const BadInput&) {
      return 0;
    }
  };
  EXPECT_EQ(textures("beside.png"), 1u);
  EXPECT_EQ(textures("b%65side.png"), 1u);
  for (const std::string& uri : std::vector<std::string>{
           "../outside.png", "%2e%2e/outside.png", "%2E%2e%2foutside.png", ".%2e/outside.png", "%252e%252e/outside.png",
           outside.string(), "file://" + outside.string(), "%2f" + outside.string().substr(1)}) {
    EXPECT_EQ(textures(uri), 0u) << uri;
  }
  std::filesystem::remove(outside);
}

// A hundred bytes that announce a gigabyte.
TEST(GltfRefusal, PicturesThatAnnounceMoreThanTheyCanHold) {
  std::vector<std::uint8_t> png = png_row({255, 255, 255, 255});
  png[18] = png[22] = 0x40;  // width and height 16384 and more
  png[19] = png[23] = 0;
  std::vector<std::uint8_t> jpeg{0xff, 0xd8, 0xff, 0xc0, 0, 11, 8, 0x40, 0, 0x40, 0, 1, 1, 0x11, 0, 0xff, 0xd9};
  for (const auto& bytes : {png, jpeg}) {
    GltfScene small = GltfScene::floor();
    small.set_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", small.add_texture(bytes)}}}}}});
    EXPECT_THAT(small.load().warnings, testing::Contains(HasSubstr("16384 x 16384 pixels cannot be in its")));
  }
}

TEST(GltfRefusal, DocumentsThatContradictThemselves) {
  struct Case {
    const char* what;
    std::function<void(Json&)> alter;
    const char* message;
  };
  const Case cases[] = {
      {"node loop", [](Json& j) { j["nodes"][0]["children"] = {0}; }, "reached twice"},
      {"longer loop",
       [](Json& j) {
         j["nodes"][0]["children"] = {1};
         j["nodes"].push_back({{"children", {0}}});
       },
       "reached twice"},
      {"missing node", [](Json& j) { j["scenes"][0]["nodes"] = {7}; }, "node 7"},
      {"negative node", [](Json& j) { j["scenes"][0]["nodes"] = {-1}; }, "node -1"},
      {"missing scene", [](Json& j) { j["scene"] = 3; }, "scene 3"},
      {"missing mesh", [](Json& j) { j["nodes"][0]["mesh"] = 5; }, "mesh 5"},
      {"missing accessor", [](Json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 99; },
       "accessor 99"},
      {"missing index accessor", [](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 99; }, "accessor"},
      {"missing material", [](Json& j) { j["meshes"][0]["primitives"][0]["material"] = 4; }, "material 4"},
      {"unknown mode", [](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 9; }, "mode 9"},
      {"missing view", [](Json& j) { j["accessors"][0]["bufferView"] = 42; }, "bufferView 42"},
      {"missing buffer", [](Json& j) { j["bufferViews"][0]["buffer"] = 42; }, "buffer 42"},
      {"view beyond buffer", [](Json& j) { j["bufferViews"][0]["byteLength"] = 1000; }, "leaves buffer"},
      {"huge offset", [](Json& j) { j["bufferViews"][0]["byteOffset"] = 18446744073709551615u; }, "small.gltf"},
      {"accessor beyond view", [](Json& j) { j["accessors"][0]["count"] = 5; }, "needs 60 bytes"},
      {"huge count", [](Json& j) { j["accessors"][0]["count"] = 4000000000u; }, "limit"},
      {"huge empty accessor",
       [](Json& j) {
         j["accessors"][0].erase("bufferView");
         j["accessors"][0]["count"] = 100000000;
       },
       "limit"},
      {"huge accessor offset", [](Json& j) { j["accessors"][0]["byteOffset"] = 9223372036854775807; }, "small.gltf"},
      {"wrong type", [](Json& j) { j["accessors"][0]["type"] = "VEC2"; }, "accessor 0"},
      {"unknown type", [](Json& j) { j["accessors"][0]["type"] = "VEC9"; }, "small.gltf"},
      {"unknown component", [](Json& j) { j["accessors"][0]["componentType"] = 1; }, "small.gltf"},
      {"index beyond vertices", [](Json& j) { j["accessors"][0]["count"] = j["accessors"][1]["count"] = 3; },
       "vertex 3 of 3"},
      {"uv count", [](Json& j) { j["accessors"][1]["count"] = 3; }, "TEXCOORD_0"},
      {"float indices", [](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 0; }, "accessor 0"},
      {"short buffer", [](Json& j) { j["buffers"][0]["byteLength"] = 1000; }, "announces 1000"},
      {"buffer without data", [](Json& j) { j["buffers"][0].erase("uri"); }, "buffer 0"},
      {"missing buffer file", [](Json& j) { j["buffers"][0]["uri"] = "absent.bin"; }, "absent.bin"},
      {"buffer is no object", [](Json& j) { j["buffers"][0] = 3; }, "buffer 0"},
      {"nodes are strings", [](Json& j) { j["nodes"] = {"a"}; }, "small.gltf"},
      {"wrong matrix", [](Json& j) { j["nodes"][0]["matrix"] = {1, 2, 3}; }, "small.gltf"},
      {"wrong alpha mode", [](Json& j) { j["materials"] = {{{"alphaMode", "HALF"}}}; }, "HALF"},
      {"missing texture",
       [](Json& j) { j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 8}}}}}}}; },
       "texture 8"},
      {"missing image",
       [](Json& j) {
         j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
         j["textures"] = {{{"source", 6}}};
       },
       "image 6"},
      {"deep nesting",
       [](Json& j) {
         Json deep = 1;
         for (int i = 0; i < 200; ++i) deep = Json::array({deep});
         j["extras"] = deep;
       },
       "nested"},
      {"wrong sky", [](Json& j) { j["scenes"][0]["extras"]["probewalk_sky"] = {{"zenith", {-1, 0, 0}}}; }, "zenith"},
      {"wrong start", [](Json& j) { j["scenes"][0]["extras"]["probewalk_start"] = "here"; }, "probewalk_start"},
      {"empty room",
       [](Json& j) {
         j["nodes"][0]["extras"] = {
             {"probewalk_room", "A"}, {"probewalk_room_min", {1, 1, 1}}, {"probewalk_room_max", {0, 2, 2}}};
       },
       "box is empty"},
      {"room moved away",
       [](Json& j) {
         j["nodes"][0]["scale"] = {1e300, 1e300, 1e300};
         j["nodes"][0]["extras"] = {
             {"probewalk_room", "A"}, {"probewalk_room_min", {-1e9, -1, -1}}, {"probewalk_room_max", {1e9, 2, 2}}};
       },
       "out of range"},
      {"light moved away",
       [](Json& j) {
         j["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
         j["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
         j["nodes"][0]["translation"] = {1e200, 0, 0};
       },
       "no valid position"},
      {"light brighter than float",
       [](Json& j) {
         j["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"color", {1e200, 0, 0}}}};
         j["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
       },
       "no valid position"},
      {"sparse beyond",
       [](Json& j) {
         j["accessors"][0]["sparse"] = {{"count", 3},
                                        {"indices", {{"bufferView", 2}, {"componentType", 5123}}},
                                        {"values", {{"bufferView", 1}}}};
       },
       "small.gltf"},
      {"meshopt without data",
       [](Json& j) {
         j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
             {"buffer", 0}, {"byteLength", 48}, {"byteStride", 12}, {"count", 4}, {"mode", "ATTRIBUTES"}};
       },
       "damaged"},
      {"meshopt mode",
       [](Json& j) {
         j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
             {"buffer", 0}, {"byteLength", 48}, {"byteStride", 12}, {"count", 4}, {"mode", "MAGIC"}};
       },
       "MAGIC"},
      {"meshopt stride",
       [](Json& j) {
         j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
             {"buffer", 0}, {"byteLength", 48}, {"byteStride", 13}, {"count", 4}, {"mode", "ATTRIBUTES"}};
       },
       "stride 13"},
      {"meshopt count",
       [](Json& j) {
         j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
             {"buffer", 0}, {"byteLength", 48}, {"byteStride", 12}, {"count", 100000000}, {"mode", "ATTRIBUTES"}};
       },
       "announces"},
      {"meshopt filter",
       [](Json& j) {
         j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}, {"byteLength", 48},
             {"byteStride", 12}, {"count", 4}, {"mode", "ATTRIBUTES"}, {"filter", "QUATERNION"}};
       },
       "QUATERNION"},
  };
  for (const Case& c : cases) {
    GltfScene small = GltfScene::floor();
    c.alter(small.json);
    EXPECT_THAT(refusal(small.write()), AllOf(HasSubstr("small.gltf"), HasSubstr(c.message))) << c.what;
  }
}

TEST(GltfRefusal, InstancesOfInstancesAreBounded) {
  GltfScene small;
  small.add_accessor({}, 5126, "VEC3", 4000000);
  small.json["accessors"][0].erase("bufferView");
  small.add_mesh({{"attributes", {{"POSITION", 0}}}});
  small.json["nodes"] = Json::array();
  Json roots = Json::array();
  for (int i = 0; i < 1000; ++i) {
    small.json["nodes"].push_back({{"mesh", 0}});
    roots.push_back(i);
  }
  small.json["scenes"][0]["nodes"] = roots;
  EXPECT_THAT(refusal(small.write()), HasSubstr("more than"));
}

// Work that grows faster than the file: numbering of equal names, columns of a fence without end.
TEST(GltfRefusal, ManyRoomsOfOneNameAreNumberedInTheirOwnTime) {
  constexpr int kRooms = 30000;
  GltfScene small = GltfScene::floor();
  for (int i = 1; i <= kRooms; ++i) {
    small.json["nodes"].push_back({{"extras",
        {{"probewalk_room", "Hall"}, {"probewalk_room_min", {0, 0, 0}}, {"probewalk_room_max", {1, 1, 1}}}}});
    small.json["scenes"][0]["nodes"].push_back(i);
  }
  const Scene scene = small.load();
  ASSERT_EQ(scene.rooms.size(), std::size_t{kRooms});
  EXPECT_EQ(scene.rooms[0].id, "hall");
  EXPECT_EQ(scene.rooms[1].id, "hall-2");
  EXPECT_EQ(scene.rooms.back().id, "hall-30000");
}

TEST(GltfRefusal, AFenceWithoutEndIsGivenLightInTime) {
  GltfScene small;
  const int position = small.add_floats({0, 0, 0, 5e8f, 0, 0, 5e8f, 2, 0}, "VEC3");
  small.add_mesh({{"attributes", {{"POSITION", position}}}});
  EXPECT_THAT(small.load().light_statement, HasSubstr("soft sky"));
}

TEST(GltfRefusal, AListOfManyObjectsIsReadInTime) {
  constexpr int kNodes = 200000;
  GltfScene small = GltfScene::floor();
  Json nodes = small.json["nodes"];
  for (int i = 1; i < kNodes; ++i) nodes.push_back({{"name", "n"}});
  small.json["nodes"] = nodes;
  EXPECT_EQ(small.load().triangles.size(), 2u);
  std::string rubbish = R"({"asset":{"version":"2.0"},"extras":[)";
  for (int i = 0; i < 1000000; ++i) rubbish += "{},";
  EXPECT_THAT(refusal(GltfScene::write("rubbish.gltf", rubbish + "0]}")), HasSubstr("no triangle"));
}

TEST(GltfRefusal, ATruncatedFileAtEveryLength) {
  const std::string whole = GltfScene::floor().glb();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::string message = refusal(GltfScene::write("cut.glb", whole.substr(0, length)));
    ASSERT_THAT(message, HasSubstr("cut.glb")) << "at " << length;
  }
}

TEST(GltfRefusal, AChangedByteAnywhereNeverDoesMoreThanThrow) {
  const std::string whole = GltfScene::floor().glb();
  for (std::size_t i = 0; i < whole.size(); i += 3) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << (i % 7)));
    refusal(GltfScene::write("damaged.glb", damaged));
  }
}

}  // namespace
}  // namespace probewalk
