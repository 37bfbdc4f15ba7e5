#include "content/stream/residency.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "content/error.h"
#include "content/probe/device_probe.h"

namespace probewalk {

namespace {

// The building counts as small when its coarse levels take at most this share of the budget.
constexpr std::uint64_t kSmallShare = 4;
constexpr double kFarthestLookAhead_m = 5.0;  // a teleport's velocity predicts nothing

std::uint64_t coarse_bytes(const RoomEntry& room) {
  return room.levels.empty() ? 0 : planned_bytes(room, room.levels.front());
}

bool occupies(LevelStatus status) { return status == LevelStatus::kLoading || status == LevelStatus::kResident; }

// Something beyond its coarsest level is there or on its way.
bool holds_fine(const std::vector<LevelStatus>& levels) {
  return levels.size() > 1 && std::any_of(levels.begin() + 1, levels.end(), occupies);
}

}  // namespace

// A room in the order in which it should be served.
struct Residency::Candidate {
  std::uint32_t room = 0;
  std::uint32_t portals = 0;  // from the walker's room
  double distance_m = 0.0;
  bool near = true;   // within the portals whose coarsest levels are always wanted
  bool fine = false;  // near enough for more than its coarsest level
};

std::uint64_t planned_bytes(const RoomEntry& room, const LevelEntry& level) {
  const auto bytes = [&](std::uint64_t cut_cells) {
    return room.probe_count * device_probe_bytes(static_cast<int>(level.geometry_size),
                                                 static_cast<int>(level.radiance_size), cut_cells);
  };
  const std::uint64_t cells = std::uint64_t{level.geometry_size} * level.geometry_size;
  return std::clamp(level.bytes_device, bytes(0), bytes(cells)) + room.probe_count * kMostPadding_bytes;
}

std::uint64_t minimum_budget(const Manifest& manifest, const ResidencyOptions& options) {
  const RoomGraph graph(manifest.rooms, manifest.portals);
  std::uint64_t most = 0;
  for (std::uint32_t room = 0; room < graph.size(); ++room) {
    std::uint64_t needed = 0;
    for (const RoomGraph::Reach& reach : graph.reach(room, glm::dvec3(0.0), options.coarse_portals)) {
      needed += coarse_bytes(manifest.rooms[reach.room]);
    }
    most = std::max(most, needed);
  }
  return most;
}

Residency::Residency(const Manifest& manifest, const ResidencyOptions& options)
    : graph_(manifest.rooms, manifest.portals), options_(options) {
  for (const RoomEntry& room : manifest.rooms) {
    auto& levels = bytes_.emplace_back();
    for (const LevelEntry& level : room.levels) levels.push_back(planned_bytes(room, level));
  }
  const std::uint64_t least = minimum_budget(manifest, options);
  if (options.budget_bytes < least) {
    constexpr std::uint64_t kMiB = 1 << 20;
    throw BadUsage(fmt::format("a device budget of {:.1f} MiB is too small for this pack; the smallest that works is "
                               "--device-budget {}",
                               static_cast<double>(options.budget_bytes) / kMiB, (least + kMiB - 1) / kMiB));
  }
  all_coarse_ = is_small();
}

bool Residency::is_small() const {
  std::uint64_t all = 0;
  for (const auto& levels : bytes_) all += levels.empty() ? 0 : levels.front();
  return all <= options_.budget_bytes / kSmallShare;
}

void Residency::learn(LevelKey key, std::uint64_t bytes) {
  bytes_[key.room][key.level] = bytes;
  if (key.level == 0) all_coarse_ = is_small();
}

LevelStatuses Residency::absent() const {
  LevelStatuses status;
  for (const auto& levels : bytes_) status.emplace_back(levels.size(), LevelStatus::kAbsent);
  return status;
}

// Rooms that deserve something, most urgent first.
std::vector<Residency::Candidate> Residency::candidates(const Walker& walker, const LevelStatuses& status) {
  const auto room = graph_.room_of(walker.head_m, room_, options_.doorway_margin_m);
  room_ = room;
  glm::dvec3 ahead_m = walker.velocity_m_s * options_.look_ahead_s;
  if (const double length_m = glm::length(ahead_m); length_m > kFarthestLookAhead_m)
    ahead_m *= kFarthestLookAhead_m / length_m;
  const auto room_ahead = graph_.room_of(walker.head_m + ahead_m, room, options_.doorway_margin_m);

  std::vector<Candidate> order;
  std::vector<bool> near(graph_.size(), false);
  for (const auto& reach : graph_.reach(room, walker.head_m, options_.coarse_portals)) {
    order.push_back({reach.room, reach.portals, reach.distance_m, true, reach.portals <= options_.fine_portals});
    near[reach.room] = true;
  }
  // What lies ahead changes the order only: a head that sways must not change what is wanted.
  const auto rank = [&](const Candidate& c) {
    const double sticky_m = holds_fine(status[c.room]) ? options_.sticky_m : 0.0;
    return std::tuple(c.room != room, c.room != room_ahead, c.distance_m - sticky_m, c.room);
  };
  std::sort(order.begin(), order.end(), [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); });
  if (all_coarse_) {
    for (std::uint32_t other = 0; other < graph_.size(); ++other) {
      if (!near[other]) order.push_back({other, ~std::uint32_t{0}, 1e9, false, false});
    }
  }
  return order;
}

// The levels to have, within the budget: the coarsest of the rooms that always have it, then the finest that fits, room
// by room, then the rest of a small building, whose space is set aside from the beginning.
std::vector<LevelKey> Residency::choose(const std::vector<Candidate>& order, const LevelStatuses& status) const {
  std::vector<LevelKey> wanted, rest;
  std::uint64_t left = options_.budget_bytes;
  const auto take = [&](LevelKey key, std::vector<LevelKey>& list) {
    if (status[key.room][key.level] == LevelStatus::kFailed || bytes(key) > left) return false;
    left -= bytes(key);
    list.push_back(key);
    return true;
  };
  for (const Candidate& c : order) {
    if (!status[c.room].empty()) take({c.room, 0}, c.near ? wanted : rest);
  }
  for (const Candidate& c : order) {
    if (!c.fine) continue;
    for (std::size_t level = status[c.room].size(); level-- > 1;) {
      if (take({c.room, static_cast<std::uint32_t>(level)}, wanted)) break;
    }
  }
  wanted.insert(wanted.end(), rest.begin(), rest.end());
  return wanted;
}

ResidencyDecision Residency::decide(const Walker& walker, const LevelStatuses& status, std::uint64_t retired_bytes) {
  ResidencyDecision decision;
  const std::vector<Candidate> order = candidates(walker, status);
  decision.room = static_cast<std::uint32_t>(room_);
  decision.wanted = choose(order, status);
  const std::set<LevelKey> wanted(decision.wanted.begin(), decision.wanted.end());

  std::uint64_t occupied = retired_bytes;
  std::uint32_t loading = 0;
  std::vector<LevelKey> spare;  // resident but not wanted
  for (std::uint32_t room = 0; room < status.size(); ++room) {
    for (std::uint32_t level = 0; level < status[room].size(); ++level) {
      const LevelKey key{room, level};
      if (!occupies(status[room][level])) continue;
      occupied += bytes(key);
      if (status[room][level] == LevelStatus::kLoading) ++loading;
      else if (!wanted.contains(key)) spare.push_back(key);
    }
  }

  // Evicted bytes are only free once no frame reads them, so they count until the caller says they are gone.
  std::uint64_t short_of = 0;
  decision.settled = true;
  for (const LevelKey& key : decision.wanted) {
    const LevelStatus s = status[key.room][key.level];
    if (s != LevelStatus::kResident) decision.settled = false;
    if (s != LevelStatus::kAbsent) continue;
    const bool fits = occupied <= options_.budget_bytes && bytes(key) <= options_.budget_bytes - occupied;
    if (!fits) {
      // Only the most urgent one waits for space; later ones would take it away.
      short_of = bytes(key) - std::min(bytes(key), options_.budget_bytes - std::min(options_.budget_bytes, occupied));
      break;
    }
    if (loading == options_.most_loads) break;
    ++loading;
    occupied += bytes(key);
    decision.loads.push_back(key);
  }

  if (short_of > retired_bytes) {
    std::vector<double> distance_m(graph_.size(), 1e12);
    for (const Candidate& c : order) distance_m[c.room] = c.distance_m;
    // Farthest first; of one room the finest first.
    std::sort(spare.begin(), spare.end(), [&](const LevelKey& a, const LevelKey& b) {
      return std::tuple(-distance_m[a.room], b) < std::tuple(-distance_m[b.room], a);
    });
    std::uint64_t freed = retired_bytes;
    for (const LevelKey& key : spare) {
      if (freed >= short_of) break;
      freed += bytes(key);
      decision.evictions.push_back(key);
    }
  }

  for (const Candidate& c : order) {
    if (c.portals > 1) continue;
    for (const LevelKey& key : decision.wanted) {
      if (key.room == c.room && status[key.room][key.level] != LevelStatus::kResident) decision.coarse = true;
    }
  }
  return decision;
}

}  // namespace probewalk
