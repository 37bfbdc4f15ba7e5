#include "xr/latency/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace probewalk {
namespace {

// Values over all magnitudes that frame times have and beyond, of both signs.
std::vector<std::int64_t> spread_values(std::size_t n) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(0.0, 42.0);
  std::vector<std::int64_t> values(n);
  for (auto& value : values) {
    value = static_cast<std::int64_t>(std::exp2(exponent(random)));
    if (random() % 4 == 0) value = -value;
  }
  return values;
}

TEST(Histogram, ReadsPercentilesBackWithinOnePercent) {
  std::vector<std::int64_t> values = spread_values(20'000);
  Histogram histogram;
  for (const std::int64_t value : values) histogram.add(value);
  std::ranges::sort(values);
  for (double p = 0.0; p <= 1.0; p += 0.0137) {
    const std::size_t rank = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(p * 20'000.0)));
    const double exact = static_cast<double>(values[rank - 1]);
    EXPECT_NEAR(static_cast<double>(*histogram.percentile(p)), exact, 0.01 * std::abs(exact)) << "p = " << p;
  }
  EXPECT_EQ(histogram.min(), values.front());
  EXPECT_EQ(histogram.max(), values.back());
  EXPECT_EQ(*histogram.percentile(1.0), values.back());
}

TEST(Histogram, BucketsCoverEveryValueAndAreNarrow) {
  const std::vector<std::int64_t> values = spread_values(2'000);
  Histogram histogram;
  for (const std::int64_t value : values) histogram.add(value);
  const auto buckets = histogram.buckets();
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < buckets.size(); ++i) {
    ASSERT_LE(buckets[i].low, buckets[i].high);
    if (i > 0) {
      ASSERT_LT(buckets[i - 1].high, buckets[i].low);
    }
    const double nearest =
        std::min(std::abs(static_cast<double>(buckets[i].low)), std::abs(static_cast<double>(buckets[i].high)));
    EXPECT_LE(static_cast<double>(buckets[i].high - buckets[i].low), nearest / 64.0 + 1e-9);
    const auto inside = std::ranges::count_if(
        values, [&](std::int64_t v) { return v >= buckets[i].low && v <= buckets[i].high; });
    EXPECT_EQ(static_cast<std::uint64_t>(inside), buckets[i].count);
    total += buckets[i].count;
  }
  EXPECT_EQ(total, values.size());
}

TEST(Histogram, MergingEqualsAddingEverythingToOne) {
  const std::vector<std::int64_t> values = spread_values(3'001);
  Histogram all, left, right;
  for (std::size_t i = 0; i < values.size(); ++i) {
    all.add(values[i]);
    (i % 3 == 0 ? left : right).add(values[i]);
  }
  Histogram merged;
  merged.merge(left);
  merged.merge(Histogram{});
  merged.merge(right);
  EXPECT_EQ(merged.count(), all.count());
  EXPECT_EQ(merged.min(), all.min());
  EXPECT_EQ(merged.max(), all.max());
  for (double p = 0.0; p <= 1.0; p += 0.05) EXPECT_EQ(merged.percentile(p), all.percentile(p));
}

TEST(Histogram, HoldsTheWholeRangeOfInt64) {
  Histogram histogram;
  histogram.add(std::numeric_limits<std::int64_t>::min());
  histogram.add(0);
  histogram.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(*histogram.percentile(0.5), 0);
  EXPECT_EQ(histogram.min(), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(histogram.max(), std::numeric_limits<std::int64_t>::max());
  const auto buckets = histogram.buckets();
  ASSERT_EQ(buckets.size(), 3u);
  EXPECT_EQ(buckets.front().low, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(buckets.back().high, std::numeric_limits<std::int64_t>::max());
}

TEST(Histogram, RefusesPercentilesThatTooFewValuesCarry) {
  Histogram histogram;
  EXPECT_FALSE(histogram.percentile(0.5).has_value());
  for (int i = 0; i < 9'999; ++i) histogram.add(i);
  for (const PercentileRank& rank : percentile_ranks()) {
    EXPECT_EQ(histogram.percentile(rank).has_value(), std::string_view(rank.name) != "p999") << rank.name;
  }
  histogram.add(9'999);
  for (const PercentileRank& rank : percentile_ranks()) EXPECT_TRUE(histogram.percentile(rank).has_value());
  Histogram few;
  for (int i = 0; i < 99; ++i) few.add(i);
  for (const PercentileRank& rank : percentile_ranks()) {
    EXPECT_EQ(few.percentile(rank).has_value(), rank.p < 0.99) << rank.name;
  }
}

}  // namespace
}  // namespace probewalk
