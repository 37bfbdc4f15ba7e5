#include "content/probe/pyramid.h"

#include <gtest/gtest.h>

#include <bit>
#include <cfenv>
#include <cmath>

#include "content/probe/device_probe.h"
#include "content/probe/tracer_f32.h"
#include "shaders/shared/pyramid_build.h"
#include "support/rough_maps.h"

namespace probewalk {
namespace {

struct Entry {
  int x, y, size;
  float maximum;
  bool is_planar;
};

// Every entry of every level.
std::vector<Entry> entries_of(const DeviceProbe& probe) {
  std::vector<Entry> entries;
  const pw_uvec2 geometry = record_in_memory(probe).geometry_address;
  const int n_log2 = static_cast<int>(probe.record.n_log2), n = 1 << n_log2;
  const auto begin = static_cast<int>(pyramid_range(probe.record).first);
  for (int level = 1; level <= f32::pyramid_top(n_log2); level += 2) {
    for (int y = 0; y < n >> level; ++y) {
      for (int x = 0; x < n >> level; ++x) {
        const pw_uint entry = f32::pyramid_entry(geometry, f32::pyramid_node(begin, n, level, x, y), x, y);
        entries.push_back({x, y, 1 << level, f32::entry_maximum(entry), (entry & kEntryPlanar) != 0});
      }
    }
  }
  return entries;
}

// Furthest that w of the entry's vertices is from the plane through its corners next to the map's centre, relative to
// w.
double distance_from_plane(const ProbeGeometry& g, const Entry& entry) {
  const int su = 2 * entry.x * entry.size >= g.n ? 1 : -1, sv = 2 * entry.y * entry.size >= g.n ? 1 : -1;
  const int x0 = (su > 0 ? entry.x : entry.x + 1) * entry.size, y0 = (sv > 0 ? entry.y : entry.y + 1) * entry.size;
  const auto w = [&](int a, int b) {
    return static_cast<double>(
        g.w[static_cast<std::size_t>(y0 + sv * b) * (g.n + 1) + static_cast<std::size_t>(x0 + su * a)]);
  };
  const double corner = w(0, 0);
  double furthest = 0.0;
  for (int b = 0; b <= entry.size; ++b) {
    for (int a = 0; a <= entry.size; ++a) {
      const double plane =
          corner + (w(entry.size, 0) - corner) / entry.size * a + (w(0, entry.size) - corner) / entry.size * b;
      furthest = std::max(furthest, std::abs(plane - w(a, b)) / w(a, b));
    }
  }
  return furthest;
}

TEST(Pyramid, CountsEverySampleAndCallsPlanarWhatIs) {
  std::size_t walls = 0;
  for (const int n : {16, 64, 128}) {
    for (const test::RoughMap& each : test::rough_maps(n)) {
      const ProbeGeometry& g = each.map.geometry;
      const DeviceProbe probe = build_device_probe(each.map);
      for (const Entry& entry : entries_of(probe)) {
        float most = 0.0f;
        for (int j = 0; j <= entry.size; ++j) {
          for (int i = 0; i <= entry.size; ++i) {
            most = std::max(most, g.w[static_cast<std::size_t>(entry.y * entry.size + j) * (n + 1) +
                                      static_cast<std::size_t>(entry.x * entry.size + i)]);
          }
        }
        ASSERT_GE(entry.maximum, most) << each.name;
        ASSERT_EQ(entry.maximum > 0.0f, most > 0.0f) << each.name;
        ASSERT_LE(entry.maximum, most * 1.11f) << each.name;
        const double distance = most > 0.0f ? distance_from_plane(g, entry) : 1.0;
        if (entry.is_planar) {
          ASSERT_LE(distance, double{kPlanarTolerance}) << each.name;
        }
        if (each.name.starts_with("box,") && distance < 1e-6) {
          ASSERT_TRUE(entry.is_planar) << each.name << ", off by " << distance;
          ++walls;
        }
      }
    }
  }
  EXPECT_GT(walls, 3000u);
}

TEST(Pyramid, IsLeftOpenForTheDevice) {
  const std::vector<test::RoughMap> maps = test::rough_maps(64);
  for (const test::RoughMap& each : maps) {
    DeviceProbe open = build_device_probe(each.map, PyramidMaker::kDevice);
    const DeviceProbe whole = build_device_probe(each.map);
    EXPECT_TRUE(open.pyramid_is_open);
    EXPECT_FALSE(whole.pyramid_is_open);
    EXPECT_EQ(open.record.l_min_m, whole.record.l_min_m);
    build_pyramid(64, each.map.geometry.w, open.geometry, pyramid_range(open.record).first);
    EXPECT_EQ(open.geometry, whole.geometry) << each.name;
    EXPECT_EQ(open.radiance, whole.radiance);
  }
  EXPECT_FALSE(build_device_probe(test::blank_map(8), PyramidMaker::kDevice).pyramid_is_open) << "it has none";
}

// As a device of that rounding would say. Behind a volatile pointer, so that nothing is computed beforehand.
bool lies_on_plane_rounding(int mode, float corner, float u_end, float v_end, int size, int a, int b, float here) {
  struct Arguments {
    volatile float corner, u_end, v_end, per_step, a, b, here;
  } x{corner, u_end, v_end, 1.0f / static_cast<float>(size), static_cast<float>(a), static_cast<float>(b), here};
  static bool (*volatile const test)(float, float, float, float, float, float) = lies_on_plane;
  std::fesetround(mode);
  volatile float along_u = (x.u_end - x.corner) * x.per_step, along_v = (x.v_end - x.corner) * x.per_step;
  const bool lies = test(x.corner, along_u, along_v, x.a, x.b, x.here);
  std::fesetround(FE_TONEAREST);
  return lies;
}

TEST(Pyramid, NothingBeyondTheToleranceLiesOnAPlaneHoweverADeviceRounds) {
  test::Random random(3);
  int lies = 0, beyond = 0, strict = 0;
  for (int k = 0; k < 300000; ++k) {
    const int size = 2 << (2 * (k % 5)), a = static_cast<int>(random(0.0, size + 0.99)),
              b = static_cast<int>(random(0.0, size + 0.99));
    // Slopes from none to as steep as w allows, and samples all about the bound.
    const double scale = std::exp(random(-12.0, 12.0)), steep = std::pow(random(0.0, 1.0), 4.0);
    const auto corner = static_cast<float>(scale),
               u_end = static_cast<float>(scale * (1.0 + steep * random(-0.9, 9.0)));
    const auto v_end = static_cast<float>(scale * (1.0 + steep * random(-0.9, 9.0)));
    const double plane = double{corner} + (double{u_end} - corner) / size * a + (double{v_end} - corner) / size * b;
    if (plane <= 0.0) continue;
    const auto here = static_cast<float>(plane * (1.0 + 2e-6 * random(-1.5, 1.5)));
    const double off = std::abs(plane - here) / here;
    beyond += off > double{kPlanarTolerance};
    for (const int mode : {FE_TONEAREST, FE_TOWARDZERO, FE_UPWARD, FE_DOWNWARD}) {
      const bool says = lies_on_plane_rounding(mode, corner, u_end, v_end, size, a, b, here);
      lies += says;
      strict += !says && off <= double{kPlanarTolerance} && steep < 0.01;
      ASSERT_TRUE(!says || off <= double{kPlanarTolerance}) << "off by " << off << ", mode " << mode;
    }
  }
  EXPECT_GT(lies, 400000);
  EXPECT_GT(beyond, 60000);
  EXPECT_LT(strict, 30000) << "hardly more than what is beyond is refused";
}

TEST(Pyramid, CodesAreAtLeastWhatTheyStandForAndInItsOrder) {
  EXPECT_EQ(pyramid_code(0u), 0u);
  std::uint32_t before = 0;
  for (double w = 1e-9; w < 2e6; w *= 1.0001) {
    const auto sample = static_cast<float>(w);
    const std::uint32_t code = pyramid_code(std::bit_cast<std::uint32_t>(sample));
    ASSERT_GE(f32::entry_maximum(code), sample);
    ASSERT_LE(f32::entry_maximum(code), std::max(sample * 1.002f, 2.4e-10f));
    ASSERT_GE(code, before);
    before = code;
  }
}

}  // namespace
}  // namespace probewalk
