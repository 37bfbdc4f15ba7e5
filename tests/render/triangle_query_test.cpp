// The contenders on triangles: the device's ray query and Embree find the same distances as RayScene.
#include "render/triangle_query.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "content/error.h"
#include "content/scene/embree_query.h"
#include "content/scene/ray_scene.h"
#include "support/low_discrepancy.h"
#include "support/procedural_scene.h"

namespace probewalk {
namespace {

class TriangleQueryTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_ray_query(device)) GTEST_SKIP() << device.info().name << " has no ray query";
  }
  void TearDown() override {
    device.wait_idle();
    EXPECT_EQ(device.validation_messages(), 0u);
  }
  const Device device{with_ray_query(), DeviceOptions{.device = "", .validation = true}};
};

std::vector<TriangleRay> random_rays(glm::dvec3 lower_m, glm::dvec3 upper_m, int count) {
  test::Random random(11);
  std::vector<TriangleRay> rays;
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 at(random(lower_m.x, upper_m.x), random(lower_m.y, upper_m.y),
                        random(lower_m.z, upper_m.z));
    rays.push_back({glm::vec3(at), 0.0f, glm::vec3(random.direction()), 0.0f});
  }
  return rays;
}

std::vector<float> expected_m(const Scene& scene, const std::vector<TriangleRay>& rays) {
  const RayScene truth(scene);
  std::vector<float> t_m;
  for (const TriangleRay& ray : rays) {
    const SurfaceHit hit = truth.closest(ray.origin_m, ray.unit_direction);
    t_m.push_back(hit.hit ? hit.t : kTriangleMiss_m);
  }
  return t_m;
}

double share_off(const std::vector<float>& t_m, const std::vector<float>& expected) {
  std::size_t off = 0;
  for (std::size_t i = 0; i < t_m.size(); ++i)
    off += !(std::abs(t_m[i] - expected[i]) <= 1e-4f * expected[i] + 1e-5f);
  return static_cast<double>(off) / static_cast<double>(t_m.size());
}

TEST_F(TriangleQueryTest, FindsTheDistancesOfARoom) {
  const Scene scene = test::load_procedural("two-rooms");
  const std::vector<TriangleRay> rays = random_rays({-4.9, 0.1, -1.9}, {4.9, 2.5, 1.9}, 5003);
  const std::vector<float> truth = expected_m(scene, rays);
  std::vector<float> t_m(rays.size());
  const TriangleQuery query(device, scene);
  EXPECT_GT(query.trace(rays, t_m), 0);
  EXPECT_LT(share_off(t_m, truth), 2e-3);
  EXPECT_GT(query.structure_bytes(), 0u);
  const EmbreeQuery embree(scene);
  for (const RayWidth width : {RayWidth::kOne, RayWidth::kSixteen}) {
    std::fill(t_m.begin(), t_m.end(), -1.0f);
    embree.trace(width, rays, t_m);  // the last packet is not full
    EXPECT_LT(share_off(t_m, truth), 2e-3);
  }
}

TEST_F(TriangleQueryTest, LetsRaysThroughWhereAlphaSaysSo) {
  const Scene scene = test::load_procedural("grove");
  const std::vector<TriangleRay> rays = random_rays({-5, 0.3, -5}, {5, 4, 5}, 6000);
  const std::vector<float> truth = expected_m(scene, rays);
  std::vector<float> t_m(rays.size());
  TriangleQuery(device, scene).trace(rays, t_m);
  EXPECT_LT(share_off(t_m, truth), 4e-3);  // at the rims of leaves the last bit decides
  EmbreeQuery(scene).trace(RayWidth::kSixteen, rays, t_m);
  EXPECT_LT(share_off(t_m, truth), 4e-3);
  Scene opaque = scene;
  for (Material& material : opaque.materials) material.alpha_mode = AlphaMode::kOpaque;
  TriangleQuery(device, opaque).trace(rays, t_m);
  EXPECT_GT(share_off(t_m, truth), 0.05);
}

TEST_F(TriangleQueryTest, TakesNoRayAndMisses) {
  const Scene scene = test::load_procedural("two-rooms");
  const TriangleQuery query(device, scene);
  EXPECT_EQ(query.trace({}, {}), 0);
  const std::vector<TriangleRay> up{{{0, 50, 0}, 0.0f, {0, 1, 0}, 0.0f}};
  std::vector<float> t_m(1);
  query.trace(up, t_m);
  EXPECT_EQ(t_m[0], kTriangleMiss_m);
}

TEST(TriangleQueryWithout, IsRefusedWhereRayQueriesWereNotAskedFor) {
  const Device device(DeviceHooks{}, DeviceOptions{.device = "", .validation = false});
  EXPECT_FALSE(has_ray_query(device));
  EXPECT_THROW(TriangleQuery(device, Scene{}), NoDevice);
}

}  // namespace
}  // namespace probewalk
