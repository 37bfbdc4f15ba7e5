// Which rooms should be on the device, and at which level: a policy of numbers in, decisions out. Knows neither files
// nor threads nor a GPU. Rules:
//  - the coarsest level of every room within three portals of the walker's is always wanted, so that no room is black;
//    of all rooms where the building is small;
//  - then the finest level that fits of the walker's room, and of rooms seen through up to two portals: first the one
//    that the walker is about to enter, then nearer ones first;
//  - what is wanted is never evicted; what is not is evicted only to make space, farthest first: a walker who turns
//    back finds the rooms still there;
//  - resident, loading and not yet freed bytes together never exceed the budget. What a level takes is what the pack
//    states, kept within what maps of its size can take, until it has been decoded and is known.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "content/pack/manifest.h"
#include "content/stream/room_graph.h"

namespace probewalk {

inline constexpr std::uint64_t kUnlimitedBudget = ~std::uint64_t{0};

struct ResidencyOptions {
  std::uint64_t budget_bytes = kUnlimitedBudget;  // device memory for probes
  std::uint32_t coarse_portals = 3;
  std::uint32_t fine_portals = 2;
  double look_ahead_s = 1.0;      // of the walker's motion
  double doorway_margin_m = 0.3;  // depth in the next room that makes it the walker's
  double sticky_m = 1.0;          // how much nearer another room must be to take a fine level's place
  std::uint32_t most_loads = 4;   // under way at once; few, so that order follows the walker
};

struct LevelKey {
  std::uint32_t room = 0;
  std::uint32_t level = 0;
  auto operator<=>(const LevelKey&) const = default;
};

enum class LevelStatus : std::uint8_t {
  kAbsent,
  kLoading,
  kResident,
  kFailed,  // its chunk is bad: never asked for again, the next coarser level stands in
};
using LevelStatuses = std::vector<std::vector<LevelStatus>>;  // [room][level], as the manifest

struct Walker {
  glm::dvec3 head_m{0.0};
  glm::dvec3 velocity_m_s{0.0};
};

struct ResidencyDecision {
  std::uint32_t room = 0;          // the walker's
  std::vector<LevelKey> wanted;    // most urgent first; together within the budget
  std::vector<LevelKey> loads;     // to begin now, in this order
  std::vector<LevelKey> evictions;  // to do now
  bool settled = false;            // everything wanted is resident
  bool coarse = false;             // the walker's room or one beside it lacks its wanted level
};

// Device bytes to set aside for a level of a room before it has been decoded.
std::uint64_t planned_bytes(const RoomEntry& room, const LevelEntry& level);

// Device bytes that suffice wherever the walker stands: the coarsest levels that are always wanted.
std::uint64_t minimum_budget(const Manifest& manifest, const ResidencyOptions& options = {});

class Residency {
 public:
  // Throws BadUsage when the budget is below the minimum; the message names the smallest that works.
  Residency(const Manifest& manifest, const ResidencyOptions& options);

  // Every level not yet asked for.
  LevelStatuses absent() const;
  // `retired_bytes` are evicted but not yet freed. The same calls in the same order give the same decisions.
  ResidencyDecision decide(const Walker& walker, const LevelStatuses& status, std::uint64_t retired_bytes = 0);

  // Device bytes that a level counts for.
  std::uint64_t bytes(LevelKey key) const { return bytes_[key.room][key.level]; }
  // It has been decoded, and takes this much.
  void learn(LevelKey key, std::uint64_t bytes);

 private:
  struct Candidate;
  std::vector<Candidate> candidates(const Walker& walker, const LevelStatuses& status);
  std::vector<LevelKey> choose(const std::vector<Candidate>& order, const LevelStatuses& status) const;
  bool is_small() const;

  RoomGraph graph_;
  std::vector<std::vector<std::uint64_t>> bytes_;  // [room][level]
  ResidencyOptions options_;
  bool all_coarse_ = false;  // every room's coarsest level is kept, wherever the walker is
  std::int64_t room_ = -1;   // the walker's at the last decision
};

}  // namespace probewalk
