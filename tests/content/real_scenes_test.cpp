// Space and placement on real scenes, where PROBEWALK_SCENES names a folder that holds them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "content/bake/placement.h"
#include "content/bake/placement/probe_sites.h"
#include "content/bake/plan_picture.h"
#include "content/scene/space.h"
#include "content/visibility_share.h"

namespace probewalk {
namespace {

struct Expected {
  const char* file;
  double least_floor_m2, most_floor_m2;
  std::size_t least_probes, most_probes;
  double covered;
};

class RealScene : public ::testing::TestWithParam<Expected> {};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST_P(RealScene, HasTheFloorAndProbesThatAPersonWouldExpect) {
  const char* folder = std::getenv("PROBEWALK_SCENES");
  if (!folder) GTEST_SKIP() << "PROBEWALK_SCENES does not name a folder of scenes";
  const std::filesystem::path file = std::filesystem::path(folder) / GetParam().file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const Scene scene = load_scene(file);
  const RayScene rays(scene);
  SilentProgress progress;
  const auto begin = std::chrono::steady_clock::now();
  const Space space = find_space(scene, rays, {}, progress);
  const double space_s = seconds_since(begin);
  const Placement placement = place_probes(scene, rays, space, {});
  const double placement_s = seconds_since(begin) - space_s;
  ASSERT_FALSE(space.floor.nodes.empty());
  const VisibilityShare share = measure_visibility(rays, space, placement, 500);
  const double floor_m2 = double(space.floor.nodes.size()) * space.floor.cell_m * space.floor.cell_m;
  fmt::print("{}: scale {}, cell {:.3f} m, floor {:.1f} m2, tour {} poses, space {:.2f} s, placement {:.2f} s\n",
             GetParam().file, scene.scale, space.floor.cell_m, floor_m2, space.tour.size(), space_s, placement_s);
  fmt::print(
      "  {}\n  surface seen by the cell's probes {:.3f}, probes that see a head {:.1f}, fewer than 3 for {:.3f}\n",
      placement.statement, share.covered, share.mean_views, share.few_views);
  for (const std::string& warning : space.warnings) fmt::print("  warning: {}\n", warning);

  EXPECT_GE(floor_m2, GetParam().least_floor_m2);
  EXPECT_LE(floor_m2, GetParam().most_floor_m2);
  EXPECT_GE(placement.sites.size(), GetParam().least_probes);
  EXPECT_LE(placement.sites.size(), GetParam().most_probes);
  EXPECT_GE(share.covered, GetParam().covered);
  for (const Pose& pose : space.tour) {
    ASSERT_GE(space.floor.find(pose.position_m), 0);
    ASSERT_GE(clearance_m(rays, pose.position_m, 1.0), 0.2);
  }
  for (const ProbeSite& site : placement.sites) ASSERT_GE(clearance_m(rays, site.position_m, 1.0), 0.15);
}

INSTANTIATE_TEST_SUITE_P(Shared, RealScene,
                         ::testing::Values(Expected{"garage/garage.gltf", 10, 32, 8, 24, 0.97},
                                           Expected{"cube-room/cube-room.gltf", 50, 95, 12, 40, 0.97},
                                           Expected{"living-room/living-room.glb", 15, 42, 8, 24, 0.97},
                                           Expected{"hotel-room/scene.glb", 30, 80, 20, 60, 0.97},
                                           Expected{"zdm2/zdm2.glb", 300, 4000, 100, 200, 0.95},
                                           Expected{"jungle/scene.gltf", 100, 3000, 60, 200, 0.95}),
                         [](const auto& test) {
                           std::string name = std::filesystem::path(test.param.file).parent_path().string();
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace probewalk
