#include "xr/ledger_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "support/room_pack.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;

WalkOptions offscreen() {
  static const fs::path pack = [] {
    const fs::path made = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / ("xr-cost-" + std::to_string(getpid()) + ".probes");
    fs::remove_all(made);
    test::write_room_pack(made);
    return made;
  }();
  WalkOptions options;
  options.pack = pack;
  options.display.choice = DisplayChoice::kOffscreen;
  options.display.eye_size = {16, 16};
  options.display.device.validation = true;
  options.command = "test";
  return options;
}

TEST(WalkLedgerCost, KeepsNoBooksOfFramesThatItIsToldToLeaveOut) {
  WalkOptions options = offscreen();
  options.frames = 24;
  options.keeps_books = [](std::uint64_t frame) { return frame % 3 == 0; };
  SilentProgress progress;
  const WalkResult result = walk(options, progress);
  EXPECT_EQ(result.validation_messages, 0u);
  const auto& frames = result.ledger.frames();
  ASSERT_EQ(frames.size(), 8u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].frame_id, 3 * i);
    EXPECT_GT(frames[i].record.end, frames[i].record.begin);
    EXPECT_GT(frames[i].gpu_trace.end, frames[i].gpu_trace.begin) << "timed on the device, and of this very frame";
    EXPECT_GE(frames[i].gpu.begin, frames[i].submit.begin - frames[i].clock_deviation_ns);
  }
}

TEST(WalkLedgerCost, IsMeasuredInPairs) {
  SilentProgress progress;
  WalkOptions options = offscreen();
  options.report = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / "xr-cost-report";  // of the walk itself, not of the measuring
  fs::remove_all(*options.report);
  const LedgerCost cost = measure_ledger_cost(options, 6, progress);
  EXPECT_EQ(cost.pairs, 6u);
  for (const CostFraction& fraction : {cost.frame_time, cost.cpu_time}) {
    EXPECT_TRUE(std::isfinite(fraction.median));
    EXPECT_LE(fraction.low, fraction.median);
    EXPECT_LE(fraction.median, fraction.high);
    EXPECT_GT(fraction.low, -1.0);
  }
  EXPECT_FALSE(fs::exists(*options.report));
}

}  // namespace
}  // namespace probewalk
