// What the ledger says of poses, and what becomes of a walk whose runtime errs: a layer in front of Monado
// (tests/openxr_layer) moves the head as it likes, errs on order, and keeps books of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "tools/monado_walk.h"
#include "xr/latency/worst_frames.h"
#include "xr/path.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// What the layer saw at an xrEndFrame.
struct EndedFrame {
  std::int64_t display_time = 0;
  int layers = 0;
  double stalled_ms = 0.0;
  double late_mm = 0.0, late_deg = 0.0;    // of the pose that the layer's views state
  double early_mm = 0.0, early_deg = 0.0;  // of the frame's first locate
  int asked = 0;                           // locates outside a frame since the xrEndFrame before
};

std::vector<EndedFrame> read_layer_log(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<EndedFrame> frames;
  while (std::getline(in, line)) {
    EndedFrame frame;
    frame.asked = std::stoi(line.substr(line.rfind(',') + 1));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    std::uint64_t number = 0;
    cells >> number >> frame.display_time >> frame.layers >> frame.stalled_ms >> frame.late_mm >> frame.late_deg >>
        frame.early_mm >> frame.early_deg;
    frames.push_back(frame);
  }
  return frames;
}

struct LayerWalk {
  MonadoWalk walk;
  std::vector<EndedFrame> ended;  // as many as there are frames, in their order
};

LayerWalk walk_behind_layer(const std::string& name, const std::string& orders, const std::string& arguments) {
  const fs::path folder = fresh_folder("openxr-timing-" + name);
  LayerWalk result;
  result.walk = walk_in_monado(folder,
                               "export XR_ENABLE_API_LAYERS=XR_APILAYER_PROBEWALK_known_motion XR_API_LAYER_PATH='" +
                                   std::string(PROBEWALK_TEST_LAYER_MANIFESTS) +
                                   "' PROBEWALK_TEST_LAYER=\"log=$PWD/layer.csv;" + orders + "\"",
                               arguments);
  EXPECT_EQ(result.walk.run.exit_code, 0) << result.walk.run.err;
  result.ended = read_layer_log(folder / "layer.csv");
  const auto& frames = result.walk.frames;
  EXPECT_GE(result.ended.size(), frames.size());
  result.ended.resize(frames.size());
  // The two clocks differ by a constant: the books speak of the same frames.
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].predicted_display - frames[0].predicted_display,
              result.ended[i].display_time - result.ended[0].display_time);
  }
  return result;
}

std::size_t count(const std::vector<FrameRecord>& frames, PoseAnswer answer) {
  return static_cast<std::size_t>(std::ranges::count(frames, answer, &FrameRecord::pose_answer));
}

double median(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

double ms(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-6;
}

TEST(OpenXrTiming, PoseErrorFoundIsThePoseErrorThatWasPutIn) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  constexpr double kRate_mm = 0.5, kRate_deg = 0.03;  // for each ms ahead
  std::printf(
      "  load   found of      worst difference        early pose       late pose   early - late   expected\n"
      "    ms  frames shown        mm        deg   p50 mm    deg    p50 mm    deg         p50 mm     p50 mm\n");
  for (const int load_ms : {0, 15}) {
    const LayerWalk run = walk_behind_layer(
        "pose-" + std::to_string(load_ms),
        "error_mm_per_ms=0.5;error_deg_per_ms=0.03;stall=xrWaitSwapchainImage;stall_every=1;stall_ms=" +
            std::to_string(load_ms),
        "--frames 60");
    const auto& frames = run.walk.frames;
    ASSERT_EQ(frames.size(), 60u);
    double worst_mm = 0.0, worst_deg = 0.0;
    std::size_t shown = 0, measured = 0;
    std::vector<double> early_mm, early_deg, late_mm, late_deg, gained_mm, expected_mm;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const FrameRecord& frame = frames[i];
      const EndedFrame& ended = run.ended[i];
      EXPECT_EQ(ended.layers > 0, frame.should_render);
      if (ended.layers == 0) continue;
      ++shown;
      early_mm.push_back(ended.early_mm);
      early_deg.push_back(ended.early_deg);
      late_mm.push_back(ended.late_mm);
      late_deg.push_back(ended.late_deg);
      // The layer errs by the time ahead, so that the two errors lie as far apart as the two locates. Where the frame's
      // time has come before its late locate, there is nothing left to err.
      const double between_ms = ms(frame.locate_late.begin - frame.locate_early.begin);
      const double slack_ms =
          ms(frame.locate_late.end - frame.locate_late.begin) + ms(frame.locate_early.end - frame.locate_early.begin);
      if (ended.late_mm > 0.01) {
        gained_mm.push_back(ended.early_mm - ended.late_mm);
        expected_mm.push_back(kRate_mm * between_ms);
        EXPECT_NEAR(gained_mm.back(), expected_mm.back(), kRate_mm * slack_ms + 0.01) << i;
        EXPECT_NEAR(ended.early_deg - ended.late_deg, kRate_deg * between_ms, kRate_deg * slack_ms + 0.01) << i;
        EXPECT_NEAR(ended.late_mm, kRate_mm * ms(frame.predicted_display - frame.locate_late.end),
                    kRate_mm * slack_ms + 0.01);
      }
      EXPECT_LE(ended.late_mm, ended.early_mm + 0.001);  // nothing is left to err where the frame's time has come
      if (frame.pose_answer != PoseAnswer::kMeasured) continue;
      ++measured;
      worst_mm = std::max(worst_mm, std::abs(frame.pose_error_mm - ended.late_mm));
      worst_deg = std::max(worst_deg, std::abs(frame.pose_error_deg - ended.late_deg));
    }
    std::printf("%6d  %6zu %5zu  %8.4f   %8.5f %8.2f %6.2f  %8.2f %6.2f       %8.2f   %8.2f\n", load_ms, measured,
                shown, worst_mm, worst_deg, median(early_mm), median(early_deg), median(late_mm), median(late_deg),
                median(gained_mm), median(expected_mm));
    EXPECT_GT(shown, 40u);
    EXPECT_GT(measured, 10u);  // a busy machine asks too late of many frames, and says so
    EXPECT_LT(worst_mm, 0.02);
    EXPECT_LT(worst_deg, 0.002);
    EXPECT_GT(median(gained_mm), kRate_mm * load_ms);
  }
}

TEST(OpenXrTiming, ABareSimulatedHeadsetErrsByNothing) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const MonadoWalk walk = walk_in_monado(fresh_folder("openxr-timing-bare"), "", "--frames 40");
  ASSERT_EQ(walk.run.exit_code, 0) << walk.run.err;
  EXPECT_GT(count(walk.frames, PoseAnswer::kMeasured), 10u);
  for (const FrameRecord& frame : walk.frames) {
    if (frame.pose_answer != PoseAnswer::kMeasured) continue;
    EXPECT_EQ(frame.pose_error_mm, 0.0);
    EXPECT_LT(frame.pose_error_deg, 1e-5);
  }
}

TEST(OpenXrTiming, EveryShownFrameIsAccountedForWhereAnswersFail) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const LayerWalk run = walk_behind_layer(
      "answers", "answer_invalid_every=4;stall=xrWaitFrame;stall_ms=160;stall_every=5", "--frames 80");
  const auto& frames = run.walk.frames;
  const auto shown = static_cast<std::size_t>(std::ranges::count_if(run.ended, [](auto& f) { return f.layers > 0; }));
  EXPECT_GT(count(frames, PoseAnswer::kMeasured), 5u);
  EXPECT_GT(count(frames, PoseAnswer::kTooLate), 2u);
  EXPECT_GT(count(frames, PoseAnswer::kRefused), 2u);
  EXPECT_EQ(frames.size() - count(frames, PoseAnswer::kNone), shown);
  for (const FrameRecord& frame : frames) {
    EXPECT_EQ(frame.pose_answer == PoseAnswer::kMeasured, frame.pose_error_mm >= 0.0);
  }
  const auto& answers = run.walk.summary["pose_answers"];
  EXPECT_GT(answers["too_late"].get<int>(), 0);
  EXPECT_GT(answers["refused"].get<int>(), 0);
}

TEST(OpenXrTiming, AFrameIsAskedAboutOnceAndAStallBringsNoHeapOfQuestions) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const LayerWalk run = walk_behind_layer("questions", "stall=xrWaitFrame;stall_ms=60;stall_every=4", "--frames 60");
  std::size_t asked = 0;
  for (const EndedFrame& frame : run.ended) {
    EXPECT_LE(frame.asked, 2);
    asked += static_cast<std::size_t>(frame.asked);
  }
  const std::size_t answered =
      count(run.walk.frames, PoseAnswer::kMeasured) + count(run.walk.frames, PoseAnswer::kRefused);
  EXPECT_GT(asked, 5u);  // a busy machine asks too late of many frames, and says so
  EXPECT_LE(asked, answered);
  EXPECT_GE(asked + 2, answered) << "those after the last xrEndFrame";
  std::vector<double> took_ms;
  for (const FrameRecord& frame : run.walk.frames) took_ms.push_back(ms(frame.ledger.end - frame.ledger.begin));
  std::printf("  %zu questions about %zu frames; the ledger took %.3f ms after a frame at the median\n", asked,
              run.walk.frames.size(), median(took_ms));
}

TEST(OpenXrTiming, NobodyAsksForPosesThatNoReportTellsOf) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("openxr-timing-unasked");
  const MonadoWalk walk =
      walk_in_monado(folder,
                     "export XR_ENABLE_API_LAYERS=XR_APILAYER_PROBEWALK_known_motion XR_API_LAYER_PATH='" +
                         std::string(PROBEWALK_TEST_LAYER_MANIFESTS) + "' PROBEWALK_TEST_LAYER=\"log=$PWD/layer.csv\"",
                     "--frames 30", Report::kNone);
  ASSERT_EQ(walk.run.exit_code, 0) << walk.run.err;
  const std::vector<EndedFrame> ended = read_layer_log(folder / "layer.csv");
  EXPECT_GE(ended.size(), 30u);
  for (const EndedFrame& frame : ended) EXPECT_EQ(frame.asked, 0);
}

TEST(OpenXrTiming, AFrameWithoutALatePoseIsShownWithTheEarlyOneAndSaysSo) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const LayerWalk run = walk_behind_layer("late-invalid", "error_mm_per_ms=0.5;late_invalid_every=7", "--frames 35");
  ASSERT_EQ(run.walk.frames.size(), 35u);
  std::size_t early = 0;
  for (std::size_t i = 0; i < 35; ++i) {
    const FrameRecord& frame = run.walk.frames[i];
    if (!frame.should_render) continue;
    EXPECT_EQ(frame.early_pose, (i + 1) % 7 == 0) << i;
    EXPECT_EQ(run.ended[i].layers, 1) << i;
    if (frame.early_pose) {
      // The layer works each out of its own sums of floats, a few micrometres apart at most.
      EXPECT_NEAR(run.ended[i].late_mm, run.ended[i].early_mm, 0.005) << i;
    }
    early += frame.early_pose ? 1 : 0;
  }
  EXPECT_GE(early, 4u);
  EXPECT_GE(run.walk.summary["early_pose_frames"].get<std::size_t>(), early - 1);
}

TEST(OpenXrTiming, ATimeThatTheRuntimeDisownsCostsThatFrameAlone) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const LayerWalk run = walk_behind_layer("time-invalid", "time_invalid_every=6", "--frames 36");
  ASSERT_EQ(run.walk.frames.size(), 36u);
  for (std::size_t i = 6; i < 36; ++i) {
    EXPECT_EQ(run.walk.frames[i].should_render, (i + 1) % 6 != 0) << i;
    EXPECT_EQ(run.ended[i].layers, (i + 1) % 6 != 0 ? 1 : 0) << i;
  }
  EXPECT_THAT(run.walk.run.err, HasSubstr("no pose for a time of its own"));
}

// The runtime's calls take their time, one after the other: each is found to have, by as much, and is named.
TEST(OpenXrTiming, AStallOfTheRuntimeIsFoundInTheCallThatStalled) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  constexpr std::size_t kEvery = 6;
  const std::vector<std::pair<std::string, std::string>> calls{{"xrWaitFrame", "wait"},
                                                               {"xrBeginFrame", "begin"},
                                                               {"xrLocateViews", "locate_early"},
                                                               {"xrWaitSwapchainImage", "blocked"},
                                                               {"xrEndFrame", "end"}};
  std::string names;
  for (const auto& [call, stage] : calls) names += (names.empty() ? "" : ",") + call;
  const LayerWalk run = walk_behind_layer("stalls", "stall_ms=160;stall_every=6;stall=" + names, "--frames 190");
  const auto& frames = run.walk.frames;
  ASSERT_EQ(frames.size(), 190u);
  const std::vector<WorstFrame> worst = worst_frames(frames, 3, true, frames.size());
  const auto length = [](const Interval& interval) { return ms(interval.end - interval.begin); };
  const auto took_ms = [&](std::size_t i, const std::string& stage) {
    const FrameRecord& frame = frames[i];
    return stage == "wait"           ? length(frame.wait)
           : stage == "begin"        ? length(frame.begin)
           : stage == "locate_early" ? length(frame.locate_early)
           : stage == "blocked"      ? ms(frame.blocked_ns)
                                     : length(frame.end);
  };
  std::printf("  %-22s %9s %10s %10s  %s\n", "call", "stalled", "found", "noise", "cause named");
  for (std::size_t k = 0; k < calls.size(); ++k) {
    const auto& [call, stage] = calls[k];
    std::vector<double> usual, found, wrong, noise, injected;
    for (std::size_t i = 6; i < frames.size(); ++i) {
      if ((i + 1) % kEvery >= 3) usual.push_back(took_ms(i, stage));
    }
    for (const double each : usual) noise.push_back(std::abs(each - median(usual)));
    std::size_t named = 0;
    std::string cause;
    for (std::size_t i = 6; i + 1 < frames.size(); ++i) {
      if ((i + 1) % kEvery != 0 || ((i + 1) / kEvery - 1) % calls.size() != k) continue;
      injected.push_back(run.ended[i].stalled_ms);
      found.push_back(took_ms(i, stage) - median(usual));
      wrong.push_back(found.back() - injected.back());
      // A wait ends the interval that the frame before began.
      const auto entry = std::ranges::find(worst, stage == "wait" ? i : i + 1, &WorstFrame::index);
      ASSERT_NE(entry, worst.end());
      if (entry->stage == stage) {
        ++named;
        cause = entry->cause;
      }
    }
    std::ranges::sort(noise);
    const double noise_ms = noise[noise.size() * 9 / 10];
    std::printf("  %-22s %6.1f ms %7.1f ms %7.2f ms  %zu of %zu: %s\n", call.c_str(), median(injected), median(found),
                noise_ms, named, found.size(), cause.c_str());
    EXPECT_GE(median(injected), 160.0) << call;
    // A wait is what the runtime makes of the time left, so that it gives back a part of what it takes longer.
    EXPECT_NEAR(median(wrong), 0.0, stage == "wait" ? 80.0 + noise_ms : 1.0 + 1.5 * noise_ms) << call;
    EXPECT_GE(named + 1, found.size()) << call;
    EXPECT_GE(found.size(), 3u);
  }
}

TEST(OpenXrTiming, TheNextFrameIsWaitedForWhileOneIsDrawnUnlessToldNotTo) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  for (const bool ahead : {true, false}) {
    const LayerWalk run =
        walk_behind_layer(ahead ? "ahead" : "not-ahead", "stall=xrWaitSwapchainImage;stall_every=1;stall_ms=20",
                          std::string("--frames 60") + (ahead ? "" : " --no-wait-ahead"));
    const auto& frames = run.walk.frames;
    ASSERT_EQ(frames.size(), 60u);
    std::size_t overlapping = 0;
    for (std::size_t i = 1; i < frames.size(); ++i) {
      const FrameRecord &before = frames[i - 1], &frame = frames[i];
      EXPECT_GE(frame.runtime_wait.begin, before.begin.end) << i << ": OpenXR allows it no sooner";
      if (ahead) {
        overlapping += frame.runtime_wait.begin < before.end.begin ? 1 : 0;
      } else {
        EXPECT_GE(frame.runtime_wait.begin, before.end.end) << i;
      }
      EXPECT_GE(frame.wait.begin, before.end.end) << i;
      EXPECT_GE(frame.wait.end, frame.runtime_wait.end) << i;
      EXPECT_GT(frame.predicted_display, before.predicted_display) << i;
    }
    if (ahead) {
      EXPECT_GT(overlapping, 50u) << "a busy machine wakes the thread that waits late now and then";
    }
    const double length_ms = ms(frames.back().wait.end - frames[10].wait.end);
    std::printf("  waited for %s: %.1f frames/s, %d refreshes missed\n", ahead ? "ahead" : "after the end",
                1e3 * static_cast<double>(frames.size() - 11) / length_ms, run.walk.summary["missed"].get<int>());
  }
}

// The layer moves the origin of our space by a metre, then announces that another space will move in an hour.
TEST(OpenXrTiming, TheViewStaysWhereItIsWhenItsOwnSpaceJumps) {
  if (!has_monado()) GTEST_SKIP() << "monado-service is not installed";
  const LayerWalk run = walk_behind_layer("jump", "jump_at_frame=15", "--frames 40 --record walked.jsonl");
  EXPECT_THAT(run.walk.run.err, HasSubstr("space LOCAL_FLOOR"));
  const Path path = read_path(fs::path(PROBEWALK_TEST_OUTPUT_DIR) / "tools" / "openxr-timing-jump" / "walked.jsonl");
  ASSERT_GT(path.poses.size(), 30u);
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    const double dt_s = path.poses[i].t_s - path.poses[i - 1].t_s;
    EXPECT_LT(glm::distance(path.poses[i].position_m, path.poses[i - 1].position_m), 0.01 + 0.6 * dt_s) << i;
  }
}

}  // namespace
}  // namespace probewalk::test
