#include "tools/probewalk/bench/eyes_row.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "tools/probewalk/bench/bench_row.h"
#include "tools/probewalk/bench/page_text.h"

namespace probewalk::bench {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const EyesRow& row) {
  const auto or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Json json = {{"scene", row.scene}, {"settings", row.settings}, {"device", row.device},
               {"heads", row.heads}, {"width", row.width},       {"height", row.height}};
  for (const auto& [name, eye] : {std::pair("first", &row.first), std::pair("second", &row.second)}) {
    json[fmt::format("{}_ns_per_ray", name)] = eye == &row.first ? row.first_ns_per_ray : row.second_ns_per_ray;
    json[fmt::format("{}_lookups_mean", name)] = eye->lookups_mean;
    json[fmt::format("{}_probes_mean", name)] = eye->probes_mean;
    json[fmt::format("{}_hit_error_p50", name)] = or_null(eye->hit_error_p50);
    json[fmt::format("{}_wrong_surface_fraction", name)] = or_null(eye->wrong_surface_fraction);
    json[fmt::format("{}_hole_fraction", name)] = eye->hole_fraction;
  }
  json["second_over_first"] = row.second_over_first;
  json["second_over_first_spread"] = row.second_over_first_spread;
  json["time_ratio"] = row.time_ratio;
  json["time_ratio_spread"] = row.time_ratio_spread;
  json["identical_fraction"] = row.identity.identical_fraction;
  json["class_changes"] = row.identity.class_changes;
  json["worst_distance_change"] = row.identity.worst_distance_change;
  return json;
}

}  // namespace

std::string eyes_json(const std::vector<EyesRow>& rows) {
  Json array = Json::array();
  for (const EyesRow& row : rows) array.push_back(json_of(row));
  return array.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string eyes_csv(const std::vector<EyesRow>& rows) {
  std::vector<Json> objects;
  for (const EyesRow& row : rows) objects.push_back(json_of(row));
  return csv_of(objects);
}

std::string eyes_table(const std::vector<EyesRow>& rows) {
  if (rows.empty()) return {};
  std::string html =
      "<h3>Two eyes</h3>\n<div class=\"scroll\"><table><tr><th class=\"words\">settings</th><th>first eye ns a ray</th>"
      "<th>second eye</th><th>second / first</th><th>look-ups first</th><th>second</th><th>probes "
      "first</th><th>second</th>"
      "<th>error p50 first</th><th>second</th><th>wrong first</th><th>second</th><th>hole first</th><th>second</th>"
      "<th>both eyes' time</th><th>identical</th><th>class changes</th></tr>\n";
  auto out = std::back_inserter(html);
  for (const EyesRow& row : rows) {
    fmt::format_to(
        out,
        "<tr{}><td class=\"words\">{}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.2f} ± {:.2f}</td><td>{:.1f}</td>"
        "<td>{:.1f}</td><td>{:.2f}</td><td>{:.2f}</td>",
        row.settings == kDefaultSettings ? " class=\"own\"" : "", row.settings, row.first_ns_per_ray,
        row.second_ns_per_ray, row.second_over_first, row.second_over_first_spread / 2.0, row.first.lookups_mean,
        row.second.lookups_mean, row.first.probes_mean, row.second.probes_mean);
    fmt::format_to(
        out,
        "<td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.2f} ± {:.2f} ×</td><td>{}</td>"
        "<td>{}</td></tr>\n",
        error_text(row.first.hit_error_p50), error_text(row.second.hit_error_p50),
        share_text(row.first.wrong_surface_fraction), share_text(row.second.wrong_surface_fraction),
        share_text(row.first.hole_fraction), share_text(row.second.hole_fraction), row.time_ratio,
        row.time_ratio_spread / 2.0, share_text(row.identity.identical_fraction), row.identity.class_changes);
  }
  return html +
         "</table></div>\n<p class=\"soft\">A head looks from each view with two eyes 63 mm apart, by the tracer that "
         "draws frames. By default the second eye goes by what the first has seen; its probes are those that were still "
         "walked through, its look-ups those in the first eye's picture, too. First eye: the left one alone. Second eye: "
         "what both together take more. Both eyes' time and identical (class, probe and distance, bit for bit) are to the "
         "table's first row.</p>\n";
}

}  // namespace probewalk::bench
