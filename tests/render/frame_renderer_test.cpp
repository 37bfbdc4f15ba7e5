#include "render/frame_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <thread>

#include "content/image/image.h"
#include "content/probe/tracer_f32.h"
#include "gpu_test.h"
#include "probe_room.h"
#include "render/readback.h"
#include "render/view.h"
#include "shaders/shared/display_transform.h"
#include "shaders/shared/lookup_colors.h"
#include "shaders/shared/view_depth.h"
#include "shaders/shared/view_ray.h"

namespace probewalk {
namespace {

constexpr VkExtent2D kExtent{100, 70};  // no multiple of a tile
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;

std::int64_t monotonic_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{1000000000} * now.tv_sec + now.tv_nsec;
}

class FrameRendererTest : public test::GpuTest {
 protected:
  FrameRendererTest() {
    store.upload(room.upload());
    settings.trace = default_dials(test::kRadianceScale);
  }

  static FrameRendererOptions options(std::uint32_t views, bool aov = true) {
    return {.tracer = {.extent_px = kExtent, .views = views, .aov = aov}, .target_format = kFormat};
  }
  Image make_target(std::uint32_t views, VkFormat format = kFormat) const {
    return Image(device,
                 {format, kExtent, views, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
  }
  static FrameTarget target_of(const Image& image) {
    FrameTarget target;
    target.image = image.handle();
    target.format = image.options().format;
    target.extent = image.options().extent_px;
    target.layers = image.options().layers;
    target.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    return target;
  }
  static std::vector<ViewConstants> views_at(glm::dvec3 head_m, std::uint32_t count, double yaw_rad = 0.4) {
    std::vector<ViewConstants> views;
    const glm::dquat turned = glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0)) * glm::angleAxis(-0.2, glm::dvec3(1, 0, 0));
    for (std::uint32_t k = 0; k < count; ++k) {
      const ViewFov fov{-0.7f, 0.6f + 0.05f * static_cast<float>(k), 0.5f, -0.55f};
      views.push_back(
          view_constants(head_m + glm::dvec3(0.063 * k, 0, 0), turned, fov, static_cast<int>(kExtent.width)));
    }
    return views;
  }
  // One frame, waited for.
  std::vector<ImageRgb8> draw(FrameRenderer& renderer, const Image& image, const std::vector<ViewConstants>& views) {
    renderer.record(target_of(image));
    renderer.write(views, settings);
    renderer.submit();
    renderer.wait();
    return read_pictures(device, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image.options().format, kExtent,
                         image.options().layers);
  }

  const test::ProbeRoom room;
  ProbeStore store{device, room.grid, room.probe_count(), {.frame_slots = kFrameSlots}};
  FrameSettings settings;
};

TEST_F(FrameRendererTest, TracesEveryPixelOfEveryViewAsTheCppTracer) {
  for (const std::uint32_t count : {1u, 2u, 4u}) {
    FrameRenderer renderer(device, store, options(count));
    const Image image = make_target(count);
    auto views = views_at({0.3, 1.5, 0.9}, count);
    draw(renderer, image, views);
    share_choice(views);
    const auto distances = read_floats(device, renderer.tracer().distance());
    const auto aov = read_uints(device, renderer.tracer().aov());
    const ProbeSet set = room.on_cpu();
    int differ = 0;
    for (std::uint32_t view = 0; view < count; ++view) {
      for (int y = 0; y < static_cast<int>(kExtent.height); ++y) {
        for (int x = 0; x < static_cast<int>(kExtent.width); ++x) {
          const glm::vec3 d = view_ray(views[view], {x, y}, {kExtent.width, kExtent.height});
          SelectionRules rules = default_rules();
          rules.choice_shift_m = choice_shift(views[view]);
          const auto expected = f32::trace_ray(set.grid(), settings.trace, rules, views[view].origin_hi_m,
                                               views[view].origin_lo_m, d, kStartLevel);
          const std::size_t at = static_cast<std::size_t>(y) * kExtent.width + static_cast<std::size_t>(x);
          differ += distances[view][at] != expected.t || aov[view][at].x != static_cast<unsigned>(expected.cls) ||
                    aov[view][at].y != static_cast<unsigned>(expected.probe) || aov[view][at].z != expected.lookups;
        }
      }
    }
    EXPECT_EQ(differ, 0) << count << " views";
  }
}

// From within the room, from outside the grid, and at edges with more rays.
TEST_F(FrameRendererTest, SharedOpeningsChangeNoBit) {
  for (const std::uint32_t samples : {1u, 4u}) {
    for (const glm::dvec3 head_m : {glm::dvec3(0.3, 1.5, 0.9), glm::dvec3(40.0, -7.0, 3.0)}) {
      std::vector<std::vector<std::vector<float>>> distances;
      std::vector<std::vector<std::vector<glm::uvec4>>> aov;
      std::vector<std::vector<ImageRgb8>> pictures;
      for (const bool shared : {false, true}) {
        FrameRendererOptions dials = options(2);
        dials.tracer.samples = samples;
        dials.tracer.shared_openings = shared;
        FrameRenderer renderer(device, store, dials);
        const Image image = make_target(2);
        pictures.push_back(draw(renderer, image, views_at(head_m, 2)));
        distances.push_back(read_floats(device, renderer.tracer().distance()));
        aov.push_back(read_uints(device, renderer.tracer().aov()));
      }
      EXPECT_EQ(distances[0], distances[1]);
      EXPECT_EQ(aov[0], aov[1]);
      for (int eye = 0; eye < 2; ++eye) EXPECT_EQ(pictures[0][eye].rgb, pictures[1][eye].rgb);
    }
  }
}

TEST_F(FrameRendererTest, SamePoseGivesTheSamePicture) {
  FrameRenderer renderer(device, store, options(2, false));
  const Image image = make_target(2);
  const auto views = views_at({0.0, 1.4, 0.5}, 2);
  const auto first = draw(renderer, image, views);
  draw(renderer, image, views_at({-1.0, 1.4, 0.5}, 2));
  const auto again = draw(renderer, image, views);
  for (int view = 0; view < 2; ++view) EXPECT_EQ(first[view].rgb, again[view].rgb);
  EXPECT_NE(first[0].rgb, first[1].rgb) << "two eyes see two pictures";
}

TEST_F(FrameRendererTest, ShowsRadianceThroughExposureCurveAndEncoding) {
  settings.exposure = 0.7f;
  for (const VkFormat format : {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB}) {
    FrameRendererOptions dials = options(1);
    dials.target_format = format;
    FrameRenderer renderer(device, store, dials);
    const Image image = make_target(1, format);
    const auto picture = draw(renderer, image, views_at({0.0, 1.4, 0.5}, 1)).front();
    const auto radiance = read_radiance(device, renderer.tracer().radiance()).front();
    double sum = 0.0;
    for (std::size_t i = 0; i < radiance.rgb.size(); ++i) {
      const glm::vec3 shown = tone_curve(radiance.rgb[i] * (settings.exposure / test::kRadianceScale));
      for (int c = 0; c < 3; ++c) {
        const float expected = 255.0f * srgb_encode(shown[c]);
        const float error = static_cast<float>(picture.rgb[3 * i + static_cast<std::size_t>(c)]) - expected;
        ASSERT_LT(std::abs(error), 1.01f);
        sum += static_cast<double>(error);
      }
    }
    EXPECT_LT(std::abs(sum / static_cast<double>(3 * radiance.rgb.size())), 0.02) << "the dither is fair";
  }
}

TEST(LookupColors, RunFromBlackByBlueGreenAndRedToWhite) {
  EXPECT_EQ(lookup_color(0.0f), glm::vec3(0.0f));
  EXPECT_EQ(lookup_color(kMostLookups), glm::vec3(1.0f));
  EXPECT_EQ(lookup_color(1e6f), glm::vec3(1.0f));
  const glm::vec3 few = lookup_color(12.8f), some = lookup_color(25.6f), many = lookup_color(51.2f);
  EXPECT_TRUE(few.b > few.g && few.g > few.r) << "blue";
  EXPECT_TRUE(some.g > some.b && some.b > some.r) << "green";
  EXPECT_TRUE(many.r > 4.0f * many.g) << "red";
  for (int n = 1; n <= 64; ++n) {
    EXPECT_GT(glm::distance(lookup_color(static_cast<float>(n)), lookup_color(static_cast<float>(n - 1))), 0.004f) << n;
  }
}

TEST_F(FrameRendererTest, ShowsEachPixelsLookUpsAsTheirColour) {
  FrameRenderer renderer(device, store, options(2, false));
  const Image image = make_target(2);
  const auto views = views_at({0.3, 1.5, 0.9}, 2);
  const auto picture = draw(renderer, image, views);
  const std::uint32_t pipelines = device.pipelines_built();
  renderer.show_lookups(true);
  auto shown = draw(renderer, image, views);
  for (int k = 0; k < 1000 && shown[0].rgb == picture[0].rgb; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    shown = draw(renderer, image, views);
  }
  ASSERT_NE(shown[0].rgb, picture[0].rgb) << "they never show";
  EXPECT_GT(device.pipelines_built(), pipelines);
  const auto aov = read_uints(device, renderer.tracer().aov());
  write_png(std::string(PROBEWALK_TEST_OUTPUT_DIR) + "/lookups.png", shown[0]);
  std::uint32_t least = ~0u, most = 0;
  for (std::size_t view = 0; view < 2; ++view) {
    for (std::size_t at = 0; at < aov[view].size(); ++at) {
      least = std::min(least, aov[view][at].z);
      most = std::max(most, aov[view][at].z);
      const glm::vec3 expected = lookup_color(static_cast<float>(aov[view][at].z));
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(shown[view].rgb[3 * at + static_cast<std::size_t>(c)], 255.0f * srgb_encode(expected[c]), 1.01f);
      }
    }
  }
  EXPECT_LT(least + 4, most) << "the picture tells pixels apart";
  renderer.show_lookups(false);
  const auto again = draw(renderer, image, views);
  for (std::size_t view = 0; view < 2; ++view) EXPECT_EQ(again[view].rgb, picture[view].rgb);
}

TEST_F(FrameRendererTest, FadesToBlack) {
  FrameRenderer renderer(device, store, options(1));
  const Image image = make_target(1);
  settings.fade = 1.0f;
  const auto picture = draw(renderer, image, views_at({0.0, 1.4, 0.5}, 1)).front();
  for (const std::uint8_t value : picture.rgb) ASSERT_EQ(value, 0);
}

TEST_F(FrameRendererTest, TheLastPoseWrittenBeforeSubmitIsTheOneDrawn) {
  FrameRenderer renderer(device, store, options(1));
  const Image image = make_target(1);
  const auto expected = draw(renderer, image, views_at({0.5, 1.5, 0.0}, 1)).front();
  renderer.record(target_of(image));
  renderer.write(views_at({-2.0, 1.0, 1.0}, 1), settings);
  renderer.write(views_at({0.5, 1.5, 0.0}, 1), settings);
  renderer.submit();
  renderer.wait();
  const auto late = read_pictures(device, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kFormat, kExtent, 1);
  EXPECT_EQ(late.front().rgb, expected.rgb);
}

TEST_F(FrameRendererTest, GivesDeviceTimesOnTheMonotonicClock) {
  FrameRenderer renderer(device, store, options(2, false));
  const Image image = make_target(2);
  EXPECT_FALSE(renderer.take_times().has_value());
  for (std::uint64_t frame = 1; frame <= 5; ++frame) {
    const std::int64_t before = monotonic_ns();
    draw(renderer, image, views_at({0.0, 1.4, 0.5}, 2));
    const std::int64_t after = monotonic_ns();
    const auto times = renderer.take_times();
    ASSERT_TRUE(times.has_value());
    EXPECT_EQ(times->frame, frame);
    ASSERT_TRUE(times->calibrated);
    EXPECT_GE(times->whole.begin_ns, before - times->max_deviation_ns);
    EXPECT_LE(times->whole.end_ns, after + times->max_deviation_ns);
    EXPECT_LT(times->trace.begin_ns, times->trace.end_ns);
    EXPECT_LE(times->trace.end_ns, times->resolve.begin_ns);
    EXPECT_LT(times->resolve.begin_ns, times->resolve.end_ns);
  }
  EXPECT_FALSE(renderer.take_times().has_value());
}

TEST_F(FrameRendererTest, KeepsTwoFramesInFlightWhileRoomsStream) {
  ProbeStore streaming(device, room.grid, room.probe_count(),
                       {.frame_slots = kFrameSlots, .upload_bytes_per_frame = 100000, .always_stage = true});
  FrameRenderer renderer(device, streaming, options(2, false));
  const Image image = make_target(2);
  streaming.upload(room.upload());
  std::uint64_t times_taken = 0;
  for (int k = 0; k < 20; ++k) {
    renderer.record(target_of(image));
    if (k == 7) renderer.record(target_of(image));  // a frame given up after recording
    renderer.write(views_at({0.1 * k, 1.4, 0.5}, 2), settings);
    renderer.submit();
    if (k == 14) streaming.evict(0, 0);
    while (const auto times = renderer.take_times()) EXPECT_EQ(times->frame, ++times_taken);
  }
  renderer.wait();
  while (renderer.take_times()) ++times_taken;
  EXPECT_EQ(times_taken, 20u);
  EXPECT_EQ(streaming.device_bytes(), 0u);
}

// Depth read back, a map a layer.
std::vector<std::vector<float>> read_depth(const Device& device, const Image& image) {
  const ImageOptions& options = image.options();
  const auto bytes = read_image(device, image.handle(), VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
                                options.format, options.extent_px, options.layers);
  const std::size_t texels = std::size_t{options.extent_px.width} * options.extent_px.height;
  std::vector<std::vector<float>> layers(options.layers, std::vector<float>(texels));
  for (std::size_t i = 0; i < texels * options.layers; ++i) {
    float& value = layers[i / texels][i % texels];
    if (options.format == VK_FORMAT_D32_SFLOAT) {
      std::memcpy(&value, bytes.data() + 4 * i, 4);
    } else {
      std::uint16_t code = 0;
      std::memcpy(&code, bytes.data() + 2 * i, 2);
      value = static_cast<float>(code) / 65535.0f;
    }
  }
  return layers;
}

TEST_F(FrameRendererTest, WritesTheDepthOfWhatIsSeen) {
  settings.depth = {1.2f, 3.1f};  // so that the room has things nearer and things farther
  for (const VkFormat format : {VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM}) {
    FrameRendererOptions dials = options(2);
    dials.depth_format = format;
    FrameRenderer renderer(device, store, dials);
    const Image image = make_target(2);
    const Image depth(
        device, {format, kExtent, 2, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    FrameTarget target = target_of(image);
    target.depth_image = depth.handle();
    target.depth_format = format;
    // Into the room, and at its window, where rays miss.
    std::size_t between = 0, at_near = 0, at_far = 0, misses = 0;
    for (const double yaw_rad : {0.4, -1.6}) {
      const auto views = views_at({0.3, 1.5, 0.9}, 2, yaw_rad);
      for (int again = 0; again < 2; ++again) {  // the second frame finds the image as the first left it
        renderer.record(target);
        renderer.write(views, settings);
        renderer.submit();
      }
      renderer.wait();
      const auto distances = read_floats(device, renderer.tracer().distance());
      const auto written = read_depth(device, depth);
      const double step = format == VK_FORMAT_D32_SFLOAT ? 1e-6 : 1.0 / 65535.0;
      for (std::size_t view = 0; view < 2; ++view) {
        for (std::size_t at = 0; at < distances[view].size(); ++at) {
          const glm::ivec2 pixel(static_cast<int>(at % kExtent.width), static_cast<int>(at / kExtent.width));
          // The pixel's ray and the view's axis, in double and without the shader's own functions.
          const glm::dvec3 ray(view_ray(views[view], pixel, {kExtent.width, kExtent.height}));
          const double z_m = -glm::dot(ray, glm::dvec3(views[view].world_from_eye_z)) * distances[view][at];
          const double near_m = settings.depth.near_m, far_m = settings.depth.far_m;
          const double clamped_m = std::clamp(z_m, near_m, far_m);
          const double expected = (1.0 / clamped_m - 1.0 / far_m) / (1.0 / near_m - 1.0 / far_m);
          ASSERT_NEAR(written[view][at], expected, step) << z_m << " m";
          if (z_m < near_m * 0.999) {
            ASSERT_EQ(written[view][at], 1.0f);
            ++at_near;
          } else if (z_m > far_m * 1.001) {
            ASSERT_EQ(written[view][at], 0.0f);
            ++at_far;
            misses += distances[view][at] >= kMissDistance_m;
          } else {
            ++between;
          }
        }
      }
    }
    EXPECT_GT(between, 1000u);
    EXPECT_GT(at_near, 100u);
    EXPECT_GT(at_far, misses);
    EXPECT_GT(misses, 100u);
  }
}

TEST_F(FrameRendererTest, DepthChangesNothingOfThePicture) {
  FrameRenderer plain(device, store, options(2, false));
  const Image image = make_target(2);
  const auto views = views_at({0.3, 1.5, 0.9}, 2);
  const auto expected = draw(plain, image, views);
  FrameRendererOptions dials = options(2, false);
  dials.depth_format = VK_FORMAT_D32_SFLOAT;
  FrameRenderer with_depth(device, store, dials);
  EXPECT_THROW(with_depth.record(target_of(image)), std::logic_error) << "no depth image";
  const Image depth(device, {VK_FORMAT_D32_SFLOAT, kExtent, 2, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT});
  FrameTarget target = target_of(image);
  target.depth_image = depth.handle();
  target.depth_format = VK_FORMAT_D32_SFLOAT;
  EXPECT_THROW(plain.record(target), std::logic_error) << "no depth asked for";
  with_depth.record(target);
  with_depth.write(views, settings);
  with_depth.submit();
  with_depth.wait();
  const auto drawn = read_pictures(device, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kFormat, kExtent, 2);
  for (int view = 0; view < 2; ++view) EXPECT_EQ(drawn[view].rgb, expected[view].rgb);
}

TEST(ViewDepth, RunsFromOneAtTheNearPlaneToZeroAtTheFarOne) {
  for (const float far_m : {10.0f, 100.0f, 33333.3f}) {
    EXPECT_EQ(view_depth(0.05f, 0.05f, far_m), 1.0f);
    EXPECT_EQ(view_depth(0.0f, 0.05f, far_m), 1.0f);
    EXPECT_EQ(view_depth(far_m, 0.05f, far_m), 0.0f);
    EXPECT_EQ(view_depth(kMissDistance_m, 0.05f, far_m), 0.0f);
    float last = 1.0f;
    for (float z_m = 0.06f; z_m < far_m; z_m *= 1.01f) {
      const float depth = view_depth(z_m, 0.05f, far_m);
      EXPECT_LT(depth, last);
      last = depth;
    }
  }
}

TEST(ViewDepth, TheFarPlaneLiesBehindAllThatIsSeen) {
  const DepthRange house = depth_range_of({{-3.0, 0.0, -4.0}, {9.0, 6.0, 4.0}});
  EXPECT_GT(house.far_m, glm::length(glm::vec3(12.0f, 6.0f, 8.0f)));
  EXPECT_LT(house.near_m, 0.1f);
  EXPECT_GT(depth_range_of({{0.0, 0.0, 0.0}, {0.1, 0.1, 0.1}}).far_m, 5.0f);
}

TEST_F(FrameRendererTest, RefusesATargetItWasNotMadeFor) {
  FrameRenderer renderer(device, store, options(2));
  EXPECT_THROW(renderer.record(target_of(make_target(1))), std::logic_error);
  EXPECT_THROW(renderer.submit(), std::logic_error);
}

}  // namespace
}  // namespace probewalk
