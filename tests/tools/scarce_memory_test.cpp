// The walk on a device whose driver has no memory to give: a layer in front of the real driver refuses allocations, as
// a full device does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "content/image/image.h"
#include "support/room_pack.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kBlock_bytes = 32u << 20;  // what probes' memory grows by

struct Allocation {
  std::uint64_t bytes = 0;
  bool refused = false;
};

struct ScarceWalk {
  RunResult run;
  json summary;
  std::vector<Allocation> allocations;
  fs::path folder;

  std::ptrdiff_t refused() const { return std::ranges::count(allocations, true, &Allocation::refused); }
  double brightness(const std::string& picture) const {
    const ImageRgb8 image = read_png(folder / "pictures" / picture);
    double sum = 0.0;
    for (const std::uint8_t value : image.rgb) sum += value;
    return sum / static_cast<double>(image.rgb.size());
  }
};

std::string interrupted_after(const std::string& words) {
  return " & walk=$!\n"
         "while kill -0 $walk && ! grep -q '" +
         words +
         "' stderr; do sleep 0.1; done\n"
         "sleep 2; kill -INT $walk; wait $walk\n";
}

// until: the walk is interrupted two seconds after it says this; empty = it ends by its options.
ScarceWalk walk_with(const std::string& name, const std::string& scarcity, const std::string& options,
                     const std::string& until = "") {
  ScarceWalk result;
  result.folder = fresh_folder("scarce-memory-" + name);
  write_room_pack(result.folder / "room.probes", 512);  // its finer level fits nowhere by chance
  // A path of one pose never ends.
  std::ofstream(result.folder / "pose.jsonl")
      << R"({"t_s": 0, "position_m": [-1, 1.55, 1.2], "orientation_xyzw": [0, -0.2, 0, 0.98]})" << "\n";
  result.run = run_bash(result.folder, "export VK_ADD_LAYER_PATH='" PROBEWALK_TEST_VULKAN_LAYERS
                                       "'\n"
                                       "export VK_INSTANCE_LAYERS=VK_LAYER_PROBEWALK_scarce_memory\n"
                                       "export PROBEWALK_TEST_MEMORY='log=memory;" +
                                           scarcity +
                                           "'\n"
                                           "'" PROBEWALK_EXECUTABLE
                                           "' walk room.probes --display offscreen --eye-size 64x48 "
                                           "--save-frames pictures --report run " +
                                           options + (until.empty() ? "" : interrupted_after(until)));
  if (std::ifstream file(result.folder / "run" / "summary.json"); file) result.summary = json::parse(file);
  std::ifstream log(result.folder / "memory");
  for (Allocation each; log >> each.bytes >> each.refused;) result.allocations.push_back(each);
  return result;
}

// Allocations up to the first one for probes: those of the walk itself.
std::size_t allocations_before_rooms() {
  static const std::size_t count = [] {
    const ScarceWalk walk = walk_with("none", "refuse=0", "--frames 2");
    const auto block = std::ranges::find(walk.allocations, kBlock_bytes, &Allocation::bytes);
    EXPECT_NE(block, walk.allocations.end()) << walk.run.err;
    return static_cast<std::size_t>(block - walk.allocations.begin());
  }();
  return count;
}

std::string from_rooms_on() {
  return "after=" + std::to_string(allocations_before_rooms()) + ";";
}

TEST(ScarceMemory, WhereABlockIsTooMuchALevelMayFit) {
  const ScarceWalk walk = walk_with("piece", "at_least=16777216", "--frames 4");
  ASSERT_EQ(walk.run.exit_code, 0) << walk.run.err;
  EXPECT_GT(walk.refused(), 0);
  EXPECT_EQ(walk.summary["streaming"]["need_to_resident_n"], 2) << walk.run.err;
  EXPECT_TRUE(walk.summary["streaming"]["troubles"].empty()) << walk.summary["streaming"];
  EXPECT_GT(walk.brightness("frame-000003-left.png"), 20.0);
}

TEST(ScarceMemory, ALevelThatFindsNoneIsAskedForAgain) {
  const ScarceWalk walk = walk_with("again", from_rooms_on() + "refuse=42",
                                    "--realtime --seconds 100 --path pose.jsonl", "loaded after all");
  ASSERT_EQ(walk.run.exit_code, 5) << walk.run.err;
  EXPECT_EQ(walk.refused(), 42);
  EXPECT_THAT(walk.run.err, HasSubstr("VK_ERROR_OUT_OF_DEVICE_MEMORY"));
  EXPECT_THAT(walk.run.err, HasSubstr("loaded after all"));
  EXPECT_FALSE(walk.summary["streaming"]["troubles"].empty());
  for (const json& trouble : walk.summary["streaming"]["troubles"]) EXPECT_TRUE(trouble["overcome"]) << trouble;
}

// No frame waits, none shows garbage: the level that had found some stays, and the report says why.
TEST(ScarceMemory, AWalkGoesOnWithoutWhatFindsNone) {
  const ScarceWalk walk = walk_with("without", from_rooms_on(), "--realtime --seconds 2");
  ASSERT_EQ(walk.run.exit_code, 0) << walk.run.err;
  EXPECT_GT(walk.summary["frames"].get<int>(), 10);
  EXPECT_GT(walk.refused(), 1);
  EXPECT_LT(walk.refused(), 100);  // it is asked for again after growing pauses
  EXPECT_GT(walk.brightness("frame-000005-left.png"), 20.0);
  ASSERT_FALSE(walk.summary["streaming"]["troubles"].empty());
  for (const json& trouble : walk.summary["streaming"]["troubles"]) {
    EXPECT_FALSE(trouble["overcome"]) << trouble;
    EXPECT_THAT(trouble["reason"].get<std::string>(), HasSubstr("VK_ERROR_OUT_OF_DEVICE_MEMORY"));
  }
  EXPECT_EQ(walk.summary["streaming"]["coarse_frame_fraction"], 1.0);
}

// A stated budget is taken at once, or the walk does not begin.
TEST(ScarceMemory, ADeviceThatHasNoneAtAllIsToldInOneLine) {
  for (const char* budget : {"", " --device-budget 64"}) {
    const ScarceWalk walk = walk_with("at-all", "after=0", std::string("--frames 4") + budget);
    EXPECT_EQ(walk.run.exit_code, 4) << walk.run.err;
    EXPECT_THAT(walk.run.err, HasSubstr("VK_ERROR_OUT_OF_DEVICE_MEMORY"));
    EXPECT_THAT(walk.run.err, HasSubstr("lower --device-budget"));
    EXPECT_TRUE(walk.summary.is_null());
  }
}

}  // namespace
}  // namespace probewalk::test
