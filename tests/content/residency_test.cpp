// The residency policy on simulated walks: no device, no files, no clock.
#include "content/stream/residency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "content/error.h"
#include "content/probe/device_probe.h"

namespace probewalk {
namespace {

// What the policy sets aside for the levels: possible for maps of 8, 16 and 32 cells a side.
constexpr std::uint64_t kCoarse = 1000, kMiddle = 4000, kFine = 16000;

// Rooms of 4 m in a row along x, a door between each two; three levels each.
Manifest row_of_rooms(std::uint32_t count) {
  Manifest m;
  for (std::uint32_t k = 0; k < count; ++k) {
    RoomEntry room;
    room.id = "room-" + std::to_string(k);
    room.bounds = {{4.0 * k, 0.0, 0.0}, {4.0 * k + 4.0, 3.0, 4.0}};
    room.probe_count = 1;
    std::uint32_t size = 8;
    for (const std::uint64_t bytes : {kCoarse, kMiddle, kFine}) {
      room.levels.push_back({std::string(32, '0'), size, size, 1, bytes - kMostPadding_bytes, -1.0});
      size *= 2;
    }
    m.rooms.push_back(room);
    const double x = 4.0 * k;
    if (k > 0) {
      m.portals.push_back(
          {static_cast<int>(k) - 1, static_cast<int>(k), {{x, 0, 1.5}, {x, 0, 2.5}, {x, 2, 2.5}, {x, 2, 1.5}}});
    }
  }
  return m;
}

Walker standing(double x) {
  return {{x, 1.6, 2.0}, {0.0, 0.0, 0.0}};
}

// A device and a loader of numbers: loads arrive some updates later, evicted bytes are freed some updates later.
class Simulation {
 public:
  Simulation(const Manifest& manifest, const ResidencyOptions& options)
      : options_(options), residency_(manifest, options), book_(manifest) {}

  ResidencyDecision step(const Walker& walker) {
    std::erase_if(loading_, [&](Loading& l) {
      if (--l.updates_left > 0) return false;
      const auto truth = true_bytes_.find(l.key);
      const bool fits = truth == true_bytes_.end() || truth->second <= book_.bytes(l.key);
      book_.set(l.key, fits ? LevelStatus::kResident : LevelStatus::kAbsent);
      if (truth != true_bytes_.end()) book_.learn(l.key, truth->second);
      return true;
    });
    std::erase_if(retired_, [](Retired& r) { return --r.updates_left == 0; });
    std::uint64_t retired = 0;
    for (const Retired& r : retired_) retired += r.bytes;
    ResidencyDecision d = residency_.decide(walker, book_, retired);
    for (const LevelKey& key : d.cancellations) {
      EXPECT_EQ(book_.status(key), LevelStatus::kLoading);
      EXPECT_TRUE(std::find(d.wanted.begin(), d.wanted.end(), key) == d.wanted.end());
      std::erase_if(loading_, [&](const Loading& l) { return l.key == key; });
      book_.set(key, LevelStatus::kAbsent);
    }
    for (const LevelKey& key : d.evictions) {
      EXPECT_EQ(book_.status(key), LevelStatus::kResident);
      EXPECT_TRUE(std::find(d.wanted.begin(), d.wanted.end(), key) == d.wanted.end());
      EXPECT_FALSE(key.room == d.room && key.level == 0);
      book_.set(key, LevelStatus::kAbsent);
      retired_.push_back({bytes(key), 3});
    }
    for (const LevelKey& key : d.loads) {
      EXPECT_EQ(book_.status(key), LevelStatus::kAbsent);
      book_.set(key, LevelStatus::kLoading);
      loading_.push_back({key, 5});
      ++loads_;
    }
    evictions_ += d.evictions.size();
    EXPECT_LE(held(), options_.budget_bytes);
    EXPECT_LE(loading_.size(), options_.most_loads);
    return d;
  }

  // Steps without motion until nothing is missing.
  ResidencyDecision settle(const Walker& walker) {
    ResidencyDecision d;
    for (int k = 0; k < 500; ++k) {
      d = step(walker);
      if (d.settled) return d;
    }
    ADD_FAILURE() << "never settled";
    return d;
  }

  std::uint64_t held() const {
    std::uint64_t sum = 0;
    for (const Retired& r : retired_) sum += r.bytes;
    for (std::uint32_t room = 0; room < book_.rooms(); ++room) {
      for (std::uint32_t level = 0; level < book_.levels(room); ++level) {
        const LevelStatus s = book_.status({room, level});
        if (s == LevelStatus::kLoading || s == LevelStatus::kResident) sum += bytes({room, level});
      }
    }
    return sum;
  }
  bool resident(std::uint32_t room, std::uint32_t level) const {
    return book_.status({room, level}) == LevelStatus::kResident;
  }
  void fail(LevelKey key) { book_.set(key, LevelStatus::kFailed); }
  // What it takes, whatever the manifest says.
  void lie(LevelKey key, std::uint64_t true_bytes) { true_bytes_[key] = true_bytes; }
  std::size_t loads() const { return loads_; }
  std::size_t evictions() const { return evictions_; }

 private:
  struct Loading {
    LevelKey key;
    int updates_left;
  };
  struct Retired {
    std::uint64_t bytes;
    int updates_left;
  };
  std::uint64_t bytes(LevelKey key) const { return book_.bytes(key); }

  ResidencyOptions options_;
  Residency residency_;
  LevelBook book_;
  std::map<LevelKey, std::uint64_t> true_bytes_;
  std::vector<Loading> loading_;
  std::vector<Retired> retired_;
  std::size_t loads_ = 0, evictions_ = 0;
};

ResidencyOptions with_budget(std::uint64_t bytes) {
  ResidencyOptions options;
  options.budget_bytes = bytes;
  return options;
}

TEST(RoomGraph, FindsTheRoomAndKeepsItInADoorway) {
  const Manifest m = row_of_rooms(3);
  const RoomGraph graph(m.rooms, m.portals);
  EXPECT_EQ(graph.room_of({5.0, 1.0, 1.0}, -1, 0.3), 1u);
  EXPECT_EQ(graph.room_of({-3.0, 1.0, 1.0}, -1, 0.3), 0u);  // outside: the nearest
  EXPECT_EQ(graph.room_of({50.0, 1.0, 1.0}, -1, 0.3), 2u);
  EXPECT_EQ(graph.room_of({4.2, 1.0, 1.0}, 0, 0.3), 0u);  // sways into room 1
  EXPECT_EQ(graph.room_of({4.4, 1.0, 1.0}, 0, 0.3), 1u);  // is in room 1
  EXPECT_EQ(graph.room_of({3.8, 1.0, 1.0}, 1, 0.3), 1u);  // sways back
}

TEST(RoomGraph, ARoomInsideABiggerOneIsEntered) {
  Manifest m = row_of_rooms(1);
  m.rooms.push_back(m.rooms[0]);
  m.rooms[1].bounds = {{-20.0, -1.0, -20.0}, {20.0, 5.0, 20.0}};
  const RoomGraph graph(m.rooms, m.portals);
  EXPECT_EQ(graph.room_of({10.0, 1.0, 2.0}, 0, 0.3), 1u);
  EXPECT_EQ(graph.room_of({2.0, 1.0, 2.0}, 1, 0.3), 0u);
}

TEST(RoomGraph, ReachesThroughPortalsNearestFirst) {
  const Manifest m = row_of_rooms(6);
  const RoomGraph graph(m.rooms, m.portals);
  std::vector<std::uint32_t> rooms;
  for (const auto& reach : graph.reach(2, {11.0, 1.0, 2.0}, 2)) rooms.push_back(reach.room);
  EXPECT_THAT(rooms, testing::ElementsAre(2, 3, 1, 4, 0));
  EXPECT_EQ(graph.reach(0, {1.0, 1.0, 2.0}, 3).size(), 4u);
}

// A gallery over the last of five rooms in a row; the way up begins in the first.
Manifest row_under_a_gallery() {
  Manifest m = row_of_rooms(5);
  RoomEntry gallery = m.rooms[0];
  gallery.id = "gallery";
  gallery.bounds = {{16.0, 3.0, 4.0}, {20.0, 6.0, 6.0}};
  m.rooms.push_back(gallery);
  m.portals.push_back({0, 5, {{0, 0, 4}, {1, 0, 4}, {1, 2, 4}, {0, 2, 4}}});
  m.portals.push_back({5, 4, {{16, 3, 4}, {20, 3, 4}, {20, 6, 4}, {16, 6, 4}}, false});
  return m;
}

TEST(RoomGraph, ADropIsSeenThroughFromBothSidesAndNobodyArrivesByIt) {
  const Manifest m = row_under_a_gallery();
  const RoomGraph graph(m.rooms, m.portals);
  const auto sees = [&](std::uint32_t room, glm::dvec3 from, glm::dvec3 look, std::uint32_t other) {
    const auto seen = graph.seen(room, from, look);
    const auto found = std::ranges::find(seen, other, &RoomGraph::Seen::room);
    return found != seen.end() && found->in_view && found->share > 0.02;
  };
  EXPECT_TRUE(sees(5, {18, 4.6, 5}, {0, 0, -1}, 4)) << "from the rail";
  EXPECT_TRUE(sees(4, {18, 1.6, 2}, glm::normalize(glm::dvec3(0, 1, 1)), 5)) << "up to it";
  const auto reach = graph.reach(5, {18, 4.6, 5}, 3);
  const auto below = std::ranges::find(reach, 4u, &RoomGraph::Reach::room);
  ASSERT_NE(below, reach.end());
  EXPECT_EQ(below->portals, 1u);
  EXPECT_TRUE(std::isinf(below->arrival_s)) << "the way there is five doors long";
  const auto first = std::ranges::find(reach, 0u, &RoomGraph::Reach::room);
  ASSERT_NE(first, reach.end());
  EXPECT_LT(first->arrival_s, 60.0);
  for (const RoomGraph::Reach& r : graph.reach(5, {18, 4.6, 5}, 5)) EXPECT_FALSE(std::isinf(r.arrival_s)) << r.room;
}

TEST(Residency, WhatLiesBelowAGalleryIsLoadedForWhoLooksDown) {
  const Manifest m = row_under_a_gallery();
  ResidencyOptions options;
  options.budget_bytes = 6 * kCoarse + 2 * kFine;
  Simulation there(m, options);
  const Walker looks_down{{18, 4.6, 4.5}, {0.0, 0.0, 0.0}, glm::normalize(glm::dvec3(0, -1, -1))};
  for (int k = 0; k < 60; ++k) there.step(looks_down);
  EXPECT_TRUE(there.resident(4, 2));
  Manifest without = m;
  without.portals.pop_back();
  Simulation blind(without, options);
  for (int k = 0; k < 60; ++k) blind.step(looks_down);
  EXPECT_FALSE(blind.resident(4, 2)) << "or this test shows nothing";
}

TEST(Residency, ASmallBuildingIsWhollyResidentAtItsCoarsest) {
  const Manifest m = row_of_rooms(8);
  Simulation s(m, {});
  const ResidencyDecision d = s.settle(standing(1.0));
  for (std::uint32_t room = 0; room < 8; ++room) EXPECT_TRUE(s.resident(room, 0)) << room;
  for (std::uint32_t room = 0; room < 3; ++room) EXPECT_TRUE(s.resident(room, 2)) << room;
  EXPECT_TRUE(s.resident(6, 2)) << "in sight through six doors";
  EXPECT_FALSE(s.resident(7, 2));
  EXPECT_FALSE(d.coarse);
}

TEST(Residency, TheWalkersRoomComesFirst) {
  const Manifest m = row_of_rooms(8);
  Residency residency(m, {});
  const ResidencyDecision d = residency.decide(standing(13.0), LevelBook(m));
  EXPECT_EQ(d.room, 3u);
  EXPECT_EQ(d.loads.size(), 4u);
  EXPECT_EQ(d.loads[0], (LevelKey{3, 0}));
  EXPECT_EQ(d.loads[1], (LevelKey{2, 0}));  // its door is nearer than the other
  EXPECT_TRUE(d.coarse);
  EXPECT_FALSE(d.settled);
}

TEST(Residency, TheSmallestBudgetIsStatedAndWorks) {
  const Manifest m = row_of_rooms(10);
  EXPECT_EQ(minimum_budget(m), 7 * kCoarse);
  try {
    Residency(m, with_budget(7 * kCoarse - 1));
    ADD_FAILURE() << "accepted";
  } catch (const BadUsage& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("--device-budget 1"));
  }
  Simulation s(m, with_budget(7 * kCoarse));
  for (double x = 0.5; x < 39.5; x += 0.05) s.step({{x, 1.6, 2.0}, {1.4, 0.0, 0.0}});
  s.settle(standing(39.0));
  EXPECT_TRUE(s.resident(9, 0) && s.resident(6, 0));
}

TEST(Residency, WithinTheBudgetTheFinestLevelThatFits) {
  const Manifest m = row_of_rooms(3);
  Simulation s(m, with_budget(3 * kCoarse + kFine + kMiddle));
  s.settle(standing(1.0));
  EXPECT_TRUE(s.resident(0, 2));
  EXPECT_TRUE(s.resident(1, 1));
  EXPECT_FALSE(s.resident(1, 2) || s.resident(2, 1) || s.resident(2, 2));
}

TEST(Residency, AWalkThereAndBackKeepsTheWalkersRoomAndTheBudget) {
  const Manifest m = row_of_rooms(12);
  for (const std::uint64_t budget :
       {7 * kCoarse, 7 * kCoarse + kMiddle, 7 * kCoarse + 2 * kFine, 12 * kFine, kUnlimitedBudget}) {
    Simulation s(m, with_budget(budget));
    s.settle(standing(0.5));
    const auto walk = [&](double from, double to) {
      const double step = from < to ? 0.02 : -0.02;  // 1.4 m/s at 72 Hz
      for (double x = from; (to - x) * step > 0.0; x += step) {
        const ResidencyDecision d = s.step({{x, 1.6, 2.0}, {step * 72.0, 0.0, 0.0}});
        ASSERT_TRUE(s.resident(d.room, 0)) << x;
      }
    };
    walk(0.5, 46.0);
    walk(46.0, 0.5);
    s.settle(standing(0.5));
  }
}

TEST(Residency, TheRoomAheadIsReadyWhenItIsEntered) {
  const Manifest m = row_of_rooms(12);
  Simulation s(m, with_budget(7 * kCoarse + 2 * kFine + kMiddle));
  s.settle(standing(2.0));
  for (double x = 2.0; x < 46.0; x += 0.02) {
    const ResidencyDecision d = s.step({{x, 1.6, 2.0}, {1.4, 0.0, 0.0}});
    ASSERT_TRUE(s.resident(d.room, 2)) << x;
  }
}

TEST(Residency, StandingInADoorwayDoesNotThrash) {
  const Manifest m = row_of_rooms(8);
  for (const std::uint64_t budget : {7 * kCoarse + kFine, 7 * kCoarse + 2 * kFine, 7 * kCoarse + 3 * kFine}) {
    Simulation s(m, with_budget(budget));
    s.settle(standing(15.9));
    const std::size_t loads = s.loads(), evictions = s.evictions();
    for (int k = 0; k < 2000; ++k) {
      const double sway = 0.2 * std::sin(0.1 * k);
      s.step({{16.0 + sway, 1.6, 2.0}, {0.2 * 0.1 * 72.0 * std::cos(0.1 * k), 0.0, 0.0}});
    }
    EXPECT_LE(s.loads() - loads, 2u) << budget;
    EXPECT_LE(s.evictions() - evictions, 2u) << budget;
  }
}

TEST(Residency, TurningBackFindsTheRoomStillThere) {
  const Manifest m = row_of_rooms(8);
  Simulation s(m, with_budget(8 * kCoarse + 6 * kFine));
  s.settle(standing(2.0));
  s.settle(standing(14.0));
  const std::size_t loads = s.loads();
  s.settle(standing(2.0));
  EXPECT_EQ(s.loads(), loads);
}

TEST(Residency, TeleportsSettleWithinTheBudget) {
  const Manifest m = row_of_rooms(40);
  Simulation s(m, with_budget(7 * kCoarse + kFine));
  for (const double x : {2.0, 150.0, 42.0, 158.0, 3.0, 81.0, 80.0}) {
    const auto room = static_cast<std::uint32_t>(x / 4.0);
    for (int k = 0; k < 3; ++k) s.step({{x, 1.6, 2.0}, {500.0, 0.0, 0.0}});
    EXPECT_EQ(s.settle(standing(x)).room, room);
    EXPECT_TRUE(s.resident(room, 2) && s.resident(room, 0)) << x;
  }
}

// What a teleport shows at once is what the aim marker has brought in.
TEST(Residency, AimingBringsInTheTargetBeforeOneIsThere) {
  const Manifest m = row_of_rooms(40);
  for (const bool aims : {true, false}) {
    Simulation s(m, with_budget(8 * kCoarse + 2 * kFine));
    s.settle(standing(2.0));
    Walker aiming = standing(2.0);
    if (aims) aiming.aim_m = glm::dvec3(150.0, 1.6, 2.0);
    for (int k = 0; k < 30; ++k) EXPECT_EQ(s.step(aiming).room, 0u);  // less than half a second
    EXPECT_EQ(s.resident(37, 0), aims);
    EXPECT_TRUE(s.resident(0, 0) && s.resident(0, 2)) << "one is still here";
    EXPECT_EQ(s.step(standing(150.0)).room, 37u);
    EXPECT_EQ(s.resident(37, 0), aims) << "in the first frame there";
    s.settle(standing(150.0));
    EXPECT_TRUE(s.resident(37, 2));
  }
}

// All directions that a marker sweeps over are no reason to lose what is around one.
TEST(Residency, AMarkerThatSweepsOverTheBuildingTakesNothingOfWhatIsInView) {
  const Manifest m = row_of_rooms(40);
  Simulation s(m, with_budget(8 * kCoarse + 2 * kFine));
  Walker aiming{{2.0, 1.6, 2.0}, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  s.settle(aiming);
  std::vector<LevelKey> shown;
  for (std::uint32_t room = 0; room < 2; ++room) {
    for (std::uint32_t level = 0; level < 3; ++level) {
      if (s.resident(room, level)) shown.push_back({room, level});
    }
  }
  ASSERT_GE(shown.size(), 3u);
  for (int k = 0; k < 400; ++k) {
    aiming.aim_m = glm::dvec3(10.0 + 0.37 * k, 1.6, 2.0);
    s.step(aiming);
    for (const LevelKey& key : shown) ASSERT_TRUE(s.resident(key.room, key.level)) << key.room << ' ' << key.level;
  }
}

TEST(Residency, ABadChunkKeepsTheCoarserLevel) {
  const Manifest m = row_of_rooms(2);
  Simulation s(m, {});
  s.fail({0, 2});
  s.settle(standing(1.0));
  EXPECT_TRUE(s.resident(0, 0) && s.resident(0, 1));
  s.fail({0, 1});
  s.settle(standing(1.0));
  s.fail({1, 0});
  s.settle(standing(1.0));
  EXPECT_TRUE(s.resident(1, 2));
}

TEST(Residency, WhatThePackStatesIsKeptWithinWhatItsMapsCanTake) {
  Manifest m = row_of_rooms(1);
  LevelEntry& level = m.rooms[0].levels[0];
  const std::uint64_t least = device_probe_bytes(8, 8), most = device_probe_bytes(8, 8, {64, 16});
  EXPECT_EQ(planned_bytes(m.rooms[0], level), kCoarse);
  level.bytes_device = 0;
  EXPECT_EQ(planned_bytes(m.rooms[0], level), least + kMostPadding_bytes);
  level.bytes_device = std::uint64_t{64} << 30;
  EXPECT_EQ(planned_bytes(m.rooms[0], level), most + kMostPadding_bytes);
  // So a pack that states too much still fits a budget that holds it.
  EXPECT_LE(minimum_budget(m), most + kMostPadding_bytes);
}

TEST(Residency, PlansWithWhatTiledSamplesTake) {
  using enum DeviceSamples;
  Manifest m = row_of_rooms(1);
  LevelEntry& level = m.rooms[0].levels[0];
  level.geometry_size = level.radiance_size = 256;
  level.bytes_device = device_probe_bytes(256, 256, {5000, 0});
  level.bytes_tiled = least_device_probe_bytes(256, 256) + 100'000;
  const std::uint64_t padding = m.rooms[0].probe_count * kMostPadding_bytes;
  EXPECT_EQ(planned_bytes(m.rooms[0], level, kFloat), level.bytes_device + padding);
  EXPECT_EQ(planned_bytes(m.rooms[0], level, kTiled), level.bytes_tiled + padding);
  EXPECT_EQ(LevelBook(m, kTiled).bytes({0, 0}), level.bytes_tiled + padding);
  EXPECT_EQ(minimum_budget(m, {.samples = kTiled}), level.bytes_tiled + padding);
  level.bytes_tiled = 1;
  EXPECT_EQ(planned_bytes(m.rooms[0], level, kTiled), least_device_probe_bytes(256, 256) + padding);
  level.bytes_tiled = 0;
  EXPECT_EQ(planned_bytes(m.rooms[0], level, kTiled), level.bytes_device + padding) << "until it is known";
}

TEST(Residency, LevelsThatTakeMoreThanStatedNeitherBreakTheBudgetNorTheWalk) {
  const Manifest m = row_of_rooms(8);
  for (const std::uint64_t budget : {7 * kCoarse + kFine, 8 * kCoarse + 3 * kFine}) {
    Simulation s(m, with_budget(budget));
    // Every fine level takes a third more than stated; that of room 2 alone more than the whole budget.
    for (std::uint32_t room = 0; room < 8; ++room) s.lie({room, 2}, kFine + kFine / 3);
    s.lie({2, 2}, budget + 1);
    for (double x = 0.5; x < 31.0; x += 0.05) s.step({{x, 1.6, 2.0}, {1.4, 0.0, 0.0}});  // each step checks the budget
    s.settle(standing(1.0));
    EXPECT_TRUE(s.resident(0, 0));
    s.settle(standing(10.0));
    EXPECT_FALSE(s.resident(2, 2));
    EXPECT_TRUE(s.resident(2, 1)) << "the next coarser stands in";
    // What is known is not tried again.
    const std::size_t loads = s.loads();
    for (int k = 0; k < 200; ++k) s.step(standing(10.0));
    EXPECT_EQ(s.loads(), loads);
  }
}

TEST(Residency, LevelsThatTakeLessThanStatedLeaveSpaceForOthers) {
  const Manifest m = row_of_rooms(3);
  const std::uint64_t budget = 3 * kCoarse + kFine + kMiddle;
  Simulation honest(m, with_budget(budget)), lying(m, with_budget(budget));
  for (std::uint32_t room = 0; room < 3; ++room) lying.lie({room, 2}, kMiddle);
  honest.settle(standing(1.0));
  lying.settle(standing(1.0));
  EXPECT_FALSE(honest.resident(1, 2));
  EXPECT_TRUE(lying.resident(0, 2) && lying.resident(1, 2) && !lying.resident(2, 2));
}

TEST(Residency, AWalkersRoomThatTakesMoreThanStatedComesBeforeItsNeighbours) {
  const Manifest m = row_of_rooms(3);
  Simulation s(m, with_budget(3 * kCoarse));
  s.settle(standing(1.0));
  EXPECT_TRUE(s.resident(2, 0));
  Simulation lying(m, with_budget(3 * kCoarse));
  lying.lie({0, 0}, 2 * kCoarse + 1);
  lying.settle(standing(1.0));
  EXPECT_TRUE(lying.resident(0, 0));
  EXPECT_FALSE(lying.resident(1, 0) && lying.resident(2, 0));
}

TEST(Residency, RoomsWithoutProbesAskForNothing) {
  Manifest m = row_of_rooms(3);
  m.rooms[1].levels.clear();
  Simulation s(m, {});
  const ResidencyDecision d = s.settle(standing(5.0));
  EXPECT_EQ(d.room, 1u);
  EXPECT_TRUE(s.resident(0, 2) && s.resident(2, 2));
}

TEST(Residency, TheSameWalkGivesTheSameDecisions) {
  const Manifest m = row_of_rooms(12);
  std::vector<LevelKey> first, second;
  for (auto* loads : {&first, &second}) {
    Simulation s(m, with_budget(7 * kCoarse + 2 * kFine));
    for (double x = 0.5; x < 46.0; x += 0.1) {
      const auto d = s.step({{x, 1.6, 2.0}, {1.4, 0.0, 0.0}});
      loads->insert(loads->end(), d.loads.begin(), d.loads.end());
    }
  }
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace probewalk
