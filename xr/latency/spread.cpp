#include "xr/latency/spread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

namespace probewalk {
namespace {

// Blocks that an interval needs, and those of them that must reach beyond a percentile; values beyond it.
constexpr std::size_t kFewestBlocks = 10;
constexpr std::size_t kFewestTailBlocks = 4;
constexpr double kFewestBeyond = 5.0;
constexpr std::size_t kMostBlocks = 512;
// A block this many correlation lengths long hides an eighth of the variance at most.
constexpr double kCorrelationsPerBlock = 4.0;
constexpr std::size_t kMostResamples = 1000, kFewestResamples = 400;
constexpr double kResampledFrames = 3e8;     // about a second
constexpr std::uint64_t kSeed = 20'261'127;  // the same runs give the same page

// Student's t: the 99.5th percentile.
constexpr double kNormal = 2.575829;
double student_t(std::size_t degrees) {
  constexpr std::array<double, 11> kFew{0, 63.657, 9.925, 5.841, 4.604, 4.032, 3.707, 3.499, 3.355, 3.250, 3.169};
  if (degrees < kFew.size()) return kFew[std::max<std::size_t>(degrees, 1)];
  const double n = static_cast<double>(degrees), z = kNormal;
  return z + (std::pow(z, 3) + z) / (4 * n) + (5 * std::pow(z, 5) + 16 * std::pow(z, 3) + 3 * z) / (96 * n * n);
}

std::size_t frames_of(const Side& side) {
  std::size_t n = 0;
  for (const Series& run : side) n += run.values.size();
  return n;
}

std::size_t cell_of(double position, std::size_t cells) {
  const double at = std::clamp(position, 0.0, 1.0) * static_cast<double>(cells);
  return std::min(static_cast<std::size_t>(at), cells - 1);
}

// The mean over a side's runs in each of equal cells of the way; an empty cell repeats the one before.
std::vector<double> along_the_way(const Side& side, std::size_t cells) {
  std::vector<double> sum(cells, 0.0), count(cells, 0.0);
  for (const Series& run : side) {
    for (std::size_t i = 0; i < run.values.size(); ++i) {
      const std::size_t c = cell_of(run.positions[i], cells);
      sum[c] += run.values[i];
      count[c] += 1.0;
    }
  }
  double last = 0.0;
  for (std::size_t c = 0; c < cells; ++c) {
    if (count[c] > 0.0) last = sum[c] / count[c];
    sum[c] = last;
  }
  return sum;
}

// Ranks, ties sharing theirs: single hitches do not hide how the rest hangs together.
std::vector<double> ranks_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t j = i;
    while (j < order.size() && values[order[j]] == values[order[i]]) ++j;
    for (std::size_t k = i; k < j; ++k) ranks[order[k]] = 0.5 * static_cast<double>(i + j - 1);
    i = j;
  }
  return ranks;
}

// How many neighbours tell the same: 1 + 2 times the sum of the autocorrelation up to where it has died away.
double correlation_length(const std::vector<double>& values) {
  const std::size_t n = values.size();
  const std::vector<double> ranks = ranks_of(values);
  const double mean = 0.5 * static_cast<double>(n - 1);
  double variance = 0.0;
  for (const double rank : ranks) variance += (rank - mean) * (rank - mean);
  if (variance <= 0.0) return 1.0;
  double length = 1.0;
  for (std::size_t lag = 1; lag < n / 4; ++lag) {
    double product = 0.0;
    for (std::size_t i = lag; i < n; ++i) product += (ranks[i] - mean) * (ranks[i - lag] - mean);
    const double correlation = product / variance;
    if (correlation < 0.05) break;
    length += 2.0 * correlation;
  }
  return length;
}

// Into how many equal blocks the way is cut.
std::size_t block_count(const Side& base, const Side& other) {
  std::size_t shortest = SIZE_MAX;
  for (const Side* side : {&base, &other}) {
    for (const Series& run : *side) shortest = std::min(shortest, run.values.size());
  }
  const std::size_t cells = std::min<std::size_t>(shortest, 4096);
  if (cells < 8) return 1;
  std::vector<double> difference = along_the_way(other, cells);
  const std::vector<double> of_base = along_the_way(base, cells);
  for (std::size_t c = 0; c < cells; ++c) difference[c] -= of_base[c];
  const double n = static_cast<double>(cells);
  const double block = std::max(std::cbrt(n), kCorrelationsPerBlock * correlation_length(difference));
  return std::clamp<std::size_t>(static_cast<std::size_t>(n / block), 1, kMostBlocks);
}

// All frames of a side by rising value, each with its block.
struct Sorted {
  std::vector<double> values;
  std::vector<std::uint16_t> blocks;
  std::vector<std::size_t> block_sizes;

  Sorted(const Side& side, std::size_t block_total) : block_sizes(block_total, 0) {
    std::vector<std::pair<double, std::uint16_t>> all;
    all.reserve(frames_of(side));
    for (const Series& run : side) {
      for (std::size_t i = 0; i < run.values.size(); ++i) {
        const std::size_t block = cell_of(run.positions[i], block_total);
        all.emplace_back(run.values[i], static_cast<std::uint16_t>(block));
        ++block_sizes[block];
      }
    }
    std::ranges::sort(all);
    for (const auto& [value, block] : all) {
      values.push_back(value);
      blocks.push_back(block);
    }
  }
};

// The smallest value that a share p do not exceed, each frame counted as often as its block was drawn.
void weighted_percentiles(const Sorted& side, const std::vector<std::uint32_t>& drawn,
                          std::span<const std::pair<double, std::size_t>> ascending, std::vector<double>& into) {
  double total = 0.0;
  for (std::size_t b = 0; b < drawn.size(); ++b) total += drawn[b] * static_cast<double>(side.block_sizes[b]);
  std::size_t next = 0;
  double seen = 0.0;
  for (std::size_t i = 0; i < side.values.size() && next < ascending.size(); ++i) {
    seen += drawn[side.blocks[i]];
    while (next < ascending.size() && seen >= ascending[next].first * total && seen > 0.0) {
      into[ascending[next++].second] = side.values[i];
    }
  }
  while (next < ascending.size()) into[ascending[next++].second] = side.values.back();
}

double percentile_of_sorted(const std::vector<double>& sorted, double p) {
  const double rank = std::ceil(p * static_cast<double>(sorted.size()));
  return sorted[std::clamp<std::size_t>(static_cast<std::size_t>(rank), 1, sorted.size()) - 1];
}

double percentile_of(std::vector<double> values, double p) {
  std::ranges::sort(values);
  return percentile_of_sorted(values, p);
}

bool tail_is_carried(const Sorted& side, double p, double value) {
  const bool upper = p >= 0.5;
  if (static_cast<double>(side.values.size()) * std::min(p, 1.0 - p) < kFewestBeyond) return false;
  // At a value that many frames share, those at it count as its tail: it is carried by all of them.
  std::vector<bool> reached(side.block_sizes.size(), false);
  for (std::size_t i = 0; i < side.values.size(); ++i) {
    if (upper ? side.values[i] >= value : side.values[i] <= value) reached[side.blocks[i]] = true;
  }
  return static_cast<std::size_t>(std::ranges::count(reached, true)) >= kFewestTailBlocks;
}

// Half of an interval from what each single run gives; none without repeats. The run-to-run variance is taken to be the
// same on both sides, so that one side's repeats serve a single run on the other.
std::optional<double> half_width_between(const Side& base, const Side& other,
                                         const std::function<std::optional<double>(const Series&)>& of_run) {
  double squares = 0.0, inverse = 0.0;
  std::size_t degrees = 0;
  for (const Side* side : {&base, &other}) {
    std::vector<double> each;
    for (const Series& run : *side) {
      const auto value = of_run(run);
      if (!value) return std::nullopt;
      each.push_back(*value);
    }
    const double n = static_cast<double>(each.size());
    const double mean = std::accumulate(each.begin(), each.end(), 0.0) / n;
    for (const double value : each) squares += (value - mean) * (value - mean);
    inverse += 1.0 / n;
    degrees += each.size() - 1;
  }
  if (degrees == 0) return std::nullopt;
  return student_t(degrees) * std::sqrt(squares / static_cast<double>(degrees) * inverse);
}

struct Bounds {
  double low = 0.0, high = 0.0;
};

// The interval of a change (on the scale on which it is symmetric) from its resamples, widened for the few blocks that
// these were drawn from, and to the spread between runs.
Bounds interval(double change, std::vector<double>& resampled, std::size_t blocks,
                const std::optional<double>& between) {
  std::ranges::sort(resampled);
  const double few = static_cast<double>(blocks);
  const double widen = student_t(blocks - 1) / kNormal * std::sqrt(few / (few - 1.0));
  constexpr double kTail = 0.5 * (1.0 - kSpreadConfidence);
  Bounds bounds{change + widen * std::min(0.0, percentile_of_sorted(resampled, kTail) - change),
                change + widen * std::max(0.0, percentile_of_sorted(resampled, 1.0 - kTail) - change)};
  if (between) {
    bounds.low = std::min(bounds.low, change - *between);
    bounds.high = std::max(bounds.high, change + *between);
  }
  return bounds;
}

// How often each block is drawn, once for each resample.
class Draws {
 public:
  explicit Draws(std::size_t blocks) : drawn_(blocks), which_(0, blocks - 1) {}
  const std::vector<std::uint32_t>& next() {
    std::ranges::fill(drawn_, 0u);
    for (std::size_t i = 0; i < drawn_.size(); ++i) ++drawn_[which_(random_)];
    return drawn_;
  }

 private:
  std::vector<std::uint32_t> drawn_;
  std::mt19937_64 random_{kSeed};
  std::uniform_int_distribution<std::size_t> which_;
};

Side without_empty_runs(const Side& side) {
  Side kept;
  for (const Series& run : side) {
    if (!run.values.empty()) kept.push_back(run);
  }
  return kept;
}

}  // namespace

std::vector<Change> percentile_changes(const Side& all_base, const Side& all_other, std::span<const double> p,
                                       bool ratio) {
  const Side base = without_empty_runs(all_base), other = without_empty_runs(all_other);
  std::vector<Change> changes(p.size());
  for (Change& change : changes) {
    change.base_n = frames_of(base);
    change.other_n = frames_of(other);
    change.exists = change.base_n > 0 && change.other_n > 0;
  }
  if (changes.empty() || !changes[0].exists) return changes;

  const std::size_t blocks = block_count(base, other);
  const Sorted of_base(base, blocks), of_other(other, blocks);
  const bool is_ratio = ratio && of_base.values.front() > 0.0 && of_other.values.front() > 0.0;
  const auto change_of = [&](double from, double to) { return is_ratio ? std::log(to / from) : to - from; };
  const auto shown = [&](double change) { return is_ratio ? std::exp(change) : change; };

  std::vector<std::pair<double, std::size_t>> ascending;
  for (std::size_t k = 0; k < p.size(); ++k) {
    Change& change = changes[k];
    change.is_ratio = is_ratio;
    change.base = percentile_of_sorted(of_base.values, p[k]);
    change.other = percentile_of_sorted(of_other.values, p[k]);
    change.value = shown(change_of(change.base, change.other));
    change.enough = blocks >= kFewestBlocks && tail_is_carried(of_base, p[k], change.base) &&
                    tail_is_carried(of_other, p[k], change.other);
    if (change.enough) ascending.emplace_back(p[k], k);
  }
  if (ascending.empty()) return changes;
  std::ranges::sort(ascending);

  const double frames = static_cast<double>(of_base.values.size() + of_other.values.size());
  const std::size_t resamples =
      std::clamp(static_cast<std::size_t>(kResampledFrames / frames), kFewestResamples, kMostResamples);
  std::vector<std::vector<double>> resampled(p.size());
  std::vector<double> from(p.size()), to(p.size());
  Draws draws(blocks);
  for (std::size_t r = 0; r < resamples; ++r) {
    const std::vector<std::uint32_t>& drawn = draws.next();
    weighted_percentiles(of_base, drawn, ascending, from);
    weighted_percentiles(of_other, drawn, ascending, to);
    for (const auto& [share, k] : ascending) resampled[k].push_back(change_of(from[k], to[k]));
  }
  for (const auto& [share, k] : ascending) {
    const auto between = half_width_between(base, other, [&](const Series& run) -> std::optional<double> {
      if (static_cast<double>(run.values.size()) * std::min(share, 1.0 - share) < 1.0) return std::nullopt;
      const double value = percentile_of(run.values, share);
      return is_ratio ? std::log(value) : value;
    });
    Change& change = changes[k];
    const Bounds bounds = interval(change_of(change.base, change.other), resampled[k], blocks, between);
    change.low = shown(bounds.low);
    change.high = shown(bounds.high);
    change.between_runs = between.has_value();
  }
  return changes;
}

Change mean_change(const Side& all_base, const Side& all_other) {
  const Side base = without_empty_runs(all_base), other = without_empty_runs(all_other);
  Change change;
  change.base_n = frames_of(base);
  change.other_n = frames_of(other);
  change.exists = change.base_n > 0 && change.other_n > 0;
  if (!change.exists) return change;

  const std::size_t blocks = block_count(base, other);
  struct Sums {
    std::vector<double> sum, count;
  };
  const auto sums_of = [&](const Side& side) {
    Sums sums{std::vector<double>(blocks, 0.0), std::vector<double>(blocks, 0.0)};
    for (const Series& run : side) {
      for (std::size_t i = 0; i < run.values.size(); ++i) {
        const std::size_t block = cell_of(run.positions[i], blocks);
        sums.sum[block] += run.values[i];
        sums.count[block] += 1.0;
      }
    }
    return sums;
  };
  const auto mean_of = [](const Sums& sums, const std::vector<std::uint32_t>& drawn) {
    double sum = 0.0, count = 0.0;
    for (std::size_t b = 0; b < drawn.size(); ++b) {
      sum += drawn[b] * sums.sum[b];
      count += drawn[b] * sums.count[b];
    }
    return count > 0.0 ? sum / count : 0.0;
  };
  const Sums of_base = sums_of(base), of_other = sums_of(other);
  const std::vector<std::uint32_t> once(blocks, 1);
  change.base = mean_of(of_base, once);
  change.other = mean_of(of_other, once);
  change.value = change.other - change.base;
  change.enough = blocks >= kFewestBlocks;
  if (!change.enough) return change;

  std::vector<double> resampled;
  Draws draws(blocks);
  for (std::size_t r = 0; r < kMostResamples; ++r) {
    const std::vector<std::uint32_t>& drawn = draws.next();
    resampled.push_back(mean_of(of_other, drawn) - mean_of(of_base, drawn));
  }
  const auto between = half_width_between(base, other, [](const Series& run) -> std::optional<double> {
    return std::accumulate(run.values.begin(), run.values.end(), 0.0) / static_cast<double>(run.values.size());
  });
  const Bounds bounds = interval(change.value, resampled, blocks, between);
  change.low = bounds.low;
  change.high = bounds.high;
  change.between_runs = between.has_value();
  return change;
}

}  // namespace probewalk
