// The overlay: what its board takes from the ledger, and what it leaves on the device shown and hidden.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "content/image/image.h"
#include "render/image.h"
#include "render/one_shot.h"
#include "render/readback.h"
#include "xr/overlay/overlay_board.h"
#include "xr/overlay/overlay_painter.h"

namespace probewalk {
namespace {

constexpr std::int64_t kPeriod_ns = 10'000'000;

// Frame k begins at k periods, `late` frames skip one refresh before them.
Ledger ledger_of(std::size_t frames, std::size_t late_every, std::uint64_t warmup = 0) {
  Ledger ledger({.warmup_frames = warmup, .has_deadlines = true});
  std::int64_t at_ns = 1'000'000'000;
  for (std::size_t k = 0; k < frames; ++k) {
    FrameRecord frame;
    frame.frame_id = k;
    if (late_every != 0 && k % late_every == late_every - 1) at_ns += kPeriod_ns;
    frame.wait = {at_ns - 1000, at_ns};
    frame.end = {at_ns + 3'900'000, at_ns + 4'000'000};
    frame.gpu = {at_ns + 1'000'000, at_ns + 7'000'000};
    frame.locate_late = {at_ns + 10, at_ns + 20};
    frame.predicted_display = at_ns + 2 * kPeriod_ns;
    frame.period = kPeriod_ns;
    ledger.add(frame);
    at_ns += kPeriod_ns;
  }
  return ledger;
}

TEST(OverlayBoard, KeepsNothingWhileHidden) {
  OverlayBoard board;
  board.note(ledger_of(100, 0), {});
  EXPECT_TRUE(board.facts().frames.empty());
  board.show(true);
  board.note(ledger_of(100, 0), {});
  EXPECT_EQ(board.facts().frames.size(), 100u);
  board.show(false);
  EXPECT_TRUE(board.facts().frames.empty());
  EXPECT_EQ(board.facts().frames_counted, 0u);
}

TEST(OverlayBoard, ShowsTheLastFramesOldestFirstAndCountsAllOfThem) {
  OverlayBoard board;
  board.show(true);
  const Ledger ledger = ledger_of(301, 10, 1);
  board.note(ledger, {});
  const OverlayFacts facts = board.facts();
  ASSERT_EQ(facts.frames.size(), OverlayBoard::kFrames);
  EXPECT_EQ(facts.frames_counted, 300u);
  EXPECT_EQ(facts.missed, 30u);
  EXPECT_EQ(facts.missed, ledger.summary().missed);
  EXPECT_DOUBLE_EQ(facts.budget_ms, 10.0);
  // The newest frame is the last: frame 300 is on time, frame 299 came a refresh late.
  EXPECT_NEAR(facts.frames.back().frame_ms, 10.0, 1e-3);
  EXPECT_NEAR(facts.frames[OverlayBoard::kFrames - 2].frame_ms, 20.0, 1e-3);
  EXPECT_EQ(facts.frames[OverlayBoard::kFrames - 2].missed, 1u);
  EXPECT_NEAR(facts.frames.back().gpu_busy_ms, 6.0, 1e-3);
}

TEST(OverlayBoard, PercentilesAreThoseOfTheReport) {
  OverlayBoard board;
  board.show(true);
  const Ledger ledger = ledger_of(400, 7, 30);
  board.note(ledger, {});
  const OverlayFacts facts = board.facts();
  const Summary summary = ledger.summary();
  const std::pair<const char*, const char*> rows[] = {
      {"frame", "frame"}, {"cpu busy", "cpu_busy"}, {"gpu busy", "gpu_busy"}, {"horizon", "prediction_horizon"}};
  ASSERT_EQ(facts.rows.size(), std::size(rows));
  for (std::size_t i = 0; i < std::size(rows); ++i) {
    const Histogram& told = summary.quantity(rows[i].second).histogram;
    EXPECT_STREQ(facts.rows[i].name, rows[i].first);
    EXPECT_EQ(facts.rows[i].n, told.count()) << rows[i].first;
    EXPECT_NEAR(facts.rows[i].p99_ms.value(), static_cast<double>(told.percentile(0.99).value()) * 1e-6, 1e-9);
  }
}

TEST(OverlayBoard, CatchesUpWithALongWalkALittleAFrame) {
  OverlayBoard board;
  board.show(true);
  const Ledger ledger = ledger_of(2 * OverlayBoard::kFramesAtOnce + 5, 0);
  board.note(ledger, {});
  EXPECT_EQ(board.facts().frames_counted, OverlayBoard::kFramesAtOnce);
  board.note(ledger, {});
  board.note(ledger, {});
  EXPECT_EQ(board.facts().frames_counted, ledger.frames().size());
}

// WalkOverlay: needs a device, see tests/CMakeLists.txt.
class WalkOverlay : public testing::Test {
 protected:
  static constexpr VkExtent2D kScreen{480, 360};
  static constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;

  void TearDown() override { EXPECT_EQ(device.validation_messages(), 0u); }

  // As a window does it: whether something was painted over the black picture.
  bool show_picture(OverlayPainter& painter) {
    const bool ready = painter.prepare(kFormat);
    if (!ready) return false;
    const VkImageView view = make_layer_view(device, screen.handle(), kFormat, 0);
    run_commands(device, [&](VkCommandBuffer commands) {
      transition(commands, screen.handle(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
      const VkClearColorValue black{};
      const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
      vkCmdClearColorImage(commands, screen.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &black, 1, &all);
      transition(commands, screen.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                 VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
      painter.paint(commands, 0, view, kScreen);
      transition(commands, screen.handle(), VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                 VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    });
    vkDestroyImageView(device.handle(), view, nullptr);
    return true;
  }
  bool show_until_painted(OverlayPainter& painter) {
    for (int k = 0; k < 3000; ++k) {
      if (show_picture(painter)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  const Device device{DeviceHooks{}, DeviceOptions{.device = "", .validation = true}};
  const Image screen{
      device,
      {kFormat, kScreen, 1,
       VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT}};
};

TEST_F(WalkOverlay, HiddenItHoldsNothingOnTheDevice) {
  const std::uint64_t bytes = device.allocated_bytes();
  const std::uint32_t pipelines = device.pipelines_built();
  OverlayBoard board;
  OverlayPainter without(device, nullptr, 1), hidden(device, &board, 1);
  for (int k = 0; k < 5; ++k) {
    EXPECT_FALSE(show_picture(without));
    EXPECT_FALSE(show_picture(hidden));
  }
  EXPECT_FALSE(hidden.is_held());
  EXPECT_EQ(device.pipelines_built(), pipelines);
  EXPECT_EQ(device.allocated_bytes(), bytes);

  board.show(true);
  ASSERT_TRUE(show_until_painted(hidden));
  EXPECT_EQ(device.pipelines_built(), pipelines + 1);
  EXPECT_TRUE(hidden.is_held());
  board.show(false);
  for (int k = 0; k < 3; ++k) EXPECT_FALSE(show_picture(hidden));
  EXPECT_FALSE(hidden.is_held());
  EXPECT_EQ(device.pipelines_built(), pipelines + 1);
}

TEST_F(WalkOverlay, PaintsAPanelInACornerAndLeavesTheRestAlone) {
  OverlayBoard board;
  board.show(true);
  OverlayStatus status;
  status.display = "window";
  status.method = "oat";
  status.room = "hall";
  status.level_shown = 0;
  status.level_wanted = 2;
  status.budget_bytes = 64 << 20;
  status.device_bytes = 21 << 20;
  status.troubled_levels = 2;
  status.last_error = "http://127.0.0.1:8080/house.probes: the server does not answer";
  status.credits = "A house, by somebody, CC-BY 4.0";
  board.note(ledger_of(200, 9), status);
  OverlayPainter painter(device, &board, 1);
  ASSERT_TRUE(show_until_painted(painter));
  const std::vector<ImageRgb8> layers =
      read_pictures(device, screen.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kFormat, kScreen, 1);
  const ImageRgb8& picture = layers.at(0);
  write_png(std::string(PROBEWALK_TEST_OUTPUT_DIR) + "/overlay.png", picture);
  const auto brightest = [&](int left, int top, int right, int bottom) {
    int most = 0;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        for (int c = 0; c < 3; ++c) {
          most =
              std::max(most, int(picture.rgb[(std::size_t(y) * kScreen.width + std::size_t(x)) * 3 + std::size_t(c)]));
        }
      }
    }
    return most;
  };
  EXPECT_GT(brightest(8, 8, 400, 40), 200) << "no letters";
  EXPECT_GT(brightest(8, 60, 400, 120), 150) << "no graph";
  EXPECT_EQ(brightest(420, 0, 480, 360), 0) << "beyond the panel";
}

TEST_F(WalkOverlay, DrawsOnScreensOfAnySize) {
  OverlayBoard board;
  board.show(true);
  board.note(ledger_of(50, 0), {});
  OverlayPanel panel;
  for (const VkExtent2D size : {VkExtent2D{1, 1}, VkExtent2D{64, 48}, VkExtent2D{4000, 3000}}) {
    const OverlayPicture picture = panel.draw(board.facts(), size);
    for (const OverlayPicture::Part& part : picture.parts) {
      EXPECT_GE(part.clip.offset.x, 0);
      EXPECT_GE(part.clip.offset.y, 0);
      EXPECT_LE(std::uint32_t(part.clip.offset.x) + part.clip.extent.width, size.width);
      EXPECT_LE(std::uint32_t(part.clip.offset.y) + part.clip.extent.height, size.height);
      EXPECT_LE(std::size_t(part.first_index) + part.indices, picture.indices.size());
    }
    for (const std::uint32_t index : picture.indices) EXPECT_LT(index, picture.vertices.size());
  }
}

}  // namespace
}  // namespace probewalk
