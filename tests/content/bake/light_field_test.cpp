#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "content/bake/bake_probe.h"
#include "content/bake/cache_points.h"
#include "content/bake/light_field.h"
#include "content/bake/patterns.h"
#include "content/bake/plain_scenes.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

LightOptions quick(int threads = 0) {
  LightOptions options;
  options.samples = 32;
  options.cache_spacing_m = 0.5;
  options.threads = threads;
  return options;
}

// Of what is found at some points with what is right.
struct Agreement {
  double energy = 0.0;      // all found over all that is right
  double mean_error = 0.0;  // over what is right
};
Agreement agreement(const std::vector<double>& found, const std::vector<double>& truth) {
  double sum = 0.0, all = 0.0, off = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += truth[i];
    all += found[i];
    off += std::abs(found[i] - truth[i]);
  }
  return {all / sum, off / sum};
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

// A lamp at the end of a long white room: light is reflected dozens of times before it is at the other end. All that is
// absorbed must be all that was sent.
TEST(LightField, KeepsTheEnergyOfALongWhiteRoom) {
  constexpr float kAlbedo = 0.92f, kLamp_cd = 100.0f;
  const glm::vec3 size_m(2.0f, 2.0f, 14.0f);
  Scene scene;
  plain::add_material(scene, glm::vec3(kAlbedo));
  plain::add_box(scene, glm::vec3(0.0f), size_m, 0);
  scene.lights.push_back(plain::point_light({1.0f, 1.0f, 0.7f}, kLamp_cd));
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField light(scene, rays, LightOptions(), progress);
  double absorbed_lm = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool far : {false, true}) {
      constexpr int kPlaces = 1000;
      double sum = 0.0;
      for (int k = 0; k < kPlaces; ++k) {
        const glm::vec2 at = r2_sequence(std::uint32_t(k));
        glm::vec3 from(0.0f), to(0.0f);
        from[u] = at.x * size_m[u], from[v] = at.y * size_m[v], from[axis] = far ? size_m[axis] - 0.01f : 0.01f;
        to[axis] = far ? 1.0f : -1.0f;
        sum += double(light.along(from, to, 1e-3f).r);
      }
      const double arriving_lux = sum / kPlaces * std::numbers::pi / double(kAlbedo);
      absorbed_lm += double(1.0f - kAlbedo) * arriving_lux * double(size_m[u] * size_m[v]);
    }
  }
  EXPECT_NEAR(absorbed_lm / (4.0 * std::numbers::pi * double(kLamp_cd)), 1.0, 0.02);
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

// However many lights matter, none may be lost: there are eight shadow rays a point.
TEST(LightField, ManyEqualLightsAddUp) {
  constexpr float kAll_cd = 300.0f;
  for (const int lights : {4, 8, 9, 16, 32}) {
    Scene scene;
    plain::add_material(scene, glm::vec3(0.5f));
    plain::add_quad(scene, {-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, 0);
    for (int k = 0; k < lights; ++k) {
      const float angle = 2.0f * std::numbers::pi_v<float> * float(k) / float(lights);
      scene.lights.push_back(
          plain::point_light({2.0f * std::cos(angle), 2.0f, 2.0f * std::sin(angle)}, kAll_cd / float(lights)));
    }
    const RayScene rays(scene);
    SilentProgress progress;
    LightOptions options = quick();
    options.bounces = 0;
    const LightField light(scene, rays, options, progress);
    const float expected = 0.5f * std::numbers::inv_pi_v<float> * kAll_cd * 2.0f / std::pow(8.0f, 1.5f);
    EXPECT_NEAR(light.along({0, 1, 0}, {0, -1, 0}, 1e-3f).r / expected, 1.0f, 1e-3f) << lights << " lights";
  }
}

// Unequal lights around a box that throws shadows, against the sum of scenes with one light each.
TEST(LightField, ManyLightsShareTheirShadowsRoughly) {
  LightOptions options = quick();
  options.samples = 1;
  options.cache_spacing_m = 2.0;
  options.bounces = 0;
  constexpr int kPoints = 256;
  const auto spread = [](double start, double step, int k) { return float(-3.0 + 6.0 * std::fmod(start + step * k, 1.0)); };
  for (const int lights : {4, 9, 16, 32}) {
    const auto add_light_of = [&](int first, int end, std::vector<double>& radiance) {
      Scene scene;
      plain::add_material(scene, glm::vec3(0.5f));
      plain::add_quad(scene, {-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, 0);
      plain::add_box(scene, {-0.5f, 0.2f, -0.5f}, {0.5f, 1.0f, 0.5f}, 0);
      for (int k = first; k < end; ++k) {
        scene.lights.push_back(plain::point_light({spread(0.3, 0.7548776, k), 2.5f, spread(0.3, 0.5698403, k)},
                                                  100.0f * float(1 + k % 3)));
      }
      const RayScene rays(scene);
      SilentProgress progress;
      const LightField light(scene, rays, options, progress);
      for (int i = 0; i < kPoints; ++i) {
        const glm::vec3 above(spread(0.5, 0.7548776, i), 0.1f, spread(0.5, 0.5698403, i));
        radiance[std::size_t(i)] += double(light.along(above, {0, -1, 0}, 1e-3f).r);
      }
    };
    std::vector<double> truth(kPoints), together(kPoints);
    for (int k = 0; k < lights; ++k) add_light_of(k, k + 1, truth);
    add_light_of(0, lights, together);
    const Agreement found = agreement(together, truth);
    EXPECT_NEAR(found.energy, 1.0, 0.05) << lights << " lights";
    EXPECT_LT(found.mean_error, lights <= 8 ? 1e-4 : 0.06) << lights << " lights";
  }
}

// Two rooms with a wall between, the lamps of one near the wall and far stronger: none of their light may be taken for
// visible in the other. Against the sum of scenes with one lamp each, which needs no choice between lights.
TEST(LightField, LampsOfTheNextRoomDoNotShineThroughTheWall) {
  LightOptions options = quick();
  options.samples = 1;
  options.cache_spacing_m = 0.5;
  options.bounces = 0;
  constexpr int kPoints = 1500;
  const auto fraction = [](double start, double step, int k) { return float(std::fmod(start + step * k, 1.0)); };
  for (const int lamps : {3, 12, 40}) {
    std::vector<Light> lights;
    for (int k = 0; k < lamps; ++k) {
      const float x = 0.3f + 3.4f * fraction(0.5, 0.7548776, k), z = -2.7f + 5.4f * fraction(0.5, 0.5698403, k);
      lights.push_back(plain::point_light({x, 2.4f, z}, 20.0f + 5.0f * float(k % 3)));
      lights.push_back(plain::point_light({-0.2f - 0.2f * x, 1.4f, z}, 100.0f));
    }
    const auto add_light_of = [&](std::size_t first, std::size_t end, std::vector<double>& radiance) {
      Scene scene;
      plain::add_material(scene, glm::vec3(0.5f));
      plain::add_box(scene, {-4, 0, -3}, {4, 2.7f, 3}, 0);
      plain::add_quad(scene, {0, 0, -3}, {0, 0, 3}, {0, 2.7f, 3}, {0, 2.7f, -3}, 0);
      plain::add_box(scene, {1.5f, 0.1f, -1}, {2.5f, 0.8f, 1}, 0);  // a table that throws shadows
      scene.lights.assign(lights.begin() + std::ptrdiff_t(first), lights.begin() + std::ptrdiff_t(end));
      const RayScene rays(scene);
      SilentProgress progress;
      const LightField light(scene, rays, options, progress);
      for (int i = 0; i < kPoints; ++i) {
        const glm::vec3 from(0.1f + 3.8f * fraction(0.5, 0.8191725, i), 0.05f, -2.9f + 5.8f * fraction(0.5, 0.6710436, i));
        const glm::vec3 down = i % 2 == 0 ? glm::vec3(0, -1, 0) : glm::vec3(-1, 0.3f, 0.2f);
        radiance[std::size_t(i)] += double(light.along(from, glm::normalize(down), 1e-3f).r);
      }
    };
    std::vector<double> truth(kPoints), together(kPoints);
    for (std::size_t k = 0; k < lights.size(); ++k) add_light_of(k, k + 1, truth);
    add_light_of(0, lights.size(), together);
    const Agreement found = agreement(together, truth);
    EXPECT_NEAR(found.energy, 1.0, 0.02) << lamps << " lamps in either room";
    EXPECT_LT(found.mean_error, lamps == 3 ? 1e-4 : lamps == 12 ? 0.05 : 0.12) << lamps << " lamps in either room";
  }
}

// The sun's disc is 0.53 degrees wide: the edge of a shadow blurs with the way to what throws it, and is sharp at contact.
TEST(LightField, TheSunsShadowsAreSharpAtContactAndSoftFarOff) {
  Scene scene;
  plain::add_material(scene, glm::vec3(0.5f));
  plain::add_quad(scene, {-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, 0);
  plain::add_quad(scene, {0, 0, 1}, {0, 4, 1}, {0, 4, 4}, {0, 0, 4}, 0);      // stands on the floor
  plain::add_quad(scene, {-4, 4, -4}, {0, 4, -4}, {0, 4, -1}, {-4, 4, -1}, 0);  // hangs 4 m above it
  Light sun;
  sun.kind = Light::Kind::kDirectional;
  sun.direction = glm::vec3(0, -1, 0);
  sun.intensity = glm::vec3(1000.0f);
  scene.lights.push_back(sun);
  const RayScene rays(scene);
  SilentProgress progress;
  LightOptions options = quick();
  options.bounces = 0;
  const LightField light(scene, rays, options, progress);
  const float lit = 0.5f * std::numbers::inv_pi_v<float> * 1000.0f;
  const auto share = [&](float x, float z) { return light.along({x, 0.1f, z}, {0, -1, 0}, 1e-4f).r / lit; };
  const float half_width_m = 4.0f * 0.004625f;
  EXPECT_NEAR(share(1.1f * half_width_m, -2.0f), 1.0f, 1e-4f);
  EXPECT_NEAR(share(-1.1f * half_width_m, -2.0f), 0.0f, 1e-4f);
  // In between what a straight edge leaves of a disc.
  for (const float at : {-0.6f, -0.3f, 0.0f, 0.3f, 0.6f}) {
    const float left = 0.5f + (at * std::sqrt(1.0f - at * at) + std::asin(at)) * std::numbers::inv_pi_v<float>;
    EXPECT_NEAR(share(at * half_width_m, -2.0f), left, 0.13f) << at;
  }
  EXPECT_NEAR(share(0.01f, 2.5f), share(-0.01f, 2.5f), 1e-4f) << "a wall along the light throws no shadow";
  // A lower sun: right at the wall's foot its shadow begins.
  Scene low = scene;
  low.lights[0].direction = glm::normalize(glm::vec3(1, -1, 0));
  const RayScene low_rays(low);
  const LightField low_light(low, low_rays, options, progress);
  EXPECT_EQ(low_light.along({0.01f, 0.1f, 2.5f}, {0, -1, 0}, 1e-4f).r, 0.0f);
  EXPECT_GT(low_light.along({-0.01f, 0.1f, 2.5f}, {0, -1, 0}, 1e-4f).r, 0.6f * lit);
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

// Another way to the same light: paths followed from a point until they die, without caches or patterns, emission counted
// where it is hit, the sky where nothing is, and point lights asked for at every bounce.
glm::vec3 follow_paths(const Scene& scene, const RayScene& rays, glm::vec3 from, glm::vec3 towards, int paths) {
  test::Random random(1);
  glm::dvec3 sum(0.0);
  for (int k = 0; k < paths; ++k) {
    glm::vec3 origin = from, direction = towards, throughput(1.0f);
    for (int bounce = 0; bounce < 24; ++bounce) {
      const SurfaceHit hit = rays.closest(origin, direction);
      if (!hit.hit) {
        sum += glm::dvec3(throughput * scene.sky.radiance(direction));
        break;
      }
      const Material& material = scene.materials[scene.triangle_material[hit.triangle]];
      sum += glm::dvec3(throughput * material.emissive_cd_m2);
      const glm::vec3 normal = glm::dot(hit.geometric_normal, direction) < 0.0f ? hit.geometric_normal : -hit.geometric_normal;
      const glm::vec3 point = origin + direction * hit.t + normal * 1e-4f;
      throughput *= glm::vec3(material.base_color_factor);
      for (const Light& light : scene.lights) {
        const glm::vec3 to_light = light.position_m - point;
        const float distance = glm::length(to_light), cosine = glm::dot(normal, to_light) / distance;
        if (cosine <= 0.0f || rays.occluded(point, to_light, 0.0f, 0.999f)) continue;
        sum += glm::dvec3(throughput * light.intensity * (std::numbers::inv_pi_v<float> * cosine / (distance * distance)));
      }
      const float survival = std::max(throughput.r, std::max(throughput.g, throughput.b));
      if (random(0.0, 1.0) >= double(survival)) break;
      throughput /= survival;
      glm::vec3 tangent, bitangent;
      tangent_frame(normal, tangent, bitangent);
      const glm::vec3 local = cosine_direction({float(random(0.0, 1.0)), float(random(0.0, 1.0))});
      origin = point;
      direction = glm::normalize(tangent * local.x + bitangent * local.y + normal * local.z);
    }
  }
  return glm::vec3(sum / double(paths));
}

TEST(LightField, AgreesWithPathsThatAreFollowed) {
  Scene scene;
  plain::add_material(scene, {0.7f, 0.6f, 0.5f});
  plain::add_material(scene, {0.2f, 0.5f, 0.3f});
  plain::add_material(scene, glm::vec3(0.0f), glm::vec3(800.0f, 700.0f, 500.0f));
  plain::add_box(scene, {-2, 0, -3}, {2, 2.6f, 3}, 0);
  plain::add_box(scene, {-1.2f, 0, -1}, {-0.4f, 1.1f, 0.2f}, 1);
  plain::add_quad(scene, {0.5f, 2.55f, 0.5f}, {1.5f, 2.55f, 0.5f}, {1.5f, 2.55f, 1.5f}, {0.5f, 2.55f, 1.5f}, 2);
  scene.lights.push_back(plain::point_light({-1.0f, 2.2f, 2.0f}, 120.0f));
  const RayScene rays(scene);
  SilentProgress progress;
  const LightField light(scene, rays, LightOptions(), progress);
  double error = 0.0, sum_cached = 0.0, sum_followed = 0.0;
  int count = 0;
  const glm::vec3 eye(0.3f, 1.5f, -0.8f);
  for (int k = 0; k < 40; ++k) {
    const glm::vec3 d(test::hammersley_direction(k, 40));
    const SurfaceHit hit = rays.closest(eye, d);
    if (!hit.hit || scene.triangle_material[hit.triangle] == 2) continue;
    const float cached = luminance(light.along(eye, d, 0.01f)), followed = luminance(follow_paths(scene, rays, eye, d, 12000));
    error += std::abs(double(cached - followed)) / double(followed);
    sum_cached += double(cached);
    sum_followed += double(followed);
    ++count;
  }
  ASSERT_GT(count, 30);
  EXPECT_NEAR(sum_cached / sum_followed, 1.0, 0.03) << "energy";
  EXPECT_LT(error / count, 0.05) << "mean error of a direction, noise of the followed paths included";
}

// What a picture covers is dark, and must not be heard before it, as near as it hangs.
TEST(LightField, WhatAPictureCoversDoesNotDarkenIt) {
  for (const float off_m : {0.018f, 0.025f, 0.04f}) {
    Scene scene;
    plain::add_material(scene, glm::vec3(0.7f));
    plain::add_box(scene, {-2, 0, -2}, {2, 3, 2}, 0);
    const float z = -2.0f + off_m;
    plain::add_quad(scene, {-0.8f, 0.9f, z}, {0.8f, 0.9f, z}, {0.8f, 2.1f, z}, {-0.8f, 2.1f, z}, 0);
    const RayScene rays(scene);
    SilentProgress progress;
    const CachePoints points(scene, rays, 0.25, 100000, progress);
    std::vector<CachedLight> lit(points.size());
    int covered = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const glm::vec3 at = points[k].position_m;
      const bool behind = at.z < z - 1e-4f && std::abs(at.x) < 0.8f && std::abs(at.y - 1.5f) < 0.6f;
      lit[k].lux = glm::vec3(behind ? 0.0f : 1.0f);
      covered += behind && points[k].normal.z > 0.5f;
    }
    EXPECT_GT(covered, 0) << off_m << " m before the wall";
    for (int k = 0; k < 256; ++k) {
      const glm::vec2 at = r2_sequence(std::uint32_t(k));
      const glm::vec3 place(1.5f * (at.x - 0.5f), 0.95f + 1.1f * at.y, z);
      EXPECT_NEAR(points.interpolate(lit, place, {0, 0, 1}).r, 1.0f, 1e-3f) << off_m << " m before the wall";
    }
  }
}

// A slot four times as deep as it is high, far narrower than the cache's spacing: light decays within it as fast as it is
// high, and no point at the mouth may say how bright it is inside.
TEST(LightField, FadesIntoANarrowSlot) {
  constexpr float kDeep_m = 0.24f, kHigh_m = 0.06f;
  Scene scene;
  plain::add_material(scene, glm::vec3(0.5f));
  plain::add_quad(scene, {-kDeep_m, 0, -1}, {-kDeep_m, 0, 1}, {1, 0, 1}, {1, 0, -1}, 0);
  plain::add_quad(scene, {-kDeep_m, kHigh_m, -1}, {0, kHigh_m, -1}, {0, kHigh_m, 1}, {-kDeep_m, kHigh_m, 1}, 0);
  plain::add_quad(scene, {-kDeep_m, 0, -1}, {-kDeep_m, kHigh_m, -1}, {-kDeep_m, kHigh_m, 1}, {-kDeep_m, 0, 1}, 0);
  scene.sky.zenith_cd_m2 = scene.sky.horizon_cd_m2 = glm::vec3(100.0f);
  const RayScene rays(scene, "sse2");  // on another processor the points would lie a little otherwise
  SilentProgress progress;
  const LightField light(scene, rays, LightOptions(), progress);
  EXPECT_LT(light.cache_points(), 2500u) << "closer points in the slot alone";
  std::vector<double> cached, followed;
  for (float x : {-0.03f, -0.09f, -0.15f}) {
    // A sensor just over the slot's floor that looks down, mid-way along it.
    std::vector<double> cached_here, followed_here;
    for (float z : {-0.4f, -0.23f, -0.05f, 0.11f, 0.3f}) {
      const glm::vec3 eye(x, 0.5f * kHigh_m, z), down(0, -1, 0);
      cached_here.push_back(double(luminance(light.along(eye, down, 0.001f))));
      followed_here.push_back(double(luminance(follow_paths(scene, rays, eye, down, 20000))));
    }
    // With points 250 mm apart alone: 1.6, 2.9 and 4.3 times.
    EXPECT_NEAR(agreement(cached_here, followed_here).energy, 1.0, 0.5) << "at " << x;
    cached.insert(cached.end(), cached_here.begin(), cached_here.end());
    followed.insert(followed.end(), followed_here.begin(), followed_here.end());
  }
  EXPECT_NEAR(agreement(cached, followed).energy, 1.0, 0.12);
  EXPECT_LT(agreement(cached, followed).mean_error, 0.2);
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
