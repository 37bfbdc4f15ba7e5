#include "render/probe_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <thread>

#include "gpu_test.h"
#include "probe_room.h"
#include "render/check.h"
#include "render/one_shot.h"
#include "render/ray_batch.h"

namespace probewalk {
namespace {

class ProbeStoreTest : public test::GpuTest {
 protected:
  // Runs one frame's worth of copies and waits for it; returns the bytes copied.
  std::uint64_t frame(ProbeStore& store) {
    ++frames;
    run_commands(device, [&](VkCommandBuffer commands) {
      work = store.begin_frame(commands, static_cast<std::uint32_t>(frames % 2), frames, frames - 1);
    });
    return work.copied_bytes;
  }
  // Uploads and evictions, at every stage of what a level goes through; then all that is left is settled.
  void evict_sooner_or_later(ProbeStore& store, const test::ProbeRoom& levels) {
    for (std::uint32_t k = 0; k < 20; ++k) {
      store.upload(levels.upload(k % 2));
      for (std::uint32_t wait = 0; wait < k; ++wait) frame(store);
      store.evict(0, k % 2);
      frame(store);
    }
    store.settle();
    frame(store);
  }
  // Class of the answer to one ray from the room's middle.
  BatchAnswer ask(const ProbeStore& store) {
    const WorldRay ray{{0.0, 1.4, 0.0}, {0.1, 0.05, -1.0}};
    if (!batch) batch.emplace(device);
    return batch->trace(store, default_dials(test::kRadianceScale), {&ray, 1}, 0.01f).front();
  }
  const test::ProbeRoom room{16, 8};
  std::optional<RayBatch> batch;
  std::uint64_t frames = 0;
  StoreWork work;  // of the last frame
};

TEST_F(ProbeStoreTest, ShowsWhatWasHandedInFromTheNextFrameOn) {
  ProbeStore store(device, room.grid, room.probe_count());
  frame(store);
  EXPECT_EQ(store.level_shown(0), -1);
  store.upload(room.upload());
  EXPECT_EQ(store.level_shown(0), -1);
  EXPECT_FALSE(store.idle());
  frame(store);
  EXPECT_EQ(store.level_shown(0), 0);
  EXPECT_TRUE(store.idle());
  EXPECT_EQ(store.bytes_uploaded(), ProbeStore::bytes_of(room.probes));
}

TEST_F(ProbeStoreTest, ShowsTheFinestLevelAndFallsBackWhenItGoes) {
  ProbeStore store(device, room.grid, room.probe_count());
  store.upload(room.upload(1));
  store.upload(room.upload(0));
  frame(store);
  EXPECT_EQ(store.level_shown(0), 1);
  store.evict(0, 1);
  frame(store);
  EXPECT_EQ(store.level_shown(0), 0);
  EXPECT_FALSE(store.is_resident(0, 1));
  EXPECT_TRUE(store.is_resident(0, 0));
}

TEST_F(ProbeStoreTest, AnswersUnknownWithoutProbesAndHitsWithThem) {
  ProbeStore store(device, room.grid, room.probe_count());
  store.settle();
  EXPECT_EQ(ask(store).answer, kClassUnknown);
  EXPECT_EQ(ask(store).probe, -1);
  store.upload(room.upload());
  store.settle();
  EXPECT_EQ(ask(store).answer, kClassHit);
  store.evict(0, 0);
  store.settle();
  EXPECT_EQ(ask(store).probe, -1);
}

TEST_F(ProbeStoreTest, FadesFromTheCoarseLevelToTheFineOne) {
  ProbeStore store(device, room.grid, room.probe_count(), {.fade_frames = 6});
  RoomUpload dark = room.upload(0);
  for (DeviceProbe& probe : dark.probes) {
    const std::size_t texels = probe.radiance.size() - (std::size_t{1} << (2 * probe.record.r_log2)) / 2;
    std::fill_n(probe.radiance.begin(), texels, 0u);
  }
  store.upload(dark);
  frame(store);
  frame(store);
  EXPECT_EQ(ask(store).radiance, glm::vec3(0)) << "the first level has nothing to fade from";
  store.upload(room.upload(1));
  std::vector<float> seen;
  for (int k = 0; k < 5; ++k) {
    frame(store);
    frame(store);  // of the slot that is asked
    seen.push_back(ask(store).radiance.x);
  }
  EXPECT_GT(seen.front(), 0.0f);
  EXPECT_LT(seen.front(), 0.5f * seen.back());
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen[3], seen[4]) << "the fade has an end";
  ProbeStore at_once(device, room.grid, room.probe_count());
  at_once.upload(room.upload(1));
  at_once.settle();
  EXPECT_EQ(seen.back(), ask(at_once).radiance.x);
}

TEST_F(ProbeStoreTest, AFadeOutlivesTheEvictionOfWhatItFadesFrom) {
  ProbeStore store(device, room.grid, room.probe_count(), {.fade_frames = 6});
  store.upload(room.upload(0));
  frame(store);
  store.upload(room.upload(1));
  frame(store);
  store.evict(0, 0);
  frame(store);
  frame(store);
  EXPECT_EQ(store.level_shown(0), 1);
  EXPECT_EQ(store.device_bytes(), ProbeStore::bytes_of(room.probes));
  EXPECT_EQ(ask(store).answer, kClassHit);
}

TEST_F(ProbeStoreTest, FreesMemoryOnlyWhenNoFrameReadsIt) {
  ProbeStore store(device, room.grid, room.probe_count());
  const std::uint64_t bytes = ProbeStore::bytes_of(room.probes);
  store.upload(room.upload());
  frame(store);
  EXPECT_EQ(store.device_bytes(), bytes);
  store.evict(0, 0);
  EXPECT_EQ(store.device_bytes(), bytes) << "the last frame may still read it";
  frame(store);
  EXPECT_EQ(store.device_bytes(), 0u);
}

TEST_F(ProbeStoreTest, StagedCopiesKeepToTheBudget) {
  ProbeStore store(device, room.grid, room.probe_count(), {.upload_bytes_per_frame = 10000, .always_stage = true});
  store.upload(room.upload());
  const std::uint64_t bytes = ProbeStore::bytes_of(room.probes);
  std::uint64_t copied = 0;
  while (copied < bytes) {
    EXPECT_EQ(store.level_shown(0), -1);
    EXPECT_EQ(store.queue_depth(), 1u);
    const std::uint64_t step = frame(store);
    ASSERT_GT(step, 0u);
    EXPECT_LE(step, 10000u);
    copied += step;
  }
  EXPECT_EQ(copied, bytes);
  EXPECT_EQ(store.level_shown(0), 0);
  EXPECT_EQ(store.queue_depth(), 0u);
  store.settle();
  EXPECT_EQ(ask(store).answer, kClassHit);
}

TEST_F(ProbeStoreTest, StagedAndWrittenMemoryAnswerAlike) {
  ProbeStore staged(device, room.grid, room.probe_count(), {.always_stage = true});
  ProbeStore written(device, room.grid, room.probe_count());
  for (ProbeStore* store : {&staged, &written}) {
    store->upload(room.upload());
    store->settle();
  }
  EXPECT_EQ(ask(staged).t_m, ask(written).t_m);
  EXPECT_EQ(ask(staged).radiance, ask(written).radiance);
}

TEST_F(ProbeStoreTest, AnEvictionWhileItsCopiesRunIsSafe) {
  ProbeStore store(device, room.grid, room.probe_count(), {.upload_bytes_per_frame = 10000, .always_stage = true});
  store.upload(room.upload());
  frame(store);
  store.evict(0, 0);
  EXPECT_EQ(frame(store), 0u);
  EXPECT_EQ(store.level_shown(0), -1);
  EXPECT_TRUE(store.idle());
  frame(store);
  EXPECT_EQ(store.device_bytes(), 0u);
}

TEST_F(ProbeStoreTest, CopiesApartKeepToTheBudgetAndShowWhenTheyHaveArrived) {
  ProbeStore store(device, room.grid, room.probe_count(),
                   {.upload_bytes_per_frame = 10000, .always_stage = true, .copy_apart = true});
  ProbeStore written(device, room.grid, room.probe_count());
  written.upload(room.upload());
  written.settle();
  store.upload(room.upload());
  EXPECT_FALSE(store.wait_before()) << "nothing has been copied yet";
  const std::uint64_t bytes = ProbeStore::bytes_of(room.probes);
  std::uint64_t before = 0;
  for (int k = 0; k < 10000 && store.level_shown(0) < 0; ++k) {
    EXPECT_EQ(store.queue_depth(), 1u);
    EXPECT_EQ(frame(store), 0u) << "nothing by the frame's commands";
    EXPECT_LE(store.bytes_uploaded() - before, 10000u);
    before = store.bytes_uploaded();
  }
  ASSERT_EQ(store.level_shown(0), 0);
  EXPECT_EQ(store.bytes_uploaded(), bytes);
  EXPECT_EQ(store.queue_depth(), 0u);
  EXPECT_TRUE(store.wait_before()) << "the frame waits for what another queue wrote";
  store.settle();
  EXPECT_EQ(ask(store).t_m, ask(written).t_m);
  EXPECT_EQ(ask(store).radiance, ask(written).radiance);
}

TEST_F(ProbeStoreTest, AnEvictionWhileCopiesRunApartIsSafe) {
  ProbeStore store(device, room.grid, room.probe_count(),
                   {.upload_bytes_per_frame = 10000, .always_stage = true, .copy_apart = true});
  evict_sooner_or_later(store, room);
  EXPECT_EQ(store.level_shown(0), -1);
  EXPECT_TRUE(store.idle());
  EXPECT_EQ(store.device_bytes(), 0u);
}

TEST_F(ProbeStoreTest, AnArenaIsTakenAtOnceAndRefusesWhatDoesNotFit) {
  const std::uint64_t bytes = ProbeStore::bytes_of(room.probes);
  ProbeStore store(device, room.grid, room.probe_count(), {.arena_bytes = bytes + bytes / 2});
  EXPECT_EQ(store.reserved_bytes(), bytes + bytes / 2);
  const std::uint64_t taken = device.allocated_bytes();
  store.upload(room.upload(0));
  frame(store);
  EXPECT_THROW(store.upload(room.upload(1)), VulkanError);
  frame(store);
  EXPECT_EQ(store.level_shown(0), 0) << "what is there stays";
  EXPECT_EQ(store.device_bytes(), bytes);
  store.evict(0, 0);
  frame(store);
  frame(store);
  store.upload(room.upload(1));
  store.settle();
  EXPECT_EQ(store.level_shown(0), 1);
  EXPECT_EQ(ask(store).answer, kClassHit);
  EXPECT_EQ(store.reserved_bytes(), bytes + bytes / 2);
  EXPECT_LE(device.allocated_bytes(), taken) << "nothing more is asked of the driver";
}

// Small levels with holes between them, which together would hold a large one.
class CrowdedStore : public ProbeStoreTest {
 protected:
  static constexpr std::uint32_t kSmall = 40;
  const std::uint64_t small_bytes = ProbeStore::bytes_of(room.probes);
  const test::ProbeRoom large{64, 32};
  ProbeStore store{device, room.grid, room.probe_count(), {.arena_bytes = kSmall * small_bytes}};

  void SetUp() override {
    ASSERT_LT(ProbeStore::bytes_of(large.probes), kSmall / 2 * small_bytes);
    for (std::uint32_t level = 0; level < kSmall; ++level) store.upload(room.upload(level));
    frame(store);
    for (std::uint32_t level = 0; level < kSmall; level += 2) store.evict(0, level);
    frame(store);
    frame(store);
    EXPECT_THROW(store.upload(large.upload(kSmall)), VulkanError) << "no hole is large enough";
  }
};

TEST_F(CrowdedStore, MovesTogetherWhatIsThereFrameByFrameAndAnswersAlikeMeanwhile) {
  const BatchAnswer before = ask(store);
  const std::uint64_t bytes = store.device_bytes(), times = store.times_freed();
  for (int k = 0; k < 60; ++k) {
    frame(store);
    const BatchAnswer now = ask(store);
    ASSERT_EQ(now.answer, before.answer) << k;
    ASSERT_EQ(now.t_m, before.t_m) << k;
    ASSERT_EQ(now.radiance, before.radiance) << k;
    ASSERT_EQ(store.level_shown(0), static_cast<int>(kSmall) - 1);
  }
  EXPECT_EQ(store.device_bytes(), bytes);
  EXPECT_GT(store.times_freed(), times) << "whoever waits for room hears of it";
  store.upload(large.upload(kSmall));
  store.settle();
  EXPECT_EQ(store.level_shown(0), static_cast<int>(kSmall));
  ProbeStore alone(device, room.grid, room.probe_count());
  alone.upload(large.upload(0));
  alone.settle();
  EXPECT_EQ(ask(store).t_m, ask(alone).t_m);
  EXPECT_EQ(ask(store).radiance, ask(alone).radiance);
  store.evict(0, kSmall);
  for (std::uint32_t level = kSmall - 1; level > 1; level -= 2) {
    store.settle();
    ASSERT_EQ(ask(store).t_m, before.t_m) << "each of those that were moved, level " << level;
    store.evict(0, level);
  }
}

TEST_F(CrowdedStore, SettlingMovesTogetherAtOnce) {
  const BatchAnswer before = ask(store);
  store.settle();
  EXPECT_EQ(ask(store).t_m, before.t_m);
  store.upload(large.upload(kSmall));
  store.settle();
  EXPECT_EQ(store.level_shown(0), static_cast<int>(kSmall));
}

TEST_F(CrowdedStore, WhatIsMovedMayGoAtAnyTime) {
  for (std::uint32_t level = 1; level < kSmall; level += 2) {
    frame(store);
    store.evict(0, level);
  }
  frame(store);
  frame(store);
  EXPECT_EQ(store.device_bytes(), 0u);
  store.upload(large.upload(0));
  store.settle();
  EXPECT_EQ(ask(store).answer, kClassHit);
}

// Pyramids are left to the device: within their budget, and shown only when they are done.
TEST_F(ProbeStoreTest, BuildsOpenPyramidsWithinABudgetBeforeALevelShows) {
  test::ProbeRoom open(64, 8);
  std::uint64_t pyramid_bytes = 0;
  for (DeviceProbe& probe : open.probes) {
    const WordRange pyramid = pyramid_range(probe.record);
    std::fill_n(probe.geometry.begin() + static_cast<std::ptrdiff_t>(pyramid.first), pyramid.count, 0xffffffffu);
    probe.pyramid_is_open = true;
    pyramid_bytes += pyramid.count * sizeof(std::uint32_t);
  }
  const test::ProbeRoom whole(64, 8);
  ProbeStore reference(device, room.grid, room.probe_count());
  reference.upload(whole.upload());
  reference.settle();
  const ProbeStoreOptions dials[] = {{.build_bytes_per_frame = 20000},
                                     {.build_bytes_per_frame = 20000, .always_stage = true},
                                     {.build_bytes_per_frame = 20000, .always_stage = true, .copy_apart = true}};
  for (const ProbeStoreOptions& options : dials) {
    ProbeStore store(device, room.grid, room.probe_count(), options);
    store.upload(open.upload());
    std::uint64_t built = 0;
    std::uint64_t steps = 0;
    for (int k = 0; k < 10000 && store.level_shown(0) < 0; ++k) {
      EXPECT_FALSE(store.idle());
      EXPECT_EQ(store.queue_depth(), 1u);
      frame(store);
      EXPECT_LE(work.built_bytes, 20000u);
      built += work.built_bytes;
      steps += work.built_bytes > 0;
    }
    ASSERT_EQ(store.level_shown(0), 0);
    EXPECT_EQ(built, 8u * 2 * 4 * 64 * 64) << "two levels of each of eight probes";
    EXPECT_GE(steps, 8u * 2 * 4 * 64 * 64 / 20000);
    EXPECT_TRUE(store.idle());
    EXPECT_EQ(store.bytes_uploaded(), ProbeStore::bytes_of(open.probes) - pyramid_bytes);
    EXPECT_EQ(store.device_bytes(), ProbeStore::bytes_of(open.probes));
    store.settle();
    EXPECT_EQ(ask(store).t_m, ask(reference).t_m);
    EXPECT_EQ(ask(store).lookups, ask(reference).lookups);
  }
  ProbeStore at_once(device, room.grid, room.probe_count(), {.build_bytes_per_frame = 1, .always_stage = true});
  at_once.upload(open.upload());
  at_once.settle();
  EXPECT_EQ(ask(at_once).lookups, ask(reference).lookups);
}

TEST_F(ProbeStoreTest, AnEvictionWhilePyramidsAreBuiltIsSafe) {
  test::ProbeRoom open(64, 8);
  for (DeviceProbe& probe : open.probes) probe.pyramid_is_open = true;
  for (const bool apart : {false, true}) {
    ProbeStore store(device, room.grid, room.probe_count(),
                     {.build_bytes_per_frame = 20000, .always_stage = apart, .copy_apart = apart});
    evict_sooner_or_later(store, open);
    EXPECT_TRUE(store.idle());
    EXPECT_EQ(store.device_bytes(), 0u);
  }
}

TEST_F(ProbeStoreTest, WithoutAnArenaMemoryGoesBackWhenRoomsGo) {
  ProbeStore store(device, room.grid, room.probe_count());
  EXPECT_EQ(store.reserved_bytes(), 0u);
  store.upload(room.upload());
  EXPECT_GE(store.reserved_bytes(), ProbeStore::bytes_of(room.probes));
  frame(store);
  store.evict(0, 0);
  frame(store);
  EXPECT_EQ(store.reserved_bytes(), 0u);
}

TEST_F(ProbeStoreTest, TakesUploadsFromOtherThreadsWhileFramesRun) {
  ProbeStore store(device, room.grid, room.probe_count());
  std::thread loader([&] {
    for (int k = 0; k < 40; ++k) {
      store.upload(room.upload(static_cast<std::uint32_t>(k % 3)));
      if (k % 5 == 4) store.evict(0, static_cast<std::uint32_t>(k % 3));
    }
  });
  for (int k = 0; k < 40; ++k) frame(store);
  loader.join();
  frame(store);
  EXPECT_TRUE(store.idle());
  EXPECT_GE(store.level_shown(0), 0);
}

TEST_F(ProbeStoreTest, RefusesProbesOutsideItsTable) {
  ProbeStore store(device, room.grid, room.probe_count());
  RoomUpload outside = room.upload();
  outside.first_probe = 1;
  EXPECT_THROW(store.upload(outside), std::logic_error);
}

}  // namespace
}  // namespace probewalk
