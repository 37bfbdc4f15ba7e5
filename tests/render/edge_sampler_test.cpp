// Extra rays at edges: they bring the picture nearer to one of sixteen rays a pixel, and touch nothing else.
#include "render/edge_sampler.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gpu_test.h"
#include "probe_room.h"
#include "render/frame_renderer.h"
#include "render/readback.h"
#include "render/view.h"
#include "shaders/shared/display_transform.h"

namespace probewalk {
namespace {

constexpr VkExtent2D kExtent{100, 70};
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;
constexpr int kFiner = 4;  // the reference's rays a pixel's side

struct Traced {
  std::vector<ImageRgbF> radiance;
  std::vector<std::vector<glm::uvec4>> counts;
};

class EdgeSamplerTest : public test::GpuTest {
 protected:
  EdgeSamplerTest() {
    store.upload(room.upload());
    settings.trace = default_dials(test::kRadianceScale);
  }

  // Pixels are as wide as in a picture of kExtent, whatever `extent` says: the reference filters radiance likewise.
  std::vector<ViewConstants> eyes(glm::dvec3 head_m, const glm::dquat& turned, float fov_rad) const {
    std::vector<ViewConstants> views;
    for (int k = 0; k < 2; ++k) {
      const ViewFov fov{-fov_rad, fov_rad, 0.7f * fov_rad, -0.7f * fov_rad};
      const glm::dvec3 eye_m = head_m + glm::dvec3(0.063 * k, 0, 0);
      views.push_back(view_constants(eye_m, turned, fov, static_cast<int>(kExtent.width)));
    }
    return views;
  }
  Traced trace(const std::vector<ViewConstants>& views, std::uint32_t samples, VkExtent2D extent = kExtent,
               bool aov = true) {
    FrameRenderer renderer(device, store, {{extent, 2, aov, samples}, kFormat});
    constexpr VkImageUsageFlags kUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const Image image(device, {kFormat, extent, 2, kUsage});
    const FrameTarget target = test::frame_target(image, kFormat, extent);
    // Twice: the second frame's list must not hold the first one's pixels.
    for (int frame = 0; frame < 2; ++frame) {
      renderer.record(target);
      renderer.write(views, settings);
      renderer.submit();
    }
    renderer.wait();
    return {read_radiance(device, renderer.tracer().radiance()), read_uints(device, renderer.tracer().aov())};
  }
  glm::vec3 shown(glm::vec3 stored) const { return tone_curve(stored * (settings.exposure / test::kRadianceScale)); }
  // Mean square difference, as displayed, from sixteen rays a pixel.
  double error(const ImageRgbF& picture, const ImageRgbF& fine) const {
    double sum = 0.0;
    for (int y = 0; y < picture.height_px; ++y) {
      for (int x = 0; x < picture.width_px; ++x) {
        glm::vec3 mean(0.0f);
        for (int k = 0; k < kFiner * kFiner; ++k) {
          const int fine_x = x * kFiner + k % kFiner, fine_y = y * kFiner + k / kFiner;
          mean += shown(fine.rgb[static_cast<std::size_t>(fine_y * fine.width_px + fine_x)]);
        }
        const glm::vec3 expected = mean / static_cast<float>(kFiner * kFiner);
        const glm::vec3 actual = shown(picture.rgb[static_cast<std::size_t>(y * picture.width_px + x)]);
        for (int c = 0; c < 3; ++c) {
          const double off = srgb_encode(actual[c]) - srgb_encode(expected[c]);
          sum += off * off;
        }
      }
    }
    return sum / (3.0 * picture.width_px * picture.height_px);
  }
  static std::uint32_t rays_of(glm::uvec4 counts) { return counts.w >> 8 & 255u; }

  const test::ProbeRoom room;
  ProbeStore store{device, room.grid, room.probe_count(), {.frame_slots = kFrameSlots}};
  FrameSettings settings;
  const std::vector<ViewConstants> furniture = eyes({0.3, 1.5, 1.9}, glm::angleAxis(-0.35, glm::dvec3(1, 0, 0)), 0.7f);
};

TEST_F(EdgeSamplerTest, MoreRaysComeNearerToSixteenOfEveryPixel) {
  const Traced fine = trace(furniture, 1, {kExtent.width * kFiner, kExtent.height * kFiner}, false);
  const Traced one = trace(furniture, 1), two = trace(furniture, 2), four = trace(furniture, 4);
  for (std::size_t view = 0; view < 2; ++view) {
    const double error1 = error(one.radiance[view], fine.radiance[view]);
    const double error2 = error(two.radiance[view], fine.radiance[view]);
    const double error4 = error(four.radiance[view], fine.radiance[view]);
    std::printf("view %zu: PSNR %.2f dB with 1, %.2f with 2, %.2f with 4 rays at edges\n", view,
                -10 * std::log10(error1), -10 * std::log10(error2), -10 * std::log10(error4));
    EXPECT_LT(error2, 0.75 * error1);
    EXPECT_LT(error4, 0.4 * error1);
  }
}

TEST_F(EdgeSamplerTest, CountsItsRaysAndLeavesOtherPixelsAsTheyWere) {
  const Traced one = trace(furniture, 1);
  for (const std::uint32_t samples : {2u, 4u}) {
    const Traced more = trace(furniture, samples);
    std::size_t edges = 0;
    for (std::size_t view = 0; view < 2; ++view) {
      for (std::size_t i = 0; i < one.counts[view].size(); ++i) {
        const glm::uvec4 before = one.counts[view][i], after = more.counts[view][i];
        ASSERT_EQ(rays_of(before), 1u);
        EXPECT_EQ(glm::uvec2(before), glm::uvec2(after)) << "class and probe are the first ray's";
        if (rays_of(after) == 1u) {
          ASSERT_EQ(before, after);
          ASSERT_EQ(one.radiance[view].rgb[i], more.radiance[view].rgb[i]);
          continue;
        }
        ASSERT_EQ(rays_of(after), samples);
        EXPECT_GT(after.z, before.z);
        EXPECT_GE(after.w & 255u, (before.w & 255u) + samples - 1);
        EXPECT_GT(after.w >> 16, before.w >> 16);
        ++edges;
      }
    }
    EXPECT_GT(edges, kExtent.width * kExtent.height * 2 / 50);
    EXPECT_LT(edges, kExtent.width * kExtent.height * 2 / 2);
  }
}

TEST_F(EdgeSamplerTest, APictureWithoutEdgesIsTheSameToTheBit) {
  // Nothing but the west wall, at an angle: its inverse depth is affine.
  const auto wall = eyes({-2.0, 1.5, 0.9}, glm::angleAxis(1.2, glm::dvec3(0, 1, 0)), 0.3f);
  const Traced one = trace(wall, 1), four = trace(wall, 4);
  EXPECT_EQ(one.counts, four.counts);
  for (std::size_t view = 0; view < 2; ++view) EXPECT_EQ(one.radiance[view].rgb, four.radiance[view].rgb);
}

TEST_F(EdgeSamplerTest, RefusesOtherNumbers) {
  for (const std::uint32_t samples : {0u, 3u, 8u}) {
    EXPECT_THROW(StereoTracer(device, {kExtent, 2, false, samples}), std::logic_error) << samples;
  }
}

TEST(ToneCurve, HasAnInverse) {
  for (const float bright : {0.0f, 0.01f, 0.3f, 0.79f, 0.81f, 3.0f, 40.0f, 900.0f}) {
    for (const float tint : {1.0f, 0.6f, 0.05f, 0.0f}) {
      // Of one color, and of a bright sky's mean with a dark frame.
      const glm::vec3 color = tone_curve(glm::vec3(bright, bright * (0.5f + 0.5f * tint), bright * tint));
      for (const glm::vec3& wanted : {color, 0.25f * color + 0.75f * tone_curve(glm::vec3(0.03f, 0.025f, 0.02f))}) {
        const glm::vec3 back = tone_curve(tone_curve_inverse(wanted));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(back[c], wanted[c], 2e-4f) << bright << " " << tint;
      }
    }
  }
}

}  // namespace
}  // namespace probewalk
