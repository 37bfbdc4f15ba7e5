#include "content/bake/plan/planner.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <set>

#include "content/bake/plan/cell_table.h"
#include "content/bake/plan/planned_maps.h"
#include "content/bake/plan/probe_choice.h"
#include "content/error.h"
#include "content/probe/host_address.h"
#include "content/probe/probe_set.h"

namespace probewalk {
namespace {

constexpr int kCoarsest = 32;             // sides that every room starts with
constexpr double kMargin = 0.9;           // of the target that sizes are chosen by: other eyes see a little worse
constexpr double kUnansweredShare = 0.4;  // of the target that the first choice of probes may leave
constexpr double kLeastImprovement = 0.08;
constexpr int kFruitless = 2;  // steps along one dial, after which it is left
constexpr int kMostRounds = 60;
constexpr int kHeldBackAttempts = 3;
constexpr double kGrowth = 1.9;       // what doubling a side adds, in the map's own bytes
constexpr double kWorstShare = 0.85;  // a budget goes first to rooms whose error is at least this share of the worst

enum Dial { kProbes, kGeometry, kRadiance, kDials };
constexpr std::array<const char*, kDials> kCoarserNames{"a probe less", "half the geometry", "half the radiance"};

struct Room {
  int n = kCoarsest, r = kCoarsest;
  double target = 0.0;
  RoomError error;
  double before = HUGE_VAL;  // error before the last step
  int last = -1;             // dial of the last step
  std::array<int, kDials> fruitless{};
  bool closed = false;  // nothing more can be done
};

// A room's views, of so many over all rooms.
ViewCounts counts_for(std::size_t rooms, double effort, double rays, double patches, double most_patches) {
  const double each = 1.0 / double(std::max<std::size_t>(1, rooms));
  return {int(effort * std::clamp(rays * each, 500.0, 3000.0)),
          patches > 0.0 ? int(effort * std::clamp(patches * each, 48.0, most_patches)) : 0};
}

class Planner {
 public:
  Planner(const Space& space, const HeadSpace& heads, const RayScene& triangles, const LightField& light,
          const Exposure& exposure, MapStore& maps, const PlanTarget& target, Progress& progress)
      : space_(space),
        heads_(heads),
        triangles_(triangles),
        light_(light),
        exposure_(exposure),
        target_(target),
        progress_(progress),
        grid_(plan_grid(heads)),
        maps_(maps, target.samples),
        choosing_(sample(0, counts_for(space.rooms.size(), target.effort, 8000, 0, 0))),
        sizing_(sample(1, counts_for(space.rooms.size(), target.effort, 16000, 1600, 200))),
        choice_(space, heads, triangles, choosing_.rays, grid_, candidate_side(), progress),
        rooms_(space.rooms.size()) {}

  Plan run() {
    const auto start = std::chrono::steady_clock::now();
    const double first = target_.error > 0.0 ? kUnansweredShare * target_.error : 0.1;
    choice_.choose(first, target_.most_probes);
    for (Room& room : rooms_) room.target = kMargin * target_.error;
    Plan plan;
    plan.target = target_;
    std::vector<RoomError> held_back;
    for (int attempt = 0;; ++attempt) {
      refine();
      if (target_.error > 0.0) coarsen();
      const WalkerViews views =
          sample(2 + std::uint32_t(attempt), counts_for(rooms_.size(), target_.effort, 24000, 2400, 500));
      arrange();
      held_back = measure(views);
      plan.held_back = mean_error(held_back, views.room_share);
      plan.held_back_rays = views.rays.size();
      plan.held_back_pictures = views.patches.size();
      plan.kept = target_.error > 0.0 ? plan.held_back.bound() <= target_.error : bytes_disk() <= target_.budget_bytes;
      // Every room is to keep it, with confidence, so that the mean does with something to spare.
      if (target_.error <= 0.0 || attempt + 1 == kHeldBackAttempts || !tighten(held_back)) break;
    }
    describe(plan, held_back);
    plan.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return plan;
  }

 private:
  int candidate_side() const { return space_.rooms.size() > 12 ? 64 : 128; }

  WalkerViews sample(std::uint32_t set, ViewCounts counts) {
    return sample_views(space_, heads_, triangles_, light_, counts, set, progress_);
  }
  std::uint32_t room_of(std::uint32_t candidate) const { return choice_.coverage().candidates()[candidate].room; }
  glm::dvec3 position(std::uint32_t candidate) const { return choice_.coverage().candidates()[candidate].position_m; }
  const std::vector<std::uint32_t>& chosen() const { return choice_.coverage().chosen(); }
  std::size_t probes_in(std::size_t room) const {
    return std::size_t(
        std::count_if(chosen().begin(), chosen().end(), [&](std::uint32_t c) { return room_of(c) == room; }));
  }

  // The grid's table for the chosen probes.
  void arrange() {
    if (arranged_ == chosen()) return;
    fill_cell_table(grid_, choice_.coverage(), choosing_.rays, triangles_);
    arranged_ = chosen();
  }

  // Records of the chosen probes in the rooms' sizes; makes the maps that are missing.
  std::vector<RoomError> measure(const WalkerViews& views, int only_room = -1) {
    std::uint64_t missing = 0;
    for (const std::uint32_t c : arranged_) {
      const Room& room = rooms_[room_of(c)];
      missing += maps_.has_geometry(c, room.n) ? 0 : std::uint64_t(room.n) * room.n;
      missing += maps_.has_radiance(c, room.r) ? 0 : std::uint64_t(room.r) * room.r;
    }
    if (missing > 0) progress_.begin("planning", missing, "texels");
    std::vector<ProbeRecord> records;
    for (const std::uint32_t c : arranged_) {
      if (progress_.cancelled())
        throw Interrupted("interrupted while planning; finished maps are kept, the same command goes on from there");
      const Room& room = rooms_[room_of(c)];
      const std::uint64_t work = (maps_.has_geometry(c, room.n) ? 0 : std::uint64_t(room.n) * room.n) +
                                 (maps_.has_radiance(c, room.r) ? 0 : std::uint64_t(room.r) * room.r);
      records.push_back(maps_.record(c, position(c), room.n, room.r));
      if (work > 0) progress_.advance(work);
    }
    ProbeView view{grid_constants(grid_, records.size()), default_dials(double(exposure_.radiance_scale))};
    view.grid.table_address = host_address(grid_.probe.data());
    view.grid.probes_address = host_address(records.data());
    return measure_error(views, view, triangles_, float(exposure_.exposure_ev), rooms_.size(), only_room);
  }

  double target_of(const Room& room) const {
    // Under a budget every room strives for less than it has.
    return target_.error > 0.0 ? room.target : 0.6 * room.error.worst();
  }
  bool passes(const Room& room) const { return !room.error.measured || room.error.worst() <= room.target; }

  std::uint64_t bytes_of_room(std::size_t room) {
    std::uint64_t bytes = 0;
    for (const std::uint32_t c : chosen()) {
      if (room_of(c) == room) bytes += bytes_of_probe(c);
    }
    return bytes;
  }
  std::uint64_t bytes_of_probe(std::uint32_t c) {
    const Room& room = rooms_[room_of(c)];
    return maps_.geometry(c, position(c), room.n).bytes_disk + maps_.radiance(c, position(c), room.r).bytes_disk;
  }
  std::uint64_t bytes_disk() {
    std::uint64_t bytes = 0;
    for (std::size_t room = 0; room < rooms_.size(); ++room) bytes += bytes_of_room(room) + coarse_bytes(room);
    return bytes;
  }
  // Of the level that goes before the finest.
  std::uint64_t coarse_bytes(std::size_t k) {
    const Room& room = rooms_[k];
    if (std::max(room.n, room.r) <= target_.coarse_side) return 0;
    std::uint64_t bytes = 0;
    for (const std::uint32_t c : chosen()) {
      if (room_of(c) != k) continue;
      bytes += maps_.geometry(c, position(c), std::min(room.n, target_.coarse_side)).bytes_disk +
               maps_.radiance(c, position(c), std::min(room.r, target_.coarse_side)).bytes_disk;
    }
    return bytes;
  }

  void refine() {
    for (int round = 0; round < kMostRounds; ++round) {
      arrange();
      const std::vector<RoomError> errors = measure(sizing_);
      bool stepped = false;
      double worst = 0.0;
      for (std::size_t k = 0; k < rooms_.size(); ++k) {
        rooms_[k].error = errors[k];
        if (!rooms_[k].closed && errors[k].measured) worst = std::max(worst, errors[k].worst());
      }
      const std::uint64_t spent = target_.budget_bytes > 0 ? bytes_disk() : 0;
      std::uint64_t left = target_.budget_bytes > spent ? target_.budget_bytes - spent : 0;
      if (target_.budget_bytes > 0 && spent > target_.budget_bytes && take_back()) continue;
      last_steps_.clear();
      for (std::size_t k = 0; k < rooms_.size(); ++k) {
        Room& room = rooms_[k];
        if (!room.error.measured || room.closed || (target_.error > 0.0 && passes(room))) continue;
        note_effect(room);
        if (target_.error <= 0.0 && room.error.worst() < kWorstShare * worst) continue;
        if (step(k, left)) {
          stepped = true;
        } else {
          room.closed = true;
          stepped = stepped || target_.error <= 0.0;  // the next worst are looked at then
        }
      }
      if (!stepped) return;
    }
  }

  void note_effect(Room& room) {
    const double now = room.error.worst();
    if (room.last >= 0) {
      int& fruitless = room.fruitless[std::size_t(room.last)];
      fruitless = now > room.before * (1.0 - kLeastImprovement) ? fruitless + 1 : 0;
    }
    room.last = -1;
  }

  // One step to what promises most a byte. `left`: bytes that may still be spent under a budget.
  bool step(std::size_t k, std::uint64_t& left) {
    Room& room = rooms_[k];
    const double target = target_of(room);
    const double lost = room.error.lost(), flip = room.error.flip;
    const double over_lost = lost > target ? 1.0 : 0.0, over_flip = flip > target ? 1.0 : 0.0;
    const double unseen_share = lost > 0.0 ? room.error.unseen / lost : 0.0;
    double geometry_bytes = 0.0, radiance_bytes = 0.0;
    const double probes = double(std::max<std::size_t>(1, probes_in(k)));
    for (const std::uint32_t c : chosen()) {
      if (room_of(c) != k) continue;
      geometry_bytes += double(maps_.geometry(c, position(c), room.n).bytes_disk);
      radiance_bytes += double(maps_.radiance(c, position(c), room.r).bytes_disk);
    }
    const bool may_add = room.fruitless[kProbes] < kFruitless && chosen().size() < target_.most_probes;
    const double next = may_add ? choice_.next_gain(std::uint32_t(k)) : 0.0;
    std::array<double, kDials> gain{}, cost{};
    gain[kProbes] =
        next * over_lost + (lost > 0.0 ? room.error.flip_places * std::min(1.0, next / lost) : 0.0) * over_flip;
    cost[kProbes] = (geometry_bytes + radiance_bytes) / probes;
    gain[kGeometry] = 0.5 * (1.0 - unseen_share) * (lost * over_lost + room.error.flip_places * over_flip);
    cost[kGeometry] = kGrowth * geometry_bytes;
    gain[kRadiance] = 0.35 * std::max(0.0, flip - room.error.flip_places) * over_flip;
    cost[kRadiance] = kGrowth * radiance_bytes;
    if (!may_add) gain[kProbes] = 0.0;
    if (room.n >= target_.most_geometry || room.fruitless[kGeometry] >= kFruitless) gain[kGeometry] = 0.0;
    if (room.r >= target_.most_radiance || room.fruitless[kRadiance] >= kFruitless) gain[kRadiance] = 0.0;
    int best = -1;
    for (int dial = 0; dial < kDials; ++dial) {
      if (!(gain[dial] > 1e-4)) continue;
      if (target_.budget_bytes > 0 && cost[dial] > double(left)) continue;
      if (best < 0 || gain[dial] / (cost[dial] + 1.0) > gain[best] / (cost[best] + 1.0)) best = dial;
    }
    if (best < 0) return false;
    last_steps_.push_back({k, room.n, room.r, chosen().size(), best});
    if (best == kProbes && !choice_.add_for(std::uint32_t(k))) {
      room.fruitless[kProbes] = kFruitless;
      last_steps_.pop_back();
      return step(k, left);
    }
    if (best == kGeometry) room.n *= 2;
    if (best == kRadiance) room.r *= 2;
    room.last = best;
    room.before = room.error.worst();
    left -= std::min(left, std::uint64_t(cost[best]));
    return true;
  }

  // The last round's steps took more than the budget: the last of them is undone and its room closed.
  bool take_back() {
    if (last_steps_.empty()) return false;
    const Step last = last_steps_.back();
    last_steps_.pop_back();
    Room& room = rooms_[last.room];
    room.closed = true;
    room.n = last.n;
    room.r = last.r;
    if (last.dial == kProbes) {
      std::vector<std::uint32_t> fewer = chosen();
      for (std::size_t k = fewer.size(); k-- > 0;) {
        if (room_of(fewer[k]) != last.room) continue;
        fewer.erase(fewer.begin() + std::ptrdiff_t(k));
        break;
      }
      choice_.set_chosen(std::move(fewer));
    }
    return true;
  }

  // Takes back what turned out needless, and remembers what the next coarser choice of each kind would have cost.
  void coarsen() {
    for (std::size_t k = 0; k < rooms_.size(); ++k) {
      Room& room = rooms_[k];
      if (!room.error.measured || probes_in(k) == 0) continue;
      coarser_[k].clear();
      for (const int dial : {kRadiance, kGeometry, kProbes}) {
        for (;;) {
          const Room kept = room;
          const std::vector<std::uint32_t> kept_probes = chosen();
          if (!make_coarser(k, dial)) break;
          arrange();
          const RoomError error = measure(sizing_, int(k))[k];
          const bool enough = error.worst() <= std::max(room.target, 1.005 * kept.error.worst());
          if (enough && !harms_others(k, dial)) {
            room.error = error;
            continue;
          }
          coarser_[k].push_back(
              {kCoarserNames[std::size_t(dial)], {room.n, room.r}, probes_in(k), bytes_of_room(k), error});
          room = kept;
          choice_.set_chosen(kept_probes);
          break;
        }
      }
    }
    arrange();
    const std::vector<RoomError> errors = measure(sizing_);
    for (std::size_t k = 0; k < rooms_.size(); ++k) rooms_[k].error = errors[k];
  }
  bool make_coarser(std::size_t k, int dial) {
    Room& room = rooms_[k];
    if (dial == kProbes) {
      if (probes_in(k) < 2) return false;
      const std::optional<std::uint32_t> least = choice_.least_needed(std::uint32_t(k));
      if (!least) return false;
      std::vector<std::uint32_t> fewer = chosen();
      std::erase(fewer, *least);
      choice_.set_chosen(std::move(fewer));
      return true;
    }
    int& side = dial == kGeometry ? room.n : room.r;
    if (side <= kSmallest) return false;
    side /= 2;
    return true;
  }
  // A room's probes also serve those who look in through its doors.
  bool harms_others(std::size_t k, int dial) {
    if (dial == kRadiance || rooms_.size() < 2) return false;
    std::set<int> beside;
    for (const Portal& portal : space_.portals) {
      if (portal.room_a == int(k)) beside.insert(portal.room_b);
      if (portal.room_b == int(k)) beside.insert(portal.room_a);
    }
    for (const int other : beside) {
      const Room& room = rooms_[std::size_t(other)];
      if (!room.error.measured) continue;
      if (measure(sizing_, other)[std::size_t(other)].worst() > std::max(room.target, 1.01 * room.error.worst()))
        return true;
    }
    return false;
  }

  // Rooms that fail on views they were not chosen by aim lower. Whether any can.
  bool tighten(const std::vector<RoomError>& held_back) {
    bool any = false;
    for (std::size_t k = 0; k < rooms_.size(); ++k) {
      Room& room = rooms_[k];
      if (!held_back[k].measured || held_back[k].bound() <= target_.error || room.closed) continue;
      room.target =
          std::min(room.target, room.error.worst()) * std::clamp(target_.error / held_back[k].bound(), 0.5, 0.97);
      any = true;
    }
    return any;
  }

  void describe(Plan& plan, const std::vector<RoomError>& held_back) {
    plan.candidates = choice_.coverage().candidates().size();
    plan.grid = grid_;
    std::vector<std::uint32_t> place(arranged_.size());
    std::uint32_t next = 0;
    for (std::size_t k = 0; k < rooms_.size(); ++k) {
      PlannedRoom planned;
      const Room& room = rooms_[k];
      planned.id = space_.rooms[k].id;
      planned.size = {room.n, room.r};
      planned.chosen_on = room.error;
      planned.held_back = held_back[k];
      planned.coarser = coarser_[k];
      for (std::size_t i = 0; i < arranged_.size(); ++i) {
        const std::uint32_t c = arranged_[i];
        if (room_of(c) != k) continue;
        place[i] = next++;
        planned.probes_m.push_back(position(c));
        const auto& geometry = maps_.geometry(c, position(c), room.n);
        const auto& radiance = maps_.radiance(c, position(c), room.r);
        planned.bytes_disk += geometry.bytes_disk + radiance.bytes_disk;
        planned.bytes_device += geometry.bytes_device + radiance.bytes_device;
      }
      if (target_.error > 0.0 && held_back[k].measured && held_back[k].worst() > target_.error)
        planned.statement = why_not(k, held_back[k]);
      plan.rooms.push_back(std::move(planned));
    }
    for (std::uint32_t& probe : plan.grid.probe) probe = place[probe];
  }

  std::string why_not(std::size_t k, const RoomError& held_back) const {
    const Room& room = rooms_[k];
    std::vector<std::string> reasons;
    if (room.n >= target_.most_geometry)
      reasons.push_back(fmt::format("maps of {} cells a side are the finest", room.n));
    if (room.fruitless[kGeometry] >= kFruitless) reasons.push_back("finer geometry no longer helps");
    if (room.r >= target_.most_radiance)
      reasons.push_back(fmt::format("pictures of {} texels a side are the finest", room.r));
    if (room.fruitless[kRadiance] >= kFruitless) reasons.push_back("finer radiance no longer helps");
    if (room.fruitless[kProbes] >= kFruitless) reasons.push_back("more probes no longer help");
    if (chosen().size() >= target_.most_probes)
      reasons.push_back(fmt::format("{} probes are the most", target_.most_probes));
    if (reasons.empty()) reasons.push_back("it was kept on the views that it was planned by, not on those held back");
    return fmt::format(
        "mean FLIP {:.4f}, wrong {:.2f} % and holes {:.2f} % of its rays ({:.2f} % see what no probe sees): {}",
        held_back.flip, 100.0 * held_back.wrong, 100.0 * held_back.hole, 100.0 * held_back.unseen,
        fmt::join(reasons, ", "));
  }

  static constexpr int kSmallest = 8;

  struct Step {
    std::size_t room;
    int n, r;
    std::size_t probes;
    int dial;
  };

  const Space& space_;
  const HeadSpace& heads_;
  const RayScene& triangles_;
  const LightField& light_;
  const Exposure& exposure_;
  const PlanTarget target_;
  Progress& progress_;
  ProbeGrid grid_;
  PlannedMaps maps_;
  const WalkerViews choosing_, sizing_;
  ProbeChoice choice_;
  std::vector<Room> rooms_;
  std::vector<std::vector<CoarserChoice>> coarser_ = std::vector<std::vector<CoarserChoice>>(rooms_.size());
  std::vector<std::uint32_t> arranged_;
  std::vector<Step> last_steps_;
};

}  // namespace

Plan plan_bake(const Space& space, const HeadSpace& heads, const RayScene& triangles, const LightField& light,
               const Exposure& exposure, MapStore& maps, const PlanTarget& target, Progress& progress) {
  return Planner(space, heads, triangles, light, exposure, maps, target, progress).run();
}

}  // namespace probewalk
