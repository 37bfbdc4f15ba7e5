// The flaws that people's files have: what can be left out is, with a warning; what cannot is refused by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>
#include <limits>

#include "content/scene/gltf_scene.h"

namespace probewalk {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

TEST(GltfDefects, VerticesThatAreNotFiniteCostTheirTriangles) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf, 3e38f}) {
    GltfScene small = GltfScene::floor();
    small.json["accessors"][0] = small.json["accessors"][static_cast<std::size_t>(
        small.add_floats({bad, 0, 0, 4, 0, 0, 4, 0, -4, 0, 0, -4}, "VEC3"))];
    small.primitive()["indices"] =
        small.add_accessor(bytes_of<std::uint16_t>({0, 1, 2, 1, 2, 3, 0, 2, 3}), 5123, "SCALAR", 9);
    const Scene scene = small.load();
    EXPECT_EQ(scene.triangles.size(), 1u) << bad;
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("2 triangles with corners that are not finite left out"))) << bad;
    EXPECT_EQ(scene.bounds.upper_m.x, 4.0);
  }
}

TEST(GltfDefects, NormalsAndCoordinatesThatAreNotFiniteAreReplaced) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  GltfScene small = GltfScene::floor();
  small.primitive()["attributes"]["NORMAL"] = small.add_floats({nan, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0}, "VEC3");
  small.primitive()["attributes"]["TEXCOORD_0"] = small.add_floats({nan, 0, 1, 0, 1, 1, 0, 1}, "VEC2");
  const Scene scene = small.load();
  for (const glm::vec3& normal : scene.normals) EXPECT_EQ(normal, glm::vec3(0, 1, 0));
  for (const glm::vec2& uv : scene.uvs[0]) EXPECT_TRUE(uv.x == uv.x);
}

TEST(GltfDefects, EmptyMeshesAndPrimitivesAreNothingToSee) {
  GltfScene small = GltfScene::floor();
  small.json["meshes"].push_back({{"primitives", Json::array()}});
  small.json["nodes"].push_back({{"mesh", 1}});
  const int none = small.add_floats({}, "VEC3");
  small.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", none}}}}}}});
  small.json["nodes"].push_back({{"mesh", 2}});
  const int no_index = small.add_accessor({}, 5123, "SCALAR", 0);
  small.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", no_index}}}}});
  small.json["nodes"].push_back({{"mesh", 3}});
  small.json["scenes"][0]["nodes"] = {0, 1, 2, 3};
  EXPECT_EQ(small.load().triangles.size(), 2u);
  small.json["scenes"][0]["nodes"] = {1, 2, 3};
  EXPECT_THAT(small.refusal(), HasSubstr("no triangle to show"));
}

TEST(GltfDefects, PrimitivesWithoutPositionsAreSkippedWithAWarning) {
  GltfScene small = GltfScene::floor();
  small.json["meshes"][0]["primitives"].push_back({{"attributes", {{"TEXCOORD_0", 1}}}});
  small.json["meshes"][0]["primitives"].push_back({{"attributes", Json::object()}});
  const Scene scene = small.load();
  EXPECT_EQ(scene.triangles.size(), 2u);
  EXPECT_THAT(scene.warnings, Contains("2 primitives without positions skipped"));
}

TEST(GltfDefects, AnIndexOutOfRangeIsRefusedByMeshAndPrimitive) {
  GltfScene small = GltfScene::floor();
  small.json["meshes"][0]["name"] = "Sofa";
  Json second = small.primitive();
  second["indices"] = small.add_accessor(bytes_of<std::uint16_t>({0, 1, 9}), 5123, "SCALAR", 3);
  small.json["meshes"][0]["primitives"].push_back(second);
  EXPECT_THAT(small.refusal(), HasSubstr("small.gltf: mesh 0 'Sofa', primitive 1: an index refers to vertex 9 of 4"));
}

TEST(GltfDefects, AMissingBufferIsRefusedByItsFile) {
  GltfScene small = GltfScene::floor();
  small.json["buffers"][1]["uri"] = "geometry/absent.bin";
  EXPECT_THAT(small.refusal(), AllOf(HasSubstr("small.gltf"), HasSubstr("geometry/absent.bin: no such file")));
}

TEST(GltfDefects, SparseAccessorsWorkWithoutABase) {
  GltfScene small = GltfScene::floor();
  const int indices = small.add_view(bytes_of<std::uint8_t>({1, 2, 3}));
  const int values = small.add_view(bytes_of<float>({6, 0, 0, 6, 0, -4, 0, 0, -4}));
  small.json["accessors"][0].erase("bufferView");
  small.json["accessors"][0]["sparse"] = {{"count", 3},
                                          {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                          {"values", {{"bufferView", values}}}};
  const Scene scene = small.load();
  EXPECT_EQ(scene.triangles.size(), 2u) << "vertex 0 is the origin, as nothing says otherwise";
  EXPECT_EQ(scene.bounds.upper_m, glm::dvec3(6, 0, 0));
  EXPECT_EQ(scene.bounds.lower_m, glm::dvec3(0, 0, -4));
  small.json["accessors"][0]["sparse"]["count"] = 5;
  EXPECT_THAT(small.refusal(), HasSubstr("accessor 0 has an invalid sparse part"));
  small.json["accessors"][0]["sparse"]["count"] = 3;
  small.json["accessors"][0]["count"] = 3;
  small.json["accessors"][1]["count"] = 3;
  EXPECT_THAT(small.refusal(), HasSubstr("accessor 0 replaces element 3 of 3"));
}

TEST(GltfDefects, UnknownExtensionsAreNamed) {
  GltfScene small = GltfScene::floor();
  small.json["extensionsUsed"] = {"KHR_mesh_quantization", "VENDOR_glitter"};
  EXPECT_THAT(small.load().warnings, Contains("extensions without effect here: VENDOR_glitter"));
  small.json["extensionsRequired"] = {"KHR_draco_mesh_compression", "VENDOR_glitter"};
  EXPECT_THAT(small.refusal(), AllOf(HasSubstr("small.gltf"), HasSubstr("needs the extension VENDOR_glitter,")));
}

// One mesh of two million triangles, as scanners write them, loads in a moment. Processor time, as the machine may be
// busy with other things; the bound leaves room for slow ones and for sanitizers.
TEST(GltfDefects, OneMeshOfTwoMillionTrianglesLoadsInSeconds) {
  constexpr std::uint32_t kSide = 1000;
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t x = 0; x <= kSide; ++x) {
    for (std::uint32_t z = 0; z <= kSide; ++z) {
      positions.insert(positions.end(), {0.01f * static_cast<float>(x), 0.0f, -0.01f * static_cast<float>(z)});
      if (x == kSide || z == kSide) continue;
      const std::uint32_t a = x * (kSide + 1) + z;
      const std::uint32_t b = a + kSide + 1;
      indices.insert(indices.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  }
  GltfScene small;
  const auto file = [&](const char* name, const std::vector<std::uint8_t>& bytes) {
    GltfScene::write(name, std::string(bytes.begin(), bytes.end()));
    small.json["buffers"].push_back({{"byteLength", bytes.size()}, {"uri", name}});
    small.json["bufferViews"].push_back({{"buffer", small.json["buffers"].size() - 1}, {"byteLength", bytes.size()}});
  };
  file("positions.bin", bytes_of(positions));
  file("indices.bin", bytes_of(indices));
  small.json["accessors"] = {
      {{"bufferView", 0}, {"componentType", 5126}, {"type", "VEC3"}, {"count", positions.size() / 3}},
      {{"bufferView", 1}, {"componentType", 5125}, {"type", "SCALAR"}, {"count", indices.size()}}};
  small.add_mesh({{"attributes", {{"POSITION", 0}}}, {"indices", 1}});
  const std::clock_t begin = std::clock();
  const Scene scene = small.load();
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  EXPECT_EQ(scene.triangles.size(), 2u * kSide * kSide);
  EXPECT_LT(seconds, 30.0);
}

}  // namespace
}  // namespace probewalk
