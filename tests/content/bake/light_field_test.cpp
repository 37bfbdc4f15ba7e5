#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "content/bake/bake_probe.h"
#include "content/bake/light_field.h"
#include "content/bake/plain_scenes.h"

namespace probewalk {
namespace {

LightOptions quick(int threads = 0) {
  LightOptions options;
  options.samples = 32;
  options.cache_spacing_m = 0.5;
  options.threads = threads;
  return options;
}

TEST(LightField, FillsAFurnaceEvenly) {
  for (float albedo : {0.0f, 0.5f, 0.8f}) {
    Scene scene;
    plain::add_material(scene, glm::vec3(albedo), glm::vec3(10.0f, 20.0f, 40.0f));
    plain::add_box(scene, {-2, 0, -2}, {2, 3, 2}, 0);
    const RayScene rays(scene);
    SilentProgress progress;
    const LightField light(scene, rays, quick(), progress);
    const glm::vec3 expected = glm::vec3(10.0f, 20.0f, 40.0f) / (1.0f - albedo);
    for (glm::vec3 d : {glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(0.6f, 0.7f, 0.2f), glm::vec3(-1, -1, 1)}) {
      const glm::vec3 seen = light.along({0.1f, 1.4f, 0.3f}, glm::normalize(d), 0.01f);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c] / expected[c], 1.0f, 0.02f) << albedo;
    }
  }
}

TEST(LightField, LightsAPlaneByAPointExactly) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.6f));
  plain::add_quad(scene, {-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, 0);
  scene.lights.push_back(plain::point_light({0, 2, 0}, 300.0f));
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField light(scene, rays, quick(), progress);
  for (float x : {0.0f, 0.5f, 1.7f, 4.0f}) {
    const float distance = std::hypot(2.0f, x);
    const float expected = 0.6f * std::numbers::inv_pi_v<float> * 300.0f * 2.0f / (distance * distance * distance);
    EXPECT_NEAR(light.along({x, 1.0f, 0.3f * 0.0f}, {0, -1, 0}, 0.001f).r / expected, 1.0f, 1e-3f);
    EXPECT_EQ(light.along({x, -1.0f, 0.0f}, {0, 1, 0}, 0.001f).r, 0.0f) << "the plane's other side is dark";
  }
}

// A small glowing square over a plane: the patch's points must add up to the light that a Lambertian square sends down.
TEST(LightField, LightsAPlaneByAPanel) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.5f));
  plain::add_material(scene, glm::vec3(0.0f), glm::vec3(1000.0f));
  plain::add_quad(scene, {-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, 0);
  plain::add_quad(scene, {-0.25f, 2, -0.25f}, {0.25f, 2, -0.25f}, {0.25f, 2, 0.25f}, {-0.25f, 2, 0.25f}, 1);
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField light(scene, rays, quick(), progress);
  const float lux = 1000.0f * 0.25f / 4.0f;  // L A / d^2 straight below
  EXPECT_NEAR(light.along({0, 1, 0}, {0, -1, 0}, 0.001f).r / (0.5f * std::numbers::inv_pi_v<float> * lux), 1.0f, 0.04f);
}

TEST(LightField, LightsACurtainFromOneSideOnly) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.7f));
  plain::add_box(scene, {-3, 0, -3}, {3, 3, 3}, 0);
  plain::add_quad(scene, {-3, 0, 0}, {3, 0, 0}, {3, 3, 0}, {-3, 3, 0}, 0);  // parts the room in two
  scene.lights.push_back(plain::point_light({0, 1.5f, 2}, 500.0f));
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField light(scene, rays, quick(), progress);
  const glm::vec3 bright = light.along({0.3f, 1.2f, 1.0f}, {0, 0, -1}, 0.001f);
  const glm::vec3 dark = light.along({0.3f, 1.2f, -1.0f}, {0, 0, 1}, 0.001f);
  EXPECT_GT(bright.g, 10.0f);
  EXPECT_LT(dark.g, 1e-3f * bright.g);
  // The floor runs under the curtain: nothing may leak along it.
  EXPECT_LT(light.along({0.3f, 1.2f, -0.05f}, {0, -1, 0}, 0.001f).g, 0.02f * light.along({0.3f, 1.2f, 0.05f}, {0, -1, 0}, 0.001f).g);
}

TEST(LightField, ShinesOutOfAClosedBulb) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.5f));
  plain::add_quad(scene, {-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, 0);
  plain::add_box(scene, {-0.05f, 1.95f, -0.05f}, {0.05f, 2.05f, 0.05f}, 0);
  scene.lights.push_back(plain::point_light({0, 2, 0}, 300.0f));
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField light(scene, rays, quick(), progress);
  EXPECT_GT(light.along({1, 1, 0}, {0, -1, 0}, 0.001f).r, 1.0f);
}

TEST(LightField, IsTheSameWhateverTheThreads) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.7f));
  plain::add_box(scene, {-2, 0, -2}, {2, 3, 2}, 0);
  plain::add_box(scene, {-0.5f, 0, -0.5f}, {0.5f, 0.8f, 0.5f}, 0);
  scene.lights.push_back(plain::point_light({1, 2, 1}, 100.0f));
  scene.sky.zenith_cd_m2 = glm::vec3(100.0f);
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField one(scene, rays, quick(1), progress), two(scene, rays, quick(2), progress);
  EXPECT_EQ(one.hash(), two.hash());
  EXPECT_GT(one.cache_points(), 100u);
  const ProbeRadiance a = bake_radiance(rays, one, {1.0, 1.5, 0.0}, 32, 1.0f);
  const ProbeRadiance b = bake_radiance(rays, two, {1.0, 1.5, 0.0}, 32, 1.0f);
  EXPECT_EQ(a.rgb9e5, b.rgb9e5);
  EXPECT_EQ(a.texel_w, b.texel_w);
}

TEST(BakeRadiance, AveragesItsSurfaceAndKeepsTheSky) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.0f), glm::vec3(50.0f));
  plain::add_quad(scene, {-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, 0);
  scene.sky.zenith_cd_m2 = scene.sky.horizon_cd_m2 = scene.sky.ground_cd_m2 = glm::vec3(8.0f);
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField light(scene, rays, quick(), progress);
  const ProbeRadiance map = bake_radiance(rays, light, {0.0, 1.0, 0.0}, 64, 2.0f);
  ASSERT_EQ(map.rgb9e5.size(), mip_chain_texels(64));
  for (std::size_t k = 0; k < map.texel_w.size(); ++k) {
    // Outlines must not mix: each texel is the floor's or the sky's radiance, times the scale.
    EXPECT_NEAR(decode_rgb9e5(map.rgb9e5[k]).r, map.texel_w[k] ? 100.0f : 16.0f, 0.5f);
  }
  const glm::vec3 mean = decode_rgb9e5(map.rgb9e5.back());
  EXPECT_GT(mean.r, 16.0f);
  EXPECT_LT(mean.r, 100.0f);
}

}  // namespace
}  // namespace probewalk
