#include "xr/latency/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "xr/latency/synthetic_run.h"

namespace probewalk {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Course {
  double gpu_scale = 1.0;
  double coarse = 0.0;  // share of frames
  bool has_deadlines = true;
};

using Runs = std::vector<Run>;

Run walked(std::uint64_t seed, const Course& course = {}) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  LedgerOptions options{.warmup_frames = 20, .has_deadlines = course.has_deadlines};
  Run run{"run", {}, Ledger(options)};
  run.info.pack = "house.probes";
  run.info.method = "octant-affine";
  run.info.device.name = "a device";
  run.info.command = "probewalk walk house.probes --report r" + std::to_string(seed);
  for (std::size_t i = 0; i < 1200; ++i) {
    FrameRecord f = synthetic_frame(i);
    const auto gpu_ns = static_cast<std::int64_t>(4e6 * course.gpu_scale * std::exp(0.05 * normal(random)));
    f.gpu.end = f.gpu.begin + gpu_ns;
    f.gpu_trace.end = f.gpu.begin + gpu_ns * 3 / 4;
    f.gpu_resolve = {f.gpu_trace.end, f.gpu.end};
    f.end.end += static_cast<std::int64_t>(1e5 * std::abs(normal(random)));
    f.level_shown = uniform(random) < course.coarse ? 0 : 1;
    run.ledger.add(f);
  }
  return run;
}

const ComparedValue& value_of(const std::vector<ComparedValue>& values, const std::string& name,
                              const std::string& statistic) {
  for (const ComparedValue& value : values) {
    if (value.name == name && value.statistic == statistic) return value;
  }
  throw std::out_of_range(name + " " + statistic);
}

Comparison of_two(const Runs& runs) {
  return compare_runs(runs, {{"before", {0}}, {"after", {1}}});
}

TEST(Comparison, JudgesEachQuantityByItself) {
  const Comparison comparison = of_two({walked(1), walked(2, {.gpu_scale = 1.08})});
  ASSERT_EQ(comparison.others.size(), 1u);
  const GroupComparison& pair = comparison.others[0];
  for (const char* statistic : {"p50", "p90", "p95"}) {
    EXPECT_EQ(verdict_words(value_of(pair.times, "gpu_busy", statistic)), "slower") << statistic;
    EXPECT_EQ(verdict_words(value_of(pair.times, "cpu_busy", statistic)), "no change") << statistic;
    EXPECT_EQ(verdict_words(value_of(pair.times, "frame", statistic)), "no change") << statistic;
  }
  EXPECT_EQ(verdict_words(value_of(pair.times, "gpu_busy", "p999")), "too few frames");
  // 8 % of 4 ms less margin, of a period of 10 ms.
  EXPECT_EQ(verdict_words(value_of(pair.times, "deadline_margin", "p50")), "worse");
  EXPECT_NEAR(value_of(pair.times, "deadline_margin", "p50").change.value, -0.32e6, 0.05e6);
  EXPECT_LT(value_of(pair.times, "deadline_margin", "p5").change.base,
            value_of(pair.times, "deadline_margin", "p50").change.base);
  EXPECT_EQ(verdict_words(value_of(pair.quality, "pose_error_mm", "p50")), "not measured");
  EXPECT_EQ(verdict_words(value_of(pair.quality, "missed", "mean")), "no change");
  EXPECT_THAT(pair.paid_with, IsEmpty());
  EXPECT_FALSE(pair.repeats);
}

TEST(Comparison, WithoutDeadlinesTheirQuantitiesDoNotExist) {
  const Comparison comparison =
      of_two({walked(1, {.has_deadlines = false}), walked(2, {.gpu_scale = 0.9, .has_deadlines = false})});
  const GroupComparison& pair = comparison.others[0];
  EXPECT_EQ(verdict_words(value_of(pair.times, "gpu_busy", "p50")), "faster");
  EXPECT_EQ(value_of(pair.times, "prediction_horizon", "p50").verdict, Verdict::kAbsent);
  EXPECT_EQ(value_of(pair.quality, "missed", "mean").verdict, Verdict::kAbsent);
}

TEST(Comparison, SaysWhatTimeWasPaidWith) {
  const Comparison coarser = of_two({walked(1), walked(2, {.gpu_scale = 0.9, .coarse = 0.2})});
  EXPECT_THAT(coarser.others[0].paid_with,
              ElementsAre(testing::AllOf(HasSubstr("gpu_"), HasSubstr("% faster, but frames shown coarse went from "
                                                                      "0.00 % to"))));
  Runs foveated{walked(1), walked(2, {.gpu_scale = 0.9})};
  foveated[1].info.foveation = "medium";
  EXPECT_THAT(of_two(foveated).others[0].paid_with,
              ElementsAre(HasSubstr("before and after do not draw the same picture (foveation differ")));
  Runs eyes{walked(1), walked(2, {.gpu_scale = 0.9})};
  eyes[1].info.second_eye = "from-first";
  EXPECT_THAT(of_two(eyes).others[0].paid_with,
              ElementsAre(HasSubstr("before and after do not draw the same picture (second eye differ")));
  // Coarse, and no faster: nothing was bought.
  EXPECT_THAT(of_two({walked(1), walked(2, {.coarse = 0.2})}).others[0].paid_with, IsEmpty());
  const Comparison slower = of_two({walked(1), walked(2, {.coarse = 0.2})});
  EXPECT_EQ(verdict_words(value_of(slower.others[0].quality, "coarse", "mean")), "worse");
}

TEST(Comparison, NamesWhatRunsDoNotAgreeOn) {
  Runs runs{walked(1), walked(2), walked(3)};
  const auto compared = [&] { return compare_runs(runs, {{"a", {0, 1}}, {"b", {2}}}).disagreements; };
  EXPECT_THAT(compared(), IsEmpty());
  runs[2].info.device.name = "another device";
  runs[1].info.eye_width = 640;
  runs[2].info.command += " --seconds 9";
  const auto disagreements = compared();
  ASSERT_EQ(disagreements.size(), 3u);
  EXPECT_EQ(disagreements[0].what, "views and eye size");
  EXPECT_TRUE(disagreements[0].within_group);
  EXPECT_TRUE(disagreements[0].changes_picture);
  EXPECT_EQ(disagreements[1].what, "device");
  EXPECT_FALSE(disagreements[1].within_group);
  EXPECT_THAT(disagreements[1].values, ElementsAre("a device", "a device", "another device"));
  EXPECT_EQ(disagreements[2].what, "command");
  EXPECT_TRUE(disagreements[2].expected);
}

std::vector<std::pair<std::string, std::vector<std::size_t>>> grouped(const std::vector<std::string>& directories) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> pairs;
  for (const RunGroup& group : group_by_name(directories)) pairs.emplace_back(group.name, group.runs);
  return pairs;
}

TEST(Groups, AreRunsWhoseNamesDifferInANumberAtTheirEnd) {
  using Indices = std::vector<std::size_t>;
  using testing::Pair;
  EXPECT_THAT(grouped({"/r/before-1", "/r/before-2/", "/r/after-1", "/r/after-10"}),
              ElementsAre(Pair("before", Indices{0, 1}), Pair("after", Indices{2, 3})));
  EXPECT_THAT(grouped({"/r/b/1", "/r/a/1", "/r/b/2"}), ElementsAre(Pair("b", Indices{0, 2}), Pair("a", Indices{1})));
  // Runs of one name only are compared with each other.
  EXPECT_THAT(grouped({"/r/run1", "/r/run2"}), ElementsAre(Pair("run1", Indices{0}), Pair("run2", Indices{1})));
  // Equal names in different places are told apart.
  EXPECT_THAT(grouped({"/before/report", "/after/report"}),
              ElementsAre(Pair("before/report", Indices{0}), Pair("after/report", Indices{1})));
  EXPECT_THAT(grouped({"/r/alone"}), ElementsAre(Pair("alone", Indices{0})));
}

TEST(Groups, CommandsAreComparedWithoutWhereTheyWrote) {
  EXPECT_EQ(without_report_folder("probewalk walk 'my house.probes' --report 'a b' --frames 9"),
            "probewalk walk 'my house.probes' --frames 9");
  EXPECT_EQ(without_report_folder("probewalk walk h --report=x"), "probewalk walk h");
  EXPECT_EQ(without_report_folder("probewalk walk h --report"), "probewalk walk h");
}

}  // namespace
}  // namespace probewalk
