#include "xr/latency/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "content/error.h"

namespace probewalk {
namespace {

constexpr const char* kCounts[] = {"missed", "discarded", "stale_run"};

[[noreturn]] void bad_gate(std::string_view part) {
  throw BadUsage(
      fmt::format("--gate: '{}' is no condition; write for example p99=11.1ms, gpu_busy.p95=8ms or missed=0", part));
}

const PercentileRank* rank_named(std::string_view name) {
  for (const PercentileRank& rank : percentile_ranks()) {
    if (name == rank.name || name == rank.label) return &rank;
  }
  return nullptr;
}

const QuantityDefinition* quantity_named(std::string_view name) {
  for (const QuantityDefinition& definition : quantity_definitions()) {
    if (name == definition.name) return &definition;
  }
  return nullptr;
}

// Factor from a limit's unit to the quantity's own; 0 when they do not fit.
double unit_factor(std::string_view unit, std::string_view quantity_unit) {
  if (quantity_unit != "ns") return unit.empty() || unit == quantity_unit ? 1.0 : 0.0;
  if (unit == "ns") return 1.0;
  if (unit == "us") return 1e3;
  if (unit == "ms") return 1e6;
  if (unit == "s") return 1e9;
  return 0.0;
}

GateCondition parse_condition(std::string_view part) {
  const std::size_t equals = part.find('=');
  if (equals == std::string_view::npos) bad_gate(part);
  const std::string_view name = part.substr(0, equals);
  const std::string_view limit = part.substr(equals + 1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(limit.data(), limit.data() + limit.size(), value);
  if (error != std::errc() || !std::isfinite(value)) bad_gate(part);
  const std::string_view unit = limit.substr(static_cast<std::size_t>(end - limit.data()));

  if (std::ranges::find(kCounts, name) != std::end(kCounts)) {
    if (!unit.empty()) bad_gate(part);
    return {"", std::string(name), value};
  }
  // "p99.9" has a dot of its own: the quantity is what stands before the last ".p" or ".max".
  std::size_t dot = name.rfind(".p");
  if (dot == std::string_view::npos) dot = name.rfind(".max");
  const std::string_view quantity = dot == std::string_view::npos ? "frame" : name.substr(0, dot);
  const std::string_view what = dot == std::string_view::npos ? name : name.substr(dot + 1);
  const QuantityDefinition* definition = quantity_named(quantity);
  const PercentileRank* rank = rank_named(what);
  if (definition == nullptr || (rank == nullptr && what != "max")) bad_gate(part);
  const double factor = unit_factor(unit, definition->unit);
  if (factor == 0.0) bad_gate(part);
  return {definition->name, rank != nullptr ? rank->name : "max", value * factor};
}

}  // namespace

std::vector<GateCondition> parse_gate(std::string_view text) {
  std::vector<GateCondition> gate;
  while (true) {
    const std::size_t comma = text.find(',');
    gate.push_back(parse_condition(text.substr(0, comma)));
    if (comma == std::string_view::npos) return gate;
    text = text.substr(comma + 1);
  }
}

std::vector<std::string> gate_failures(const std::vector<GateCondition>& gate, const Summary& summary) {
  std::vector<std::string> failures;
  for (const GateCondition& condition : gate) {
    if (condition.quantity.empty()) {
      const std::uint64_t count = condition.what == "missed"      ? summary.missed
                                  : condition.what == "discarded" ? summary.discarded
                                                                  : summary.stale_run_max;
      if (static_cast<double>(count) > condition.limit) {
        failures.push_back(fmt::format("{} = {}, more than {:g}", condition.what, count, condition.limit));
      }
      continue;
    }
    const QuantitySummary& quantity = summary.quantity(condition.quantity);
    const Histogram& histogram = quantity.histogram;
    const PercentileRank* rank = rank_named(condition.what);
    std::optional<std::int64_t> value;
    if (rank != nullptr) {
      value = histogram.percentile(*rank);
    } else if (histogram.count() > 0) {
      value = histogram.max();
    }
    const bool is_time = quantity.unit == "ns";
    const char* unit = is_time ? "ms" : quantity.unit.c_str();
    const double shown_scale = is_time ? 1e-6 : 1.0;
    if (!value) {
      failures.push_back(fmt::format("{}.{} cannot be judged: n = {} is too small", condition.quantity, condition.what,
                                     histogram.count()));
      continue;
    }
    const double in_unit = static_cast<double>(*value) / quantity.scale;
    if (in_unit > condition.limit) {
      failures.push_back(fmt::format("{}.{} = {:.4g} {}, more than {:.4g} {}", condition.quantity, condition.what,
                                     in_unit * shown_scale, unit, condition.limit * shown_scale, unit));
    }
  }
  return failures;
}

}  // namespace probewalk
