// KHR_draco_mesh_compression, with streams that Draco's own encoder writes, and with what is made of them by damage.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "content/scene/gltf_scene.h"

namespace probewalk {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Stream = std::vector<std::uint8_t>;

enum class Method { kEdgebreaker, kSequential };

Stream encoded(const draco::Mesh& mesh, Method method, int speed = 5) {
  draco::Encoder encoder;
  encoder.SetSpeedOptions(speed, speed);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 10);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 12);
  encoder.SetEncodingMethod(method == Method::kEdgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                                           : draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok()) throw std::runtime_error("Draco's encoder refuses the mesh");
  return {buffer.data(), buffer.data() + buffer.size()};
}

// A level grid of `side` x `side` squares, 1 m each, with normals and texture coordinates in metres. Its attributes
// have the ids 0 (position), 1 (normal), 2 (texture coordinates).
std::unique_ptr<draco::Mesh> grid(int side) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(side * side * 2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  const std::array<float, 3> up{0, 1, 0};
  int face = 0;
  for (int x = 0; x < side; ++x) {
    for (int z = 0; z < side; ++z) {
      const auto corner = [&](int dx, int dz) {
        return std::array<float, 3>{static_cast<float>(x + dx), 0.0f, -static_cast<float>(z + dz)};
      };
      const auto coordinates = [&](int dx, int dz) {
        return std::array<float, 2>{static_cast<float>(x + dx), static_cast<float>(z + dz)};
      };
      const int second[2][2] = {{1, 0}, {1, 1}};
      const int third[2][2] = {{1, 1}, {0, 1}};
      for (int half = 0; half < 2; ++half, ++face) {
        const draco::FaceIndex f(static_cast<std::uint32_t>(face));
        const int* b = second[half];
        const int* c = third[half];
        builder.SetAttributeValuesForFace(position, f, corner(0, 0).data(), corner(b[0], b[1]).data(),
                                          corner(c[0], c[1]).data());
        builder.SetAttributeValuesForFace(normal, f, up.data(), up.data(), up.data());
        builder.SetAttributeValuesForFace(uv, f, coordinates(0, 0).data(), coordinates(b[0], b[1]).data(),
                                          coordinates(c[0], c[1]).data());
      }
    }
  }
  return builder.Finalize();
}

// A document whose one primitive is the stream, without any other data.
GltfScene with_stream(const Stream& stream, const draco::Mesh& mesh, bool required = true) {
  GltfScene small;
  small.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  if (required) small.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const int view = small.add_view(stream);
  const auto accessor = [&](int component_type, const char* type, std::size_t count) {
    small.json["accessors"].push_back({{"componentType", component_type}, {"type", type}, {"count", count}});
    return small.json["accessors"].size() - 1;
  };
  const auto position = accessor(5126, "VEC3", mesh.num_points());
  const auto normal = accessor(5126, "VEC3", mesh.num_points());
  const auto uv = accessor(5126, "VEC2", mesh.num_points());
  const auto index = accessor(5125, "SCALAR", std::size_t{mesh.num_faces()} * 3);
  small.add_mesh({{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}},
                  {"indices", index},
                  {"extensions",
                   {{"KHR_draco_mesh_compression",
                     {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}}}}}});
  return small;
}

// The floor of GltfScene with the stream beside its plain data.
GltfScene with_fallback(const Stream& stream) {
  GltfScene small = GltfScene::floor();
  small.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  small.primitive()["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", small.add_view(stream)}, {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 2}}}};
  return small;
}

TEST(GltfDraco, ReadsBothMethods) {
  const auto mesh = grid(6);
  for (const Method method : {Method::kEdgebreaker, Method::kSequential}) {
    for (const int speed : {0, 5, 10}) {
      const Scene scene = with_stream(encoded(*mesh, method, speed), *mesh).load();
      ASSERT_EQ(scene.triangles.size(), 72u) << speed;
      EXPECT_THAT(scene.warnings, Not(Contains(HasSubstr("Draco"))));
      EXPECT_NEAR(scene.bounds.upper_m.x, 6.0, 1e-3);
      EXPECT_NEAR(scene.bounds.lower_m.z, -6.0, 1e-3);
      double area = 0.0;
      for (const glm::uvec3& corner : scene.triangles) {
        const glm::vec3 a = scene.positions_m[corner.x];
        const glm::vec3 cross = glm::cross(scene.positions_m[corner.y] - a, scene.positions_m[corner.z] - a);
        EXPECT_GT(cross.y, 0.0f) << "faces up";
        area += 0.5 * static_cast<double>(cross.y);
      }
      EXPECT_NEAR(area, 36.0, 0.01);
      for (std::size_t v = 0; v < scene.positions_m.size(); ++v) {
        EXPECT_NEAR(scene.normals[v].y, 1.0f, 0.01f);
        EXPECT_NEAR(scene.uvs[0][v].x, scene.positions_m[v].x, 0.01f);
        EXPECT_NEAR(scene.uvs[0][v].y, -scene.positions_m[v].z, 0.01f);
      }
    }
  }
}

TEST(GltfDraco, ReadsQuantisedAttributesAsTheirAccessorsSay) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_INT16);
  const std::array<std::int16_t, 3> a{0, 0, 0}, b{32767, 0, 0}, c{0, 0, -32767};
  builder.SetAttributeValuesForFace(position, draco::FaceIndex(0), a.data(), b.data(), c.data());
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  ASSERT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  const Stream stream(buffer.data(), buffer.data() + buffer.size());
  for (const bool normalized : {false, true}) {
    GltfScene small = with_stream(stream, *mesh);
    small.primitive()["attributes"] = {{"POSITION", 0}};
    small.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"] = {{"POSITION", 0}};
    small.json["accessors"][0]["componentType"] = 5122;
    small.json["accessors"][0]["normalized"] = normalized;
    EXPECT_NEAR(small.load().bounds.upper_m.x, normalized ? 1.0 : 32767.0, 1e-4);
  }
}

TEST(GltfDraco, IsDecodedOnceForManyInstances) {
  const auto mesh = grid(60);
  GltfScene small = with_stream(encoded(*mesh, Method::kEdgebreaker), *mesh);
  Json roots = Json::array();
  for (int i = 0; i < 40; ++i) {
    small.json["nodes"][static_cast<std::size_t>(i)] = {{"mesh", 0}, {"translation", {100 * i, 0, 0}}};
    roots.push_back(i);
  }
  small.json["scenes"][0]["nodes"] = roots;
  EXPECT_EQ(small.load().triangles.size(), 40u * 7200u);
}

TEST(GltfDraco, IsPreferredToTheUncompressedForm) {
  const auto mesh = grid(6);
  const Scene scene = with_fallback(encoded(*mesh, Method::kEdgebreaker)).load();
  EXPECT_NEAR(scene.bounds.upper_m.x, 6.0, 1e-3) << "the stream's, not the 4 m of the accessors";
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST(GltfDraco, ADamagedStreamCostsNothingWhereTheUncompressedFormIsThere) {
  Stream stream = encoded(*grid(6), Method::kEdgebreaker);
  stream.resize(stream.size() / 2);
  GltfScene small = with_fallback(stream);
  const Scene scene = small.load();
  EXPECT_EQ(scene.bounds.upper_m.x, 4.0);
  EXPECT_THAT(scene.warnings, Contains(AllOf(HasSubstr("Draco"), HasSubstr("its uncompressed form is used"))));
  small.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  EXPECT_THAT(small.refusal(), AllOf(HasSubstr("small.gltf"), HasSubstr("Draco stream in bufferView 3 is damaged")));
}

TEST(GltfDraco, ADamagedStreamIsRefused) {
  const auto mesh = grid(6);
  const Stream whole = encoded(*mesh, Method::kEdgebreaker);
  const auto refusal = [&](const Stream& stream) { return with_stream(stream, *mesh, false).refusal(); };
  EXPECT_THAT(refusal({1, 2, 3}), AllOf(HasSubstr("small.gltf"), HasSubstr("bufferView 0 is no Draco stream")));
  Stream old = whole;
  old[6] = 1;
  EXPECT_THAT(refusal(old), HasSubstr("version 2.1"));
  Stream points = whole;
  points[7] = 0;
  EXPECT_THAT(refusal(points), HasSubstr("holds no triangles"));
  Stream method = whole;
  method[8] = 9;
  EXPECT_THAT(refusal(method), HasSubstr("method 9"));
}

// What precedes the triangles in a stream: magic, version 2.2, mesh, method, flags.
Stream header(Method method) {
  Stream stream{'D', 'R', 'A', 'C', 'O', 2, 2, 1, static_cast<std::uint8_t>(method == Method::kEdgebreaker), 0, 0};
  if (method == Method::kEdgebreaker) stream.push_back(0);  // the traversal
  return stream;
}

void append_varint(Stream& stream, std::uint32_t value) {
  for (; value >= 128; value >>= 7) stream.push_back(static_cast<std::uint8_t>(value | 128));
  stream.push_back(static_cast<std::uint8_t>(value));
}

TEST(GltfDraco, AnnouncedSizesAreCheckedBeforeMemoryIsTaken) {
  const auto mesh = grid(1);
  const auto refusal = [&](Stream stream, std::uint32_t first, std::uint32_t second, std::uint8_t tables,
                           std::size_t size) {
    append_varint(stream, first);
    append_varint(stream, second);
    stream.push_back(tables);
    stream.resize(std::max(stream.size(), size));
    return with_stream(stream, *mesh).refusal();
  };
  constexpr std::uint32_t kMany = 1'400'000'000;  // 33 GB of corner tables
  const Stream edgebreaker = header(Method::kEdgebreaker);
  EXPECT_THAT(refusal(edgebreaker, kMany, kMany, 0, 0), HasSubstr("announces 1400000000 triangles"));
  EXPECT_THAT(refusal(header(Method::kSequential), kMany, kMany, 0, 0), HasSubstr("announces 1400000000 triangles"));
  EXPECT_THAT(refusal(header(Method::kSequential), 1, kMany, 0, 0), HasSubstr("1400000000 vertices"));
  EXPECT_THAT(refusal(edgebreaker, 1000, 30'000'000, 0, 0), HasSubstr("triangles in 19 bytes"));
  EXPECT_THAT(refusal(edgebreaker, 1000, 30'000'000, 255, 4096), HasSubstr("255 attribute tables"));
}

TEST(GltfDraco, TruncatedOrChangedStreamsNeverDoMoreThanThrow) {
  const auto mesh = grid(2);
  for (const Method method : {Method::kEdgebreaker, Method::kSequential}) {
    for (const int speed : {0, 10}) {
      const Stream whole = encoded(*mesh, method, speed);
      for (std::size_t length = 0; length < whole.size(); ++length) {
        const Stream cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
        const std::string message = with_stream(cut, *mesh).refusal();
        ASSERT_TRUE(message == "accepted" || message.find("small.gltf") != std::string::npos) << message;
        if (length + 16 < whole.size()) {
          ASSERT_NE(message, "accepted") << "cut at " << length << " of " << whole.size();
        }
      }
      for (std::size_t i = 0; i < whole.size(); ++i) {
        Stream changed = whole;
        changed[i] = static_cast<std::uint8_t>(changed[i] ^ (1 << (i % 8)));
        const std::string message = with_stream(changed, *mesh).refusal();
        ASSERT_TRUE(message == "accepted" || message.find("small.gltf") != std::string::npos) << message;
      }
    }
  }
}

TEST(GltfDraco, RefusesAttributesThatTheStreamLacks) {
  const auto mesh = grid(2);
  const Stream stream = encoded(*mesh, Method::kEdgebreaker);
  const auto refusal = [&](const Json& id) {
    GltfScene small = with_stream(stream, *mesh);
    small.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = id;
    return small.refusal();
  };
  EXPECT_THAT(refusal(77), AllOf(HasSubstr("mesh 0"), HasSubstr("POSITION has no attribute 77")));
  EXPECT_THAT(refusal(2), HasSubstr("no attribute 2 of 3 components"));
  EXPECT_THAT(refusal(-1), HasSubstr("POSITION"));
  EXPECT_THAT(refusal("0"), HasSubstr("POSITION"));
  GltfScene small = with_stream(stream, *mesh);
  small.primitive()["extensions"]["KHR_draco_mesh_compression"] = Json::object();
  EXPECT_THAT(small.refusal(), HasSubstr("lacks its bufferView"));
  small = with_stream(stream, *mesh);
  small.primitive()["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 42;
  EXPECT_THAT(small.refusal(), HasSubstr("bufferView 42 does not exist"));
}

// The limit of triangles a byte leaves room for the best that the coder can do: quantised to 14 bits, the steps of this
// grid are whole numbers, so that nothing remains to be written but its regularity.
TEST(GltfDraco, AnEvenGridStaysBelowTheLimitOfExpansion) {
  const auto mesh = grid(129);
  const Stream stream = encoded(*mesh, Method::kEdgebreaker, 0);
  EXPECT_LT(33282.0 / static_cast<double>(stream.size()), 2000.0) << "the limit is 16384";
  EXPECT_EQ(with_stream(stream, *mesh).load().triangles.size(), 33282u);
}

}  // namespace
}  // namespace probewalk
