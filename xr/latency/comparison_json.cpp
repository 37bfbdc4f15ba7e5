#include "xr/latency/comparison_json.h"

namespace probewalk {
namespace {

using Json = nlohmann::ordered_json;

Json value_json(const ComparedValue& value) {
  const Change& change = value.change;
  const bool judged = change.exists && change.enough;
  return {{"quantity", value.name},
          {"statistic", value.statistic},
          {"unit", value.unit},
          {"base_n", change.base_n},
          {"n", change.other_n},
          {"base", change.exists ? Json(change.base) : Json()},
          {"value", change.exists ? Json(change.other) : Json()},
          {"change_is", change.is_ratio ? "ratio" : "difference"},
          {"change", change.exists ? Json(change.value) : Json()},
          {"low", judged ? Json(change.low) : Json()},
          {"high", judged ? Json(change.high) : Json()},
          {"confidence", kSpreadConfidence},
          {"between_runs", change.between_runs},
          {"verdict", verdict_words(value)}};
}

}  // namespace

Json comparison_json(std::span<const Run> runs, const Comparison& comparison) {
  Json groups = Json::array(), disagreements = Json::array(), others = Json::array();
  for (const RunGroup& group : comparison.groups) {
    Json names = Json::array();
    for (const std::size_t run : group.runs) names.push_back(runs[run].name);
    groups.push_back({{"name", group.name}, {"runs", names}});
  }
  for (const Disagreement& d : comparison.disagreements) {
    disagreements.push_back({{"what", d.what},
                             {"values", d.values},
                             {"among_repeats", d.within_group},
                             {"changes_picture", d.changes_picture},
                             {"expected", d.expected}});
  }
  for (const GroupComparison& pair : comparison.others) {
    Json values = Json::array();
    for (const ComparedValue& value : pair.times) values.push_back(value_json(value));
    for (const ComparedValue& value : pair.quality) values.push_back(value_json(value));
    others.push_back({{"base", comparison.groups.front().name},
                      {"group", comparison.groups[pair.other].name},
                      {"repeats", pair.repeats},
                      {"values", values},
                      {"paid_with", pair.paid_with}});
  }
  return {{"groups", groups}, {"differ_in", disagreements}, {"comparisons", others}};
}

}  // namespace probewalk
