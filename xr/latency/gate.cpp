#include "xr/latency/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "content/error.h"
#include "xr/latency/report_text.h"

namespace probewalk {
namespace {

enum class Unit { kTime, kMillimetres, kDegrees, kCount, kShare, kBytes };

struct UnitWord {
  std::string_view word;
  double factor;
};

// What a limit may end in; the first is what summary.json is in.
std::vector<UnitWord> words_of(Unit unit) {
  switch (unit) {
    case Unit::kTime:
      return {{"ns", 1.0}, {"us", 1e3}, {"ms", 1e6}, {"s", 1e9}};
    case Unit::kMillimetres:
      return {{"mm", 1.0}, {"", 1.0}};
    case Unit::kDegrees:
      return {{"deg", 1.0}, {"", 1.0}};
    case Unit::kCount:
      return {{"", 1.0}};
    case Unit::kShare:
      return {{"", 1.0}, {"%", 0.01}};
    case Unit::kBytes:
      return {{"B", 1.0}, {"KiB", 0x1p10}, {"MiB", 0x1p20}, {"GiB", 0x1p30}};
  }
  return {};
}

const char* json_unit(Unit unit) {
  switch (unit) {
    case Unit::kTime:
      return "ns";
    case Unit::kMillimetres:
      return "mm";
    case Unit::kDegrees:
      return "deg";
    case Unit::kCount:
      return "count";
    case Unit::kShare:
      return "fraction";
    case Unit::kBytes:
      return "bytes";
  }
  return "";
}

std::string in_words(Unit unit, double value) {
  switch (unit) {
    case Unit::kTime:
      return fmt::format("{:.4g} ms", value * 1e-6);
    case Unit::kMillimetres:
      return fmt::format("{:.4g} mm", value);
    case Unit::kDegrees:
      return fmt::format("{:.4g} deg", value);
    case Unit::kCount:
      return fmt::format("{:g}", value);
    case Unit::kShare:
      return fmt::format("{:.4g} %", 100.0 * value);
    case Unit::kBytes:
      return in_bytes(static_cast<std::uint64_t>(std::max(0.0, value)));
  }
  return {};
}

Unit unit_of(const QuantityDefinition& definition) {
  const std::string_view unit = definition.unit;
  return unit == "ns" ? Unit::kTime : unit == "mm" ? Unit::kMillimetres : Unit::kDegrees;
}

// A value, or why there is none.
struct Reading {
  std::optional<double> value;
  std::string note;
};

template <typename T>
Reading or_note(const std::optional<T>& value, const char* note) {
  return value ? Reading{static_cast<double>(*value), {}} : Reading{std::nullopt, note};
}

// p of a histogram that needs n_min values to carry it.
Reading percentile_of(const Histogram& histogram, double p, std::uint64_t n_min, double scale, const char* none) {
  if (histogram.count() == 0) return {std::nullopt, none};
  if (histogram.count() < n_min) {
    return {std::nullopt, fmt::format("n = {} is too small, it needs {}", histogram.count(), n_min)};
  }
  return {static_cast<double>(*histogram.percentile(p)) / scale, {}};
}

constexpr const char* kNotMeasured = "not measured, or it does not exist on this display";
constexpr const char* kNothingAwaited = "no level had to be waited for in this run (n = 0)";

}  // namespace

struct GateKey {
  std::string name;
  std::string alias;  // as in summary.json; may be empty
  Unit unit;
  bool at_least;
  std::string meaning;
  std::function<Reading(const Run&, const Summary&)> read;
};

namespace {

void add_percentile_keys(std::vector<GateKey>& keys) {
  for (const QuantityDefinition& definition : quantity_definitions()) {
    const std::string name = definition.name;
    const Unit unit = unit_of(definition);
    // What there should be much of is gated at its low end.
    const bool at_least = name == "deadline_margin";
    for (const PercentileRank& rank : percentile_ranks()) {
      const double p = at_least ? 1.0 - rank.p : rank.p;
      const std::string statistic = at_least ? fmt::format("p{:g}", 100.0 * p) : std::string(rank.name);
      const std::string label = name + "." + (at_least ? statistic : std::string(rank.label));
      keys.push_back({name + "." + statistic, label == name + "." + statistic ? "" : label, unit, at_least, "",
                      [name, p, n_min = rank.n_min](const Run&, const Summary& summary) {
                        const QuantitySummary& quantity = summary.quantity(name);
                        return percentile_of(quantity.histogram, p, n_min, quantity.scale, kNotMeasured);
                      }});
    }
    keys.push_back({name + (at_least ? ".min" : ".max"), "", unit, at_least, "",
                    [name, at_least](const Run&, const Summary& summary) -> Reading {
                      const QuantitySummary& quantity = summary.quantity(name);
                      if (quantity.histogram.count() == 0) return {std::nullopt, kNotMeasured};
                      const std::int64_t end = at_least ? quantity.histogram.min() : quantity.histogram.max();
                      return {static_cast<double>(end) / quantity.scale, {}};
                    }});
  }
}

Reading of_deadlines(const Run& run, std::uint64_t count) {
  return {static_cast<double>(count),
          run.ledger.options().has_deadlines ? "" : "this display has no deadlines: nothing can be missed"};
}

void add_count_keys(std::vector<GateKey>& keys) {
  const auto count = [&](const char* name, const char* alias, const char* meaning, bool at_least,
                         std::uint64_t Summary::* member) {
    keys.push_back({name, alias, Unit::kCount, at_least, meaning, [member](const Run&, const Summary& summary) {
                      return Reading{static_cast<double>(summary.*member), {}};
                    }});
  };
  keys.push_back({"missed", "", Unit::kCount, false, "refreshes without a new frame",
                  [](const Run& run, const Summary& summary) { return of_deadlines(run, summary.missed); }});
  keys.push_back({"stale_run", "stale_run_max", Unit::kCount, false, "the longest run of refreshes without a new frame",
                  [](const Run& run, const Summary& summary) { return of_deadlines(run, summary.stale_run_max); }});
  count("discarded", "", "frames that the runtime discarded", false, &Summary::discarded);
  count("not_rendered", "", "frames that the runtime asked not to render", false, &Summary::not_rendered);
  count("frames", "", "frames counted, so that a run cut short does not pass", true, &Summary::frames);
}

void add_other_keys(std::vector<GateKey>& keys) {
  keys.push_back({"within_budget", "within_budget_fraction", Unit::kShare, true, "share of frames within budget",
                  [](const Run&, const Summary& s) {
                    return or_note(s.within_budget_fraction, "no frame has both CPU and GPU times and a period");
                  }});
  keys.push_back({"coarse", "coarse_frame_fraction", Unit::kShare, false, "share of frames below the level wanted",
                  [](const Run&, const Summary& s) { return or_note(s.coarse_frame_fraction, kNotMeasured); }});
  for (const PercentileRank& rank : percentile_ranks()) {
    if (rank.p != 0.5 && rank.p != 0.99) continue;
    keys.push_back({fmt::format("need_to_resident.{}", rank.name), fmt::format("need_to_resident_{}_ns", rank.name),
                    Unit::kTime, false, "", [p = rank.p, n_min = rank.n_min](const Run& run, const Summary&) {
                      return percentile_of(need_to_resident_histogram(run.info.streaming), p, n_min, 1.0, kNothingAwaited);
                    }});
  }
  keys.push_back({"need_to_resident.max", "", Unit::kTime, false, "", [](const Run& run, const Summary&) {
                    return percentile_of(need_to_resident_histogram(run.info.streaming), 1.0, 1, 1.0, kNothingAwaited);
                  }});
  keys.push_back({"frame_thread.p99", "frame_thread_p99_ns", Unit::kTime, false,
                  "time that streaming takes from the frame thread", [](const Run&, const Summary& s) {
                    return or_note(s.frame_thread_p99_ns, "n is too small, it needs 100 frames");
                  }});
  keys.push_back({"device_bytes", "device_bytes_max", Unit::kBytes, false, "the most that rooms took on the device",
                  [](const Run&, const Summary& s) { return Reading{static_cast<double>(s.device_bytes_max), {}}; }});
  keys.push_back({"clock_error", "clock_error_ns", Unit::kTime, false, "between the device's clock and the CPU's",
                  [](const Run&, const Summary& s) {
                    return or_note(s.clock_error_ns, "the device's clock was not calibrated");
                  }});
  keys.push_back({"instrumentation_cost", "instrumentation_cost_fraction", Unit::kShare, false,
                  "what measuring costs, of frame time", [](const Run& run, const Summary&) {
                    return or_note(run.info.instrumentation_cost_fraction, "it was not measured in this run");
                  }});
}

const std::vector<GateKey>& keys() {
  static const std::vector<GateKey> all = [] {
    std::vector<GateKey> made;
    add_percentile_keys(made);
    add_count_keys(made);
    add_other_keys(made);
    return made;
  }();
  return all;
}

const GateKey* key_named(std::string_view name) {
  for (const std::string& full : {std::string(name), "frame." + std::string(name)}) {
    for (const GateKey& key : keys()) {
      if (key.name == full || (!key.alias.empty() && key.alias == full)) return &key;
    }
  }
  return nullptr;
}

// Names that start alike are told as one: "cpu_busy.{p50,p90,max}".
std::string names_in_brief() {
  std::string text;
  for (std::size_t i = 0; i < keys().size();) {
    const std::string& name = keys()[i].name;
    const std::size_t dot = name.find('.');
    std::string statistics;
    std::size_t j = i;
    while (dot != std::string::npos && j < keys().size() && keys()[j].name.starts_with(name.substr(0, dot + 1))) {
      statistics += (j > i ? "|" : "") + keys()[j].name.substr(dot + 1);
      ++j;
    }
    text += (text.empty() ? "" : ", ") + (j > i + 1 ? name.substr(0, dot + 1) + statistics : name);
    i = std::max(j, i + 1);
  }
  return text;
}

GateCondition parse_condition(std::string_view part) {
  const std::size_t equals = part.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw BadUsage(
        fmt::format("--gate: '{}' is no condition; write for example p99=11.1ms, gpu_busy.p95=8ms or missed=0", part));
  }
  const std::string_view name = part.substr(0, equals), limit = part.substr(equals + 1);
  const GateKey* key = key_named(name);
  if (key == nullptr) {
    throw BadUsage(
        fmt::format("--gate: '{}' is no name of a value; known are: {}; p50 alone is that of frame, and so on", name,
                    names_in_brief()));
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(limit.data(), limit.data() + limit.size(), value);
  if (error != std::errc() || !std::isfinite(value)) {
    throw BadUsage(fmt::format("--gate: '{}' holds no number to compare {} with", part, key->name));
  }
  std::string_view unit = limit.substr(static_cast<std::size_t>(end - limit.data()));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  std::string allowed;
  for (const UnitWord& word : words_of(key->unit)) {
    if (unit == word.word) return {key, value * word.factor};
    allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", word.word.empty() ? "none" : word.word);
  }
  throw BadUsage(fmt::format("--gate: '{}': {} is given in another unit than '{}'; units of it: {}", part, key->name,
                             unit, allowed));
}

}  // namespace

std::vector<GateCondition> parse_gate(std::string_view text) {
  std::vector<GateCondition> gate;
  while (true) {
    const std::size_t comma = text.find(',');
    std::string_view part = text.substr(0, comma);
    while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
    gate.push_back(parse_condition(part));
    if (comma == std::string_view::npos) return gate;
    text = text.substr(comma + 1);
  }
}

std::vector<GateResult> judge_gate(const std::vector<GateCondition>& gate, const Run& run, const Summary& summary) {
  std::vector<GateResult> results;
  for (const GateCondition& condition : gate) {
    const GateKey& key = *condition.key;
    const Reading reading = key.read(run, summary);
    GateResult result{key.name, json_unit(key.unit), reading.value, condition.limit, key.at_least};
    result.note = reading.note;
    result.limit_text = in_words(key.unit, condition.limit);
    result.value_text = reading.value ? in_words(key.unit, *reading.value) : "none";
    result.holds =
        reading.value && (key.at_least ? *reading.value >= condition.limit : *reading.value <= condition.limit);
    results.push_back(std::move(result));
  }
  return results;
}

std::string failure_text(const GateResult& result) {
  if (!result.value) return fmt::format("{} cannot be judged: {}", result.key, result.note);
  return fmt::format("{} = {}, {} than {}", result.key, result.value_text, result.at_least ? "less" : "more",
                     result.limit_text);
}

std::string gate_names_help() {
  std::string text =
      "Conditions of --gate are NAME=LIMIT, with commas between them; a limit is the worst that is allowed.\n"
      "  p50 p90 p95 p99 p999 max     of frame times\n"
      "  QUANTITY.p99 and so on       of ";
  std::size_t column = 32;
  for (const QuantityDefinition& definition : quantity_definitions()) {
    if (std::string_view(definition.name) == "deadline_margin") continue;
    const std::string_view name = definition.name;
    if (column + name.size() + 1 > 100) {
      text += "\n                               ";
      column = 31;
    }
    text += name;
    text += ' ';
    column += name.size() + 1;
  }
  text +=
      "\n  deadline_margin.p1           and p50 p10 p5 p0.1 min: at least so much\n"
      "  need_to_resident.p50 .p99 .max   from a level first wanted to its being there\n";
  for (const GateKey& key : keys()) {
    if (key.meaning.empty()) continue;
    text += fmt::format("  {:<28} {}{}\n", key.name, key.meaning, key.at_least ? ": at least" : "");
  }
  return text +
         "Times end in ns, us, ms or s; shares are 0.01 or 1%; bytes end in B, KiB, MiB or GiB. The names of "
         "summary.json "
         "are\nunderstood, too. A value that was not measured, or that too few frames carry, fails.";
}

}  // namespace probewalk
