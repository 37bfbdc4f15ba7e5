#include "content/bake/plan/probe_choice.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "content/bake/plan/cell_table.h"
#include "content/box_scene.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

// Nearly all that walkers see is in a hall that partitions make hard; two closets have a few rays each.
TEST(ProbeChoice, GivesEveryRoomOneBeforeAnyHasTwoThoughOthersWouldAnswerMore) {
  BoxScene boxes;
  boxes.room({0, 0, 0}, {8, 2.5f, 5.2f});
  boxes.wall_with_door(0, 8, 4, 2.5f, 0.6f, 1.5f);
  for (const float x : {2.0f, 4.0f, 6.0f}) boxes.solid({x - 0.05f, 0, 0}, {x + 0.05f, 2.5f, 3.0f});
  boxes.authored_room("hall", {0, 0, 0}, {8, 2.5, 4});
  boxes.authored_room("closet-0", {0, 0, 4}, {4, 2.5, 5.2});
  boxes.authored_room("closet-1", {4, 0, 4}, {8, 2.5, 5.2});
  const RayScene triangles(boxes.scene);
  SilentProgress progress;
  const Space space = find_space(boxes.scene, triangles, {}, progress);
  ASSERT_EQ(space.rooms.size(), 3u);
  const HeadSpace heads(boxes.scene, triangles, space);
  std::vector<EyeRay> rays;
  std::vector<int> seen_from(3, 0);
  for (int k = 0; k < 4000; ++k) {
    const glm::dvec3 eye = heads.eyes()[std::size_t(k) % heads.eyes().size()];
    const auto room = std::uint32_t(heads.room(eye));
    if (room > 0 && seen_from[room] >= 20) continue;
    ++seen_from[room];
    EyeRay ray{eye, glm::vec3(test::hammersley_direction(k, 4000)), room, std::numeric_limits<float>::infinity()};
    const SurfaceHit hit = triangles.closest(glm::vec3(eye), ray.direction);
    if (hit.hit) ray.truth_m = hit.t;
    rays.push_back(ray);
  }
  ASSERT_GT(seen_from[0], 500);
  const ProbeGrid grid = plan_grid(heads);
  for (const std::size_t most : {3, 4}) {
    ProbeChoice choice(space, heads, triangles, rays, grid, 32, progress);
    choice.choose(0.0, most);
    std::vector<int> probes(3, 0);
    for (const std::uint32_t c : choice.coverage().chosen()) ++probes[choice.coverage().candidates()[c].room];
    EXPECT_EQ(choice.coverage().chosen().size(), most);
    EXPECT_EQ(probes[1], 1) << most;
    EXPECT_EQ(probes[2], 1) << most;
  }
}

}  // namespace
}  // namespace probewalk
