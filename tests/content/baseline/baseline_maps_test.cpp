#include "content/baseline/baseline_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "content/error.h"
#include "content/probe/probe_map.h"
#include "support/analytic_rooms.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

BaselineMaps make(const Scene& scene, const std::vector<glm::dvec3>& positions_m, int n) {
  const RayScene rays(scene);
  SilentProgress progress;
  return make_baseline_maps(rays, positions_m, n, progress);
}

glm::dvec3 texel_direction(int n, int i, int j) {
  return glm::normalize(octahedral_point((2 * i + 1.0) / n - 1, (2 * j + 1.0) / n - 1));
}

TEST(BaselineMaps, ABoxIsSeenAtItsWallsDistances) {
  const test::BoxRoom room;
  const glm::dvec3 position_m(0.7, 1.9, -2.2);
  constexpr int n = 32;
  const BaselineMaps maps = make(room.scene(), {position_m}, n);
  ASSERT_EQ(maps.probes.size(), 1u);
  const BaselineMap& map = maps.probes.front();
  ASSERT_EQ(map.distance_m.size(), static_cast<std::size_t>(n * n));
  double farthest = 0.0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const std::size_t texel = static_cast<std::size_t>(j * n + i);
      const glm::dvec3 d = texel_direction(n, i, j);
      const double expected = room.distance(position_m, d);
      farthest = std::max(farthest, expected);
      ASSERT_NEAR(map.distance_m[texel], expected, 2e-6 * expected);
      const glm::dvec3 normal(decode_baseline_normal(map.normal[texel]));
      ASSERT_LT(glm::dot(normal, d), 0.0);
      const double along = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
      ASSERT_NEAR(along, 1.0, 1e-4);
    }
  }
  EXPECT_EQ(map.record.n_log2, 5u);
  EXPECT_NEAR(maps.farthest_m, farthest, 1e-5);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(map.record.box_min_m[axis], room.lower_m[axis] - position_m[axis], 1e-5);
    EXPECT_NEAR(map.record.box_max_m[axis], room.upper_m[axis] - position_m[axis], 1e-5);
  }
}

TEST(BaselineMaps, FurnitureDoesNotMoveTheProxysWalls) {
  const test::BoxRoom room;
  test::SceneBuilder builder;
  builder.box(glm::vec3(room.lower_m), glm::vec3(room.upper_m), true);
  builder.table(1.0f, -1.0f, 1.4f, 0.8f, 0.74f, 0.05f);
  builder.box({3.2f, 0.0f, 0.2f}, {4.0f, 1.2f, 1.0f});
  const glm::dvec3 position_m(-0.5, 1.4, -1.2);
  const BaselineMaps maps = make(builder.build(), {position_m}, 64);
  const BaselineRecord& record = maps.probes.front().record;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(record.box_min_m[axis], room.lower_m[axis] - position_m[axis], 1e-5) << axis;
    EXPECT_NEAR(record.box_max_m[axis], room.upper_m[axis] - position_m[axis], 1e-5) << axis;
  }
}

TEST(BaselineMaps, ABallsMeanIsItsRadius) {
  const BaselineMaps maps = make(test::ball_room(3.0, {1.0, 2.0, 3.0}), {{1.0, 2.0, 3.0}}, 32);
  const BaselineMap& map = maps.probes.front();
  const auto [least, greatest] = std::minmax_element(map.distance_m.begin(), map.distance_m.end());
  EXPECT_NEAR(*least, 3.0, 6e-4);
  EXPECT_NEAR(*greatest, 3.0, 6e-4);
  EXPECT_NEAR(map.record.mean_m, 3.0, 6e-4);
}

TEST(BaselineMaps, ThePyramidBoundsWhatLiesUnderANodeAndATexelAround) {
  constexpr int n = 64;
  const BaselineMaps maps = make(test::furnished_room(), {{0.4, 1.3, 0.2}}, n);
  const BaselineMap& map = maps.probes.front();
  ASSERT_EQ(map.minimum_m.size(), static_cast<std::size_t>(n * n - 1) / 3);
  for (int level = 1; level <= 6; ++level) {
    const int side = n >> level;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const float bound = map.minimum_m[minimum_offset(n, level) + static_cast<std::size_t>(y * side + x)];
        float least = kBaselineSky_m;
        const int size = 1 << level;
        for (int j = y * size - 1; j <= (y + 1) * size; ++j) {
          for (int i = x * size - 1; i <= (x + 1) * size; ++i) {
            // Folded by way of the direction just outside: independent of how the maker folds.
            int fi = i, fj = j;
            if (i < 0 || j < 0 || i >= n || j >= n) {
              const bool corner = (i < 0 || i >= n) && (j < 0 || j >= n);
              if (corner) continue;
              const glm::dvec2 uv((2 * i + 1.0) / n - 1, (2 * j + 1.0) / n - 1);
              // A step over the edge u = 1 comes back at (1 - step, -v).
              glm::dvec2 inside = uv;
              if (std::abs(uv.x) > 1.0) inside = {std::copysign(2.0 - std::abs(uv.x), uv.x), -uv.y};
              if (std::abs(uv.y) > 1.0) inside = {-uv.x, std::copysign(2.0 - std::abs(uv.y), uv.y)};
              fi = static_cast<int>(std::floor((inside.x + 1.0) * n / 2));
              fj = static_cast<int>(std::floor((inside.y + 1.0) * n / 2));
            }
            least = std::min(least, map.distance_m[static_cast<std::size_t>(fj * n + fi)]);
          }
        }
        // Level 1 sees its ring exactly; coarser ones take their children's rings, which is no more than that.
        ASSERT_LE(bound, least);
        if (level == 1) {
          ASSERT_GE(bound, least * 0.2f);
        }
      }
    }
  }
}

TEST(BaselineMaps, SkyIsSky) {
  test::SceneBuilder builder;
  builder.quad({-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5});
  const BaselineMaps maps = make(builder.build(), {{0.0, 1.0, 0.0}, {0.0, 50.0, 0.0}}, 16);
  std::size_t sky = 0;
  for (std::size_t k = 0; k < 256; ++k) {
    const bool is_sky = maps.probes[0].distance_m[k] == kBaselineSky_m;
    EXPECT_EQ(is_sky, maps.probes[0].normal[k] == 0u);
    sky += is_sky;
  }
  EXPECT_GT(sky, 100u);
  EXPECT_LT(sky, 200u);
  // A scene of nothing but sky has no proxies, and says so.
  test::SceneBuilder empty;
  empty.quad({1e3f, 0, 0}, {1e3f, 1e-3f, 0}, {1e3f, 1e-3f, 1e-3f}, {1e3f, 0, 1e-3f});
  const BaselineMaps nothing = make(empty.build(), {{0.0, 500.0, 300.0}}, 8);
  EXPECT_EQ(nothing.probes.front().record.mean_m, 0.0f);
  EXPECT_EQ(nothing.farthest_m, 0.0f);
}

TEST(BaselineMaps, NormalsKeepTheirDirection) {
  for (int k = 0; k < 4000; ++k) {
    const glm::dvec3 d = test::hammersley_direction(k, 4000);
    const std::uint32_t word = encode_baseline_normal(glm::vec3(d));
    ASSERT_NE(word, 0u);
    ASSERT_LT(glm::length(glm::dvec3(decode_baseline_normal(word)) - d), 1e-4);
  }
  for (const glm::vec3 axis : {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(1, 0, 0), glm::vec3(0, -1, 0)}) {
    EXPECT_NE(encode_baseline_normal(axis), 0u);
    EXPECT_LT(glm::length(decode_baseline_normal(encode_baseline_normal(axis)) - axis), 1e-4f);
  }
}

TEST(BaselineMaps, OtherSizesThanPowersOfTwoAreRefused) {
  const Scene scene = test::BoxRoom().scene();
  for (const int n : {0, 4, 12, 100, 16384}) EXPECT_THROW(make(scene, {{0.0, 1.0, 0.0}}, n), BadUsage) << n;
}

class ImpatientProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void note(std::string_view) override {}
  bool cancelled() const override { return true; }
};

TEST(BaselineMaps, CanBeInterrupted) {
  const Scene scene = test::BoxRoom().scene();
  const RayScene rays(scene);
  ImpatientProgress progress;
  const std::vector<glm::dvec3> positions_m{{0.0, 1.0, 0.0}};
  EXPECT_THROW(make_baseline_maps(rays, positions_m, 16, progress), Interrupted);
}

}  // namespace
}  // namespace probewalk
