// All of a run, as the page tells it.
#pragma once

#include <string>
#include <vector>

#include "tools/probewalk/bench/bench_options.h"
#include "tools/probewalk/bench/scene_report.h"
#include "xr/latency/run_info.h"

namespace probewalk::bench {

struct BenchSummary {
  BenchOptions options;
  MachineInfo machine = read_machine_info();
  DeviceFacts device;
  std::string build, started_utc;
  std::vector<SceneReport> scenes;
  std::vector<std::string> figures;  // files relative to the page, with --figures
};

}  // namespace probewalk::bench
