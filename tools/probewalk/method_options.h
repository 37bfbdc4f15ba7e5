// How rays are answered, as `walk`, `render` and `trace` take it: --method and its dials, the selection of probes, and
// where the maps of methods come from that need more than a pack carries.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "content/baseline/baseline_maps.h"
#include "content/baseline/method.h"
#include "content/pack/pack_io.h"
#include "content/progress.h"

namespace probewalk {

struct MethodOptions {
  std::string method = "oat";
  std::string scene;       // bound to the command's own --scene
  int map_resolution = 0;  // 0 = the pack's finest geometry
  // Empty: what the method's source says.
  std::optional<int> first, order, last_resort;
  bool no_advance = false, no_retry = false, no_start_test = false, restart = false;
  std::optional<float> distance_weight;
  std::optional<int> max_tries;
  std::optional<int> epsilon_rule;
  std::optional<float> epsilon, epsilon_growth, step_m;
  bool reject_backfaces = false, backward_trace = false;
  DeviceSamples samples = kDefaultSamples;
};

// Adds all but --scene.
void add_method_options(CLI::App& command, MethodOptions& options);
// Adds --scene for the maps alone.
void add_map_scene_option(CLI::App& command, MethodOptions& options);

// Throws BadUsage for an unknown method, with the names, and for options that would do nothing with it.
TracerChoice chosen_tracer(const MethodOptions& options);

// The maps that the choice needs, from the cache or the scene; null when it needs none. `scale` overrides the pack's.
// Throws BadUsage when the scene is missing, BadInput, Interrupted.
std::unique_ptr<BaselineMaps> chosen_maps(const TracerChoice& choice, const MethodOptions& options, const Pack& pack,
                                          std::optional<double> scale, int threads, Progress& progress);

}  // namespace probewalk
