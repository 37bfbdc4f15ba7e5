// All of a run, as the page tells it.
#pragma once

#include <string>
#include <vector>

#include "tools/probewalk/bench/bench_options.h"
#include "tools/probewalk/bench/scene_report.h"
#include "tools/probewalk/bench/triangle_cost.h"
#include "xr/latency/run_info.h"

namespace probewalk::bench {

struct BenchSummary {
  BenchOptions options;
  MachineInfo machine = read_machine_info();
  DeviceFacts device;
  std::string build, started_utc;
  std::vector<SceneReport> scenes;
  bool has_figures = false;                // figures/index.html is there
  std::vector<TriangleCostRow> triangles;  // empty unless asked for
};

}  // namespace probewalk::bench
