#include "content/stability/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace probewalk::stability {

namespace {

using nlohmann::ordered_json;

ordered_json to_json(glm::vec3 v) {
  return {v.x, v.y, v.z};
}

// JSON has no NaN and no infinities: text then.
ordered_json to_json(double value) {
  if (std::isfinite(value)) return value;
  return fmt::format("{}", value);
}

ordered_json to_json(const Answer& answer) {
  return {{"class", class_name(answer.cls)}, {"t", to_json(answer.t)}, {"t_safe", to_json(answer.t_safe)}};
}

ordered_json to_json(const Example& example) {
  return {{"ray", example.index},
          {"origin_hi_m", to_json(example.ray.origin_hi_m)},
          {"origin_lo_m", to_json(example.ray.origin_lo_m)},
          {"direction", to_json(example.ray.direction)},
          {"t_start", to_json(static_cast<double>(example.ray.t_start))},
          {"answer", to_json(example.answer)},
          {"reference", to_json(example.reference)}};
}

ordered_json to_json(const Comparison& comparison) {
  ordered_json by_class = ordered_json::object();
  for (int a = 0; a < kClasses; ++a) {
    for (int b = 0; b < kClasses; ++b) {
      const std::uint64_t count = comparison.by_class[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
      if (count > 0) by_class[std::string(class_name(a)) + " -> " + class_name(b)] = count;
    }
  }
  ordered_json json = {{"rays", comparison.rays},
                       {"disagreements", comparison.disagreements},
                       {"ties", comparison.ties},
                       {"beyond_ties", comparison.beyond_ties()},
                       {"error_p50", comparison.errors.percentile(0.5)},
                       {"error_p99", comparison.errors.percentile(0.99)},
                       {"error_max", comparison.errors.max()},
                       {"by_class", by_class}};
  if (comparison.beyond_ties() > 0) json["first_beyond"] = to_json(comparison.beyond);
  return json;
}

ordered_json to_json(const CaseTally& tally) {
  ordered_json classes;
  for (int k = 0; k < kClasses; ++k) classes[class_name(k)] = tally.classes[static_cast<std::size_t>(k)];
  return {{"rays", tally.rays},
          {"nan_count", tally.not_finite},
          {"endless_count", tally.endless},
          {"hierarchical_differs", tally.hierarchical_differs},
          {"more_than_one_lookup", tally.more_than_one},
          {"lookups_mean", tally.rays > 0 ? static_cast<double>(tally.lookups) / static_cast<double>(tally.rays) : 0.0},
          {"lookups_max", tally.lookups_max},
          {"lookups_bound", tally.lookups_bound},
          {"device_rays", tally.device_rays},
          {"device_same_bits", tally.device_same_bits},
          {"classes", classes},
          {"float_vs_double", to_json(tally.float_double)},
          {"float_vs_flat", to_json(tally.float_flat)},
          {"double_vs_flat", to_json(tally.double_planes)},
          {"device_vs_double", to_json(tally.device_double)},
          {"device_vs_float", to_json(tally.device_float)},
          {"float_vs_brute_force", to_json(tally.float_brute)},
          {"device_vs_brute_force", to_json(tally.device_brute)},
          {"double_vs_brute_force", to_json(tally.double_brute)}};
}

ordered_json row(const CaseResult& result) {
  ordered_json json = {{"case", result.hard.name},
                       {"place", result.place},
                       {"cells", result.cells},
                       {"about", result.hard.says},
                       {"passed", failures(result).empty()}};
  json.update(to_json(result.tally));
  return json;
}

std::string csv_cell(const ordered_json& value) {
  if (!value.is_string()) return value.dump();
  std::string text = "\"";
  for (const char c : value.get<std::string>()) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

// Name and value of every number, text and truth in the row; nested objects by a dot; lists and examples left out.
void flatten(const ordered_json& json, const std::string& prefix,
             std::vector<std::pair<std::string, std::string>>& cells) {
  for (const auto& [key, value] : json.items()) {
    if (key == "first_beyond" || key == "by_class") continue;
    if (value.is_object())
      flatten(value, prefix + key + ".", cells);
    else
      cells.emplace_back(prefix + key, csv_cell(value));
  }
}

}  // namespace

CaseTally totals(const std::vector<CaseResult>& results) {
  CaseTally all;
  for (const CaseResult& result : results) all.merge(result.tally);
  return all;
}

std::vector<std::string> all_failures(const std::vector<CaseResult>& results) {
  std::vector<std::string> lines;
  for (const CaseResult& result : results) {
    for (std::string& line : failures(result)) lines.push_back(std::move(line));
  }
  return lines;
}

ordered_json results_json(const TrialInfo& info, const std::vector<CaseResult>& results) {
  ordered_json cases = ordered_json::array();
  for (const CaseResult& result : results) cases.push_back(row(result));
  const std::vector<std::string> failed = all_failures(results);
  return {{"schema", "probewalk-stability-1"},
          {"command", info.command},
          {"build", info.build},
          {"device", info.device},
          {"machine", {{"cpu", info.cpu}, {"system", info.system}}},
          {"started_utc", info.started_utc},
          {"seconds", info.seconds},
          {"tie", info.tie},
          {"passed", failed.empty()},
          {"failures", failed},
          {"totals", to_json(totals(results))},
          {"cases", cases}};
}

std::string results_csv(const std::vector<CaseResult>& results) {
  std::string text;
  for (const CaseResult& result : results) {
    std::vector<std::pair<std::string, std::string>> cells;
    flatten(row(result), "", cells);
    const auto line = [&](bool heading) {
      for (std::size_t k = 0; k < cells.size(); ++k) {
        text += (k > 0 ? "," : "") + (heading ? cells[k].first : cells[k].second);
      }
      text += '\n';
    };
    if (text.empty()) line(true);
    line(false);
  }
  return text;
}

std::vector<std::string> summary(const TrialInfo& info, const std::vector<CaseResult>& results) {
  const CaseTally all = totals(results);
  const std::vector<std::string> failed = all_failures(results);
  const bool device = all.device_rays > 0;
  std::uint64_t brute_fine = 0;
  for (const CaseResult& result : results) {
    if (result.cells > 128) brute_fine += result.tally.float_brute.rays;
  }
  std::vector<std::string> lines;
  lines.push_back(fmt::format(
      "{} rays in {} hard cases were walked{} in C++ float, and compared with the same walk in double, cell by cell. "
      "{} of "
      "them ({} at 512 cells a side) also met brute force: an intersection in double with every piece of the probe's "
      "surface, cuts included, that shares no code with the tracer.",
      all.rays, results.size(), device ? " on the device and" : "", all.float_brute.rays, brute_fine));
  lines.push_back(
      fmt::format("{} answers held a NaN or an infinity; {} walks were endless (the longest took {} look-ups); {} "
                  "answers changed by a bit when nodes of the pyramid were skipped instead of walked cell by cell. Where "
                  "one plane stood for many cells, {} answers changed beyond ties; 99 % of the others' distances changed "
                  "by {:.1e} at most. In double, where rounding has no part in it, {} answers changed beyond ties, and no "
                  "other distance by more than {:.1e} ({:.0e} is allowed).",
                  all.not_finite, all.endless, all.lookups_max, all.hierarchical_differs, all.float_flat.beyond_ties(),
                  all.float_flat.errors.percentile(0.99), all.double_planes.beyond_ties(), all.double_planes.errors.max(),
                  kPlaneError));
  if (device) {
    lines.push_back(fmt::format(
        "The device gave the same bits as C++ float for {} of {} rays; {} answers differ, {} of them beyond ties.",
        all.device_same_bits, all.device_rays, all.device_float.disagreements, all.device_float.beyond_ties()));
  }
  lines.push_back(
      fmt::format("Float and double disagree about {} rays, {} of them beyond ties; float and brute force about {}, {} "
                  "beyond ties. A tie "
                  "is a ray whose answer jumps within {:.1e} of it, or which lies in a surface so nearly that within "
                  "that distance the "
                  "hit moves to the other's: there rounding alone decides.",
                  all.float_double.disagreements, all.float_double.beyond_ties(), all.float_brute.disagreements,
                  all.float_brute.beyond_ties(), info.tie));
  lines.push_back(failed.empty() ? std::string("Every check holds.")
                                 : fmt::format("{} checks do not hold.", failed.size()));
  return lines;
}

}  // namespace probewalk::stability
