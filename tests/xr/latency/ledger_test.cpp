#include "xr/latency/ledger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "xr/latency/synthetic_run.h"

namespace probewalk {
namespace {

Ledger regular_run(std::size_t n, LedgerOptions options = {}) {
  Ledger ledger(options);
  for (std::size_t i = 0; i < n; ++i) ledger.add(synthetic_frame(i));
  return ledger;
}

void expect_all(const Summary& summary, const char* name, std::uint64_t n, double value) {
  const QuantitySummary& quantity = summary.quantity(name);
  EXPECT_EQ(quantity.histogram.count(), n) << name;
  EXPECT_NEAR(static_cast<double>(quantity.histogram.max()) / quantity.scale, value, 1e-6) << name;
  EXPECT_NEAR(static_cast<double>(quantity.histogram.min()) / quantity.scale, value, 1e-6) << name;
}

TEST(Ledger, DerivesEveryQuantityAsDefined) {
  const Summary summary = regular_run(200).summary();
  expect_all(summary, "frame", 199, 10.0 * kMs);
  expect_all(summary, "cpu_wait", 200, 2.0 * kMs);
  expect_all(summary, "cpu_busy", 200, 4.0 * kMs);  // 5 ms less 1 ms blocked
  expect_all(summary, "gpu_busy", 200, 4.0 * kMs);
  expect_all(summary, "gpu_trace", 200, 3.0 * kMs);
  expect_all(summary, "prediction_horizon", 200, 22.25 * kMs);  // 25 - 2.75
  expect_all(summary, "deadline_margin", 200, 8.0 * kMs);       // 25 - 10 - 7
  EXPECT_EQ(summary.quantity("pose_error_mm").histogram.count(), 0u);
  EXPECT_EQ(summary.frames, 200u);
  EXPECT_EQ(summary.period_ns, kPeriod);
  EXPECT_EQ(summary.missed, 0u);
  EXPECT_EQ(summary.stale_run_max, 0u);
  EXPECT_EQ(summary.within_budget_fraction, 1.0);
  EXPECT_EQ(summary.clock_error_ns, 20);
  EXPECT_EQ(summary.coarse_frame_fraction, 0.0);
}

TEST(Ledger, WarmUpIsCountedAndLeftOut) {
  Ledger ledger(LedgerOptions{.warmup_frames = 10});
  for (std::size_t i = 0; i < 30; ++i) {
    FrameRecord frame = synthetic_frame(i);
    if (i < 10) {  // slow, missing its deadlines, calibrated badly, drawing coarse
      delay(frame, static_cast<std::int64_t>(i) * 40 * kMs - 400 * kMs);
      frame.clock_deviation_ns = 999;
      frame.level_shown = 0;
      frame.discarded = true;
    }
    frame.bytes_uploaded = 100;
    ledger.add(frame);
  }
  const Summary summary = ledger.summary();
  EXPECT_EQ(summary.warmup_frames, 10u);
  EXPECT_EQ(summary.frames, 20u);
  EXPECT_EQ(summary.missed, 0u);
  EXPECT_EQ(summary.discarded, 0u);
  EXPECT_EQ(summary.clock_error_ns, 20);
  EXPECT_EQ(summary.coarse_frame_fraction, 0.0);
  // The first frame that counts follows warm-up work, so it has no frame time of its own.
  expect_all(summary, "frame", 19, 10.0 * kMs);
  EXPECT_EQ(summary.bytes_uploaded, 3'000u);  // streaming counts the whole run

  const Summary short_run = regular_run(5, {.warmup_frames = 10}).summary();
  EXPECT_EQ(short_run.warmup_frames, 5u);
  EXPECT_EQ(short_run.frames, 0u);
  EXPECT_FALSE(short_run.within_budget_fraction.has_value());
}

TEST(Ledger, KnowsTheLongestTimeAtACoarseLevel) {
  // Coarse: 3 frames, a break, 2 frames of which the second is shown for five periods, one at the end.
  Ledger ledger;
  const bool coarse[] = {false, true, true, true, false, true, true, false, false, true};
  std::int64_t display = 1'000 * kPeriod;
  for (std::size_t i = 0; i < std::size(coarse); ++i) {
    FrameRecord frame = synthetic_frame(i);
    frame.predicted_display = display;
    frame.level_wanted = 1, frame.level_shown = coarse[i] ? 0 : 1;
    ledger.add(frame);
    display += (i == 6 ? 5 : 1) * kPeriod;
  }
  const Summary summary = ledger.summary();
  EXPECT_EQ(summary.coarse_frame_fraction, 0.6);
  EXPECT_EQ(summary.coarse_run_max, 3u);
  EXPECT_EQ(summary.coarse_run_max_ns, 6 * kPeriod);

  Ledger to_the_end;  // a run that the walk's end cuts off counts, its last frame with its own refresh
  for (std::size_t i = 0; i < 4; ++i) {
    FrameRecord frame = synthetic_frame(i);
    frame.predicted_display = static_cast<std::int64_t>(100 + i) * kPeriod;
    frame.level_wanted = 1, frame.level_shown = i < 2 ? 1 : 0;
    to_the_end.add(frame);
  }
  EXPECT_EQ(to_the_end.summary().coarse_run_max, 2u);
  EXPECT_EQ(to_the_end.summary().coarse_run_max_ns, 2 * kPeriod);

  EXPECT_EQ(regular_run(20).summary().coarse_run_max, 0u);
  EXPECT_EQ(regular_run(20).summary().coarse_run_max_ns, 0);
}

TEST(Ledger, CountsMissedRefreshesFromPredictedDisplayTimes) {
  // Advances in periods: 1, 1.4 (on time), 1.6 (one missed), 4 (three missed), 1.
  const double advances[] = {1.0, 1.4, 1.6, 4.0, 1.0};
  Ledger ledger;
  FrameRecord frame = synthetic_frame(0);
  ledger.add(frame);
  for (std::size_t i = 0; i < std::size(advances); ++i) {
    const std::int64_t display = frame.predicted_display + static_cast<std::int64_t>(advances[i] * kPeriod);
    frame = synthetic_frame(i + 1);
    frame.predicted_display = display;
    ledger.add(frame);
  }
  const Summary summary = ledger.summary();
  EXPECT_EQ(summary.missed, 4u);
  EXPECT_EQ(summary.stale_run_max, 3u);
}

TEST(Ledger, StaleRunGoesOnThroughDiscardedFrames) {
  Ledger ledger;
  for (std::size_t i = 0; i < 8; ++i) {
    FrameRecord frame = synthetic_frame(i);
    if (i >= 4) delay(frame, kPeriod);  // one refresh missed before frame 4
    frame.discarded = i == 4 || i == 5;
    frame.should_render = i != 7;
    ledger.add(frame);
  }
  const Summary summary = ledger.summary();
  EXPECT_EQ(summary.missed, 1u);
  EXPECT_EQ(summary.discarded, 2u);
  EXPECT_EQ(summary.stale_run_max, 3u);  // the missed one and the two discarded
  EXPECT_EQ(summary.not_rendered, 1u);
  EXPECT_EQ(summary.quantity("cpu_busy").histogram.count(), 7u);
}

TEST(Ledger, WithinBudgetNeedsBothCpuAndGpu) {
  Ledger ledger;
  for (std::size_t i = 0; i < 10; ++i) {
    FrameRecord frame = synthetic_frame(i);
    if (i == 2) frame.gpu.end = frame.gpu.begin + 11 * kMs;
    if (i == 5) frame.end.end = frame.wait.end + 12 * kMs;  // 11 ms busy
    if (i == 6) frame.end.end = frame.wait.end + 11 * kMs;  // 10 ms busy: just within
    if (i == 8) frame.gpu = {};                             // not measured: not judged
    if (i == 9) frame.should_render = false;
    ledger.add(frame);
  }
  EXPECT_DOUBLE_EQ(*ledger.summary().within_budget_fraction, 6.0 / 8.0);
}

TEST(Ledger, WithoutDeadlinesOrCalibrationWhatTheyGiveDoesNotExist) {
  const Summary fixed_clock = regular_run(50, {.has_deadlines = false}).summary();
  EXPECT_EQ(fixed_clock.quantity("prediction_horizon").histogram.count(), 0u);
  EXPECT_EQ(fixed_clock.quantity("deadline_margin").histogram.count(), 0u);
  EXPECT_EQ(fixed_clock.quantity("gpu_busy").histogram.count(), 50u);

  Ledger ledger;
  for (std::size_t i = 0; i < 50; ++i) {
    FrameRecord frame = synthetic_frame(i);
    frame.clock_calibrated = false;
    frame.gpu = {0, 4 * kMs};  // an axis of its own
    ledger.add(frame);
  }
  const Summary uncalibrated = ledger.summary();
  EXPECT_FALSE(uncalibrated.clock_error_ns.has_value());
  EXPECT_EQ(uncalibrated.quantity("deadline_margin").histogram.count(), 0u);
  expect_all(uncalibrated, "gpu_busy", 50, 4.0 * kMs);
}

TEST(Ledger, CountsWhatTheRuntimeAnsweredAboutPosesAndTakesTheHorizonOfThePoseUsed) {
  Ledger ledger;
  for (std::size_t i = 0; i < 10; ++i) {
    FrameRecord frame = synthetic_frame(i);
    frame.pose_answer = i < 4   ? PoseAnswer::kMeasured
                        : i < 7 ? PoseAnswer::kTooLate
                        : i < 9 ? PoseAnswer::kRefused
                                : PoseAnswer::kPending;
    frame.early_pose = true;  // all of them: the late pose was never valid
    ledger.add(frame);
  }
  const Summary summary = ledger.summary();
  EXPECT_THAT(summary.pose_answers, testing::ElementsAre(0, 1, 4, 3, 2));
  EXPECT_EQ(summary.early_pose_frames, 10u);
  // Shown 25 ms after the wait ended, located half a millisecond after it.
  expect_all(summary, "prediction_horizon", 10, 24.5 * kMs);
}

TEST(Ledger, CoarseFramesAreThoseBelowTheLevelWantedOrWithNothingToShow) {
  Ledger ledger;
  const std::pair<int, int> shown_and_wanted[] = {{1, 1}, {2, 1}, {0, 1}, {-1, 0}, {-1, -1}, {1, -1}};
  for (std::size_t i = 0; i < std::size(shown_and_wanted); ++i) {
    FrameRecord frame = synthetic_frame(i);
    std::tie(frame.level_shown, frame.level_wanted) = shown_and_wanted[i];
    ledger.add(frame);
  }
  EXPECT_DOUBLE_EQ(*ledger.summary().coarse_frame_fraction, 2.0 / 4.0);
}

TEST(Ledger, MissedRefreshesAreTheRoundedAdvanceLessOne) {
  // Every advance from under one period to beyond four, by hand: none below 1.5, then the nearest whole number less
  // one.
  for (int tenths = 5; tenths <= 44; ++tenths) {
    FrameRecord first = synthetic_frame(0), next = synthetic_frame(1);
    next.predicted_display = first.predicted_display + tenths * (kPeriod / 10);
    const std::uint32_t expected = tenths < 15 ? 0 : static_cast<std::uint32_t>((tenths + 5) / 10 - 1);
    EXPECT_EQ(derive(next, &first, true).missed, expected) << tenths << " tenths of a period";
    EXPECT_EQ(derive(next, &first, false).missed, 0u);
    EXPECT_EQ(derive(next, nullptr, true).missed, 0u);
  }
}

TEST(Ledger, WhatDidNotHappenHasNoLength) {
  FrameRecord frame = synthetic_frame(1);
  const FrameRecord before = synthetic_frame(0);
  frame.should_render = false;
  FrameQuantities q = derive(frame, &before, true);
  EXPECT_FALSE(q.cpu_busy_ns || q.gpu_busy_ns || q.deadline_margin_ns || q.within_budget);
  EXPECT_EQ(q.frame_ns, kPeriod);
  EXPECT_EQ(q.cpu_wait_ns, 2 * kMs);

  frame = synthetic_frame(1);
  frame.blocked_ns = 9 * kMs;  // more than there was: a measurement's doubt, no negative work
  EXPECT_EQ(derive(frame, &before, true).cpu_busy_ns, 0);
  frame.gpu = frame.gpu_trace = {};
  frame.locate_late = {};
  q = derive(frame, nullptr, true);
  EXPECT_FALSE(q.frame_ns || q.gpu_busy_ns || q.gpu_trace_ns || q.prediction_horizon_ns || q.deadline_margin_ns);
  EXPECT_FALSE(q.pose_error_mm || q.pose_error_deg);

  frame = synthetic_frame(1);
  frame.gpu.end += 9 * kMs;  // a millisecond too late
  EXPECT_EQ(derive(frame, &before, true).deadline_margin_ns, -1 * kMs);
}

TEST(Ledger, KeepsPoseErrorsInTheirOwnUnits) {
  Ledger ledger;
  for (std::size_t i = 0; i < 3; ++i) {
    FrameRecord frame = synthetic_frame(i);
    frame.pose_error_mm = 1.25;
    frame.pose_error_deg = 0.0;  // exactly none is a measurement too
    ledger.add(frame);
  }
  const Summary summary = ledger.summary();
  expect_all(summary, "pose_error_mm", 3, 1.25);
  expect_all(summary, "pose_error_deg", 3, 0.0);
}

}  // namespace
}  // namespace probewalk
