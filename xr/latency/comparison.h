// Runs against runs: which belong together, whether they can be compared at all, what changed by more than its spread,
// and what a gain in time was paid with.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "xr/latency/run.h"
#include "xr/latency/spread.h"

namespace probewalk {

// Repeats of one thing.
struct RunGroup {
  std::string name;
  std::vector<std::size_t> runs;  // indices
};

// The shortest ends of the paths that tell all of them apart.
std::vector<std::string> distinct_names(std::span<const std::string> directories);

// Directories whose last names differ only in a number at their end are repeats ("before-1", "before-2"); where the
// whole name is a number, the directory above says what it repeats ("before/1"). When that would leave one group only,
// every run stands for itself. Groups come in the order of their first run.
std::vector<RunGroup> group_by_name(std::span<const std::string> directories);

enum class Verdict { kAbsent, kTooFew, kNoChange, kBetter, kWorse };

struct ComparedValue {
  std::string name;       // a quantity's, or "missed", "discarded", "coarse", "within_budget", "not_rendered"
  std::string unit;       // of `change`: "ns", "mm", "deg", "per_frame"
  std::string statistic;  // "p50" ... ; of deadline_margin, whose bad end is the low one, "p1" ... ; "mean"
  Change change;
  Verdict verdict = Verdict::kAbsent;
};

struct GroupComparison {
  std::size_t other = 0;               // the group compared with the first one
  std::vector<ComparedValue> times;    // in the order of quantity_definitions()
  std::vector<ComparedValue> quality;  // what a wearer gets: pose errors, missed, coarse, ...
  std::vector<std::string> paid_with;  // a sentence for each thing that got worse while time got better
  bool repeats = false;                // either side has more than one run
};

// Something on which the runs do not agree.
struct Disagreement {
  std::string what;
  std::vector<std::string> values;  // one a run
  bool within_group = false;        // repeats that are none
  bool changes_picture = false;     // the pictures, or their errors, are not the same
  bool expected = false;            // often the very thing that is compared: build, command
};

struct Comparison {
  std::vector<RunGroup> groups;
  std::vector<Disagreement> disagreements;
  std::vector<GroupComparison> others;  // each later group against the first
};

// Changes below this share are none: histograms are no finer, and nobody feels them.
inline constexpr double kSmallestChange = 0.01;

// `groups`: at least one, each with at least one run.
Comparison compare_runs(std::span<const Run> runs, std::vector<RunGroup> groups);

// "faster", "slower", "better", "worse", "no change", "too few frames", "not measured".
std::string verdict_words(const ComparedValue& value);
// "missed refreshes", "coarse frames", ...; a quantity's own name.
std::string name_in_words(const ComparedValue& value);
// A command without where it wrote its report.
std::string without_report_folder(const std::string& command);

}  // namespace probewalk
