// The overlay for the wearer, on a real runtime: what a layer in front of Monado (tests/openxr_layer) counts at each
// xrEndFrame, and what Monado's own compositor then shows. Skipped, with the reason, where Monado is not installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "support/virtual_screen.h"
#include "tools/scripted_walk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

struct EndedFrame {
  int layers = 0, swapchains = 0, quads = 0;
};

std::vector<EndedFrame> read_layer_log(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<EndedFrame> frames;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    frames.push_back({std::stoi(cells.at(2)), std::stoi(cells.at(8)), std::stoi(cells.at(9))});
  }
  return frames;
}

// The simulated headset's frames, as the layer saw them.
std::vector<EndedFrame> walk_with(const std::string& name, const std::string& arguments) {
  const bool has_checks =
      std::system("ls /usr/share/openxr/1/api_layers/explicit.d/*core_validation* >/dev/null 2>&1") == 0;
  const fs::path folder = fresh_folder("headset-overlay-" + name);
  const std::string manifests = PROBEWALK_TEST_LAYER_MANIFESTS;
  const MonadoWalk walk =
      walk_in_monado(folder,
                     "export XR_API_LAYER_PATH='" + manifests + "':/usr/share/openxr/1/api_layers/explicit.d " +
                         "XR_ENABLE_API_LAYERS=XR_APILAYER_PROBEWALK_known_motion" +
                         (has_checks ? ":XR_APILAYER_LUNARG_core_validation XR_CORE_VALIDATION_EXPORT_TYPE=text "
                                       "XR_CORE_VALIDATION_FILE_NAME=$PWD/openxr.txt"
                                     : "") +
                         " PROBEWALK_TEST_LAYER=\"log=$PWD/layer.csv\"",
                     "--validate " + arguments);
  EXPECT_EQ(walk.run.exit_code, 0) << walk.run.err;
  EXPECT_THAT(walk.run.err, Not(HasSubstr("VUID")));
  EXPECT_THAT(walk.run.err, Not(HasSubstr("warning:")));
  if (has_checks) {
    EXPECT_THAT(read_text(folder / "openxr.txt"), Not(HasSubstr("VALID_ERROR")));
    EXPECT_THAT(read_text(folder / "openxr.txt"), Not(HasSubstr("VALID_WARNING")));
  }
  return read_layer_log(folder / "layer.csv");
}

TEST(HeadsetOverlay, IsALayerOfItsOwnWhileItIsShown) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const std::vector<EndedFrame> frames = walk_with("shown", "--frames 80 --headset-overlay");
  const auto first = std::ranges::find(frames, 1, &EndedFrame::quads);
  ASSERT_NE(first, frames.end()) << "it was never shown";
  EXPECT_GT(frames.end() - first, 20);
  for (auto frame = first; frame != frames.end(); ++frame) {
    if (frame->layers == 0) continue;  // the session ends
    EXPECT_EQ(frame->layers, 2);
    EXPECT_EQ(frame->quads, 1);
    EXPECT_EQ(frame->swapchains, 3) << "colour, depth, overlay";
  }
}

TEST(HeadsetOverlay, HiddenItHasNeitherLayerNorSwapchain) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  // That of the mirror is another.
  for (const std::string options : {"", "--overlay"}) {
    for (const EndedFrame& frame : walk_with("hidden" + options, "--frames 30 " + options)) {
      EXPECT_LE(frame.layers, 1);
      EXPECT_EQ(frame.swapchains, 2) << "colour, depth";
    }
  }
}

// Monado waits for the application's queue when the panel's images go, while the mirror presents on a thread of its
// own.
TEST(HeadsetOverlay, GoesWhileTheMirrorPresents) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const VirtualScreen screen;
  if (!screen.is_there()) GTEST_SKIP() << "Xvfb is not installed";
  // Menu, held, hides it.
  const ScriptedWalk walk =
      walk_by_script("headset-overlay-goes", "destroy_ms=400;inputs=40:left/menu/click:1,90:left/menu/click:0",
                     "--frames 130 --validate --headset-overlay --mirror both",
                     "export SIMULATED_LEFT=simple SIMULATED_RIGHT=simple DISPLAY=:" + screen.number() + "\n");
  ASSERT_EQ(walk.walk.run.exit_code, 0) << walk.walk.run.err;
  ASSERT_FALSE(walk.ended.empty());
  EXPECT_EQ(walk.ended.back()["swapchains_destroyed"], 1) << "the panel's, in mid-walk";
  EXPECT_THAT(walk.walk.run.err, HasSubstr("mirror: "));
  EXPECT_THAT(walk.walk.run.err, Not(HasSubstr("Vulkan validation")));
}

TEST(HeadsetOverlay, IsForHeadsets) {
  const fs::path folder = fresh_folder("headset-overlay-refused");
  for (const char* display : {"window", "offscreen"}) {
    const RunResult run = run_bash(folder, std::string("'") + PROBEWALK_EXECUTABLE +
                                               "' walk nowhere.probes --display " + display + " --headset-overlay");
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr("--headset-overlay"));
  }
}

}  // namespace
}  // namespace probewalk::test
