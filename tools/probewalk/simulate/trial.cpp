#include "tools/probewalk/simulate/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "content/error.h"
#include "tools/probewalk/bench/statistics.h"

namespace probewalk::simulation {

Trial run_trial(const Manifest& manifest, const std::vector<SimulatedWalk>& walks,
                const std::vector<std::string>& policies, const SimulationOptions& options, Progress& progress) {
  Trial trial;
  trial.policies.resize(policies.size());
  struct Waits {
    std::vector<double> need_s, decide_ns;
  };
  std::vector<Waits> waits(policies.size());
  const RoomGraph graph(manifest.rooms, manifest.portals);
  progress.begin("simulating", walks.size() * policies.size(), "walks");
  double steps = 0.0;
  for (std::size_t w = 0; w < walks.size(); ++w) {
    const WalkViews views(graph, walks[w]);
    const auto n = static_cast<double>(walks[w].steps.size());
    trial.bound_octaves += n * missing_octaves_bound(manifest, views, options.residency.budget_bytes);
    trial.simulated_s += n * walks[w].step_s;
    steps += n;
    std::vector<double> missing;
    for (std::size_t k = 0; k < policies.size(); ++k) {
      if (progress.cancelled()) throw Interrupted("interrupted while simulating; nothing was written");
      SimulationOptions own = options;
      if (w > 0) own.sample_s = 0.0;
      SimulationResult result = simulate_policy(policies[k], manifest, graph, walks[w], views, own);
      PolicyTrial& sum = trial.policies[k];
      sum.policy = policies[k];
      ++sum.walks;
      sum.steps += result.steps;
      sum.missing_octaves += result.missing_octaves * n;
      sum.coarse_share += static_cast<double>(result.coarse_steps);
      sum.hole_share += static_cast<double>(result.hole_steps);
      sum.dark_view_share += static_cast<double>(result.dark_view_steps);
      sum.coarse_run_max_s =
          std::max(sum.coarse_run_max_s, static_cast<double>(result.coarse_run_max) * walks[w].step_s);
      sum.over_budget_steps += result.over_budget_steps;
      sum.loads += result.loads;
      sum.evictions += result.evictions;
      sum.evictions_in_view += result.evictions_in_view;
      sum.evictions_to_nothing_in_view += result.evictions_to_nothing_in_view;
      sum.cancellations += result.cancellations;
      sum.failures += result.failures;
      sum.held_bytes_max = std::max(sum.held_bytes_max, result.held_bytes_max);
      sum.bytes_moved += result.bytes_moved;
      waits[k].need_s.insert(waits[k].need_s.end(), result.need_to_resident_s.begin(), result.need_to_resident_s.end());
      waits[k].decide_ns.insert(waits[k].decide_ns.end(), result.decide_ns.begin(), result.decide_ns.end());
      if (w == 0) sum.samples = std::move(result.samples);
      missing.push_back(result.missing_octaves);
      progress.advance(1);
    }
    const double least = *std::min_element(missing.begin(), missing.end());
    for (std::size_t k = 0; k < policies.size(); ++k) {
      trial.policies[k].regret_octaves += (missing[k] - least) / static_cast<double>(walks.size());
    }
  }
  steps = std::max(steps, 1.0);
  trial.bound_octaves /= steps;
  for (std::size_t k = 0; k < policies.size(); ++k) {
    PolicyTrial& sum = trial.policies[k];
    sum.missing_octaves /= steps;
    sum.coarse_share /= steps;
    sum.hole_share /= steps;
    sum.dark_view_share /= steps;
    if (!waits[k].need_s.empty()) {
      sum.need_p50_s = bench::quantile(waits[k].need_s, 0.5);
      sum.need_p99_s = bench::quantile(waits[k].need_s, 0.99);
    }
    sum.decide_p50_ns = bench::quantile(waits[k].decide_ns, 0.5);
    sum.decide_p99_ns = bench::quantile(waits[k].decide_ns, 0.99);
  }
  return trial;
}

nlohmann::ordered_json to_json(const Trial& trial) {
  nlohmann::ordered_json json = {{"simulated_s", trial.simulated_s}, {"missing_octaves_bound", trial.bound_octaves}};
  nlohmann::ordered_json policies = nlohmann::ordered_json::array();
  for (const PolicyTrial& p : trial.policies) {
    policies.push_back({{"policy", p.policy},
                        {"walks", p.walks},
                        {"steps", p.steps},
                        {"missing_octaves", p.missing_octaves},
                        {"regret_octaves", p.regret_octaves},
                        {"coarse_frame_fraction", p.coarse_share},
                        {"coarse_run_max_s", p.coarse_run_max_s},
                        {"hole_frame_fraction", p.hole_share},
                        {"dark_view_frame_fraction", p.dark_view_share},
                        {"need_to_resident_p50_ns", p.need_p50_s * 1e9},
                        {"need_to_resident_p99_ns", p.need_p99_s * 1e9},
                        {"device_bytes_max", p.held_bytes_max},
                        {"over_budget_frames", p.over_budget_steps},
                        {"bytes_moved", p.bytes_moved},
                        {"loads", p.loads},
                        {"evictions", p.evictions},
                        {"evictions_in_view", p.evictions_in_view},
                        {"evictions_to_nothing_in_view", p.evictions_to_nothing_in_view},
                        {"cancellations", p.cancellations},
                        {"failures", p.failures},
                        {"decide_p50_ns", p.decide_p50_ns},
                        {"decide_p99_ns", p.decide_p99_ns}});
  }
  json["policies"] = std::move(policies);
  return json;
}

std::vector<std::string> table(const Trial& trial) {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:<11} {:>8} {:>7} {:>8} {:>9} {:>7} {:>7} {:>10} {:>10} {:>9} {:>9} {:>9}", "policy",
                              "missing", "regret", "coarse", "longest", "holes", "dark", "need p50", "need p99",
                              "moved", "held", "decide"));
  for (const PolicyTrial& p : trial.policies) {
    lines.push_back(fmt::format(
        "{:<11} {:>8.3f} {:>7.3f} {:>6.2f} % {:>7.2f} s {:>5.2f} % {:>5.2f} % {:>7.0f} ms {:>7.0f} ms {:>6.0f} MB "
        "{:>5.0f} MiB {:>6.1f} us",
        p.policy, p.missing_octaves, p.regret_octaves, 100.0 * p.coarse_share, p.coarse_run_max_s, 100.0 * p.hole_share,
        100.0 * p.dark_view_share, p.need_p50_s * 1e3, p.need_p99_s * 1e3, p.bytes_moved * 1e-6,
        static_cast<double>(p.held_bytes_max) / (1 << 20), p.decide_p50_ns * 1e-3));
  }
  return lines;
}

}  // namespace probewalk::simulation
