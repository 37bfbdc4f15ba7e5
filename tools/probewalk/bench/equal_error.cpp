#include "tools/probewalk/bench/equal_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tools/probewalk/bench/statistics.h"

namespace probewalk::bench {
namespace {

constexpr double kClutterTries = 1.25;

std::optional<double> error_of(const BenchRow& row, EqualBy by) {
  return by == EqualBy::kMedian ? row.hit_error_p50 : failed_fraction(row);
}

// Times are ratios to the default row: of rows that were not timed in the same repetitions they alone can be compared.
double cost_of(const BenchRow& row) { return row.time_ratio.value_or(0.0); }

std::vector<CostError> points_of(const std::vector<const BenchRow*>& rows, EqualBy by) {
  std::vector<CostError> points;
  for (const BenchRow* row : rows) {
    if (const auto error = error_of(*row, by)) points.push_back({cost_of(*row), *error});
  }
  return points;
}

std::string percent(double fraction) { return fmt::format("{:.2f} %", 100.0 * fraction); }

const BenchRow* row_at(const std::vector<BenchRow>& rows, const std::string& method, int size) {
  for (const BenchRow& row : rows) {
    if (row.method == method && row.resolution == size) return &row;
  }
  return nullptr;
}

}  // namespace

std::vector<EqualError> equal_errors(const std::vector<BenchRow>& rows) {
  std::vector<EqualError> result;
  const auto found = std::find_if(rows.begin(), rows.end(), [](const BenchRow& r) { return r.settings == kDefaultSettings; });
  if (found == rows.end() || !found->hit_error_p50 || !found->time_ratio) return result;
  const BenchRow& product = *found;
  std::map<std::string, std::vector<const BenchRow*>> marches;
  std::vector<const BenchRow*> own;
  for (const BenchRow& row : rows) {
    if (!row.time_ratio || !row.hit_error_p50) continue;
    if (row.method == "oat") own.push_back(&row);
    if (is_march(row.method)) marches[row.method].push_back(&row);
  }
  for (const auto& [name, march] : marches) {
    for (const EqualBy by : {EqualBy::kMedian, EqualBy::kFailed}) {
      const auto points = points_of(march, by);
      const auto better = [&](const BenchRow* a, const BenchRow* b) { return *error_of(*a, by) < *error_of(*b, by); };
      const BenchRow& best = **std::min_element(march.begin(), march.end(), better);
      EqualError equal;
      equal.march = name;
      equal.by = by;
      for (const BenchRow* row : march) equal.march_size = std::max(equal.march_size, row->resolution);
      if (const auto cost = cost_at_error(points, *error_of(product, by))) {
        equal.reached = true;
        equal.error = *error_of(product, by);
        equal.speed_ratio = *cost / cost_of(product);
      } else {
        equal.error = *error_of(best, by);
        equal.march_size = best.resolution;
        // The default is itself good enough, so there always is an answer.
        equal.speed_ratio = cost_of(best) / cost_at_error(points_of(own, by), equal.error).value_or(cost_of(product));
      }
      result.push_back(equal);
    }
  }
  return result;
}

std::optional<EqualError> best_march(const std::vector<EqualError>& all, EqualBy by) {
  std::optional<EqualError> best;
  for (const EqualError& equal : all) {
    if (equal.by != by) continue;
    // One that reaches the product's error does better than any that does not.
    if (!best || (equal.reached && !best->reached) || (equal.reached == best->reached && equal.speed_ratio < best->speed_ratio)) {
      best = equal;
    }
  }
  return best;
}

bool is_clutter(const SceneReport& report) {
  const BenchRow* row = report.default_row();
  return row != nullptr && row->probes_mean > kClutterTries;
}

std::vector<Goal> goals_of(const SceneReport& report) {
  std::vector<Goal> goals;
  const BenchRow* product = report.default_row();
  if (product == nullptr) return goals;
  const bool clutter = is_clutter(report);
  const auto verdict = [](bool reached) { return reached ? Verdict::kReached : Verdict::kNotReached; };

  const auto equal = equal_errors(report.rows);
  for (const EqualBy by : {EqualBy::kFailed, EqualBy::kMedian}) {
    Goal goal;
    goal.scene = report.name;
    const double aim = clutter ? 1.0 : 4.0;
    goal.aim = fmt::format("at equal {}, at least {} the best march",
                           by == EqualBy::kMedian ? "median distance error" : "wrong + hole",
                           clutter ? "as fast as" : "4 times as fast as");
    if (const auto best = best_march(equal, by)) {
      const auto words = [&](double e) { return by == EqualBy::kMedian ? fmt::format("{:.1e}", e) : percent(e); };
      goal.result = fmt::format("{:.2f} times as fast as {} at {}", best->speed_ratio, best->march, words(best->error));
      if (!best->reached) {
        goal.result += fmt::format("; no march reaches oat's {} with maps of up to {}", words(*error_of(*product, by)),
                                   best->march_size);
      }
      goal.verdict = verdict(best->speed_ratio >= aim);
    } else {
      goal.result = report.has_truth ? "no march was measured" : "no triangles to compare with";
    }
    goals.push_back(goal);
  }

  if (!clutter) {
    Goal goal{report.name, "at most 10 look-ups a ray at 1024²", {}, Verdict::kNotMeasured};
    const BenchRow* at = product->resolution == 1024 ? product : row_at(report.rows, "oat", 1024);
    if (at != nullptr) {
      goal.result = fmt::format("{:.1f} look-ups", at->lookups_mean);
      goal.verdict = verdict(at->lookups_mean <= 10.0);
    } else {
      goal.result = fmt::format("the pack has no level of 1024²; at {}² {:.1f} look-ups", product->resolution, product->lookups_mean);
    }
    goals.push_back(goal);
  } else {
    // Foliage and grilles were given different aims; a pack does not say which it is.
    Goal goal{report.name, "at most 1.4 probes tried a ray in foliage, 1.7 at a grille",
              fmt::format("{:.2f} probes", product->probes_mean), Verdict::kNotReached};
    if (product->probes_mean <= 1.4) goal.verdict = Verdict::kReached;
    if (product->probes_mean > 1.4 && product->probes_mean <= 1.7) {
      goal.result += ": enough for a grille, not for foliage";
    }
    goals.push_back(goal);
  }

  Goal goal{report.name, fmt::format("wrong + hole at equal resolution at most {} of two-level's", clutter ? "a third" : "a tenth"),
            {}, Verdict::kNotMeasured};
  const BenchRow* other = row_at(report.rows, "two-level", product->resolution);
  if (other != nullptr && failed_fraction(*other) && failed_fraction(*product)) {
    const double own = *failed_fraction(*product), theirs = *failed_fraction(*other);
    goal.result = fmt::format("{} against {}{}", percent(own), percent(theirs),
                              theirs > 0.0 ? fmt::format(": {:.3f} of it", own / theirs) : "");
    goal.verdict = verdict(own <= theirs * (clutter ? 1.0 / 3.0 : 0.1));
  } else {
    goal.result = report.has_truth ? fmt::format("two-level was not measured at {}²", product->resolution)
                                   : "no triangles to compare with";
  }
  goals.push_back(goal);
  return goals;
}

}  // namespace probewalk::bench
