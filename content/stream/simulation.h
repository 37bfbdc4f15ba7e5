// Streaming without a device: a policy, a source of numbers and a walk, step by step, faster than real time; and what
// came of it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "content/stream/residency.h"
#include "content/stream/simulated_source.h"
#include "content/stream/simulated_walk.h"

namespace probewalk {

struct SimulationOptions {
  ResidencyOptions residency;
  SourceModel source;
  std::uint32_t retire_steps = 3;  // until evicted bytes are free
  bool starts_settled = true;      // as if the walker had waited for everything before setting out
  double sample_s = 0.0;           // of `samples`; 0 = none
};

struct SimulationSample {
  double t_s = 0.0;
  std::int32_t room = 0;
  std::int32_t shown = -1, wanted = -1;  // levels of the walker's room
  std::uint64_t wanted_bytes = 0;        // device bytes of all that is wanted
  std::uint64_t held_bytes = 0;          // resident, loading and not yet freed
  double bytes_moved = 0.0;              // from the source since the start
  double missing_octaves = 0.0;
  std::size_t depth = 0;  // loads under way
};

struct SimulationResult {
  std::size_t steps = 0;
  // Octaves of detail that the view lacks against every room's finest level, averaged over directions and time; a room
  // with nothing to show lacks kHoleOctaves more than at its coarsest.
  double missing_octaves = 0.0;
  std::size_t hole_steps = 0;       // the walker's room had nothing to show
  std::size_t dark_view_steps = 0;  // some room in view had nothing to show
  std::size_t coarse_steps = 0;     // the walker's room showed less than the finest level that the policy wanted then
  std::size_t coarse_run_max = 0;
  std::size_t over_budget_steps = 0;  // must be 0
  std::uint64_t held_bytes_max = 0;
  double bytes_moved = 0.0;
  std::size_t loads = 0, evictions = 0, cancellations = 0, failures = 0;
  // Of the evictions: those that made a room in view coarser, and those that left one in view with nothing to show.
  std::size_t evictions_in_view = 0, evictions_to_nothing_in_view = 0;
  std::vector<double> need_to_resident_s;  // of levels that were not there when the walk began
  std::vector<std::int64_t> decide_ns;     // of each step
  std::vector<SimulationSample> samples;
};

inline constexpr double kHoleOctaves = 4.0;

// `policy` is asked once a step; for what is there before the first step `settled_by` is asked, or the policy itself.
SimulationResult simulate(const Manifest& manifest, const SimulatedWalk& walk, const WalkViews& views,
                          StreamingPolicy& policy, const SimulationOptions& options,
                          StreamingPolicy* settled_by = nullptr);

// A bound that no policy can beat, whatever the source: at every step the best levels of what is seen that the budget
// holds, parts of levels allowed. Missing octaves, averaged as above.
double missing_octaves_bound(const Manifest& manifest, const WalkViews& views, std::uint64_t budget_bytes);

struct PolicyOutcome {
  std::string policy;
  SimulationResult result;
};
// Names: "probewalk", "neighbours", "lru", "oracle". The oracle is the best of several horizons. Throws BadUsage for
// another name, or a budget that is too small.
SimulationResult simulate_policy(const std::string& policy, const Manifest& manifest, const RoomGraph& graph,
                                 const SimulatedWalk& walk, const WalkViews& views, const SimulationOptions& options);
inline constexpr const char* kPolicies[] = {"probewalk", "neighbours", "lru", "oracle"};

}  // namespace probewalk
