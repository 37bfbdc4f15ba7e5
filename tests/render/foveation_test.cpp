// Fixed foveation: the fovea as without, one ray a block elsewhere, every pixel filled.
#include "render/foveation.h"

#include <gtest/gtest.h>

#include <set>

#include "content/error.h"
#include "content/probe/tracer_f32.h"
#include "gpu_test.h"
#include "probe_room.h"
#include "render/frame_renderer.h"
#include "render/readback.h"
#include "render/view.h"
#include "shaders/shared/foveation.h"

namespace probewalk {
namespace {

constexpr VkExtent2D kExtent{150, 109};  // no multiple of a block
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;
constexpr Foveation kNarrow{0.25f, 0.5f};

struct Drawn {
  std::vector<std::vector<float>> distance_m;
  std::vector<std::vector<glm::uvec4>> counts;
  std::vector<ImageRgbF> radiance;
};

class FoveationTest : public test::GpuTest {
 protected:
  FoveationTest() { store.upload(room.upload()); }

  Drawn draw(const std::optional<Foveation>& foveation, std::uint32_t samples = 1) {
    FrameRenderer renderer(
        device, store,
        {.tracer = {.extent_px = kExtent, .views = 2, .aov = true, .samples = samples, .foveation = foveation},
         .target_format = kFormat});
    const Image image(device,
                      {kFormat, kExtent, 2, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    const FrameTarget target = test::frame_target(image, kFormat, kExtent);
    FrameSettings settings;
    settings.trace = default_dials(test::kRadianceScale);
    renderer.record(target);
    renderer.write(views(), settings);
    renderer.submit();
    renderer.wait();
    return {read_floats(device, renderer.tracer().distance()), read_uints(device, renderer.tracer().aov()),
            read_radiance(device, renderer.tracer().radiance())};
  }

  static std::vector<ViewConstants> views() {
    std::vector<ViewConstants> both;
    for (const double side : {-0.5, 0.5}) {
      const ViewFov fov{-0.9f + 0.1f * float(side), 0.8f + 0.1f * float(side), 0.7f, -0.75f};
      both.push_back(view_constants(glm::dvec3(0.3 + 0.063 * side, 1.5, 0.9), glm::angleAxis(0.4, glm::dvec3(0, 1, 0)),
                                    fov, static_cast<int>(kExtent.width)));
    }
    share_choice(both);
    return both;
  }
  static FrameConstants frame() {
    FrameConstants constants{};
    constants.size_px = {kExtent.width, kExtent.height};
    constants.full_rate_cosine = std::cos(kNarrow.full_rad);
    constants.half_rate_cosine = std::cos(kNarrow.half_rad);
    return constants;
  }
  static std::size_t index_of(glm::ivec2 pixel) {
    return static_cast<std::size_t>(pixel.y) * kExtent.width + static_cast<std::size_t>(pixel.x);
  }

  const test::ProbeRoom room;
  ProbeStore store{device, room.grid, room.probe_count(), {.frame_slots = kFrameSlots}};
};

TEST_F(FoveationTest, TheFoveaIsAsWithoutAndOutsideARayStandsForABlock) {
  const Drawn plain = draw(std::nullopt), foveated = draw(kNarrow);
  const ProbeSet set = room.on_cpu();
  const FrameConstants constants = frame();
  for (std::size_t view = 0; view < 2; ++view) {
    const ViewConstants eye = views()[view];
    SelectionRules rules = default_rules();
    rules.choice_shift_m = choice_shift(eye);
    std::set<int> rates;
    std::size_t rays = 0, blocks = 0;
    for (int y = 0; y < int(kExtent.height); ++y) {
      for (int x = 0; x < int(kExtent.width); ++x) {
        const glm::ivec2 pixel(x, y);
        const int rate = foveation_rate(eye, pixel, constants);
        rates.insert(rate);
        const std::size_t at = index_of(pixel);
        rays += foveated.counts[view][at].w >> 8 & 255u;
        if (rate == 1) {
          ++blocks;
          ASSERT_EQ(foveated.distance_m[view][at], plain.distance_m[view][at]);
          ASSERT_EQ(foveated.radiance[view].rgb[at], plain.radiance[view].rgb[at]);
          ASSERT_EQ(foveated.counts[view][at], plain.counts[view][at]);
          continue;
        }
        const glm::ivec2 corner = pixel / rate * rate;
        blocks += pixel == corner;
        const glm::vec3 d = view_ray_through(eye, glm::vec2(corner) + 0.5f * float(rate), constants.size_px);
        const auto expected = f32::trace_ray(set.grid(), default_dials(test::kRadianceScale), rules, eye.origin_hi_m,
                                             eye.origin_lo_m, d, kStartLevel);
        ASSERT_EQ(foveated.distance_m[view][at], expected.t) << x << ", " << y << " at rate " << rate;
        ASSERT_EQ(foveated.counts[view][at].y, static_cast<unsigned>(expected.probe));
        const bool keeps = pixel == block_keeper(pixel, rate, constants.size_px);
        ASSERT_EQ(foveated.counts[view][at].z, keeps ? expected.lookups : 0u);
      }
    }
    EXPECT_EQ(rates, (std::set<int>{1, 2, 4}));
    EXPECT_EQ(rays, blocks);
    EXPECT_LT(rays, std::size_t{kExtent.width} * kExtent.height / 2);
  }
}

TEST_F(FoveationTest, BetweenRaysIsFilledWithWhatTheyShow) {
  const Drawn plain = draw(std::nullopt), foveated = draw(kNarrow);
  // Most of the room is smooth: filled in it looks like itself, but for edges and the blocks around them. Left
  // unfilled, half of the picture would be off.
  std::size_t off = 0, all = 0;
  for (std::size_t view = 0; view < 2; ++view) {
    for (std::size_t at = 0; at < plain.radiance[view].rgb.size(); ++at) {
      const glm::vec3 here = foveated.radiance[view].rgb[at], there = plain.radiance[view].rgb[at];
      ASSERT_TRUE(here.x >= 0.0f && here.y >= 0.0f && here.z >= 0.0f);
      off += glm::length(here - there) > 0.1f * glm::length(there) + 1e-4f;
      ++all;
    }
  }
  EXPECT_LT(double(off), 0.2 * double(all));
}

TEST_F(FoveationTest, PixelsOfBlocksGetNoRaysForTheirEdges) {
  const Drawn smooth = draw(kNarrow, 4);
  const FrameConstants constants = frame();
  std::size_t extra = 0;
  for (std::size_t view = 0; view < 2; ++view) {
    for (int y = 0; y < int(kExtent.height); ++y) {
      for (int x = 0; x < int(kExtent.width); ++x) {
        const unsigned rays = smooth.counts[view][index_of({x, y})].w >> 8 & 255u;
        const int rate = foveation_rate(views()[view], {x, y}, constants);
        if (rate > 1) {
          ASSERT_LE(rays, 1u);
        }
        extra += rays > 1;
      }
    }
  }
  EXPECT_GT(extra, 0u) << "edges in the fovea are still smoothed";
}

TEST(FoveationLevels, AreOrderedAndKnownByName) {
  EXPECT_FALSE(foveation_of("off"));
  const Foveation low = foveation_of("low").value(), medium = foveation_of("medium").value(),
                  high = foveation_of("high").value();
  EXPECT_GT(low.full_rad, medium.full_rad);
  EXPECT_GT(medium.full_rad, high.full_rad);
  for (const Foveation& level : {low, medium, high}) EXPECT_LT(level.full_rad, level.half_rad);
  try {
    foveation_of("extreme");
    FAIL() << "an unknown level was taken";
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("medium"), std::string::npos);
  }
}

}  // namespace
}  // namespace probewalk
