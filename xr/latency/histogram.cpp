#include "xr/latency/histogram.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace probewalk {
namespace {

// 64 buckets an octave: a bucket is at most 1/64 of its lower end wide, its middle at most 0.8 % from any value in it.
// Values below 128 are exact.
constexpr int kSubBucketBits = 6;
constexpr std::uint64_t kSubBuckets = 1ull << kSubBucketBits;

std::size_t bucket_index(std::uint64_t magnitude) {
  if (magnitude < kSubBuckets) return static_cast<std::size_t>(magnitude);
  const int octave = std::bit_width(magnitude) - 1 - kSubBucketBits;
  return static_cast<std::size_t>(octave) * kSubBuckets + static_cast<std::size_t>(magnitude >> octave);
}

std::uint64_t bucket_low(std::size_t index) {
  if (index < 2 * kSubBuckets) return index;
  const std::size_t octave = index / kSubBuckets - 1;
  return (index - octave * kSubBuckets) << octave;
}

std::uint64_t bucket_high(std::size_t index) { return bucket_low(index + 1) - 1; }

std::uint64_t magnitude_of(std::int64_t value) {
  return value < 0 ? ~static_cast<std::uint64_t>(value) + 1 : static_cast<std::uint64_t>(value);
}

void add_counts(std::vector<std::uint64_t>& to, const std::vector<std::uint64_t>& from) {
  if (to.size() < from.size()) to.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) to[i] += from[i];
}

// Bucket ends as signed values; the lowest int64 has a magnitude that only its negative side reaches.
std::int64_t positive_end(std::uint64_t magnitude) {
  return static_cast<std::int64_t>(std::min<std::uint64_t>(magnitude, INT64_MAX));
}
std::int64_t negative_end(std::uint64_t magnitude) {
  return magnitude > static_cast<std::uint64_t>(INT64_MAX) ? INT64_MIN : -static_cast<std::int64_t>(magnitude);
}

constexpr std::array<PercentileRank, 5> kRanks{{
    {"p50", "p50", 0.50, 1},
    {"p90", "p90", 0.90, 10},
    {"p95", "p95", 0.95, 20},
    {"p99", "p99", 0.99, 100},
    {"p999", "p99.9", 0.999, 10'000},
}};

}  // namespace

std::span<const PercentileRank> percentile_ranks() { return kRanks; }

void Histogram::add(std::int64_t value) {
  std::vector<std::uint64_t>& side = value < 0 ? negative_ : positive_;
  const std::size_t index = bucket_index(magnitude_of(value));
  if (side.size() <= index) side.resize(index + 1);
  ++side[index];
  min_ = count_ == 0 ? value : std::min(min_, value);
  max_ = count_ == 0 ? value : std::max(max_, value);
  ++count_;
}

void Histogram::merge(const Histogram& other) {
  if (other.count_ == 0) return;
  add_counts(positive_, other.positive_);
  add_counts(negative_, other.negative_);
  min_ = count_ == 0 ? other.min_ : std::min(min_, other.min_);
  max_ = count_ == 0 ? other.max_ : std::max(max_, other.max_);
  count_ += other.count_;
}

std::vector<Histogram::Bucket> Histogram::buckets() const {
  std::vector<Bucket> occupied;
  for (std::size_t i = negative_.size(); i-- > 0;) {
    if (negative_[i] != 0) {
      occupied.push_back({negative_end(bucket_high(i)), negative_end(bucket_low(i)), negative_[i]});
    }
  }
  for (std::size_t i = 0; i < positive_.size(); ++i) {
    if (positive_[i] != 0) {
      occupied.push_back({positive_end(bucket_low(i)), positive_end(bucket_high(i)), positive_[i]});
    }
  }
  return occupied;
}

std::optional<std::int64_t> Histogram::percentile(double p) const {
  if (count_ == 0) return std::nullopt;
  const double wanted = std::ceil(std::clamp(p, 0.0, 1.0) * static_cast<double>(count_));
  const std::uint64_t rank = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(wanted));
  if (rank >= count_) return max_;
  std::uint64_t seen = 0;
  for (const Bucket& bucket : buckets()) {
    seen += bucket.count;
    if (seen >= rank) return std::clamp(bucket.low + (bucket.high - bucket.low) / 2, min_, max_);
  }
  return max_;
}

std::optional<std::int64_t> Histogram::percentile(const PercentileRank& rank) const {
  return count_ < rank.n_min ? std::nullopt : percentile(rank.p);
}

}  // namespace probewalk
