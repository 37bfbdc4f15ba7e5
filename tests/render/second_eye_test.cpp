#include "render/second_eye.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gpu_test.h"
#include "probe_room.h"
#include "render/frame_renderer.h"
#include "render/readback.h"
#include "render/view.h"

namespace probewalk {
namespace {

constexpr VkExtent2D kExtent{150, 100};  // no multiple of a tile
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;

struct Drawn {
  std::vector<ImageRgb8> shown;
  std::vector<std::vector<float>> distance_m;
  std::vector<std::vector<glm::uvec4>> counts;
};

// Of a view's pixels, against the same view traced by itself.
struct Against {
  std::size_t pixels = 0, not_walked = 0, classes = 0, farther_off = 0;
  std::size_t walks = 0, plain_walks = 0;  // through probes
};

class SecondEyeTest : public test::GpuTest {
 protected:
  SecondEyeTest() { store.upload(room.upload()); }

  // Left and right eye, 63 mm apart, of a head that looks along -z turned by yaw and pitch.
  static std::vector<ViewConstants> eyes(glm::dvec3 head_m, double yaw_rad, double pitch_rad = 0.0,
                                         double apart_m = 0.063, const ViewFov& fov = {-0.8f, 0.7f, 0.6f, -0.65f}) {
    const glm::dquat turned =
        glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch_rad, glm::dvec3(1, 0, 0));
    std::vector<ViewConstants> both;
    for (const double side : {-0.5, 0.5}) {
      // The other eye sees as much further out as this one.
      const ViewFov own = side < 0 ? fov : ViewFov{-fov.right_rad, -fov.left_rad, fov.up_rad, fov.down_rad};
      both.push_back(view_constants(head_m + turned * glm::dvec3(apart_m * side, 0, 0), turned, own,
                                    static_cast<int>(kExtent.width)));
    }
    return both;
  }

  Drawn draw(const std::vector<ViewConstants>& views, const TracerOptions& tracing, ProbeStore& probes,
             VkExtent2D extent = kExtent, const std::vector<HiddenMesh>& hidden = {}) {
    TracerOptions tracer = tracing;
    tracer.extent_px = kExtent;
    tracer.views = static_cast<std::uint32_t>(views.size());
    tracer.aov = true;
    FrameRenderer renderer(device, probes, {.tracer = tracer, .target_format = kFormat});
    if (!hidden.empty()) renderer.hide(hidden);
    const Image image(device, {kFormat, extent, tracer.views,
                               VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    FrameTarget target;
    target.image = image.handle();
    target.format = kFormat;
    target.extent = extent;
    target.layers = tracer.views;
    target.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    FrameSettings settings;
    settings.trace = default_dials(test::kRadianceScale);
    for (int frame = 0; frame < 2; ++frame) {  // the second finds the first one's lists
      renderer.record(target);
      renderer.write(views, settings);
      renderer.submit();
      renderer.wait();
    }
    return {read_pictures(device, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kFormat, extent, tracer.views),
            read_floats(device, renderer.tracer().distance()), read_uints(device, renderer.tracer().aov())};
  }
  Drawn draw(const std::vector<ViewConstants>& views, bool second_from_first) {
    return draw(views, {.second_from_first = second_from_first}, store);
  }

  static Against compare(const Drawn& drawn, const Drawn& plain, std::size_t view, VkExtent2D extent = kExtent) {
    Against a;
    add(a, drawn, plain, view, extent);
    return a;
  }
  static void add(Against& a, const Drawn& drawn, const Drawn& plain, std::size_t view, VkExtent2D extent = kExtent) {
    for (std::uint32_t y = 0; y < extent.height; ++y) {
      for (std::uint32_t x = 0; x < extent.width; ++x) {
        const std::size_t k = std::size_t{y} * kExtent.width + x;
        const glm::uvec4 own = drawn.counts[view][k], other = plain.counts[view][k];
        ++a.pixels;
        a.not_walked += (own.w & 255u) == 0;
        a.classes += own.x != other.x;
        const float t = drawn.distance_m[view][k], t_plain = plain.distance_m[view][k];
        // Of a hole the distance is how far nothing is known to be met: no more than a guess.
        a.farther_off += own.x == other.x && own.x != unsigned(kClassUnknown) && std::abs(t - t_plain) > 1e-3f * t_plain;
        a.walks += own.w & 255u;
        a.plain_walks += other.w & 255u;
      }
    }
  }

  const test::ProbeRoom room{128, 32};
  ProbeStore store{device, room.grid, room.probe_count(), {.frame_slots = kFrameSlots}};
};

TEST_F(SecondEyeTest, MeetsWhatTracingMeetsAndWalksLess) {
  Against all;
  for (const auto& [head_m, yaw_rad, pitch_rad] :
       {std::tuple(glm::dvec3(0.3, 1.5, 0.9), 0.4, -0.2), std::tuple(glm::dvec3(-1.2, 1.6, 1.8), -2.6, 0.1),
        std::tuple(glm::dvec3(1.4, 1.3, -0.4), 1.9, -0.4), std::tuple(glm::dvec3(-0.2, 1.7, 0.3), 0.0, -1.2)}) {
    const auto views = eyes(head_m, yaw_rad, pitch_rad);
    const Drawn drawn = draw(views, true), plain = draw(views, false);
    EXPECT_EQ(drawn.distance_m[0], plain.distance_m[0]) << "the first eye traces as ever";
    EXPECT_EQ(drawn.counts[0], plain.counts[0]);
    EXPECT_EQ(drawn.shown[0].rgb, plain.shown[0].rgb);
    add(all, drawn, plain, 1);
  }
  const auto share = [&](std::size_t n) { return double(n) / double(all.pixels); };
  EXPECT_GT(share(all.not_walked), 0.5);
  EXPECT_LT(share(all.classes), 0.004);
  EXPECT_LT(share(all.farther_off), 0.003);
  EXPECT_LT(all.walks, all.plain_walks / 2);
}

TEST_F(SecondEyeTest, FourViewsAreTwoPairs) {
  std::vector<ViewConstants> views = eyes({0.3, 1.5, 0.9}, 0.4);
  for (const ViewConstants& inset : eyes({0.3, 1.5, 0.9}, 0.4, 0.0, 0.063, {-0.3f, 0.25f, 0.3f, -0.3f})) {
    views.push_back(inset);
  }
  const Drawn drawn = draw(views, true), plain = draw(views, false);
  for (const std::size_t first : {0u, 2u}) {
    EXPECT_EQ(drawn.counts[first], plain.counts[first]);
    const Against second = compare(drawn, plain, first + 1);
    // Of the inset's narrow picture more lies where only its own eye can see.
    EXPECT_GT(second.not_walked, second.pixels / (first == 0 ? 2 : 6)) << "pair " << first / 2;
    EXPECT_LT(second.classes, second.pixels / 100);
    EXPECT_LT(second.farther_off, second.pixels / 50);
  }
}

// Eyes that do not look the same way, or not from side by side, each see for themselves, to the bit.
TEST_F(SecondEyeTest, EyesThatAreNotSideBySideTraceEachByItself) {
  const auto straight = eyes({0.3, 1.5, 0.9}, 0.4);
  const auto swapped = std::vector{straight[1], straight[0]};
  const auto canted = std::vector{straight[0], eyes({0.3, 1.5, 0.9}, 0.35)[1]};
  const auto one_place = std::vector{straight[0], straight[0]};
  auto stepped = straight;
  stepped[1] = eyes({0.3, 1.52, 0.9}, 0.4)[1];
  auto taller = straight;
  taller[1] = eyes({0.3, 1.5, 0.9}, 0.4, 0.0, 0.063, {-0.8f, 0.7f, 0.7f, -0.65f})[1];
  for (const auto& views : {swapped, canted, one_place, stepped, taller}) {
    const Drawn drawn = draw(views, true), plain = draw(views, false);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      EXPECT_EQ(drawn.distance_m[eye], plain.distance_m[eye]);
      EXPECT_EQ(drawn.counts[eye], plain.counts[eye]);
      EXPECT_EQ(drawn.shown[eye].rgb, plain.shown[eye].rgb);
    }
  }
}

// Runtimes tell each eye's pose with rounding of its own.
TEST_F(SecondEyeTest, EyesThatDifferByRoundingAreSideBySide) {
  auto views = eyes({0.3, 1.5, 0.9}, 0.4);
  views[1] = eyes({0.3, 1.5 + 1e-6, 0.9}, 0.4 + 2e-6, 1e-6)[1];
  ASSERT_NE(views[0].world_from_eye_x, views[1].world_from_eye_x);
  const Drawn drawn = draw(views, true), plain = draw(views, false);
  const Against second = compare(drawn, plain, 1);
  EXPECT_GT(second.not_walked, second.pixels / 2);
  EXPECT_LT(second.farther_off, second.pixels / 100);
}

TEST_F(SecondEyeTest, OddViewsFoveationAndBaselinesAreTracedAsEver) {
  const auto views = eyes({0.3, 1.5, 0.9}, 0.4);
  TracerOptions odd{.extent_px = kExtent, .views = 1, .second_from_first = true};
  EXPECT_FALSE(StereoTracer(device, odd).options().second_from_first);
  const TracerOptions foveated{.foveation = Foveation{0.2f, 0.4f}, .second_from_first = true};
  TracerOptions plain = foveated;
  plain.second_from_first = false;
  const Drawn drawn = draw(views, foveated, store), other = draw(views, plain, store);
  EXPECT_EQ(drawn.counts, other.counts);
  EXPECT_EQ(drawn.shown[1].rgb, other.shown[1].rgb);
  TracerChoice environment;
  environment.method = kMethodEnvironment;
  EXPECT_FALSE(SecondEye::suits(kExtent, 2, false, environment));
  EXPECT_TRUE(SecondEye::suits(kExtent, 4, false, {}));
  EXPECT_FALSE(SecondEye::suits({8000, 100}, 2, false, {})) << "wider than a group looks through";
}

// A smaller picture than the tracer was made for (eyes whose resolution adapts) keeps its rows apart.
TEST_F(SecondEyeTest, SmallerPicturesAreLookedThroughAsTheyAre) {
  constexpr VkExtent2D kSmall{101, 67};
  const auto views = eyes({0.3, 1.5, 0.9}, 0.4);
  const Drawn drawn = draw(views, {.second_from_first = true}, store, kSmall), plain = draw(views, {}, store, kSmall);
  const Against second = compare(drawn, plain, 1, kSmall);
  EXPECT_GT(second.not_walked, second.pixels / 2);
  EXPECT_LT(second.classes, second.pixels / 100);
  EXPECT_LT(second.farther_off, second.pixels / 50);
}

TEST_F(SecondEyeTest, MoreRaysAtEdgesGoOnTopOfIt) {
  const auto views = eyes({0.3, 1.5, 0.9}, 0.4);
  const TracerOptions four{.samples = 4, .second_from_first = true};
  TracerOptions plain_four = four;
  plain_four.second_from_first = false;
  const Drawn drawn = draw(views, four, store), plain = draw(views, plain_four, store);
  std::size_t several = 0, differ = 0;
  for (std::size_t k = 0; k < drawn.counts[1].size(); ++k) {
    several += (drawn.counts[1][k].w >> 8 & 255u) == 4;
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      most = std::max(most, std::abs(int(drawn.shown[1].rgb[3 * k + c]) - int(plain.shown[1].rgb[3 * k + c])));
    }
    differ += most > 8;
  }
  EXPECT_GT(several, 300u);
  EXPECT_LT(differ, drawn.counts[1].size() / 100);
}

// Where the first eye has no ray since its lens hides the place, nobody goes by it.
TEST_F(SecondEyeTest, GoesByNoPixelThatTheFirstEyesLensHides) {
  const auto views = eyes({0.3, 1.5, 0.9}, 0.4);
  // The right half of the first eye's picture is hidden, nothing of the second one's.
  const HiddenMesh right_half{{{0, -2}, {2, -2}, {2, 2}, {0, 2}}, {0, 1, 2, 0, 2, 3}};
  const HiddenMesh corner{{{1.9f, 1.9f}, {2, 1.9f}, {2, 2}}, {0, 1, 2}};
  const Drawn drawn = draw(views, {.masked = true, .second_from_first = true}, store, kExtent, {right_half, corner});
  const Drawn plain = draw(views, {}, store);
  const Against second = compare(drawn, plain, 1);
  EXPECT_LT(second.classes, second.pixels / 100);
  EXPECT_LT(second.farther_off, second.pixels / 50);
  EXPECT_GT(second.not_walked, 100u) << "the other half is gone by";
  EXPECT_LT(second.not_walked, second.pixels / 2);
}

// A box at the second eye's temple, outside the first eye's picture: the margin finds it, and the rays that might meet
// it are traced.
class ClosePost : public SecondEyeTest {
 protected:
  static Scene scene() {
    test::SceneBuilder b;
    b.box({-3, 0, -2.5f}, {3, 2.6f, 2.5f}, true);
    b.box({0.50f, 0.9f, 0.43f}, {0.60f, 1.9f, 0.48f});
    return b.build();
  }
  const test::ProbeRoom with_post{256, 32, {DeviceSamples::kFloat}, scene()};
};

TEST_F(ClosePost, IsSeenThoughTheFirstEyeHasNotGotIt) {
  ProbeStore posts(device, with_post.grid, with_post.probe_count(), {.frame_slots = kFrameSlots});
  posts.upload(with_post.upload());
  const auto views = eyes({0.345, 1.5, 0.62}, 0.0, 0.0, 0.063, {-0.75f, 0.75f, 0.6f, -0.6f});
  const Drawn drawn = draw(views, {.second_from_first = true}, posts), plain = draw(views, {}, posts);
  std::size_t close_to_first = 0, close_to_second = 0, still_close = 0;
  for (std::size_t k = 0; k < plain.distance_m[0].size(); ++k) {
    close_to_first += plain.distance_m[0][k] < 0.5f;
    close_to_second += plain.distance_m[1][k] < 0.5f;
    still_close += plain.distance_m[1][k] < 0.5f && drawn.distance_m[1][k] < 0.5f;
  }
  EXPECT_EQ(close_to_first, 0u) << "the scene tests nothing";
  EXPECT_GT(close_to_second, 500u) << "the scene tests nothing";
  EXPECT_EQ(still_close, close_to_second);
}

// The tiles of the margin have no bits in the mask: what the mask says of the picture's left edge is nothing to them.
TEST_F(ClosePost, IsSeenWhereTheFirstEyesLensHidesItsLeftEdge) {
  ProbeStore posts(device, with_post.grid, with_post.probe_count(), {.frame_slots = kFrameSlots});
  posts.upload(with_post.upload());
  const ViewFov fov{-0.75f, 0.75f, 0.6f, -0.6f};
  const auto before = eyes({-1.0, 1.5, 0.62}, 0.0, 0.0, 0.063, fov), beside = eyes({0.345, 1.5, 0.62}, 0.0, 0.0, 0.063, fov);
  const HiddenMesh left_half{{{-2, -2}, {0, -2}, {0, 2}, {-2, 2}}, {0, 1, 2, 0, 2, 3}};
  const HiddenMesh corner{{{1.9f, 1.9f}, {2, 1.9f}, {2, 2}}, {0, 1, 2}};
  FrameRenderer renderer(device, posts,
                         {.tracer = {.extent_px = kExtent, .views = 2, .aov = true, .masked = true, .second_from_first = true},
                          .target_format = kFormat});
  const Image image(device, {kFormat, kExtent, 2, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
  const auto frame = [&](const std::vector<ViewConstants>& views, const HiddenMesh& of_first) {
    renderer.hide({of_first, corner});
    FrameSettings settings;
    settings.trace = default_dials(test::kRadianceScale);
    const FrameTarget target = test::frame_target(image, kFormat, kExtent);
    renderer.record(target);
    renderer.write(views, settings);
    renderer.submit();
    renderer.wait();
  };
  frame(before, corner);
  frame(beside, left_half);
  const auto drawn = read_floats(device, renderer.tracer().distance())[1];
  const auto plain = draw(beside, {}, posts).distance_m[1];
  std::size_t close = 0, still_close = 0;
  for (std::size_t k = 0; k < plain.size(); ++k) {
    close += plain[k] < 0.5f;
    still_close += plain[k] < 0.5f && drawn[k] < 0.5f;
  }
  EXPECT_EQ(still_close, close);
}

}  // namespace
}  // namespace probewalk
