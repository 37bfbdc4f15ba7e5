// Policies of streaming over simulated walks: the budget, the source, the oracle, and what a decision costs.
#include "content/stream/simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "content/error.h"
#include "content/stream/simulated_site.h"

namespace probewalk {
namespace {

// One room of three levels, as a pack would list it.
Manifest model_pack() {
  Manifest pack;
  pack.scene_name = "model";
  RoomEntry room;
  room.id = "room";
  room.probe_count = 4;
  for (const std::uint32_t side : {64u, 128u, 256u}) {
    LevelEntry level;
    level.chunk = std::string(32, '0');
    level.geometry_size = level.radiance_size = side;
    level.bytes_disk = std::uint64_t{side} * side * 8;
    level.bytes_device = std::uint64_t{side} * side * 40;
    room.levels.push_back(level);
  }
  pack.rooms.push_back(room);
  return pack;
}

SimulationOptions options_for(const Manifest& site, double share_of_site, double bytes_per_s, double latency_s) {
  SimulationOptions options;
  options.residency.budget_bytes = std::max(
      minimum_budget(site), static_cast<std::uint64_t>(share_of_site * static_cast<double>(site.bytes_device())));
  options.source.bytes_per_s = bytes_per_s;
  options.source.latency_s = latency_s;
  return options;
}

std::int64_t median(std::vector<std::int64_t> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TEST(SimulatedSite, JoinsAsManyRoomsAsAsked) {
  const Manifest pack = model_pack();
  for (const std::uint32_t rooms : {1u, 7u, 200u}) {
    const Manifest site = site_of_rooms(pack, rooms);
    ASSERT_EQ(site.rooms.size(), rooms);
    EXPECT_EQ(site.bytes_device(), rooms * pack.bytes_device());
    const RoomGraph graph(site.rooms, site.portals);
    const auto reached = graph.reach(0, site.rooms.front().bounds.lower_m + glm::dvec3(1.0), rooms);
    EXPECT_EQ(reached.size(), rooms) << "every room can be walked to";
  }
  EXPECT_THROW(site_of_rooms(Manifest{}, 3), std::logic_error);
}

TEST(SimulatedWalk, NobodyFallsOverADrop) {
  Manifest site = site_of_rooms(model_pack(), 2);
  site.portals.resize(1);
  const auto rooms_walked = [&] {
    std::set<std::uint32_t> rooms;
    const RoomGraph graph(site.rooms, site.portals);
    for (const WalkStep& step : random_walk(site, WalkKind::kWander, 5, 120.0, 0.1).steps) {
      rooms.insert(graph.room_of(step.head_m, -1, 0.0));
    }
    return rooms.size();
  };
  EXPECT_EQ(rooms_walked(), 2u) << "or this test shows nothing";
  site.portals[0].walked = false;
  EXPECT_EQ(rooms_walked(), 1u);
}

TEST(Simulation, NoPolicyIsEverOverTheBudgetWhateverTheSourceAndTheWalk) {
  const Manifest site = site_of_rooms(model_pack(), 40);
  const RoomGraph graph(site.rooms, site.portals);
  std::uint64_t seed = 1;
  for (const double rate : {5e6, 500e6}) {
    for (const double latency_s : {0.0, 0.3}) {
      for (const WalkKind kind : kAllWalkKinds) {
        const SimulatedWalk walk = random_walk(site, kind, seed++, 20.0, 1.0 / 30.0);
        const WalkViews views(graph, walk);
        SimulationOptions options = options_for(site, 0.1, rate, latency_s);
        options.source.failure_share = 0.05;
        for (const char* policy : kPolicies) {
          const SimulationResult result = simulate_policy(policy, site, graph, walk, views, options);
          EXPECT_EQ(result.steps, walk.steps.size());
          EXPECT_EQ(result.over_budget_steps, 0u) << policy << ", " << walk.kind;
          EXPECT_LE(result.held_bytes_max, options.residency.budget_bytes);
          EXPECT_GE(result.missing_octaves + 1e-9, missing_octaves_bound(site, views, options.residency.budget_bytes))
              << policy << " beats what cannot be beaten";
        }
      }
    }
  }
}

TEST(Simulation, TheProductLacksLittleMoreThanTheOracleAndLessThanPlainPolicies) {
  const Manifest site = site_of_rooms(model_pack(), 100);
  const RoomGraph graph(site.rooms, site.portals);
  double missing[std::size(kPolicies)] = {};
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const SimulatedWalk walk = random_walk(site, kAllWalkKinds[seed % 4], seed, 30.0, 1.0 / 30.0);
    const WalkViews views(graph, walk);
    const SimulationOptions options = options_for(site, 0.12, 2e6, 0.05);
    for (std::size_t k = 0; k < std::size(kPolicies); ++k) {
      const SimulationResult result = simulate_policy(kPolicies[k], site, graph, walk, views, options);
      missing[k] += result.missing_octaves / 12.0;
    }
  }
  EXPECT_LT(missing[0], missing[1]) << "against neighbours";
  EXPECT_LT(missing[0], missing[2]) << "against lru";
  EXPECT_LT(missing[0], missing[3] + 0.25) << "against the oracle";
}

// A room in view hardly ever becomes coarser, and then for the sake of the room around the walker; it never goes dark.
TEST(Simulation, WhatIsInViewIsNeverEvictedToNothing) {
  const Manifest site = site_of_rooms(model_pack(), 60);
  const RoomGraph graph(site.rooms, site.portals);
  std::size_t steps = 0, evictions = 0, in_view = 0, plain_to_nothing = 0;
  std::uint64_t seed = 1;
  for (const double rate : {5e6, 20e6, 80e6, 500e6}) {
    for (const double latency_s : {0.0, 0.02, 0.1, 0.3}) {
      for (const WalkKind kind : kAllWalkKinds) {
        const SimulatedWalk walk = random_walk(site, kind, seed++, 20.0, 1.0 / 30.0);
        const WalkViews views(graph, walk);
        const SimulationOptions options = options_for(site, 0.1, rate, latency_s);
        const SimulationResult result = simulate_policy("probewalk", site, graph, walk, views, options);
        EXPECT_EQ(result.evictions_to_nothing_in_view, 0u)
            << walk.kind << ", " << rate << " B/s, " << latency_s << " s";
        EXPECT_EQ(result.over_budget_steps, 0u);
        steps += result.steps;
        evictions += result.evictions;
        in_view += result.evictions_in_view;
        plain_to_nothing += simulate_policy("lru", site, graph, walk, views, options).evictions_to_nothing_in_view;
      }
    }
  }
  EXPECT_GT(evictions, 200u);
  EXPECT_LT(in_view, steps / 500);
  EXPECT_GT(plain_to_nothing, 0u) << "what is asserted above can happen";
}

TEST(Simulation, ADecisionCostsNoMoreInASiteAHundredTimesAsLarge) {
  std::int64_t cost_ns[2] = {};
  for (int k = 0; k < 2; ++k) {
    const Manifest site = site_of_rooms(model_pack(), k == 0 ? 100 : 10000);
    const RoomGraph graph(site.rooms, site.portals);
    const SimulatedWalk walk = random_walk(site, WalkKind::kWander, 3, 30.0, 1.0 / 30.0);
    const WalkViews views(graph, walk);
    SimulationOptions options = options_for(site, 0.0, 50e6, 0.02);
    options.residency.budget_bytes = 40 * model_pack().bytes_device();
    cost_ns[k] = median(simulate_policy("probewalk", site, graph, walk, views, options).decide_ns);
  }
  // Other work on the machine is in both; a cost that grew with the rooms would be a hundred times as much.
  EXPECT_LT(cost_ns[1], 5 * cost_ns[0]);
}

TEST(Simulation, ASlowerSourceTakesLongerAndAFailingOneIsAskedAgain) {
  const Manifest site = site_of_rooms(model_pack(), 60);
  const RoomGraph graph(site.rooms, site.portals);
  const SimulatedWalk walk = random_walk(site, WalkKind::kTeleport, 5, 40.0, 1.0 / 30.0);
  const WalkViews views(graph, walk);
  const SimulationResult quick =
      simulate_policy("probewalk", site, graph, walk, views, options_for(site, 0.2, 500e6, 0.0));
  const SimulationResult slow =
      simulate_policy("probewalk", site, graph, walk, views, options_for(site, 0.2, 1e6, 0.3));
  EXPECT_LT(quick.missing_octaves, slow.missing_octaves);
  EXPECT_LT(quick.coarse_steps, slow.coarse_steps);
  SimulationOptions failing = options_for(site, 0.2, 50e6, 0.02);
  failing.source.failure_share = 0.2;
  const SimulationResult failed = simulate_policy("probewalk", site, graph, walk, views, failing);
  EXPECT_GT(failed.failures, 10u);
  EXPECT_LT(failed.missing_octaves, 1.0) << "what failed came in later";
  EXPECT_THROW(simulate_policy("psychic", site, graph, walk, views, failing), BadUsage);
}

}  // namespace
}  // namespace probewalk
