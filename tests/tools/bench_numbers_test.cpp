// What `probewalk bench` makes of its measurements, without a device: medians, fronts, equal error, aims, views, rows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "tools/probewalk/bench/bench_row.h"
#include "tools/probewalk/bench/bench_views.h"
#include "tools/probewalk/bench/equal_error.h"
#include "tools/probewalk/bench/page_text.h"
#include "tools/probewalk/bench/settings.h"
#include "tools/probewalk/bench/statistics.h"

namespace probewalk::bench {
namespace {

TEST(BenchNumbers, MedianAndSpreadIgnoreOneOutlier) {
  EXPECT_DOUBLE_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_DOUBLE_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_DOUBLE_EQ(median({5.0}), 5.0);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 3.0, 4.0, 5.0}, 0.25), 2.0);
  EXPECT_DOUBLE_EQ(spread({1.0, 2.0, 3.0, 4.0, 5.0}), 2.0);
  EXPECT_DOUBLE_EQ(spread({1.0, 2.0, 3.0, 4.0, 5000.0}), 2.0);
  EXPECT_DOUBLE_EQ(spread({7.0}), 0.0);
}

TEST(BenchNumbers, PercentilesAreValuesThatOccur) {
  const std::vector<float> values{1.0f, 2.0f, 3.0f, 4.0f};
  EXPECT_DOUBLE_EQ(percentile_of_sorted(values, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(percentile_of_sorted(values, 0.51), 3.0);
  EXPECT_DOUBLE_EQ(percentile_of_sorted(values, 0.99), 4.0);
  EXPECT_DOUBLE_EQ(percentile_of_sorted(values, 0.0), 1.0);
}

TEST(BenchNumbers, TheFrontLeavesOutWhatIsBeaten) {
  const std::vector<CostError> points{{4.0, 0.1}, {1.0, 1.0}, {2.0, 1.0}, {2.0, 0.5}, {3.0, 0.6}};
  EXPECT_EQ(pareto_front(points), (std::vector<std::size_t>{1, 3, 0}));
  EXPECT_TRUE(pareto_front({}).empty());
  // Of two alike one is enough.
  EXPECT_EQ(pareto_front(std::vector<CostError>{{1.0, 1.0}, {1.0, 1.0}}).size(), 1u);
}

TEST(BenchNumbers, CostAtAnErrorLiesBetweenMeasuredSizesAndNeverBeyond) {
  // Cost doubles while the error falls by 4: half way in the logarithm is sqrt(2) of the cost at half the error.
  const std::vector<CostError> points{{10.0, 0.4}, {20.0, 0.1}, {40.0, 0.025}};
  EXPECT_NEAR(cost_at_error(points, 0.1).value(), 20.0, 1e-9);
  EXPECT_NEAR(cost_at_error(points, 0.2).value(), 10.0 * std::numbers::sqrt2, 1e-9);
  EXPECT_NEAR(cost_at_error(points, 0.05).value(), 20.0 * std::numbers::sqrt2, 1e-9);
  EXPECT_DOUBLE_EQ(cost_at_error(points, 1.0).value(), 10.0);  // the cheapest is better than asked for
  EXPECT_FALSE(cost_at_error(points, 0.02).has_value());
  EXPECT_FALSE(cost_at_error({}, 1.0).has_value());
  // A dearer size that is worse plays no part.
  EXPECT_NEAR(cost_at_error(std::vector<CostError>{{10.0, 0.4}, {15.0, 0.9}, {20.0, 0.1}}, 0.2).value(), 10.0 * std::numbers::sqrt2, 1e-9);
}

BenchRow row(const std::string& method, const std::string& settings, int size, double time, double median_error, double failed) {
  BenchRow r;
  r.scene = "test";
  r.method = method;
  r.settings = settings;
  r.resolution = size;
  r.time_ratio = time;
  r.ns_per_ray_median = 100.0 * time;
  r.hit_error_p50 = median_error;
  r.wrong_surface_fraction = failed;
  r.probes_mean = 1.1;
  r.lookups_mean = 9.0;
  return r;
}

SceneReport report() {
  SceneReport scene;
  scene.name = "test";
  scene.resolution = 512;
  scene.has_truth = true;
  scene.rows = {row("oat", "default", 512, 1.0, 1e-7, 0.002), row("oat", "resolution 256", 256, 0.8, 1.2e-7, 0.01),
                row("two-level", "maps 512", 512, 0.9, 2e-3, 0.04), row("two-level", "maps 1024", 1024, 2.4, 1e-3, 0.02),
                row("march-2d", "maps 512", 512, 3.0, 2e-3, 0.01), row("march-2d", "maps 1024", 1024, 6.0, 1e-3, 0.001)};
  return scene;
}

TEST(BenchNumbers, EqualErrorTakesTheMarchesOwnBestWhereItNeverGetsAsGood) {
  const auto all = equal_errors(report().rows);
  ASSERT_EQ(all.size(), 4u);  // two marches by two errors
  for (const EqualError& equal : all) {
    if (equal.march == "two-level" && equal.by == EqualBy::kFailed) {
      EXPECT_FALSE(equal.reached);
      EXPECT_DOUBLE_EQ(equal.error, 0.02);
      EXPECT_EQ(equal.march_size, 1024);
      EXPECT_NEAR(equal.speed_ratio, 2.4 / 0.8, 1e-9);  // the small level of oat is good enough for that
    }
    if (equal.march == "march-2d" && equal.by == EqualBy::kFailed) {
      EXPECT_TRUE(equal.reached);
      EXPECT_DOUBLE_EQ(equal.error, 0.002);
      // Between 3 at 1 % and 6 at 0.1 %: log(5) / log(10) of the way.
      EXPECT_NEAR(equal.speed_ratio, 3.0 * std::pow(2.0, std::log(5.0) / std::log(10.0)), 1e-9);
    }
    if (equal.by == EqualBy::kMedian) {
      EXPECT_FALSE(equal.reached);
    }
  }
  const auto best = best_march(all, EqualBy::kFailed);
  ASSERT_TRUE(best.has_value());
  EXPECT_EQ(best->march, "march-2d");  // it alone gets as good
}

TEST(BenchNumbers, AimsAreJudgedByWhatWasMeasured) {
  SceneReport scene = report();
  const auto find = [](const std::vector<Goal>& goals, const std::string& words) {
    for (const Goal& goal : goals) {
      if (goal.aim.find(words) != std::string::npos) return goal;
    }
    return Goal{};
  };
  std::vector<Goal> goals = goals_of(scene);
  EXPECT_EQ(find(goals, "equal wrong + hole").verdict, Verdict::kReached);        // 4.87 times
  EXPECT_EQ(find(goals, "equal median").verdict, Verdict::kNotReached);           // 3 times
  EXPECT_EQ(find(goals, "look-ups").verdict, Verdict::kNotMeasured);              // there is no level of 1024
  EXPECT_EQ(find(goals, "at equal resolution").verdict, Verdict::kReached);       // 0.2 % of 4 %
  scene.rows[0].wrong_surface_fraction = 0.03;
  EXPECT_EQ(find(goals_of(scene), "at equal resolution").verdict, Verdict::kNotReached);
  scene.rows[0].probes_mean = 1.5;
  goals = goals_of(scene);
  EXPECT_TRUE(is_clutter(scene));
  EXPECT_EQ(find(goals, "probes tried").verdict, Verdict::kNotReached);
  EXPECT_EQ(find(goals, "look-ups").aim, "");
  scene.has_truth = false;
  for (BenchRow& r : scene.rows) r.hit_error_p50 = r.wrong_surface_fraction = std::nullopt;
  EXPECT_EQ(find(goals_of(scene), "equal median").verdict, Verdict::kNotMeasured);
}

TEST(BenchNumbers, AFasterMethodThatErrsMoreIsToldSo) {
  const SceneReport scene = report();
  const std::string words = beside_product(scene.rows[2], scene.rows[0]);
  EXPECT_EQ(words, "1.1 times as fast as oat, but worse: wrong + hole 20 times as large, median error over 1000 times as large");
  EXPECT_EQ(beside_product(scene.rows[0], scene.rows[0]), "the product as it ships");
  EXPECT_EQ(beside_product(row("march-2d", "maps 512", 512, 3.0, 1e-7, 0.002), scene.rows[0]),
            "takes 3.0 times as long as oat; wrong + hole the same, median error the same");
}

TEST(BenchNumbers, PicturesAreAsDenseAsAHeadset) {
  for (const double density : {10.0, 20.0, 35.0}) {
    for (const int height : {32, 240, 1000}) {
      const double fov = fov_at_density(height, density);
      EXPECT_NEAR(density_of({320, height, fov}), density, 1e-9);
      EXPECT_LT(fov, std::numbers::pi);
    }
  }
}

TEST(BenchNumbers, TheProductComesFirstAndOnce) {
  const SettingsRequest all{{256, 512}, all_method_names(), {512, 1024}, true, true};
  const std::vector<Setting> settings = settings_for(all);
  EXPECT_EQ(settings.front().method, "oat");
  EXPECT_EQ(settings.front().settings, kDefaultSettings);
  EXPECT_EQ(settings.front().level, 1u);
  std::set<std::string> names;
  for (const Setting& s : settings) {
    EXPECT_TRUE(names.insert(s.method + "/" + s.settings).second) << s.method << " " << s.settings;
    EXPECT_EQ(s.maps > 0, needs_maps(s.method));
  }
  // Every method asked for is there, and both sides of every acceleration.
  for (const std::string& name : all_method_names()) {
    EXPECT_TRUE(std::any_of(settings.begin(), settings.end(), [&](const Setting& s) { return s.method == name; })) << name;
  }
  for (const Acceleration& a : accelerations()) {
    for (const auto& [method, words] : {std::pair(a.method_without, a.settings_without), std::pair(a.method_with, a.settings_with)}) {
      EXPECT_TRUE(std::any_of(settings.begin(), settings.end(), [&](const Setting& s) {
        return s.method == method && (words.empty() || s.settings == words);
      })) << a.name << ": " << method << " " << words;
    }
  }
  // Without a scene nothing that needs its maps.
  SettingsRequest bare = all;
  bare.maps_possible = false;
  for (const Setting& s : settings_for(bare)) EXPECT_FALSE(needs_maps(s.method)) << s.method;
}

TEST(BenchNumbers, WhatWasNotMeasuredIsNullAndAnEmptyField) {
  BenchRow r;
  r.scene = "a, \"quoted\" name";
  r.method = "oat";
  r.psnr_db = std::numeric_limits<double>::infinity();
  const auto json = nlohmann::ordered_json::parse(rows_json(std::span(&r, 1)));
  EXPECT_TRUE(json[0]["hit_error_p50"].is_null());
  EXPECT_TRUE(json[0]["psnr_db"].is_null());
  const std::string csv = rows_csv(std::span(&r, 1));
  EXPECT_NE(csv.find("\r\n\"a, \"\"quoted\"\" name\",oat,"), std::string::npos);
}

}  // namespace
}  // namespace probewalk::bench
