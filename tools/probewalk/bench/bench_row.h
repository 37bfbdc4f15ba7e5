// One row of the results: a method with its settings over the views of a scene. The names of the keys in JSON and CSV are
// a contract: other programs read them.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

namespace probewalk::bench {

inline constexpr const char* kDefaultSettings = "default";

// What is empty was not measured, or does not exist: null in JSON, an empty field in CSV.
struct BenchRow {
  std::string scene;     // name of the pack's folder
  std::string method;    // as --method names it
  std::string settings;  // kDefaultSettings for the product as it ships; else what differs from it, or from the method's own
  std::string device;
  int views = 0;
  int width = 0, height = 0;  // of a view, px
  std::uint64_t rays = 0;
  int resolution = 0;  // of the probes' geometry or of the baseline's maps, a side

  double ns_per_ray_median = 0.0;
  double ns_per_ray_spread = 0.0;  // between the quartiles of the repetitions
  // To the row with the product's defaults, repetition by repetition: what lasted as long as both is in neither.
  std::optional<double> time_ratio, time_ratio_spread;

  double lookups_mean = 0.0;
  double lookups_p99 = 0.0;
  double attribute_reads_mean = 0.0;
  double probes_mean = 0.0;

  // Against the triangles; distances relative, over rays that hit in both; shares of all rays.
  std::optional<double> hit_error_p50, hit_error_p95, hit_error_p99;
  std::optional<double> wrong_surface_fraction;
  double hole_fraction = 0.0;

  // Against exact intersection of the same probe data, relative, over rays that hit in both; ties are left out and counted.
  std::optional<double> tracer_error_max, tracer_error_p99;
  std::optional<std::uint64_t> tracer_ties, tracer_disagreements;
  std::string tracer_reference;  // how it was intersected; empty where there is none

  std::uint64_t nan_count = 0;
  std::optional<double> flip_mean, psnr_db;
  std::optional<double> pixels_per_degree;
  std::string worst_view;  // by FLIP
  std::uint64_t bytes_device = 0;
};

nlohmann::ordered_json row_json(const BenchRow& row);
// An array of rows, two spaces to a level.
std::string rows_json(std::span<const BenchRow> rows);
// Flat objects with the same keys, as a header with the keys in their order, then a line an object (RFC 4180).
std::string csv_of(std::span<const nlohmann::ordered_json> objects);
// A header with the keys of the JSON in the same order, then a line a row.
std::string rows_csv(std::span<const BenchRow> rows);

// Wrong or without an answer, of all rays: one number for how often a method fails. Empty without triangles.
std::optional<double> failed_fraction(const BenchRow& row);

}  // namespace probewalk::bench
