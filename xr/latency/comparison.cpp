#include "xr/latency/comparison.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <set>

#include "xr/latency/report_text.h"
#include "xr/latency/streaming_section.h"

namespace probewalk {
namespace {

// What is compared of a frame. Time inside the runtime's wait is left out: more of it is neither better nor worse.
struct ComparedQuantity {
  const char* name;
  const char* unit;
  std::function<std::optional<double>(const FrameRecord&, const FrameQuantities&)> of_frame;
  bool more_is_better = false;  // then the low percentiles are the bad ones
  bool needs_deadlines = false;
};

template <typename T>
auto member(std::optional<T> FrameQuantities::* which) {
  return [which](const FrameRecord&, const FrameQuantities& q) -> std::optional<double> {
    return q.*which ? std::optional(static_cast<double>(*(q.*which))) : std::nullopt;
  };
}

const std::vector<ComparedQuantity>& time_quantities() {
  static const std::vector<ComparedQuantity> all{
      {"frame", "ns", member(&FrameQuantities::frame_ns)},
      {"cpu_busy", "ns", member(&FrameQuantities::cpu_busy_ns)},
      {"gpu_busy", "ns", member(&FrameQuantities::gpu_busy_ns)},
      {"gpu_trace", "ns", member(&FrameQuantities::gpu_trace_ns)},
      {"prediction_horizon", "ns", member(&FrameQuantities::prediction_horizon_ns)},
      {"deadline_margin", "ns", member(&FrameQuantities::deadline_margin_ns), true},
  };
  return all;
}

const std::vector<ComparedQuantity>& pose_quantities() {
  static const std::vector<ComparedQuantity> all{
      {"pose_error_mm", "mm", member(&FrameQuantities::pose_error_mm)},
      {"pose_error_deg", "deg", member(&FrameQuantities::pose_error_deg)},
  };
  return all;
}

// Counted per frame.
const std::vector<ComparedQuantity>& shares() {
  static const std::vector<ComparedQuantity> all{
      {"missed", "per_frame",
       [](const FrameRecord&, const FrameQuantities& q) { return std::optional(static_cast<double>(q.missed)); }, false,
       true},
      {"discarded", "per_frame",
       [](const FrameRecord& f, const FrameQuantities&) { return std::optional(f.discarded ? 1.0 : 0.0); }},
      {"not_rendered", "per_frame",
       [](const FrameRecord& f, const FrameQuantities&) { return std::optional(f.should_render ? 0.0 : 1.0); }},
      {"coarse", "per_frame",
       [](const FrameRecord& f, const FrameQuantities&) -> std::optional<double> {
         if (f.level_wanted < 0) return std::nullopt;
         return f.level_shown < f.level_wanted ? 1.0 : 0.0;
       }},
      {"within_budget", "per_frame",
       [](const FrameRecord&, const FrameQuantities& q) -> std::optional<double> {
         return q.within_budget ? std::optional(*q.within_budget ? 1.0 : 0.0) : std::nullopt;
       },
       true},
  };
  return all;
}

// Where on the run's way a frame lies: by time where the display sets the pace, since a path then goes by time.
Series series_of(const Run& run, const ComparedQuantity& quantity) {
  const auto& frames = run.ledger.frames();
  const std::size_t first = run.ledger.first_counted();
  const bool by_time = run.ledger.options().has_deadlines;
  Series series;
  if (first >= frames.size() || (quantity.needs_deadlines && !by_time)) return series;
  const double count = static_cast<double>(frames.size() - first);
  const double begin = static_cast<double>(frames[first].wait.end);
  const double length = std::max(1.0, static_cast<double>(frames.back().wait.end) - begin);
  for (std::size_t i = first; i < frames.size(); ++i) {
    const FrameQuantities q = derive(frames[i], i > first ? &frames[i - 1] : nullptr, by_time);
    const auto value = quantity.of_frame(frames[i], q);
    if (!value) continue;
    series.values.push_back(*value);
    series.positions.push_back(by_time ? (static_cast<double>(frames[i].wait.end) - begin) / length
                                       : static_cast<double>(i - first) / count);
  }
  return series;
}

Side side_of(std::span<const Run> runs, const RunGroup& group, const ComparedQuantity& quantity) {
  Side side;
  for (const std::size_t run : group.runs) side.push_back(series_of(runs[run], quantity));
  return side;
}

Verdict judge(const Change& change, bool more_is_better, double smallest) {
  if (!change.exists) return Verdict::kAbsent;
  if (!change.enough) return Verdict::kTooFew;
  const double none = change.is_ratio ? 1.0 : 0.0;
  if (std::abs(change.value - none) < smallest || (change.low <= none && none <= change.high)) {
    return Verdict::kNoChange;
  }
  return (change.value > none) == more_is_better ? Verdict::kBetter : Verdict::kWorse;
}

void add_percentiles(std::vector<ComparedValue>& values, const ComparedQuantity& quantity, const Side& base,
                     const Side& other, std::int64_t period_ns) {
  std::vector<double> shares;
  for (const PercentileRank& rank : percentile_ranks()) {
    shares.push_back(quantity.more_is_better ? 1.0 - rank.p : rank.p);
  }
  const std::vector<Change> changes = percentile_changes(base, other, shares, !quantity.more_is_better);
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const PercentileRank& rank = percentile_ranks()[k];
    ComparedValue value{quantity.name, quantity.unit, rank.name, changes[k]};
    if (quantity.more_is_better && rank.p != 0.5) value.statistic = fmt::format("p{:g}", 100.0 - 100.0 * rank.p);
    value.change.enough &= std::min(changes[k].base_n, changes[k].other_n) >= rank.n_min;
    // A difference of times is nothing below a hundredth of the period.
    const double smallest = changes[k].is_ratio                       ? kSmallestChange
                            : std::string_view(quantity.unit) == "ns" ? kSmallestChange * static_cast<double>(period_ns)
                                                                      : 0.0;
    value.verdict = judge(value.change, quantity.more_is_better, smallest);
    values.push_back(std::move(value));
  }
}

// What must agree for times to be comparable.
struct Term {
  const char* what;
  std::function<std::string(const Run&)> text;
  bool changes_picture = false;
  bool expected = false;
};

// The median: runtimes that pace by what an application manages change it on the way.
std::string refresh_text(const Run& run) {
  std::vector<std::int64_t> periods;
  for (const FrameRecord& frame : run.ledger.frames()) {
    if (frame.period > 0) periods.push_back(frame.period);
  }
  if (periods.empty()) return {};
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return fmt::format("{:.1f} Hz", 1e9 / static_cast<double>(*middle));
}

const std::vector<Term>& terms() {
  static const std::vector<Term> all{
      {"pack", [](const Run& r) { return r.info.pack; }, true},
      {"method", [](const Run& r) { return r.info.method; }, true},
      {"rays a pixel at edges", [](const Run& r) { return fmt::format("{}", r.info.samples); }, true},
      {"foveation", [](const Run& r) { return r.info.foveation; }, true},
      {"second eye", [](const Run& r) { return r.info.second_eye; }, true},
      {"views and eye size",
       [](const Run& r) { return fmt::format("{} of {} × {} px", r.info.views, r.info.eye_width, r.info.eye_height); },
       true},
      {"display", [](const Run& r) { return r.info.display; }},
      {"runtime", [](const Run& r) { return r.info.runtime; }},
      {"refresh", refresh_text},
      {"device", [](const Run& r) { return r.info.device.name; }},
      {"driver", [](const Run& r) { return r.info.device.driver + ", Vulkan " + r.info.device.api_version; }},
      {"CPU", [](const Run& r) { return fmt::format("{}, {} cores", r.info.machine.cpu, r.info.machine.cores); }},
      {"CPU governor", [](const Run& r) { return r.info.machine.governor; }},
      {"system", [](const Run& r) { return r.info.machine.operating_system + ", " + r.info.machine.kernel; }},
      {"device budget",
       [](const Run& r) { return budget_in_words(r.info.streaming); }},
      {"frames counted",
       [](const Run& r) { return fmt::format("{}", r.ledger.frames().size() - r.ledger.first_counted()); }, false,
       true},
      {"build", [](const Run& r) { return r.info.build; }, false, true},
      {"command", [](const Run& r) { return without_report_folder(r.info.command); }, false, true},
  };
  return all;
}

std::vector<Disagreement> disagreements_of(std::span<const Run> runs, std::span<const RunGroup> groups) {
  std::vector<Disagreement> found;
  for (const Term& term : terms()) {
    Disagreement disagreement{term.what, {}, false, term.changes_picture, term.expected};
    std::set<std::string> all;
    for (const Run& run : runs) {
      disagreement.values.push_back(term.text(run));
      all.insert(disagreement.values.back());
    }
    for (const RunGroup& group : groups) {
      std::set<std::string> here;
      for (const std::size_t run : group.runs) here.insert(disagreement.values[run]);
      // Runs against a real display never count quite the same frames.
      disagreement.within_group |= here.size() > 1 && std::string_view(term.what) != "frames counted";
    }
    if (all.size() > 1) found.push_back(std::move(disagreement));
  }
  return found;
}

std::string in_unit(const ComparedValue& value, double v) {
  if (value.unit == "ns") return in_ms(std::llround(v)) + " ms";
  if (value.unit == "per_frame") return fmt::format("{:.2f} %", 100.0 * v);
  return fmt::format("{:.3g} {}", v, value.unit);
}

std::vector<std::string> paid_with(const GroupComparison& pair, std::span<const Disagreement> disagreements,
                                   const std::string& base, const std::string& other) {
  const ComparedValue* gain = nullptr;
  for (const ComparedValue& value : pair.times) {
    if (value.verdict != Verdict::kBetter || !value.change.is_ratio) continue;
    if (gain == nullptr || value.change.value < gain->change.value) gain = &value;
  }
  if (gain == nullptr) return {};
  const std::string got =
      fmt::format("{} {} got {:.1f} % faster", gain->name, gain->statistic, 100.0 * (1.0 - gain->change.value));
  std::vector<std::string> sentences;
  for (const ComparedValue& value : pair.quality) {
    if (!value.change.exists) continue;
    const bool more_is_better = value.name == "within_budget";
    const bool worse = more_is_better ? value.change.value<0.0 : value.change.value>(value.change.is_ratio ? 1.0 : 0.0);
    if (!worse || (value.verdict == Verdict::kNoChange && value.change.is_ratio)) continue;
    sentences.push_back(fmt::format("{}, but {}{} went from {} to {}{}.", got, name_in_words(value),
                                    value.unit == "per_frame" ? "" : " " + value.statistic,
                                    in_unit(value, value.change.base), in_unit(value, value.change.other),
                                    value.verdict == Verdict::kWorse ? "" : " (not beyond its spread)"));
  }
  std::vector<std::string> pictures;
  for (const Disagreement& d : disagreements) {
    if (d.changes_picture) pictures.push_back(d.what);
  }
  if (!pictures.empty()) {
    sentences.push_back(fmt::format(
        "{}, but {} and {} do not draw the same picture ({} differ). Set the pictures' errors beside it: probewalk "
        "bench.",
        got, base, other, fmt::join(pictures, ", ")));
  }
  return sentences;
}

}  // namespace

std::string without_report_folder(const std::string& command) {
  std::string kept;
  // Words are shell-quoted: a space inside quotes is none between words.
  std::vector<std::string> words{""};
  bool quoted = false;
  for (const char c : command) {
    if (c == '\'') quoted = !quoted;
    if (c == ' ' && !quoted) {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--report") {
      ++i;
    } else if (!words[i].starts_with("--report=")) {
      kept += (kept.empty() ? "" : " ") + words[i];
    }
  }
  return kept;
}

std::vector<std::string> distinct_names(std::span<const std::string> directories) {
  std::vector<std::filesystem::path> paths;
  std::size_t most = 1;
  for (const std::string& directory : directories) {
    std::filesystem::path path = std::filesystem::absolute(directory).lexically_normal();
    paths.push_back(path.has_filename() ? path : path.parent_path());
    most = std::max(most, static_cast<std::size_t>(std::distance(paths.back().begin(), paths.back().end())));
  }
  std::vector<std::string> names;
  for (std::size_t parts = 1; parts <= most; ++parts) {
    names.clear();
    for (const std::filesystem::path& path : paths) {
      const auto count = static_cast<std::size_t>(std::distance(path.begin(), path.end()));
      std::filesystem::path name;
      for (auto part = std::next(path.begin(), static_cast<std::ptrdiff_t>(count - std::min(parts, count)));
           part != path.end(); ++part) {
        name /= *part;
      }
      names.push_back(name.string());
    }
    if (std::set<std::string>(names.begin(), names.end()).size() == names.size()) break;
  }
  return names;
}

std::vector<RunGroup> group_by_name(std::span<const std::string> directories) {
  std::vector<RunGroup> groups;
  const auto stem_of = [](const std::string& directory) {
    std::filesystem::path path = std::filesystem::absolute(directory).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();
    std::string stem = path.filename().string();
    const std::size_t last = stem.find_last_not_of("0123456789");
    if (last == std::string::npos) return path.parent_path().string();
    if (last + 1 == stem.size()) return path.string();
    stem.resize(last + 1);
    while (!stem.empty() && std::string_view("-_. ").find(stem.back()) != std::string_view::npos) stem.pop_back();
    return (path.parent_path() / stem).string();
  };
  std::vector<std::string> stems;
  for (std::size_t i = 0; i < directories.size(); ++i) {
    const std::string stem = stem_of(directories[i]);
    const auto found = std::ranges::find(stems, stem);
    if (found != stems.end()) {
      groups[static_cast<std::size_t>(found - stems.begin())].runs.push_back(i);
      continue;
    }
    stems.push_back(stem);
    groups.push_back({"", {i}});
  }
  if (groups.size() == 1) {
    groups.clear();
    for (std::size_t i = 0; i < directories.size(); ++i) groups.push_back({"", {i}});
    stems.assign(directories.begin(), directories.end());
  }
  const std::vector<std::string> names = distinct_names(stems);
  for (std::size_t g = 0; g < groups.size(); ++g) groups[g].name = names[g];
  return groups;
}

Comparison compare_runs(std::span<const Run> runs, std::vector<RunGroup> groups) {
  Comparison comparison;
  comparison.groups = std::move(groups);
  comparison.disagreements = disagreements_of(runs, comparison.groups);
  const RunGroup& base = comparison.groups.front();
  std::int64_t period_ns = 0;
  for (const FrameRecord& frame : runs[base.runs.front()].ledger.frames())
    period_ns = std::max(period_ns, frame.period);
  for (std::size_t g = 1; g < comparison.groups.size(); ++g) {
    const RunGroup& other = comparison.groups[g];
    GroupComparison& pair = comparison.others.emplace_back();
    pair.other = g;
    pair.repeats = base.runs.size() > 1 || other.runs.size() > 1;
    for (const ComparedQuantity& quantity : time_quantities()) {
      add_percentiles(pair.times, quantity, side_of(runs, base, quantity), side_of(runs, other, quantity), period_ns);
    }
    for (const ComparedQuantity& quantity : pose_quantities()) {
      add_percentiles(pair.quality, quantity, side_of(runs, base, quantity), side_of(runs, other, quantity), period_ns);
    }
    for (const ComparedQuantity& quantity : shares()) {
      ComparedValue value{quantity.name, quantity.unit, "mean",
                          mean_change(side_of(runs, base, quantity), side_of(runs, other, quantity))};
      value.verdict = judge(value.change, quantity.more_is_better, 0.0);
      pair.quality.push_back(std::move(value));
    }
    pair.paid_with = paid_with(pair, comparison.disagreements, base.name, other.name);
  }
  return comparison;
}

std::string verdict_words(const ComparedValue& value) {
  const bool speed = value.unit == "ns" && value.name != "deadline_margin" && value.name != "prediction_horizon";
  switch (value.verdict) {
    case Verdict::kAbsent:
      return "not measured";
    case Verdict::kTooFew:
      return "too few frames";
    case Verdict::kNoChange:
      return "no change";
    case Verdict::kBetter:
      return speed ? "faster" : "better";
    case Verdict::kWorse:
      return speed ? "slower" : "worse";
  }
  return {};
}

std::string name_in_words(const ComparedValue& value) {
  if (value.name == "missed") return "refreshes missed per frame";
  if (value.name == "discarded") return "frames discarded";
  if (value.name == "not_rendered") return "frames not rendered";
  if (value.name == "coarse") return "frames shown coarse";
  if (value.name == "within_budget") return "frames within budget";
  return value.name;
}

}  // namespace probewalk
