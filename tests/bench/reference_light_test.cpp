// The judge of baked light against closed forms, and its ways of sampling against each other.
#include "bench/reference_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "content/box_scene.h"

namespace probewalk {
namespace {

using bench::ReferenceLight;

struct Estimate {
  double mean = 0.0, error = 0.0;  // lux, its standard error
};

Estimate estimate(const ReferenceLight& light, glm::vec3 at_m, int paths) {
  std::mt19937 random(7);
  double sum = 0.0, squares = 0.0;
  for (int k = 0; k < paths; ++k) {
    const double value = light.path(at_m, {0, 1, 0}, {0, 1, 0}, random).sum().g;
    sum += value, squares += value * value;
  }
  const double mean = sum / paths;
  return {mean, std::sqrt(std::max(squares / paths - mean * mean, 0.0) / paths)};
}

void set_last_material(Scene& scene, std::size_t first_triangle, std::uint32_t material) {
  for (std::size_t t = first_triangle; t < scene.triangles.size(); ++t) scene.triangle_material[t] = material;
}

// A lamp a metre wide, one metre above the floor.
Scene lamp_over_floor(float floor_albedo) {
  BoxScene box;
  box.floor({-4, -4}, {4, 4}, 0.0f);
  const std::size_t floor_triangles = box.scene.triangles.size();
  box.floor({-0.5f, -0.5f}, {0.5f, 0.5f}, 1.0f);
  box.scene.materials[0].base_color_factor = glm::vec4(floor_albedo);
  box.scene.materials.resize(2);
  box.scene.materials[1].base_color_factor = glm::vec4(floor_albedo);
  box.scene.materials[1].emissive_cd_m2 = glm::vec3(10.0f);
  set_last_material(box.scene, floor_triangles, 1);
  return box.scene;
}

TEST(ReferenceLight, KeepsAWhiteFurnaceAtItsClosedForm) {
  BoxScene box;
  box.room({-1, 0, -1}, {1, 2, 1});
  box.scene.materials[0].base_color_factor = glm::vec4(0.6f);
  box.scene.materials[0].emissive_cd_m2 = glm::vec3(2.0f);
  const RayScene rays(box.scene);
  const Estimate found = estimate(ReferenceLight(box.scene, rays), {0.3f, 0.0f, 0.2f}, 60000);
  const double truth = std::numbers::pi * 2.0 / (1.0 - 0.6);
  EXPECT_LT(found.error, 0.01 * truth);
  EXPECT_NEAR(found.mean, truth, 4.0 * found.error);
}

TEST(ReferenceLight, GivesALampTheFormFactorOfItsRectangle) {
  const Scene scene = lamp_over_floor(0.0f);
  const RayScene rays(scene);
  const double a = 0.5, root = std::sqrt(1.0 + a * a);
  const double truth = 10.0 * std::numbers::pi * 4.0 / std::numbers::pi * a / root * std::atan(a / root);
  for (const auto sampling :
       {ReferenceLight::Sampling::kBoth, ReferenceLight::Sampling::kHits, ReferenceLight::Sampling::kAreas}) {
    const Estimate found = estimate(ReferenceLight(scene, rays, {}, {}, sampling), {0, 0, 0}, 60000);
    EXPECT_LT(found.error, 0.01 * truth);
    EXPECT_NEAR(found.mean, truth, 4.0 * found.error) << int(sampling);
  }
}

TEST(ReferenceLight, SamplesAlikeByAreasAndHitsBetweenSurfacesThatReflect) {
  const Scene scene = lamp_over_floor(0.8f);
  const RayScene rays(scene);
  const glm::vec3 at_m(0.4f, 0.0f, 0.3f);
  const Estimate both = estimate(ReferenceLight(scene, rays), at_m, 60000);
  for (const auto sampling : {ReferenceLight::Sampling::kHits, ReferenceLight::Sampling::kAreas}) {
    const Estimate one = estimate(ReferenceLight(scene, rays, {}, {}, sampling), at_m, 60000);
    EXPECT_NEAR(one.mean, both.mean, 4.0 * std::hypot(one.error, both.error)) << int(sampling);
  }
  const Estimate hits = estimate(ReferenceLight(scene, rays, {}, {}, ReferenceLight::Sampling::kHits), at_m, 60000);
  EXPECT_LT(both.error, 0.6 * hits.error);
}

}  // namespace
}  // namespace probewalk
