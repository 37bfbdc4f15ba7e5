#include "content/stream/residency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "content/error.h"
#include "content/stream/level_choice.h"

namespace probewalk {

namespace {

// The building counts as small when its coarse levels take at most this share of the budget.
constexpr std::uint64_t kSmallShare = 4;
constexpr double kMostSpeed_m_s = 5.0;    // a teleport's velocity predicts nothing
constexpr double kAimDelay_s = 0.5;       // from aiming to being there
constexpr double kSoon_s = 1.5;           // a room that is entered so soon is the next one
constexpr double kUnseenWeight = 0.5;     // of a room that the walker is about to enter, against the one around them
constexpr double kViewWeight = 0.5;       // of a room that fills the view
constexpr double kBehindWeight = 0.25;    // of one that would, if the head turned
constexpr std::uint32_t kFillRooms = 16;  // looked at in one frame for the rest of a small building

ResidencyOptions usable(ResidencyOptions options) {
  if (options.usable_share < 1.0 && options.budget_bytes != kUnlimitedBudget) {
    options.budget_bytes = static_cast<std::uint64_t>(options.usable_share * static_cast<double>(options.budget_bytes));
  }
  return options;
}

}  // namespace

std::uint64_t minimum_budget(const Manifest& manifest, const ResidencyOptions& options) {
  const RoomGraph graph(manifest.rooms, manifest.portals);
  std::uint64_t most = 0;
  for (std::uint32_t room = 0; room < graph.size(); ++room) {
    std::uint64_t needed = 0;
    for (const RoomGraph::Reach& reach : graph.reach(room, glm::dvec3(0.0), options.coarse_portals)) {
      const RoomEntry& entry = manifest.rooms[reach.room];
      needed += entry.levels.empty() ? 0 : planned_bytes(entry, entry.levels.front(), options.samples);
    }
    most = std::max(most, needed);
  }
  return most;
}

Residency::Residency(const Manifest& manifest, const ResidencyOptions& options)
    : graph_(manifest.rooms, manifest.portals),
      options_(usable(options)),
      planner_(options_.budget_bytes, options.most_loads) {
  if (options_.budget_bytes < minimum_budget(manifest, options)) {
    const auto least = static_cast<std::uint64_t>(
        std::ceil(static_cast<double>(minimum_budget(manifest, options)) / options.usable_share));
    constexpr std::uint64_t kMiB = 1 << 20;
    throw BadUsage(
        fmt::format("a device budget of {:.1f} MiB is too small for this pack; the smallest that works is "
                    "--device-budget {}",
                    static_cast<double>(options.budget_bytes) / kMiB, (least + kMiB - 1) / kMiB));
  }
}

// Rooms that deserve something, most urgent first; the walker's room is the first.
std::vector<Residency::Candidate> Residency::candidates(const Walker& walker) {
  const auto room = graph_.room_of(walker.head_m, room_, options_.doorway_margin_m);
  room_ = room;
  glm::dvec3 velocity_m_s = walker.velocity_m_s;
  if (const double speed_m_s = glm::length(velocity_m_s); speed_m_s > kMostSpeed_m_s) velocity_m_s = glm::dvec3(0.0);

  std::vector<Candidate> all;
  for (const RoomGraph::Reach& reach : graph_.reach(room, walker.head_m, options_.coarse_portals, velocity_m_s)) {
    all.push_back({.room = reach.room,
                   .portals = reach.portals,
                   .arrival_s = reach.arrival_s,
                   .near = true,
                   .fine = reach.portals <= options_.fine_portals});
  }
  for (const RoomGraph::Seen& seen : graph_.seen(room, walker.head_m, walker.look)) {
    all.push_back(
        {.room = seen.room, .portals = seen.portals, .share = seen.share, .in_view = seen.in_view, .fine = true});
  }
  if (walker.aim_m) {
    // No must: the smallest budget holds the walker's surroundings only.
    const std::uint32_t target = graph_.room_of(*walker.aim_m, -1, 0.0);
    for (const RoomGraph::Reach& reach : graph_.reach(target, *walker.aim_m, options_.fine_portals)) {
      all.push_back({.room = reach.room,
                     .arrival_s = reach.arrival_s + kAimDelay_s,
                     .fine = reach.portals == 0,
                     .aimed = reach.portals == 0});
    }
  }

  std::vector<Candidate> order;
  std::ranges::stable_sort(all, {}, &Candidate::room);
  for (const Candidate& c : all) {
    if (order.empty() || order.back().room != c.room) {
      order.push_back(c);
      continue;
    }
    Candidate& merged = order.back();
    merged.portals = std::min(merged.portals, c.portals);
    merged.arrival_s = std::min(merged.arrival_s, c.arrival_s);
    merged.share = std::max(merged.share, c.share);
    merged.in_view = merged.in_view || c.in_view;
    merged.fine = merged.fine || c.fine;
    merged.aimed = merged.aimed || c.aimed;
  }
  // On the doorstep the room stays the old one for a while: the one that the head is in is as good as entered.
  const std::uint32_t entered = graph_.room_of(walker.head_m, -1, 0.0);
  Candidate* next = nullptr;
  for (Candidate& c : order) {
    if (c.room == entered) c.arrival_s = 0.0;
    if (c.portals == 1 && c.arrival_s < kSoon_s && (next == nullptr || c.arrival_s < next->arrival_s)) next = &c;
  }
  if (next != nullptr) next->next = true;
  for (Candidate& c : order) {
    c.weight = c.room == room ? 1.0
                              : std::max(kUnseenWeight * std::exp(-c.arrival_s / options_.patience_s),
                                         (c.in_view ? kViewWeight : kBehindWeight) * std::sqrt(c.share));
  }
  std::sort(order.begin(), order.end(), [&](const Candidate& a, const Candidate& b) {
    return std::tuple(a.room != room, -a.weight, a.room) < std::tuple(b.room != room, -b.weight, b.room);
  });
  return order;
}

// The levels to have, most urgent first, within the budget.
std::vector<LevelKey> Residency::want(const std::vector<Candidate>& order, const LevelBook& book) const {
  std::vector<LevelKey> wanted;
  std::uint64_t left = options_.budget_bytes;
  if (all_coarse_) left -= book.coarse_bytes();  // set aside from the beginning
  const auto take_coarse = [&](const Candidate& c) {
    const LevelKey key{c.room, 0};
    if (book.levels(c.room) == 0 || book.status(key) == LevelStatus::kFailed) return;
    if (!all_coarse_ && book.bytes(key) > left) return;
    if (!all_coarse_) left -= book.bytes(key);
    wanted.push_back(key);
  };
  for (const Candidate& c : order) {
    if (c.near) take_coarse(c);
  }
  // Rooms farther off take nothing of what the walker's own and the next one could have.
  std::uint64_t kept = 0;
  for (const Candidate& c : order) {
    if (c.room != order.front().room && !c.next) continue;
    std::uint64_t finest = 0;
    for (std::uint32_t level = 1; level < book.levels(c.room); ++level) {
      const std::uint64_t bytes = book.bytes({c.room, level});
      if (kept + bytes <= left) finest = std::max(finest, bytes);
    }
    kept += finest;
  }
  const auto take_far = [&](bool is_next) {
    for (const Candidate& c : order) {
      if (c.near || (c.share > 0.0 || c.aimed) != is_next || book.levels(c.room) == 0) continue;
      if (all_coarse_ || left >= kept + book.bytes({c.room, 0})) take_coarse(c);
    }
  };
  take_far(true);
  // Nor do those beyond a teleport's target of what is shown in view.
  for (const Candidate& c : order) {
    const int shown = c.in_view && c.room != order.front().room && !c.next ? book.shown(c.room) : 0;
    if (shown > 0) kept += book.bytes({c.room, static_cast<std::uint32_t>(shown)});
  }
  take_far(false);

  std::vector<RoomWorth> rooms;
  for (const Candidate& c : order) rooms.push_back({c.room, c.weight, c.fine, c.in_view, c.next});
  const std::vector<std::uint32_t> level = choose_levels(rooms, book, left, options_.sticky);
  // By what a byte is worth, so that the shortest waits come first among equals.
  std::vector<std::pair<double, LevelKey>> fine;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (level[k] == 0) continue;
    const LevelKey key{order[k].room, level[k]};
    const double gain = book.quality(key) - book.quality({key.room, 0});
    const double bytes = static_cast<double>(book.bytes_disk(key)) + 1.0;
    fine.push_back({k == 0 ? INFINITY : order[k].weight * gain / bytes, key});
  }
  std::sort(fine.begin(), fine.end(), [](const auto& a, const auto& b) {
    return std::tuple(-a.first, a.second) < std::tuple(-b.first, b.second);
  });
  for (const auto& [urgency, key] : fine) wanted.push_back(key);
  return wanted;
}

// The rest of a small building comes in when there is nothing else to do.
void Residency::fill(ResidencyDecision& decision, const LevelBook& book, std::uint64_t retired_bytes) {
  if (book.coarse_open() == 0) return;
  std::uint64_t occupied = book.held_bytes() + retired_bytes;
  for (const LevelKey& key : decision.loads) occupied += book.bytes(key);
  std::size_t loading = book.loading() + decision.loads.size();
  for (std::uint32_t k = 0; k < kFillRooms && loading < options_.most_loads; ++k) {
    const LevelKey key{next_fill_, 0};
    next_fill_ = (next_fill_ + 1) % book.rooms();
    if (book.levels(key.room) == 0 || book.status(key) != LevelStatus::kAbsent) continue;
    if (std::find(decision.loads.begin(), decision.loads.end(), key) != decision.loads.end()) continue;
    if (occupied > options_.budget_bytes || book.bytes(key) > options_.budget_bytes - occupied) continue;
    decision.loads.push_back(key);
    occupied += book.bytes(key);
    ++loading;
  }
}

ResidencyDecision Residency::decide(const Walker& walker, const LevelBook& book, std::uint64_t retired_bytes) {
  ResidencyDecision decision;
  if (book.rooms() == 0) return decision;
  const bool was_small = all_coarse_;
  all_coarse_ = book.coarse_bytes() <= options_.budget_bytes / kSmallShare;
  if (was_small && !all_coarse_) {  // the pack had stated too little
    for (std::uint32_t room = 0; room < book.rooms(); ++room) {
      if (book.levels(room) > 0) planner_.touch({room, 0});
    }
  }
  const std::vector<Candidate> order = candidates(walker);
  decision.room = static_cast<std::uint32_t>(room_);
  for (const Candidate& c : order) {
    if (c.in_view) decision.in_view.push_back(c.room);
  }
  decision.wanted = want(order, book);

  planner_.plan(decision, book, retired_bytes, all_coarse_);
  if (all_coarse_) {
    if (book.coarse_open() > 0) decision.settled = false;
    fill(decision, book, retired_bytes);
  }
  for (const Candidate& c : order) {
    if (c.portals > 1) continue;
    for (const LevelKey& key : decision.wanted) {
      if (key.room == c.room && book.status(key) != LevelStatus::kResident) decision.coarse = true;
    }
  }
  return decision;
}

}  // namespace probewalk
