// Which rooms should be on the device, and at which level: the product's policy. Rules:
//  - the coarsest level of every room within three portals of the walker's, and of every room in sight, is always
//    wanted, so that no room is black (beyond three portals only where the walker's own room and the next lose nothing
//    by it); of all rooms where the building is small. That of a room that a teleport is aimed at likewise, of those
//    around it where they take nothing of what is shown in view;
//  - the rest of the budget goes to finer levels by benefit per byte: octaves of detail, times how much of the view the
//    room fills or how soon the walker may be there, over the bytes that it takes. The walker's own room is weighed
//    against all others together, so that its size does not rob it of its detail;
//  - what is there has a bonus over what is not, so that a walker who stands in a doorway makes nothing come and go;
//  - what is wanted is never evicted, and a level in view gives way to nothing but the walker's own room and the one
//    entered next; a finer one that is wanted for it comes in before it goes. What is not wanted goes only to make
//    space, what was wanted longest ago first: a walker who turns back finds the rooms still there;
//  - resident, loading and not yet freed bytes together never exceed the budget. What a level takes is what the pack
//    states, kept within what maps of its size can take, until it has been decoded and is known.
// What a decision costs depends on the rooms around the walker, not on how many the building has.
#pragma once

#include <cstdint>
#include <vector>

#include "content/stream/room_graph.h"
#include "content/stream/streaming_policy.h"

namespace probewalk {

struct ResidencyOptions {
  std::uint64_t budget_bytes = kUnlimitedBudget;  // device memory for probes
  // Of the budget: what may be held. The rest is lost between pieces of memory that come and go.
  double usable_share = 1.0;
  DeviceSamples samples = kDefaultSamples;  // with which levels lie there
  std::uint32_t coarse_portals = 3;
  std::uint32_t fine_portals = 2;
  double patience_s = 3.0;        // a room reached this much later counts 1/e as much
  double doorway_margin_m = 0.3;  // depth in the next room that makes it the walker's
  double sticky = 1.5;            // how much more what is there counts than what is not
  std::uint32_t most_loads = 4;   // under way at once; few, so that order follows the walker
};

// Device bytes that suffice wherever the walker stands: the coarsest levels that are always wanted.
std::uint64_t minimum_budget(const Manifest& manifest, const ResidencyOptions& options = {});

class Residency final : public StreamingPolicy {
 public:
  // Throws BadUsage when the budget is below the minimum; the message names the smallest that works.
  Residency(const Manifest& manifest, const ResidencyOptions& options);
  ResidencyDecision decide(const Walker& walker, const LevelBook& book, std::uint64_t retired_bytes = 0) override;

 private:
  // A room that deserves something.
  struct Candidate {
    std::uint32_t room = 0;
    std::uint32_t portals = ~std::uint32_t{0};  // from the walker's room, where that is known
    double arrival_s = 1e9;
    double share = 0.0;  // of all directions; 0 = out of sight
    bool in_view = false;
    double weight = 0.0;  // of an octave of its detail
    bool near = false;    // its coarsest level is a must
    bool fine = false;    // near enough, or in sight, for more
    bool next = false;    // the one that is entered soonest, if that is soon
    bool aimed = false;   // a teleport would lead there
  };
  std::vector<Candidate> candidates(const Walker& walker);
  std::vector<LevelKey> want(const std::vector<Candidate>& order, const LevelBook& book) const;
  void fill(ResidencyDecision& decision, const LevelBook& book, std::uint64_t retired_bytes);

  RoomGraph graph_;
  ResidencyOptions options_;  // with the usable bytes for the budget
  ResidencyPlanner planner_;
  std::int64_t room_ = -1;       // the walker's at the last decision
  bool all_coarse_ = false;      // every room's coarsest level is kept, wherever the walker is
  std::uint32_t next_fill_ = 0;  // room that is looked at next for that
};

}  // namespace probewalk
