#include "content/stream/simulated_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace probewalk {

namespace {

// std distributions differ between libraries; this does not.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  std::uint32_t below(std::size_t count) {
    return static_cast<std::uint32_t>(std::min(static_cast<double>(count) - 1.0, unit() * static_cast<double>(count)));
  }

 private:
  std::mt19937_64 engine_;
};

class Walk {
 public:
  Walk(const Manifest& manifest, WalkKind kind, std::uint64_t seed, double duration_s, double step_s)
      : manifest_(manifest),
        kind_(kind),
        dice_(seed),
        most_(static_cast<std::size_t>(duration_s / step_s)),
        speed_m_s_(dice_.between(1.0, 1.8)) {
    walk_.kind = name_of(kind);
    walk_.step_s = step_s;
    doors_.resize(manifest.rooms.size());
    for (const Portal& portal : manifest.portals) {
      if (!portal.walked) continue;
      glm::dvec3 middle_m(0.0);
      for (const glm::dvec3& corner : portal.polygon) middle_m += corner / static_cast<double>(portal.polygon.size());
      double floor_m = middle_m.y;
      for (const glm::dvec3& corner : portal.polygon) floor_m = std::min(floor_m, corner.y);
      middle_m.y = floor_m + kEye_m;
      const auto a = static_cast<std::uint32_t>(portal.room_a), b = static_cast<std::uint32_t>(portal.room_b);
      doors_[a].push_back({b, middle_m});
      doors_[b].push_back({a, middle_m});
    }
  }

  SimulatedWalk run() {
    if (manifest_.rooms.empty()) return walk_;
    room_ = dice_.below(manifest_.rooms.size());
    step_.head_m = place_in(room_);
    while (walk_.steps.size() < most_) {
      const std::size_t before = walk_.steps.size();
      go_on();
      if (walk_.steps.size() == before) stand(0.5);  // whatever the building, time passes
    }
    walk_.steps.resize(most_);
    return std::move(walk_);
  }

 private:
  static constexpr double kEye_m = 1.6;
  struct Door {
    std::uint32_t to = 0;
    glm::dvec3 middle_m{0.0};
  };

  glm::dvec3 place_in(std::uint32_t room) {
    const Bounds& box = manifest_.rooms[room].bounds;
    const glm::dvec3 size_m = box.upper_m - box.lower_m;
    return {box.lower_m.x + size_m.x * dice_.between(0.3, 0.7), box.lower_m.y + std::min(kEye_m, 0.9 * size_m.y),
            box.lower_m.z + size_m.z * dice_.between(0.3, 0.7)};
  }

  void go_on() {
    if (kind_ == WalkKind::kTeleport) return teleport();
    if (doors_[room_].empty()) return stand(1.0);
    const Door door = doors_[room_][dice_.below(doors_[room_].size())];
    if (kind_ == WalkKind::kDoorway) return sway(door);
    if (kind_ == WalkKind::kTurnBack && dice_.unit() < 0.7) return turn_back(door);
    go_to(door.middle_m);
    room_ = door.to;
    go_to(place_in(room_));
    if (dice_.unit() < 0.3) stand(dice_.between(0.5, 6.0));
  }

  void teleport() {
    stand(dice_.between(1.0, 5.0));
    const std::uint32_t target = dice_.below(manifest_.rooms.size());
    const glm::dvec3 target_m = place_in(target);
    step_.aim_m = target_m;
    stand(dice_.between(0.3, 1.0));
    step_.aim_m.reset();
    step_.head_m = target_m;
    room_ = target;
    stand(0.1);
  }

  void turn_back(const Door& door) {
    const glm::dvec3 home_m = step_.head_m;
    go_to(door.middle_m);
    if (dice_.unit() < 0.5) {
      go_to(door.middle_m + 0.8 * glm::normalize(door.middle_m - home_m + glm::dvec3(1e-6)));
    } else {
      go_to(place_in(door.to));
    }
    go_to(door.middle_m);
    go_to(home_m);
  }

  void sway(const Door& door) {
    go_to(door.middle_m);
    const glm::dvec3 across = step_.look;
    const double period_s = dice_.between(0.8, 3.0), reach_m = dice_.between(0.1, 0.5);
    const double stay_s = dice_.between(4.0, 12.0);
    for (double t = 0.0; t < stay_s && walk_.steps.size() < most_; t += walk_.step_s) {
      step_.head_m = door.middle_m + across * (reach_m * std::sin(2.0 * std::numbers::pi * t / period_s));
      walk_.steps.push_back(step_);
    }
    room_ = door.to;
    go_to(place_in(room_));
  }

  void stand(double seconds) {
    const double turn_rad_s = dice_.between(-0.8, 0.8);
    for (double t = 0.0; t < seconds && walk_.steps.size() < most_; t += walk_.step_s) {
      const double c = std::cos(turn_rad_s * walk_.step_s), s = std::sin(turn_rad_s * walk_.step_s);
      step_.look = {c * step_.look.x + s * step_.look.z, 0.0, c * step_.look.z - s * step_.look.x};
      walk_.steps.push_back(step_);
    }
  }

  void go_to(const glm::dvec3& target_m) {
    const glm::dvec3 from_m = step_.head_m, way_m = target_m - from_m;
    const double length_m = glm::length(way_m);
    glm::dvec3 flat(way_m.x, 0.0, way_m.z);
    if (glm::length(flat) > 1e-6) step_.look = glm::normalize(flat);
    const double seconds = length_m / speed_m_s_;
    for (double t = walk_.step_s; t < seconds && walk_.steps.size() < most_; t += walk_.step_s) {
      step_.head_m = from_m + way_m * (t / seconds);
      walk_.steps.push_back(step_);
    }
    step_.head_m = target_m;
    if (walk_.steps.size() < most_) walk_.steps.push_back(step_);
  }

  const Manifest& manifest_;
  WalkKind kind_;
  Dice dice_;
  std::size_t most_;
  double speed_m_s_;
  std::vector<std::vector<Door>> doors_;
  SimulatedWalk walk_;
  WalkStep step_;
  std::uint32_t room_ = 0;
};

}  // namespace

const char* name_of(WalkKind kind) {
  switch (kind) {
    case WalkKind::kWander:
      return "wander";
    case WalkKind::kTurnBack:
      return "turn back";
    case WalkKind::kDoorway:
      return "doorway";
    case WalkKind::kTeleport:
      return "teleport";
  }
  return "";
}

SimulatedWalk random_walk(const Manifest& manifest, WalkKind kind, std::uint64_t seed, double duration_s,
                          double step_s) {
  return Walk(manifest, kind, seed, duration_s, step_s).run();
}

WalkViews::WalkViews(const RoomGraph& graph, const SimulatedWalk& walk) {
  std::int64_t room = -1;
  for (const WalkStep& step : walk.steps) {
    first_.push_back(seen_.size());
    room = graph.room_of(step.head_m, room, 0.05);
    const auto seen = graph.seen(static_cast<std::uint32_t>(room), step.head_m, step.look);
    seen_.insert(seen_.end(), seen.begin(), seen.end());
  }
  first_.push_back(seen_.size());
}

}  // namespace probewalk
