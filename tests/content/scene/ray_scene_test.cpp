#include "content/scene/ray_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "content/error.h"

namespace probewalk {
namespace {

void add_triangle(Scene& scene, glm::vec3 a, glm::vec3 b, glm::vec3 c, std::uint32_t material = 0) {
  const auto first = static_cast<unsigned>(scene.positions_m.size());
  scene.positions_m.insert(scene.positions_m.end(), {a, b, c});
  scene.uvs[0].insert(scene.uvs[0].end(), {{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}});
  scene.triangles.push_back({first, first + 1, first + 2});
  scene.triangle_material.push_back(material);
}

// The right triangle with corners (0,0), (1,0), (0,1) at height z; faces +z.
void add_at_height(Scene& scene, float z, std::uint32_t material = 0) {
  add_triangle(scene, {0, 0, z}, {1, 0, z}, {0, 1, z}, material);
}

// Two columns: alpha `left` for u < 0.5 and `right` above, sampled at their centres 0.25 and 0.75.
int add_alpha_texture(Scene& scene, std::uint8_t left, std::uint8_t right) {
  Texture texture;
  texture.wrap_u = texture.wrap_v = WrapMode::kClampToEdge;
  texture.levels.push_back({2, 1, {255, 255, 255, left, 255, 255, 255, right}});
  scene.textures.push_back(texture);
  return static_cast<int>(scene.textures.size()) - 1;
}

Scene with_material(AlphaMode mode) {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[1].alpha_mode = mode;
  return scene;
}

constexpr glm::vec3 kDown{0, 0, -1};

TEST(RayScene, FindsTheClosestTriangleWithItsNormalAndBarycentrics) {
  Scene scene;
  scene.materials.resize(1);
  add_at_height(scene, 0.0f);
  add_at_height(scene, 1.0f);
  const RayScene rays(scene);
  const SurfaceHit hit = rays.closest({0.25f, 0.5f, 3.0f}, kDown * 2.0f);
  ASSERT_TRUE(hit.hit);
  EXPECT_EQ(hit.triangle, 1u);
  EXPECT_FLOAT_EQ(hit.t, 1.0f);
  EXPECT_NEAR(hit.barycentric.x, 0.25f, 1e-6f);
  EXPECT_NEAR(hit.barycentric.y, 0.5f, 1e-6f);
  EXPECT_EQ(hit.geometric_normal, glm::vec3(0, 0, 1));
  EXPECT_EQ(rays.closest({0.25f, 0.25f, -1.0f}, {0, 0, 1}).geometric_normal, glm::vec3(0, 0, 1))
      << "the normal follows the winding, not the ray";
}

TEST(RayScene, HonoursTheRangeOfDistances) {
  Scene scene;
  scene.materials.resize(1);
  add_at_height(scene, 0.0f);
  const RayScene rays(scene);
  EXPECT_FALSE(rays.closest({0.25f, 0.25f, 1.0f}, kDown, 0.0f, 0.9f).hit);
  EXPECT_FALSE(rays.closest({0.25f, 0.25f, 1.0f}, kDown, 1.1f).hit);
  EXPECT_FALSE(rays.occluded({0.25f, 0.25f, 1.0f}, kDown, 0.0f, 0.9f));
  EXPECT_TRUE(rays.occluded({0.25f, 0.25f, 1.0f}, kDown, 0.0f, 1.1f));
}

TEST(RayScene, APointBelowTheCutOffDoesNotExist) {
  for (const AlphaMode mode : {AlphaMode::kMask, AlphaMode::kBlend}) {
    Scene scene = with_material(mode);
    scene.materials[1].base_color.texture = add_alpha_texture(scene, 255, 0);
    add_at_height(scene, 0.0f);
    add_at_height(scene, 1.0f, 1);
    const RayScene rays(scene);
    EXPECT_EQ(rays.closest({0.2f, 0.1f, 2.0f}, kDown).triangle, 1u);
    EXPECT_EQ(rays.closest({0.8f, 0.1f, 2.0f}, kDown).triangle, 0u);
    EXPECT_TRUE(rays.occluded({0.2f, 0.1f, 2.0f}, kDown, 0.0f, 1.5f));
    EXPECT_FALSE(rays.occluded({0.8f, 0.1f, 2.0f}, kDown, 0.0f, 1.5f));
  }
}

TEST(RayScene, FactorAndCutOffDecideTogether) {
  Scene scene = with_material(AlphaMode::kMask);
  scene.materials[1].base_color.texture = add_alpha_texture(scene, 128, 255);
  scene.materials[1].base_color_factor.a = 0.5f;
  scene.materials[1].alpha_cutoff = 0.4f;
  add_at_height(scene, 1.0f, 1);
  const RayScene rays(scene);
  EXPECT_FALSE(rays.closest({0.2f, 0.1f, 2.0f}, kDown).hit);
  EXPECT_TRUE(rays.closest({0.8f, 0.1f, 2.0f}, kDown).hit);
}

TEST(RayScene, AConstantAlphaNeedsNoTexture) {
  for (const auto& [alpha, exists] : {std::pair{0.49f, false}, std::pair{0.5f, true}}) {
    Scene scene = with_material(AlphaMode::kBlend);
    scene.materials[1].base_color_factor.a = alpha;
    add_at_height(scene, 1.0f, 1);
    EXPECT_EQ(RayScene(scene).closest({0.2f, 0.1f, 2.0f}, kDown).hit, exists) << alpha;
  }
}

TEST(RayScene, OpaqueIgnoresAlpha) {
  Scene scene = with_material(AlphaMode::kOpaque);
  scene.materials[1].base_color.texture = add_alpha_texture(scene, 0, 0);
  add_at_height(scene, 1.0f, 1);
  EXPECT_TRUE(RayScene(scene).closest({0.2f, 0.1f, 2.0f}, kDown).hit);
}

TEST(RayScene, TriangleStaysAnIndexOfTheSceneWhenKindsAreMixed) {
  Scene scene = with_material(AlphaMode::kMask);
  scene.materials[1].base_color.texture = add_alpha_texture(scene, 255, 0);
  for (int i = 0; i < 8; ++i) add_at_height(scene, static_cast<float>(i), i % 3 == 0 ? 1 : 0);
  const RayScene rays(scene);
  for (unsigned i = 0; i < 8; ++i) {
    const SurfaceHit hit = rays.closest({0.1f, 0.1f, static_cast<float>(i) + 0.5f}, kDown);
    ASSERT_TRUE(hit.hit);
    EXPECT_EQ(hit.triangle, i);
  }
}

TEST(RayScene, SurvivesTrianglesWithoutAreaOrWithoutFiniteCorners) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  Scene scene;
  scene.materials.resize(1);
  add_triangle(scene, {0, 0, 1}, {1, 0, 1}, {2, 0, 1});
  add_triangle(scene, {0, 0, 1}, {0, 0, 1}, {0, 0, 1});
  add_triangle(scene, {nan, 0, 1}, {1, 0, 1}, {0, 1, 1});
  add_triangle(scene, {0, 0, 1}, {infinity, 0, 1}, {0, 1, 1});
  add_at_height(scene, 0.0f);
  const RayScene rays(scene);
  const SurfaceHit hit = rays.closest({0.25f, 0.25f, 2.0f}, kDown);
  ASSERT_TRUE(hit.hit);
  EXPECT_EQ(hit.triangle, 4u);
  EXPECT_TRUE(std::isfinite(hit.geometric_normal.x));
}

TEST(RayScene, AnEmptySceneIsMissed) {
  const Scene scene;
  EXPECT_FALSE(RayScene(scene).closest({0, 0, 0}, kDown).hit);
}

TEST(RayScene, NoRaySlipsThroughASharedEdge) {
  Scene scene;
  scene.materials.resize(1);
  // A fan around an irrational centre, seen from above, aimed at its spokes and hub.
  const glm::vec3 hub(0.1f, 0.2f, 0.0f);
  constexpr int kSpokes = 61;
  const auto rim = [](int i) {
    const float angle = 6.2831853f * static_cast<float>(i % kSpokes) / kSpokes;
    return glm::vec3(2.0f * std::cos(angle), 2.0f * std::sin(angle), 0.0f);
  };
  for (int i = 0; i < kSpokes; ++i) add_triangle(scene, hub, rim(i), rim(i + 1));
  const RayScene rays(scene);
  const glm::vec3 eye(0.3f, -0.4f, 1.7f);
  for (int i = 0; i < kSpokes; ++i) {
    for (int k = 0; k < 50; ++k) {
      const glm::vec3 target = glm::mix(hub, rim(i), static_cast<float>(k) / 50.0f);
      EXPECT_TRUE(rays.closest(eye, target - eye).hit);
    }
  }
}

TEST(RayScene, PinsAnInstructionSetOrRefusesItByName) {
  Scene scene;
  scene.materials.resize(1);
  add_at_height(scene, 0.0f);
  EXPECT_TRUE(RayScene(scene, "sse2").closest({0.25f, 0.25f, 1.0f}, kDown).hit);
  try {
    const RayScene rays(scene, "sse5");
    FAIL() << "an unknown name was accepted";
  } catch (const BadUsage& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("sse5"), testing::HasSubstr("avx2")));
  }
}

}  // namespace
}  // namespace probewalk
