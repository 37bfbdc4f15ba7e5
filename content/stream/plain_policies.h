// What the product's policy is compared with: two plain policies, and one that knows the future.
// All keep the coarsest level of every room within three portals, like the product, and differ in what is finer.
#pragma once

#include <cstdint>
#include <vector>

#include "content/stream/residency.h"
#include "content/stream/simulated_walk.h"

namespace probewalk {

enum class PlainRule {
  kNeighbours,  // the walker's room and all beside it, nearest first, each at the finest level that fits
  kInSight,  // LRU: what is looked at, when it is: the walker's room, then what shows through portals; what was looked
             // at longest ago goes first
};

class PlainPolicy final : public StreamingPolicy {
 public:
  PlainPolicy(PlainRule rule, const Manifest& manifest, const ResidencyOptions& options);
  ResidencyDecision decide(const Walker& walker, const LevelBook& book, std::uint64_t retired_bytes) override;

 private:
  PlainRule rule_;
  RoomGraph graph_;
  ResidencyOptions options_;
  ResidencyPlanner planner_;
  std::int64_t room_ = -1;
};

// Knows the whole walk: weighs rooms by how much they will be seen within `horizon_s`, loads what is needed soonest
// first. No best schedule (that is as hard as packing knapsacks over time): the best of several horizons is a good one.
class OraclePolicy final : public StreamingPolicy {
 public:
  // All outlive the policy, which is asked once for each step of the walk.
  OraclePolicy(const RoomGraph& graph, const SimulatedWalk& walk, const WalkViews& views,
               const ResidencyOptions& options, double horizon_s);
  ResidencyDecision decide(const Walker& walker, const LevelBook& book, std::uint64_t retired_bytes) override;

 private:
  std::vector<LevelKey> want(const LevelBook& book) const;

  const RoomGraph& graph_;
  const SimulatedWalk& walk_;
  const WalkViews& views_;
  ResidencyOptions options_;
  double horizon_s_;
  ResidencyPlanner planner_;
  std::size_t step_ = 0;
  std::vector<LevelKey> wanted_;  // thought through a few times a second
};

}  // namespace probewalk
