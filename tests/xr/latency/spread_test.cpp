#include "xr/latency/spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace probewalk {
namespace {

constexpr double kShares[] = {0.5, 0.9, 0.95, 0.99};

struct Shape {
  std::size_t frames = 1500;
  double hang_together = 0.0;  // how much of a frame's deviation the next one inherits
  double way = 0.0;            // how much the path's places differ, the same in every run
  double from_run_to_run = 0.0;
  double hitches = 0.01;  // share of frames that take three times as long
  double scale = 1.0;
  std::size_t runs = 1;
};

Side invented(const Shape& shape, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  Side side;
  for (std::size_t r = 0; r < shape.runs; ++r) {
    const double of_run = shape.from_run_to_run * normal(random);
    double deviation = normal(random);
    Series run;
    for (std::size_t i = 0; i < shape.frames; ++i) {
      const double position = static_cast<double>(i) / static_cast<double>(shape.frames);
      deviation =
          shape.hang_together * deviation + std::sqrt(1.0 - shape.hang_together * shape.hang_together) * normal(random);
      const double place = shape.way * std::sin(9.0 * position);
      const double hitch = uniform(random) < shape.hitches ? 3.0 : 1.0;
      run.values.push_back(shape.scale * 8e6 * hitch * std::exp(0.08 * deviation + place + of_run));
      run.positions.push_back(position);
    }
    side.push_back(std::move(run));
  }
  return side;
}

// How many of the seeds call a change, and how many a rise, for each of kShares.
struct Calls {
  std::array<std::size_t, std::size(kShares)> change{}, rise{}, judged{};
};
Calls calls(const Shape& base, const Shape& other, std::size_t seeds) {
  Calls calls;
  for (std::size_t seed = 0; seed < seeds; ++seed) {
    const auto changes = percentile_changes(invented(base, 2 * seed + 1), invented(other, 2 * seed + 2), kShares, true);
    for (std::size_t k = 0; k < changes.size(); ++k) {
      if (!changes[k].enough) continue;
      ++calls.judged[k];
      calls.rise[k] += changes[k].low > 1.0 ? 1 : 0;
      calls.change[k] += changes[k].low > 1.0 || changes[k].high < 1.0 ? 1 : 0;
    }
  }
  return calls;
}

void expect_quiet(const Shape& shape, const char* what) {
  constexpr std::size_t kSeeds = 60;
  const Calls found = calls(shape, shape, kSeeds);
  for (std::size_t k = 0; k < std::size(kShares); ++k) {
    EXPECT_LE(found.change[k], kSeeds / 20) << what << ", p = " << kShares[k];
    EXPECT_EQ(found.judged[k], kSeeds) << what << ", p = " << kShares[k];
    testing::Test::RecordProperty(std::string(what) + ", false alarms of 60 at p" + std::to_string(kShares[k]),
                                  static_cast<int>(found.change[k]));
  }
}

TEST(Spread, CallsNoiseNoChange) {
  expect_quiet({}, "independent frames");
  expect_quiet({.hang_together = 0.9}, "frames that hang together");
  expect_quiet({.way = 0.3}, "a way of dear and cheap places");
  expect_quiet({.hang_together = 0.7, .way = 0.3, .hitches = 0.02}, "all of it");
  expect_quiet({.frames = 600, .from_run_to_run = 0.05, .runs = 3}, "runs that differ as a whole");
  expect_quiet({.frames = 600, .hang_together = 0.7, .way = 0.2, .from_run_to_run = 0.03, .runs = 2}, "two repeats");
}

TEST(Spread, FindsAShiftOfFivePercent) {
  constexpr std::size_t kSeeds = 25;
  const Calls independent = calls({}, {.scale = 1.05}, kSeeds);
  EXPECT_GE(independent.rise[0], kSeeds * 95 / 100);
  EXPECT_GE(independent.rise[1], kSeeds * 95 / 100);
  EXPECT_GE(independent.rise[2], kSeeds * 90 / 100);
  const Calls on_a_way = calls({.way = 0.3}, {.way = 0.3, .scale = 1.05}, kSeeds);
  EXPECT_GE(on_a_way.rise[0], kSeeds * 95 / 100);
  const Calls repeated =
      calls({.from_run_to_run = 0.01, .runs = 4}, {.from_run_to_run = 0.01, .scale = 1.05, .runs = 4}, kSeeds);
  EXPECT_GE(repeated.rise[0], kSeeds * 90 / 100);
  for (const Calls& found : {independent, on_a_way, repeated}) {
    for (std::size_t k = 0; k < std::size(kShares); ++k) EXPECT_LE(found.change[k] - found.rise[k], 1u) << k;
  }
}

TEST(Spread, FindsAShiftOfTenPercentWhereFramesHangTogether) {
  constexpr std::size_t kSeeds = 25;
  const Calls found =
      calls({.frames = 3000, .hang_together = 0.8}, {.frames = 3000, .hang_together = 0.8, .scale = 1.1}, kSeeds);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_GE(found.rise[k], kSeeds * 95 / 100) << k;
}

TEST(Spread, SingleRunsThatDifferAsAWholeNeedRepeats) {
  // What blocks cannot know is known from repeats: 5 % from run to run, and nothing changed.
  constexpr std::size_t kSeeds = 25;
  const Calls alone = calls({.from_run_to_run = 0.05}, {.from_run_to_run = 0.05}, kSeeds);
  const Calls repeated = calls({.frames = 500, .from_run_to_run = 0.05, .runs = 3},
                               {.frames = 500, .from_run_to_run = 0.05, .runs = 3}, kSeeds);
  EXPECT_GT(alone.change[0], kSeeds / 2);
  EXPECT_LE(repeated.change[0], kSeeds / 20);
}

TEST(Spread, RepeatsOfOneSideServeASingleRunOfTheOther) {
  const auto changes = percentile_changes(invented({.from_run_to_run = 0.05, .runs = 4}, 1),
                                          invented({.from_run_to_run = 0.05}, 2), kShares, true);
  EXPECT_TRUE(changes[0].between_runs);
  EXPECT_LT(changes[0].low, 0.92);
  EXPECT_GT(changes[0].high, 1.08);
  EXPECT_FALSE(percentile_changes(invented({}, 1), invented({}, 2), kShares, true)[0].between_runs);
}

TEST(Spread, SaysWhenFramesAreTooFew) {
  const double shares[] = {0.5, 0.99, 0.999};
  const auto few = percentile_changes(invented({.frames = 40}, 1), invented({.frames = 40}, 2), shares, true);
  EXPECT_TRUE(few[0].enough);
  EXPECT_FALSE(few[1].enough);
  EXPECT_FALSE(few[2].enough);
  const auto fewest = percentile_changes(invented({.frames = 7}, 1), invented({.frames = 7}, 2), shares, true);
  EXPECT_TRUE(fewest[0].exists);
  EXPECT_FALSE(fewest[0].enough);
  const auto more = percentile_changes(invented({.frames = 400}, 1), invented({.frames = 2000}, 2), shares, true);
  EXPECT_TRUE(more[0].enough);
  EXPECT_FALSE(more[1].enough);  // four frames of 400 lie beyond p99
  const auto most = percentile_changes(invented({.frames = 2000}, 1), invented({.frames = 2000}, 2), shares, true);
  EXPECT_TRUE(most[1].enough);
  EXPECT_FALSE(most[2].enough);

  // All that is slow came at once: one such event says nothing about the next.
  Side lump = invented({.frames = 1000, .hitches = 0.0}, 1);
  for (std::size_t i = 500; i < 512; ++i) lump[0].values[i] *= 5.0;
  EXPECT_FALSE(percentile_changes(lump, invented({.frames = 1000}, 2), shares, true)[1].enough);

  const auto none = percentile_changes({}, invented({}, 1), shares, true);
  EXPECT_FALSE(none[0].exists);
  EXPECT_EQ(none[0].other_n, 1500u);
}

TEST(Spread, ValuesAreThoseOfAllFramesTogether) {
  Series low, high;
  for (int i = 1; i <= 100; ++i) {
    low.values.push_back(i);
    high.values.push_back(100 + i);
    low.positions.push_back(i / 101.0);
    high.positions.push_back(i / 101.0);
  }
  const double shares[] = {0.5, 0.95};
  const auto changes = percentile_changes({low, high}, {high}, shares, true);
  EXPECT_EQ(changes[0].base, 100.0);  // of 1 .. 200; the mean of the two medians would be 100.5
  EXPECT_EQ(changes[0].other, 150.0);
  EXPECT_EQ(changes[1].base, 190.0);
  EXPECT_DOUBLE_EQ(changes[0].value, 1.5);
  EXPECT_EQ(changes[0].base_n, 200u);
}

TEST(Spread, ComparesDifferencesWhereValuesPassThroughNought) {
  Side base = invented({}, 3), other = invented({}, 4);
  for (Side* side : {&base, &other}) {
    for (double& value : (*side)[0].values) value = 8e6 - value;
  }
  for (double& value : other[0].values) value += 2e6;
  const Change change = percentile_changes(base, other, kShares, true)[0];
  EXPECT_FALSE(change.is_ratio);
  EXPECT_NEAR(change.value, 2e6, 1e5);
  EXPECT_GT(change.low, 1e6);
  EXPECT_LT(change.high, 3e6);
}

TEST(Spread, FindsRatesThatRoseAndCallsEqualOnesNoChange) {
  const auto rate = [](double p, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform;
    Series run;
    for (std::size_t i = 0; i < 2000; ++i) {
      run.values.push_back(uniform(random) < p ? 1.0 : 0.0);
      run.positions.push_back(static_cast<double>(i) / 2000.0);
    }
    return Side{run};
  };
  std::size_t false_alarms = 0, found = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Change same = mean_change(rate(0.02, 2 * seed), rate(0.02, 2 * seed + 1));
    const Change more = mean_change(rate(0.02, 2 * seed), rate(0.05, 2 * seed + 1));
    false_alarms += same.low > 0.0 || same.high < 0.0 ? 1 : 0;
    found += more.low > 0.0 ? 1 : 0;
  }
  EXPECT_LE(false_alarms, 5u);
  EXPECT_GE(found, 95u);
  const Change nothing = mean_change(rate(0.0, 1), rate(0.0, 2));
  EXPECT_EQ(nothing.low, 0.0);
  EXPECT_EQ(nothing.high, 0.0);
}

}  // namespace
}  // namespace probewalk
