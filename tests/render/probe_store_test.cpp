#include "render/probe_store.h"

#include <gtest/gtest.h>

#include <algorithm>
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
    std::uint64_t copied = 0;
    ++frames;
    run_commands(device, [&](VkCommandBuffer commands) {
      copied = store.begin_frame(commands, static_cast<std::uint32_t>(frames % 2), frames, frames - 1);
    });
    return copied;
  }
  // Class of the answer to one ray from the room's middle.
  BatchAnswer ask(const ProbeStore& store) const {
    const WorldRay ray{{0.0, 1.4, 0.0}, {0.1, 0.05, -1.0}};
    return RayBatch(device).trace(store, default_dials(test::kRadianceScale), {&ray, 1}, 0.01f).front();
  }
  const test::ProbeRoom room{16, 8};
  std::uint64_t frames = 0;
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
  for (std::uint32_t k = 0; k < 20; ++k) {
    store.upload(room.upload(k % 2));
    for (std::uint32_t wait = 0; wait < k; ++wait) frame(store);
    store.evict(0, k % 2);
    frame(store);
  }
  store.settle();
  frame(store);
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
