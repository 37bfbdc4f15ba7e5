#include "content/bake/point_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace probewalk {
namespace {

double sum_of(const std::vector<std::uint32_t>& rays) {
  return std::accumulate(rays.begin(), rays.end(), 0.0);
}

TEST(LimitRays, LeavesASceneOfFewPointsAlone) {
  std::vector<std::uint32_t> rays{384, 1536, 24, 0};
  const std::vector<std::uint32_t> before = rays;
  EXPECT_EQ(limit_rays(rays), 1.0);
  EXPECT_EQ(rays, before);
  rays.clear();
  EXPECT_EQ(limit_rays(rays), 1.0);
}

TEST(LimitRays, HalvesUntilTheyAreNoMoreThanMayBe) {
  std::vector<std::uint32_t> rays(200000, 1536);
  rays.front() = 384;
  EXPECT_EQ(limit_rays(rays), 0.25);
  EXPECT_LE(sum_of(rays), kMostRays);
  EXPECT_GT(sum_of(rays), 0.5 * kMostRays);
  EXPECT_EQ(rays.front(), 96u);
  EXPECT_EQ(rays.back(), 384u);
}

// A lamp more in one room, a few points more: all others are lit by the same rays as before.
TEST(LimitRays, StaysAsItIsWhenALittleChanges) {
  std::vector<std::uint32_t> rays(200000, 1536), more(201000, 1536);
  std::fill(more.begin(), more.begin() + 5000, 384);
  limit_rays(rays);
  limit_rays(more);
  EXPECT_EQ(rays.back(), more.back());
}

TEST(LimitRays, LeavesEachPointSomeRaysButNoMoreThanItWanted) {
  std::vector<std::uint32_t> rays(3000000, 384);
  rays.front() = 24;
  EXPECT_EQ(limit_rays(rays), 0.0625);
  EXPECT_EQ(rays.front(), 24u);
  EXPECT_EQ(rays.back(), kLeastRays);
}

}  // namespace
}  // namespace probewalk
