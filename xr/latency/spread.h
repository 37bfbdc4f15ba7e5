// Whether two sides of repeated runs differ by more than their own spread. Pure: numbers in, numbers out.
//
// Two spreads are asked, and the wider one judges:
// - within the runs: the runs are cut into blocks, long enough that one says little about the next, and blocks are
// drawn
//   again with replacement. All runs lend the same blocks: what a place on the path costs is no noise and cancels.
// - between the runs, where a side has repeats: Student's t from what single runs give. Blocks cannot show what differs
//   from run to run (clocks, heat, neighbours).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace probewalk {

// One run's values of a quantity in the order of its frames.
struct Series {
  std::vector<double> values;
  std::vector<double> positions;  // of each on the run's way, ascending in [0, 1]
};
using Side = std::vector<Series>;  // one a run

// Of an interval; a hundred comparisons of the same thing with itself call one a change.
inline constexpr double kSpreadConfidence = 0.99;

struct Change {
  std::size_t base_n = 0, other_n = 0;  // frames, all runs of the side together
  double base = 0.0, other = 0.0;       // of all frames of the side together; exact
  bool is_ratio = false;                // `value`, `low`, `high` are other / base; else other - base
  double value = 0.0, low = 0.0, high = 0.0;
  bool between_runs = false;  // repeats took part in the interval
  bool enough = false;        // there are frames enough for the interval to mean something; else it is not filled
  bool exists = false;        // both sides have values at all; else nothing is filled but the counts
};

// For each p in (0, 1): ratios where all values are positive and `ratio` is asked for, else differences.
std::vector<Change> percentile_changes(const Side& base, const Side& other, std::span<const double> p, bool ratio);

// Of the mean, as a difference: shares and counts per frame.
Change mean_change(const Side& base, const Side& other);

}  // namespace probewalk
