// EXT_mesh_gpu_instancing and the tree of nodes around it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "content/scene/gltf_scene.h"

namespace probewalk {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// One triangle (0, 0, 0), (1, 0, 0), (0, 0, -1), facing up, shown through the attributes.
GltfScene instanced(const Json& attributes = Json::object()) {
  GltfScene small;
  small.add_mesh({{"attributes", {{"POSITION", small.add_floats({0, 0, 0, 1, 0, 0, 0, 0, -1}, "VEC3")}}}});
  small.json["extensionsUsed"] = small.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  small.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  return small;
}

Json& attributes(GltfScene& small, std::size_t node = 0) {
  return small.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
}

// The three corners of a triangle of the scene.
std::vector<glm::vec3> corners(const Scene& scene, std::size_t triangle) {
  const glm::uvec3 t = scene.triangles[triangle];
  return {scene.positions_m[t.x], scene.positions_m[t.y], scene.positions_m[t.z]};
}

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-5f) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << a.x << " " << a.y << " " << a.z << " for " << b.x << " " << b.y << " " << b.z;
}

TEST(GltfInstancing, PlacesByTranslationRotationAndScale) {
  const float half = std::sqrt(0.5f);
  GltfScene small = instanced();
  attributes(small) = {{"TRANSLATION", small.add_floats({10, 0, 0, 20, 0, 0}, "VEC3")},
                       {"ROTATION", small.add_floats({0, 0, 0, 1, 0, 0, half, half}, "VEC4")},
                       {"SCALE", small.add_floats({1, 1, 1, 3, 1, 1}, "VEC3")}};
  const Scene scene = small.load();
  ASSERT_EQ(scene.triangles.size(), 2u);
  EXPECT_THAT(scene.warnings, Not(Contains(HasSubstr("EXT_mesh_gpu_instancing"))));
  expect_near(corners(scene, 0)[1], {11, 0, 0});
  expect_near(corners(scene, 1)[0], {20, 0, 0});
  expect_near(corners(scene, 1)[1], {20, 3, 0});  // scaled along x, then a quarter about z, then moved
  EXPECT_EQ(scene.triangle_object, (std::vector<std::uint32_t>{0, 0}));
}

TEST(GltfInstancing, AnyAttributeMayBeAbsent) {
  GltfScene moved = instanced();
  attributes(moved) = {{"TRANSLATION", moved.add_floats({0, 1, 0, 0, 2, 0, 0, 3, 0}, "VEC3")}};
  EXPECT_EQ(moved.load().bounds.upper_m, glm::dvec3(1, 3, 0));
  EXPECT_EQ(moved.load().triangles.size(), 3u);

  const float half = std::sqrt(0.5f);
  GltfScene turned = instanced();
  attributes(turned) = {{"ROTATION", turned.add_floats({0, 0, half, half, 0, 0, 0, 1}, "VEC4")}};
  expect_near(corners(turned.load(), 0)[1], {0, 1, 0});

  GltfScene scaled = instanced();
  attributes(scaled) = {{"SCALE", scaled.add_floats({2, 2, 2, -1, 1, 1}, "VEC3")}};
  const Scene scene = scaled.load();
  EXPECT_EQ(scene.bounds.upper_m.x, 2.0);
  EXPECT_EQ(scene.bounds.lower_m.x, -1.0);
  for (std::size_t i = 0; i < 2; ++i) {
    const std::vector<glm::vec3> c = corners(scene, i);
    EXPECT_GT(glm::cross(c[1] - c[0], c[2] - c[0]).y, 0.0f) << "a mirrored instance faces as the mesh does";
  }

  GltfScene labelled = instanced();
  attributes(labelled) = {{"_ID", labelled.add_floats({1, 2, 3}, "SCALAR")}};
  EXPECT_EQ(labelled.load().triangles.size(), 1u) << "instances that all lie on each other are one";
}

TEST(GltfInstancing, RotationsMayBeQuantised) {
  const std::vector<std::int8_t> bytes{0, 0, 90, 90};
  const std::vector<std::int16_t> shorts{0, 0, 23170, 23170};
  for (const bool wide : {false, true}) {
    GltfScene small = instanced();
    const int rotation = small.add_accessor(wide ? bytes_of(shorts) : bytes_of(bytes), wide ? 5122 : 5120, "VEC4", 1);
    small.json["accessors"][rotation]["normalized"] = true;
    attributes(small) = {{"ROTATION", rotation}};
    expect_near(corners(small.load(), 0)[1], {0, 1, 0});
  }
}

TEST(GltfInstancing, WorksBelowTransformedAndInstancedNodes) {
  GltfScene small = instanced();
  // A turned parent, a moved node of 2 instances, a child of that node with 3 of its own: a node's instances are of its
  // mesh, not of its children.
  const double half = std::sqrt(0.5);
  const Json two = {{"TRANSLATION", small.add_floats({0, 0, 0, 5, 0, 0}, "VEC3")}};
  const Json three = {{"TRANSLATION", small.add_floats({0, 0, 0, 0, 1, 0, 0, 2, 0}, "VEC3")}};
  small.json["nodes"] = {{{"rotation", {0, half, 0, half}}, {"children", {1}}},
                         {{"mesh", 0}, {"translation", {100, 0, 0}}, {"children", {2}}},
                         {{"mesh", 0}, {"scale", {2, 2, 2}}, {"translation", {0, 10, 0}}}};
  attributes(small, 1) = two;
  attributes(small, 2) = three;
  const Scene scene = small.load();
  ASSERT_EQ(scene.triangles.size(), 5u);
  EXPECT_EQ(scene.triangle_object, (std::vector<std::uint32_t>{1, 1, 2, 2, 2}));
  // A quarter about y turns x to -z.
  expect_near(corners(scene, 1)[0], {0, 0, -105}, 1e-4f);
  expect_near(corners(scene, 4)[0], {0, 14, -100}, 1e-4f);
  expect_near(corners(scene, 4)[1], {0, 14, -102}, 1e-4f);
}

TEST(GltfInstancing, AnInstanceThatIsNotFiniteIsLeftOut) {
  GltfScene small = instanced();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  attributes(small) = {{"TRANSLATION", small.add_floats({nan, 0, 0, 1, 0, 0}, "VEC3")}};
  const Scene scene = small.load();
  EXPECT_EQ(scene.triangles.size(), 1u);
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("1 triangles with corners that are not finite")));
}

TEST(GltfInstancing, RefusesWhatContradictsItself) {
  GltfScene unequal = instanced();
  attributes(unequal) = {{"TRANSLATION", unequal.add_floats({0, 0, 0, 1, 0, 0}, "VEC3")},
                         {"SCALE", unequal.add_floats({1, 1, 1}, "VEC3")}};
  EXPECT_THAT(unequal.refusal(), AllOf(HasSubstr("small.gltf"), HasSubstr("node 0"), HasSubstr("2 and 1 instances")));

  for (const Json& value : {Json(77), Json(-1), Json("a"), Json(1.5)}) {
    GltfScene absent = instanced();
    attributes(absent) = {{"SCALE", value}};
    EXPECT_THAT(absent.refusal(), HasSubstr("small.gltf")) << value;
  }
  GltfScene empty = instanced();
  empty.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = Json::object();
  EXPECT_THAT(empty.refusal(), HasSubstr("no attributes"));
}

TEST(GltfInstancing, TheNumberOfInstancesIsBounded) {
  // Zeros without data: the cheapest way to ask for many.
  GltfScene many = instanced();
  many.json["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 2'000'000}});
  attributes(many) = {{"TRANSLATION", many.json["accessors"].size() - 1}};
  EXPECT_THAT(many.refusal(), HasSubstr("2000000 instances, more than the limit"));
  many.json["accessors"].back()["count"] = 1'000'000;
  Json roots = Json::array({0});
  for (int i = 1; i < 4; ++i) {
    many.json["nodes"].push_back(many.json["nodes"][0]);
    roots.push_back(i);
  }
  many.json["scenes"][0]["nodes"] = roots;
  EXPECT_THAT(many.refusal(), HasSubstr("instances"));
}

TEST(GltfNodes, HierarchiesThatAreTooDeepAreRefused) {
  GltfScene small = GltfScene::floor();
  const auto chain = [&](std::size_t length) {
    small.json["nodes"] = Json::array();
    for (std::size_t i = 0; i + 1 < length; ++i) small.json["nodes"].push_back({{"children", {i + 1}}});
    small.json["nodes"].push_back({{"mesh", 0}});
  };
  chain(500);
  EXPECT_EQ(small.load().triangles.size(), 2u);
  chain(3000);
  EXPECT_THAT(small.refusal(), AllOf(HasSubstr("small.gltf"), HasSubstr("more than 1024 nodes below a root")));
}

}  // namespace
}  // namespace probewalk
