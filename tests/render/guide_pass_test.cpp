// What locomotion shows over a picture, by the pixels that it changes.
#include "render/guide_pass.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "content/image/image.h"
#include "gpu_test.h"
#include "probe_room.h"
#include "render/frame_renderer.h"
#include "render/readback.h"
#include "render/view.h"
#include "shaders/shared/guides.h"
#include "shaders/shared/view_ray.h"

namespace probewalk {
namespace {

constexpr VkExtent2D kExtent{160, 120};
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;

class GuidePassTest : public test::GpuTest {
 protected:
  GuidePassTest() {
    store.upload(room.upload());
    settings.trace = default_dials(test::kRadianceScale);
  }

  std::unique_ptr<FrameRenderer> make_renderer(bool aov = false) {
    return std::make_unique<FrameRenderer>(
        device, store,
        FrameRendererOptions{.tracer = {.extent_px = kExtent, .views = 2, .aov = aov}, .target_format = kFormat});
  }
  FrameTarget target() const {
    return test::frame_target(image, kFormat, kExtent);
  }
  // Two eyes whose fields of view mirror each other.
  static std::vector<ViewConstants> eyes_at(glm::dvec3 head_m, double yaw_rad, double pitch_rad) {
    const glm::dquat turned =
        glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch_rad, glm::dvec3(1, 0, 0));
    const ViewFov left{-0.85f, 0.65f, 0.7f, -0.75f}, right{-0.65f, 0.85f, 0.7f, -0.75f};
    const glm::dvec3 half = turned * glm::dvec3(0.032, 0, 0);
    return {view_constants(head_m - half, turned, left, static_cast<int>(kExtent.width)),
            view_constants(head_m + half, turned, right, static_cast<int>(kExtent.width))};
  }
  std::vector<ImageRgb8> frame(FrameRenderer& renderer, const std::vector<ViewConstants>& views,
                               const Guides& guides) const {
    renderer.record(target(), guides);
    renderer.write(views, settings);
    renderer.submit();
    renderer.wait();
    return read_pictures(device, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kFormat, kExtent, 2);
  }
  // Frames until the guides show.
  std::vector<ImageRgb8> draw(FrameRenderer& renderer, const std::vector<ViewConstants>& views,
                              const Guides& guides) const {
    const auto plain = frame(renderer, views, {});
    for (int k = 0; k < 1000; ++k) {
      auto shown = frame(renderer, views, guides);
      if (shown[0].rgb != plain[0].rgb || shown[1].rgb != plain[1].rgb) return shown;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "the guides never show";
    return plain;
  }
  static void keep(const std::string& name, const ImageRgb8& picture) {
    write_png(std::string(PROBEWALK_TEST_OUTPUT_DIR) + "/guides-" + name + ".png", picture);
  }
  // Where a point of the world is seen.
  static glm::vec2 pixel_of(const ViewConstants& view, glm::dvec3 point_m) {
    const glm::vec3 p(point_m - (glm::dvec3(view.origin_hi_m) + glm::dvec3(view.origin_lo_m)));
    const glm::vec2 tangents =
        glm::vec2(glm::dot(p, glm::vec3(view.world_from_eye_x)), glm::dot(p, glm::vec3(view.world_from_eye_y))) /
        -glm::dot(p, glm::vec3(view.world_from_eye_z));
    const glm::vec4 t = view.tan_angles;
    return {(tangents.x - t.x) / (t.y - t.x) * static_cast<float>(kExtent.width),
            (tangents.y - t.z) / (t.w - t.z) * static_cast<float>(kExtent.height)};
  }
  static glm::ivec3 at(const ImageRgb8& picture, glm::vec2 place) {
    const int x = std::clamp(static_cast<int>(place.x), 0, picture.width_px - 1);
    const int y = std::clamp(static_cast<int>(place.y), 0, picture.height_px - 1);
    const std::uint8_t* rgb =
        &picture.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width_px) +
                          static_cast<std::size_t>(x))];
    return {rgb[0], rgb[1], rgb[2]};
  }
  static std::size_t differ(const ImageRgb8& a, const ImageRgb8& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.rgb.size(); i += 3) count += !std::equal(&a.rgb[i], &a.rgb[i] + 3, &b.rgb[i]);
    return count;
  }
  // A way in a low arc.
  static std::vector<glm::dvec3> thrown(glm::dvec3 from_m, glm::dvec3 to_m) {
    std::vector<glm::dvec3> way;
    for (int i = 0; i < kGuidePoints; ++i) {
      const double f = i / (kGuidePoints - 1.0);
      way.push_back(glm::mix(from_m, to_m, f) + glm::dvec3(0, 1.2 * f * (1 - f), 0));
    }
    return way;
  }

  const test::ProbeRoom room;
  ProbeStore store{device, room.grid, room.probe_count(), {.frame_slots = kFrameSlots}};
  const Image image{device,
                    {kFormat, kExtent, 2, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT}};
  FrameSettings settings;
};

TEST_F(GuidePassTest, TheMarkerShowsWhereOneLandsAndTheWayLeadsThere) {
  const auto renderer = make_renderer();
  const auto views = eyes_at({1.2, 1.6, 1.0}, 1.4, -0.4);
  const auto plain = frame(*renderer, views, {});
  const glm::dvec3 landing(-1.6, 0.0, 0.6);
  const auto way = thrown({1.3, 1.2, 0.6}, landing);
  const auto shown = draw(*renderer, views, {.aim = AimGuide{way, landing}});
  for (std::size_t eye = 0; eye < 2; ++eye) {
    keep(eye == 0 ? "landing-left" : "landing-right", shown[eye]);
    const glm::ivec3 middle = at(shown[eye], pixel_of(views[eye], landing));
    EXPECT_GT(middle.y, 2 * middle.x) << eye;
    EXPECT_GT(middle.y, 150) << eye;
    int green = 0;
    for (const int i : {8, 16, 24}) {
      const glm::ivec3 c = at(shown[eye], pixel_of(views[eye], way[static_cast<std::size_t>(i)]));
      green += c.y > c.x + 40 && c.y > c.z + 40;
    }
    EXPECT_EQ(green, 3) << eye;
    EXPECT_LT(differ(shown[eye], plain[eye]), kExtent.width * kExtent.height / 10) << "the rest is left alone";
  }
}

TEST_F(GuidePassTest, AWayThatLandsNowhereIsRed) {
  const auto renderer = make_renderer();
  const auto views = eyes_at({1.2, 1.6, 1.0}, 1.4, -0.2);
  const auto way = thrown({1.3, 1.2, 0.6}, {-1.6, 1.0, 0.6});
  const auto shown = draw(*renderer, views, {.aim = AimGuide{way, std::nullopt}});
  keep("nowhere", shown[0]);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    for (const std::size_t i : {std::size_t{16}, way.size() - 1}) {
      const glm::ivec3 c = at(shown[eye], pixel_of(views[eye], way[i]));
      EXPECT_GT(c.x, c.y + 60) << eye << " " << i;
    }
  }
}

TEST_F(GuidePassTest, WhatIsNearerHidesIt) {
  const auto renderer = make_renderer();
  const auto views = eyes_at({1.2, 1.6, 1.0}, 1.4, -0.4);
  const auto plain = frame(*renderer, views, {});
  const auto in_view = thrown({1.3, 1.2, 0.6}, {-1.6, 0.0, 0.6});
  draw(*renderer, views, {.aim = AimGuide{in_view, in_view.back()}});  // they are ready now
  // Behind the room's walls and below its floor.
  for (const glm::dvec3 behind : {glm::dvec3(-7.0, 0.0, 0.3), glm::dvec3(-1.6, -0.6, 0.6)}) {
    const auto shown = frame(*renderer, views, {.aim = AimGuide{thrown(behind, behind), behind}});
    EXPECT_EQ(differ(shown[0], plain[0]) + differ(shown[1], plain[1]), 0u) << behind.y;
  }
  // Part of it behind the wall: what is in front still shows.
  const auto partly =
      frame(*renderer, views, {.aim = AimGuide{thrown({1.3, 1.2, 0.6}, {-7.0, 0.0, 0.3}), std::nullopt}});
  EXPECT_GT(differ(partly[0], plain[0]), 20u);
}

TEST_F(GuidePassTest, HidesBehindWhatTheLookUpsPictureMet) {
  const auto renderer = make_renderer(true);
  const auto views = eyes_at({1.2, 1.6, 1.0}, 1.4, -0.4);
  const glm::dvec3 landing(-1.6, 0.0, 0.6), below = landing - glm::dvec3(0, 0.6, 0);
  renderer->show_lookups(true);
  const auto picture = frame(*renderer, views, {});
  auto lookups = picture;
  for (int k = 0; k < 1000 && lookups[0].rgb == picture[0].rgb; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    lookups = frame(*renderer, views, {});
  }
  ASSERT_NE(lookups[0].rgb, picture[0].rgb);
  const auto shown = draw(*renderer, views, {.aim = AimGuide{thrown(landing, landing), landing}});
  EXPECT_GT(differ(shown[0], lookups[0]), 20u);
  const auto hidden = frame(*renderer, views, {.aim = AimGuide{thrown(below, below), below}});
  EXPECT_EQ(differ(hidden[0], lookups[0]), 0u);
}

// For those who watch: a view of its own beside the frame's, with guides of its own.
TEST_F(GuidePassTest, AViewBesideTheFrameShowsThemToo) {
  const auto renderer = make_renderer();
  const auto views = eyes_at({1.2, 1.6, 1.0}, 1.4, -0.4);
  TracerOptions tracer;
  tracer.extent_px = kExtent;
  tracer.views = 1;
  SideView side(device, tracer, kFormat);
  const auto beside = [&](const Guides& guides) {
    const auto wearer = frame(*renderer, views, {});
    EXPECT_TRUE(renderer->submit_beside(side, views[1], settings, guides));
    renderer->wait();
    const FrameTarget& target = side.target();
    auto seen = read_pictures(device, target.image, target.final_layout, kFormat, kExtent, 1);
    seen.push_back(wearer[1]);
    return seen;
  };
  const auto plain = beside({});
  EXPECT_EQ(plain[0].rgb, plain[1].rgb) << "the same view of the same probes";
  const glm::dvec3 landing(-1.6, 0.0, 0.6);
  const auto way = thrown({1.3, 1.2, 0.6}, landing);
  auto shown = plain;
  for (int k = 0; k < 1000 && shown[0].rgb == plain[0].rgb; ++k) {
    shown = beside({.aim = AimGuide{way, landing}});
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  keep("beside", shown[0]);
  const glm::ivec3 middle = at(shown[0], pixel_of(views[1], landing));
  EXPECT_GT(middle.y, 2 * middle.x);
  EXPECT_GT(middle.y, 150);
  EXPECT_EQ(shown[1].rgb, plain[1].rgb) << "the frame itself has none";
  EXPECT_EQ(beside({})[0].rgb, plain[0].rgb);
  // As the wearer's own, to the bit.
  EXPECT_EQ(draw(*renderer, views, {.aim = AimGuide{way, landing}})[1].rgb, shown[0].rgb);
}

TEST_F(GuidePassTest, WithoutAnyThePictureIsTheSameToTheBitAndNothingIsKept) {
  const auto views = eyes_at({1.2, 1.6, 1.0}, 1.4, -0.4);
  const auto renderer = make_renderer();
  const auto plain = frame(*renderer, views, {});
  frame(*renderer, views, {});
  const std::uint32_t pipelines = device.pipelines_built();
  const glm::dvec3 landing(-1.6, 0.0, 0.6);
  const auto way = thrown(landing, landing);
  const Guides guides{.aim = AimGuide{way, landing}, .vignette = VignetteShape{0.3, 0.5}};
  draw(*renderer, views, guides);
  EXPECT_EQ(device.pipelines_built(), pipelines + 1);
  const auto again = frame(*renderer, views, {});
  for (std::size_t eye = 0; eye < 2; ++eye) EXPECT_EQ(again[eye].rgb, plain[eye].rgb);
  draw(*renderer, views, guides);
  EXPECT_EQ(device.pipelines_built(), pipelines + 1) << "it is kept from one aim to the next";
  FrameTarget small = target();
  small.extent = {16, 12};
  for (std::uint64_t k = 0; k <= kGuideRest_frames; ++k) {
    renderer->record(small);
    renderer->write(views, settings);
    renderer->submit();
  }
  draw(*renderer, views, guides);
  EXPECT_EQ(device.pipelines_built(), pipelines + 2) << "it was given up meanwhile";
}

TEST_F(GuidePassTest, TheVignetteDarkensByTheAngleFromEachEyesOwnAxis) {
  const auto views = eyes_at({1.2, 1.6, 1.0}, 1.4, -0.4);
  const auto renderer = make_renderer();
  const auto plain = frame(*renderer, views, {});
  const VignetteShape shape{0.35, 0.6};
  const auto shown = draw(*renderer, views, {.aim = {}, .vignette = shape});
  for (std::size_t eye = 0; eye < 2; ++eye) {
    keep(eye == 0 ? "vignette-left" : "vignette-right", shown[eye]);
    std::size_t clear = 0, between = 0, black = 0;
    for (int y = 0; y < static_cast<int>(kExtent.height); ++y) {
      for (int x = 0; x < static_cast<int>(kExtent.width); ++x) {
        const glm::vec2 middle(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const glm::dvec3 ray(view_ray(views[eye], {x, y}, {kExtent.width, kExtent.height}));
        const double angle = std::acos(-glm::dot(ray, glm::dvec3(views[eye].world_from_eye_z)));
        const glm::ivec3 was = at(plain[eye], middle), is = at(shown[eye], middle);
        if (angle < shape.clear_rad - 0.01) {
          ASSERT_EQ(is, was);
          ++clear;
        } else if (angle > shape.black_rad + 0.01) {
          ASSERT_EQ(is, glm::ivec3(0));
          ++black;
        } else {
          ASSERT_LE(is.y, was.y + 1);
          ++between;
        }
      }
    }
    EXPECT_GT(clear, 1000u);
    EXPECT_GT(between, 1000u);
    EXPECT_GT(black, 1000u);
  }
}

TEST_F(GuidePassTest, TheTwoEyesAreDarkenedAlike) {
  // White everywhere: what is left is the vignette alone.
  settings.exposure = 1e6f;
  const auto views = eyes_at({1.2, 1.6, 1.0}, 1.4, -0.4);
  const auto renderer = make_renderer();
  const auto shown = draw(*renderer, views, {.aim = {}, .vignette = VignetteShape{0.3, 0.7}});
  const int width = static_cast<int>(kExtent.width);
  int most = 0;
  for (int y = 0; y < static_cast<int>(kExtent.height); ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::vec2 left(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const glm::vec2 right(static_cast<float>(width - 1 - x) + 0.5f, left.y);
      most = std::max(most, std::abs(at(shown[0], left).y - at(shown[1], right).y));
    }
  }
  EXPECT_LE(most, 1);
}

TEST_F(GuidePassTest, ABlinkDarkensTheMarkerWithThePicture) {
  const auto views = eyes_at({1.2, 1.6, 1.0}, 1.4, -0.4);
  const auto renderer = make_renderer();
  const glm::dvec3 landing(-1.6, 0.0, 0.6);
  const auto way = thrown(landing, landing);
  const Guides guides{.aim = AimGuide{way, landing}, .vignette = {}};
  draw(*renderer, views, guides);
  settings.fade = 1.0f;
  for (const ImageRgb8& picture : frame(*renderer, views, guides)) {
    for (const std::uint8_t value : picture.rgb) ASSERT_EQ(value, 0);
  }
}

}  // namespace
}  // namespace probewalk
