// Walks for trials of streaming policies: where the head is at every step, and what it would see of each room there.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "content/pack/manifest.h"
#include "content/stream/room_graph.h"

namespace probewalk {

struct WalkStep {
  glm::dvec3 head_m{0.0};
  glm::dvec3 look{0.0, 0.0, -1.0};  // unit
  std::optional<glm::dvec3> aim_m = std::nullopt;
};

struct SimulatedWalk {
  std::string kind;  // for tables
  double step_s = 1.0 / 72.0;
  std::vector<WalkStep> steps;
};

enum class WalkKind {
  kWander,    // from room to room, now and then a pause
  kTurnBack,  // as far as a door's other side or a room beyond, and back
  kDoorway,   // stands and sways in one doorway after the other
  kTeleport,  // aims for a moment, jumps to any room, looks around
};
inline constexpr WalkKind kAllWalkKinds[] = {WalkKind::kWander, WalkKind::kTurnBack, WalkKind::kDoorway,
                                             WalkKind::kTeleport};
const char* name_of(WalkKind kind);

// A walk along the middles of rooms and portals, at 1.0 to 1.8 m/s. The same seed gives the same walk.
SimulatedWalk random_walk(const Manifest& manifest, WalkKind kind, std::uint64_t seed, double duration_s,
                          double step_s);

// What each step sees: rooms by their share of all directions, the walker's own first.
class WalkViews {
 public:
  WalkViews(const RoomGraph& graph, const SimulatedWalk& walk);
  std::span<const RoomGraph::Seen> operator[](std::size_t step) const {
    return {seen_.data() + first_[step], first_[step + 1] - first_[step]};
  }
  std::size_t size() const { return first_.size() - 1; }

 private:
  std::vector<std::size_t> first_;
  std::vector<RoomGraph::Seen> seen_;
};

}  // namespace probewalk
