#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cmath>
#include <limits>

#include "content/scene/gltf_scene.h"

namespace probewalk {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

glm::vec3 face_normal(const Scene& scene, std::size_t triangle) {
  const glm::uvec3 corner = scene.triangles[triangle];
  return glm::normalize(glm::cross(scene.positions_m[corner.y] - scene.positions_m[corner.x],
                                   scene.positions_m[corner.z] - scene.positions_m[corner.x]));
}

// The triangles that are in the file, without the panels of the default light.
std::size_t file_triangles(const Scene& scene) {
  std::size_t count = 0;
  for (const std::uint32_t material : scene.triangle_material) {
    if (scene.materials[material].name != "default ceiling light") ++count;
  }
  return count;
}

TEST(GltfGeometry, ReadsIndexedTriangles) {
  const Scene scene = GltfScene::floor().load();
  EXPECT_EQ(file_triangles(scene), 2u);
  EXPECT_EQ(scene.name, "small");
  EXPECT_EQ(scene.bounds.lower_m, glm::dvec3(0, 0, -4));
  EXPECT_EQ(scene.bounds.upper_m, glm::dvec3(4, 0, 0));
  EXPECT_EQ(face_normal(scene, 0), glm::vec3(0, 1, 0));
  for (const glm::vec3& normal : scene.normals) EXPECT_EQ(normal, glm::vec3(0, 1, 0)) << "missing normals are flat";
}

TEST(GltfGeometry, ReadsTheSameFromBinaryGltf) {
  const GltfScene small = GltfScene::floor();
  SceneLoadOptions options;
  options.scale = 1.0;
  const Scene json = load_scene(small.write(), options);
  const Scene binary = load_scene(GltfScene::write("small.glb", small.glb()), options);
  EXPECT_EQ(json.positions_m, binary.positions_m);
  EXPECT_EQ(json.triangles, binary.triangles);
  EXPECT_NE(json.content_hash, binary.content_hash);
}

TEST(GltfGeometry, ReadsWithoutIndices) {
  GltfScene small;
  small.add_mesh({{"attributes", {{"POSITION", small.add_floats({0, 0, 0, 1, 0, 0, 0, 0, -1}, "VEC3")}}}});
  EXPECT_EQ(file_triangles(small.load()), 1u);
}

TEST(GltfGeometry, TurnsStripsAndFansIntoTrianglesThatFaceAlike) {
  for (const int mode : {5, 6}) {
    GltfScene small;
    const std::vector<float> strip{0, 0, 0, 1, 0, 0, 0, 0, -1, 1, 0, -1, 0, 0, -2};
    const std::vector<float> fan{0, 0, 0, 1, 0, 0, 1, 0, -1, 0, 0, -1, -1, 0, -1};
    small.add_mesh({{"attributes", {{"POSITION", small.add_floats(mode == 5 ? strip : fan, "VEC3")}}}, {"mode", mode}});
    const Scene scene = small.load();
    ASSERT_EQ(file_triangles(scene), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(face_normal(scene, i), glm::vec3(0, 1, 0)) << mode << " " << i;
  }
}

TEST(GltfGeometry, SkipsPointsAndLinesWithAWarning) {
  GltfScene small = GltfScene::floor();
  Json points = small.primitive();
  points["mode"] = 0;
  small.json["meshes"][0]["primitives"].push_back(points);
  const Scene scene = small.load();
  EXPECT_EQ(file_triangles(scene), 2u);
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("points or lines")));
}

TEST(GltfGeometry, AppliesTranslationRotationAndScaleOfAllAncestors) {
  GltfScene small = GltfScene::floor();
  const double half = std::sqrt(0.5);
  small.json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}},
                         {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {2, 1, 1}}}};
  const Scene scene = small.load();
  // Scaled along x to 8, then turned a quarter about z: x becomes y.
  EXPECT_NEAR(scene.bounds.upper_m.y, 8.0, 1e-6);
  EXPECT_NEAR(scene.bounds.lower_m.x, 10.0, 1e-6);
  EXPECT_EQ(scene.triangle_object[0], 1u);
  EXPECT_NEAR(face_normal(scene, 0).x, -1.0f, 1e-6f);
}

TEST(GltfGeometry, AppliesMatrices) {
  GltfScene small = GltfScene::floor();
  small.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
  EXPECT_EQ(small.load().bounds.lower_m, glm::dvec3(5, 6, 3));
}

TEST(GltfGeometry, MirroringKeepsTheOutsideOutside) {
  GltfScene small = GltfScene::floor();
  const int normals = small.add_floats({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3");
  small.primitive()["attributes"]["NORMAL"] = normals;
  small.json["nodes"][0]["scale"] = {-1, 1, 1};
  const Scene scene = small.load();
  EXPECT_EQ(face_normal(scene, 0), glm::vec3(0, 1, 0));
  EXPECT_EQ(scene.normals[0], glm::vec3(0, 1, 0));
}

TEST(GltfGeometry, NormalsFollowUnevenScalesLikeSurfacesDo) {
  GltfScene small;
  const float s = std::sqrt(0.5f);
  const int position = small.add_floats({0, 0, 0, 1, -1, 0, 0, 0, -1}, "VEC3");
  const int normal = small.add_floats({s, s, 0, s, s, 0, s, s, 0}, "VEC3");
  small.add_mesh({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}});
  small.json["nodes"][0]["scale"] = {3, 1, 1};
  const Scene scene = small.load();
  EXPECT_NEAR(glm::distance(scene.normals[0], face_normal(scene, 0)), 0.0f, 1e-6f);
}

TEST(GltfGeometry, ReadsEveryComponentType) {
  // The same floor, 4 units wide, quantised: KHR_mesh_quantization is nothing but that.
  const std::vector<std::int16_t> shorts{0, 0, 0, 4, 0, 0, 4, 0, -4};
  const std::vector<std::int8_t> bytes{0, 0, 0, 4, 0, 0, 4, 0, -4};
  const std::vector<std::int16_t> normalized{0, 0, 0, 32767, 0, 0, 32767, 0, -32767};
  struct Case {
    std::vector<std::uint8_t> data;
    int type;
    bool normalized;
    double width;
  };
  for (const Case& c : {Case{bytes_of(shorts), 5122, false, 4.0}, Case{bytes_of(bytes), 5120, false, 4.0},
                        Case{bytes_of(normalized), 5122, true, 1.0}}) {
    GltfScene small;
    small.json["extensionsRequired"] = small.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    const int position = small.add_accessor(c.data, c.type, "VEC3", 3);
    small.json["accessors"][position]["normalized"] = c.normalized;
    small.add_mesh({{"attributes", {{"POSITION", position}}}});
    EXPECT_NEAR(small.load().bounds.upper_m.x, c.width, 1e-6) << c.type;
  }
}

TEST(GltfGeometry, ReadsEveryIndexType) {
  const std::vector<std::pair<int, std::vector<std::uint8_t>>> cases{
      {5121, bytes_of<std::uint8_t>({0, 1, 2})},
      {5123, bytes_of<std::uint16_t>({0, 1, 2})},
      {5125, bytes_of<std::uint32_t>({0, 1, 2})}};
  for (const auto& [type, data] : cases) {
    GltfScene small = GltfScene::floor();
    small.primitive()["indices"] = small.add_accessor(data, type, "SCALAR", 3);
    EXPECT_EQ(file_triangles(small.load()), 1u) << type;
  }
}

TEST(GltfGeometry, ReadsInterleavedVertices) {
  GltfScene small;
  const int view = small.add_view(bytes_of<float>({0, 0, 0, 9, 1, 0, 0, 9, 0, 0, -1, 9}));
  small.json["bufferViews"][view]["byteStride"] = 16;
  small.json["accessors"].push_back({{"bufferView", view}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 3}});
  small.add_mesh({{"attributes", {{"POSITION", 0}}}});
  const Scene scene = small.load();
  EXPECT_EQ(scene.bounds.upper_m, glm::dvec3(1, 0, 0));
  EXPECT_EQ(scene.bounds.lower_m, glm::dvec3(0, 0, -1));
}

TEST(GltfGeometry, AppliesSparseReplacements) {
  GltfScene small = GltfScene::floor();
  const int indices = small.add_view(bytes_of<std::uint16_t>({1, 2}));
  const int values = small.add_view(bytes_of<float>({6, 0, 0, 6, 0, -4}));
  small.json["accessors"][0]["sparse"] = {{"count", 2},
                                          {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                          {"values", {{"bufferView", values}}}};
  EXPECT_EQ(small.load().bounds.upper_m.x, 6.0);
}

TEST(GltfGeometry, LeavesOutWhatIsNotFiniteOrHasNoArea) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  GltfScene small;
  const int position = small.add_floats({0, 0, 0, 1, 0, 0, 0, 0, -1,  //
                                         nan, 0, 0, 1, 0, 0, 0, 0, -1,  //
                                         0, 0, 0, 1, 0, 0, 2, 0, 0},
                                        "VEC3");
  small.add_mesh({{"attributes", {{"POSITION", position}}}});
  const Scene scene = small.load();
  EXPECT_EQ(file_triangles(scene), 1u);
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("1 triangles with corners that are not finite")));
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("1 triangles without area")));
  for (const glm::vec3& p : scene.positions_m) EXPECT_TRUE(std::isfinite(p.x));
}

TEST(GltfGeometry, ShowsTheRestPoseOfWhatMovesAndSaysSo) {
  GltfScene small = GltfScene::floor();
  small.json["animations"] = {{{"channels", Json::array()}, {"samplers", Json::array()}}};
  small.json["skins"] = {{{"joints", {0}}}};
  const Scene scene = small.load();
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("animations: the rest pose")));
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("skins: the rest pose")));
}

TEST(GltfGeometry, ShowsOnlyTheDefaultScene) {
  GltfScene small = GltfScene::floor();
  small.json["nodes"].push_back({{"mesh", 0}, {"translation", {50, 0, 0}}});
  EXPECT_EQ(small.load().bounds.upper_m.x, 4.0);
  small.json.erase("scenes");
  small.json.erase("scene");
  EXPECT_EQ(small.load().bounds.upper_m.x, 54.0) << "without scenes every root is shown";
}

// Replaces the floor's views by compressed ones, as gltfpack writes them: a fallback buffer without data.
void compress(GltfScene& small, int view, const std::vector<std::uint8_t>& packed, std::size_t count,
              std::size_t stride, const char* mode, const char* filter = "NONE") {
  const std::size_t fallback = small.json["buffers"].size();
  small.json["buffers"].push_back(
      {{"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  const int packed_view = small.add_view(packed);
  const Json buffer = small.json["bufferViews"][packed_view]["buffer"];
  small.json["bufferViews"][view] = {{"buffer", fallback},
                                     {"byteLength", count * stride},
                                     {"extensions",
                                      {{"EXT_meshopt_compression",
                                        {{"buffer", buffer},
                                         {"byteLength", packed.size()},
                                         {"byteStride", stride},
                                         {"count", count},
                                         {"mode", mode},
                                         {"filter", filter}}}}}};
  small.json["extensionsUsed"] = small.json["extensionsRequired"] = {"EXT_meshopt_compression"};
}

std::vector<std::uint8_t> encode_vertices(const void* data, std::size_t count, std::size_t stride) {
  std::vector<std::uint8_t> packed(meshopt_encodeVertexBufferBound(count, stride));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), data, count, stride));
  return packed;
}

TEST(GltfGeometry, DecodesMeshoptAttributesTrianglesAndSequences) {
  const std::vector<float> positions{0, 0, 0, 4, 0, 0, 4, 0, -4, 0, 0, -4};
  const std::vector<unsigned> indices{0, 1, 2, 0, 2, 3};
  const Scene plain = GltfScene::floor().load();
  for (const bool sequence : {false, true}) {
    GltfScene small = GltfScene::floor();
    compress(small, 0, encode_vertices(positions.data(), 4, 12), 4, 12, "ATTRIBUTES");
    std::vector<std::uint8_t> packed(256);
    packed.resize(sequence ? meshopt_encodeIndexSequence(packed.data(), packed.size(), indices.data(), 6)
                           : meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), 6));
    compress(small, 2, packed, 6, 2, sequence ? "INDICES" : "TRIANGLES");
    const Scene scene = small.load();
    ASSERT_EQ(file_triangles(scene), 2u);
    EXPECT_EQ(scene.bounds.upper_m, plain.bounds.upper_m);
    EXPECT_EQ(scene.bounds.lower_m, plain.bounds.lower_m);
    EXPECT_EQ(face_normal(scene, 1), glm::vec3(0, 1, 0));
  }
}

TEST(GltfGeometry, DecodesMeshoptFilters) {
  const std::vector<float> positions{0, 0, 0, 4, 0, 0, 4, 0, -4, 0, 0, -4};
  std::vector<std::uint32_t> exponential(12);
  meshopt_encodeFilterExp(exponential.data(), 4, 12, 15, positions.data(), meshopt_EncodeExpSeparate);
  GltfScene small = GltfScene::floor();
  compress(small, 0, encode_vertices(exponential.data(), 4, 12), 4, 12, "ATTRIBUTES", "EXPONENTIAL");

  const float tilt = std::sqrt(0.5f);
  const std::vector<float> normals{0, 1, 0, 0, tilt, tilt, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0};
  std::vector<std::int8_t> octahedral(16);
  meshopt_encodeFilterOct(octahedral.data(), 4, 4, 8, normals.data());
  const int normal = small.add_accessor(bytes_of(octahedral), 5120, "VEC3", 4);
  const int view = small.json["accessors"][normal]["bufferView"];
  small.json["accessors"][normal]["normalized"] = true;
  small.primitive()["attributes"]["NORMAL"] = normal;
  compress(small, view, encode_vertices(octahedral.data(), 4, 4), 4, 4, "ATTRIBUTES", "OCTAHEDRAL");
  small.json["bufferViews"][view]["byteStride"] = 4;

  const Scene scene = small.load();
  EXPECT_NEAR(scene.bounds.upper_m.x, 4.0, 1e-3);
  EXPECT_NEAR(scene.normals[0].y, 1.0f, 0.01f);
  EXPECT_NEAR(scene.normals[1].x, tilt, 0.02f);
}

TEST(GltfGeometry, IsTheSameEveryTime) {
  const GltfScene small = GltfScene::floor();
  const Scene a = small.load();
  const Scene b = small.load();
  EXPECT_EQ(a.positions_m, b.positions_m);
  EXPECT_EQ(a.content_hash, b.content_hash);
}

}  // namespace
}  // namespace probewalk
