// A row of what two eyes cost beside one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/probewalk/bench/errors.h"

namespace probewalk::bench {

// One eye of all heads. Errors as in BenchRow.
struct EyeCost {
  double lookups_mean = 0.0, probes_mean = 0.0;
  std::optional<double> hit_error_p50, wrong_surface_fraction;
  double hole_fraction = 0.0;
};

// A way of tracing two eyes. Its names in eyes.json and eyes.csv are a contract, as those of BenchRow.
struct EyesRow {
  std::string scene, settings, device;
  int heads = 0, width = 0, height = 0;  // px of an eye
  EyeCost first, second;                 // left, right
  // The left eye alone, and what both take more than that: medians and the distance between the quartiles, ns a ray.
  double first_ns_per_ray = 0.0, second_ns_per_ray = 0.0;
  double second_over_first = 0.0, second_over_first_spread = 0.0;  // repetition by repetition
  double time_ratio = 1.0, time_ratio_spread = 0.0;  // of both eyes, to the first row's, repetition by repetition
  Identity identity;                                 // of both eyes' answers, to the first row's
};

std::string eyes_json(const std::vector<EyesRow>& rows);
std::string eyes_csv(const std::vector<EyesRow>& rows);
// A table for the page; empty without rows.
std::string eyes_table(const std::vector<EyesRow>& rows);

}  // namespace probewalk::bench
