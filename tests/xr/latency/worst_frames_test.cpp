#include "xr/latency/worst_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "xr/latency/synthetic_run.h"

namespace probewalk {
namespace {

constexpr std::size_t kStalled = 20;
constexpr std::int64_t kStall = 30 * kMs;

// 40 regular frames; frame 20 is changed by `fault`, and everything after it comes 30 ms later.
template <typename Fault>
std::vector<WorstFrame> worst_with(Fault fault) {
  std::vector<FrameRecord> frames;
  for (std::size_t i = 0; i < 40; ++i) {
    frames.push_back(synthetic_frame(i));
    if (i > kStalled) delay(frames.back(), kStall);
  }
  fault(frames);
  return worst_frames(frames, 0, true);
}

void expect_blamed(const std::vector<WorstFrame>& worst, const std::string& stage) {
  ASSERT_EQ(worst.size(), 10u);
  EXPECT_EQ(worst[0].index, kStalled + 1);
  EXPECT_EQ(worst[0].frame_ns, kPeriod + kStall);
  EXPECT_EQ(worst[0].missed, 3u);
  EXPECT_EQ(worst[0].stage, stage) << worst[0].cause;
  EXPECT_NEAR(static_cast<double>(worst[0].excess_ns), static_cast<double>(kStall), 0.1 * kMs) << worst[0].cause;
  for (std::size_t i = 1; i < worst.size(); ++i) EXPECT_EQ(worst[i].stage, "") << worst[i].cause;
}

TEST(WorstFrames, BlameTheCallThatStalled) {
  expect_blamed(worst_with([](auto& f) { f[kStalled].record.end += kStall; }), "record");
  expect_blamed(worst_with([](auto& f) { f[kStalled].submit.end += kStall; }), "submit");
  expect_blamed(worst_with([](auto& f) { f[kStalled].begin.end += kStall; }), "begin");
  expect_blamed(worst_with([](auto& f) { f[kStalled].end.end += kStall; }), "end");
  expect_blamed(worst_with([](auto& f) { f[kStalled].ledger.end += kStall; }), "ledger");
}

TEST(WorstFrames, BlameWorkBetweenTheCalls) {
  expect_blamed(worst_with([](auto&) {}), "between_calls");
}

TEST(WorstFrames, BlameTheRuntimeWhenItHeldTheFrameBack) {
  const auto worst = worst_with([](auto& f) { f[kStalled + 1].wait.begin -= kStall; });
  expect_blamed(worst, "wait");
  EXPECT_THAT(worst[0].cause, testing::HasSubstr("the runtime held the frame back"));
}

TEST(WorstFrames, BlameTheDeviceWhenTheCpuOnlyWaitedForIt) {
  expect_blamed(worst_with([](auto& f) {
                  f[kStalled + 1].wait.begin -= kStall;
                  f[kStalled].gpu_trace.end += kStall;
                  f[kStalled].gpu.end += kStall;
                }),
                "gpu_trace");
  expect_blamed(worst_with([](auto& f) {
                  f[kStalled].submit.end += kStall;
                  f[kStalled].blocked_ns += kStall;
                  f[kStalled].gpu.end += kStall;
                }),
                "gpu_other");
  expect_blamed(worst_with([](auto& f) {
                  f[kStalled].end.end += kStall;  // a runtime that waits for the device when the frame ends
                  f[kStalled].gpu_trace.end += kStall;
                  f[kStalled].gpu.end += kStall;
                }),
                "gpu_trace");
}

TEST(WorstFrames, BlameTheCpuWhenItWorkedBesideASlowDevice) {
  expect_blamed(worst_with([](auto& f) {
                  f[kStalled].record.end += kStall;
                  f[kStalled].gpu.end += kStall;
                }),
                "record");
}

TEST(WorstFrames, BlameStreamingInsideTheCallThatItSlowed) {
  const auto worst = worst_with([](auto& f) {
    f[kStalled].record.end += kStall;
    f[kStalled].streaming_ns += kStall;
    f[kStalled].bytes_uploaded = 3 << 20;
    for (std::size_t i = kStalled; i < f.size(); ++i) f[i].room = 4;
  });
  expect_blamed(worst, "streaming");
  EXPECT_THAT(worst[0].cause, testing::HasSubstr("3.0 MiB uploaded"));
  EXPECT_THAT(worst[0].cause, testing::HasSubstr("room 0 to 4"));
}

TEST(WorstFrames, NamePipelineBuilds) {
  const auto worst = worst_with([](auto& f) {
    f[kStalled].record.end += kStall;
    f[kStalled].pipelines_built = 2;
  });
  expect_blamed(worst, "record");
  EXPECT_THAT(worst[0].cause, testing::HasSubstr("2 pipeline build"));
}

TEST(WorstFrames, AreNoneWithoutFrames) {
  EXPECT_TRUE(worst_frames({}, 0, true).empty());
  const FrameRecord one = synthetic_frame(0);
  EXPECT_TRUE(worst_frames({&one, 1}, 0, true).empty());
}

}  // namespace
}  // namespace probewalk
