#include "xr/latency/streaming_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "xr/latency/synthetic_run.h"

namespace probewalk {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Level 0 of 1 in frames [first, last); nothing at all in the first of them.
probewalk::Run coarse_between(std::size_t first, std::size_t last, std::uint64_t warmup = 0) {
  probewalk::Run run{"run", {}, Ledger(LedgerOptions{.warmup_frames = warmup})};
  for (std::size_t i = 0; i < 100; ++i) {
    FrameRecord frame = synthetic_frame(i);
    if (i >= first && i < last) frame.level_shown = i == first ? -1 : 0;
    if (i == 2) frame.level_shown = 0;
    frame.device_bytes = 3 << 20;
    run.ledger.add(frame);
  }
  return run;
}

std::string section(const probewalk::Run& run) {
  return streaming_section(run, run.ledger.summary());
}

TEST(StreamingSection, TellsOfTheLongestCoarseRunThatTheLedgerFinds) {
  const auto summary_of = [](const probewalk::Run& run) { return run.ledger.summary(); };
  const Summary longest = summary_of(coarse_between(40, 47));
  EXPECT_EQ(longest.coarse_run_max, 7u);
  EXPECT_EQ(longest.coarse_run_first, 40u);
  EXPECT_EQ(longest.coarse_run_max_ns, 7 * kPeriod);
  EXPECT_EQ(summary_of(coarse_between(0, 0)).coarse_run_max, 1u);
  EXPECT_EQ(summary_of(coarse_between(5, 20, 30)).coarse_run_max, 0u) << "warm-up is left out";
  EXPECT_EQ(summary_of(coarse_between(90, 100)).coarse_run_max_ns, 10 * kPeriod) << "the last frame is shown, too";
  EXPECT_EQ(Ledger{}.summary().coarse_run_max, 0u);
}

TEST(StreamingSection, TellsSharesTimesBytesAndBudget) {
  auto run = coarse_between(40, 47);
  run.info.streaming.need_to_resident_ns = {5 * kMs, 90 * kMs, 6 * kMs};
  run.info.streaming.device_budget_bytes = 2 << 20;
  EXPECT_THAT(section(run),
              AllOf(HasSubstr("8.0 %"), HasSubstr("from frame 40; the longest in time took 70.0 ms"),
                    HasSubstr("(n = 3)"), HasSubstr("p99 needs 100 levels"), HasSubstr("of a budget of 2.0 MiB"),
                    HasSubstr("class=\"dark\""), HasSubstr("class=\"coarse\""), Not(HasSubstr("could be loaded"))));
}

TEST(StreamingSection, WithoutABudgetSaysWhatTheDeviceHad) {
  auto run = coarse_between(40, 47);
  EXPECT_THAT(section(run), HasSubstr("budget: none set"));
  run.info.streaming.device_free_bytes = 3ull << 30;
  EXPECT_THAT(section(run), HasSubstr("budget: none set, the device had 3.00 GiB free"));
}

TEST(StreamingSection, NamesWhatCouldNotBeLoadedWhatNeverCameFirst) {
  auto run = coarse_between(40, 47);
  run.info.streaming.troubles = {{"hall", 1, 1, true, "the server was away"}, {"a<b", 2, 2, false, "chunk is damaged"}};
  const std::string html = section(run);
  EXPECT_THAT(html, AllOf(HasSubstr("Not everything could be loaded"),
                          HasSubstr("room a&lt;b, level 2: chunk is damaged (2 times)"),
                          HasSubstr("room hall, level 1: the server was away (1 time, then loaded)")));
  EXPECT_LT(html.find("a&lt;b"), html.find("room hall"));
}

TEST(StreamingSection, IsNoneWhereNothingIsStreamed) {
  probewalk::Run run{"run", {}, Ledger{}};
  EXPECT_EQ(section(run), "");
  FrameRecord frame = synthetic_frame(0);
  frame.level_shown = frame.level_wanted = -1;
  run.ledger.add(frame);
  EXPECT_EQ(section(run), "");
}

}  // namespace
}  // namespace probewalk
