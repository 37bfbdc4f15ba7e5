// What a policy of streaming is asked and answers: numbers in, decisions out. Knows neither files nor threads nor a
// GPU.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "content/stream/level_book.h"

namespace probewalk {

inline constexpr std::uint64_t kUnlimitedBudget = ~std::uint64_t{0};

struct Walker {
  glm::dvec3 head_m{0.0};
  glm::dvec3 velocity_m_s{0.0};                    // smoothed over a few tenths of a second
  glm::dvec3 look{0.0};                            // direction of the view; 0 = all around
  std::optional<glm::dvec3> aim_m = std::nullopt;  // where a teleport may go next
};

struct ResidencyDecision {
  std::uint32_t room = 0;               // the walker's
  std::vector<LevelKey> wanted;         // most urgent first; together within the budget
  std::vector<std::uint32_t> in_view;   // rooms that should not become coarser if that can be helped
  std::vector<LevelKey> loads;          // to begin now, in this order
  std::vector<LevelKey> evictions;      // to do now
  std::vector<LevelKey> cancellations;  // loads under way that are in the way of something more urgent
  bool settled = false;                 // everything wanted is resident
  bool coarse = false;                  // the walker's room or one beside it lacks its wanted level
};

class StreamingPolicy {
 public:
  virtual ~StreamingPolicy() = default;
  // Once a frame. `retired_bytes` are evicted but not yet freed. The same calls in the same order give the same
  // decisions.
  virtual ResidencyDecision decide(const Walker& walker, const LevelBook& book, std::uint64_t retired_bytes) = 0;
};

// Carries out what is wanted within the budget, for every policy alike: what to load now, and what goes for it.
// Resident, loading and not yet freed bytes together never exceed the budget. What is not wanted goes only to make
// space, what was wanted longest ago first, what a room in view shows last of all. Costs as much as what is wanted,
// however much is resident.
class ResidencyPlanner {
 public:
  ResidencyPlanner(std::uint64_t budget_bytes, std::uint32_t most_loads)
      : budget_bytes_(budget_bytes), most_loads_(most_loads) {}

  // Fills in what follows from decision.wanted. With `keep_coarse` no coarsest level is ever evicted, whether or not it
  // is wanted.
  void plan(ResidencyDecision& decision, const LevelBook& book, std::uint64_t retired_bytes, bool keep_coarse = false);
  // It is wanted now, as far as evictions are concerned. plan() calls this for what is wanted; others may for what came
  // in without.
  void touch(LevelKey key);

 private:
  // Something that was wanted and may be held, and when it was wanted last: higher is later, no two are the same.
  struct Wanted {
    LevelKey key;
    std::uint64_t turn = 0;
  };
  const Wanted* find(LevelKey key) const;
  void cancel_unwanted(ResidencyDecision& decision, const LevelBook& book) const;
  void evict(ResidencyDecision& decision, const LevelBook& book, std::uint64_t bytes, bool keep_coarse);

  std::uint64_t budget_bytes_;
  std::uint32_t most_loads_;
  std::vector<Wanted> wanted_;  // by key: in one piece, as a frame finds the memory cold
  std::uint64_t turn_ = 0;      // the last that was given
  std::uint64_t plan_turn_ = 0; // the last before this plan
};

}  // namespace probewalk
