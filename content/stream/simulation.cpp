#include "content/stream/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <set>
#include <utility>

#include "content/error.h"
#include "content/stream/plain_policies.h"

namespace probewalk {

namespace {

constexpr double kVelocitySmoothing_s = 0.2;
constexpr double kJump_m = 0.5;        // further in one step is a teleport, not a motion
constexpr double kRetry_s = 0.5;       // a load that failed is tried again after this
constexpr double kSettleMost_s = 600;  // of simulated time

double missing_octaves(const LevelBook& book, std::span<const RoomGraph::Seen> views) {
  double missing = 0.0;
  for (const RoomGraph::Seen& seen : views) {
    const std::uint32_t levels = book.levels(seen.room);
    if (levels == 0) continue;
    const int shown = book.shown(seen.room);
    const double best = book.quality({seen.room, levels - 1});
    const double has = shown >= 0 ? book.quality({seen.room, static_cast<std::uint32_t>(shown)})
                                  : book.quality({seen.room, 0}) - kHoleOctaves;
    missing += seen.share * (best - has);
  }
  return missing;
}

class Simulation {
 public:
  Simulation(const Manifest& manifest, StreamingPolicy& policy, const SimulationOptions& options)
      : policy_(&policy), options_(options), book_(manifest), source_(options.source) {}

  // By another policy, perhaps: one that knows the walk is asked for its steps alone.
  void settle(const WalkStep& step, double step_s, StreamingPolicy& by) {
    StreamingPolicy* const own = std::exchange(policy_, &by);
    walker_.head_m = step.head_m;
    walker_.look = step.look;
    SourceModel quick;
    quick.bytes_per_s = quick.decode_bytes_per_s = 1e12;
    quick.latency_s = 0.0;
    source_ = SimulatedSource(quick);
    for (double t = 0.0; t < kSettleMost_s; t += step_s) {
      if (advance(step_s, false, {}).settled && book_.loading() == 0) break;
    }
    policy_ = own;
    source_ = SimulatedSource(options_.source);
    result_ = {};
    wanted_since_s_.clear();
    t_s_ = 0.0;
  }

  void step(const WalkStep& step, double step_s, std::span<const RoomGraph::Seen> views) {
    const glm::dvec3 moved_m = step.head_m - walker_.head_m;
    const glm::dvec3 velocity = is_first_ || glm::length(moved_m) > kJump_m ? glm::dvec3(0.0) : moved_m / step_s;
    walker_.velocity_m_s += (velocity - walker_.velocity_m_s) * std::min(1.0, step_s / kVelocitySmoothing_s);
    walker_.head_m = step.head_m;
    walker_.look = step.look;
    walker_.aim_m = step.aim_m;
    is_first_ = false;
    const ResidencyDecision decision = advance(step_s, true, views);
    judge(decision, views);
  }

  SimulationResult take_result() {
    result_.bytes_moved = source_.bytes_moved();
    if (result_.steps > 0) result_.missing_octaves /= static_cast<double>(result_.steps);
    return std::move(result_);
  }

 private:
  ResidencyDecision advance(double step_s, bool with_retries, std::span<const RoomGraph::Seen> views) {
    t_s_ += step_s;
    take_arrivals(step_s);
    for (auto failed = failed_.begin(); failed != failed_.end();) {
      if (with_retries && failed->second > t_s_) {
        ++failed;
        continue;
      }
      book_.set(failed->first, LevelStatus::kAbsent);
      failed = failed_.erase(failed);
    }
    while (!retired_.empty() && retired_.front().first <= steps_done_) {
      retired_bytes_ -= retired_.front().second;
      retired_.pop_front();
    }
    const auto before = std::chrono::steady_clock::now();
    ResidencyDecision decision = policy_->decide(walker_, book_, retired_bytes_);
    result_.decide_ns.push_back((std::chrono::steady_clock::now() - before).count());
    carry_out(decision, views);
    note_wants(decision);
    ++steps_done_;
    const std::uint64_t held = book_.held_bytes() + retired_bytes_;
    result_.held_bytes_max = std::max(result_.held_bytes_max, held);
    if (held > options_.residency.budget_bytes) ++result_.over_budget_steps;
    return decision;
  }

  void take_arrivals(double step_s) {
    for (const SimulatedSource::Ended& ended : source_.advance(step_s)) {
      if (ended.failed) {
        book_.set(ended.key, LevelStatus::kFailed);
        failed_[ended.key] = t_s_ + kRetry_s;
        ++result_.failures;
        continue;
      }
      book_.set(ended.key, LevelStatus::kResident);
      const auto since = wanted_since_s_.find(ended.key);
      if (since != wanted_since_s_.end()) result_.need_to_resident_s.push_back(t_s_ - since->second);
    }
  }

  void carry_out(const ResidencyDecision& decision, std::span<const RoomGraph::Seen> views) {
    for (const LevelKey& key : decision.evictions) {
      const int shown = book_.shown(key.room);
      book_.set(key, LevelStatus::kAbsent);
      if (book_.shown(key.room) < shown && is_in_view(key.room, views)) {
        ++result_.evictions_in_view;
        if (book_.shown(key.room) < 0) ++result_.evictions_to_nothing_in_view;
      }
      retired_.push_back({steps_done_ + options_.retire_steps, book_.bytes(key)});
      retired_bytes_ += book_.bytes(key);
    }
    for (const LevelKey& key : decision.cancellations) {
      source_.cancel(key);
      book_.set(key, LevelStatus::kAbsent);
    }
    for (const LevelKey& key : decision.loads) {
      source_.request(key, book_.bytes_disk(key));
      book_.set(key, LevelStatus::kLoading);
    }
    result_.evictions += decision.evictions.size();
    result_.cancellations += decision.cancellations.size();
    result_.loads += decision.loads.size();
  }

  static bool is_in_view(std::uint32_t room, std::span<const RoomGraph::Seen> views) {
    return std::ranges::any_of(views, [&](const RoomGraph::Seen& s) { return s.room == room && s.in_view; });
  }

  void note_wants(const ResidencyDecision& decision) {
    std::map<LevelKey, double> since;
    for (const LevelKey& key : decision.wanted) {
      if (book_.status(key) == LevelStatus::kResident) continue;
      const auto known = wanted_since_s_.find(key);
      since.emplace(key, known != wanted_since_s_.end() ? known->second : t_s_);
    }
    wanted_since_s_ = std::move(since);
  }

  void judge(const ResidencyDecision& decision, std::span<const RoomGraph::Seen> views) {
    const double missing = missing_octaves(book_, views);
    const std::uint32_t room = views.front().room;
    const int shown = book_.shown(room);
    int wanted = -1;
    for (const LevelKey& key : decision.wanted) {
      if (key.room == room) wanted = std::max(wanted, static_cast<int>(key.level));
    }
    ++result_.steps;
    result_.missing_octaves += missing;
    if (book_.levels(room) > 0 && shown < 0) ++result_.hole_steps;
    result_.dark_view_steps += std::ranges::any_of(views, [&](const RoomGraph::Seen& s) {
      return s.in_view && book_.levels(s.room) > 0 && book_.shown(s.room) < 0;
    });
    coarse_run_ = shown < wanted ? coarse_run_ + 1 : 0;
    if (coarse_run_ > 0) ++result_.coarse_steps;
    result_.coarse_run_max = std::max(result_.coarse_run_max, coarse_run_);
    if (options_.sample_s > 0.0 && t_s_ >= next_sample_s_) {
      next_sample_s_ = t_s_ + options_.sample_s;
      SimulationSample sample{t_s_,
                              static_cast<std::int32_t>(room),
                              shown,
                              wanted,
                              0,
                              book_.held_bytes() + retired_bytes_,
                              source_.bytes_moved(),
                              missing,
                              source_.depth()};
      for (const LevelKey& key : decision.wanted) sample.wanted_bytes += book_.bytes(key);
      result_.samples.push_back(sample);
    }
  }

  StreamingPolicy* policy_;
  const SimulationOptions& options_;
  LevelBook book_;
  SimulatedSource source_;
  Walker walker_;
  bool is_first_ = true;
  double t_s_ = 0.0, next_sample_s_ = 0.0;
  std::uint64_t steps_done_ = 0;
  std::deque<std::pair<std::uint64_t, std::uint64_t>> retired_;  // step at which they are free, bytes
  std::uint64_t retired_bytes_ = 0;
  std::map<LevelKey, double> wanted_since_s_, failed_;
  std::size_t coarse_run_ = 0;
  SimulationResult result_;
};

}  // namespace

SimulationResult simulate(const Manifest& manifest, const SimulatedWalk& walk, const WalkViews& views,
                          StreamingPolicy& policy, const SimulationOptions& options, StreamingPolicy* settled_by) {
  Simulation simulation(manifest, policy, options);
  if (options.starts_settled && !walk.steps.empty()) {
    simulation.settle(walk.steps.front(), walk.step_s, settled_by != nullptr ? *settled_by : policy);
  }
  for (std::size_t k = 0; k < walk.steps.size(); ++k) simulation.step(walk.steps[k], walk.step_s, views[k]);
  return simulation.take_result();
}

double missing_octaves_bound(const Manifest& manifest, const WalkViews& views, std::uint64_t budget_bytes) {
  const LevelBook book(manifest);
  double sum = 0.0;
  for (std::size_t k = 0; k < views.size(); ++k) {
    // Steps along each room's upper hull of detail over bytes, best first; the last one in part.
    std::vector<std::pair<double, double>> steps;  // octaves a byte, bytes
    double missing = 0.0;
    for (const RoomGraph::Seen& seen : views[k]) {
      const std::uint32_t levels = book.levels(seen.room);
      if (levels == 0) continue;
      const double best = book.quality({seen.room, levels - 1});
      double quality = book.quality({seen.room, 0}) - kHoleOctaves, bytes = 0.0;
      missing += seen.share * (best - quality);
      for (std::uint32_t level = 0; level < levels;) {
        double steepest = -1.0, next_bytes = 0.0;
        std::uint32_t next = levels;
        for (std::uint32_t to = level; to < levels; ++to) {
          const double to_bytes = static_cast<double>(book.bytes({seen.room, to}));
          const double slope = (book.quality({seen.room, to}) - quality) / std::max(1.0, to_bytes - bytes);
          if (slope >= steepest) {
            steepest = slope;
            next = to;
            next_bytes = to_bytes;
          }
        }
        steps.push_back({seen.share * steepest, std::max(1.0, next_bytes - bytes)});
        quality = book.quality({seen.room, next});
        bytes = next_bytes;
        level = next + 1;
      }
    }
    std::sort(steps.rbegin(), steps.rend());
    double left = budget_bytes == kUnlimitedBudget ? 1e300 : static_cast<double>(budget_bytes);
    for (const auto& [density, bytes] : steps) {
      const double taken = std::min(left, bytes);
      missing -= density * taken;
      left -= taken;
      if (left <= 0.0) break;
    }
    sum += std::max(0.0, missing);
  }
  return views.size() > 0 ? sum / static_cast<double>(views.size()) : 0.0;
}

SimulationResult simulate_policy(const std::string& policy, const Manifest& manifest, const RoomGraph& graph,
                                 const SimulatedWalk& walk, const WalkViews& views, const SimulationOptions& options) {
  if (policy == "probewalk") {
    Residency residency(manifest, options.residency);
    return simulate(manifest, walk, views, residency, options);
  }
  if (policy == "neighbours") {
    PlainPolicy neighbours(PlainRule::kNeighbours, manifest, options.residency);
    return simulate(manifest, walk, views, neighbours, options);
  }
  if (policy == "lru") {
    PlainPolicy lru(PlainRule::kInSight, manifest, options.residency);
    return simulate(manifest, walk, views, lru, options);
  }
  if (policy != "oracle") {
    throw BadUsage(fmt::format("policy {}: choose among probewalk, neighbours, lru, oracle", policy));
  }
  std::optional<SimulationResult> best;
  for (const double horizon_s : {2.0, 8.0, 32.0}) {
    // It sets out with what the product's policy has brought in.
    Residency residency(manifest, options.residency);
    OraclePolicy oracle(graph, walk, views, options.residency, horizon_s);
    SimulationResult result = simulate(manifest, walk, views, oracle, options, &residency);
    if (!best || result.missing_octaves < best->missing_octaves) best = std::move(result);
  }
  return std::move(*best);
}

}  // namespace probewalk
