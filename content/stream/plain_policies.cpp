#include "content/stream/plain_policies.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "content/stream/level_choice.h"

namespace probewalk {

namespace {

// Takes levels until the budget is spent.
class Purse {
 public:
  Purse(const LevelBook& book, std::uint64_t budget_bytes) : book_(book), left_bytes_(budget_bytes) {}

  bool take(LevelKey key) {
    if (book_.status(key) == LevelStatus::kFailed || book_.bytes(key) > left_bytes_) return false;
    left_bytes_ -= book_.bytes(key);
    wanted.push_back(key);
    return true;
  }
  void take_coarse(std::uint32_t room) {
    if (book_.levels(room) > 0) take({room, 0});
  }
  void take_finest(std::uint32_t room) {
    for (std::uint32_t level = book_.levels(room); level-- > 1;) {
      if (take({room, level})) return;
    }
  }
  std::uint64_t left_bytes() const { return left_bytes_; }

  std::vector<LevelKey> wanted;

 private:
  const LevelBook& book_;
  std::uint64_t left_bytes_;
};

constexpr std::size_t kStepsAThought = 6;

}  // namespace

PlainPolicy::PlainPolicy(PlainRule rule, const Manifest& manifest, const ResidencyOptions& options)
    : rule_(rule),
      graph_(manifest.rooms, manifest.portals),
      options_(options),
      planner_(options.budget_bytes, options.most_loads) {}

ResidencyDecision PlainPolicy::decide(const Walker& walker, const LevelBook& book, std::uint64_t retired_bytes) {
  ResidencyDecision decision;
  if (book.rooms() == 0) return decision;
  room_ = decision.room = graph_.room_of(walker.head_m, room_, options_.doorway_margin_m);
  Purse purse(book, options_.budget_bytes);
  const auto reach = graph_.reach(decision.room, walker.head_m, options_.coarse_portals);
  for (const RoomGraph::Reach& r : reach) purse.take_coarse(r.room);
  if (rule_ == PlainRule::kNeighbours) {
    for (const RoomGraph::Reach& r : reach) {
      if (r.portals <= 1) purse.take_finest(r.room);
    }
  } else {
    auto seen = graph_.seen(decision.room, walker.head_m, walker.look);
    std::erase_if(seen, [](const RoomGraph::Seen& s) { return !s.in_view; });
    std::sort(seen.begin(), seen.end(), [](const RoomGraph::Seen& a, const RoomGraph::Seen& b) {
      return std::tuple(a.portals > 0, -a.share, a.room) < std::tuple(b.portals > 0, -b.share, b.room);
    });
    for (const RoomGraph::Seen& s : seen) purse.take_finest(s.room);
  }
  decision.wanted = std::move(purse.wanted);
  planner_.plan(decision, book, retired_bytes);
  return decision;
}

OraclePolicy::OraclePolicy(const RoomGraph& graph, const SimulatedWalk& walk, const WalkViews& views,
                           const ResidencyOptions& options, double horizon_s)
    : graph_(graph),
      walk_(walk),
      views_(views),
      options_(options),
      horizon_s_(horizon_s),
      planner_(options.budget_bytes, options.most_loads) {}

std::vector<LevelKey> OraclePolicy::want(const LevelBook& book) const {
  struct Need {
    double weight = 0.0, first_s = 1e9;
  };
  std::map<std::uint32_t, Need> needs;
  const double sample_s = std::max(0.25, horizon_s_ / 32.0);
  double total = 0.0;
  for (double ahead_s = 0.0; ahead_s <= horizon_s_; ahead_s += sample_s) {
    const std::size_t step = step_ + static_cast<std::size_t>(ahead_s / walk_.step_s);
    if (step >= views_.size()) break;
    const double fading = std::exp(-2.0 * ahead_s / horizon_s_);
    total += fading;
    for (const RoomGraph::Seen& seen : views_[step]) {
      Need& need = needs[seen.room];
      need.weight += seen.share * fading;
      need.first_s = std::min(need.first_s, ahead_s);
    }
  }
  const std::uint32_t own = views_[step_].front().room;
  Purse purse(book, options_.budget_bytes);
  for (const RoomGraph::Reach& r : graph_.reach(own, walk_.steps[step_].head_m, options_.coarse_portals)) {
    purse.take_coarse(r.room);
  }
  std::vector<std::tuple<double, std::uint32_t>> by_time;
  for (const auto& [room, need] : needs) by_time.push_back({need.first_s, room});
  std::sort(by_time.begin(), by_time.end());
  for (const auto& [first_s, room] : by_time) {
    if (std::find(purse.wanted.begin(), purse.wanted.end(), LevelKey{room, 0}) == purse.wanted.end()) {
      purse.take_coarse(room);
    }
  }
  std::vector<RoomWorth> rooms;
  for (const auto& [room, need] : needs) rooms.push_back({room, need.weight / total, true, false});
  std::sort(rooms.begin(), rooms.end(), [](const RoomWorth& a, const RoomWorth& b) {
    return std::tuple(-a.weight, a.room) < std::tuple(-b.weight, b.room);
  });
  const std::vector<std::uint32_t> level = choose_levels(rooms, book, purse.left_bytes(), 1.2);
  std::vector<std::tuple<double, double, LevelKey>> fine;
  for (std::size_t k = 0; k < rooms.size(); ++k) {
    if (level[k] == 0) continue;
    const LevelKey key{rooms[k].room, level[k]};
    const double density = rooms[k].weight / (static_cast<double>(book.bytes_disk(key)) + 1.0);
    // What is in sight within a second is a matter of what it is worth, the rest of when it is needed.
    fine.push_back({std::max(1.0, needs[key.room].first_s), -density, key});
  }
  std::sort(fine.begin(), fine.end());
  for (const auto& [first_s, density, key] : fine) purse.wanted.push_back(key);
  return std::move(purse.wanted);
}

ResidencyDecision OraclePolicy::decide(const Walker& /*walker*/, const LevelBook& book, std::uint64_t retired_bytes) {
  for (std::uint32_t room = 0; step_ == 0 && room < book.rooms(); ++room) {  // what is there already may go, too
    for (std::uint32_t level = 0; level < book.levels(room); ++level) {
      if (book.status({room, level}) == LevelStatus::kResident) planner_.touch({room, level});
    }
  }
  ResidencyDecision decision;
  if (step_ % kStepsAThought == 0) wanted_ = want(book);
  decision.room = views_[step_].front().room;
  decision.wanted = wanted_;
  planner_.plan(decision, book, retired_bytes);
  ++step_;
  return decision;
}

}  // namespace probewalk
