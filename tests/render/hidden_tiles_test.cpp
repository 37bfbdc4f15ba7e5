// What a visibility mask saves, and that what can be seen stays as it is.
#include "render/hidden_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "content/probe/tracer_f32.h"
#include "gpu_test.h"
#include "probe_room.h"
#include "render/frame_renderer.h"
#include "render/readback.h"
#include "render/view.h"

namespace probewalk {
namespace {

constexpr glm::vec4 kSquare(-1.0f, 1.0f, 1.0f, -1.0f);

// All but a disc of this radius around the view's axis: a ring of quads out to `far`.
HiddenMesh ring(float radius, float far = 4.0f) {
  constexpr int kParts = 48;
  HiddenMesh mesh;
  for (int i = 0; i < kParts; ++i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * float(i) / kParts;
    mesh.vertices.push_back(radius * glm::vec2(std::cos(angle), std::sin(angle)));
    mesh.vertices.push_back(far * glm::vec2(std::cos(angle), std::sin(angle)));
    const auto a = std::uint32_t(2 * i), b = std::uint32_t(2 * ((i + 1) % kParts));
    for (const std::uint32_t index : {a, a + 1, b, b, a + 1, b + 1}) mesh.indices.push_back(index);
  }
  return mesh;
}

std::size_t count(const std::vector<std::uint8_t>& tiles) {
  std::size_t n = 0;
  for (const std::uint8_t tile : tiles) n += tile;
  return n;
}

TEST(HiddenTiles, NothingIsHiddenWithoutTriangles) {
  EXPECT_EQ(count(hidden_tiles({}, kSquare, {100, 60}, 2)), 0u);
  EXPECT_EQ(hidden_tiles({}, kSquare, {100, 60}, 2).size(), 13u * 8u);
  EXPECT_EQ(count(hidden_tiles({{{0, 0}, {1, 0}}, {0, 1}}, kSquare, {64, 64}, 2)), 0u);
}

TEST(HiddenTiles, HideNoPixelOutsideTheMeshNorNextToOne) {
  for (const VkExtent2D extent : {VkExtent2D{320, 320}, VkExtent2D{333, 181}, VkExtent2D{1200, 1100}}) {
    for (const int margin_px : {2, 8}) {
      const float radius = 0.9f;
      const auto tiles = hidden_tiles(ring(radius), kSquare, extent, margin_px);
      const int columns = (int(extent.width) + 7) / 8;
      std::size_t hidden = count(tiles), outside = 0;
      for (int y = 0; y < int(extent.height); ++y) {
        for (int x = 0; x < int(extent.width); ++x) {
          // The ring is a polygon: a little within its radius is within it for sure.
          const glm::vec2 p(2.0f * (float(x) + 0.5f) / float(extent.width) - 1.0f,
                            1.0f - 2.0f * (float(y) + 0.5f) / float(extent.height));
          const bool visible = glm::length(p) < radius * std::cos(std::numbers::pi_v<float> / 48.0f);
          outside += glm::length(p) > radius ? 1 : 0;
          for (const int dx : {-margin_px, 0, margin_px}) {
            const int near_x = std::clamp(x + dx, 0, int(extent.width) - 1);
            if (visible) {
              ASSERT_EQ(tiles[std::size_t(y / 8 * columns + near_x / 8)], 0) << x << ", " << y << " " << margin_px;
            }
          }
        }
      }
      // Not all that is outside, since tiles are whole; but most of it where they are small.
      if (extent.width == 1200) {
        EXPECT_GT(double(hidden) * 64.0, 0.75 * double(outside)) << margin_px;
      }
    }
  }
}

TEST(HiddenTiles, TrianglesThatMeetHideWhatLiesAcrossTheirEdge) {
  // The whole view as a fan of slivers around a point that is no point of the grid.
  HiddenMesh mesh;
  mesh.vertices.push_back({0.137f, -0.2613f});
  for (int i = 0; i < 37; ++i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * float(i) / 37.0f;
    mesh.vertices.push_back(5.0f * glm::vec2(std::cos(angle), std::sin(angle)));
    for (const int index : {0, i + 1, (i + 1) % 37 + 1}) mesh.indices.push_back(std::uint32_t(index));
  }
  const auto tiles = hidden_tiles(mesh, kSquare, {203, 155}, 2);
  EXPECT_EQ(count(tiles), tiles.size());
}

TEST(HiddenTiles, HostileMeshesHideNothingAndBreakNothing) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  HiddenMesh mesh{{{nan, 0}, {inf, 1}, {-inf, 2}, {1e30f, -1e30f}, {0, 0}, {0, 0}}, {0, 1, 2, 3, 4, 99, 5, 5, 5, 1, 2}};
  EXPECT_EQ(count(hidden_tiles(mesh, kSquare, {128, 128}, 2)), 0u);
}

TEST(HiddenTiles, WordsHoldTheViewsOneAfterTheOther) {
  const std::vector<std::vector<std::uint8_t>> views{{1, 0, 0}, std::vector<std::uint8_t>(40, 1)};
  const auto words = hidden_tile_words(views);
  ASSERT_EQ(words.size(), 2u);
  EXPECT_EQ(words[0], 0xfffffff9u);
  EXPECT_EQ(words[1], (1u << 11) - 1u);
}

constexpr VkExtent2D kExtent{150, 109};
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;

class HiddenTilesOnDevice : public test::GpuTest {
 protected:
  struct Drawn {
    std::vector<std::vector<float>> distance_m;
    std::vector<std::vector<glm::uvec4>> counts;
    std::vector<ImageRgb8> shown;
  };
  HiddenTilesOnDevice() { store.upload(room.upload()); }

  Drawn draw(FrameRenderer& renderer, VkExtent2D extent = kExtent) {
    const Image image(device,
                      {kFormat, kExtent, 2, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    const FrameTarget target = test::frame_target(image, kFormat, extent);
    FrameSettings settings;
    settings.trace = default_dials(test::kRadianceScale);
    renderer.record(target);
    renderer.write(views(extent), settings);
    renderer.submit();
    renderer.wait();
    return {read_floats(device, renderer.tracer().distance()), read_uints(device, renderer.tracer().aov()),
            read_pictures(device, target.image, target.final_layout, kFormat, extent, 2)};
  }
  static std::vector<ViewConstants> views(VkExtent2D extent) {
    std::vector<ViewConstants> both;
    for (const double side : {-0.5, 0.5}) {
      const ViewFov fov{-0.8f + 0.1f * float(side), 0.8f + 0.1f * float(side), 0.75f, -0.75f};
      both.push_back(view_constants(glm::dvec3(0.3 + 0.063 * side, 1.5, 0.9), glm::angleAxis(0.4, glm::dvec3(0, 1, 0)),
                                    fov, static_cast<int>(extent.width)));
    }
    return both;
  }
  FrameRendererOptions options(bool masked, std::uint32_t samples, const std::optional<Foveation>& foveation) const {
    return {.tracer = {.extent_px = kExtent,
                       .views = 2,
                       .aov = true,
                       .samples = samples,
                       .foveation = foveation,
                       .masked = masked},
            .target_format = kFormat};
  }

  const test::ProbeRoom room;
  ProbeStore store{device, room.grid, room.probe_count(), {.frame_slots = kFrameSlots}};
};

TEST_F(HiddenTilesOnDevice, HiddenPixelsAreSkippedAndVisibleOnesAreTheSameToTheBit) {
  const HiddenMesh mesh = ring(0.7f);
  const std::pair<std::uint32_t, std::optional<Foveation>> ways[] = {{1, std::nullopt}, {4, Foveation{0.2f, 0.4f}}};
  for (const auto& [samples, foveation] : ways) {
    FrameRenderer whole(device, store, options(false, samples, foveation));
    const Drawn all = draw(whole);
    FrameRenderer masked(device, store, options(true, samples, foveation));
    masked.hide({mesh, mesh});
    const Drawn seen = draw(masked);
    const auto eyes = views(kExtent);
    std::uint64_t lookups_all = 0, lookups_seen = 0;
    std::size_t skipped = 0, visible = 0;
    for (std::size_t v = 0; v < 2; ++v) {
      const auto tiles = hidden_tiles(mesh, eyes[v].tan_angles, kExtent, foveation ? 8 : 2);
      EXPECT_GT(count(tiles), 20u);
      for (std::size_t i = 0; i < all.counts[v].size(); ++i) {
        const int x = int(i % kExtent.width), y = int(i / kExtent.width);
        lookups_all += all.counts[v][i].z;
        lookups_seen += seen.counts[v][i].z;
        if (tiles[std::size_t(y / 8 * 19 + x / 8)] != 0) {
          ++skipped;
          EXPECT_EQ(seen.counts[v][i].z, 0u);
          EXPECT_EQ(seen.counts[v][i].w, 0u);
          EXPECT_EQ(seen.shown[v].rgb[3 * i], 0);
          continue;
        }
        const glm::vec4 tan = eyes[v].tan_angles;
        const glm::vec2 at(tan.x + (float(x) + 0.5f) / kExtent.width * (tan.y - tan.x),
                           tan.z + (float(y) + 0.5f) / kExtent.height * (tan.w - tan.z));
        if (glm::length(at) > 0.69f) continue;
        ++visible;
        EXPECT_EQ(seen.counts[v][i], all.counts[v][i]) << x << ", " << y;
        EXPECT_EQ(seen.distance_m[v][i], all.distance_m[v][i]);
        for (std::size_t c = 0; c < 3; ++c) {
          EXPECT_EQ(seen.shown[v].rgb[3 * i + c], all.shown[v].rgb[3 * i + c]) << x << ", " << y;
        }
      }
    }
    EXPECT_GT(visible, 10000u);
    EXPECT_GT(skipped, 3000u);
    EXPECT_LT(lookups_seen, lookups_all);
  }
}

TEST_F(HiddenTilesOnDevice, TheMaskFollowsItsMeshAndTheExtent) {
  FrameRenderer masked(device, store, options(true, 1, {}));
  const auto lookups = [&](VkExtent2D extent) {
    const Drawn drawn = draw(masked, extent);
    std::uint64_t sum = 0;
    for (std::uint32_t y = 0; y < extent.height; ++y) {
      for (std::uint32_t x = 0; x < extent.width; ++x) sum += drawn.counts[0][y * kExtent.width + x].z;
    }
    return sum;
  };
  const std::uint64_t open = lookups(kExtent);
  masked.hide({ring(0.5f), ring(0.5f)});
  const std::uint64_t narrow = lookups(kExtent);
  EXPECT_LT(narrow, open / 2);
  EXPECT_EQ(lookups(kExtent), narrow);  // the other slot's buffer
  const std::uint64_t small = lookups({90, 65});
  EXPECT_GT(small, narrow / 5);
  EXPECT_LT(small, narrow);
  masked.hide({ring(10.0f, 20.0f), ring(10.0f, 20.0f)});
  EXPECT_EQ(lookups(kExtent), open);
}

// A part of the target, as an eye's resolution that adapts has it: the same as a renderer made for that size.
TEST_F(HiddenTilesOnDevice, PartOfATargetIsDrawnAsAWholeOneOfThatSize) {
  constexpr VkExtent2D kPart{105, 76};
  constexpr std::uint32_t samples = 4;
  FrameRenderer large(device, store, options(false, samples, Foveation{0.3f, 0.5f}));
  draw(large);
  const Drawn part = draw(large, kPart);
  FrameRendererOptions small_options = options(false, samples, Foveation{0.3f, 0.5f});
  small_options.tracer.extent_px = kPart;
  FrameRenderer small(device, store, small_options);
  const Drawn whole = draw(small, kPart);
  for (std::size_t v = 0; v < 2; ++v) EXPECT_EQ(part.shown[v].rgb, whole.shown[v].rgb);
}

}  // namespace
}  // namespace probewalk
