// Counts of int64 values in log-linear buckets (the scheme of HdrHistogram): every power of two is cut into 64 equal
// buckets, so that any value read back is within 1 % of one that was added. Histograms merge; percentiles never do.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace probewalk {

// The percentiles that every table shows. `p` is a fraction; `name` is the JSON key.
struct PercentileRank {
  const char* name;
  const char* label;
  double p;
  // The least n that carries it: one value beyond it up to p99; ten for p99.9, where one hitch would decide.
  std::uint64_t n_min;
};
std::span<const PercentileRank> percentile_ranks();

class Histogram {
 public:
  // One occupied bucket: values in [low, high], both inclusive.
  struct Bucket {
    std::int64_t low = 0;
    std::int64_t high = 0;
    std::uint64_t count = 0;
  };

  void add(std::int64_t value);
  void merge(const Histogram& other);

  std::uint64_t count() const { return count_; }
  // Exact. 0 when empty.
  std::int64_t min() const { return min_; }
  std::int64_t max() const { return max_; }
  // The smallest value v such that at least p * n values are <= v, within 1 %. p in [0, 1]. Empty: none.
  std::optional<std::int64_t> percentile(double p) const;
  // The same, but none when n is too small to carry it.
  std::optional<std::int64_t> percentile(const PercentileRank& rank) const;
  // Occupied buckets in ascending order of value.
  std::vector<Bucket> buckets() const;

 private:
  // Index = bucket of |value|; grown on demand, at most 3 776 entries.
  std::vector<std::uint64_t> positive_, negative_;
  std::uint64_t count_ = 0;
  std::int64_t min_ = 0, max_ = 0;
};

}  // namespace probewalk
