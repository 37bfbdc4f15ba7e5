// What lenses hide is not drawn, and what they hide may change on the way: a layer in front of Monado
// (tests/openxr_layer) has lenses that hide halves of the views, which the saved pictures show. Skipped, with the
// reason, where Monado is not installed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "content/image/image.h"
#include "tools/scripted_walk.h"

namespace probewalk::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// Tiles that the edge of a mask crosses, and the margin around what is seen, are drawn: so far from it nothing is.
constexpr int kAroundEdge_px = 16;

// Which half of the picture is black: left, right, up, down, none or all. Empty = something else, "half a half".
std::string black_half(const std::filesystem::path& file) {
  const ImageRgb8 picture = read_png(file);
  const int width = picture.width_px, height = picture.height_px;
  const auto is_black = [&](int from_x, int from_y, int to_x, int to_y) {
    int black = 0, all = 0;
    for (int y = std::max(from_y, 0); y < std::min(to_y, height); ++y) {
      for (int x = std::max(from_x, 0); x < std::min(to_x, width); ++x, ++all) {
        const std::uint8_t* c = &picture.rgb[3 * static_cast<std::size_t>(y * width + x)];
        black += c[0] + c[1] + c[2] == 0;
      }
    }
    EXPECT_GT(all, 0);
    return black == all ? 1 : black == 0 ? 0 : -1;
  };
  const int middle_x = width / 2, middle_y = height / 2;
  const int left = is_black(0, 0, middle_x - kAroundEdge_px, height);
  const int right = is_black(middle_x + kAroundEdge_px, 0, width, height);
  const int up = is_black(0, 0, width, middle_y - kAroundEdge_px);
  const int down = is_black(0, middle_y + kAroundEdge_px, width, height);
  if (left == 1 && right == 1) return "all";
  if (left == 0 && right == 0 && up == 0 && down == 0) return "none";
  if (left == 1 && right == 0) return "left";
  if (right == 1 && left == 0) return "right";
  if (up == 1 && down == 0) return "up";
  if (down == 1 && up == 0) return "down";
  return "";
}

// What is black in the eyes' pictures: "left/down" in words of black_half; empty where there is no picture.
std::string black_in(const ScriptedWalk& walk, int frame) {
  const auto file = [&](const char* eye) {
    return walk.folder / "pictures" / fmt::format("frame-{:06}-{}.png", frame, eye);
  };
  if (!std::filesystem::exists(file("left"))) return "";
  return black_half(file("left")) + "/" + black_half(file("right"));
}

const std::string kSaved = " --settle --save-frames pictures";

TEST(OpenXrMasks, HideTilesOfEachViewAndAreMadeAnewOnTheEvent) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const ScriptedWalk walk =
      walk_by_script("openxr-masks", "masks=1:left:down,15:up:none,25:none:right,30:none:none", "--frames 40" + kSaved);
  ASSERT_EQ(walk.walk.run.exit_code, 0) << walk.walk.run.err;
  // The event of frame N, counted from 1, is taken before the next one, whose picture has the number N.
  int seen[4] = {0, 0, 0, 0};
  for (int frame = 0; frame < 40; ++frame) {
    const std::string black = black_in(walk, frame);
    if (black.empty()) continue;
    const int part = frame < 15 ? 0 : frame < 25 ? 1 : frame < 30 ? 2 : 3;
    const char* const expected[4] = {"left/down", "up/none", "none/right", "none/none"};
    EXPECT_EQ(black, expected[part]) << "frame " << frame;
    ++seen[part];
  }
  for (const int pictures : seen) EXPECT_GE(pictures, 4);
}

TEST(OpenXrMasks, FitEyesThatAreDrawnSmaller) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const ScriptedWalk walk =
      walk_by_script("openxr-masks-smaller", "masks=1:right:up", "--frames 12 --eye-scale 0.75" + kSaved);
  ASSERT_EQ(walk.walk.run.exit_code, 0) << walk.walk.run.err;
  EXPECT_EQ(black_in(walk, 11), "right/up");
  EXPECT_EQ(read_png(walk.folder / "pictures" / "frame-000011-left.png").width_px, 48);
}

TEST(OpenXrMasks, ThatGrowWhileTheyAreReadAreReadAgain) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const ScriptedWalk walk =
      walk_by_script("openxr-masks-grown", "masks=1:left:left;masks_grow=1", "--frames 20" + kSaved);
  ASSERT_EQ(walk.walk.run.exit_code, 0) << walk.walk.run.err;
  EXPECT_THAT(walk.walk.run.err, Not(HasSubstr("warning:")));
  EXPECT_EQ(black_in(walk, 19), "left/left");
}

}  // namespace
}  // namespace probewalk::test
