#include "tools/probewalk/bench/bench_row.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace probewalk::bench {
namespace {

using Json = nlohmann::ordered_json;

template <typename T>
Json or_null(const std::optional<T>& value) {
  if (!value) return nullptr;
  if constexpr (std::is_floating_point_v<T>) {
    if (!std::isfinite(*value)) return nullptr;
  }
  return *value;
}

Json or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

// Commas, quotes and line ends in quotes; a number as JSON writes it, so that both files say the same to the last digit.
std::string csv_field(const Json& value) {
  if (value.is_null()) return {};
  if (!value.is_string()) return value.dump();
  const std::string& text = value.get_ref<const std::string&>();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

Json row_json(const BenchRow& row) {
  return {{"scene", row.scene},
          {"method", row.method},
          {"settings", row.settings},
          {"device", row.device},
          {"views", row.views},
          {"width", row.width},
          {"height", row.height},
          {"rays", row.rays},
          {"resolution", row.resolution},
          {"ns_per_ray_median", row.ns_per_ray_median},
          {"ns_per_ray_spread", row.ns_per_ray_spread},
          {"time_ratio", or_null(row.time_ratio)},
          {"time_ratio_spread", or_null(row.time_ratio_spread)},
          {"lookups_mean", row.lookups_mean},
          {"lookups_p99", row.lookups_p99},
          {"attribute_reads_mean", row.attribute_reads_mean},
          {"probes_mean", row.probes_mean},
          {"hit_error_p50", or_null(row.hit_error_p50)},
          {"hit_error_p95", or_null(row.hit_error_p95)},
          {"hit_error_p99", or_null(row.hit_error_p99)},
          {"tracer_error_max", or_null(row.tracer_error_max)},
          {"tracer_error_p99", or_null(row.tracer_error_p99)},
          {"tracer_ties", or_null(row.tracer_ties)},
          {"tracer_disagreements", or_null(row.tracer_disagreements)},
          {"tracer_reference", or_null(row.tracer_reference)},
          {"wrong_surface_fraction", or_null(row.wrong_surface_fraction)},
          {"hole_fraction", row.hole_fraction},
          {"nan_count", row.nan_count},
          {"flip_mean", or_null(row.flip_mean)},
          {"psnr_db", or_null(row.psnr_db)},
          {"pixels_per_degree", or_null(row.pixels_per_degree)},
          {"worst_view", or_null(row.worst_view)},
          {"bytes_device", row.bytes_device}};
}

std::string rows_json(std::span<const BenchRow> rows) {
  Json array = Json::array();
  for (const BenchRow& row : rows) array.push_back(row_json(row));
  return array.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string csv_of(std::span<const nlohmann::ordered_json> objects) {
  std::string text;
  const auto add_line = [&](const Json& row, bool keys) {
    bool first = true;
    for (const auto& [key, value] : row.items()) {
      if (!first) text += ',';
      first = false;
      text += keys ? key : csv_field(value);
    }
    text += "\r\n";
  };
  if (!objects.empty()) add_line(objects.front(), true);
  for (const Json& row : objects) add_line(row, false);
  return text;
}

std::string rows_csv(std::span<const BenchRow> rows) {
  std::vector<Json> objects;
  for (const BenchRow& row : rows) objects.push_back(row_json(row));
  if (!rows.empty()) return csv_of(objects);
  const std::string header = csv_of(std::vector{row_json({})});
  return header.substr(0, header.find('\n') + 1);
}

std::optional<double> failed_fraction(const BenchRow& row) {
  if (!row.wrong_surface_fraction) return std::nullopt;
  return *row.wrong_surface_fraction + row.hole_fraction;
}

}  // namespace probewalk::bench
