// What was measured of one pack: the rows, and what the page tells beside them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/probewalk/bench/bench_row.h"
#include "tools/probewalk/bench/errors.h"
#include "tools/probewalk/bench/eyes_row.h"
#include "tools/probewalk/bench/settings.h"

namespace probewalk::bench {

struct AccelerationResult {
  Acceleration acceleration;
  BenchRow without, with;
  double time_ratio = 1.0, time_ratio_spread = 0.0;  // with / without, repetition by repetition
  Identity identity;
};

// The worst view of a method's first row, as files beside the page.
struct WorstPicture {
  std::string method, settings, view;
  float flip = 0.0f;
  std::string reference, shown, difference;  // relative to the page
};

// Embree on the triangles themselves, with all of the CPU's threads: the same rays, distances only.
struct TrianglesTime {
  std::string name;
  double ns_per_ray_median = 0.0, ns_per_ray_spread = 0.0;
  double time_ratio = 0.0;  // to the product's defaults, repetition by repetition
};

struct SceneReport {
  std::string name;        // of the pack's folder; `scene` of its rows
  std::string pack, scene; // as given; the scene may be empty
  std::string scene_name;  // as the pack calls it
  std::string credits;
  std::size_t rooms = 0, probes = 0, triangles = 0;
  int resolution = 0;      // of the finest level
  bool has_truth = false, has_pictures = false;
  std::vector<BenchRow> rows;
  std::vector<AccelerationResult> accelerations;
  std::vector<EyesRow> eyes;
  std::vector<WorstPicture> pictures;
  std::vector<TrianglesTime> triangles_times;
  std::vector<std::string> missing;  // what was not measured, and why

  const BenchRow* default_row() const {
    for (const BenchRow& row : rows) {
      if (row.settings == kDefaultSettings) return &row;
    }
    return nullptr;
  }
};

}  // namespace probewalk::bench
