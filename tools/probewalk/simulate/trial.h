// Policies of streaming over the same walks, and what came of it: numbers for tables, JSON and the page.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "content/pack/manifest.h"
#include "content/progress.h"
#include "content/stream/simulation.h"

namespace probewalk::simulation {

// One policy over all walks.
struct PolicyTrial {
  std::string policy;
  std::size_t walks = 0, steps = 0;
  double missing_octaves = 0.0;  // mean over all steps; see SimulationResult
  double regret_octaves = 0.0;   // mean over walks of what it lacks more than the best policy knows how to have there
  double coarse_share = 0.0, hole_share = 0.0, dark_view_share = 0.0;
  double coarse_run_max_s = 0.0;
  std::size_t over_budget_steps = 0, loads = 0, evictions = 0, cancellations = 0, failures = 0;
  std::size_t evictions_in_view = 0, evictions_to_nothing_in_view = 0;  // see SimulationResult
  std::uint64_t held_bytes_max = 0;
  double bytes_moved = 0.0;
  double need_p50_s = 0.0, need_p99_s = 0.0;  // from wanted to resident
  double decide_p50_ns = 0.0, decide_p99_ns = 0.0;
  std::vector<SimulationSample> samples;  // of the first walk
};

struct Trial {
  std::vector<PolicyTrial> policies;
  double bound_octaves = 0.0;  // what no policy can go below, whatever the source
  double simulated_s = 0.0;    // of walking, each policy
};

// Throws BadUsage (unknown policy, budget too small), Interrupted.
Trial run_trial(const Manifest& manifest, const std::vector<SimulatedWalk>& walks,
                const std::vector<std::string>& policies, const SimulationOptions& options, Progress& progress);

nlohmann::ordered_json to_json(const Trial& trial);
// A line a policy, with its head.
std::vector<std::string> table(const Trial& trial);

}  // namespace probewalk::simulation
