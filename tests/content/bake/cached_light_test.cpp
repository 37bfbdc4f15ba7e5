#include "content/bake/cached_light.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "content/bake/cache_points.h"
#include "content/bake/light_field.h"
#include "content/bake/patterns.h"
#include "content/bake/plain_scenes.h"
#include "content/bake/polygon_light.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// Whether a ray from the origin meets the triangle.
bool meets(const std::array<glm::vec3, 3>& t, glm::vec3 d) {
  const float side = glm::dot(glm::cross(t[0], t[1]), t[2]);
  return side * glm::dot(glm::cross(t[0], t[1]), d) > 0.0f && side * glm::dot(glm::cross(t[1], t[2]), d) > 0.0f &&
         side * glm::dot(glm::cross(t[2], t[0]), d) > 0.0f;
}

TEST(PolygonLight, IsTheIntegralOfTheCosineAboveBothHorizons) {
  const std::array<std::array<glm::vec3, 3>, 4> triangles{{
      {{{-1, 1, -1}, {1, 1, -1}, {0, 1, 1}}},                 // overhead
      {{{0.1f, -1, -0.5f}, {0.1f, 2, -0.5f}, {0.1f, 1, 2}}},  // through the horizon, near
      {{{3, 0.5f, 0}, {3, 0.7f, 0.4f}, {3, -0.1f, 0.4f}}},    // small and low
      {{{-1, -2, -1}, {1, -2, -1}, {0, -2, 1}}},              // below
  }};
  const glm::vec3 geometric(0, 1, 0);
  for (const glm::vec3 normal : {geometric, glm::normalize(glm::vec3(0.4f, 1, -0.2f))}) {
    for (const auto& triangle : triangles) {
      constexpr int kCount = 200000;
      double sum = 0.0;
      for (int k = 0; k < kCount; ++k) {
        const glm::vec3 d(test::hammersley_direction(k, kCount));
        if (glm::dot(d, geometric) > 0.0f && meets(triangle, d)) sum += std::max(0.0, double(glm::dot(d, normal)));
      }
      EXPECT_NEAR(triangle_cosine_integral(triangle, geometric, normal), sum * 4.0 * std::numbers::pi / kCount, 2e-3);
    }
  }
}

// Light from one side, gathered as the cache does: how it changes as the surface turns is known to first order.
TEST(CachedLight, KnowsHowLightChangesAsTheSurfaceTurns) {
  const auto sky = [](glm::vec3 d) { return glm::vec3(1.0f + 4.0f * std::max(d.x, 0.0f), 1.0f, 0.5f); };
  const auto gather = [&](glm::vec3 normal) {
    constexpr int kRays = 4096;
    glm::vec3 tangent, bitangent;
    tangent_frame(normal, tangent, bitangent);
    CachedLight light;
    for (int k = 0; k < kRays; ++k) {
      const glm::vec3 local = cosine_direction(hammersley(std::uint32_t(k), kRays));
      const glm::vec3 d = tangent * local.x + bitangent * local.y + normal * local.z;
      light.add(sky(d), d, normal);
    }
    return light * (kPi / kRays);
  };
  const glm::vec3 up(0, 1, 0);
  const CachedLight light = gather(up);
  for (const float angle : {-0.35f, -0.15f, 0.15f, 0.35f}) {
    const glm::vec3 turned(std::sin(angle), std::cos(angle), 0.0f);
    const glm::vec3 guessed = light.at(turned - up), right = gather(turned).lux;
    EXPECT_NEAR(guessed.r / right.r, 1.0f, 0.04f) << angle;
    EXPECT_GT(std::abs(light.lux.r / right.r - 1.0f), 2.0f * std::abs(guessed.r / right.r - 1.0f)) << angle;
    EXPECT_NEAR(guessed.g / right.g, 1.0f, 0.01f) << "even light stays as it is";
  }
  EXPECT_EQ(light.at(glm::vec3(0.0f)), light.lux);
  EXPECT_GE(light.at({-9.0f, 0.0f, 0.0f}).r, 0.0f);
}

LightOptions few_rays() {
  LightOptions options;
  options.samples = 32;
  return options;
}

// Beside a panel, nearer than its points are to one another.
TEST(LightField, LightsWhatStandsBesideAPanel) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.5f));
  plain::add_material(scene, glm::vec3(0.0f), glm::vec3(1000.0f));
  plain::add_quad(scene, {-0.35f, 2, -0.35f}, {0.35f, 2, -0.35f}, {0.35f, 2, 0.35f}, {-0.35f, 2, 0.35f}, 1);
  plain::add_quad(scene, {0.4f, 1, -1}, {0.4f, 2, -1}, {0.4f, 2, 1}, {0.4f, 1, 1}, 0);  // 5 cm beside it, hanging down
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField light(scene, rays, few_rays(), progress);
  for (const float z : {-0.3f, -0.1f, 0.0f, 0.13f, 0.27f}) {
    for (const float y : {1.97f, 1.9f, 1.7f}) {
      // The panel by a fine grid of small pieces.
      constexpr int kPieces = 700;
      const glm::dvec3 at(0.4, y, z);
      double lux = 0.0;
      for (int i = 0; i < kPieces; ++i) {
        for (int j = 0; j < kPieces; ++j) {
          const glm::dvec3 piece(-0.35 + 0.7 * (i + 0.5) / kPieces, 2.0, -0.35 + 0.7 * (j + 0.5) / kPieces);
          const glm::dvec3 to = piece - at;
          const double square = glm::dot(to, to);
          lux += 1000.0 * (0.7 / kPieces) * (0.7 / kPieces) * (-to.x) * to.y / (square * square);
        }
      }
      const float seen = light.along({0.0f, y, z}, {1, 0, 0}, 1e-4f).r;
      EXPECT_NEAR(seen / (0.5 * std::numbers::inv_pi * lux), 1.0, 0.05) << y << " " << z;
    }
  }
}

// An emitter too large for a patch, small from where it is looked at: rays over the hemisphere alone find it now and
// then.
TEST(LightField, LightFromALargeFarPanelIsNotNoisy) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.5f));
  plain::add_material(scene, glm::vec3(0.0f), glm::vec3(1000.0f));
  plain::add_quad(scene, {-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, 0);
  plain::add_quad(scene, {-1, 12, -1}, {1, 12, -1}, {1, 12, 1}, {-1, 12, 1}, 1);
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField light(scene, rays, few_rays(), progress);
  double sum = 0.0, worst = 0.0;
  int count = 0;
  for (float x = -1.5f; x <= 1.5f; x += 0.25f) {
    for (float z = -1.5f; z <= 1.5f; z += 0.25f) {
      const double square = double(x * x + z * z) + 144.0;
      const double lux = 1000.0 * 4.0 * 144.0 / (square * square);
      const double ratio = double(light.along({x, 1, z}, {0, -1, 0}, 1e-4f).r) / (0.5 * std::numbers::inv_pi * lux);
      sum += ratio;
      worst = std::max(worst, std::abs(ratio - 1.0));
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 1.0, 0.02);
  EXPECT_LT(worst, 0.08);
}

TEST(LightField, PutsPointsCloserOnlyWhereLightChanges) {
  const auto added = [](float lamp_cd_m2) {
    Scene scene;
    plain::add_material(scene, glm::vec3(0.5f), glm::vec3(1.0f));
    plain::add_material(scene, glm::vec3(0.0f), glm::vec3(lamp_cd_m2));
    plain::add_box(scene, {-2, 0, -2}, {2, 3, 2}, 0);
    plain::add_quad(scene, {-1.9f, 1.0f, -1.99f}, {-0.5f, 1.0f, -1.99f}, {-0.5f, 2.4f, -1.99f}, {-1.9f, 2.4f, -1.99f},
                    1);
    const RayScene rays(scene);
    SilentProgress progress;
    LightOptions options = few_rays();
    options.samples = 128;
    const LightField light(scene, rays, options, progress);
    const CachePoints scattered(scene, rays, options.cache_spacing_m, 300000, progress);
    return light.cache_points() - scattered.size();
  };
  EXPECT_LT(added(2.0f), 20u) << "as bright as the walls: nothing to see";
  EXPECT_GT(added(2000.0f), 100u) << "a window's light falls off from it";
}

}  // namespace
}  // namespace probewalk
