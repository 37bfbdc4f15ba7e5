// What is handed to xrEndFrame, as a layer in front of Monado (tests/openxr_layer) saw it: poses, depth, rectangles.
// Skipped, with the reason, where Monado is not installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/depth_range.h"
#include "tools/scripted_walk.h"

namespace probewalk::test {
namespace {

using nlohmann::json;

// Frames that were drawn: at least so many of them.
std::vector<json> drawn_in(const ScriptedWalk& walk, std::size_t least) {
  EXPECT_EQ(walk.walk.run.exit_code, 0) << walk.walk.run.err;
  std::vector<json> drawn;
  for (const json& ended : walk.ended) {
    EXPECT_EQ(ended["display_time"], ended["waited_time"]) << "a frame is for the time that it was waited for";
    EXPECT_EQ(ended["layers"], ended["views"].empty() ? 0 : 1);
    if (!ended["views"].empty()) drawn.push_back(ended);
  }
  EXPECT_GE(drawn.size(), least);
  return drawn;
}

// Left and right lie in layers of their own of one array image, both within it.
void expect_rect(const json& picture, std::size_t view, int width, int height) {
  EXPECT_EQ(picture["rect"], (json{0, 0, width, height}));
  EXPECT_EQ(picture["layer"], view);
  EXPECT_EQ(picture["swapchain"][2], 2);
  EXPECT_LE(width, picture["swapchain"][0].get<int>());
  EXPECT_LE(height, picture["swapchain"][1].get<int>());
}

TEST(OpenXrLayers, StateThePosesLocatedLast) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  constexpr double kLate_m = 0.01;  // from one locate of a frame to the next
  for (const double scale : {1.0, 2.0, 0.1}) {
    SCOPED_TRACE(scale);
    const ScriptedWalk walk =
        walk_by_script("openxr-layers-poses", "still=1;late_m=0.01",
                       "--frames 30 --record walked.jsonl --world-scale " + std::to_string(scale));
    const std::vector<json> drawn = drawn_in(walk, 15);
    const Path path = read_path(walk.folder / "walked.jsonl");
    for (const json& ended : drawn) {
      EXPECT_EQ(ended["locates"], 2) << "early, and late";
      ASSERT_EQ(ended["located"].size(), ended["views"].size());
      for (std::size_t i = 0; i < ended["views"].size(); ++i) {
        // To the last bit, and in the runtime's metres whatever the world's scale.
        EXPECT_EQ(ended["views"][i]["pose"], ended["located"][i]["pose"]);
        EXPECT_EQ(ended["views"][i]["fov_rad"], ended["located"][i]["fov_rad"]);
      }
      const PathPose* pose = pose_of(path, walk, ended);
      ASSERT_NE(pose, nullptr);
      // The rig lies where the first early pose put it: over the pack's start, (-1, 1.2).
      EXPECT_NEAR(std::hypot(pose->position_m.x + 1.0, pose->position_m.z - 1.2), kLate_m * scale, 1e-5)
          << "drawn for the late pose";
      const double eyes_m = glm::distance(position_of(ended["views"][0]), position_of(ended["views"][1]));
      EXPECT_GT(eyes_m, 0.05);
      EXPECT_NEAR(glm::distance(pose->views.at(0).position_m, pose->views.at(1).position_m), eyes_m * scale, 1e-5);
    }
  }
}

TEST(OpenXrLayers, StateDepthReversedAndInTheWearersMetres) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const Bounds bounds = furnished_room().bounds;
  const double diagonal_m = glm::distance(bounds.lower_m, bounds.upper_m);
  for (const double scale : {1.0, 2.5, 0.1}) {
    SCOPED_TRACE(scale);
    const ScriptedWalk walk =
        walk_by_script("openxr-layers-depth", "", "--frames 20 --world-scale " + std::to_string(scale));
    for (const json& ended : drawn_in(walk, 8)) {
      for (std::size_t i = 0; i < 2; ++i) {
        ASSERT_TRUE(ended["views"][i].contains("depth"));
        const json& depth = ended["views"][i]["depth"];
        expect_rect(depth, i, 64, 48);
        EXPECT_EQ(depth["range"], (json{0.0, 1.0}));
        // The depth of 0 is the far plane: it is named as that of minDepth, the near one.
        const double of_zero_m = depth["near_m"].get<double>(), of_one_m = depth["far_m"].get<double>();
        EXPECT_NEAR(of_zero_m * scale, depth_range_of(bounds).far_m, 1e-3);
        EXPECT_GE(of_zero_m * scale, diagonal_m) << "the room is seen from corner to corner";
        EXPECT_NEAR(of_one_m, 0.05, 1e-6) << "nearer than eyes come to a wall, however large the wearer is";
      }
    }
  }
}

TEST(OpenXrLayers, AreAsLargeAsTheEyesAreDrawn) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const ScriptedWalk walk = walk_by_script("openxr-layers-fixed", "", "--frames 12 --eye-scale 0.7");
  for (const json& ended : drawn_in(walk, 3)) {
    for (std::size_t i = 0; i < 2; ++i) {
      expect_rect(ended["views"][i]["colour"], i, 45, 34);
      expect_rect(ended["views"][i]["depth"], i, 45, 34);
      EXPECT_EQ(ended["views"][i]["colour"]["swapchain"], (json{64, 48, 2}));
    }
  }
}

// No device keeps up with a period of a microsecond, and every one does with ten seconds.
TEST(OpenXrLayers, FollowTheEyesDownAndUpAgain) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const ScriptedWalk walk =
      walk_by_script("openxr-layers-adapts", "period_ms=1:10000,20:0.001,60:10000", "--frames 190 --eye-scale auto");
  const std::vector<json> drawn = drawn_in(walk, 150);
  ASSERT_EQ(walk.walk.frames.size(), 190u);
  std::vector<double> scales;
  for (const json& ended : drawn) {
    const FrameRecord& frame = walk.walk.frames.at(ended["frame"].get<std::size_t>() - 1);
    ASSERT_TRUE(frame.should_render);
    if (scales.empty() || scales.back() != frame.eye_scale) scales.push_back(frame.eye_scale);
    for (std::size_t i = 0; i < 2; ++i) {
      for (const char* picture : {"colour", "depth"}) {
        expect_rect(ended["views"][i][picture], i, static_cast<int>(std::lround(64 * frame.eye_scale)),
                    static_cast<int>(std::lround(48 * frame.eye_scale)));
      }
    }
  }
  ASSERT_EQ(scales.size(), 3u) << testing::PrintToString(scales);
  EXPECT_EQ(scales[0], 1.0);
  EXPECT_EQ(scales[1], 0.6);
  EXPECT_EQ(scales[2], 0.65);
}

}  // namespace
}  // namespace probewalk::test
