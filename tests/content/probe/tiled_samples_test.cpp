#include "content/probe/tiled_samples.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "content/bake/bake_probe.h"
#include "content/pack/sample_tiles.h"
#include "content/probe/device_probe.h"
#include "content/probe/host_address.h"
#include "content/probe/tracer_f32.h"
#include "content/probe/tracer_f64.h"
#include "content/scene/ray_scene.h"
#include "support/rough_maps.h"
#include "support/test_scenes.h"

namespace probewalk {
namespace {

std::uint32_t bits(float w) {
  return std::bit_cast<std::uint32_t>(w);
}

// Tiles as they lie in memory, whether they are worth it or not.
struct Block {
  explicit Block(const std::vector<float>& w, int side) : n(side), tiles(tile_samples(w, side)) {
    words.resize(tiles.tiles.size());
    place_tiles(tiles, static_cast<std::uint32_t>(words.size()), words);
    words.insert(words.end(), tiles.floats.begin(), tiles.floats.end());
  }
  float at(int i, int j) const { return f32::sample_w(host_address(words.data()), true, n, i, j); }

  int n;
  DeviceTiles tiles;
  std::vector<std::uint32_t> words;
};

// By single vertices, and by cells as seen from each quadrant.
void expect_same_bits(const std::vector<float>& w, int n, const std::string& name) {
  const Block block(w, n);
  const pw_uvec2 address = host_address(block.words.data());
  const auto across = static_cast<std::uint64_t>(n / kDeviceTileSide + 1);
  ASSERT_EQ(block.tiles.words(), across * across * kDeviceTileWords + 81 * block.tiles.of_floats) << name;
  const auto stored = [&](int i, int j) {
    return bits(w[static_cast<std::size_t>(j) * static_cast<std::size_t>(n + 1) + static_cast<std::size_t>(i)]);
  };
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      ASSERT_EQ(bits(block.at(i, j)), stored(i, j)) << name << ", vertex " << i << ", " << j;
      if (i % 8 == 0 && j % 8 == 0) {
        ASSERT_EQ(block.words[static_cast<std::size_t>(f32::corner_word(true, n, i, j))], stored(i, j)) << name;
      }
      if (i == n || j == n) continue;
      for (const glm::ivec2 side : {glm::ivec2(1, 1), glm::ivec2(-1, 1), glm::ivec2(1, -1), glm::ivec2(-1, -1)}) {
        for (const int size : {1, 2}) {
          if (size == 2 && (i % 2 != 0 || j % 2 != 0)) continue;
          const int x = side.x > 0 ? i : i + size, y = side.y > 0 ? j : j + size;
          const glm::ivec2 far = glm::ivec2(x, y) + side * size;
          const f32::CornerSamples at = f32::corner_samples(address, true, n, x, y, side, size);
          ASSERT_EQ(bits(at.w00), stored(x, y)) << name;
          ASSERT_EQ(bits(at.w10), stored(far.x, y)) << name;
          ASSERT_EQ(bits(at.w01), stored(x, far.y)) << name;
          ASSERT_EQ(bits(at.w11), stored(far.x, far.y)) << name;
        }
      }
    }
  }
}

template <class Sample>
std::vector<float> map_of(int n, Sample sample) {
  std::vector<float> w;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) w.push_back(sample(i, j));
  }
  return w;
}

TEST(TiledSamples, GiveBackEveryBitOfEveryMap) {
  for (const int n : {64, 128}) {
    for (const test::RoughMap& each : test::rough_maps(n)) expect_same_bits(each.map.geometry.w, n, each.name);
  }
}

TEST(TiledSamples, GiveBackTheBitsOfHardMaps) {
  constexpr int n = 64;
  test::Random random(7);
  const auto check = [&](const char* name, auto sample) { expect_same_bits(map_of(n, sample), n, name); };
  const auto any_bits = [&] { return std::bit_cast<float>(static_cast<std::uint32_t>(random(0.0, 4294967296.0))); };
  check("any bits whatsoever", [&](int, int) { return any_bits(); });
  check("any bits in one vertex of a wall", [&](int i, int j) { return i == 20 && j == 20 ? any_bits() : 0.5f; });
  check("a sign in one vertex of the sky", [](int i, int j) { return i == 20 && j == 20 ? -0.0f : 0.0f; });
  check("infinity everywhere", [](int, int) { return std::numeric_limits<float>::infinity(); });
  check("the largest float everywhere", [](int, int) { return std::numeric_limits<float>::max(); });
  check("denormals", [](int i, int j) { return std::bit_cast<float>(static_cast<std::uint32_t>(i + j * 7)); });
  check("the least of the normals", [](int, int) { return std::numeric_limits<float>::min(); });
  check("the least of a pack", [](int i, int j) { return 1e-9f * (1.0f + 1e-7f * static_cast<float>(i + j)); });
  check("the greatest of a pack", [](int i, int j) { return 1e6f * (1.0f - 1e-7f * static_cast<float>(i + j)); });
  for (const float octave : {0.5f, 1.0f, 2.0f}) {
    check("a wall across an octave",
          [&](int i, int j) { return octave * (0.999f + 1e-4f * static_cast<float>(i - j + 10)); });
  }
  // As steep as slopes can be held, and steeper.
  for (const float steep : {0.01f, 0.05f, 0.2f, 0.44f, 0.4375f, 0.5f, 2.0f, 100.0f}) {
    check("a steep ramp", [&](int i, int) { return 1.0f + steep * static_cast<float>(i & 15); });
    check("a steep fall", [&](int i, int j) { return 1.0f + steep * static_cast<float>(32 - (i & 15) - (j & 15)); });
    check("steps of octaves", [&](int i, int j) { return std::ldexp(1.0f + steep * 1e-3f, (i & 3) - (j & 1)); });
  }
  // What a row has in common and a vertex of its own, at the ends of what they can be, and one beyond.
  for (const int common : {-17, -16, 0, 8, 15, 16}) {
    for (const int own : {0, 7, 8}) {
      const auto wall = map_of(n, [&](int i, int j) {
        const bool apart = j % 8 == 5 && i % 8 != 0;
        return std::bit_cast<float>(bits(1.5f) +
                                    static_cast<std::uint32_t>(apart ? common + (i % 8 == 3 ? own : 0) : 0));
      });
      expect_same_bits(wall, n, "offs at their ends");
      // The row's first vertices are on the plane.
      const int least = std::min(common, 0), most = std::max(common + own, 0);
      EXPECT_EQ(Block(wall, n).tiles.of_floats == 0, least >= -16 && most - least <= 7) << common << " " << own;
    }
    const auto shifted = map_of(n, [&](int, int j) {
      return std::bit_cast<float>(bits(1.5f) + static_cast<std::uint32_t>(j % 8 == 5 ? common : 0));
    });
    expect_same_bits(shifted, n, "a row off the plane");
    EXPECT_EQ(Block(shifted, n).tiles.of_floats == 0, common >= -16 && common <= 22) << common;
  }
}

TEST(TiledSamples, TakeFewBitsWhereThereAreWalls) {
  constexpr int n = 256;
  const std::vector<float> box = map_of(n, [](int i, int j) { return test::box_w(n, i, j); });
  const Block exact(box, n), sky(std::vector<float>(box.size(), 0.0f), n);
  EXPECT_EQ(sky.tiles.of_floats, 0u);
  EXPECT_LT(exact.tiles.of_floats, n * n / 64 / 4u) << "but for edges there are walls";
  EXPECT_LT(exact.tiles.words(), box.size() / 2);
  const TiledSamples quantised = encode_tiled_samples(box, n);
  EXPECT_LE(Block(quantised.w, n).tiles.words(), exact.tiles.words() * 11 / 10);
}

class TiledProbe : public testing::Test {
 protected:
  TiledProbe() { map.geometry = bake_geometry(rays, {0.3, 1.5, -0.2}, 256); }
  const Scene scene = test::furnished_room();
  const RayScene rays{scene};
  ProbeMap map = test::blank_map(8);
};

TEST_F(TiledProbe, TakesFewerBytesAndNoFewerThanStated) {
  const DeviceProbe plain = build_device_probe(map);
  const DeviceProbe tiled = build_device_probe(map, PyramidMaker::kHost, DeviceSamples::kTiledAlways);
  ASSERT_NE(tiled.record.flags & kFlagTiledSamples, 0u);
  EXPECT_LT(device_bytes(tiled), device_bytes(plain));
  EXPECT_GE(device_bytes(tiled), least_device_probe_bytes(256, 8));
  EXPECT_EQ(count_planar_entries(tiled), count_planar_entries(plain));
  EXPECT_EQ(tiled.record.l_min_m, plain.record.l_min_m);
  for (int j = 0; j <= 256; j += 3) {
    for (int i = 0; i <= 256; ++i) ASSERT_EQ(bits(sample_of(tiled, i, j)), bits(sample_of(plain, i, j)));
  }
}

TEST_F(TiledProbe, IsWalkedToTheBitAsOneOfFloats) {
  const DeviceProbe plain = build_device_probe(map);
  const DeviceProbe tiled = build_device_probe(map, PyramidMaker::kHost, DeviceSamples::kTiledAlways);
  const ProbeRecord a = record_in_memory(plain), b = record_in_memory(tiled);
  test::Random random(11);
  int hits = 0;
  for (int k = 0; k < 20000; ++k) {
    const glm::dvec3 x(random(-2.5, 2.5), random(-1.3, 1.0), random(-2.0, 2.0)), d = random.direction();
    const int level = k % 3 == 0 ? 0 : k % 3 == 1 ? kStartLevel : kStartLevel + kWithoutPlanes;
    const f32::WalkState f = f32::walk_probe(a, glm::vec3(x), glm::vec3(d), 0.0f, level);
    const f32::WalkState g = f32::walk_probe(b, glm::vec3(x), glm::vec3(d), 0.0f, level);
    ASSERT_EQ(f.status, g.status);
    ASSERT_EQ(bits(f.t), bits(g.t));
    ASSERT_EQ(bits(f.t_safe), bits(g.t_safe));
    ASSERT_EQ(f.plane, g.plane);
    ASSERT_EQ(f.lookups, g.lookups);
    const f64::WalkState p = f64::walk_probe(a, x, d, 0.0, level), q = f64::walk_probe(b, x, d, 0.0, level);
    ASSERT_EQ(p.status, q.status);
    ASSERT_EQ(p.t, q.t);
    ASSERT_EQ(p.lookups, q.lookups);
    hits += f.status == kClassHit;
  }
  EXPECT_GT(hits, 8000);
}

TEST(TiledSamples, AreLeftFloatsWhereTilesSaveLittle) {
  for (const test::RoughMap& each : test::rough_maps(64)) {
    const DeviceProbe tiled = build_device_probe(each.map, PyramidMaker::kHost, DeviceSamples::kTiled);
    const DeviceProbe plain = build_device_probe(each.map);
    EXPECT_LE(tiled.geometry.size(), plain.geometry.size()) << each.name;
    if (!each.name.starts_with("noise") && !each.name.starts_with("the extremes")) continue;
    EXPECT_EQ(tiled.geometry, plain.geometry) << each.name;
    EXPECT_EQ(tiled.record.flags, plain.record.flags) << each.name;
  }
  const ProbeMap small = test::blank_map(32);
  EXPECT_EQ(build_device_probe(small, PyramidMaker::kHost, DeviceSamples::kTiled).geometry,
            build_device_probe(small).geometry);
}

}  // namespace
}  // namespace probewalk
